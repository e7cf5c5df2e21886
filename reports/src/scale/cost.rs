//! The cost of a run as a sum of parts, each in proportion to something known of the run.

use crate::{
    markdown::{count, table, three},
    scale::linear::Linear,
};

/// The size of a cloud and of a call of `gather` for `views` images of it, each at least as wide as high.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    pub samples: f64,
    pub width: u64,
    pub height: u64,
    pub spp: u64,
    pub views: u64,
}

impl Size {
    fn pixels(&self) -> f64 {
        (self.width * self.height * self.views) as f64
    }

    /// Pixels of the middle squares of all images, which hold the translucent object.
    fn inner(&self) -> f64 {
        (self.height * self.height * self.views) as f64
    }

    fn paths(&self) -> f64 {
        self.inner() * self.spp as f64
    }

    pub fn text(&self) -> String {
        let views = if self.views == 1 { String::new() } else { format!("{} views of ", self.views) };
        format!("K {}, {views}{} x {}, {} paths", count(self.samples as u64), self.width, self.height, self.spp)
    }
}

/// One cost of a run: its name, its unit, and its parts.
pub struct Figure {
    pub name: &'static str,
    pub unit: &'static str,
    /// Divisor that turns seconds or bytes into the unit.
    pub scale: f64,
    parts: &'static [Part],
}

/// A part of a cost: its name, and its amount in a run.
pub type Part = (&'static str, fn(&Size) -> f64);

const START: Part = ("start", |_| 1.0);
const SAMPLE: Part = ("sample", |size| size.samples);
const IMAGE: Part = ("image", |size| size.views as f64);
/// Background lies outside the middle square.
const PIXEL: Part = ("pixel", Size::pixels);
const PIXEL_OF_ONE: Part = ("pixel of one image", |size| (size.width * size.height) as f64);
const INNER: Part = ("pixel of the middle square", Size::inner);
const OUTER: Part = ("path beside the middle square", |size| (size.pixels() - size.inner()) * size.spp as f64);
/// Silhouette pixels trace more rays.
const EDGE: Part = ("path of a row of the middle square", |size| (size.height * size.views * size.spp) as f64);
const PATH: Part = ("path of the middle square", Size::paths);
const LEVEL: Part = ("such a path and doubling of K from 10k on", |size| size.paths() * (size.samples / 1e4).log2());
/// Refinement of the cut: the more paths a pixel has, the looser the accuracy of each.
const CUT: Part = ("such a path x (K / 10k)^(1/3) / (paths a pixel)^(3/4)", |size| {
    size.paths() * (size.samples / 1e4).cbrt() * (size.spp as f64).powf(-0.75)
});

pub const FIGURES: [Figure; 6] = [
    Figure { name: "sampling, processor", unit: "s", scale: 1.0, parts: &[START, SAMPLE] },
    Figure { name: "sampling, memory", unit: "MB", scale: 1e6, parts: &[START, SAMPLE] },
    Figure { name: "cloud, file", unit: "MB", scale: 1e6, parts: &[START, SAMPLE] },
    Figure {
        name: "gather, processor",
        unit: "s",
        scale: 1.0,
        parts: &[START, SAMPLE, IMAGE, PIXEL, OUTER, EDGE, PATH, LEVEL, CUT],
    },
    Figure { name: "gather, memory", unit: "MB", scale: 1e6, parts: &[START, SAMPLE, PIXEL_OF_ONE] },
    Figure { name: "images, files", unit: "MB", scale: 1e6, parts: &[IMAGE, INNER, PIXEL] },
];

/// The fitted costs of a run, in the order of `FIGURES`.
pub struct Model(Vec<Linear>);

impl Model {
    pub fn fit(measured: &[(Size, [f64; 6])]) -> Model {
        let fit = |k: usize| {
            let row = |(size, costs): &(Size, [f64; 6])| (FIGURES[k].amounts(size), costs[k]);
            Linear::fit(&measured.iter().map(row).collect::<Vec<_>>())
        };
        Model((0..FIGURES.len()).map(fit).collect())
    }

    /// Seconds of one processor, bytes of memory, bytes of the file.
    pub fn sampling(&self, size: &Size) -> [f64; 3] {
        [0, 1, 2].map(|k| self.at(k, size))
    }

    /// Seconds of one processor, bytes of memory (the mapped cloud included), bytes of all images.
    pub fn gather(&self, size: &Size) -> [f64; 3] {
        [3, 4, 5].map(|k| self.at(k, size))
    }

    pub fn at(&self, k: usize, size: &Size) -> f64 {
        self.0[k].at(&FIGURES[k].amounts(size))
    }

    pub fn table(&self) -> String {
        let mut rows = Vec::new();
        for (figure, fitted) in FIGURES.iter().zip(&self.0) {
            for ((part, _), c) in figure.parts.iter().zip(&fitted.coefficients) {
                let value =
                    if figure.unit == "s" { format!("{} µs", three(1e6 * c)) } else { format!("{} bytes", three(*c)) };
                rows.push(vec![figure.name.into(), (*part).into(), value]);
            }
        }
        table(&["cost", "of each", "is"], &rows)
    }
}

impl Figure {
    fn amounts(&self, size: &Size) -> Vec<f64> {
        self.parts.iter().map(|(_, amount)| amount(size)).collect()
    }
}
