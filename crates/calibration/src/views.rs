//! What images from all around show of a surface: twelve views along the vertices of an icosahedron, and the light that
//! leaves towards the directions nearest to each.

use glam::DVec3;
use rayon::prelude::*;
use scene::{Rays, SurfacePoint};
use std::f64::consts::PI;

/// The number of views.
pub const VIEWS: usize = 12;

/// A number for each view.
pub type PerView = [f64; VIEWS];

/// Levels of splits of the regions by which the light towards each view is counted.
pub const REGION_LEVELS: u32 = 6;

/// The golden ratio.
const GOLDEN: f64 = 1.618_033_988_749_895;

/// Directions over which the light towards all views together is integrated, and every how many of them one point has: it
/// has 128, and those of consecutive points are others.
const DIRECTIONS: usize = 8192;
const STRIDE: usize = 64;

/// Points of each cell of which it is found whether a view sees them.
const POINTS_OF_CELL: usize = 2;

/// The direction of a view, not normalized.
fn axis(view: usize) -> DVec3 {
    let sign = |bit: usize| if view & bit == 0 { 1.0 } else { -1.0 };
    let [a, b] = [sign(1), sign(2) * GOLDEN];
    [DVec3::new(0.0, a, b), DVec3::new(b, 0.0, a), DVec3::new(a, b, 0.0)][view / 4]
}

/// The view that is nearest to a direction. The twelve are four in each of three planes, with all signs.
pub fn nearest(direction: DVec3) -> usize {
    let DVec3 { x, y, z } = direction;
    let planes = [(y, z), (z, x), (x, y)];
    let along = planes.map(|(a, b)| a.abs() + GOLDEN * b.abs());
    let plane = (1..3).fold(0, |best, k| if along[k] > along[best] { k } else { best });
    let (a, b) = planes[plane];
    4 * plane + usize::from(a < 0.0) + 2 * usize::from(b < 0.0)
}

/// Directions that are spread evenly over the sphere along a spiral (Swinbank and Purser 2006), each with its view. The
/// same number of them serves all views to within one or two.
fn directions() -> Vec<(DVec3, usize)> {
    let one = |k: usize| {
        let height = 1.0 - (2.0 * k as f64 + 1.0) / DIRECTIONS as f64;
        let (sine, cosine) = (2.0 * PI * GOLDEN * k as f64).sin_cos();
        let radius = (1.0 - height * height).sqrt();
        let direction = DVec3::new(radius * cosine, radius * sine, height);
        (direction, nearest(direction))
    };
    (0..DIRECTIONS).map(one).collect()
}

/// How the light of one channel leaves.
pub struct Leaving<'a> {
    /// `T21` by the cosine outside.
    pub transmittance: &'a dyn Fn(f64) -> f64,
    /// `a` and `b` of the exit lobe.
    pub lobe: [f64; 2],
    /// `l/η`, m.
    pub shift: f64,
    /// For each patch, the gradient of the logarithm of the light, 1/m.
    pub slopes: &'a [DVec3],
    pub channel: usize,
}

/// Steps of a table over the cosine.
const STEPS: usize = 1024;

/// `T21 (a + b μ) μ` in the middle of each step of μ.
fn table(leaving: &Leaving) -> Vec<f64> {
    let [a, b] = leaving.lobe;
    let middle = |k: usize| (k as f64 + 0.5) / STEPS as f64;
    let at = |cosine: f64| (leaving.transmittance)(cosine) * (a + b * cosine).max(0.0) * cosine;
    (0..STEPS).map(|k| at(middle(k))).collect()
}

/// A surface seen from all around.
pub struct Views<'a> {
    directions: Vec<(DVec3, usize)>,
    points: &'a [SurfacePoint],
    /// The light of the model at each point, of any unit.
    light: &'a [DVec3],
    /// The points of each cell.
    of_cell: Vec<Vec<u32>>,
    /// For each cell, the mean over its points of `∫ μ dω` over the directions of each view.
    pub projected: Vec<PerView>,
    /// The same, where a point that the view does not see counts as 0.
    pub visible: Vec<PerView>,
}

impl<'a> Views<'a> {
    /// Of the points of a surface in the cells `cell_of`, of which there are `cells`. A view is as far away as the
    /// surface is large: what lies beyond, as the walls of a room, hides nothing.
    pub fn new(
        points: &'a [SurfacePoint],
        light: &'a [DVec3],
        (cell_of, cells): (&[u32], usize),
        rays: &Rays,
    ) -> Views<'a> {
        let mut of_cell: Vec<Vec<u32>> = vec![Vec::new(); cells];
        cell_of.iter().enumerate().for_each(|(k, cell)| of_cell[*cell as usize].push(k as u32));
        let positions = || points.iter().map(|p| p.position);
        let low = positions().fold(DVec3::INFINITY, DVec3::min);
        let high = positions().fold(DVec3::NEG_INFINITY, DVec3::max);
        let distance = (high - low).length();
        let (projected, visible) = (vec![[0.0; VIEWS]; cells], Vec::new());
        let mut views = Views { directions: directions(), points, light, of_cell, projected, visible };
        let axes: Vec<DVec3> = (0..VIEWS).map(|view| axis(view).normalize()).collect();
        let sees = |point: &SurfacePoint, view: usize| {
            axes[view].dot(point.geometric_normal) > 0.0
                && rays.visible(point.position, axes[view], distance, Some(point.triangle))
        };
        let of = |own: &Vec<u32>| {
            let mut projected = [0.0; VIEWS];
            own.iter().for_each(|k| views.add(*k, &mut projected, |cosine, _| cosine));
            // Points are in the order of triangles: the first of a cell lie together.
            let count = own.len().min(POINTS_OF_CELL);
            let tried: Vec<&SurfacePoint> =
                (0..count).map(|k| &points[own[(2 * k + 1) * own.len() / (2 * count)] as usize]).collect();
            let mut visible = [0.0; VIEWS];
            for view in 0..VIEWS {
                projected[view] /= own.len().max(1) as f64;
                let seen = tried.iter().filter(|point| sees(point, view)).count();
                visible[view] = projected[view] * seen as f64 / count.max(1) as f64;
            }
            (projected, visible)
        };
        (views.projected, views.visible) = views.of_cell.par_iter().map(of).unzip();
        views
    }

    /// For each cell, the light that leaves towards the directions of each view, as a share of all light that leaves the
    /// cell. `patch_of` gives the patch of a cell.
    pub fn shares(&self, leaving: &Leaving, patch_of: impl Fn(u32) -> u32 + Sync) -> Vec<PerView> {
        let (table, shift, slopes, channel) = (table(leaving), leaving.shift, leaving.slopes, leaving.channel);
        let of = |(cell, own): (usize, &Vec<u32>)| {
            let slope = slopes[patch_of(cell as u32) as usize] * shift;
            let mut sums = [0.0; VIEWS];
            for &k in own {
                let (light, normal) = (self.light[k as usize][channel], self.points[k as usize].geometric_normal);
                let along = slope - slope.dot(normal) * normal;
                self.add(k, &mut sums, |cosine, direction| {
                    let turned = (-along.dot(direction).clamp(-1.0, 1.0)).exp();
                    light * turned * table[((cosine * STEPS as f64) as usize).min(STEPS - 1)]
                });
            }
            let total: f64 = sums.iter().sum();
            sums.map(|sum| if total > 0.0 { sum / total } else { 0.0 })
        };
        self.of_cell.par_iter().enumerate().map(of).collect()
    }

    /// Adds the integral over the directions of each view, above the surface at a point, of a function of the cosine and
    /// the direction.
    fn add(&self, point: u32, sums: &mut PerView, f: impl Fn(f64, DVec3) -> f64) {
        let normal = self.points[point as usize].geometric_normal;
        for (direction, view) in self.directions.iter().skip(point as usize % STRIDE).step_by(STRIDE) {
            let cosine = normal.dot(*direction);
            if cosine > 0.0 {
                sums[*view] += f(cosine, *direction) * (4.0 * PI * STRIDE as f64 / DIRECTIONS as f64);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bssrdf::fresnel::transmittance;
    use glam::Vec3;
    use scene::NormalKind;
    use test_support::meshes::{Part, World, sphere, world};

    impl Views<'static> {
        /// Cells that all views show alike.
        pub fn of_a_point(cells: usize) -> Views<'static> {
            let alike = || vec![[PI / VIEWS as f64; VIEWS]; cells];
            let (projected, visible) = (alike(), alike());
            Views { directions: Vec::new(), points: &[], light: &[], of_cell: Vec::new(), projected, visible }
        }
    }

    /// A shell of two spheres.
    fn shell() -> World {
        let mut mesh = sphere(1.0, 3);
        let inner = sphere(0.8, 3);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(inner.positions.iter().copied());
        mesh.triangles.extend(inner.triangles.iter().map(|[a, b, c]| [a + first, c + first, b + first]));
        world(&[Part::translucent(mesh)], &[], DVec3::ZERO)
    }

    /// A point on each triangle, each a cell of its own.
    fn points(world: &World) -> Vec<SurfacePoint> {
        let point = |k: usize| world.scene.mesh.point(k as u32, [1.0 / 3.0; 3], NormalKind::Geometric);
        (0..world.scene.mesh.triangles.len()).map(point).collect()
    }

    /// Seen to catch: the signs of a view in the other order.
    #[test]
    fn the_nearest_view_has_the_largest_cosine() {
        for (direction, view) in directions() {
            let along = |view: usize| axis(view).dot(direction);
            assert!((0..VIEWS).all(|other| along(other) <= along(view) + 1e-12), "{direction} {view}");
        }
    }

    /// What all views together show of the outside of a shell is ∫ μ dω = π at each point, and of its inside nothing.
    ///
    /// Seen to catch: rays that are not followed; the solid angle of a direction without the stride.
    #[test]
    fn views_show_the_outside() {
        let world = shell();
        let points = points(&world);
        let light = vec![DVec3::ONE; points.len()];
        let cell_of: Vec<u32> = (0..points.len() as u32).collect();
        let views = Views::new(&points, &light, (&cell_of, points.len()), &world.rays);
        let sum = |of: &[PerView], outside: bool| {
            let own = points.iter().zip(of).filter(|(p, _)| (p.position.length() > 0.9) == outside);
            let sums: Vec<f64> = own.map(|(_, seen)| seen.iter().sum()).collect();
            sums.iter().sum::<f64>() / sums.len() as f64
        };
        for outside in [false, true] {
            assert!((sum(&views.projected, outside) / PI - 1.0).abs() < 1e-3, "{}", sum(&views.projected, outside));
        }
        // Light that leaves nearly along the surface counts to a view that does not face it.
        assert!(sum(&views.visible, true) > 0.9 * PI, "{}", sum(&views.visible, true));
        assert_eq!(sum(&views.visible, false), 0.0);
    }

    /// The light of a cell is all seen by some view, more of it by those along the normal than a diffuse surface would
    /// show if the lobe grows with the cosine, and more by those against the gradient, from where the point that is seen
    /// lies further up.
    ///
    /// Seen to catch: a gradient of the wrong sign; the lobe left out.
    #[test]
    fn shares_follow_the_lobe_and_the_gradient() {
        let world = shell();
        // Of one flat cell, as many points as it takes for all directions.
        let one = points(&world).into_iter().find(|p| p.geometric_normal.z > 0.9).expect("the sphere has a top");
        let points = vec![SurfacePoint { geometric_normal: DVec3::Z, ..one }; STRIDE];
        let (light, cell_of) = (vec![DVec3::ONE; STRIDE], vec![0; STRIDE]);
        let views = Views::new(&points, &light, (&cell_of, 1), &world.rays);
        let shares = |lobe: [f64; 2], slope: Vec3| {
            let leaving = Leaving {
                transmittance: &|cosine| transmittance(cosine, 1.3),
                lobe,
                shift: 1e-3,
                slopes: &[slope.as_dvec3()],
                channel: 0,
            };
            let shares = views.shares(&leaving, |_| 0)[0];
            assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            let along = |v: DVec3| (0..VIEWS).map(|k| shares[k] * axis(k).normalize().dot(v)).sum::<f64>();
            [along(DVec3::Z), along(DVec3::X)]
        };
        let [up, across] = shares([1.0, 0.0], Vec3::ZERO);
        assert!(across.abs() < 3e-3, "{across}");
        let [up_of_lobe, _] = shares([0.0, 1.0], Vec3::ZERO);
        assert!(up_of_lobe > 1.05 * up, "{up_of_lobe} {up}");
        // ∫ T21 μ (1 − 0.2 v_x) v_x dω over ∫ T21 μ dω, of which the views hold the most.
        let [_, across] = shares([1.0, 0.0], Vec3::X * 200.0);
        assert!((across / -0.05 - 1.0).abs() < 0.2, "{across}");
    }
}
