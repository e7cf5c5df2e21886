//! `scale.md`: the cost of sampling and gathering in processor time, memory and files, from runs of many sizes; how
//! well a model of it predicts runs of other sizes; and a forecast for farms.

mod cost;
mod forecast;
mod linear;
mod runs;

use crate::{
    error::Error,
    markdown::{percent, table, three},
};
use cost::{FIGURES, Model, Size};
use runs::Farm;
use std::path::Path;

const fn size(samples: f64, [width, height]: [u64; 2], spp: u64, views: u64) -> Size {
    Size { samples, width, height, spp, views }
}

/// Runs that the model is fitted to: each part of it dominates one of them.
const FITTED: [Size; 16] = [
    size(1e5, [16, 16], 4, 1),
    size(1e5, [16, 16], 4, 40),
    size(1e5, [192, 192], 4, 1),
    size(1e5, [192, 192], 64, 1),
    size(3e5, [256, 256], 4, 1),
    size(3e5, [64, 64], 16, 10),
    size(1e5, [1024, 64], 64, 1),
    size(1e6, [64, 64], 4, 10),
    size(1e6, [192, 192], 16, 1),
    size(1e6, [384, 384], 4, 1),
    size(3e6, [16, 16], 4, 1),
    size(3e6, [192, 192], 64, 1),
    size(1e7, [16, 16], 4, 1),
    size(1e7, [192, 192], 4, 1),
    size(1e7, [192, 192], 16, 1),
    size(1e7, [128, 128], 64, 1),
];

/// Runs that the model is tested with, inside the range of the others and beyond it.
const CHECKED: [Size; 3] = [size(2e5, [200, 150], 8, 12), size(2e6, [512, 384], 4, 1), size(2e7, [800, 450], 16, 1)];

/// Measures, and returns the text of `scale.md`.
pub fn document(programs: &Path, data: &Path) -> Result<String, Error> {
    let farm = Farm::new(programs, data)?;
    let measure = |sizes: &[Size]| -> Result<Vec<(Size, [f64; 6])>, Error> {
        sizes.iter().map(|size| Ok((*size, farm.mean(size)?))).collect()
    };
    let (fitted, checked) = (measure(&FITTED)?, measure(&CHECKED)?);
    let model = Model::fit(&fitted);
    Ok(format!(
        "{HEAD}\n{}\n{CHECK}\n{}\n{}",
        model.table(),
        comparison(&model, &fitted, &checked),
        forecast::text(&model)
    ))
}

/// A table of predicted and measured costs.
fn comparison(model: &Model, fitted: &[(Size, [f64; 6])], checked: &[(Size, [f64; 6])]) -> String {
    let error = |size: &Size, costs: &[f64; 6], k: usize| model.at(k, size) / costs[k] - 1.0;
    let mut rows = Vec::new();
    for (size, costs) in checked {
        for (k, figure) in FIGURES.iter().enumerate() {
            let said = [model.at(k, size), costs[k]].map(|x| format!("{} {}", three(x / figure.scale), figure.unit));
            let mut row = vec![size.text(), figure.name.into()];
            row.extend(said);
            row.push(percent(error(size, costs, k)));
            rows.push(row);
        }
    }
    let all = |runs: &[(Size, [f64; 6])]| {
        let errors = runs.iter().flat_map(|(size, costs)| (0..FIGURES.len()).map(move |k| error(size, costs, k).abs()));
        errors.fold(0.0, f64::max)
    };
    let (worst, own) = (percent(all(checked)), percent(all(fitted)));
    let verdict = format!("The largest error is {worst}; among the runs that the model was fitted to it is {own}.\n");
    format!("{}\n{verdict}", table(&["run", "what", "model", "measured", "off by"], &rows))
}

const HEAD: &str = "\
# Sizes and farms

Made by `make scale`; do not edit. The scene is `data/scenes/figure.glb` (its front view, skin1, all settings at their defaults) \
on one thread. The figure fills most of the middle square of an image; a wider image has floor and background beside it.

The cost of a run is the sum of the following parts. Seconds are of one processor, user and system.
";

const CHECK: &str = "\
The model against runs of other sizes than those that it was fitted to (K of 100k to 10M, images up to 384 x 384, 4 to 64 paths a pixel):
";
