//! Counts of what happens while an image is rendered.

/// Counts of the events on the paths of an image.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    pub paths: u64,
    /// Paths that met their first translucent surface from outside.
    pub from_outside: u64,
    /// Paths that met their first translucent surface from within: the camera is inside a medium, or looks into an open
    /// mesh.
    pub from_inside: u64,
    /// Rays that tell what paths meet, and what light meets that is sent to find highlights. Rays of edge pixels and near
    /// points are counted apart; those through pixel centers, for normals and positions, are not counted.
    pub rays: u64,
    /// Rays that tell whether a light is visible, of paths and of the light that is sent.
    pub shadow_rays: u64,
    pub gathers: u64,
    pub evaluations: u64,
    /// Points around exitant points that were lit, and the rays that were traced for them.
    pub near_points: u64,
    pub near_rays: u64,
    /// Nodes of the trees over the samples that were visited.
    pub nodes: u64,
    /// Paths that were ended by the depth limit, so that their light is missing.
    pub cut_by_depth: u64,
    /// Paths that left a medium without meeting its surface, because the mesh is open.
    pub escaped_inside: u64,
    /// Outer surfaces that were met from inside a medium and passed undeflected, because objects overlap.
    pub nested: u64,
    /// Points at which the interpolated normal contradicts the triangle, so that the triangle's own was used.
    pub geometric_normals: u64,
    /// Edge pixels, in which more rays than paths measure the transmittance of the first interface.
    pub edge_pixels: u64,
    /// Rays of edge pixels, and the rays that search for them.
    pub edge_rays: u64,
    /// Random walks, their simulated collisions, and the connections of these to lights, blocked ones included.
    pub walks: u64,
    pub collisions: u64,
    pub connections: u64,
    /// Directional lights whose reflections inside were left out, as there are too many.
    pub reflections_left_out: u64,
    /// Walks that left their medium through a hole of its surface.
    pub walks_escaped: u64,
    /// Walks that were reflected inside without end, see [`walks::MAX_REFLECTIONS`].
    pub walks_trapped: u64,
    /// Walks that met an opaque surface inside a medium.
    pub walks_absorbed_inside: u64,
}

impl Counts {
    /// Adds the work of near fields.
    pub fn near_field(&mut self, work: &near_field::Work) {
        self.near_points += work.points;
        self.near_rays += work.rays;
    }

    pub fn add(&mut self, other: &Counts) {
        self.paths += other.paths;
        self.from_outside += other.from_outside;
        self.from_inside += other.from_inside;
        self.rays += other.rays;
        self.shadow_rays += other.shadow_rays;
        self.gathers += other.gathers;
        self.evaluations += other.evaluations;
        self.near_points += other.near_points;
        self.near_rays += other.near_rays;
        self.nodes += other.nodes;
        self.cut_by_depth += other.cut_by_depth;
        self.escaped_inside += other.escaped_inside;
        self.nested += other.nested;
        self.geometric_normals += other.geometric_normals;
        self.edge_pixels += other.edge_pixels;
        self.edge_rays += other.edge_rays;
        self.walks += other.walks;
        self.collisions += other.collisions;
        self.connections += other.connections;
        self.reflections_left_out += other.reflections_left_out;
        self.walks_escaped += other.walks_escaped;
        self.walks_trapped += other.walks_trapped;
        self.walks_absorbed_inside += other.walks_absorbed_inside;
    }
}
