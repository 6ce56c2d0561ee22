//! Scenes that cannot be shown, with the reasons.

use super::prepared_scene::PreparedScene;
use crate::limits;
use crate::scenes::SceneSource;

pub(super) const TREE_TOO_LONG: &str = "building its region tree takes too long for every frame";

pub(super) struct Refusal {
    pub source: SceneSource,
    pub heading: String,
    pub text: String,
}

/// The refusal of a scene that is too slow on this machine. `why` is the beginning of a sentence.
pub(super) fn too_expensive(scene: &PreparedScene, why: &str) -> Refusal {
    let heading = format!("{} is too much for this machine; the last good scene stays", scene.title());
    // Each sentence gets a line, because a small window has no room for long lines.
    let text = format!(
        "{why}; the limit is {:.0} s\n{}\nuse fewer or simpler parts, or make the window smaller",
        limits::PICTURE_SECONDS_MAX,
        scene.costs_in_words()
    );
    tracing::warn!("{heading}: {text}");
    Refusal { source: scene.source.clone(), heading, text }
}
