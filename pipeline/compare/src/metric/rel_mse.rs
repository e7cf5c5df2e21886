//! The mean squared error relative to the reference, in which dark and bright parts of the image count alike.

use super::channel::ChannelMetric;
use super::gate_kind::{GateKind, GateValue};

/// Is added to the squared reference, so that no black pixel divides by zero; it is printed with every report.
pub const EPSILON: f64 = 0.01;

/// The relative mean squared error.
pub(super) const METRIC: ChannelMetric = ChannelMetric {
    key: "relmse",
    heading: "relMSE",
    signed: false,
    term: |reference, test| (test - reference) * (test - reference) / (reference * reference + EPSILON),
    value: |means| means.term,
};

pub(super) const GATE: GateKind = GateKind {
    name: "max-relmse",
    help: "Largest mean of (test - reference)^2 / (reference^2 + 0.01), of every channel",
    value: GateValue::Channel(METRIC.key),
};

#[cfg(test)]
mod tests {
    use super::EPSILON;
    use crate::metric::measure_each;

    #[test]
    fn known_errors() {
        // 0.5^2 / (0^2 + 0.01) = 25 and 1^2 / (3^2 + 0.01) = 1 / 9.01, over two samples.
        let expected = (0.25 / EPSILON + 1.0 / 9.01) / 2.0;
        assert!((measure_each(&[(&[0.0, 3.0], &[0.5, 4.0])], 2, [0, 0]).0.get("relmse") - expected).abs() < 1e-12);
    }
}
