//! The scenes of `data/`, each built from a few numbers.
//!
//! Every file has the same bytes on every run and machine: the shapes use only sums, products, quotients and square
//! roots, which IEEE 754 rounds alike everywhere, and numbers that look
//! random are products of integers, and no order depends on a hash. The files can therefore be committed,
//! and a byte that changes means that the scene has changed.
//!
//! ```
//! let slab = make_scenes::slab::scene();
//! let bytes = make_scenes::glb::encode(&slab);
//! assert!(bytes.starts_with(b"glTF"));
//! ```

pub mod candle;
pub mod chess;
pub mod field;
pub mod figure;
pub mod fruit;
pub mod glb;
pub mod gummies;
pub mod lattice;
pub mod mesh;
pub mod milk;
pub mod noise;
pub mod panorama;
pub mod peach;
pub mod peel;
pub mod piglet;
pub mod scene;
pub mod sculpture;
pub mod sky;
pub mod slab;
pub mod slivers;
pub mod soft_boxes;
pub mod sphere;
pub mod studio;
pub mod surface_nets;
pub mod turned;

use scene::Scene;

/// Every scene: first those for tests, then those of the gallery.
pub fn all() -> Vec<Scene> {
    vec![
        slab::scene(),
        sphere::scene(),
        slivers::scene(),
        figure::scene(),
        gummies::scene(),
        chess::scene(),
        piglet::scene(),
        candle::scene(),
        milk::scene(),
        peach::scene(),
    ]
}

/// The scenes, built once for all tests, which only read them.
#[cfg(test)]
static SCENES: std::sync::LazyLock<Vec<Scene>> = std::sync::LazyLock::new(all);
