//! The sums of an image as numbers, which a file can keep: with them, more paths can be added later, and the image is
//! to the last bit the one that would have been rendered at once.

use crate::{allotment::Allotment, edge::Edge, pixel_sum::PixelSum};
use scene::random::Stream;

/// Numbers of a pixel's sums, and of those of an edge pixel.
const OF_PIXEL: usize = PixelSum::NUMBERS;
const OF_EDGE: usize = Edge::NUMBERS;

/// The sums of an image.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Paths that each pixel has, or that all share for each.
    pub paths: u32,
    /// Paths of each pixel before they were shared, if they are.
    pub base: Option<u32>,
    /// One plane of numbers for each sum, with one for each pixel; those of edge pixels come last, and are 0 elsewhere.
    /// If paths are shared, one more plane has the pixels' shares.
    pub planes: Vec<Vec<f64>>,
}

impl State {
    /// The number of planes of sums.
    pub const PLANES: usize = OF_PIXEL + OF_EDGE;

    pub(crate) fn of(
        paths: u32,
        sums: &[PixelSum],
        edges: &[Option<Box<Edge>>],
        allotment: Option<&Allotment>,
    ) -> State {
        let mut planes: Vec<Vec<f64>> = (0..State::PLANES).map(|_| Vec::with_capacity(sums.len())).collect();
        for (sum, edge) in sums.iter().zip(edges) {
            let of_edge = edge.as_ref().map_or([0.0; OF_EDGE], |edge| edge.numbers());
            planes.iter_mut().zip(sum.numbers().into_iter().chain(of_edge)).for_each(|(plane, x)| plane.push(x));
        }
        planes.extend(allotment.map(|allotment| allotment.shares.clone()));
        State { paths, base: allotment.map(|allotment| allotment.base), planes }
    }

    /// The shares of the pixels, if they share their paths.
    pub(crate) fn allotment(&self, rounding: Stream) -> Option<Allotment> {
        Some(Allotment::new(self.base?, self.planes.get(State::PLANES)?.clone(), rounding))
    }

    /// Replaces the sums of pixels that have so many paths. Which pixels are edges does not change.
    pub(crate) fn restore(&self, paths: &[u32], sums: &mut [PixelSum], edges: &mut [Option<Box<Edge>>]) {
        for (pixel, (sum, edge)) in sums.iter_mut().zip(edges).enumerate() {
            *sum = PixelSum::from_numbers(paths[pixel], std::array::from_fn(|k| self.planes[k][pixel]));
            if let Some(edge) = edge {
                let numbers = std::array::from_fn(|k| self.planes[OF_PIXEL + k][pixel]);
                **edge = Edge::from_numbers(paths[pixel], numbers);
            }
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
        PathLight {
            layers: std::array::from_fn(vector),
            halves: [vector(7), vector(8)],
            through: 0.3 / f64::from(path + 1),
        }
    }

    /// Seen to catch: halves exchanged, the counts of one half for both, rays left out.
    #[test]
    fn sums_that_were_kept_go_on_to_the_last_bit() {
        for (first, all) in [(2, 4), (3, 8), (16, 64)] {
            let (mut sums, mut edges) = ([PixelSum::default(); 2], [None, Some(Box::<Edge>::default())]);
            let add = |sums: &mut [PixelSum], edges: &mut [Option<Box<Edge>>], paths: std::ops::Range<u32>| {
                for path in paths {
                    sums.iter_mut().for_each(|sum| sum.add(path, false, &light(path)));
                    for edge in edges.iter_mut().flatten() {
                        edge.add_path(path as usize % 2, &light(path));
                        (0..crate::edge::RAYS).for_each(|ray| {
                            edge.add_ray(path as usize % 2, 1.0 / f64::from(path + ray + 1));
                        });
                    }
                }
            };
            add(&mut sums, &mut edges, 0..first);
            let kept = State::of(first, &sums, &edges, None);
            assert_eq!((kept.base, kept.planes.len()), (None, State::PLANES));
            let (mut other, mut other_edges) = ([PixelSum::default(); 2], [None, Some(Box::default())]);
            kept.restore(&[first; 2], &mut other, &mut other_edges);
            add(&mut sums, &mut edges, first..all);
            add(&mut other, &mut other_edges, first..all);
            assert_eq!(format!("{sums:?} {edges:?}"), format!("{other:?} {other_edges:?}"), "{first} of {all}");
        }
    }
}
