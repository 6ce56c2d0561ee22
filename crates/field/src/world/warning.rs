//! Warnings about a value that is not a distance, and about a camera inside of an object.

use super::World;
use crate::graph::{FrameInputs, NodeId, Point};
use crate::lang::{Diagnostic, Object};

impl World {
    /// Returns a warning if the shape's value is not a distance and a factor makes it one; at the first object. A formula
    /// without such a factor is drawn as its author wrote it.
    pub fn warning(&self) -> Option<Diagnostic> {
        let object = self.scene.objects.first().filter(|_| self.non_lipschitz)?;
        let factor = self.slopes.distance_factor?;
        let message =
            "the shape's value is not a distance, so rays take short steps and its shadows are sharp";
        let hint = format!("multiply the value by {factor:.2} to make it a distance");
        Some(Diagnostic::warning(object.span, message).hint(hint))
    }

    /// Returns the object whose body contains a place, so that an eye there sees nothing but its inside. One can look
    /// through glass.
    pub fn object_around(&self, [x, y, z]: [f32; 3], inputs: &FrameInputs) -> Option<&Object> {
        let scene = &self.scene;
        let is_opaque = |object: &&Object| {
            let glass = scene.materials.get(object.material).map(|material| material.glass);
            glass.and_then(|glass| scene.graph.as_constant(glass)).is_some_and(|glass| glass <= 0.0)
        };
        let objects: Vec<&Object> = scene.objects.iter().filter(is_opaque).collect();
        let shapes: Vec<NodeId> = objects.iter().map(|object| object.shape).collect();
        let values = scene.graph.evaluate(&shapes, &Point::at(x, y, z), inputs).ok()?;
        objects.into_iter().zip(values).find(|(_, value)| *value < 0.0).map(|(object, _)| object)
    }
}
