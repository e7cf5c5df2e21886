//! The report: what was measured and judged, as a table for people and as JSON for programs.

use std::fmt::Write;

use cli::printable;
use formats::image::Image;
use serde::Serialize;

use crate::gate::Judgement;
use crate::layer::Layer;
use crate::metric::{CHANNEL_METRICS, ChannelMetric, EPSILON, Metrics, PictureMetrics, Worst, measure_each};
use crate::structure::Input;

/// The version of the keys, which changes only when a key of the JSON report changes its meaning or is removed.
const SCHEMA: u32 = 1;
/// The verdict names so many of the layers that are not judged; the report has all.
const NAMED: usize = 12;

/// Everything that was measured and judged. Numbers that are not finite are `null` in JSON.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Report {
    /// The version of the keys.
    pub schema: u32,
    /// The number of pixels in a row.
    pub width: usize,
    /// The number of rows.
    pub height: usize,
    /// The number that is added to the squared reference in relMSE.
    pub relmse_epsilon: f64,
    /// The attributes of both headers that identify the inputs of the images.
    pub inputs: Vec<Input>,
    /// The number of samples that are not finite, in all channels.
    pub nonfinite: NonFinite,
    /// The layers: beauty first, then by name.
    pub layers: Vec<LayerReport>,
    /// The metrics of the picture.
    pub picture: PictureMetrics,
    /// The judgements of every gate, in the order of the options, on every layer that it judges.
    pub gates: Vec<Judgement>,
    /// The layers that the verdict speaks of.
    pub judged: Vec<String>,
    /// The layers that differ and that no gate judges.
    pub unjudged: Vec<String>,
    /// Further remarks about the headers, in words.
    pub notes: Vec<String>,
    /// Whether every gate passed.
    pub pass: bool,
}

/// Samples that are NaN or infinite.
#[derive(Clone, Debug, Default, Serialize)]
pub struct NonFinite {
    /// Whether they may pass.
    pub allowed: bool,
    /// Their number in the reference.
    pub reference: u64,
    /// Their number in the test image.
    pub test: u64,
}

/// A layer: all its channels together, and each alone.
#[derive(Clone, Debug, Serialize)]
pub struct LayerReport {
    /// Its name.
    pub name: String,
    /// The metrics over the samples of all its channels.
    #[serde(flatten)]
    pub metrics: Metrics,
    /// The metrics of each channel.
    pub channels: Vec<ChannelReport>,
}

/// A channel.
#[derive(Clone, Debug, Serialize)]
pub struct ChannelReport {
    /// Its name without that of the layer.
    pub name: String,
    /// The metrics over its samples.
    #[serde(flatten)]
    pub metrics: Metrics,
}

/// A report with all metrics, in which nothing is judged.
pub(crate) fn measure(image: &Image, layers: &[Layer<'_>], picture: PictureMetrics) -> Report {
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
        nonfinite: NonFinite {
            allowed: false,
            reference: count(|metrics| metrics.nonfinite_reference),
            test: count(|metrics| metrics.nonfinite_test),
        },
        layers,
        picture,
        ..Report::default()
    }
}

impl Report {
    /// The largest absolute value of a metric among the channels of a layer, and the channel. NaN is the largest.
    pub(crate) fn worst_channel(&self, layer: &str, key: &str) -> (f64, Option<String>) {
        let channels = self.layers.iter().filter(|found| found.name == layer).flat_map(|found| &found.channels);
        channels.map(|channel| (channel.metrics.get(key).abs(), Some(channel.name.clone()))).fold(
            (0.0, None),
            |worst, found| if worst.1.is_none() || found.0.total_cmp(&worst.0).is_gt() { found } else { worst },
        )
    }

    /// The table, with a line for each layer and for each channel of the layers that the verdict speaks of.
    pub fn table(&self) -> String {
        let headings: String = CHANNEL_METRICS.iter().map(|metric| format!("{:>11}", metric.heading)).collect();
        let mut table = format!(
            "{:<14}{:>11}{:>11}{headings}{:>11}{:>11}  at, reference -> test\n",
            "layer", "mean ref", "mean test", "p99", "max"
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
        // Writing to a string cannot fail.
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

    /// One line: `PASS name relmse=... bias=...` with the values of the worst channel, or `FAIL gate value > limit`.
    /// Layers that differ and that no gate judges are named at its end.
    pub fn verdict(&self, name: &str) -> String {
        let failed: Vec<String> = self.gates.iter().filter(|gate| !gate.ok).map(failure).collect();
        if !failed.is_empty() {
            return format!("FAIL {}\n", failed.join("; "));
        }
        let judged = || self.layers.iter().filter(|layer| self.judged.contains(&layer.name));
        let worst = |key: &str| {
            let values = judged().flat_map(|layer| &layer.channels).map(|channel| channel.metrics.get(key));
            values.max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0)
        };
        let (name, relmse, bias) = (printable(name), worst("relmse"), worst("bias"));
        format!("PASS {name} relmse={relmse:.3e} bias={bias:+.3e}{}\n", self.not_judged())
    }

    /// The end of a verdict that names the layers that differ and that no gate judges.
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
    let Metrics { mean_reference, mean_test, p99, max: Worst { error, pixel: [x, y], reference, test }, .. } = metrics;
    let cell = |metric: &ChannelMetric| match (metric.signed, metrics.get(metric.key)) {
        (true, value) => format!("{value:>+11.2e}"),
        (false, value) => format!("{value:>11.3e}"),
    };
    let values: String = CHANNEL_METRICS.iter().map(cell).collect();
    let (reference, test) = (sample(*reference), sample(*test));
    let _ = writeln!(
        table,
        "{name:<14}{mean_reference:>11.3e}{mean_test:>11.3e}{values}{p99:>11.3e}{error:>11.3e}  {x},{y} {reference} -> {test}"
    );
}

fn failure(gate: &Judgement) -> String {
    let layer = printable(&gate.layer);
    let whose = match &gate.channel {
        Some(channel) => format!("{layer} {}", printable(channel)),
        None => layer.into_owned(),
    };
    format!("{} {} > {} ({whose})", gate.gate, number(gate.value), number(gate.limit))
}

/// A number with all its digits, so that a value beyond a limit never looks equal to the limit.
fn number(value: f64) -> String {
    if is_plain(value) { format!("{value}") } else { format!("{value:e}") }
}

/// A sample of an image with the digits of float32.
fn sample(value: f64) -> String {
    let short = value as f32;
    if is_plain(value) { format!("{short}") } else { format!("{short:e}") }
}

/// Whether a number is written without an exponent.
fn is_plain(value: f64) -> bool {
    value == 0.0 || (1e-4..1e15).contains(&value.abs())
}
