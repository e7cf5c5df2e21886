//! Highlights: the images of lights in surfaces that mirror, as rough surfaces see them (docs/method.md 18.8).
//!
//! A path that a rough surface mirrors meets the image of a lamp in a nearby smooth surface by chance alone: rarely, and
//! then it is bright. Light is therefore sent to surfaces that mirror, and on to rough ones. Where it arrives, it tells
//! where such images are to be looked for.

use crate::lobes::{self, Lobes};
use bsdf::{Bsdf, Surface, View};
use scene::DVec3;

/// The least and the largest angle within which half of the directions of a lobe lie, radians.
const NARROWEST: f64 = 0.02;
const WIDEST: f64 = 0.25;

/// Light that a surface mirrored to a rough one.
#[derive(Clone, Copy, Debug)]
pub struct Highlight {
    /// Where it arrived, m.
    pub at: DVec3,
    /// Where it was mirrored, m.
    pub mirror: DVec3,
    /// In proportion to its flux.
    pub power: f64,
    /// The radiance of the image, W/(m² sr), of the brightest channel.
    pub radiance: f64,
}

/// The highlights of a scene, in the order of a tree: the halves of a node lie on either side of a plane.
#[derive(Debug, Default)]
pub struct Highlights {
    found: Vec<Highlight>,
    /// A heap: node `i` has the children `2i + 1` and `2i + 2`. Points whose coordinate of this index is below this value
    /// belong to the first.
    splits: Vec<(usize, f64)>,
}

impl Highlights {
    /// Those of the light that was found, each with a uniform number that decides whether it is kept. Bright ones are: paths
    /// meet dim ones often enough.
    pub fn bright(found: Vec<(Highlight, f64)>) -> Highlights {
        let sum = |of: &dyn Fn(&Highlight) -> f64| found.iter().map(|(highlight, _)| of(highlight)).sum::<f64>();
        let bright = sum(&|h| h.power * h.radiance) / sum(&|h| h.power);
        let kept = found.into_iter().filter(|(highlight, xi)| highlight.radiance > bright * xi);
        Highlights::new(kept.map(|(highlight, _)| highlight).collect())
    }

    fn new(mut found: Vec<Highlight>) -> Highlights {
        let leaves = found.len().div_ceil(lobes::MOST).next_power_of_two();
        let mut splits = vec![(0, 0.0); 2 * leaves];
        split(&mut found, &mut splits, 0);
        Highlights { found, splits }
    }

    /// The highlights whose light arrived around a point.
    fn around(&self, position: DVec3) -> &[Highlight] {
        let (mut around, mut node) = (&self.found[..], 0);
        while around.len() > lobes::MOST {
            let (axis, value) = self.splits[node];
            let (one, two) = around.split_at(around.len() / 2);
            (around, node) = if position[axis] < value { (one, 2 * node + 1) } else { (two, 2 * node + 2) };
        }
        around
    }

    /// The directions in which a rough surface that is seen so may see highlights, each as likely as its light is seen; none
    /// if there are none. Images move by no more than the point, in front of convex mirrors by less.
    pub fn lobes(&self, at: DVec3, bsdf: &Surface, view: &View) -> Option<Lobes> {
        let mut lobes = Lobes::default();
        for highlight in self.around(at) {
            let (axis, distance) = ((highlight.mirror - at).normalize_or_zero(), highlight.mirror.distance(at));
            let width = 0.5 * at.distance(highlight.at) / distance;
            if width < WIDEST {
                let weight = highlight.power * bsdf.evaluate(view, axis).max_element();
                lobes.add(axis, width.max(NARROWEST), weight);
            }
        }
        (!lobes.is_empty()).then_some(lobes)
    }
}

/// Splits highlights at the median of the longest side of their box, and the halves alike, down to as many as a mixture
/// has lobes.
fn split(found: &mut [Highlight], splits: &mut [(usize, f64)], node: usize) {
    if found.len() <= lobes::MOST {
        return;
    }
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = found.iter().fold(start, |(low, high), h| (low.min(h.at), high.max(h.at)));
    let axis = (high - low).max_position();
    let half = found.len() / 2;
    found.sort_by(|a, b| a.at[axis].total_cmp(&b.at[axis]));
    splits[node] = (axis, found[half].at[axis]);
    let (one, two) = found.split_at_mut(half);
    split(one, splits, 2 * node + 1);
    split(two, splits, 2 * node + 2);
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::random::{Purpose, Stream};

    /// Every highlight is among those around the place where its light arrived, which are never more than a mixture holds.
    ///
    /// Seen to catch: the children of a node changed over; a split beside the median.
    #[test]
    fn highlights_are_found_where_their_light_arrived() {
        let stream = Stream::new(3, Purpose::Highlight);
        for count in [0, 1, lobes::MOST, lobes::MOST + 1, 1000, 4097] {
            let highlight = |k: usize| {
                let at = DVec3::from_array([0, 1, 2].map(|d| stream.item(k as u64).uniform(d)));
                Highlight { at, mirror: DVec3::splat(k as f64), power: 1.0, radiance: 1.0 }
            };
            let all: Vec<Highlight> = (0..count).map(highlight).collect();
            let highlights = Highlights::new(all.clone());
            for one in &all {
                let around = highlights.around(one.at);
                assert!(
                    around.len() <= lobes::MOST && around.iter().any(|h| h.mirror == one.mirror),
                    "{count}: {one:?}"
                );
            }
        }
    }
}
