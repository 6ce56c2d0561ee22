//! Scenes that cannot be shown, and why.

use super::prepared_scene::PreparedScene;
use crate::limits::LIMITS;
use crate::scenes::SceneSource;

/// What is said of a scene that is not shown because of its tree.
pub(super) const TREE_TOO_LONG: &str = "its tree of regions would take too long for each picture";

/// A scene that cannot be shown, and why.
pub(super) struct Refusal {
    /// The scene.
    pub source: SceneSource,
    /// One line.
    pub heading: String,
    /// The reasons.
    pub text: String,
}

/// The refusal of a scene that this machine cannot draw in time. `why` begins a sentence.
pub(super) fn too_expensive(scene: &PreparedScene, why: &str) -> Refusal {
    let heading = format!("{} is too much for this machine; the last good scene stays", scene.title());
    // One line each: a small window has no room for long ones.
    let text = format!(
        "{why}; the limit is {:.0} s\n{}\nuse fewer or simpler parts, or make the window smaller",
        LIMITS.picture_seconds_max,
        scene.costs_in_words()
    );
    tracing::warn!("{heading}: {text}");
    Refusal { source: scene.source.clone(), heading, text }
}
