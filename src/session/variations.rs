//! Variations of a scene: which one is shown, and how one is made and checked.

use std::hash::{BuildHasher, RandomState};
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::documents::FileThread;
use crate::scenes::{Drafts, NumberEdits, SceneSource, TextureCache};
use mariana_editing::mutated;
use mariana_work::Awaited;

/// Numbers of variations are less than this, so that a user can remember and send them.
const NUMBERS: u64 = 10_000;

/// A variation, ready to be shown.
pub(super) struct Variation {
    /// The scene that is varied.
    pub original: SceneSource,
    pub number: u64,
    pub file: PathBuf,
    pub text: String,
}

#[derive(Default)]
pub(super) struct Surprises {
    /// The scene in whose place the coming variation is shown.
    pub replaced: Option<SceneSource>,
    /// The variations shown so far, the last one at the end.
    pub shown: Vec<Variation>,
    pub coming: Awaited<Result<Variation, String>>,
    last_number: u64,
    pub files: Option<FileThread>,
    /// The variation that is being saved.
    pub keeping: Option<PathBuf>,
    /// True if the shown variation could not be saved.
    pub is_unkeepable: bool,
}

impl Surprises {
    /// True if the scene is a variation that is not saved.
    pub(super) fn is_unsaved(&self, source: &SceneSource) -> bool {
        self.variation(source).is_some()
    }

    /// Returns the scene to remember for the next run: the original of an unsaved variation.
    pub(super) fn lasting<'a>(&'a self, source: &'a SceneSource) -> &'a SceneSource {
        self.variation(source).map_or(source, |one| &one.original)
    }

    pub(super) fn variation(&self, source: &SceneSource) -> Option<&Variation> {
        self.shown.iter().find(|one| source.file() == Some(&one.file))
    }

    pub(super) fn next_number(&mut self) -> u64 {
        let seed = RandomState::new().hash_one(self.last_number);
        let number = 1 + seed % (NUMBERS - 1);
        // Never the same variation twice in a row.
        self.last_number = if number == self.last_number { 1 + number % (NUMBERS - 1) } else { number };
        self.last_number
    }
}

pub(super) fn words_of(number: u64) -> String {
    format!("variation {number}: F5 another, F6 back, F7 keep")
}

/// Makes the first variation that the loader accepts. Returns a message if the loader accepts no variation.
pub(super) fn vary(
    original: &SceneSource,
    folder: &Path,
    drafts: &Drafts,
    numbers: Range<u64>,
) -> Result<Variation, String> {
    let texts = drafts.texts();
    let draft = original.file().and_then(|file| texts.of(file));
    let text = match draft {
        Some(draft) => String::from_utf8_lossy(draft).into_owned(),
        None => original.text().map_err(|error| error.to_string())?.into_owned(),
    };
    for number in numbers {
        let Some(text) = mutated(&text, number) else {
            return Err("this scene has no parameter and no colour to vary".to_owned());
        };
        let file = folder.join(format!("{}-{number}.scene", original.title()));
        // The file does not exist yet: check its text like a draft.
        let trial = Drafts::default();
        trial.set(&file, text.as_bytes().into());
        let source = SceneSource::File(file.clone());
        let (mut textures, mut edits) = (TextureCache::default(), NumberEdits::default());
        if source.ready_with(&mut textures, &mut edits, &trial.texts()).0.is_ok() {
            return Ok(Variation { original: original.clone(), number, file, text });
        }
    }
    Err("no variation of this scene can be drawn: press F5 again".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::shipped_names;

    #[test]
    fn every_shipped_scene_has_valid_variations() {
        let folder = tempfile::tempdir().unwrap();
        for name in shipped_names() {
            let scene = SceneSource::Shipped(name.clone());
            let made = vary(&scene, folder.path(), &Drafts::default(), 7..8);
            let made = made.unwrap_or_else(|words| panic!("{name}: {words}"));
            assert_ne!(made.text, scene.text().unwrap());
            let again = vary(&scene, folder.path(), &Drafts::default(), 7..8).unwrap_or_else(|_| panic!());
            assert_eq!(made.text, again.text);
        }
    }
}
