//! What of the version of a text that shows holds for the next one.

use std::time::Duration;

use super::prepared_scene::{FirstTree, PreparedScene};
use super::prepared_scenes::PreparedScenes;
use crate::faults::{self, Fault};

/// A scene whose last tree took longer is tried before it comes on: an edit can make a slow tree too slow.
const TREE_MAX: Duration = Duration::from_millis(50);
/// So does a distance with so many times the clauses that it had, and [`CLAUSES_MORE`].
const CLAUSES_TIMES: usize = 2;
/// See [`CLAUSES_TIMES`].
const CLAUSES_MORE: usize = 64;

/// Whether the scene that is coming is the one that shows with its numbers as constants: it then waits for its own
/// program, because a good one is shown already.
pub(super) fn only_settles(scenes: &PreparedScenes) -> bool {
    let (Some(shown), Some(coming)) = (&scenes.shown, &scenes.coming) else { return false };
    coming.settles && shown.source == coming.source && shown.programs.compiled.is_some()
}

/// The version of a scene that shows, if the new one will be drawn as that one is, as far as can be foreseen. Where it
/// turns out otherwise, the one before is taken back.
pub(super) fn last_version<'a>(
    scenes: &'a PreparedScenes,
    scene: &PreparedScene,
) -> Option<&'a PreparedScene> {
    let last = scenes.shown.as_ref().filter(|_| scenes.is_version_of_shown(scene))?;
    let non_lipschitz = |scene: &PreparedScene| scene.resources.world().non_lipschitz;
    let clauses = |scene: &PreparedScene| scene.resources.buffers().cost.distance;
    let built = last.resources.regions();
    // A busy machine must not turn the test of this fault into one of something else.
    let is_quick = |time: Duration| time <= TREE_MAX || faults::is_wanted(Fault::SlowTree);
    let is_alike = last.tree != FirstTree::TooLong
        && built.is_some_and(|built| is_quick(built.time))
        && (non_lipschitz(last) || !non_lipschitz(scene))
        && clauses(scene) <= CLAUSES_TIMES * clauses(last) + CLAUSES_MORE;
    is_alike.then_some(last)
}
