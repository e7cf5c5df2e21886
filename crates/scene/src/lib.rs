//! The scene: a triangle mesh, its lights and cameras, and rays through it.
//!
//! [`Scene::import`] reads a glTF file and checks it. [`Rays`] finds what a ray meets, and [`light`] chooses lights for
//! a point of the surface and tells what arrives there. Random numbers are pure functions of their index ([`random`]),
//! some of them well spread ([`sequence`]), and [`warp`] turns them into points and directions.
//!
//! The crate does not depend on scattering in media or on the rendering of images. After import, lengths are in metres.
//! Positions are float32 relative to [`Scene::origin`], the center of the mesh in float64: an object far from the
//! origin loses no digits.
//!
//! A triangle in the sun:
//!
//! ```
//! use scene::light::{DirectionalLight, Light, LightChoice, LightTree, Lit, ReceiverBounds, light_at};
//! use scene::{DVec3, Mesh, NormalKind, Rays, Triangle, Vec3};
//!
//! let mesh = Mesh {
//!     positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
//!     normals: vec![Vec3::ZERO; 3],
//!     triangles: vec![Triangle { vertices: [0, 1, 2], material: 0 }],
//!     ..Mesh::default()
//! };
//! let rays = Rays::new(&mesh);
//! let at = mesh.point(0, [0.25, 0.25, 0.5], NormalKind::Geometric);
//! let hit = rays.closest(at.position + DVec3::Z, DVec3::NEG_Z, None).expect("the ray meets the triangle");
//! assert!((hit.triangle, hit.distance) == (0, 1.0));
//!
//! let sun = DirectionalLight { direction: DVec3::new(0.0, 0.6, 0.8), irradiance: DVec3::splat(5.0) };
//! let lights = LightTree::new([&sun as &dyn Light]);
//! let choice = LightChoice::new(&lights, &ReceiverBounds::point(&at), 1);
//! let mut shadow_rays = 0;
//! let Lit::Light { irradiance, .. } = light_at(&choice, &rays, &at, [0.5; 3], &mut shadow_rays) else { panic!("lit") };
//! assert!((irradiance - DVec3::splat(4.0)).length() < 1e-12);
//! ```

mod bumps;
mod cutouts;
mod digest;
mod error;
mod framing;
pub mod import;
mod lens;
pub mod light;
mod material;
mod mesh;
mod mesh_defects;
mod panes;
pub mod random;
mod rays;
mod scene;
pub mod sequence;
mod surface_colors;
pub mod texture;
mod unhonoured;
mod view;
mod warnings;
pub mod warp;

pub use bumps::{Bump, Bumps, NormalMap};
pub use error::{LostVolumes, SceneError};
pub use framing::{Framing, Placed};
pub use glam::{DVec3, DVec4, Vec3};
pub use import::{FileUnits, ImportOptions, LightUnit, Pose};
pub use lens::{Aperture, FILM_HEIGHT, Focus, Lens};
pub use material::{Alpha, GlossStated, Material, Scatter, ScatterExtension, StatedMedium, Volume, Wall, WallShares};
pub use mesh::{Mesh, NormalKind, SurfacePoint, Triangle};
pub use mesh_defects::MeshDefects;
pub use rays::{Hit, Rays};
pub use scene::Scene;
pub use surface_colors::{SurfaceColors, TextureColor};
pub use view::{Camera, Projection, View, ViewFile};
