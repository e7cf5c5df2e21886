//! Do samplers follow their densities, and are means right? Every test names the planted errors that it was seen to
//! catch.
//!
//! Seeds are fixed: a test that passed once passes always. Were they drawn anew, a correct program would fail one of
//! the decisions once in a thousand runs (`support::FALSE_ALARM_RATE`). The feature `slow` runs the same statistics
//! with more samples.

#[path = "statistics/bounce.rs"]
mod bounce;
#[path = "statistics/cut.rs"]
mod cut;
#[path = "statistics/edges.rs"]
mod edges;
#[path = "statistics/environment.rs"]
mod environment;
#[path = "statistics/error_bars.rs"]
mod error_bars;
#[path = "statistics/knob.rs"]
mod knob;
#[path = "statistics/means.rs"]
mod means;
#[path = "statistics/objects.rs"]
mod objects;
#[path = "statistics/paths.rs"]
mod paths;
#[path = "statistics/patterns.rs"]
mod patterns;
#[path = "statistics/picks.rs"]
mod picks;
#[path = "statistics/reflectance.rs"]
mod reflectance;
#[path = "statistics/roulette.rs"]
mod roulette;
#[path = "statistics/sampling.rs"]
mod sampling;
#[path = "statistics/shards.rs"]
mod shards;
#[path = "statistics/slab.rs"]
mod slab;
#[path = "statistics/spread.rs"]
mod spread;
