//! Limits, and whether they are held.
//!
//! Every gate passes only if value <= limit, so a value that is no number fails it.

use serde::Serialize;

use crate::layer::{ALPHA, BEAUTY, Layer};
use crate::metric::{Metrics, bitwise_differences, pixels_beyond};
use crate::{Choice, Limit, Mismatch, Report, Settings};

/// A limit; those of a metric hold for every channel of the layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gate {
    /// Relative difference of the means, without sign.
    Bias(f64),
    /// Mean squared error relative to the reference.
    RelMse(f64),
    /// Root of the mean squared error, in units of the channel.
    Rmse(f64),
    /// Largest absolute error, in units of the channel.
    Abs(f64),
    /// So many pixels may differ by more than a threshold in units of the channel.
    Outliers {
        /// Pixels allowed.
        count: u64,
        /// Absolute error that makes an outlier.
        threshold: f64,
    },
    /// Mean of HDR-FLIP, of the beauty layer whatever layer is chosen.
    Flip(f64),
    /// Every bit of every sample.
    Exact,
}

/// What became of a gate on one layer.
#[derive(Clone, Debug, Serialize)]
pub struct Judgement {
    /// Its name: that of the option, or `nonfinite`.
    pub gate: &'static str,
    /// The layer.
    pub layer: String,
    /// The channel of the value, where it belongs to one.
    pub channel: Option<String>,
    /// What was found: of metrics, the worst channel's.
    pub value: f64,
    /// The most that passes.
    pub limit: f64,
    /// Absolute error that makes an outlier, for `max-outliers`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub threshold: Option<f64>,
    /// Whether it passed.
    pub ok: bool,
    /// Why the limit is what it is, of a limits file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

impl Gate {
    /// A gate by the name of its option. Only `max-outliers` has a threshold.
    pub fn new(name: &str, limit: f64, threshold: Option<f64>) -> Result<Gate, String> {
        let is_limit = |number: f64| number.is_finite() && number >= 0.0;
        if !is_limit(limit) || threshold.is_some_and(|threshold| !is_limit(threshold)) {
            return Err("not a finite number of at least 0".to_owned());
        }
        match (name, threshold) {
            ("max-outliers", None) => Err("`threshold` is missing: the error that makes an outlier".to_owned()),
            ("max-outliers", Some(threshold)) => match limit as u64 {
                count if count as f64 == limit => Ok(Gate::Outliers { count, threshold }),
                _ => Err("not a whole number of pixels".to_owned()),
            },
            (_, Some(_)) => Err("`threshold` belongs to `max-outliers` only".to_owned()),
            ("max-bias", None) => Ok(Gate::Bias(limit)),
            ("max-relmse", None) => Ok(Gate::RelMse(limit)),
            ("max-rmse", None) => Ok(Gate::Rmse(limit)),
            ("max-abs", None) => Ok(Gate::Abs(limit)),
            ("max-flip", None) => Ok(Gate::Flip(limit)),
            ("exact", None) if limit == 0.0 => Ok(Gate::Exact),
            ("exact", None) => Err("the limit of this gate is 0".to_owned()),
            _ => Err(format!("there is no gate `{name}`")),
        }
    }

    /// Whether two gates ask the same of an image and differ at most in what they allow.
    pub(crate) fn is_same_question(self, other: Gate) -> bool {
        match (self, other) {
            (Gate::Outliers { threshold: one, .. }, Gate::Outliers { threshold: two, .. }) => one == two,
            _ => self.name() == other.name(),
        }
    }

    pub(crate) fn is_flip(self) -> bool {
        matches!(self, Gate::Flip(_))
    }

    fn name(self) -> &'static str {
        match self {
            Gate::Bias(_) => "max-bias",
            Gate::RelMse(_) => "max-relmse",
            Gate::Rmse(_) => "max-rmse",
            Gate::Abs(_) => "max-abs",
            Gate::Outliers { .. } => "max-outliers",
            Gate::Flip(_) => "max-flip",
            Gate::Exact => "exact",
        }
    }

    fn limit(self) -> f64 {
        match self {
            Gate::Bias(limit) | Gate::RelMse(limit) | Gate::Rmse(limit) | Gate::Abs(limit) | Gate::Flip(limit) => limit,
            Gate::Outliers { count, .. } => count as f64,
            Gate::Exact => 0.0,
        }
    }

    fn judge(self, layer: &Layer<'_>, report: &Report) -> Judgement {
        let worst = |metric: fn(&Metrics) -> f64| report.worst_channel(&layer.name, metric);
        let (value, channel) = match self {
            Gate::Bias(_) => worst(|metrics| metrics.bias.abs()),
            Gate::RelMse(_) => worst(|metrics| metrics.relmse),
            Gate::Rmse(_) => worst(|metrics| metrics.rmse),
            Gate::Abs(_) => worst(|metrics| metrics.max.error),
            Gate::Outliers { threshold, .. } => (pixels_beyond(&layer.samples(), threshold) as f64, None),
            Gate::Flip(_) => (report.picture.flip_hdr.as_ref().map_or(f64::NAN, |hdr| hdr.flip.mean), None),
            Gate::Exact => (bitwise_differences(&layer.samples()) as f64, None),
        };
        let threshold = if let Gate::Outliers { threshold, .. } = self { Some(threshold) } else { None };
        let limit = self.limit();
        let (gate, layer) = (self.name(), layer.name.clone());
        Judgement { gate, layer, channel, value, limit, threshold, ok: value <= limit, reason: None }
    }
}

/// The finiteness of all channels first, then every gate on every layer that it looks at.
pub(crate) fn judge(layers: &[Layer<'_>], report: &Report, settings: &Settings) -> Vec<Judgement> {
    let mut judgements = Vec::new();
    if !settings.allow_nonfinite {
        let value = (report.nonfinite.reference + report.nonfinite.test) as f64;
        let layer = "all".to_owned();
        let (gate, limit) = ("nonfinite", 0.0);
        let ok = value <= limit;
        judgements.push(Judgement { gate, layer, channel: None, value, limit, threshold: None, ok, reason: None });
    }
    for (gate, choice, reason) in asked(settings) {
        let chosen = layers.iter().filter(|layer| sees(gate, choice, &layer.name));
        judgements.extend(chosen.map(|layer| Judgement { reason: reason.cloned(), ..gate.judge(layer, report) }));
    }
    judgements
}

/// Every gate with its layers and, if it has one, its reason: those of the command line first.
fn asked(settings: &Settings) -> impl Iterator<Item = (Gate, &Choice, Option<&String>)> {
    let own = settings.gates.iter().map(|gate| (*gate, &settings.choice, None));
    own.chain(settings.limits.iter().map(|Limit { gate, choice, reason }| (*gate, choice, Some(reason))))
}

/// Whether FLIP is judged.
pub(crate) fn any_flip(settings: &Settings) -> bool {
    asked(settings).any(|(gate, ..)| gate.is_flip())
}

/// Perceptual means hide single bright pixels and a small bias of the whole picture.
pub(crate) fn flip_alone(settings: &Settings) -> bool {
    any_flip(settings) && asked(settings).all(|(gate, ..)| gate.is_flip())
}

/// The layer, or `None` for all.
pub(crate) fn looks_at(gate: Gate, choice: &Choice) -> Option<&str> {
    match (choice, gate) {
        (_, Gate::Flip(_)) => Some(BEAUTY),
        (Choice::Default, Gate::Exact) | (Choice::All, _) => None,
        (Choice::Default, _) => Some(BEAUTY),
        (Choice::Named(name), _) => Some(name),
    }
}

/// Whether a gate looks at a layer. One that looks at the picture without being told a layer looks at its alpha too.
fn sees(gate: Gate, choice: &Choice, layer: &str) -> bool {
    let whole_picture = *choice == Choice::Default && !gate.is_flip();
    looks_at(gate, choice).is_none_or(|name| layer == name) || whole_picture && ALPHA.contains(&layer)
}

/// Names of the layers that differ and that no gate looks at; without any gate, those that the verdict does not speak of.
pub(crate) fn unjudged_layers(layers: &[Layer<'_>], report: &Report, settings: &Settings) -> Vec<String> {
    let any_gate = asked(settings).next().is_some();
    let is_judged = |name: &String| match any_gate {
        true => asked(settings).any(|(gate, choice, _)| sees(gate, choice, name)),
        false => report.judged.contains(name),
    };
    let differs = |layer: &Layer<'_>| {
        let measured = report.layers.iter().find(|measured| measured.name == layer.name);
        // Equal NaNs have an error that is no number; the two zeroes have none.
        measured.is_none_or(|measured| measured.metrics.max.error != 0.0) && bitwise_differences(&layer.samples()) > 0
    };
    layers.iter().filter(|layer| !is_judged(&layer.name) && differs(layer)).map(|layer| layer.name.clone()).collect()
}

/// A gate without a layer to look at would always pass.
pub(crate) fn check_choice(layers: &[Layer<'_>], settings: &Settings) -> Result<(), Mismatch> {
    let asked = asked(settings).filter_map(|(gate, choice, _)| looks_at(gate, choice));
    let named = if let Choice::Named(name) = &settings.choice { Some(name.as_str()) } else { None };
    match asked.chain(named).find(|name| layers.iter().all(|layer| layer.name != *name)) {
        None => Ok(()),
        Some(name) => Err(Mismatch::no_layer(name, layers)),
    }
}

/// Names of the layers that the verdict speaks of: the picture with its alpha, or all if there is no beauty layer.
pub(crate) fn judged_layers(layers: &[Layer<'_>], choice: &Choice) -> Vec<String> {
    let wanted = match choice {
        Choice::Default => Some(BEAUTY),
        Choice::All => None,
        Choice::Named(name) => Some(name.as_str()),
    };
    let wanted = wanted.filter(|name| layers.iter().any(|layer| layer.name == *name));
    let is_alpha = |name: &String| *choice == Choice::Default && ALPHA.contains(&name.as_str());
    let chosen = |name: &String| wanted.is_none_or(|wanted| name == wanted) || is_alpha(name);
    layers.iter().map(|layer| layer.name.clone()).filter(chosen).collect()
}
