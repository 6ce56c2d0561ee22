//! The counts of a counting renderer.

/// Whether a renderer counts distance evaluations (slower) or not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Counting {
    /// Pictures only.
    Off,
    /// Pictures and [`Evaluations`].
    On,
}

/// Distance evaluations of one picture, summed over its pixels and samples, by kind of ray.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize)]
pub struct Evaluations {
    /// Along rays from the eye.
    pub primary: f64,
    /// Along mirrored rays.
    pub reflection: f64,
    /// For normals.
    pub normal: f64,
    /// Along rays to the lamp.
    pub shadow: f64,
    /// For ambient occlusion.
    pub occlusion: f64,
    /// Rays that ended at their step cap.
    pub capped_rays: f64,
    /// Clauses of distances and objects that the interpreter ran; 0 for compiled scenes.
    pub clauses: f64,
    /// The same for materials and light.
    pub surface_clauses: f64,
    /// Searches for the cell of a point.
    pub lookups: f64,
    /// Pixels that got the samples of an edge.
    pub edge_pixels: f64,
}

impl Evaluations {
    /// Evaluations of all kinds.
    pub fn total(&self) -> f64 {
        self.primary + self.reflection + self.normal + self.shadow + self.occlusion
    }

    /// The same, divided by a number of pixels.
    pub fn per_pixel(&self, pixels: f64) -> Self {
        Self {
            primary: self.primary / pixels,
            reflection: self.reflection / pixels,
            normal: self.normal / pixels,
            shadow: self.shadow / pixels,
            occlusion: self.occlusion / pixels,
            capped_rays: self.capped_rays / pixels,
            clauses: self.clauses / pixels,
            surface_clauses: self.surface_clauses / pixels,
            lookups: self.lookups / pixels,
            edge_pixels: self.edge_pixels / pixels,
        }
    }
}
