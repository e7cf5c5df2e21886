//! Do samplers follow their densities, and are means right? Every test names the planted errors that it was seen to
//! catch.
//!
//! Seeds are fixed: a test that passed once passes always. Were they drawn anew, a correct program would fail one of
//! the decisions once in a thousand runs (`test_support::FALSE_ALARM_RATE`). The feature `slow` runs the same
//! statistics with more samples.

mod blends;
mod bounce;
mod calibration;
mod cut;
mod edges;
mod environment;
mod error_bars;
mod glossy;
mod half_space;
mod knob;
mod lens;
mod means;
mod near_field;
mod objects;
mod paths;
mod patterns;
mod picks;
mod reference;
mod reflectance;
mod rough;
mod roulette;
mod sampling;
mod shards;
mod slab;
mod spread;
mod stripes;
mod textures;
mod walls;
