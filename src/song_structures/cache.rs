//! A cache of song structures in the user's cache folder. The key is a hash of the song's bytes, the played part and
//! the version of the analysis. The files contain JSON.

use std::path::PathBuf;

use crate::config::Folders;

use super::cached_files::{CachedFiles, FileKey};
use crate::limits;
use mariana_music::{STRUCTURE_VERSION, SongStructure};
use mariana_player::track::Content;

/// The cache.
#[derive(Debug, Clone)]
pub struct StructureCache(CachedFiles);

impl StructureCache {
    /// Returns a cache in the user's cache folder, if there is one.
    pub fn of_user() -> Self {
        Self::among(&Folders::of_user())
    }

    /// Returns a cache in the cache folder of `folders`, if there is one.
    pub fn among(folders: &Folders) -> Self {
        Self::in_place(folders.cache.as_ref().map(|cache| cache.join("songs")))
    }

    /// Returns a cache in this folder, which is created at the first write.
    pub fn in_folder(path: PathBuf) -> Self {
        Self::in_place(Some(path))
    }

    fn in_place(folder: Option<PathBuf>) -> Self {
        let (bytes_max, kept_max) = (limits::STRUCTURE_BYTES_MAX, limits::STRUCTURES_KEPT_MAX);
        Self(CachedFiles { folder, ending: "song", bytes_max, kept_max })
    }

    /// Returns the key of `content`; `None` without a folder, for unreadable content, or if `go_on` returns false.
    pub(super) fn key(&self, content: &Content, go_on: &dyn Fn() -> bool) -> Option<FileKey> {
        let about = (STRUCTURE_VERSION, content.cut.map(|cut| (cut.start, cut.end)));
        self.0.key(about, [&content.song], go_on)
    }

    pub(super) fn load(&self, key: FileKey) -> Option<SongStructure> {
        self.0.load(key, |text| serde_json::from_slice(text).ok())
    }

    /// Saves a structure. After an error, the next run analyses the song again.
    pub(super) fn save(&self, key: FileKey, structure: &SongStructure) {
        if let Ok(text) = serde_json::to_string(structure) {
            self.0.save(key, text.as_bytes());
        }
    }
}
