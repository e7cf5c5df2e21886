//! The report on a cloud: statistics and a summary.

use crate::{draw::Made, inputs::Inputs};
use cli::{Common, Seconds, count};
use formats::cloud::{self, Cloud};
use std::collections::BTreeMap;

/// Statistics as JSON.
pub fn statistics(made: &Made, inputs: &Inputs, seconds: &Seconds, common: &Common) -> Vec<u8> {
    let (cloud, meta) = (&made.cloud, made.cloud.meta());
    let rate = seconds.of("sample").filter(|s| *s > 0.0).map(|s| meta.shadow_rays as f64 / s);
    let value = serde_json::json!({
        "schema": 1,
        "seconds": seconds.table(),
        "peak_memory_bytes": cli::peak_memory_bytes(),
        "threads": common.thread_count(),
        "kept": made.kept,
        "shard": meta.options.shard.to_string(),
        "samples_drawn": meta.samples_drawn,
        "samples_stored": cloud.len(),
        "samples_dropped": meta.samples_dropped,
        "surface_area_m2": meta.surface_area_m2,
        "shadow_rays": meta.shadow_rays,
        "shadow_rays_per_second": rate,
        "mesh": inputs.plan.defects.counts().into_iter().collect::<BTreeMap<_, _>>(),
        "mean_flux_w": meta.mean_flux_w,
        "file_bytes": cloud.bytes(),
        "content": cloud::hex(&meta.content),
        "materials": meta.materials.iter().map(|m| &m.name).collect::<Vec<_>>(),
    });
    format!("{value:#}\n").into_bytes()
}

/// Prints how many samples carry light, and how much; warns if none does.
pub fn summarize(cloud: &Cloud, common: &Common) {
    let meta = cloud.meta();
    let drawn = meta.samples_drawn as f64;
    let share = |n: u64| 100.0 * n as f64 / drawn;
    let dropped: Vec<String> = meta
        .samples_dropped
        .iter()
        .filter(|(_, n)| **n > 0)
        .map(|(reason, n)| format!("{:.1} % {}", share(*n), reason.replace('_', " ")))
        .collect();
    let dropped = if dropped.is_empty() { "none dropped".into() } else { dropped.join(", ") };
    let (lit, drawn, area, [r, g, b]) =
        (count(cloud.len()), count(meta.samples_drawn), meta.surface_area_m2, meta.mean_flux_w);
    common.say(format_args!(
        "{lit} of {drawn} samples carry light ({dropped}); area {area:.4e} m2, mean flux {r:.4e} {g:.4e} {b:.4e} W"
    ));
    if cloud.is_empty() {
        common.warn("no sample carries light: the image of this cloud will show no scattered light");
    }
}
