//! Texts of files as somebody has them in an editor, before they are saved: they stand in the place of what the files
//! hold. And what the loader found in them, for that editor.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use mariana_field::lang::{Diagnostic, Sources, Turning};

use super::draft_texts::DraftTexts;
use super::folder::Folder;
use super::world::ReadyScene;
use super::{SceneError, SceneSource};

/// Texts that are edited, shared by an editor and the threads that load scenes. A lock is held for as long as a pointer
/// takes to be copied.
#[derive(Debug, Clone, Default)]
pub struct Drafts(Arc<Mutex<Shared>>);

/// Most scenes of which is told what was found: those that are loaded, and those ahead of them.
const FINDINGS_MAX: usize = 8;

#[derive(Debug, Default)]
struct Shared {
    texts: DraftTexts,
    /// One of each scene.
    findings: Vec<Findings>,
}

/// What the loader found in a scene, for whoever edits its text.
#[derive(Debug, Clone, PartialEq)]
pub struct Findings {
    /// The scene.
    pub source: SceneSource,
    /// The version of the texts that were read.
    pub version: u64,
    /// What is wrong; empty if the scene can be drawn.
    pub mistakes: Vec<Mistake>,
    /// The files of its texts: its own first, then those that it includes.
    pub texts: Vec<PathBuf>,
    /// Where numbers of its own text begin that a frame may set.
    pub numbers: Vec<usize>,
}

/// A mistake at its place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mistake {
    /// The file's place in the texts of its [`Findings`].
    pub text: usize,
    /// The bytes that it is about; empty if it is about the whole.
    pub range: Range<usize>,
    /// What is wrong, in one sentence without its full stop.
    pub message: String,
    /// What to do about it; may be empty.
    pub hint: String,
}

impl Drafts {
    /// Puts a text in the place of what a file holds, and gives its version.
    pub fn set(&self, file: &Path, text: Arc<[u8]>) -> u64 {
        self.change(|texts| Arc::make_mut(&mut texts.texts).insert(file.to_owned(), text))
    }

    /// The file's own content counts again.
    pub fn remove(&self, file: &Path) -> u64 {
        self.change(|texts| Arc::make_mut(&mut texts.texts).remove(file))
    }

    /// Numbers of a file's text are turned from now on: they get ranges; or none is any more.
    pub fn turn(&self, turning: Option<(&Path, &[Turning])>) -> u64 {
        self.change(|texts| texts.turning = turning.map(|(file, turning)| (file.into(), turning.into())))
    }

    /// The texts as they are now.
    pub fn texts(&self) -> DraftTexts {
        self.lock().texts.clone()
    }

    /// What the loaders found since the last call, of each scene the newest.
    pub fn take_findings(&self) -> Vec<Findings> {
        std::mem::take(&mut self.lock().findings)
    }

    /// Hands over what was found.
    pub fn tell(&self, findings: Findings) {
        let mut shared = self.lock();
        shared.findings.retain(|other| other.source != findings.source);
        if shared.findings.len() >= FINDINGS_MAX {
            shared.findings.remove(0);
        }
        shared.findings.push(findings);
    }

    fn change<T>(&self, change: impl FnOnce(&mut DraftTexts) -> T) -> u64 {
        let mut shared = self.lock();
        shared.texts.version += 1;
        let version = shared.texts.version;
        let _old = change(&mut shared.texts);
        version
    }

    fn lock(&self) -> MutexGuard<'_, Shared> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Findings {
    /// What was found when `source` was loaded from these texts.
    pub fn of(source: &SceneSource, drafts: &DraftTexts, result: &Result<ReadyScene, SceneError>) -> Self {
        let mut texts: Vec<PathBuf> = source.file().map(Path::to_owned).into_iter().collect();
        let mut numbers = Vec::new();
        let whole = |error: &SceneError| Mistake {
            text: 0,
            range: 0..0,
            message: error.to_string(),
            hint: String::new(),
        };
        let mistakes = match result {
            Ok(ready) => {
                let scene = &ready.world.scene;
                texts.extend(included(source, scene.includes.iter().map(String::as_str)));
                let turned = scene.params.iter().filter(|param| param.is_number && param.min < param.max);
                numbers.extend(turned.map(|param| param.span.start as usize));
                Vec::new()
            }
            Err(SceneError::Mistakes { found, .. }) => {
                let others = found.sources.files().iter().skip(1).map(|file| file.name.as_str());
                texts.extend(included(source, others));
                found.diagnostics.iter().filter_map(|one| placed(one, &found.sources)).collect()
            }
            Err(SceneError::NotText { position, .. }) => {
                vec![Mistake {
                    text: 0,
                    range: *position..position + 1,
                    message: "this byte is not UTF-8".to_owned(),
                    hint: "delete it, or save the text as UTF-8 elsewhere".to_owned(),
                }]
            }
            Err(other) => vec![whole(other)],
        };
        Self { source: source.clone(), version: drafts.version, mistakes, texts, numbers }
    }
}

/// Where the files are that a scene includes.
fn included<'a>(source: &SceneSource, names: impl Iterator<Item = &'a str>) -> impl Iterator<Item = PathBuf> {
    let folder = source.file().map(Folder::of);
    names.filter_map(move |name| Some(folder.as_ref()?.path(name)))
}

/// A mistake at its place in one of the texts.
fn placed(one: &Diagnostic, sources: &Sources) -> Option<Mistake> {
    let (text, range) = sources.place_in_file(one.span)?;
    let label = if one.label.is_empty() { String::new() } else { format!(" ({})", one.label) };
    let message = format!("{}{label}", one.message);
    Some(Mistake { text, range, message, hint: one.hint.clone().unwrap_or_default() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{NumberEdits, TextureCache};

    fn load(source: &SceneSource, drafts: &Drafts) -> (Result<ReadyScene, SceneError>, Findings) {
        let texts = drafts.texts();
        let (mut textures, mut edits) = (TextureCache::default(), NumberEdits::default());
        let (result, _) = source.ready_with(&mut textures, &mut edits, &texts);
        let findings = Findings::of(source, &texts, &result);
        (result, findings)
    }

    #[test]
    fn a_draft_stands_in_the_place_of_a_file_and_of_what_it_includes() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::write(path("main.scene"), "include \"part.scene\"\nobject o { shape = ball(p) }").unwrap();
        std::fs::write(path("part.scene"), "fn ball(p) = length(p) - 1").unwrap();
        let (source, drafts) = (SceneSource::File(path("main.scene")), Drafts::default());
        let clauses = |drafts: &Drafts| load(&source, drafts).0.unwrap().buffers.cost.distance;
        let before = clauses(&drafts);
        drafts.set(&path("part.scene"), b"fn ball(p) = length(p) - 1 + sin(x) * cos(y)".as_slice().into());
        assert!(clauses(&drafts) > before);
        let (_, findings) = load(&source, &drafts);
        assert_eq!(findings.texts, [path("main.scene"), path("part.scene")]);
        // A mistake in the included text stands there.
        let version = drafts.set(&path("part.scene"), b"fn ball(p) = length(p) - one".as_slice().into());
        let (result, findings) = load(&source, &drafts);
        assert!(result.is_err());
        assert_eq!((findings.version, findings.mistakes.len()), (version, 1));
        assert_eq!((findings.mistakes[0].text, findings.mistakes[0].range.clone()), (1, 25..28));
        drafts.remove(&path("part.scene"));
        assert_eq!(clauses(&drafts), before);
        // A file that is not there yet, and one that is no text.
        let new = SceneSource::File(path("new.scene"));
        drafts.set(&path("new.scene"), b"length(p) - 1".as_slice().into());
        assert!(load(&new, &drafts).0.is_ok());
        drafts.set(&path("new.scene"), b"length(p) \xff- 1".as_slice().into());
        assert_eq!(load(&new, &drafts).1.mistakes[0].range, 10..11);
    }

    #[test]
    fn a_number_that_is_turned_is_told_with_its_place() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("main.scene");
        std::fs::write(&file, "length(p) - 0.5").unwrap();
        let (source, drafts) = (SceneSource::File(file.clone()), Drafts::default());
        assert!(load(&source, &drafts).1.numbers.is_empty());
        drafts.turn(Some((&file, &[Turning { place: 0, least: 0.1, most: 2.0 }])));
        let (result, findings) = load(&source, &drafts);
        assert_eq!(findings.numbers, [12]);
        assert!(!result.unwrap().settles);
        drafts.turn(None);
        assert!(load(&source, &drafts).1.numbers.is_empty());
    }
}
