//! A cache of the parts of songs in the user's cache folder. The key is a hash of the stems' bytes, of what decides
//! about the analysis, and of the version of the analysis.

use std::path::PathBuf;

use super::{SongOfParts, kept_numbers};
use crate::config::Folders;
use crate::limits;
use crate::song_structures::{CachedFiles, FileKey};
use mariana_music::{PART_TRACK_VERSION, PartTracks};
use mariana_player::song::Song;
use mariana_player::stems::Stem;

/// The cache.
#[derive(Debug, Clone)]
pub struct PartsCache(CachedFiles);

impl PartsCache {
    /// Returns a cache in the user's cache folder, if there is one.
    pub fn of_user() -> Self {
        Self::among(&Folders::of_user())
    }

    /// Returns a cache in the cache folder of `folders`, if there is one.
    pub fn among(folders: &Folders) -> Self {
        let folder = folders.cache.as_ref().map(|cache| cache.join("parts"));
        let (bytes_max, kept_max) = (limits::PARTS_BYTES_MAX, limits::PARTS_KEPT_MAX);
        Self(CachedFiles { folder, ending: "parts", bytes_max, kept_max })
    }

    /// Returns a cache in this folder, which is created at the first write.
    pub fn in_folder(path: PathBuf) -> Self {
        Self::among(&Folders { cache: Some(path), ..Folders::default() })
    }

    /// Returns the key of a song's stems; `None` without stems or a folder, for an unreadable stem, or if `go_on`
    /// returns false.
    pub(super) fn key(
        &self,
        song: &SongOfParts<'_>,
        stems: &[Stem],
        go_on: &dyn Fn() -> bool,
    ) -> Option<FileKey> {
        let mut files: Vec<Song> = stems.iter().map(|stem| Song::File(stem.path().to_owned())).collect();
        files.dedup();
        files.first()?;
        let parts: Vec<usize> = stems.iter().map(|stem| stem.part).collect();
        let names: Vec<&str> = kept_numbers().iter().map(|kept| kept.name).collect();
        let cut = song.cut.map(|cut| (cut.start, cut.end));
        let about = (PART_TRACK_VERSION, parts, names, cut, song.scene_gain.to_bits());
        self.0.key(about, &files, go_on)
    }

    pub(super) fn load(&self, key: FileKey) -> Option<PartTracks> {
        self.0.load(key, |bytes| PartTracks::from_bytes(&kept_numbers(), bytes))
    }

    /// Saves the parts of a song. After an error, the next run reads the stems again.
    pub(super) fn save(&self, key: FileKey, tracks: &PartTracks) {
        self.0.save(key, &tracks.to_bytes());
    }
}
