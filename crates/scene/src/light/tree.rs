//! A hierarchy of lights by their bounds (after Conty Estevez and Kulla 2018, importance sampling of many lights).

use super::{
    bounds::{LightBounds, LightSphere, ReceiverBounds},
    contract::Light,
};
use crate::mesh::{SurfacePoint, bounds};
use glam::DVec3;

/// Up to this number, lights with bounds are weighed one by one, without a tree.
pub(super) const MAX_FLAT: usize = 16;

/// The least importance of a node, as a share of the irradiance with the largest cosine: lights that the center of a
/// receiver does not see may light the rest of it.
const MIN_SHARE: f64 = 0.5;

/// Lights, ready to choose from.
pub struct LightTree<'a> {
    pub(super) lights: Vec<&'a dyn Light>,
    /// Indices of the lights that are weighed at each point: those without bounds, or all if they are few.
    pub(super) single: Vec<u32>,
    /// The lights without bounds.
    distant: Vec<&'a dyn Light>,
    /// The lights that are surfaces, by their material.
    surfaces: Vec<(u16, &'a dyn Light)>,
    /// The root first; the first child of a node follows it.
    nodes: Vec<Node>,
    /// Indices of the nodes of single lights.
    pub(super) leaves: Vec<u32>,
}

struct Node {
    sphere: LightSphere,
    kind: Kind,
}

/// The children of a node or its light, by index.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    /// Two nodes.
    Inner([u32; 2]),
    /// A light.
    Leaf(u32),
}

impl<'a> LightTree<'a> {
    pub fn new(lights: impl IntoIterator<Item = &'a dyn Light>) -> LightTree<'a> {
        let lights: Vec<&dyn Light> = lights.into_iter().collect();
        let indices = 0..lights.len() as u32;
        let mut bounded: Vec<(u32, LightBounds)> =
            indices.clone().filter_map(|k| Some((k, lights[k as usize].bounds()?))).collect();
        let is_flat = bounded.len() <= MAX_FLAT;
        let single = indices.filter(|k| is_flat || lights[*k as usize].bounds().is_none()).collect();
        let distant = lights.iter().copied().filter(|light| light.bounds().is_none()).collect();
        let mut surfaces: Vec<(u16, &dyn Light)> =
            lights.iter().filter_map(|light| Some((light.material()?, *light))).collect();
        surfaces.sort_by_key(|(material, _)| *material);
        let mut tree = LightTree { lights, single, distant, surfaces, nodes: Vec::new(), leaves: Vec::new() };
        if !is_flat {
            tree.add(&mut bounded);
        }
        tree
    }

    /// Adds the node of these lights and those below it: halves across the longest edge of the box of their centers.
    fn add(&mut self, lights: &mut [(u32, LightBounds)]) {
        let all = lights.iter().skip(1).fold(lights[0].1, |all, (_, bounds)| all.join(bounds));
        let index = self.nodes.len();
        self.nodes.push(Node { sphere: LightSphere::new(&all), kind: Kind::Leaf(lights[0].0) });
        if lights.len() == 1 {
            self.leaves.push(index as u32);
            return;
        }
        let (low, high) = bounds(lights.iter().map(|(_, b)| b.center()));
        let axis = (high - low).max_position();
        // Between equal centers the index of the light decides, so that there is only one order.
        lights.sort_by(|(i, a), (j, b)| a.center()[axis].total_cmp(&b.center()[axis]).then(i.cmp(j)));
        let (one, two) = lights.split_at_mut(lights.len() / 2);
        self.add(one);
        self.nodes[index].kind = Kind::Inner([index as u32 + 1, self.nodes.len() as u32]);
        self.add(two);
    }

    /// True if all lights are weighed at each point.
    pub fn is_flat(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Radiance that a ray sees which leaves the scene in this unit direction, W/(m² sr): that of the distant lights.
    /// Others show it on their own surfaces.
    pub fn distant_radiance(&self, origin: DVec3, direction: DVec3) -> DVec3 {
        self.distant.iter().map(|light| light.radiance(origin, direction)).sum()
    }

    /// The same for a direction that was drawn with a density, 1/sr, at a point whose light is sampled as well: the share
    /// that each light leaves to such rays by the balance heuristic.
    pub fn distant_radiance_by(&self, at: &SurfacePoint, direction: DVec3, density: f64) -> DVec3 {
        let share = |light: &&dyn Light| density / (density + light.pdf_solid_angle(at, direction));
        let one = |light: &&dyn Light| light.radiance(at.position, direction) * share(light);
        self.distant.iter().map(one).sum()
    }

    /// The share of the light of an emitting material that is left to a ray by the balance heuristic, as above.
    pub fn share_of_surface(&self, material: u16, at: &SurfacePoint, direction: DVec3, density: f64) -> f64 {
        let found = self.surfaces.binary_search_by_key(&material, |(material, _)| *material);
        let sampled = found.map_or(0.0, |k| self.surfaces[k].1.pdf_solid_angle(at, direction));
        density / (density + sampled)
    }

    pub(super) fn kind(&self, node: u32) -> Kind {
        self.nodes[node as usize].kind
    }

    /// An estimate of the irradiance by a node's lights, positive if any of them can light the receiver, W/m².
    pub(super) fn importance(&self, node: u32, receiver: &ReceiverBounds) -> f64 {
        let Node { sphere, kind } = &self.nodes[node as usize];
        let [at_center, max] = sphere.irradiance(receiver);
        let at_center = match kind {
            Kind::Leaf(light) if max > 0.0 && sphere.falls_off() => {
                self.lights[*light as usize].importance(&receiver.center)
            }
            _ => at_center,
        };
        // The sum of a list of these must be finite.
        at_center.min(f64::MAX / 1e9).max(MIN_SHARE * max)
    }

    pub(super) fn is_near(&self, node: u32, receiver: &ReceiverBounds) -> bool {
        self.nodes[node as usize].sphere.is_near(receiver)
    }
}
