//! How a BSSRDF varies with the distance between the points. The cut opens nodes by these tables; its efficiency
//! depends on them, its mean does not.

use bssrdf::{Bssrdf, DVec3, Medium, Separation, fresnel};
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// The tables are indexed by the bits of a float32 above this one: sixteen steps for each doubling of the squared
/// distance.
const SHIFT: u32 = 19;
const ENTRIES: usize = 1 << (32 - 1 - SHIFT);

/// Tables over the squared distance, m², of all float32 values: means over the channels, and over normals at the
/// exitant point. The normals matter only in nearly clear media, where the directional dipole has a pole for light that
/// passes the exitant point at a grazing angle.
#[derive(Clone, Debug)]
pub struct FalloffTables {
    /// Mean of `S_bare`, 1/(m² sr).
    pub value: Table,
    /// The largest `value` from this distance on.
    pub peak: Table,
    /// Mean of `value` over a disc of this squared radius around the exitant point, 1/(m² sr).
    pub disc: Table,
    /// Standard deviation over samples, divided by the root mean square of their distances from their mean, 1/(m³ sr).
    /// It never grows with the distance.
    pub slope: Table,
    /// Standard deviation over diffuse directions of light, 1/(m² sr).
    pub scatter: Table,
}

/// A number for each step of the squared distance.
#[derive(Clone, Debug)]
pub struct Table(Box<[f32; ENTRIES]>);

impl Table {
    #[inline(always)]
    pub fn at(&self, distance_squared: f32) -> f32 {
        self.0[(distance_squared.to_bits() >> SHIFT) as usize & (ENTRIES - 1)]
    }
}

/// The entries of the tables at one distance.
#[derive(Clone, Copy, Debug, Default)]
struct Variation {
    value: f64,
    slope: f64,
    scatter: f64,
}

impl FalloffTables {
    /// `size` is that of the surface, m: over shorter distances it is nearly a plane. A surface of infinite size is
    /// one.
    pub fn new(medium: &Medium, model: &dyn Bssrdf, size: f64) -> FalloffTables {
        let table = || Table(Box::new([0.0; ENTRIES]));
        let mut tables =
            FalloffTables { value: table(), peak: table(), disc: table(), slope: table(), scatter: table() };
        let (nearest, farthest) = distances(medium, model);
        let variations = variations(model, &directions(medium.eta), nearest, farthest, size);
        let (mut slope, mut peak) = (0.0f64, 0.0f64);
        for k in (0..ENTRIES).rev() {
            let distance = f64::from(middle(k)).sqrt();
            if distance > farthest || !distance.is_finite() {
                continue;
            }
            let here = interpolate(&variations, (distance / nearest).ln() / STEP.ln());
            (slope, peak) = (slope.max(here.slope), peak.max(here.value));
            (tables.value.0[k], tables.scatter.0[k]) = (here.value as f32, here.scatter as f32);
            (tables.slope.0[k], tables.peak.0[k]) = (slope as f32, peak as f32);
        }
        tables.average();
        tables
    }

    /// Fills `disc` with `∫ S 2πr dr/(πR²)`, the mean over the squared distance.
    fn average(&mut self) {
        let mut sum = 0.0;
        for k in 0..ENTRIES {
            let (from, to) = (f64::from(start(k)), f64::from(start(k + 1)));
            if to.is_finite() && to > 0.0 {
                sum += f64::from(self.value.0[k]) * (to - from);
                self.disc.0[k] = (sum / to) as f32;
            }
        }
    }
}

/// The squared distance where a table's step begins.
fn start(index: usize) -> f32 {
    f32::from_bits((index as u32) << SHIFT)
}

/// The squared distance in the middle of a table's step.
fn middle(index: usize) -> f32 {
    f32::from_bits((index as u32) << SHIFT | 1 << (SHIFT - 1))
}

/// The range of distances for which the model is evaluated, m: from a thousandth of the shortest transport mean free
/// path to where the channel of the smallest `σ_tr` has vanished.
fn distances(medium: &Medium, model: &dyn Bssrdf) -> (f64, f64) {
    let scattering = medium.channels.iter().filter(|c| c.scatters());
    let shortest = scattering.map(|c| 1.0 / c.reduced_extinction()).fold(f64::INFINITY, f64::min);
    let transport = model.transport().into_iter().filter(|t| *t > 0.0).fold(f64::INFINITY, f64::min);
    let farthest = if transport.is_finite() { 200.0 / transport } else { f64::INFINITY };
    (1e-3 * shortest, farthest.min(1e4 * shortest.max(1.0 / transport)))
}

/// Refracted directions of diffuse light from four angles at each of eight azimuths.
fn directions(eta: f64) -> [Vec<DVec3>; 8] {
    std::array::from_fn(|azimuth| {
        let (sine, cosine) = (PI / 4.0 * azimuth as f64).sin_cos();
        let light = |k: usize| {
            let squared = (k as f64 + 0.5) / 4.0;
            let across = (1.0 - squared).sqrt();
            DVec3::new(across * cosine, across * sine, squared.sqrt())
        };
        (0..4).filter_map(|k| fresnel::enter(DVec3::Z, light(k), eta)).map(|e| e.direction).collect()
    })
}

/// The normals at the exitant point over which the tables are a mean: that of a plane, and four perpendicular to it,
/// each at 45 degrees to the offset.
fn normals() -> [DVec3; 5] {
    let slant = FRAC_1_SQRT_2;
    let across = |x: f64, y: f64| DVec3::new(slant * x, slant * y, 0.0);
    [DVec3::Z, across(1.0, 1.0), across(-1.0, 1.0), across(-1.0, -1.0), across(1.0, -1.0)]
}

/// The share of the normals other than a plane's at a distance of the surface's size. It is proportional to the
/// distance, since a surface is nearly a plane around any point.
const CURVED: f64 = 0.5;

/// `S_bare` of one channel for each direction, where the offset is perpendicular to the normal at the point of entry.
fn values(
    model: &dyn Bssrdf,
    channel: usize,
    distance: f64,
    normal_out: DVec3,
    directions: &[Vec<DVec3>; 8],
) -> Vec<f64> {
    let value = |refracted: &DVec3| {
        let offset = DVec3::new(distance, 0.0, 0.0);
        let separation = Separation { offset, normal_in: DVec3::Z, refracted: *refracted, normal_out };
        model.bare(channel, &separation)
    };
    directions.iter().flatten().map(value).collect()
}

/// The ratio of successive distances at which the model is evaluated.
const STEP: f64 = 1.1;

/// The variation at `nearest` and at each [`STEP`] beyond, on a surface of this size, m.
fn variations(
    model: &dyn Bssrdf,
    directions: &[Vec<DVec3>; 8],
    nearest: f64,
    farthest: f64,
    size: f64,
) -> Vec<Variation> {
    let steps = ((farthest / nearest).ln() / STEP.ln()).ceil().clamp(1.0, 2000.0) as i32;
    let distance = |step: i32| nearest * STEP.powi(step);
    let with_normal = |normal: DVec3| {
        let at = |step| (distance(step), [0, 1, 2].map(|c| values(model, c, distance(step), normal, directions)));
        let rows: Vec<(f64, [Vec<f64>; 3])> = (-1..=steps + 1).map(at).collect();
        rows.windows(3).map(|rows| variation(&rows[0], &rows[1], &rows[2])).collect()
    };
    let by_normal: [Vec<Variation>; 5] = normals().map(with_normal);
    let others = (by_normal.len() - 1) as f64;
    let mean = |step: i32| {
        let share = CURVED * (distance(step) / size).min(1.0);
        let weights = std::iter::once(1.0 - share).chain(std::iter::repeat(share / others));
        let mut mean = Variation::default();
        for (weight, variations) in weights.zip(&by_normal) {
            let here = &variations[step as usize];
            mean.value += weight * here.value;
            mean.slope += weight * here.slope * here.slope;
            mean.scatter += weight * here.scatter * here.scatter;
        }
        Variation { slope: mean.slope.sqrt(), scatter: mean.scatter.sqrt(), ..mean }
    };
    (0..=steps).map(mean).collect()
}

/// The variation at a step that need not be a whole number: the geometric mean of those at the two nearest.
fn interpolate(variations: &[Variation], step: f64) -> Variation {
    let step = step.clamp(0.0, (variations.len() - 1) as f64);
    let (low, share) = (step as usize, step.fract());
    let (a, b) = (&variations[low], &variations[(low + 1).min(variations.len() - 1)]);
    let mean = |a: f64, b: f64| if a > 0.0 && b > 0.0 { a * (b / a).powf(share) } else { a };
    Variation { value: mean(a.value, b.value), slope: mean(a.slope, b.slope), scatter: mean(a.scatter, b.scatter) }
}

/// The variation at the distance of the middle one of three rows of values, as means over the channels.
fn variation(near: &(f64, [Vec<f64>; 3]), here: &(f64, [Vec<f64>; 3]), far: &(f64, [Vec<f64>; 3])) -> Variation {
    let mut sum = Variation::default();
    let (distance, width) = (here.0, far.0 - near.0);
    for channel in 0..3 {
        let (near, here, far) = (&near.1[channel], &here.1[channel], &far.1[channel]);
        let n = here.len().max(1) as f64;
        let mean = here.iter().sum::<f64>() / n;
        let along = near.iter().zip(far).map(|(a, b)| ((a - b) / width).powi(2)).sum::<f64>() / n;
        // The same direction at the next azimuth is an eighth of the list further on.
        let turned = here.iter().cycle().skip(here.len() / 8).zip(here);
        let across = turned.take(here.len()).map(|(a, b)| ((a - b) / (PI / 4.0 * distance)).powi(2)).sum::<f64>() / n;
        sum.value += mean / 3.0;
        sum.slope += (0.5 * (along + across)).sqrt() / 3.0;
        sum.scatter += (here.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt() / 3.0;
    }
    sum
}
