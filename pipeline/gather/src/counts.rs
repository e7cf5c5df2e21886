//! What is counted while an image is rendered.

/// What happened on the paths of an image.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    pub paths: u64,
    /// Paths the first translucent surface of which they met from its outside.
    pub from_outside: u64,
    /// The same from within: the camera stands inside a medium, or looks into an open mesh.
    pub from_inside: u64,
    pub rays: u64,
    pub shadow_rays: u64,
    pub gathers: u64,
    pub evaluations: u64,
    /// Nodes of the samples' trees that were looked at.
    pub nodes: u64,
    /// Paths ended by the depth limit: their light is missing.
    pub cut_by_depth: u64,
    /// Paths that left a medium without meeting its surface: the mesh is open.
    pub escaped_inside: u64,
    /// Outer surfaces met from inside a medium, passed straight: objects overlap.
    pub nested: u64,
    /// Points where the interpolated normal contradicts the triangle, whose own normal was taken.
    pub geometric_normals: u64,
    /// Pixels whose share of light that gets through is known from more rays than paths.
    pub edge_pixels: u64,
    /// Those rays, and the ones that look for such pixels.
    pub edge_rays: u64,
}

impl Counts {
    pub fn add(&mut self, other: &Counts) {
        self.paths += other.paths;
        self.from_outside += other.from_outside;
        self.from_inside += other.from_inside;
        self.rays += other.rays;
        self.shadow_rays += other.shadow_rays;
        self.gathers += other.gathers;
        self.evaluations += other.evaluations;
        self.nodes += other.nodes;
        self.cut_by_depth += other.cut_by_depth;
        self.escaped_inside += other.escaped_inside;
        self.nested += other.nested;
        self.geometric_normals += other.geometric_normals;
        self.edge_pixels += other.edge_pixels;
        self.edge_rays += other.edge_rays;
    }
}
