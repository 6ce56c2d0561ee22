//! Starts the scene loaders before the window opens.
//!
//! **No scene can prevent the start.** The window opens while a large scene is still loading. If the process died while
//! a scene was being loaded, the next run does not load this scene by itself: a mark file tells.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use super::SessionError;
use super::opening::Prepared;
use super::scene::{LoadedScene, SceneLoader, SceneLoaders};
use super::waker::Waker;
use crate::attempt::{self, Attempt};
use crate::clock;
use crate::export::print_message;
use crate::scenes::{Drafts, Findings, Loader, NumberEdits, SceneError, SceneSource, TextureCache};

/// Longest wait for the first scene before the window opens. A mistake found until then ends the program without one.
const WINDOW_WAIT: Duration = Duration::from_millis(500);
/// Longest wait for the scene of the last show.
const RESUMED_WAIT: Duration = Duration::from_secs(10);

/// The scene that the session begins with.
pub(crate) struct FirstScene {
    starter: LoaderStarter,
    loader: SceneLoader,
    pub(crate) loaded: Option<LoadedScene>,
    pub(super) requested: SceneSource,
    /// The scene to show if the requested one cannot be shown; `None` if the user has named the scene.
    substitute: Option<SceneSource>,
    gives_up: Instant,
    prepares_ahead: bool,
    message: Option<String>,
}

impl FirstScene {
    /// Requests the first scene, and waits a moment for it. `drafts` are the texts that loaders read instead of files.
    ///
    /// # Errors
    /// Fails if the scene cannot be shown, or the system has no thread left.
    pub(super) fn request(prepared: &Prepared, drafts: &Drafts, waker: &Waker) -> Result<Self, SessionError> {
        let Prepared { settings, scene, memory, .. } = prepared;
        let marks = LoadMarks(memory.folders.cache.as_ref().map(|cache| cache.join("loading")));
        let starter = LoaderStarter { waker: waker.clone(), drafts: drafts.clone(), marks };
        let requested = scene.source.clone();
        if settings.resumed_scene_or.is_none() {
            // The user asks for this scene, so an earlier death does not count.
            let _ = starter.marks.path(&requested).and_then(|path| attempt::death(&path));
        }
        let loader = starter.start()?;
        loader.request(requested.clone());
        let mut first = Self {
            loader,
            starter,
            loaded: None,
            requested,
            substitute: settings.resumed_scene_or.clone(),
            gives_up: clock::now() + RESUMED_WAIT,
            prepares_ahead: settings.prepare_ahead,
            message: None,
        };
        first.wait_until(clock::now() + WINDOW_WAIT)?;
        Ok(first)
    }

    /// Waits for the scene. Returns also the reason why it is another scene than the last show's.
    ///
    /// # Errors
    /// Fails if the scene cannot be shown, or the system has no thread left.
    pub(crate) fn wait(mut self) -> Result<(SceneLoaders, LoadedScene, Option<String>), SessionError> {
        loop {
            self.wait_until(clock::now() + WINDOW_WAIT)?;
            if let Some(first) = self.loaded {
                let ahead = match self.prepares_ahead {
                    true => Some([self.starter.start()?, self.starter.start()?]),
                    false => None,
                };
                let loaders = SceneLoaders { shown: self.loader, ahead };
                return Ok((loaders, first, self.message));
            }
        }
    }

    fn wait_until(&mut self, until: Instant) -> Result<(), SessionError> {
        while self.loaded.is_none() && clock::now() < until {
            let Some(loaded) = self.loader.poll() else {
                if clock::now() > self.gives_up && self.substitute.is_some() {
                    self.substitute_for("loading it takes more than 10 s")?;
                }
                std::thread::sleep(Duration::from_millis(1));
                continue;
            };
            match loaded.value {
                Ok(scene) => self.loaded = Some(LoadedScene { source: loaded.source, scene }),
                Err(error) if self.substitute.is_some() => self.substitute_for(&error.to_string())?,
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }

    /// Loads the substitute with another loader, because the first may be busy for long.
    fn substitute_for(&mut self, reason: &str) -> Result<(), SessionError> {
        let Some(substitute) = self.substitute.take() else { return Ok(()) };
        let message = format!(
            "the scene of the last show, {}, is not shown, and {} is shown instead: {reason}",
            self.requested.title(),
            substitute.title()
        );
        print_message(&message);
        self.message = Some(message);
        self.loader = self.starter.start()?;
        self.loader.request(substitute);
        Ok(())
    }
}

struct LoaderStarter {
    waker: Waker,
    drafts: Drafts,
    marks: LoadMarks,
}

impl LoaderStarter {
    fn start(&self) -> Result<SceneLoader, SessionError> {
        let (mut textures, mut edits) = (TextureCache::default(), NumberEdits::default());
        let (waker, drafts, marks) = (self.waker.clone(), self.drafts.clone(), self.marks.clone());
        let load = move |source: &SceneSource| {
            let attempt = match marks.begin(source) {
                Ok(attempt) => attempt,
                Err(error) => return (Err(error), Vec::new()),
            };
            let texts = drafts.texts();
            let (result, files) = source.ready_with(&mut textures, &mut edits, &texts);
            drop(attempt);
            drafts.publish(Findings::of(source, &texts, &result));
            (result, files)
        };
        Loader::start(load, move || waker.wake()).map_err(|error| SessionError::NoThread(error.to_string()))
    }
}

/// The folder with a mark for each scene that is being loaded; `None` without marks.
#[derive(Clone)]
struct LoadMarks(Option<PathBuf>);

impl LoadMarks {
    fn path(&self, source: &SceneSource) -> Option<PathBuf> {
        let mut hasher = DefaultHasher::new();
        format!("{source:?}").hash(&mut hasher);
        Some(self.0.as_ref()?.join(format!("{:016x}", hasher.finish())))
    }

    /// Marks that a scene is being loaded.
    ///
    /// # Errors
    /// Fails once if an earlier run died while it loaded this scene.
    fn begin(&self, source: &SceneSource) -> Result<Option<Attempt>, SceneError> {
        let Some(path) = self.path(source) else { return Ok(None) };
        if attempt::death(&path).is_some() {
            return Err(SceneError::EndedTheProgram);
        }
        // Without a mark, only the death remains unknown.
        let _ = path.parent().map(std::fs::create_dir_all);
        Ok(attempt::begin(&path, ""))
    }
}
