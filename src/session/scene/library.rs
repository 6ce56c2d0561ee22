//! The scene that was asked for, and what loads it: the list of scenes, and a loader that watches files.

use std::time::{Duration, Instant};

use super::awaited_edit::AwaitedEdit;
use crate::clock;
use crate::scenes::{Loaded, Loader, ReadyScene, SceneError, SceneList, SceneSource};

/// Loads scenes on a thread.
pub(crate) type SceneLoader = Loader<Result<ReadyScene, SceneError>>;

/// How long one go draws before the show looks whether anything has happened.
const GO: Duration = Duration::from_millis(100);
/// The same while a text is written: a key is answered at once, even if the picture takes long.
const GO_OF_EDITOR: Duration = Duration::from_millis(10);

/// See the module.
pub(crate) struct SceneLibrary {
    loader: SceneLoader,
    list: SceneList,
    /// What was asked for last: shown, or on its way.
    wanted: SceneSource,
    edit: AwaitedEdit,
    /// Whether somebody writes its text, so that mistakes come and go.
    is_written: bool,
}

impl SceneLibrary {
    /// A scene is wanted, which `loader` watches.
    pub(super) fn new(loader: SceneLoader, wanted: SceneSource) -> Self {
        let list = SceneList::around(&wanted);
        Self { loader, list, wanted, edit: AwaitedEdit::default(), is_written: false }
    }

    /// What was asked for last: shown, or on its way.
    pub(crate) fn wanted(&self) -> &SceneSource {
        &self.wanted
    }

    /// All scenes that the keys go through. Reads a folder.
    pub(crate) fn all_sources(&self) -> Vec<SceneSource> {
        self.list.all(&self.wanted)
    }

    /// A scene's name with its place among those that the keys go through, such as "terrain, 3 of 17". Reads a folder.
    pub(crate) fn placed_name(&self, source: &SceneSource) -> String {
        let (at, count) = self.list.place(source);
        format!("{}, {} of {count}", source.title(), at + 1)
    }

    /// The scenes after and before one in the list.
    pub(super) fn neighbours_of(&self, source: &SceneSource) -> [Option<SceneSource>; 2] {
        [Some(self.list.next(source)), Some(self.list.previous(source))]
    }

    /// The scene after the wanted one, or before it.
    pub(super) fn beside(&self, forward: bool) -> SceneSource {
        if forward { self.list.next(&self.wanted) } else { self.list.previous(&self.wanted) }
    }

    /// Notes whether somebody writes the scene's text.
    pub(crate) fn set_written(&mut self, written: bool) {
        self.is_written = written;
    }

    /// Whether somebody writes the scene's text.
    pub(super) fn is_written(&self) -> bool {
        self.is_written
    }

    /// Loads the scene again, because its text has changed without its file.
    pub(crate) fn load_again(&mut self) {
        tracing::debug!("{} is loaded again for its draft", self.wanted.title());
        self.loader.load_again();
        self.edit.ask(clock::now());
    }

    /// Until when the next picture waits for a changed text, if it does at `now`.
    pub(super) fn awaits_edit(&self, now: Instant) -> Option<Instant> {
        self.edit.until(now)
    }

    /// How long a picture is drawn before the show looks for keys.
    pub(super) fn length_of_go(&self) -> Duration {
        if self.is_written { GO_OF_EDITOR } else { GO }
    }

    /// Wants a scene from now on, which somebody else has ready.
    pub(super) fn want(&mut self, source: SceneSource) {
        self.wanted = source;
    }

    /// Has the wanted scene loaded.
    pub(super) fn load(&self) {
        self.loader.request(self.wanted.clone());
    }

    /// Goes on with a scene that was wanted elsewhere.
    pub(super) fn take_over(&mut self, wanted: SceneSource) {
        if wanted != self.wanted {
            self.list = SceneList::around(&wanted);
            self.wanted = wanted;
            self.load();
        }
    }

    /// The wanted scene, or what is wrong with it, once it is loaded or its files have changed.
    pub(super) fn poll(&mut self) -> Option<Loaded<Result<ReadyScene, SceneError>>> {
        while let Some(loaded) = self.loader.poll() {
            if loaded.source == self.wanted {
                self.edit.note_loaded(loaded.took);
                return Some(loaded);
            }
        }
        None
    }

    /// What watches the files of the wanted scene, to be exchanged for another one.
    pub(super) fn loader_mut(&mut self) -> &mut SceneLoader {
        &mut self.loader
    }

    /// The loader, for another session.
    pub(super) fn into_loader(self) -> (SceneLoader, SceneSource) {
        (self.loader, self.wanted)
    }
}
