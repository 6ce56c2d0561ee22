//! A scene in whose text numbers are being changed needs no compiler: it takes over the program of its last version.

use std::rc::Rc;
use std::time::Duration;

use super::{Cast, SceneStage, Task};
use crate::gpu::program::Program;
use mariana_field::world::World;

/// How long nobody changes a number before all of them become constants of a program again.
const REST: Duration = Duration::from_secs(10);

/// Whether numbers of its text are read as inputs.
fn is_changing(cast: &Cast) -> bool {
    let world = cast.resources.world();
    // The share of a blend is no number of a text.
    world.blended.is_none() && world.scene.params.iter().any(|param| param.is_number)
}

impl SceneStage {
    /// The program of a scene that is there and differs from this one in nothing that is compiled. If that program is
    /// still being made, it is made for the scene with the number `id` from now on.
    /// Also tells whether it can look up the cells of a tree.
    pub(super) fn inherited_program(&mut self, id: u64, world: &World) -> Option<(Rc<Program>, bool)> {
        let alike: Vec<&Cast> =
            self.casts().filter(|cast| cast.resources.world().is_compiled_like(world)).collect();
        let program = alike.iter().find_map(|cast| Some((cast.compiled.clone()?, cast.has_cells)));
        if program.is_none() {
            let alike: Vec<u64> = alike.iter().map(|cast| cast.id).collect();
            for task in self.tasks.values_mut() {
                if let Task::Compiled { id: of, .. } = task
                    && alike.contains(of)
                {
                    *of = id;
                    break;
                }
            }
        }
        program
    }

    /// Whether the scene that is coming is the one on the stage with its numbers as constants: it then waits for its
    /// own program, because a good one is shown already.
    pub(super) fn coming_only_settles(&self) -> bool {
        let (Some(shown), Some(coming)) = (&self.on_stage, &self.coming) else { return false };
        coming.settles && shown.source == coming.source && shown.compiled.is_some()
    }

    /// Asks for the scene again when nobody has changed a number for a while.
    pub(super) fn settle_numbers(&mut self) {
        let Some(shown) = self.on_stage.as_mut().filter(|cast| is_changing(cast)) else { return };
        if shown.since.elapsed() > REST
            && !shown.is_resting
            && shown.source == self.source
            && self.coming.is_none()
        {
            shown.is_resting = true;
            self.loader.request(self.source.clone());
        }
    }
}
