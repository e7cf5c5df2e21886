//! What is said of a calibration.

use cli::{Common, Seconds};
use formats::{
    calibration::{Calibration, ChannelErrors},
    cloud::hex,
};

const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// Lines for the terminal: for each material and channel, how wrong the model was, and is with the calibration.
pub fn lines(calibration: &Calibration) -> Vec<String> {
    let mut lines = Vec::new();
    for material in &calibration.materials {
        lines.push(format!("material `{}`: {}", material.name, material.medium.name));
        for (name, e) in CHANNELS.iter().zip(&material.errors) {
            if *e == ChannelErrors::default() {
                lines.push(format!("  {name:5} no scattered light leaves: there is nothing to calibrate"));
                continue;
            }
            let unresolved = match e.unresolved {
                share if share > 0.0 => {
                    format!("; unresolved (few walks): {:.1} % of the surface", 100.0 * share)
                }
                _ => String::new(),
            };
            lines.push(format!(
                "  {name:5} the model was off by relMSE {:.2e}, now by about {:.1e} +- {:.0e}{unresolved}",
                e.before, e.after, e.uncertainty
            ));
        }
    }
    lines
}

/// Statistics as JSON.
pub fn statistics(calibration: &Calibration, common: &Common, seconds: &Seconds) -> Vec<u8> {
    let materials: Vec<_> = calibration
        .materials
        .iter()
        .map(|m| {
            let of = |f: fn(&ChannelErrors) -> f64| m.errors.map(|e| f(&e));
            serde_json::json!({
                "material": m.name,
                "medium": m.medium.name,
                "error_before": of(|e| e.before),
                "error_after": of(|e| e.after),
                "error_uncertainty": of(|e| e.uncertainty),
                "unresolved_share": of(|e| e.unresolved),
                "exit_lobe": m.lobe,
                "patches": m.surface.patches.len(),
            })
        })
        .collect();
    let value = serde_json::json!({
        "schema": 1,
        "threads": common.thread_count(),
        "calibration": hex(&calibration.content),
        "cloud": hex(&calibration.cloud),
        "bssrdf": calibration.model,
        "walks": calibration.walks,
        "materials": materials,
        "seconds": seconds.table(),
        "peak_memory_bytes": cli::peak_memory_bytes(),
    });
    format!("{value:#}\n").into_bytes()
}
