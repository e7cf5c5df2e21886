//! How one image looks at one exposure, and how two looks differ, over a tile.

use simd::Kernel;

use super::color::{self, hunt_lab, opponents};
use super::contrast::{Blur, Contrast};
use super::exposure::Tone;
use super::feature::{self, Detectors};
use crate::metric::convolve::{Along, Even, EvenOfSumZero, Odd, convolve};
use crate::metric::elementary::power;
use crate::metric::tile::{GROUPS, HALO, LANES, PITCH, Plane, ROWS, group, lanes, plane};

/// All filters.
pub(super) struct Eye {
    contrast: Contrast,
    detectors: Detectors,
}

impl Eye {
    pub fn new() -> Eye {
        Eye { contrast: Contrast::new(), detectors: Detectors::new() }
    }
}

/// Of one image.
pub(super) struct Look {
    /// L*, a*, b* with Hunt's adjustment, of what is not too fine to be seen.
    color: [Box<Plane>; 3],
    /// Strength of edges and of points.
    edge: Box<Plane>,
    point: Box<Plane>,
}

impl Default for Look {
    fn default() -> Look {
        Look { color: std::array::from_fn(|_| plane()), edge: plane(), point: plane() }
    }
}

impl Look {
    /// L*, a*, b*, edges and points.
    #[inline(always)]
    fn lanes(&self, at: usize) -> [&[f32; LANES]; 5] {
        let [l, a, b] = &self.color;
        [lanes(l, at), lanes(a, at), lanes(b, at), lanes(&self.edge, at), lanes(&self.point, at)]
    }
}

/// What lies between light and look.
pub(super) struct Work {
    opponents: [Box<Plane>; 3],
    across: Box<Plane>,
    more: Box<Plane>,
}

impl Default for Work {
    fn default() -> Work {
        Work { opponents: std::array::from_fn(|_| plane()), across: plane(), more: plane() }
    }
}

/// Shows linear light with a tone, and looks.
pub(super) fn see(eye: &Eye, tone: Tone, linear: &[Box<Plane>; 3], work: &mut Work, look: &mut Look) {
    simd::dispatch(See { eye, tone, linear, work, look });
}

/// Raises `largest` to the difference of two looks.
pub(super) fn compare(looks: &[Look; 2], limit: f32, largest: &mut Plane) {
    simd::dispatch(Compare { looks, limit, largest });
}

struct See<'a> {
    eye: &'a Eye,
    tone: Tone,
    linear: &'a [Box<Plane>; 3],
    work: &'a mut Work,
    look: &'a mut Look,
}

impl Kernel for See<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Work { opponents, across, more } = self.work;
        split(self.tone, self.linear, opponents);
        let Contrast { light, red_green, blue_yellow } = &self.eye.contrast;
        let Look { color, edge, point } = self.look;
        blur(light, &opponents[0], across, &mut color[0]);
        blur(red_green, &opponents[1], across, &mut color[1]);
        blur(&blue_yellow[0], &opponents[2], across, &mut color[2]);
        blur(&blue_yellow[1], &opponents[2], across, more);
        adjust(color, more);
        let Detectors { smooth, edge: first, point: second } = &self.eye.detectors;
        convolve::<Even>(Along::Rows(HALO), smooth, &opponents[0], across);
        convolve::<Odd>(Along::Columns, first, across, edge);
        convolve::<EvenOfSumZero>(Along::Columns, second, across, point);
        convolve::<Odd>(Along::Rows(HALO), first, &opponents[0], across);
        convolve::<Even>(Along::Columns, smooth, across, more);
        length(edge, more);
        convolve::<EvenOfSumZero>(Along::Rows(HALO), second, &opponents[0], across);
        convolve::<Even>(Along::Columns, smooth, across, more);
        length(point, more);
    }
}

/// Rows of both margins too; the columns beyond the halo come along.
#[inline(always)]
fn split(tone: Tone, [r, g, b]: &[Box<Plane>; 3], opponents_of: &mut [Box<Plane>; 3]) {
    let [y, xy, yz] = opponents_of;
    for at in (0..PITCH * ROWS).step_by(LANES) {
        let (r, g, b) = (lanes(r, at), lanes(g, at), lanes(b, at));
        let mut result = [[0.0; LANES]; 3];
        for i in 0..LANES {
            [result[0][i], result[1][i], result[2][i]] = opponents([tone.show(r[i]), tone.show(g[i]), tone.show(b[i])]);
        }
        y[at..at + LANES].copy_from_slice(&result[0]);
        xy[at..at + LANES].copy_from_slice(&result[1]);
        yz[at..at + LANES].copy_from_slice(&result[2]);
    }
}

#[inline(always)]
fn blur(filter: &Blur, from: &Plane, across: &mut Plane, to: &mut Plane) {
    convolve::<Even>(Along::Rows(filter.columns.len() - 1), &filter.rows, from, across);
    convolve::<Even>(Along::Columns, &filter.columns, across, to);
}

/// Filtered opponents become adjusted colors; `more` is added to the third.
#[inline(always)]
fn adjust([first, second, third]: &mut [Box<Plane>; 3], more: &Plane) {
    for at in (0..GROUPS).map(group) {
        let (y, xy, yz, more) = (*lanes(first, at), *lanes(second, at), *lanes(third, at), lanes(more, at));
        let mut result = [[0.0; LANES]; 3];
        for i in 0..LANES {
            [result[0][i], result[1][i], result[2][i]] = hunt_lab([y[i], xy[i], yz[i] + more[i]]);
        }
        first[at..at + LANES].copy_from_slice(&result[0]);
        second[at..at + LANES].copy_from_slice(&result[1]);
        third[at..at + LANES].copy_from_slice(&result[2]);
    }
}

/// Of vectors of these components, in the place of the first.
#[inline(always)]
fn length(components: &mut Plane, others: &Plane) {
    for at in (0..GROUPS).map(group) {
        let (x, y) = (*lanes(components, at), lanes(others, at));
        let mut result = [0.0; LANES];
        for i in 0..LANES {
            result[i] = (x[i] * x[i] + y[i] * y[i]).sqrt();
        }
        components[at..at + LANES].copy_from_slice(&result);
    }
}

struct Compare<'a> {
    looks: &'a [Look; 2],
    limit: f32,
    largest: &'a mut Plane,
}

impl Kernel for Compare<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let [reference, test] = self.looks;
        for at in (0..GROUPS).map(group) {
            let (a, b) = (reference.lanes(at), test.lanes(at));
            let mut largest = *lanes(self.largest, at);
            for i in 0..LANES {
                let color = color::difference([a[0][i], a[1][i], a[2][i]], [b[0][i], b[1][i], b[2][i]], self.limit);
                let feature = feature::difference([a[3][i], b[3][i]], [a[4][i], b[4][i]]);
                // The paper's color^(1 - feature), exactly zero where the colors are equal.
                largest[i] = largest[i].max(color * power(color, -feature));
            }
            self.largest[at..at + LANES].copy_from_slice(&largest);
        }
    }
}

#[cfg(test)]
mod tests {
    use simd::Level;

    use super::*;
    use crate::metric::tile::MARGIN;

    /// The look of a grey plane, at one level of instructions.
    fn look(level: Level, of: impl Fn(usize, usize) -> f32) -> Look {
        let mut grey = plane();
        for (i, sample) in grey.iter_mut().enumerate() {
            *sample = of(i % PITCH, i / PITCH);
        }
        let linear = [grey.clone(), grey.clone(), grey];
        let (mut look, mut work) = (Look::default(), Work::default());
        let (eye, tone) = (Eye::new(), Tone::Clamp);
        simd::run_as(level, See { eye: &eye, tone, linear: &linear, work: &mut work, look: &mut look });
        look
    }

    #[test]
    fn a_step_is_an_edge_and_a_line_is_a_point() {
        let at = (HALO + 20) * PITCH + MARGIN + 50;
        let step = look(Level::Plain, |x, _| if x >= MARGIN + 50 { 1.0 } else { 0.0 });
        // All weights of one side see the light, none of the other.
        assert!((step.edge[at] - 1.0).abs() < 1e-5, "{}", step.edge[at]);
        let line = look(Level::Plain, |_, y| if y == HALO + 20 { 1.0 } else { 0.0 });
        // The weight in the middle alone.
        let middle = -f64::from(Detectors::new().point[0]);
        assert!((f64::from(line.point[at]) - middle).abs() < 1e-5 && line.edge[at] == 0.0);
    }

    #[test]
    fn an_even_plane_has_neither() {
        let even = look(Level::Plain, |_, _| 0.3);
        for group in (0..GROUPS).map(group) {
            let [l, _, _, edge, point] = even.lanes(group);
            // L* of 0.3 is 61.654.
            assert!(l.iter().all(|l| (l - 61.654).abs() < 1e-3), "{l:?}");
            assert_eq!([edge, point], [&[0.0; LANES]; 2]);
        }
    }

    #[test]
    fn every_level_of_instructions_gives_the_same_bits() {
        let bits = |level| {
            let looks = [3, 5].map(|k| look(level, |x, y| ((x * x + k * y * y) % 37) as f32 / 30.0));
            let mut largest = plane();
            simd::run_as(level, Compare { looks: &looks, limit: color::largest_difference(), largest: &mut largest });
            largest.map(f32::to_bits)
        };
        let plain = bits(Level::Plain);
        assert!(plain.iter().any(|bits| *bits != 0));
        for level in Level::ALL {
            assert!(plain == bits(level), "{level:?}");
        }
    }
}
