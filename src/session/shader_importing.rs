//! Shaders that the user opens: each becomes a scene in the folder of the user's scenes.

use std::path::PathBuf;

use super::panels::thumbnails_ahead_at;
use super::shader_import::ShaderImport;
use super::{Interface, Playback};
use crate::clock;
use crate::scenes::{ImportedShader, SceneSource};

impl Interface {
    /// Makes a scene of a shader, which is shown when it is ready.
    pub(super) fn import_shader(&mut self, playback: &mut Playback, shader: PathBuf) {
        let Some(folder) = self.folders.own_scenes() else {
            let words = "there is no folder for your own scenes: make a scene with `mariana import`";
            return playback.reports.answer(words);
        };
        match ShaderImport::start(shader, folder, self.waker.clone()) {
            Ok(import) => self.shader_import = import,
            Err(words) => playback.reports.answer(words),
        }
    }

    /// Shows an imported shader. If the import has failed, reports the reason, and the scene stays.
    pub(super) fn update_shader_import(&mut self, playback: &mut Playback) {
        match self.shader_import.result() {
            Some(Ok(ImportedShader { scene, left_out })) => {
                let left_out = match left_out.as_slice() {
                    [] => String::new(),
                    parts => format!("; left out: {}", parts.join("; ")),
                };
                playback.reports.answer(format!("imported as {}{left_out}", scene.display()));
                self.show_file(playback, scene);
            }
            Some(Err(words)) => playback.reports.answer(words),
            None => {}
        }
    }

    pub(super) fn show_file(&mut self, playback: &mut Playback, scene: PathBuf) {
        playback.scene.show_source(SceneSource::File(scene));
        // The file may be in another folder, whose thumbnails are not drawn yet.
        self.thumbnails_ahead = Some(thumbnails_ahead_at(clock::now()));
    }
}
