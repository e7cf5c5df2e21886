//! Lights in a tree of bounds (after Conty Estevez and Kulla 2018, importance sampling of many lights).

use super::{
    Light,
    bounds::{LightBounds, LightSphere},
    receiver::ReceiverBounds,
};

/// So few lights are weighed one by one.
pub(super) const FEW: usize = 16;

/// Share of the most light that may arrive which a light is weighed by at least: what the middle of a region does not
/// see may light the rest of it.
const MIN_SHARE: f64 = 0.5;

/// Lights, ready to choose from.
pub struct LightTree<'a> {
    pub(super) lights: &'a [Box<dyn Light>],
    /// Lights that are weighed at each point: those without bounds, or all if there are few.
    pub(super) single: Vec<u32>,
    /// The first is the root; the first child of a node follows it.
    nodes: Vec<Node>,
    /// Nodes of single lights.
    leaves: Vec<u32>,
}

struct Node {
    sphere: LightSphere,
    kind: Kind,
}

/// What a node stands for.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    /// Two nodes.
    Inner([u32; 2]),
    /// A light.
    Leaf(u32),
}

impl<'a> LightTree<'a> {
    pub fn new(lights: &'a [Box<dyn Light>]) -> LightTree<'a> {
        let numbers = 0..lights.len() as u32;
        let mut placed: Vec<(u32, LightBounds)> =
            numbers.filter_map(|k| Some((k, lights[k as usize].bounds()?))).collect();
        if placed.len() <= FEW {
            placed.clear();
        }
        let mut in_tree = vec![false; lights.len()];
        placed.iter().for_each(|(k, _)| in_tree[*k as usize] = true);
        let single = (0..lights.len() as u32).filter(|k| !in_tree[*k as usize]).collect();
        let mut tree = LightTree { lights, single, nodes: Vec::new(), leaves: Vec::new() };
        if !placed.is_empty() {
            tree.add(&mut placed);
        }
        tree
    }

    /// Adds the node of these lights and those below it: halves across the longest edge of the box of their centres.
    fn add(&mut self, lights: &mut [(u32, LightBounds)]) {
        let all = lights.iter().skip(1).fold(lights[0].1, |all, (_, e)| all.join(e));
        let index = self.nodes.len();
        self.nodes.push(Node { sphere: LightSphere::new(&all), kind: Kind::Leaf(lights[0].0) });
        if lights.len() == 1 {
            self.leaves.push(index as u32);
            return;
        }
        let first = lights[0].1.centre();
        let (low, high) =
            lights.iter().fold((first, first), |(low, high), (_, e)| (low.min(e.centre()), high.max(e.centre())));
        let axis = (high - low).max_position();
        // The number of a light decides between equals, so that the order is one.
        lights.sort_by(|(i, a), (j, b)| a.centre()[axis].total_cmp(&b.centre()[axis]).then(i.cmp(j)));
        let (one, two) = lights.split_at_mut(lights.len() / 2);
        self.add(one);
        self.nodes[index].kind = Kind::Inner([index as u32 + 1, self.nodes.len() as u32]);
        self.add(two);
    }

    /// True if all lights are weighed at each point.
    pub fn is_flat(&self) -> bool {
        self.nodes.is_empty()
    }

    pub(super) fn leaves(&self) -> &[u32] {
        &self.leaves
    }

    pub(super) fn kind(&self, node: u32) -> Kind {
        self.nodes[node as usize].kind
    }

    /// A number near the light that arrives from a node, positive if any can, W/m².
    pub(super) fn importance(&self, node: u32, region: &ReceiverBounds) -> f64 {
        let Node { sphere, kind } = &self.nodes[node as usize];
        let [middle, most] = sphere.arriving(region);
        let middle = match kind {
            Kind::Leaf(light) if most > 0.0 && sphere.falls_off() => {
                self.lights[*light as usize].importance(&region.middle)
            }
            _ => middle,
        };
        // Lists of them are added up.
        middle.min(f64::MAX / 1e9).max(MIN_SHARE * most)
    }

    pub(super) fn is_near(&self, node: u32, region: &ReceiverBounds) -> bool {
        self.nodes[node as usize].sphere.is_near(region)
    }
}
