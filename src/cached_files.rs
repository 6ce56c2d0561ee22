//! Files in the user's cache folder. A file contains a line with a checksum, and then the contents. All files may be
//! deleted at any time; a damaged file is replaced, and the least recently used files are deleted first.
//!
//! [`CachedFiles`] are about songs. The name of a file is a hash of the songs' bytes and of what else decides about the
//! contents.

use std::hash::{DefaultHasher, Hash, Hasher as _};
use std::path::PathBuf;

use crate::atomic_file::AtomicFile;
use crate::caches::{make_room, touch};
use crate::reading::read_at_most;
use mariana_player::song::Song;

/// Identifies a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FileKey(u128);

/// A folder of files of one kind.
#[derive(Debug, Clone)]
pub struct CachedFiles {
    /// The folder, which is created at the first write; `None` if nothing is cached.
    pub folder: Option<PathBuf>,
    /// The files' extension.
    pub ending: &'static str,
    /// Maximum size of the contents of a file, in bytes. Larger contents are not saved.
    pub bytes_max: usize,
    /// Maximum number of files.
    pub kept_max: usize,
}

impl CachedFiles {
    /// Returns the key of `songs`, and of the value `about` that else decides about the contents; `None` without a
    /// folder, for an unreadable song, or if `go_on` returns false.
    pub fn key<'a>(
        &self,
        about: impl Hash,
        songs: impl IntoIterator<Item = &'a Song>,
        go_on: &dyn Fn() -> bool,
    ) -> Option<FileKey> {
        self.folder.as_ref()?;
        // Two 64-bit hashes. If another version of Rust hashes differently, the songs are analysed again.
        let mut hashers = [0_u8, 1].map(|first| {
            let mut hasher = DefaultHasher::new();
            (first, &about).hash(&mut hasher);
            hasher
        });
        for song in songs {
            let (mut whole, mut length) = (true, 0_u64);
            let read = song.read(|piece| {
                hashers.iter_mut().for_each(|hasher| hasher.write(piece));
                length += piece.len() as u64;
                whole = go_on();
                whole
            });
            read.ok().filter(|()| whole)?;
            hashers.iter_mut().for_each(|hasher| hasher.write_u64(length));
        }
        let [a, b] = hashers.map(|hasher| hasher.finish());
        Some(FileKey((u128::from(a) << 64) | u128::from(b)))
    }

    /// Returns the contents of a file, if the file exists and `decode` accepts its contents.
    pub fn load<T>(&self, key: FileKey, decode: impl FnOnce(&[u8]) -> Option<T>) -> Option<T> {
        let path = self.path(key)?;
        let bytes = read_at_most(&path, self.bytes_max + CHECKSUM_LINE).ok()??;
        let contents = unsealed(&bytes).and_then(decode);
        match contents {
            None => tracing::info!("{} is damaged and will be replaced", path.display()),
            Some(_) => touch(&path),
        }
        contents
    }

    /// Saves a file. After an error, the next run finds no file.
    pub fn save(&self, key: FileKey, contents: &[u8]) {
        let Some(path) = self.path(key).filter(|_| contents.len() <= self.bytes_max) else { return };
        match AtomicFile::create_with_folder(&path).and_then(|file| file.write(&sealed(contents))) {
            Ok(()) => self.forget_oldest(),
            Err(error) => tracing::debug!("a file of the cache cannot be saved: {error}"),
        }
    }

    fn path(&self, FileKey(key): FileKey) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join(format!("{key:032x}.{}", self.ending)))
    }

    /// Deletes the least recently used files beyond the limit.
    pub(crate) fn forget_oldest(&self) {
        if let Some(folder) = &self.folder {
            make_room(folder, &[self.ending], |_| 1, self.kept_max as u64);
        }
    }
}

/// Length of the first line, including the line feed, in bytes.
pub const CHECKSUM_LINE: usize = 17;

/// Puts a line with a checksum before the contents of a file.
pub fn sealed(contents: &[u8]) -> Vec<u8> {
    [format!("{:016x}\n", checksum(contents)).as_bytes(), contents].concat()
}

/// Returns the contents of a [`sealed`] file; `None` if they are damaged.
pub fn unsealed(bytes: &[u8]) -> Option<&[u8]> {
    let (line, contents) = bytes.split_at_checked(CHECKSUM_LINE)?;
    let line = std::str::from_utf8(line).ok()?.strip_suffix('\n')?;
    (u64::from_str_radix(line, 16).ok()? == checksum(contents)).then_some(contents)
}

fn checksum(bytes: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    hasher.write(bytes);
    hasher.finish()
}
