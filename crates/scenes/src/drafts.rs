//! Unsaved texts from the editor, which the loader uses instead of the files. The loader returns its [`Findings`] on
//! the same channel.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use mariana_field::lang::{self, Turning};
use mariana_files::reading::TextError;
use mariana_work::lock;

use super::folder::Folder;
use super::world::ReadyScene;
use super::{FoundMistakes, SceneError, SceneSource};

/// Unsaved texts, shared between the editor and the threads that load scenes. The lock is held only to copy a
/// pointer.
#[derive(Debug, Clone, Default)]
pub struct Drafts(Arc<Mutex<Shared>>);

/// Maximum number of loaded and preloaded scenes with findings.
const FINDINGS_MAX: usize = 64;

#[derive(Debug, Default)]
struct Shared {
    texts: DraftTexts,
    /// At most one entry for each scene, oldest first.
    findings: Vec<Arc<Findings>>,
}

/// The results of loading a scene, for the editor.
#[derive(Debug, Clone, PartialEq)]
pub struct Findings {
    /// The scene.
    pub source: SceneSource,
    /// The version of the texts that were read.
    pub version: u64,
    /// Empty if the scene can be drawn.
    pub mistakes: Vec<Mistake>,
    /// The warnings about a scene without mistakes.
    pub warnings: Vec<Mistake>,
    /// The files of the scene: its main file, then its includes.
    pub texts: Vec<PathBuf>,
    /// Byte positions of the numbers in the main file that are parameters and can be set each frame.
    pub numbers: Vec<usize>,
}

/// A mistake, or a warning, with its position.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mistake {
    /// Index into [`Findings::texts`].
    pub text: usize,
    /// Byte range of the mistake; empty for the whole text.
    pub range: Range<usize>,
    /// The message, one sentence without a full stop.
    pub message: String,
    /// Advice; may be empty.
    pub hint: String,
}

impl Drafts {
    /// Uses `text` instead of the file's content. Returns the new version.
    pub fn set(&self, file: &Path, text: Arc<[u8]>) -> u64 {
        self.change(|texts| Arc::make_mut(&mut texts.texts).insert(file.to_owned(), text))
    }

    /// Uses the file's own content again. Returns the new version.
    pub fn remove(&self, file: &Path) -> u64 {
        self.change(|texts| Arc::make_mut(&mut texts.texts).remove(file))
    }

    /// Sets which numbers of a file the user is turning in the editor, with their ranges; `None` if no number is
    /// turned. Returns the new version.
    pub fn turn(&self, turning: Option<(&Path, &[Turning])>) -> u64 {
        self.change(|texts| texts.turning = turning.map(|(file, turning)| (file.into(), turning.into())))
    }

    /// Returns a snapshot of the texts.
    pub fn texts(&self) -> DraftTexts {
        lock(&self.0).texts.clone()
    }

    /// The latest findings about a scene.
    pub fn findings(&self, source: &SceneSource) -> Option<Arc<Findings>> {
        lock(&self.0).findings.iter().find(|findings| findings.source == *source).cloned()
    }

    /// Publishes findings, replacing older ones of the same scene.
    pub fn publish(&self, findings: Findings) {
        let mut shared = lock(&self.0);
        shared.findings.retain(|other| other.source != findings.source);
        if shared.findings.len() >= FINDINGS_MAX {
            shared.findings.remove(0);
        }
        shared.findings.push(Arc::new(findings));
    }

    fn change<T>(&self, change: impl FnOnce(&mut DraftTexts) -> T) -> u64 {
        let mut shared = lock(&self.0);
        shared.texts.version += 1;
        let version = shared.texts.version;
        let _old = change(&mut shared.texts);
        version
    }
}

impl Findings {
    /// Returns the findings of the load of `source` from these texts.
    pub fn of(source: &SceneSource, drafts: &DraftTexts, result: &Result<ReadyScene, SceneError>) -> Self {
        let mut texts: Vec<PathBuf> = source.file().map(Path::to_owned).into_iter().collect();
        let (mut numbers, mut warnings) = (Vec::new(), Vec::new());
        let mistakes = match result {
            Ok(ready) => {
                let scene = &ready.world.scene;
                texts.extend(included(source, scene.includes.iter().map(String::as_str)));
                let turned = scene.params.iter().filter(|param| param.is_number && param.min < param.max);
                numbers.extend(turned.map(|param| param.span.start as usize));
                warnings = placed(&ready.warnings);
                Vec::new()
            }
            Err(SceneError::Mistakes { found, .. }) => {
                let others = found.sources.files().iter().skip(1).map(|file| file.name.as_str());
                texts.extend(included(source, others));
                placed(found)
            }
            Err(error) => {
                let (range, message, hint) = match error {
                    SceneError::File { problem: TextError::NotText(position), .. } => (
                        *position..position + 1,
                        "this byte is not UTF-8".to_owned(),
                        "delete it, or save the text as UTF-8 with another editor",
                    ),
                    other => (0..0, other.to_string(), ""),
                };
                vec![Mistake { text: 0, range, message, hint: hint.to_owned() }]
            }
        };
        Self { source: source.clone(), version: drafts.version, mistakes, warnings, texts, numbers }
    }
}

fn included<'a>(source: &SceneSource, names: impl Iterator<Item = &'a str>) -> impl Iterator<Item = PathBuf> {
    let folder = source.file().map(Folder::of);
    names.filter_map(move |name| Some(folder.as_ref()?.path(name)))
}

fn placed(found: &FoundMistakes) -> Vec<Mistake> {
    let placed = found.diagnostics.iter().filter_map(|one| {
        let (text, range) = found.sources.place_in_file(one.span)?;
        let label = if one.label.is_empty() { String::new() } else { format!(" ({})", one.label) };
        let message = format!("{}{label}", one.message);
        Some(Mistake { text, range, message, hint: one.hint.clone().unwrap_or_default() })
    });
    placed.collect()
}

/// Snapshot of the unsaved texts in the editor.
#[derive(Debug, Clone, Default)]
pub struct DraftTexts {
    pub(super) texts: Arc<BTreeMap<PathBuf, Arc<[u8]>>>,
    /// Increases with every change.
    pub(super) version: u64,
    /// The file whose numbers are being turned, and those numbers.
    pub(super) turning: Option<(Arc<Path>, Arc<[Turning]>)>,
}

impl DraftTexts {
    /// Returns the unsaved text of a file, if there is one.
    pub fn of(&self, file: &Path) -> Option<&Arc<[u8]>> {
        self.texts.get(file)
    }

    pub(super) fn turning(&self, file: &Path) -> &[Turning] {
        self.turning.as_ref().filter(|(of, _)| **of == *file).map_or(&[], |(_, turning)| turning)
    }
}

// Finds the numbers in a scene's text that are being edited, by comparing versions of the text.
//
// A program compiled with [`lang::compile_while_changing`] reads these numbers as inputs. The first edit of a number
// compiles a new program; further edits need no compilation. When the same text is loaded twice, editing has ended
// and the numbers become constants again, because drivers optimize constants better than inputs.

/// The last version of a text, and the indices of the numbers that differ between versions.
#[derive(Debug, Default)]
pub struct NumberEdits {
    last: Option<(SceneSource, String)>,
    changing: BTreeSet<usize>,
    pub(super) settled: bool,
}

impl NumberEdits {
    /// Compares `text` with the previous version and returns the indices of the numbers being edited. An unchanged text
    /// ends the edit, unless `is_turned` says that the user is turning one of the numbers.
    pub(super) fn follow(&mut self, source: &SceneSource, text: &str, is_turned: bool) -> &BTreeSet<usize> {
        let before = self.last.take().filter(|(of, _)| of == source).map(|(_, text)| text);
        let is_as_it_was = before.as_deref() == Some(text);
        self.settled = is_as_it_was && !self.changing.is_empty() && !is_turned;
        if is_as_it_was && is_turned {
            self.last = before.map(|text| (source.clone(), text));
            return &self.changing;
        }
        match before.filter(|_| !is_as_it_was).and_then(|before| lang::changed_numbers(&before, text)) {
            Some(changed) => self.changing.extend(changed),
            None => self.changing.clear(),
        }
        self.last = Some((source.clone(), text.to_owned()));
        &self.changing
    }
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
    fn drafts_replace_a_file_and_its_includes() {
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
        // A mistake in an included text is reported with its position in that text.
        let version = drafts.set(&path("part.scene"), b"fn ball(p) = length(p) - one".as_slice().into());
        let (result, findings) = load(&source, &drafts);
        assert!(result.is_err());
        assert_eq!((findings.version, findings.mistakes.len()), (version, 1));
        assert_eq!((findings.mistakes[0].text, findings.mistakes[0].range.clone()), (1, 25..28));
        drafts.remove(&path("part.scene"));
        assert_eq!(clauses(&drafts), before);
        // A file that does not exist yet, and a text that is not UTF-8.
        let new = SceneSource::File(path("new.scene"));
        drafts.set(&path("new.scene"), b"length(p) - 1".as_slice().into());
        assert!(load(&new, &drafts).0.is_ok());
        drafts.set(&path("new.scene"), b"length(p) \xff- 1".as_slice().into());
        assert_eq!(load(&new, &drafts).1.mistakes[0].range, 10..11);
    }

    #[test]
    fn warnings_have_positions_and_the_scene_is_ready() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("main.scene");
        std::fs::write(&file, "let lost = 1\n3 * (length(p) - 0.5)").unwrap();
        let (result, findings) = load(&SceneSource::File(file), &Drafts::default());
        assert!(result.is_ok() && findings.mistakes.is_empty());
        let places: Vec<_> = findings.warnings.iter().map(|one| one.range.clone()).collect();
        assert_eq!(places, [4..8, 13..34]);
        assert!(findings.warnings[1].hint.contains("multiply the value by 0.3"), "{:?}", findings.warnings);
    }

    #[test]
    fn a_turned_number_is_reported_with_its_position() {
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

#[cfg(test)]
mod number_edits_tests {
    use super::*;

    #[test]
    fn numbers_are_inputs_until_the_text_repeats_or_changes_otherwise() {
        let (one, other) = (SceneSource::Formula("one".into()), SceneSource::Formula("other".into()));
        let mut edits = NumberEdits::default();
        let mut follow = |source: &SceneSource, text: &str| {
            let changing: Vec<usize> = edits.follow(source, text, false).iter().copied().collect();
            (changing, edits.settled)
        };
        assert_eq!(follow(&one, "sphere(p, 1) - 0.5"), (vec![], false));
        assert_eq!(follow(&one, "sphere(p, 2) - 0.5"), (vec![0], false));
        assert_eq!(follow(&one, "sphere(p, 2) - 0.25"), (vec![0, 1], false));
        // An edited comment changes no number and does not end the edit.
        assert_eq!(follow(&one, "sphere(p, 2) - 0.25 # thin"), (vec![0, 1], false));
        assert_eq!(follow(&one, "sphere(p, 2) - 0.25 # thin"), (vec![], true));
        assert_eq!(follow(&one, "sphere(p, 2) - 0.25 # thin"), (vec![], false));
        assert_eq!(follow(&one, "sphere(p, 3) - 0.25"), (vec![0], false));
        assert_eq!(follow(&one, "sphere(p, 3) + 0.25"), (vec![], false));
        assert_eq!(follow(&one, "sphere(p, 3) + 0.5"), (vec![1], false));
        assert_eq!(follow(&other, "sphere(p, 3) + 0.75"), (vec![], false));
    }
}
