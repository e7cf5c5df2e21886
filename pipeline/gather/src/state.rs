//! The sums of an image as numbers, which a file can keep: with them, more paths can be added later, and the image is
//! to the last bit the one that would have been rendered at once.

use crate::{allotment::Allotment, pixel_sum::PixelSum};
use scene::random::Stream;

/// The sums of an image.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Paths that each pixel has, or that all share for each.
    pub paths: u32,
    /// Paths of each pixel before they were shared, if they are.
    pub base: Option<u32>,
    /// One plane of numbers for each sum, with one for each pixel. If paths are shared, one more plane has the pixels'
    /// shares.
    pub planes: Vec<Vec<f64>>,
}

impl State {
    /// The number of planes of sums.
    pub const PLANES: usize = PixelSum::NUMBERS;

    pub(crate) fn of(paths: u32, sums: &[PixelSum], allotment: Option<&Allotment>) -> State {
        let mut planes: Vec<Vec<f64>> = (0..State::PLANES).map(|_| Vec::with_capacity(sums.len())).collect();
        for sum in sums {
            planes.iter_mut().zip(sum.numbers()).for_each(|(plane, x)| plane.push(x));
        }
        planes.extend(allotment.map(|allotment| allotment.shares.clone()));
        State { paths, base: allotment.map(|allotment| allotment.base), planes }
    }

    /// The shares of the pixels, if they share their paths.
    pub(crate) fn allotment(&self, rounding: Stream) -> Option<Allotment> {
        Some(Allotment::new(self.base?, self.planes.get(State::PLANES)?.clone(), rounding))
    }

    /// Replaces the sums of pixels that have so many paths.
    pub(crate) fn restore(&self, paths: &[u32], sums: &mut [PixelSum]) {
        for (pixel, sum) in sums.iter_mut().enumerate() {
            *sum = PixelSum::from_numbers(paths[pixel], std::array::from_fn(|k| self.planes[k][pixel]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path_state::PathLight;
    use scene::DVec3;

    /// Light that differs in all of its numbers.
    fn light(path: u32) -> PathLight {
        let vector = |k: usize| DVec3::new(0.1, 0.7, 1.0 / 3.0) * f64::from(path + 1) / (k + 1) as f64;
        PathLight { layers: std::array::from_fn(vector), halves: [vector(7), vector(8)], ..PathLight::default() }
    }

    /// Seen to catch: halves exchanged, the counts of one half for both.
    #[test]
    fn sums_that_were_kept_go_on_to_the_last_bit() {
        for (first, all) in [(2, 4), (3, 8), (16, 64)] {
            let add = |sums: &mut [PixelSum], paths: std::ops::Range<u32>| {
                paths.for_each(|path| sums.iter_mut().for_each(|sum| sum.add(path, false, &light(path))));
            };
            let mut sums = [PixelSum::default(); 2];
            add(&mut sums, 0..first);
            let kept = State::of(first, &sums, None);
            assert_eq!((kept.base, kept.planes.len()), (None, State::PLANES));
            let mut other = [PixelSum::default(); 2];
            kept.restore(&[first; 2], &mut other);
            add(&mut sums, first..all);
            add(&mut other, first..all);
            assert_eq!(format!("{sums:?}"), format!("{other:?}"), "{first} of {all}");
        }
    }
}
