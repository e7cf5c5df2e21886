//! Comparisons of accepted images.

use compare::{Gate, Mismatch, Settings, compare, difference, heatmap, html};
use formats::Image;

/// Larger images take longer and find no more.
const MAX_SAMPLES: usize = 1 << 9;

/// An image equals itself, and differs in any way from itself with its samples in another order: both comparisons are
/// measured, judged, drawn and put on a page.
pub fn check_comparison(image: &Image) {
    if image.channels.iter().map(|c| c.samples.len()).sum::<usize>() > MAX_SAMPLES {
        return;
    }
    let mut turned = image.clone();
    turned.channels.iter_mut().for_each(|channel| channel.samples.reverse());
    let numbers = image.channels.iter().flat_map(|c| &c.samples).all(|x| x.is_finite());
    for (test, same) in [(image, true), (&turned, false)] {
        let gates =
            [("exact", 0.0, None), ("max-bias", 0.1, None), ("max-rmse", 0.1, None), ("max-outliers", 3.0, Some(0.1))];
        let gates = gates.map(|(name, limit, threshold)| Gate::new(name, limit, threshold).expect("a gate")).into();
        let settings = Settings { gates, ignore_meta: true, ..Settings::default() };
        let report = match compare(image, test, &settings) {
            Ok(report) => report,
            Err(Mismatch::NoLayer { .. }) => return,
            Err(error) => panic!("{error}"),
        };
        assert!(!same || report.pass || !numbers, "{}", report.verdict("itself"));
        assert!(numbers || !report.pass, "{}", report.verdict("no numbers"));
        if same {
            continue;
        }
        assert!(!report.table().is_empty());
        let page = html::page(&report, &report, image, test).expect("a page");
        assert!(page.starts_with(b"<!DOCTYPE html>"));
        if let Ok(difference) = difference(image, test) {
            difference.encode().ok();
        }
        heatmap::heatmap(image, test, &settings.choice, heatmap::DEFAULT_MAX).ok();
    }
}
