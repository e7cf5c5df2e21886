//! Phase one: a scene's lit surface as a point cloud.
//!
//! [`Plan`] decides which surfaces are sampled and what the cloud's identity is; [`sample()`] draws the samples: a
//! triangle ([`TriangleChoice`]), a point on it, a direction towards the light, and the flux that arrives ([`draw`]).
//! [`hierarchy`] orders them and builds the tree over them. The samples depend on no camera and no medium, so that one
//! cloud serves all of them; only [`Search`] knows a medium, and uses it to choose the number of samples.
//!
//! ```
//! use formats::cloud::{Choice, LightUnit, Normals, Options, Pattern, Shard};
//! use sample_surface::{Plan, Settings, Surfaces, sample};
//! use scene::{ImportOptions, Rays, Scene};
//!
//! let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/scenes/slab.glb");
//! let unit = scene::LightUnit::Radiometric;
//! let import =
//!     ImportOptions { metres_per_unit: 1.0, light_unit: Some(unit), emission_unit: Some(unit), pose: None };
//! let scene = Scene::import(file.as_ref(), &import)?;
//! let options = Options {
//!     seed: 0,
//!     shard: Shard::ALONE,
//!     choice: Choice::Area,
//!     pattern: Pattern::Stratified,
//!     shares: Vec::new(),
//!     normals: Normals::Shading,
//!     metres_per_unit: 1.0,
//!     light_unit: LightUnit::Radiometric,
//!     emission_unit: LightUnit::Radiometric,
//!     pose: String::new(),
//!     environment: "0,0,0".into(),
//! };
//! let settings = Settings { samples: 1000, options };
//! let (surfaces, _) = Surfaces::translucent(&scene)?;
//! let plan = Plan::new(&scene, &settings, surfaces)?;
//! let rays = Rays::of_scene(&scene, |material| plan.samples(material));
//! let cloud = sample(&scene, &rays, &settings, &plan, |_| ())?;
//! assert_eq!(cloud.meta.samples_drawn, 1000);
//! assert!(cloud.content.samples > 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod adaptive_count;
mod choice;
pub mod hierarchy;
mod hilbert;
mod pattern;
mod plan;
mod points;
mod portions;
mod ribbon;
mod sample;
mod trials;

pub use adaptive_count::{Round, Search, SufficientCloud};
pub use choice::{Choice, Chosen, TriangleChoice};
pub use pattern::{Numbers, Pattern, SamplePoint};
pub use plan::{Plan, SampleError, Settings, Surfaces};
pub use points::Goal;
pub use portions::{Sampled, sample};
pub use sample::{SampleOutcome, draw};
pub use trials::{TRIALS, Trials};
