//! Judges layers by gates.

use crate::gate::{Gate, Judgement};
use crate::layer::{ALPHA, Choice, Layer};
use crate::metric::{GateValue, bitwise_differences};
use crate::report::Report;
use crate::settings::Settings;
use crate::structure::Mismatch;

/// Judges the finiteness of all channels first, then by every gate on every layer that it judges.
pub(crate) fn judge(layers: &[Layer<'_>], report: &Report, settings: &Settings) -> Vec<Judgement> {
    let mut judgements = Vec::new();
    if !settings.allow_nonfinite {
        let value = (report.nonfinite.reference + report.nonfinite.test) as f64;
        let (gate, layer, ok) = ("nonfinite", "all".to_owned(), value == 0.0);
        judgements.push(Judgement { gate, layer, channel: None, value, limit: 0.0, threshold: None, ok, reason: None });
    }
    for (gate, choice, reason) in settings.all_gates() {
        let chosen = layers.iter().filter(|layer| judges(gate, choice, &layer.name));
        judgements
            .extend(chosen.map(|layer| Judgement { reason: reason.cloned(), ..judge_layer(gate, layer, report) }));
    }
    judgements
}

fn judge_layer(gate: Gate, layer: &Layer<'_>, report: &Report) -> Judgement {
    let (value, channel) = match gate.value() {
        GateValue::Channel(key) => report.worst_channel(&layer.name, key),
        GateValue::Picture(key) => (report.picture.get(key).unwrap_or(f64::NAN), None),
        GateValue::Pixels(count) => (count(&layer.samples(), gate.threshold().unwrap_or(0.0)) as f64, None),
        GateValue::Samples(count) => (count(&layer.samples()) as f64, None),
    };
    gate.judge(&layer.name, value, channel)
}

/// Whether a gate judges a layer. A gate that judges the picture by default judges its alpha too.
fn judges(gate: Gate, choice: &Choice, layer: &str) -> bool {
    let whole_picture = *choice == Choice::Default && !matches!(gate.value(), GateValue::Picture(_));
    gate.layer(choice).is_none_or(|name| layer == name) || whole_picture && ALPHA.contains(&layer)
}

/// The names of the layers that differ and that no gate judges. If there are no gates, they are those that the verdict
/// does not speak of.
pub(crate) fn unjudged_layers(layers: &[Layer<'_>], report: &Report, settings: &Settings) -> Vec<String> {
    let any_gate = settings.all_gates().next().is_some();
    let is_judged = |name: &String| match any_gate {
        true => settings.all_gates().any(|(gate, choice, _)| judges(gate, choice, name)),
        false => report.judged.contains(name),
    };
    let differs = |layer: &Layer<'_>| {
        let measured = report.layers.iter().find(|measured| measured.name == layer.name);
        // The error of equal NaNs is NaN; that of the two zeroes is 0.
        measured.is_none_or(|measured| measured.metrics.max.error != 0.0) && bitwise_differences(&layer.samples()) > 0
    };
    layers.iter().filter(|layer| !is_judged(&layer.name) && differs(layer)).map(|layer| layer.name.clone()).collect()
}

/// Refuses a gate whose layer does not exist, because it would always pass.
pub(crate) fn check_choice(layers: &[Layer<'_>], settings: &Settings) -> Result<(), Mismatch> {
    let judged = settings.all_gates().filter_map(|(gate, choice, _)| gate.layer(choice));
    let named = if let Choice::Named(name) = &settings.choice { Some(name.as_str()) } else { None };
    let missing = judged.chain(named).find(|name| layers.iter().all(|layer| layer.name != *name));
    missing.map_or(Ok(()), |name| Err(Mismatch::no_layer(name, layers)))
}

/// The names of the layers that the verdict speaks of: the picture with its alpha, or all layers if there is no beauty
/// layer.
pub(crate) fn judged_layers(layers: &[Layer<'_>], choice: &Choice) -> Vec<String> {
    let wanted = choice.layer().filter(|name| layers.iter().any(|layer| layer.name == *name));
    let is_alpha = |name: &String| *choice == Choice::Default && ALPHA.contains(&name.as_str());
    let chosen = |name: &String| wanted.is_none_or(|wanted| name == wanted) || is_alpha(name);
    layers.iter().map(|layer| layer.name.clone()).filter(chosen).collect()
}
