//! Finds the scenes of a show, and facts about these scenes.

use std::path::Path;

use crate::scenes::{SceneError, SceneSource};
use mariana_show::{Refusal, SceneFacts};

pub(super) fn facts_of(source: &SceneSource) -> Result<SceneFacts, SceneError> {
    source.checked().map(SceneFacts::from)
}

pub(super) fn refusal(error: SceneError) -> Refusal {
    match error {
        SceneError::Mistakes { name, plain, .. } => {
            Refusal { sentence: format!("the scene {name} has mistakes"), mistakes: Some(plain) }
        }
        error => Refusal { sentence: error.to_string(), mistakes: None },
    }
}

/// Returns the scene with this name in a show: a file in its folder, or a shipped scene.
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
