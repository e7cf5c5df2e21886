//! The bias: whether the test image is brighter or darker on the whole. Noise cancels in it, a fault does not.

use super::channel::ChannelMetric;
use super::gate_kind::{GateKind, GateValue};

/// The relative difference of the means.
pub(super) const METRIC: ChannelMetric = ChannelMetric {
    key: "bias",
    heading: "bias",
    signed: true,
    // The bias is made of the means of both images alone.
    term: |_, _| 0.0,
    value: |means| relative_difference(means.reference, means.test),
};

pub(super) const GATE: GateKind = GateKind {
    name: "max-bias",
    help: "Largest relative difference of the means, of every channel (0.01 is one per cent)",
    value: GateValue::Channel(METRIC.key),
};

/// Positive where the test image is brighter. Relative to a black reference, any light is infinitely brighter.
fn relative_difference(reference: f64, test: f64) -> f64 {
    let difference = test - reference;
    // Guards 0/0: two black images have no bias.
    if difference == 0.0 { 0.0 } else { difference / reference.abs() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::measure_each;

    #[test]
    fn known_means() {
        let metrics = measure_each(&[(&[1.0, 2.0], &[2.0, 2.5]), (&[3.0, 6.0], &[3.0, 0.0])], 2, [0, 0]).0;
        assert_eq!([metrics.mean_reference, metrics.mean_test], [3.0, 1.875]);
        assert_eq!(metrics.get("bias"), -0.375);
    }

    #[test]
    fn sign_and_limits() {
        assert_eq!(relative_difference(-2.0, -1.0), 0.5);
        assert_eq!(relative_difference(0.0, 0.0), 0.0);
        assert_eq!(relative_difference(0.0, 1.0), f64::INFINITY);
        assert!(relative_difference(f64::NAN, 1.0).is_nan());
        assert!(relative_difference(f64::INFINITY, f64::INFINITY).is_nan());
    }
}
