//! The half-space model's two sources, and the table that corrects them: what the model shares with the program that
//! makes the table, `data/make-half-space-table`.

mod boundary;
mod images;
pub mod layout;
pub(crate) mod profile;
mod table;

pub use boundary::{critical_cosine, exit_moment, reflection};
pub use images::{GRAZING, Images, SOFTNESS2, forwardness, transport};

/// The mean cosine, outside, of the light that leaves a half-space; `absorbed` is `1 − α'`.
pub fn mean_cosine(absorbed: f64, eta: f64) -> f64 {
    table::Corrections::new(absorbed, eta).cosine
}
