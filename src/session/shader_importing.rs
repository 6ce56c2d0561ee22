//! Shaders that the user opens: each becomes a scene in the folder of the user's scenes, on a thread.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread::Builder;

use super::{Interface, Playback};
use crate::scenes::{ImportedShader, SceneSource, ShaderError, import_shader};

/// The import in progress.
#[derive(Default)]
pub(super) struct ShaderImport(Option<Receiver<Result<ImportedShader, ShaderError>>>);

impl Interface {
    /// Makes a scene of a shader, which is shown when it is ready.
    pub(super) fn import_shader(&mut self, playback: &mut Playback, shader: PathBuf) {
        let Some(folder) = self.folders.own_scenes() else {
            let words = "there is no folder for your own scenes: make a scene with `mariana import`";
            return playback.reports.answer(words.to_owned());
        };
        let (tell, coming) = channel();
        let waker = self.waker.clone();
        // Executing a shader may take longer than a frame.
        let started = Builder::new().name("import".into()).spawn(move || {
            let _ = tell.send(import_shader(&shader, &folder));
            waker.wake();
        });
        match started {
            Ok(_) => self.shader_import = ShaderImport(Some(coming)),
            Err(error) => playback.reports.answer(format!("cannot import the shader: {error}")),
        }
    }

    /// Shows an imported shader. If the import has failed, reports the reason, and the scene stays.
    pub(super) fn update_shader_import(&mut self, playback: &mut Playback) {
        let result = match self.shader_import.0.as_ref().map(Receiver::try_recv) {
            Some(Ok(result)) => Some(result),
            Some(Err(TryRecvError::Disconnected)) => None,
            Some(Err(TryRecvError::Empty)) | None => return,
        };
        self.shader_import = ShaderImport::default();
        match result {
            Some(Ok(ImportedShader { scene, left_out })) => {
                let left_out = match left_out.as_slice() {
                    [] => String::new(),
                    parts => format!("; left out: {}", parts.join("; ")),
                };
                playback.reports.answer(format!("imported as {}{left_out}", scene.display()));
                self.show_file(playback, scene);
            }
            Some(Err(error)) => playback.reports.answer(error.to_string()),
            None => playback.reports.answer("the shader could not be imported".to_owned()),
        }
    }

    pub(super) fn show_file(&mut self, playback: &mut Playback, scene: PathBuf) {
        playback.scene.show_source(SceneSource::File(scene));
        // The file may be in another folder, whose thumbnails are not drawn yet.
        self.thumbnails_ahead = Some(super::panels::thumbnails_ahead_at(crate::clock::now()));
    }
}
