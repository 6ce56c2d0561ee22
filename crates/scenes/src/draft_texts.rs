//! The unsaved texts of files at one moment.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mariana_field::lang::Turning;

/// The texts at one moment.
#[derive(Debug, Clone, Default)]
pub struct DraftTexts {
    pub(super) texts: Arc<BTreeMap<PathBuf, Arc<[u8]>>>,
    /// Grows with every change.
    pub(super) version: u64,
    /// The numbers that are turned in a file's text, if any.
    pub(super) turning: Option<(Arc<Path>, Arc<[Turning]>)>,
}

impl DraftTexts {
    /// The text that stands in the place of a file's, if there is one.
    pub fn of(&self, file: &Path) -> Option<&Arc<[u8]>> {
        self.texts.get(file)
    }

    /// The numbers that are turned in a file.
    pub(super) fn turning(&self, file: &Path) -> &[Turning] {
        self.turning.as_ref().filter(|(of, _)| **of == *file).map_or(&[], |(_, turning)| turning)
    }
}
