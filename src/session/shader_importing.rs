//! Shaders that the user opens: each becomes a scene in the folder of the user's scenes.

use std::path::PathBuf;

use mariana_work::once;

use super::panels::thumbnails_ahead_at;
use super::{Interface, Playback};
use crate::clock;
use crate::scenes::{ImportedShader, SceneSource, import_shader};

impl Interface {
    /// Makes a scene of a shader, which is shown when it is ready.
    pub(super) fn import_shader(&mut self, playback: &mut Playback, shader: PathBuf) {
        let Some(folder) = self.folders.own_scenes() else {
            let words = "there is no folder for your own scenes: make a scene with `mariana import`";
            return playback.reports.answer(words);
        };
        // Executing a shader may take longer than a frame.
        match once("import", self.waker.waking(), move || import_shader(&shader, &folder)) {
            Ok(import) => self.shader_import = import,
            Err(error) => playback.reports.answer(format!("cannot import the shader: {error}")),
        }
    }

    /// Shows an imported shader. If the import has failed, reports the reason, and the scene stays.
    pub(super) fn update_shader_import(&mut self, playback: &mut Playback) {
        match self.shader_import.poll() {
            Some(Ok(Ok(ImportedShader { scene, notes }))) => {
                let words = [vec![format!("imported as {}", scene.display())], notes].concat();
                playback.reports.answer(words.join("; "));
                self.show_file(playback, scene);
            }
            Some(Ok(Err(error))) => playback.reports.answer(error.to_string()),
            Some(Err(_)) => playback.reports.answer("the shader could not be imported"),
            None => {}
        }
    }

    pub(super) fn show_file(&mut self, playback: &mut Playback, scene: PathBuf) {
        playback.scene.show_source(SceneSource::File(scene));
        // The file may be in another folder, whose thumbnails are not drawn yet.
        self.thumbnails_ahead = Some(thumbnails_ahead_at(clock::now()));
    }
}
