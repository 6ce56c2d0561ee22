//! The warning about a value that is not a distance.

use super::World;
use crate::lang::Diagnostic;

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
}
