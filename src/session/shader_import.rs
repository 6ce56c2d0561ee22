//! The import of a shader on a thread.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread::Builder;

use super::waker::Waker;
use crate::scenes::{ImportedShader, import_shader};

/// The import in progress.
#[derive(Default)]
pub(super) struct ShaderImport(Option<Receiver<Result<ImportedShader, String>>>);

impl ShaderImport {
    /// Makes a scene of a shader in a folder. Executing a shader may take longer than a frame.
    pub(super) fn start(shader: PathBuf, folder: PathBuf, waker: Waker) -> Result<Self, String> {
        let (tell, coming) = channel();
        let import = move || {
            let _ = tell.send(import_shader(&shader, &folder).map_err(|error| error.to_string()));
            waker.wake();
        };
        let started = Builder::new().name("import".into()).spawn(import);
        started.map(|_| Self(Some(coming))).map_err(|error| format!("cannot import the shader: {error}"))
    }

    /// Returns the result once: the scene, or the reason why there is none.
    pub(super) fn result(&mut self) -> Option<Result<ImportedShader, String>> {
        let result = match self.0.as_ref()?.try_recv() {
            Ok(result) => result,
            Err(TryRecvError::Disconnected) => Err("the shader could not be imported".to_owned()),
            Err(TryRecvError::Empty) => return None,
        };
        self.0 = None;
        Some(result)
    }
}
