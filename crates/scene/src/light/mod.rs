//! Lights: their contract, the choice of one among many, and the light that arrives at a point of the surface.

mod area;
mod bounce;
mod bounds;
mod choice;
pub(crate) mod contract;
mod cosine_importance;
mod direct;
mod direction_cone;
mod directional;
pub(crate) mod environment;
mod environment_map;
mod glow;
mod hierarchical_sampler;
mod point;
mod texel_sums;
mod tree;

pub use area::AreaLight;
pub use bounce::{Bounce, LitSurface, reflected};
pub use bounds::{LightBounds, ReceiverBounds};
pub use choice::{LightChoice, Pick};
pub use contract::{Delta, Illumination, Light};
pub use direct::{Lit, Reflected, all_light_at, all_lights_at, light_at};
pub use direction_cone::DirectionCone;
pub use directional::DirectionalLight;
pub use environment::Environment;
pub use environment_map::{EnvironmentMap, MapError};
pub use point::{PointLight, Spot};
pub use tree::LightTree;
