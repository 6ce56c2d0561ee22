//! Warnings about a value that is not a distance, and about a camera inside of an object.

use super::World;
use crate::graph::{FrameInputs, Point};
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

    /// Returns the object whose body contains a point. An eye there sees only the body's inside. Planes have no
    /// inside, and one can look through glass. `inputs` have the hoisted values.
    pub fn object_around(&self, [x, y, z]: [f32; 3], inputs: &FrameInputs) -> Option<&Object> {
        let roots = [self.roots.distance[1], self.roots.object];
        let values = self.graph.evaluate(&roots, &Point::at(x, y, z), inputs).ok()?;
        let [distance, number] = values.first_chunk()?;
        let object = self.scene.objects.get(*number as usize).filter(|_| self.has_rest && *distance < 0.0)?;
        let glass = self.scene.materials.get(object.material)?.glass;
        self.scene.graph.as_constant(glass).is_some_and(|glass| glass <= 0.0).then_some(object)
    }
}
