//! `scale.md`: what sampling and gathering cost in processor time, memory and files, from runs of many sizes; how well
//! that predicts runs of other sizes; and what it says of farms.

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

/// What the model is fitted to: each part of it weighs most in one of them.
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

/// What it is held against: within the range of the others, and beyond it.
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

/// What the model says beside what was measured.
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
    let verdict = format!("The worst of them is off by {worst}; of the runs that it was fitted to, by {own}.\n");
    format!("{}\n{verdict}", table(&["run", "what", "model", "measured", "off by"], &rows))
}

const HEAD: &str = "\
# Past one machine

Made by `make scale`; do not edit. `data/scenes/figure.glb` (its front view, skin1, all settings as they are by default) on \
one thread. The figure fills most of the middle square of an image; a wide one has floor and background beside it.

What a run costs is the sum of these. Seconds are of one processor, user and system.
";

const CHECK: &str = "\
The model against runs of other sizes than those it was fitted to (K of 100k to 10M, images up to 384 x 384, 4 to 64 paths a pixel):
";
