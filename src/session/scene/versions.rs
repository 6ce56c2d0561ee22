//! Comparison of a new version of a text with the shown version.

use std::time::Duration;

use super::prepared_scene::{FirstTree, PreparedScene};
use super::prepared_scenes::PreparedScenes;
use crate::faults::{self, Fault};

/// If the last tree took longer than this, a new version gets a trial tree: an edit can make a slow tree too slow.
const TREE_MAX: Duration = Duration::from_millis(50);
/// A new version also gets a trial tree if it has more clauses than this factor times those of the last version, plus
/// [`CLAUSES_MORE`].
const CLAUSES_TIMES: usize = 2;
/// Clauses that an edit may add in any case.
const CLAUSES_MORE: usize = 64;

/// True if the coming scene only turns numbers into constants again. It can wait: the shown program draws the same.
pub(super) fn only_settles(scenes: &PreparedScenes) -> bool {
    let (Some(shown), Some(coming)) = (&scenes.shown, &scenes.coming) else { return false };
    coming.settles && shown.source == coming.source && shown.programs.compiled.is_some()
}

/// Returns the shown version of `scene` if both should cost about the same. It replaces a `scene` that is too slow.
pub(super) fn last_version<'a>(
    scenes: &'a PreparedScenes,
    scene: &PreparedScene,
) -> Option<&'a PreparedScene> {
    let last = scenes.shown.as_ref().filter(|_| scenes.is_version_of_shown(scene))?;
    let non_lipschitz = |scene: &PreparedScene| scene.resources.world().non_lipschitz;
    let clauses = |scene: &PreparedScene| scene.resources.buffers().cost.distance;
    let built = last.resources.regions();
    // This fault is tested on busy machines too, where every tree may be slow.
    let is_quick = |time: Duration| time <= TREE_MAX || faults::is_wanted(Fault::SlowTree);
    let is_alike = last.tree != FirstTree::TooLong
        && built.is_some_and(|built| is_quick(built.time))
        && (non_lipschitz(last) || !non_lipschitz(scene))
        && clauses(scene) <= CLAUSES_TIMES * clauses(last) + CLAUSES_MORE;
    is_alike.then_some(last)
}
