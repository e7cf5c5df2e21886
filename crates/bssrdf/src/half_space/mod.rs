//! The half-space model's two sources, and the table that corrects them: what the model shares with the program that
//! makes the table, `data/make-half-space-table`.

mod boundary;
mod images;
pub mod layout;
pub(crate) mod profile;
pub(crate) mod table;

pub(crate) use boundary::lobe_of;
pub use boundary::{critical_cosine, exit_lobe, exit_moment, reflection};
pub use images::{GRAZING, Images, SOFTNESS2, forwardness, transport};
