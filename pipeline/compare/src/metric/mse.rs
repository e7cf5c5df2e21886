//! The mean absolute error and the root of the mean squared error, in units of the channel.

use super::channel::ChannelMetric;
use super::gate_kind::{GateKind, GateValue};

/// The mean absolute error.
pub(super) const MAE: ChannelMetric = ChannelMetric {
    key: "mae",
    heading: "MAE",
    signed: false,
    term: |reference, test| (test - reference).abs(),
    value: |means| means.term,
};

/// The root of the mean squared error.
pub(super) const RMSE: ChannelMetric = ChannelMetric {
    key: "rmse",
    heading: "RMSE",
    signed: false,
    term: |reference, test| (test - reference) * (test - reference),
    value: |means| means.term.sqrt(),
};

pub(super) const GATE: GateKind = GateKind {
    name: "max-rmse",
    help: "Largest root of the mean squared error, of every channel, in units of the channel",
    value: GateValue::Channel(RMSE.key),
};

#[cfg(test)]
mod tests {
    use crate::metric::measure_each;

    #[test]
    fn known_errors() {
        let metrics = measure_each(&[(&[1.0, 2.0], &[4.0, 2.0]), (&[0.0, 5.0], &[0.0, 1.0])], 2, [0, 0]).0;
        assert_eq!((metrics.get("mae"), metrics.get("rmse")), (1.75, 2.5));
    }
}
