//! Gates: a limit on a metric or on a count, and the judgement whether an image holds it.
//!
//! Every gate passes only if value <= limit, so that NaN fails it.

use serde::Serialize;

use crate::layer::{BEAUTY, Choice};
use crate::metric::{GATES, GateKind, GateValue};

/// A limit. That of a metric holds for every channel of a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gate {
    kind: &'static GateKind,
    limit: f64,
    /// The absolute error that makes an outlier, in units of the channel.
    threshold: Option<f64>,
}

/// The judgement of a gate on one layer.
#[derive(Clone, Debug, Serialize)]
pub struct Judgement {
    /// The name of the gate's option, or `nonfinite`.
    pub gate: &'static str,
    /// The name of the layer.
    pub layer: String,
    /// The channel of the value, if the value belongs to one.
    pub channel: Option<String>,
    /// The value that was found; of a metric, that of the worst channel.
    pub value: f64,
    /// The largest value that passes.
    pub limit: f64,
    /// The absolute error that makes an outlier, for `max-outliers`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub threshold: Option<f64>,
    /// Whether the layer passed.
    pub ok: bool,
    /// The reason for the limit, if it is from a limits file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

impl Gate {
    /// A gate by the name of its option. Only `max-outliers` has a threshold.
    ///
    /// ```
    /// let gate = compare::Gate::new("max-outliers", 3.0, Some(0.5))?;
    /// assert_eq!((gate.name(), gate.limit()), ("max-outliers", 3.0));
    /// assert!(compare::Gate::new("max-bias", f64::NAN, None).is_err());
    /// # Ok::<(), String>(())
    /// ```
    pub fn new(name: &str, limit: f64, threshold: Option<f64>) -> Result<Gate, String> {
        let is_limit = |number: f64| number.is_finite() && number >= 0.0;
        if !is_limit(limit) || threshold.is_some_and(|threshold| !is_limit(threshold)) {
            return Err("it must be a finite number of at least 0".to_owned());
        }
        let kind = GATES.iter().find(|kind| kind.name == name).ok_or_else(|| format!("there is no gate `{name}`"))?;
        let fault = match (kind.value, threshold) {
            (GateValue::Pixels(_), None) => "`threshold` is missing: it is the error that makes an outlier",
            (GateValue::Pixels(_), Some(_)) if limit.fract() != 0.0 => "it must be a whole number of pixels",
            (GateValue::Pixels(_), Some(_)) => return Ok(Gate { kind, limit, threshold }),
            (_, Some(_)) => "`threshold` belongs to `max-outliers` only",
            (GateValue::Samples(_), None) if limit != 0.0 => "the limit of this gate must be 0",
            (_, None) => return Ok(Gate { kind, limit, threshold }),
        };
        Err(fault.to_owned())
    }

    /// The name of its option.
    pub fn name(self) -> &'static str {
        self.kind.name
    }

    /// The largest value that passes.
    pub fn limit(self) -> f64 {
        self.limit
    }

    /// The absolute error that makes an outlier, if the gate is on their number.
    pub fn threshold(self) -> Option<f64> {
        self.threshold
    }

    /// Whether it needs FLIP to be measured.
    pub fn needs_flip(self) -> bool {
        matches!(self.kind.value, GateValue::Picture(key) if key.starts_with("flip"))
    }

    /// The value that it limits.
    pub(crate) fn value(self) -> GateValue {
        self.kind.value
    }

    /// Whether two gates differ in their limits at most.
    pub(crate) fn is_same_question(self, other: Gate) -> bool {
        (self.kind, self.threshold) == (other.kind, other.threshold)
    }

    /// The layer that it judges under a choice, or `None` for all layers.
    pub(crate) fn layer(self, choice: &Choice) -> Option<&str> {
        match (choice, self.kind.value) {
            (_, GateValue::Picture(_)) => Some(BEAUTY),
            (Choice::Default, GateValue::Samples(_)) => None,
            (choice, _) => choice.layer(),
        }
    }

    /// The judgement of a value that was found.
    pub(crate) fn judge(self, layer: &str, value: f64, channel: Option<String>) -> Judgement {
        let Gate { kind, limit, threshold } = self;
        let (gate, layer) = (kind.name, layer.to_owned());
        Judgement { gate, layer, channel, value, limit, threshold, ok: value <= limit, reason: None }
    }
}
