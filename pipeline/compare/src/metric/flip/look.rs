//! How a tile of one image looks at one exposure, and how the looks of two images differ.

use simd::Kernel;

use super::color::{self, hunt_lab, opponents};
use super::contrast::Contrast;
use super::exposure::Tone;
use super::feature::{self, Detectors};
use crate::metric::convolve::{Along, Symmetry, blur, convolve};
use crate::metric::elementary::power;
use crate::metric::tile::{GROUPS, HALO, LANES, PITCH, Plane, ROWS, group, lanes};

/// The filters of the viewer's eye.
#[derive(Default)]
pub(super) struct Eye {
    contrast: Contrast,
    detectors: Detectors,
}

/// What the viewer sees of a tile of one image: L*, a*, b* with Hunt's adjustment, after the filters of contrast
/// sensitivity, then the strength of edges and of points.
pub(super) type Look = [Box<Plane>; 5];

/// [`LANES`] pixels of the planes of a look.
#[inline(always)]
fn look_lanes([l, a, b, edge, point]: &Look, at: usize) -> [&[f32; LANES]; 5] {
    [lanes(l, at), lanes(a, at), lanes(b, at), lanes(edge, at), lanes(point, at)]
}

/// Intermediate results between light and look: the three opponent channels, and two filtered planes.
pub(super) type Work = [Box<Plane>; 5];

/// Shows linear light with a tone, and writes how it looks.
pub(super) struct See<'a> {
    pub eye: &'a Eye,
    pub tone: Tone,
    pub linear: &'a [Box<Plane>; 3],
    pub work: &'a mut Work,
    pub look: &'a mut Look,
}

impl Kernel for See<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let [y, xy, yz, across, second] = self.work;
        let [l, a, b, edge, point] = self.look;
        let Contrast { light, red_green, blue_yellow } = &self.eye.contrast;
        split(self.tone, self.linear, [y, xy, yz]);
        blur(&light.rows, &light.columns, y, across, l);
        blur(&red_green.rows, &red_green.columns, xy, across, a);
        blur(&blue_yellow[0].rows, &blue_yellow[0].columns, yz, across, b);
        blur(&blue_yellow[1].rows, &blue_yellow[1].columns, yz, across, second);
        adjust([l, a, b], second);
        let Detectors { smooth, edge: slope, point: curvature } = &self.eye.detectors;
        convolve(Symmetry::Even, Along::Rows(HALO), smooth, y, across);
        convolve(Symmetry::Odd, Along::Columns, slope, across, edge);
        convolve(Symmetry::EvenOfSumZero, Along::Columns, curvature, across, point);
        convolve(Symmetry::Odd, Along::Rows(HALO), slope, y, across);
        convolve(Symmetry::Even, Along::Columns, smooth, across, second);
        length(edge, second);
        convolve(Symmetry::EvenOfSumZero, Along::Rows(HALO), curvature, y, across);
        convolve(Symmetry::Even, Along::Columns, smooth, across, second);
        length(point, second);
    }
}

/// Splits the light that the screen emits into opponent channels, margins included.
#[inline(always)]
fn split(tone: Tone, [r, g, b]: &[Box<Plane>; 3], [y, xy, yz]: [&mut Plane; 3]) {
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

/// Turns filtered opponent channels into adjusted colors. The third channel is the sum of two filters, the second of
/// which is `addend`.
#[inline(always)]
fn adjust([first, second, third]: [&mut Plane; 3], addend: &Plane) {
    for at in (0..GROUPS).map(group) {
        let (y, xy, yz, addend) = (*lanes(first, at), *lanes(second, at), *lanes(third, at), lanes(addend, at));
        let mut result = [[0.0; LANES]; 3];
        for i in 0..LANES {
            [result[0][i], result[1][i], result[2][i]] = hunt_lab([y[i], xy[i], yz[i] + addend[i]]);
        }
        first[at..at + LANES].copy_from_slice(&result[0]);
        second[at..at + LANES].copy_from_slice(&result[1]);
        third[at..at + LANES].copy_from_slice(&result[2]);
    }
}

/// Replaces the first components of vectors by the lengths of the vectors.
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

/// Raises each value of `largest` to the difference of the two looks where that is larger.
pub(super) struct Compare<'a> {
    pub looks: &'a [Look; 2],
    pub limit: f32,
    pub largest: &'a mut Plane,
}

impl Kernel for Compare<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let [reference, test] = self.looks;
        for at in (0..GROUPS).map(group) {
            let (a, b) = (look_lanes(reference, at), look_lanes(test, at));
            let mut largest = *lanes(self.largest, at);
            for i in 0..LANES {
                let color = color::difference([a[0][i], a[1][i], a[2][i]], [b[0][i], b[1][i], b[2][i]], self.limit);
                let feature = feature::difference([a[3][i], b[3][i]], [a[4][i], b[4][i]]);
                // This is the paper's color^(1 - feature), exactly zero where the colors are equal.
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
    use crate::metric::tile::{MARGIN, planes};

    /// The look of a gray plane, at one level of instructions.
    fn look(level: Level, of: impl Fn(usize, usize) -> f32) -> Look {
        let [mut gray] = planes();
        for (i, sample) in gray.iter_mut().enumerate() {
            *sample = of(i % PITCH, i / PITCH);
        }
        let linear = [gray.clone(), gray.clone(), gray];
        let (mut look, mut work) = (planes(), planes());
        let (eye, tone) = (Eye::default(), Tone::Clamp);
        simd::run_as(level, See { eye: &eye, tone, linear: &linear, work: &mut work, look: &mut look });
        look
    }

    #[test]
    fn a_step_is_an_edge_and_a_line_is_a_point() {
        let at = (HALO + 20) * PITCH + MARGIN + 50;
        let step = look(Level::Plain, |x, _| if x >= MARGIN + 50 { 1.0 } else { 0.0 });
        // All weights of one side see the light, and none of the other side.
        assert!((step[3][at] - 1.0).abs() < 1e-5, "{}", step[3][at]);
        let line = look(Level::Plain, |_, y| if y == HALO + 20 { 1.0 } else { 0.0 });
        // The weight in the middle alone sees the line.
        let middle = -f64::from(Detectors::default().point[0]);
        assert!((f64::from(line[4][at]) - middle).abs() < 1e-5 && line[3][at] == 0.0);
    }

    #[test]
    fn a_uniform_plane_has_neither() {
        let uniform = look(Level::Plain, |_, _| 0.3);
        for group in (0..GROUPS).map(group) {
            let [l, _, _, edge, point] = look_lanes(&uniform, group);
            // L* of 0.3 is 61.654.
            assert!(l.iter().all(|l| (l - 61.654).abs() < 1e-3), "{l:?}");
            assert_eq!([edge, point], [&[0.0; LANES]; 2]);
        }
    }

    #[test]
    fn every_level_of_instructions_gives_the_same_bits() {
        let bits = |level| {
            let looks = [3, 5].map(|k| look(level, |x, y| ((x * x + k * y * y) % 37) as f32 / 30.0));
            let [mut largest] = planes();
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
