//! Random walks of light below a dielectric boundary, smooth or rough: the exact solution that BSSRDFs approximate
//! (docs/method.md section 14).
//!
//! A [`walk`] needs a [`Domain`], the space that the medium fills: a [`Solid`] is the inside of a mesh, a [`Slab`] a
//! slab or a half-space. [`Matter`] is one channel of a medium. Walks start below the boundary, are scattered after
//! Henyey and Greenstein, are reflected inside by a [`Boundary`] with the normals of the triangles, and end where they
//! leave ([`End`]). It is [`Smooth`], of Fresnel's equations, or [`Rough`].
//!
//! What a half-space of isotropic scatterers reflects:
//!
//! ```
//! use bssrdf::Coefficients;
//! use scene::{DVec3, random::{Purpose, Stream}};
//! use walks::{End, Matter, Sequence, Slab, Start, walk};
//!
//! let coefficients = Coefficients { sigma_a: 100.0, sigma_s: 900.0, asymmetry: 0.0 };
//! let matter = Matter::new(&coefficients, 1.0).expect("it scatters");
//! let half_space = Slab { thickness: f64::INFINITY };
//! let start = Start { position: DVec3::ZERO, direction: DVec3::Z, face: Some(Slab::FRONT) };
//! let stream = Stream::new(0, Purpose::LightWalk);
//! let reflected: f64 = (0..10_000)
//!     .map(|k| match walk(&half_space, &matter, &start, &mut Sequence::new(stream.item(k)), |_, _| ()) {
//!         End::Scattered(exit) => exit.weight,
//!         _ => 0.0,
//!     })
//!     .sum();
//! // 1 − H(1)√(1 − 0.9) = 0.415 (Chandrasekhar 1950).
//! assert!((reflected / 10_000.0 - 0.415).abs() < 0.02);
//! ```

mod beams;
mod boundary;
mod cells;
mod clearance;
mod connect;
mod domain;
mod facet;
mod lamps;
mod matter;
mod phase;
mod random;
mod reflections;
mod refraction;
mod roughness;
mod solid;
mod walk;

pub use beams::{Arrival, Beams};
pub use boundary::{Boundary, Meeting, Passage, Rough, Smooth};
pub use connect::Connections;
pub use domain::{Crossing, Domain, Flight, Leg, Slab};
pub use lamps::{Lamps, Left};
pub use matter::Matter;
pub use phase::{density, scatter};
pub use random::{FIRST, Sequence};
pub use roughness::Roughness;
pub use solid::{Solid, entered};
pub use walk::{Collision, End, Exit, MAX_REFLECTIONS, Observer, Start, observed_walk, walk};
