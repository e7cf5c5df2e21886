//! Points that are spread evenly over the surface of a material, and the model's light there.

use crate::patches::Site;
use glam::DVec3;
use rayon::prelude::*;
use scene::{
    Mesh, NormalKind, SurfacePoint,
    random::{Purpose, Stream},
    warp,
};
use sums::{
    Summation,
    estimator::{Estimator, Scratch},
    samples::Exit,
};

/// Points on the surface of a material.
pub struct Surface {
    /// m².
    pub area: f64,
    pub points: Vec<SurfacePoint>,
}

/// Relative error of the model's light at one point. The mean over a patch has a tenth of it.
const ACCURACY: f64 = 0.05;

/// Steps of the sequence R2 (Roberts 2018): the inverse of the plastic number, and its square.
const STEPS: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];

impl Surface {
    /// Draws `count` points on the triangles of `material`. Each triangle gets its share by area, to within one point,
    /// and those of one triangle follow a sequence of low discrepancy: the mean over a patch of 128 points is as good as
    /// that of five hundred independent ones.
    pub fn new(mesh: &Mesh, material: u16, normals: NormalKind, count: usize, seed: u64) -> Surface {
        let own: Vec<u32> =
            (0..mesh.triangles.len() as u32).filter(|k| mesh.triangles[*k as usize].material == material).collect();
        let mut ends = vec![0.0];
        own.iter().for_each(|k| ends.push(ends[ends.len() - 1] + mesh.area(*k as usize)));
        let area = ends[own.len()];
        let stream = Stream::new(seed, Purpose::CalibrationPoint);
        let offset = stream.item(u64::from(material)).uniform(0);
        // The number of points before this place on the line of all triangles.
        let before = |place: f64| (place / area * count as f64 - offset).ceil().clamp(0.0, count as f64) as usize;
        let of = |k: usize| {
            let shift = stream.item(u64::from(material) << 32 | u64::from(own[k]));
            let triangle = own[k];
            let spread = move |index: usize| {
                let [x, y] = [0, 1].map(|d| (shift.uniform(1 + d) + index as f64 * STEPS[d as usize]).fract());
                mesh.point(triangle, warp::triangle([x, y]), normals)
            };
            (0..before(ends[k + 1]) - before(ends[k])).map(spread).collect::<Vec<_>>()
        };
        let points = (0..own.len()).into_par_iter().flat_map_iter(of).collect();
        Surface { area, points }
    }

    pub fn sites(&self) -> Vec<Site> {
        self.points.iter().map(|p| Site { position: p.position, normal: p.geometric_normal }).collect()
    }

    /// The sum over the cloud at each point, W/(m² sr): the radiance that leaves, without `T21`.
    pub fn light(&self, summation: &Summation, seed: u64, progress: impl Fn(u64) + Sync) -> Vec<DVec3> {
        let stream = Stream::new(seed, Purpose::CalibrationSum);
        let estimator = Estimator::Cut { accuracy: ACCURACY };
        let light = |scratch: &mut Scratch, (index, point): (usize, &SurfacePoint)| {
            let item = stream.item(index as u64);
            let exit = |half: usize| Exit::new(point.position, point.normal, item.bits(half as u64));
            let radiance = summation.whole(estimator, exit, scratch).radiance;
            progress(1);
            radiance
        };
        self.points.par_iter().enumerate().map_init(Scratch::default, light).collect()
    }
}
