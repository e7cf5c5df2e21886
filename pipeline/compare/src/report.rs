//! What was measured, as a table for people and as JSON for programs.

use std::fmt::Write;

use cli::printable;
use formats::image::Image;
use serde::Serialize;

use crate::gate::Judgement;
use crate::layer::Layer;
use crate::metric::{EPSILON, Metrics, PictureMetrics, measure_each};
use crate::structure::Input;

/// Changes only when a key of the JSON report changes its meaning or goes.
const SCHEMA: u32 = 1;
/// Layers that are not judged that the verdict names; the report has all.
const NAMED: usize = 12;

/// Everything that was measured and judged. Numbers that are not finite become `null` in JSON.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Version of the keys.
    pub schema: u32,
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// What is added to the squared reference in relMSE.
    pub relmse_epsilon: f64,
    /// Whether both images were made from the same inputs, as far as they tell.
    pub inputs: Vec<Input>,
    /// NaN and infinity in all channels.
    pub nonfinite: NonFinite,
    /// The beauty layer first, then by name.
    pub layers: Vec<LayerReport>,
    /// The beauty layer as it is seen.
    pub picture: PictureMetrics,
    /// Every gate, in the order of the options, on every layer that it looks at.
    pub gates: Vec<Judgement>,
    /// Layers that the verdict speaks of.
    pub judged: Vec<String>,
    /// Layers that differ and that no gate looks at.
    pub unjudged: Vec<String>,
    /// What a reader should know of the headers besides, in words.
    pub notes: Vec<String>,
    /// Whether every gate passed.
    pub pass: bool,
}

/// Samples that are NaN or infinite.
#[derive(Clone, Debug, Serialize)]
pub struct NonFinite {
    /// Whether they are let pass.
    pub allowed: bool,
    /// In the reference.
    pub reference: u64,
    /// In the test image.
    pub test: u64,
}

/// A layer, all its channels together and each alone.
#[derive(Clone, Debug, Serialize)]
pub struct LayerReport {
    /// Its name.
    pub name: String,
    /// Over the samples of all its channels.
    #[serde(flatten)]
    pub metrics: Metrics,
    /// Each channel alone.
    pub channels: Vec<ChannelReport>,
}

/// A channel.
#[derive(Clone, Debug, Serialize)]
pub struct ChannelReport {
    /// Its name without the layer.
    pub name: String,
    /// Over its samples.
    #[serde(flatten)]
    pub metrics: Metrics,
}

/// All metrics; nothing judged yet.
pub(crate) fn measure(image: &Image, layers: &[Layer<'_>]) -> Report {
    let measure = |layer: &Layer<'_>| {
        let (metrics, each) = measure_each(&layer.samples(), image.width, image.window);
        let channels = layer.channels.iter().zip(each);
        let channels = channels.map(|((name, _), metrics)| ChannelReport { name: name.clone(), metrics }).collect();
        LayerReport { name: layer.name.clone(), metrics, channels }
    };
    let layers: Vec<LayerReport> = layers.iter().map(measure).collect();
    let count = |of: fn(&Metrics) -> u64| layers.iter().map(|layer| of(&layer.metrics)).sum();
    Report {
        schema: SCHEMA,
        width: image.width,
        height: image.height,
        relmse_epsilon: EPSILON,
        inputs: Vec::new(),
        nonfinite: NonFinite {
            allowed: false,
            reference: count(|metrics| metrics.nonfinite_reference),
            test: count(|metrics| metrics.nonfinite_test),
        },
        layers,
        picture: PictureMetrics::default(),
        gates: Vec::new(),
        judged: Vec::new(),
        unjudged: Vec::new(),
        notes: Vec::new(),
        pass: false,
    }
}

impl Report {
    /// The largest value among the channels of a layer, and whose it is. One that is no number is largest.
    pub(crate) fn worst_channel(&self, layer: &str, metric: fn(&Metrics) -> f64) -> (f64, Option<String>) {
        let channels = self.layers.iter().filter(|found| found.name == layer).flat_map(|found| &found.channels);
        channels.map(|channel| (metric(&channel.metrics).abs(), Some(channel.name.clone()))).fold(
            (0.0, None),
            |worst, found| if worst.1.is_none() || found.0.total_cmp(&worst.0).is_gt() { found } else { worst },
        )
    }

    /// A line per layer; the channels too of those that the verdict speaks of.
    pub fn table(&self) -> String {
        let mut table = format!(
            "{:<14}{:>11}{:>11}{:>11}{:>11}{:>11}{:>11}{:>11}{:>11}  at, reference -> test\n",
            "layer", "mean ref", "mean test", "bias", "MAE", "RMSE", "relMSE", "p99", "max"
        );
        for layer in &self.layers {
            line(&mut table, &printable(&layer.name), &layer.metrics);
            if layer.channels.len() > 1 && self.judged.contains(&layer.name) {
                for channel in &layer.channels {
                    line(&mut table, &format!("  {}", printable(&channel.name)), &channel.metrics);
                }
            }
        }
        let NonFinite { reference, test, .. } = &self.nonfinite;
        // Writing to a string cannot fail, here and below.
        let _ = writeln!(table, "not finite: {reference} samples of the reference, {test} of the test image");
        let _ = writeln!(table, "relMSE = mean of (test - reference)^2 / (reference^2 + {EPSILON})");
        table.push_str(&self.picture.lines());
        for note in self.inputs.iter().filter_map(Input::note).chain(self.notes.iter().cloned()) {
            let _ = writeln!(table, "{}", printable(&note));
        }
        for gate in self.gates.iter().filter(|gate| !gate.ok) {
            if let Some(reason) = &gate.reason {
                let (layer, limit) = (printable(&gate.layer), number(gate.limit));
                let _ = writeln!(table, "{} of {layer} is limited to {limit}: {}", gate.gate, printable(reason));
            }
        }
        table
    }

    /// One line: `PASS name relmse=... bias=...`, of the worst channel, or `FAIL gate value > limit`. If layers differ that
    /// no gate looks at, it says which after the numbers.
    pub fn verdict(&self, name: &str) -> String {
        let failed: Vec<String> = self.gates.iter().filter(|gate| !gate.ok).map(failure).collect();
        if !failed.is_empty() {
            return format!("FAIL {}\n", failed.join("; "));
        }
        let judged = || self.layers.iter().filter(|layer| self.judged.contains(&layer.name));
        let worst = |metric: fn(&Metrics) -> f64| {
            let values = judged().flat_map(|layer| &layer.channels).map(|channel| metric(&channel.metrics));
            values.max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0)
        };
        format!(
            "PASS {} relmse={:.3e} bias={:+.3e}{}\n",
            printable(name),
            worst(|metrics| metrics.relmse),
            worst(|metrics| metrics.bias),
            self.not_judged()
        )
    }

    /// The layers that differ and that no gate looks at, as the end of a verdict.
    fn not_judged(&self) -> String {
        let named: Vec<_> = self.unjudged.iter().take(NAMED).map(|name| printable(name)).collect();
        match self.unjudged.len().saturating_sub(NAMED) {
            _ if named.is_empty() => String::new(),
            0 => format!("; different but not judged: {}", named.join(", ")),
            more => format!("; different but not judged: {} and {more} more", named.join(", ")),
        }
    }
}

fn line(table: &mut String, name: &str, metrics: &Metrics) {
    let Metrics { mean_reference, mean_test, bias, mae, rmse, relmse, p99, max, .. } = metrics;
    let _ = writeln!(
        table,
        "{name:<14}{mean_reference:>11.3e}{mean_test:>11.3e}{bias:>+11.2e}{mae:>11.3e}{rmse:>11.3e}{relmse:>11.3e}\
         {p99:>11.3e}{:>11.3e}  {},{} {} -> {}",
        max.error,
        max.pixel[0],
        max.pixel[1],
        sample(max.reference),
        sample(max.test),
    );
}

fn failure(gate: &Judgement) -> String {
    let layer = printable(&gate.layer);
    let place = match &gate.channel {
        Some(channel) => format!("{layer} {}", printable(channel)),
        None => layer.into_owned(),
    };
    format!("{} {} > {} ({place})", gate.gate, number(gate.value), number(gate.limit))
}

/// All digits, so that a value beyond a limit never looks equal to it.
fn number(value: f64) -> String {
    if is_plain(value) { format!("{value}") } else { format!("{value:e}") }
}

/// A value of an image, with the digits of float32.
fn sample(value: f64) -> String {
    let short = value as f32;
    if is_plain(value) { format!("{short}") } else { format!("{short:e}") }
}

/// Whether a number is short without an exponent.
fn is_plain(value: f64) -> bool {
    value == 0.0 || (1e-4..1e15).contains(&value.abs())
}
