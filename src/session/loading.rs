//! Starts the scene loaders and the frame senders before the window opens.

use std::time::Duration;

use super::SessionError;
use super::frame_senders::Sends;
use super::scene::{LoadedScene, SceneLoader, SceneLoaders};
use super::waker::Waker;
use crate::config::PlaySettings;
use crate::export::painter::SceneChoice;
use crate::scenes::{Drafts, Findings, Loader, NumberEdits, SceneSource, TextureCache};

pub(crate) struct BackgroundWork {
    pub(crate) loaders: SceneLoaders,
    pub(crate) first: LoadedScene,
    pub(crate) drafts: Drafts,
    pub(crate) sends: Sends,
}

impl BackgroundWork {
    /// Starts the senders and the loaders, and waits for the first scene.
    ///
    /// # Errors
    /// Fails if a sender or the scene fails, or the system has no thread left.
    pub(crate) fn start(
        settings: &PlaySettings,
        scene: &SceneChoice,
        waker: &Waker,
    ) -> Result<Self, SessionError> {
        // Start the senders first, so that a failing sender ends the program before a window opens.
        let size = settings.send_size.unwrap_or(settings.size);
        let sends = Sends::start(&settings.sends, size, settings.send_fps)?;
        let drafts = Drafts::default();
        let (loaders, first) = load_first(scene, settings.prepare_ahead, waker, &drafts)?;
        Ok(Self { loaders, first, drafts, sends })
    }
}

/// Starts loaders for the shown scene and, if `prepares_ahead`, for its neighbours. Waits for the first scene.
///
/// # Errors
/// Fails if the scene cannot be shown, or the system has no thread left.
fn load_first(
    scene: &SceneChoice,
    prepares_ahead: bool,
    waker: &Waker,
    drafts: &Drafts,
) -> Result<(SceneLoaders, LoadedScene), SessionError> {
    let loader = start_loader(waker, drafts)?;
    loader.request(scene.source.clone());
    let first = loop {
        match loader.poll() {
            Some(loaded) => break LoadedScene { source: loaded.source, scene: loaded.value? },
            None => std::thread::sleep(Duration::from_millis(1)),
        }
    };
    let ahead = match prepares_ahead {
        true => Some([start_loader(waker, drafts)?, start_loader(waker, drafts)?]),
        false => None,
    };
    Ok((SceneLoaders { shown: loader, ahead }, first))
}

fn start_loader(waker: &Waker, drafts: &Drafts) -> Result<SceneLoader, SessionError> {
    let (mut textures, mut edits) = (TextureCache::default(), NumberEdits::default());
    let waker = waker.clone();
    let drafts = drafts.clone();
    let load = move |source: &SceneSource| {
        let texts = drafts.texts();
        let (result, files) = source.ready_with(&mut textures, &mut edits, &texts);
        drafts.tell(Findings::of(source, &texts, &result));
        (result, files)
    };
    Loader::start(load, move || waker.wake())
        .map_err(|error| SessionError::Window { doing: "a thread", reason: error.to_string() })
}
