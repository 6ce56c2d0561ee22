//! Finds the scenes of shows, and facts about them.

use std::path::Path;

use crate::scenes::{SceneError, SceneSource};
use mariana_show::{Refusal, SceneFacts};

/// Compiles a scene.
///
/// # Errors
/// Mistakes in the scene, or an unreadable file.
pub(super) fn facts_of(source: &SceneSource) -> Result<SceneFacts, SceneError> {
    source.checked().map(SceneFacts::from)
}

/// The error as a refusal of the scene.
pub(super) fn refusal(error: SceneError) -> Refusal {
    match error {
        SceneError::Mistakes { name, plain, .. } => {
            Refusal { sentence: format!("the scene {name} has mistakes"), mistakes: Some(plain) }
        }
        error => Refusal { sentence: error.to_string(), mistakes: None },
    }
}

/// The scene that a show means by a name: a file in its folder, or a shipped scene.
pub(super) fn source_of(name: &str, folder: &Path) -> Result<SceneSource, SceneError> {
    let beside = folder.join(name);
    if beside.is_file() {
        return Ok(SceneSource::File(beside));
    }
    match SceneSource::find(name)? {
        SceneSource::File(_) => Ok(SceneSource::File(beside)),
        found => Ok(found),
    }
}
