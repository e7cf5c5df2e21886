//! Images must not change, or must change in a known way, when a scene is described differently: other units, another
//! position or orientation, its mirror image, other triangles for the same surface, other lights.
//!
//! All tests render the figure of `data/scenes`, whose glTF document they edit: 38 000 triangles, spot lights and a
//! point light, a perspective camera, an opaque floor. Where both scenes have the same samples up to rounding, their
//! pixels are compared; each tolerance has its reason beside it. Where the samples differ, means over clouds are
//! compared, as in `statistics`. Every test names the planted errors that it was seen to catch.

mod expected;
mod figure;
mod lights;
mod mirror;
mod parts;
mod picture;
mod position;
mod scale;
mod tessellation;
mod unseen;
