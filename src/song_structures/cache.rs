//! A cache of song structures in the user's cache folder. The name of a file is a hash of the song's bytes, the played
//! part and the version of the analysis. A file contains a line with a checksum, and then JSON. All files may be
//! deleted at any time; a damaged file is replaced, and the least recently used files are deleted first.

use std::fs::{self, File};
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::config::Folders;

use crate::atomic_file::AtomicFile;
use crate::limits::LIMITS;
use mariana_music::{STRUCTURE_VERSION, SongStructure};
use mariana_player::track::Content;

const ENDING: &str = "song";

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct StructureKey(u128);

/// The cache.
#[derive(Debug, Clone)]
pub struct StructureCache {
    /// `None` if nothing is cached.
    folder: Option<PathBuf>,
}

impl StructureCache {
    /// Returns a cache in the user's cache folder, if there is one.
    pub fn of_user() -> Self {
        Self::among(&Folders::of_user())
    }

    /// Returns a cache in the cache folder of `folders`, if there is one.
    pub fn among(folders: &Folders) -> Self {
        Self { folder: folders.cache.as_ref().map(|cache| cache.join("songs")) }
    }

    /// Returns a cache in this folder, which is created at the first write.
    pub fn in_folder(path: PathBuf) -> Self {
        Self { folder: Some(path) }
    }

    /// Returns the key of `content`; `None` without a folder, for unreadable content, or if `go_on` returns false.
    pub(super) fn key(&self, content: &Content, go_on: &dyn Fn() -> bool) -> Option<StructureKey> {
        self.folder.as_ref()?;
        // Two 64-bit hashes. If another version of Rust hashes differently, the song is analysed again.
        let mut hashers = [0_u8, 1].map(|first| {
            let mut hasher = DefaultHasher::new();
            (first, STRUCTURE_VERSION, content.cut.map(|cut| (cut.start, cut.end))).hash(&mut hasher);
            hasher
        });
        let mut whole = true;
        let read = content.song.read(|piece| {
            hashers.iter_mut().for_each(|hasher| hasher.write(piece));
            whole = go_on();
            whole
        });
        read.ok().filter(|()| whole)?;
        let [a, b] = hashers.map(|hasher| hasher.finish());
        Some(StructureKey((u128::from(a) << 64) | u128::from(b)))
    }

    pub(super) fn load(&self, key: StructureKey) -> Option<SongStructure> {
        let path = self.path(key)?;
        let bytes = read_file(&path).ok()?;
        let structure = decode(&bytes);
        if structure.is_none() {
            tracing::info!("{} is damaged and will be replaced", path.display());
        } else {
            // Update the time of use. If that fails, the cache may delete this file too early.
            let _ = File::options().write(true).open(path).and_then(|it| it.set_modified(SystemTime::now()));
        }
        structure
    }

    /// Saves a structure. After an error, the next run analyses the song again.
    pub(super) fn save(&self, key: StructureKey, structure: &SongStructure) {
        let (Some(path), Ok(text)) = (self.path(key), serde_json::to_string(structure)) else { return };
        if text.len() > LIMITS.structure_bytes_max {
            return;
        }
        let bytes = encode(&text);
        let written = path.parent().map_or(Ok(()), fs::create_dir_all).map_err(|error| error.to_string());
        let written = written.and_then(|()| {
            AtomicFile::create(&path)
                .and_then(|file| file.write(bytes.as_bytes()))
                .map_err(|error| error.to_string())
        });
        match written {
            Ok(()) => forget_oldest(path.parent(), LIMITS.structures_kept_max),
            Err(reason) => tracing::debug!("the structure of a song cannot be saved: {reason}"),
        }
    }

    fn path(&self, StructureKey(key): StructureKey) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join(format!("{key:032x}.{ENDING}")))
    }
}

fn read_file(path: &Path) -> io::Result<Vec<u8>> {
    // Opening a device or a pipe could block forever.
    if !fs::symlink_metadata(path)?.is_file() {
        return Err(io::ErrorKind::InvalidInput.into());
    }
    let (limit, mut bytes) = (LIMITS.structure_bytes_max + CHECKSUM_LINE, Vec::new());
    File::open(path)?.take(limit as u64 + 1).read_to_end(&mut bytes)?;
    if bytes.len() > limit { Err(io::ErrorKind::FileTooLarge.into()) } else { Ok(bytes) }
}

/// Length of the first line, including the line feed, in bytes.
const CHECKSUM_LINE: usize = 17;

fn encode(text: &str) -> String {
    format!("{:016x}\n{text}", checksum(text.as_bytes()))
}

fn decode(bytes: &[u8]) -> Option<SongStructure> {
    let (line, text) = bytes.split_at_checked(CHECKSUM_LINE)?;
    let line = std::str::from_utf8(line).ok()?.strip_suffix('\n')?;
    let is_whole = u64::from_str_radix(line, 16).ok()? == checksum(text);
    if is_whole { serde_json::from_slice(text).ok() } else { None }
}

fn checksum(bytes: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    hasher.write(bytes);
    hasher.finish()
}

pub(super) fn forget_oldest(folder: Option<&Path>, kept: usize) {
    let Some(listing) = folder.and_then(|folder| fs::read_dir(folder).ok()) else { return };
    let mut files: Vec<(SystemTime, PathBuf)> = listing
        .flatten()
        .filter(|entry| entry.path().extension().is_some_and(|ending| ending == ENDING))
        .filter_map(|entry| Some((entry.metadata().ok()?.modified().ok()?, entry.path())))
        .collect();
    files.sort();
    let surplus = files.len().saturating_sub(kept);
    for (_, path) in files.into_iter().take(surplus) {
        let _ = fs::remove_file(path);
    }
}
