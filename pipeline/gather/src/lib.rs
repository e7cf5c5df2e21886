//! Phase two: a cloud, media and a camera to an image.
//!
//! [`render`] follows camera paths through the interfaces of translucent objects to exitant points, where it sums the
//! cloud; [`Passes`] adds paths in passes, until an error target is met. No light is sampled for a translucent surface:
//! its light is that of the cloud. Pixels are rendered in parallel and each sum in a fixed order, so that the image is
//! the same for any number of threads.
//!
//! The example renders four pixels of a scene without a cloud, so that all of its surfaces are opaque.
//!
//! ```
//! use bssrdf::Model;
//! use gather::{Filter, Input, Settings, estimator::Estimator, render};
//! use scene::{ImportOptions, LightUnit, NormalKind, Rays, Scene};
//!
//! let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/scenes/slab.glb");
//! let unit = LightUnit::Radiometric;
//! let import =
//!     ImportOptions { metres_per_unit: 1.0, light_unit: Some(unit), emission_unit: Some(unit), pose: None };
//! let scene = Scene::import(file.as_ref(), &import)?;
//! let rays = Rays::of_scene(&scene, |_| false);
//! let settings = Settings {
//!     width: 2,
//!     height: 2,
//!     crop: None,
//!     paths_per_pixel: 4,
//!     filter: Filter::Box,
//!     estimator: Estimator::Exhaustive,
//!     balances: false,
//!     model: Model::DirectionalDipole,
//!     near_field: true,
//!     reference: false,
//!     normals: NormalKind::Shading,
//!     max_depth: 16,
//!     seed: 0,
//!     backdrop: None,
//! };
//! let input = Input { scene: &scene, rays: &rays, clouds: &[], media: &[], tints: &[], calibration: None, camera: &scene.cameras[0] };
//! let rendered = render(&input, &settings, |_| ());
//! assert_eq!((rendered.pixels.len(), rendered.counts.paths), (4, 16));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod allotment;
mod balance;
pub mod counts;
mod crop;
mod cut_correction;
mod edge;
pub mod errors;
pub mod exposure;
pub mod film;
mod freedom;
mod glossy;
mod highlights;
mod image;
mod known;
mod lobes;
mod meeting;
mod mirrors;
mod objects;
mod passes;
mod path;
pub mod path_state;
mod pixel_numbers;
mod pixel_sum;
pub mod preview;
mod reference;
pub mod renderer;
mod seen;
mod shared;
mod state;
mod subsurface;
mod walked;
mod wall;
mod watch;

pub use balance::unmeasured as accuracy_of_unknown_noise;
pub use crop::Crop;
pub use image::{Filter, Input, Rendered, Settings};
pub use passes::{Passes, render};
pub use shared::can_share;
pub use state::State;
pub use sums::{Summation, estimator, samples};
pub use watch::{Tile, Watch};
