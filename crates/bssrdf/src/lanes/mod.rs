//! The models in float32, sixteen samples at a time.
//!
//! Every length is taken in units of `1/σ_t'`, which makes the diffusion coefficient of the dipoles 1/3 and leaves only
//! `α'`, `η` and `σ_t'/σ_t` (docs/method.md section 8). The float64 models of this crate are the reference.

pub(crate) mod block;
pub(crate) mod distances;
mod entry;
pub(crate) mod exp;

pub use crate::model::{BetterLanes, DirectionalLanes, HalfSpaceLanes, StandardLanes};
pub use block::{Block, LANES, Lane, LaneModel};
pub use entry::{Directions, Entered, EntryRefraction};
pub use exp::exp_negative;
