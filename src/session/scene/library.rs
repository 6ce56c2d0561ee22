//! The requested scene, the list of scenes, and the loader that watches the scene's files.

use std::collections::BTreeSet;
use std::time::Duration;

use super::awaited_edit::AwaitedEdit;
use crate::clock;
use crate::scenes::{Loaded, Loader, ReadyScene, SceneError, SceneList, SceneSource};

pub(crate) type SceneLoader = Loader<Result<ReadyScene, SceneError>>;

const GO: Duration = Duration::from_millis(100);
/// While a text is edited, drawing pauses after this time to read input, so that keys are answered at once.
const GO_OF_EDITOR: Duration = Duration::from_millis(10);

pub(crate) struct SceneLibrary {
    pub(super) loader: SceneLoader,
    list: SceneList,
    /// The titles of the marked scenes.
    pub(crate) marks: BTreeSet<String>,
    /// The last requested scene: shown, or being loaded.
    pub(crate) wanted: SceneSource,
    pub(super) edit: AwaitedEdit,
    /// True while the scene's text is being edited: mistakes in it are temporary.
    pub(crate) is_written: bool,
}

impl SceneLibrary {
    pub(super) fn new(loader: SceneLoader, wanted: SceneSource) -> Self {
        let list = SceneList::around(&wanted);
        Self { loader, list, marks: BTreeSet::new(), wanted, edit: AwaitedEdit::default(), is_written: false }
    }

    /// All scenes of the list. Reads a folder.
    pub(crate) fn all_sources(&self) -> Vec<SceneSource> {
        self.list.all(&self.wanted)
    }

    /// All scenes, including `current`, in the order of their numbers: marked scenes first. Reads a folder.
    pub(crate) fn numbered(&self, current: &SceneSource) -> Vec<SceneSource> {
        let mut scenes = self.list.all(current);
        scenes.sort_by_key(|scene| !self.marks.contains(&scene.title()));
        scenes
    }

    /// A scene's name with its number, such as "terrain, 3 of 17". Reads a folder.
    pub(crate) fn placed_name(&self, source: &SceneSource) -> String {
        let scenes = self.numbered(source);
        let at = scenes.iter().position(|scene| scene == source).unwrap_or(0);
        format!("{}, {} of {}", source.title(), at + 1, scenes.len())
    }

    pub(super) fn neighbours_of(&self, source: &SceneSource) -> [Option<SceneSource>; 2] {
        [Some(self.list.next(source)), Some(self.list.previous(source))]
    }

    /// The next or the previous scene of the list. Reads a folder.
    pub(super) fn next_after(&self, source: &SceneSource, forward: bool) -> SceneSource {
        if forward { self.list.next(source) } else { self.list.previous(source) }
    }

    /// Reloads the scene, because its draft has changed but its file has not.
    pub(crate) fn load_again(&mut self) {
        tracing::debug!("{} is loaded again for its draft", self.wanted.title());
        self.loader.load_again();
        self.edit.start(clock::now());
    }

    pub(super) fn length_of_go(&self) -> Duration {
        if self.is_written { GO_OF_EDITOR } else { GO }
    }

    pub(super) fn load(&self) {
        self.loader.request(self.wanted.clone());
    }

    pub(super) fn adopt(&mut self, wanted: SceneSource) {
        if wanted != self.wanted {
            self.list = SceneList::around(&wanted);
            self.wanted = wanted;
            self.load();
        }
    }

    /// Returns the requested scene or its error after each load or reload.
    pub(super) fn poll(&mut self) -> Option<Loaded<Result<ReadyScene, SceneError>>> {
        while let Some(loaded) = self.loader.poll() {
            if loaded.source == self.wanted {
                self.edit.record_loaded(loaded.took);
                return Some(loaded);
            }
        }
        None
    }
}
