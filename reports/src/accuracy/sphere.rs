//! A sphere under parallel light, seen from afar: brute-force scattering beside the models.

use bssrdf::{Coefficients, DVec3, Medium, fresnel};
use gather::estimator::{Estimator, Rule};
use glam::DVec2;
use rayon::prelude::*;
use scene::{
    Camera,
    random::{Purpose, Stream},
};
use std::f64::consts::{PI, TAU};
use test_support::pipeline::{Lit, Point};
use walks::{Crossing, Domain, End, Exit, Flight, Matter, Sequence, Start, walk};

/// Side of the image, pixels; the sphere fills it.
pub const SIDE: usize = 48;

/// Half width of the band of exit directions that count, about the cone around the light through the viewer, rad. By
/// the symmetry of sphere and light, every direction of that cone is equivalent to the viewer's after a rotation
/// about the light.
const BAND: f64 = 0.03;

/// The scene: radius in m, unit direction towards the light, irradiance across it in W/m², orthographic camera.
#[derive(Clone, Debug)]
pub struct Setting {
    pub radius: f64,
    pub to_light: DVec3,
    pub irradiance: f64,
    pub camera: Camera,
}

/// Scattered radiance of each pixel, one channel, W/(m² sr).
pub type Plane = Vec<f64>;

impl Setting {
    fn to_viewer(&self) -> DVec3 {
        -self.camera.forward
    }

    /// Image coordinates in [−1, 1] of a point of the unit sphere, y downwards.
    fn project(&self, p: DVec3) -> DVec2 {
        DVec2::new(p.dot(self.camera.right), -p.dot(self.camera.up))
    }

    /// The unit normal at image coordinates in [−1, 1]; none beside the sphere.
    fn normal(&self, q: DVec2) -> Option<DVec3> {
        let depth = 1.0 - q.length_squared();
        (depth > 0.0).then(|| q.x * self.camera.right - q.y * self.camera.up + depth.sqrt() * self.to_viewer())
    }

    /// The unit normal at the center of a pixel.
    pub fn pixel_normal(&self, index: usize) -> Option<DVec3> {
        let center = DVec2::new((index % SIDE) as f64 + 0.5, (index / SIDE) as f64 + 0.5);
        self.normal(center * (2.0 / SIDE as f64) - DVec2::ONE)
    }

    /// The exit point turned about the light, to the two azimuths (by the mirror symmetry) at which its direction is
    /// the viewer's.
    fn turned(&self, point: DVec3, direction: DVec3) -> [DVec3; 2] {
        let z = self.to_light;
        let flat = |v: DVec3| (v - v.dot(z) * z).normalize_or_zero();
        let x = flat(self.to_viewer());
        let y = z.cross(x);
        let along = flat(direction);
        let (cos, sin) = (along.dot(x), along.dot(y));
        let (px, py) = (point.dot(x), point.dot(y));
        let (qx, qy) = (cos * px + sin * py, cos * py - sin * px);
        [qy, -qy].map(|qy| x * qx + y * qy + z * point.dot(z))
    }
}

/// Follows `photons` through the sphere, one channel; light that was never scattered does not count.
pub fn brute_force(setting: &Setting, medium: &Medium, channel: usize, photons: u64, seed: u64) -> Plane {
    const PORTION: u64 = 20_000;
    let c = medium.channels[channel];
    let in_radii = |sigma: f64| sigma * setting.radius;
    let c = Coefficients { sigma_a: in_radii(c.sigma_a), sigma_s: in_radii(c.sigma_s), ..c };
    let Some(matter) = Matter::new(&c, medium.eta) else { return vec![0.0; SIDE * SIDE] };
    let stream = Stream::new(seed, Purpose::LightWalk);
    let portion = |index: u64| {
        let mut sums = vec![0.0; SIDE * SIDE];
        for photon in index * PORTION..(index + 1) * PORTION {
            if let Some(exit) = exit(setting, &matter, &mut Sequence::new(stream.item(photon))) {
                record(setting, &exit, &mut sums);
            }
        }
        sums
    };
    let portions: Vec<Vec<f64>> = (0..photons.div_ceil(PORTION)).into_par_iter().map(portion).collect();
    let mut plane = vec![0.0; SIDE * SIDE];
    for sums in portions {
        plane.iter_mut().zip(sums).for_each(|(sum, weight)| *sum += weight);
    }
    let angle = setting.to_light.angle_between(setting.to_viewer());
    let solid_angle = TAU * ((angle - BAND).cos() - (angle + BAND).cos());
    let pixel_area = (2.0 * setting.radius / SIDE as f64).powi(2);
    let sent = (photons.div_ceil(PORTION) * PORTION) as f64;
    let power = setting.irradiance * PI * setting.radius * setting.radius / sent;
    // Each exit was recorded twice, mirrored.
    let scale = 0.5 * power / (pixel_area * solid_angle);
    plane.iter_mut().for_each(|x| *x *= scale);
    plane
}

fn record(setting: &Setting, exit: &Exit, sums: &mut [f64]) {
    let angle = setting.to_light.angle_between(setting.to_viewer());
    if (setting.to_light.angle_between(exit.direction) - angle).abs() > BAND {
        return;
    }
    for p in setting.turned(exit.position, exit.direction) {
        let q = (setting.project(p) + DVec2::ONE) * (0.5 * SIDE as f64);
        let (x, y) = (q.x.floor(), q.y.floor());
        if x >= 0.0 && y >= 0.0 && x < SIDE as f64 && y < SIDE as f64 {
            sums[y as usize * SIDE + x as usize] += exit.weight;
        }
    }
}

/// The space inside the unit sphere.
struct Ball;

impl Domain for Ball {
    fn clearance(&self, position: DVec3) -> f64 {
        (1.0 - position.length()).max(0.0)
    }

    fn crossing(&self, flight: &mut Flight, limit: f64) -> Crossing {
        let (point, direction) = (flight.position, flight.direction);
        let half = point.dot(direction);
        let distance = -half + (half * half - point.length_squared() + 1.0).max(0.0).sqrt();
        if distance >= limit {
            return Crossing::Free;
        }
        Crossing::Boundary { distance, face: 0, normal: (point + direction * distance).normalize() }
    }
}

/// Where light leaves after scattering; lengths in radii.
fn exit(setting: &Setting, matter: &Matter, random: &mut Sequence) -> Option<Exit> {
    let (x, y) = setting.to_light.any_orthonormal_pair();
    let (b, a) = (TAU * random.uniform()).sin_cos();
    let r = random.uniform().sqrt();
    let position = x * (r * a) + y * (r * b) + setting.to_light * (1.0 - r * r).sqrt();
    let entry = fresnel::enter(position.normalize(), setting.to_light, matter.eta)?;
    if random.uniform() >= entry.transmittance {
        return None;
    }
    let start = Start { position, direction: entry.direction, face: Some(0) };
    match walk(&Ball, matter, &start, random, |_, _| ()) {
        End::Scattered(exit) => Some(exit),
        _ => None,
    }
}

/// `T21 L_r` of a cloud of the same sphere in each pixel, three channels; the mean over a few points a pixel.
pub fn model(setting: &Setting, lit: &Lit, eta: f64) -> [Plane; 3] {
    const POINTS: usize = 3;
    let at = |k: usize| (k as f64 + 0.5) / POINTS as f64;
    let pixel = |index: usize| {
        let corner = DVec2::new((index % SIDE) as f64, (index / SIDE) as f64);
        let mut sum = DVec3::ZERO;
        for point in 0..POINTS * POINTS {
            let offset = DVec2::new(at(point % POINTS), at(point / POINTS));
            let Some(normal) = setting.normal((corner + offset) * (2.0 / SIDE as f64) - DVec2::ONE) else { continue };
            let exit = fresnel::transmittance(normal.dot(setting.to_viewer()), eta);
            let point = Point { position: normal * setting.radius, normal };
            sum += exit * lit.radiance(Estimator::Roulette(Rule::Mixture), point, index as u64);
        }
        sum / (POINTS * POINTS) as f64
    };
    let pixels: Vec<DVec3> = (0..SIDE * SIDE).into_par_iter().map(pixel).collect();
    [0, 1, 2].map(|c| pixels.iter().map(|p| p[c]).collect())
}
