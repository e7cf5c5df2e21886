//! Points that are spread evenly over the surface of a material, and the model's light there.

use crate::patches::{Patches, Site};
use glam::DVec3;
use near_field::{NearField, Numbers, Place, Surroundings};
use rayon::prelude::*;
use scene::{
    Mesh, NormalKind, SurfacePoint,
    random::{Item, Purpose, Stream},
    sequence::Sequence,
    warp,
};
use sums::{
    Summation,
    estimator::{Estimator, Scratch},
    samples::Exit,
};
use walks::Solid;

/// Points on the surface of a material.
pub struct Surface {
    /// m².
    pub area: f64,
    pub points: Vec<SurfacePoint>,
}

/// What lights the points.
pub struct Lit<'a> {
    pub summation: Summation<'a>,
    /// The near part of the model, if the samples do not carry it, and what lights it.
    pub near: Option<(NearField, &'a Surroundings<'a>)>,
}

/// Estimates of the near field at each point.
const ESTIMATES: u32 = 4;

/// The numbers of all estimates of near fields. Points with consecutive indices lie close together, so that the light of a
/// patch is spread evenly: drawn independently under a sky, it left a colored stain on a calibrated bowl of milk.
struct NearNumbers([Sequence; 2]);

impl NearNumbers {
    fn new(seed: u64) -> NearNumbers {
        let sequence = |purpose| {
            let stream = Stream::new(seed, purpose);
            Sequence::new(stream.item(0), stream)
        };
        NearNumbers([Purpose::NearField, Purpose::NearLight].map(sequence))
    }

    fn at(&self, index: u32) -> Numbers {
        let [[radius, azimuth, l1, l2], [axis, light, ..]] = self.0.each_ref().map(|sequence| sequence.point(index));
        [radius, azimuth, axis, light, l1, l2]
    }
}

impl Lit<'_> {
    /// The light that enters near a point, as the mean of some estimates with these numbers.
    fn nearby(
        &self,
        point: &SurfacePoint,
        numbers: impl Fn(u32) -> Numbers,
        item: Item,
        scratch: &mut near_field::Scratch,
    ) -> DVec3 {
        let Some((near, surroundings)) = &self.near else {
            return DVec3::ZERO;
        };
        let at = Place { surface: *point, position: point.position, normal: point.smooth_normal, crossing: DVec3::ONE };
        let one = |k: u32| near.light(surroundings, (&at, 1.0), &numbers(k), item, scratch);
        (0..ESTIMATES).map(one).sum::<DVec3>() / f64::from(ESTIMATES)
    }
}

/// Relative error of the model's light at one point. The mean over a patch has an eighth of it.
const ACCURACY: f64 = 0.1;

/// Points for the areas of cells, for each point at which the model is evaluated.
const AREA_POINTS: usize = 16;

/// Steps of the sequence R2 (Roberts 2018): the inverse of the plastic number, and its square.
const STEPS: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];

/// Points spread over the triangles of a material, not yet drawn.
struct Spread {
    triangles: Vec<u32>,
    /// The area before each triangle and, last, of all, m².
    ends: Vec<f64>,
    count: usize,
    stream: Stream,
    /// Where the first point lies, in units of the area of one point.
    offset: f64,
}

impl Surface {
    /// Draws `count` points on the triangles of `material`. Each triangle gets its share by area, to within one point,
    /// and those of one triangle follow a sequence of low discrepancy: the mean over a patch is as good as that of
    /// several times as many independent ones.
    pub fn new(mesh: &Mesh, material: u16, normals: NormalKind, count: usize, seed: u64) -> Surface {
        let spread = Spread::new(mesh, material, count, Stream::new(seed, Purpose::CalibrationPoint));
        let of = |k: usize| spread.points(k).map(|(triangle, weights)| mesh.point(triangle, weights, normals));
        let points = (0..spread.triangles.len()).into_par_iter().flat_map_iter(of).collect();
        Surface { area: spread.area(), points }
    }

    /// The area of each of `cells` cells, m², from many more points than the model is evaluated at.
    pub fn cell_areas(&self, mesh: &Mesh, patches: &Patches, material: u16, seed: u64) -> Vec<f64> {
        let count = AREA_POINTS * self.points.len();
        let spread = Spread::new(mesh, material, count, Stream::new(seed, Purpose::CalibrationArea));
        let cells = |k: usize| {
            let cell = |(triangle, weights)| {
                let point = mesh.point(triangle, weights, NormalKind::Geometric);
                patches.cell(&Site { position: point.position, normal: point.geometric_normal })
            };
            spread.points(k).map(cell)
        };
        let found: Vec<u32> = (0..spread.triangles.len()).into_par_iter().flat_map_iter(cells).collect();
        let mut areas = vec![0.0; patches.cells()];
        found.iter().for_each(|cell| areas[*cell as usize] += self.area / found.len() as f64);
        areas
    }

    pub fn sites(&self) -> Vec<Site> {
        self.points.iter().map(|p| Site { position: p.position, normal: p.geometric_normal }).collect()
    }

    /// The radiance without `T21` that leaves each point by the model, W/(m² sr). No light leaves from points inside
    /// another part of the solid.
    pub fn light(&self, lit: &Lit, solid: &Solid, seed: u64, progress: impl Fn(u64) + Sync) -> Vec<DVec3> {
        let stream = Stream::new(seed, Purpose::CalibrationSum);
        let numbers = NearNumbers::new(seed);
        let estimator = Estimator::Cut { accuracy: ACCURACY };
        let light = |(scratch, near): &mut (Scratch, near_field::Scratch), (index, point): (usize, &SurfacePoint)| {
            progress(1);
            if solid.is_buried(point.position, point.geometric_normal) {
                return DVec3::ZERO;
            }
            let item = stream.item(index as u64);
            let nearby = lit.nearby(point, |k| numbers.at(ESTIMATES * index as u32 + k), item, near);
            let exit =
                |half: usize| Exit::new(point.position, point.smooth_normal, item.bits(half as u64)).besides(nearby);
            let leaving = lit.summation.whole(estimator, exit, scratch);
            leaving.radiance + nearby
        };
        self.points.par_iter().enumerate().map_init(Default::default, light).collect()
    }
}

impl Spread {
    fn new(mesh: &Mesh, material: u16, count: usize, stream: Stream) -> Spread {
        let is_own = |k: &u32| mesh.triangles[*k as usize].material == material;
        let triangles: Vec<u32> = (0..mesh.triangles.len() as u32).filter(is_own).collect();
        let mut ends = vec![0.0];
        triangles.iter().for_each(|k| ends.push(ends[ends.len() - 1] + mesh.area(*k as usize)));
        Spread { triangles, ends, count, stream, offset: stream.item(u64::from(material)).uniform(0) }
    }

    fn area(&self) -> f64 {
        self.ends[self.triangles.len()]
    }

    /// The number of points before this place on the line of all triangles, m².
    fn before(&self, place: f64) -> usize {
        let count = self.count as f64;
        (place / self.area() * count - self.offset).ceil().clamp(0.0, count) as usize
    }

    /// The points of the `k`-th triangle: its index in the mesh, and barycentric weights.
    fn points(&self, k: usize) -> impl Iterator<Item = (u32, [f64; 3])> + use<> {
        let triangle = self.triangles[k];
        let shift = self.stream.item(1 << 32 | u64::from(triangle));
        let point = move |index: usize| {
            let at = |d: usize| (shift.uniform(d as u64) + index as f64 * STEPS[d]).fract();
            (triangle, warp::triangle([at(0), at(1)]))
        };
        (0..self.before(self.ends[k + 1]) - self.before(self.ends[k])).map(point)
    }
}
