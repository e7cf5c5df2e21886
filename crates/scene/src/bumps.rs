//! Normal maps: the normals of bumps that the mesh does not have (docs/method.md section 19).
//!
//! The bumps tilt the normal that cosines are taken with. Light below the surface sees the smooth surface: its samples keep
//! the smooth normal, and the flux that falls on them is that on the bumps.

use crate::texture::Texture;
use glam::{DVec2, DVec3, Vec3};

/// A picture of normals, in the frame of tangent, bitangent and normal.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalMap {
    texture: Texture,
    /// Factor of the components along the surface.
    scale: f64,
    /// Root mean square slope of the bumps along one direction.
    slope: f64,
}

/// The normal maps of a mesh.
#[derive(Clone, Debug, Default)]
pub struct Bumps {
    /// The normal map of each material.
    pub(crate) maps: Vec<Option<NormalMap>>,
    /// Texture coordinates of the vertices; vertices at the end may have none.
    pub(crate) coordinates: Vec<[f32; 2]>,
    /// For each triangle, the frames of its corners.
    pub(crate) frames: Vec<[Frame; 3]>,
}

/// The frame of a normal map at a corner of a triangle, beside the normal there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Frame {
    /// Where `u` grows; 0 if that is unknown.
    pub tangent: Vec3,
    /// The bitangent, which points up in the picture, is this times `normal × tangent`: 1, or -1 where the picture is
    /// mirrored.
    pub sign: f32,
}

/// A place on a mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub triangle: u32,
    pub vertices: [u32; 3],
    pub material: u16,
    /// Barycentric weights of the vertices.
    pub weights: [f64; 3],
}

/// The bumps at a point, as far as they change how much light falls on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bump {
    /// Area of the bumpy surface over that of the smooth one.
    stretch: f64,
    /// Root mean square slope of all bumps.
    slope: f64,
}

/// The code for 0 and how many codes there are to 1. The specification has 127.5 for both, which no picture of eight bits
/// can state: a flat picture would tilt all normals.
const ZERO: f64 = 128.0;
const ONE: f64 = 127.0;

/// Steeper bumps do not stretch the surface more than this, so that few samples do not carry most of the light.
const MAX_STRETCH: f64 = 4.0;

impl Default for Bump {
    fn default() -> Self {
        Bump { stretch: 1.0, slope: 0.0 }
    }
}

impl Bump {
    /// The factor of the irradiance of the tilted normal with which the bumps get, on average, the light that falls on
    /// the smooth surface, for light whose cosine to the smooth normal is `cosine` (docs/method.md 19.2).
    pub fn gain(self, cosine: f64) -> f64 {
        if self.slope == 0.0 {
            return self.stretch;
        }
        if cosine <= 0.0 {
            return 0.0;
        }
        self.stretch * unshadowed(cosine / (self.slope * 2f64.sqrt() * (1.0 - cosine * cosine).max(0.0).sqrt()))
    }
}

/// The share of a rough surface of normally distributed slopes that light reaches, at `a = cot θ/(√2 σ)`: Smith 1967, as
/// the rational fit of Walter, Marschner, Li and Torrance 2007 (docs/method.md 19.3).
fn unshadowed(a: f64) -> f64 {
    if a < 1.6 { (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a) } else { 1.0 }
}

impl NormalMap {
    pub fn new(texture: Texture, scale: f64) -> NormalMap {
        let mut map = NormalMap { texture, scale, slope: 0.0 };
        let texels = &map.texture.picture.texels;
        let square = |texel: &[u8; 4]| {
            let normal = map.decoded(texel.map(f64::from)[..3].try_into().expect("three of four"));
            let flat = normal.truncate() / normal.z.max(1.0 / MAX_STRETCH);
            0.5 * flat.length_squared()
        };
        map.slope = (texels.iter().map(square).sum::<f64>() / texels.len() as f64).sqrt();
        map
    }

    pub fn texture(&self) -> &Texture {
        &self.texture
    }

    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The unit normal at texture coordinates, along tangent, bitangent and normal.
    fn at(&self, coordinates: DVec2) -> DVec3 {
        self.decoded(self.texture.codes_at(coordinates.to_array()).truncate().to_array())
    }

    fn decoded(&self, codes: [f64; 3]) -> DVec3 {
        let [x, y, z] = codes.map(|code| (code - ZERO) / ONE);
        DVec3::new(x * self.scale, y * self.scale, z).try_normalize().unwrap_or(DVec3::Z)
    }
}

impl Bumps {
    /// The normal of the bumps at a place where the smooth surface has the normal `smooth`, as it is interpolated and not
    /// normalized (docs/method.md 19.1), and the bumps; none if its material has no normal map, or that has no frame there.
    // Scenes without normal maps do not pay for this code where points are made.
    #[cold]
    #[inline(never)]
    pub(crate) fn tilted(&self, at: Place, smooth: DVec3) -> Option<(DVec3, Bump)> {
        let map = self.maps.get(usize::from(at.material)).and_then(Option::as_ref)?;
        let corners = self.frames.get(at.triangle as usize)?;
        let [a, b, c] = corners.map(|corner| corner.tangent.as_dvec3());
        let tangent = a * at.weights[0] + b * at.weights[1] + c * at.weights[2];
        if tangent.length_squared() < 1e-12 {
            return None;
        }
        let of =
            |i: u32| DVec2::from_array(self.coordinates.get(i as usize).copied().unwrap_or_default().map(f64::from));
        let [a, b, c] = at.vertices.map(of);
        let local = map.at(a * at.weights[0] + b * at.weights[1] + c * at.weights[2]);
        let bitangent = smooth.cross(tangent) * f64::from(corners[0].sign);
        let normal = (local.x * tangent + local.y * bitangent + local.z * smooth).try_normalize()?;
        Some((normal, Bump { stretch: 1.0 / local.z.max(1.0 / MAX_STRETCH), slope: map.slope }))
    }
}
