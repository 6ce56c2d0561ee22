use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mariana_field::lang::Turning;

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
