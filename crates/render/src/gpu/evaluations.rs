//! Counts of distance evaluations and other work of a frame.

/// Turns the counting of distance evaluations on or off. Counting makes a renderer slower.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Counting {
    /// Draw images only.
    Off,
    /// Draw images and count [`Evaluations`].
    On,
}

/// Distance evaluations of one image by kind of ray, summed over all pixels and samples.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize)]
pub struct Evaluations {
    /// Along rays from the eye.
    pub primary: f64,
    /// Along mirrored rays.
    pub reflection: f64,
    /// For normals.
    pub normal: f64,
    /// Along rays to lights.
    pub shadow: f64,
    /// For ambient occlusion.
    pub occlusion: f64,
    /// Rays that stopped because they reached the maximum number of steps.
    pub capped_rays: f64,
    /// Clauses of distances and objects that the interpreter ran; 0 for compiled scenes.
    pub clauses: f64,
    /// Clauses of materials and light that the interpreter ran; 0 for compiled scenes.
    pub surface_clauses: f64,
    /// Lookups of the cell that contains a point.
    pub lookups: f64,
    /// Evaluations of media.
    pub media: f64,
    /// Steps through media, including steps through empty space, which need no evaluation.
    pub media_steps: f64,
    /// Nodes and points of swarms that rays tested.
    pub swarm_steps: f64,
    /// Pixels with further samples at edges.
    pub edge_pixels: f64,
}

impl Evaluations {
    /// Evaluations of all kinds.
    pub fn total(&self) -> f64 {
        self.primary + self.reflection + self.normal + self.shadow + self.occlusion
    }
}
