//! What a file contained when it was looked at, to decide whether it really changed.

use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io;
use std::path::Path;
use std::time::SystemTime;

use mariana_field::limits::LIMITS as FIELD_LIMITS;

use super::folder::read_at_most;
use crate::limits::LIMITS;

/// A file as it was at one time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Look {
    pub content: Content,
    pub stamp: Stamp,
}

/// Its content.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Content {
    /// There is no such file.
    Missing,
    /// A file of this many bytes; if that is more than any scene reads, only the beginning is known.
    Bytes { length: u64, hash: u64 },
    /// A folder, a pipe, or something that the system refuses to read.
    Unreadable(String),
}

/// What the system reports without reading the file: length and time of the last change. Alone it proves nothing,
/// because two saves within one tick of the file system's clock look the same.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Stamp(Option<(u64, Option<SystemTime>)>);

impl Stamp {
    pub(super) fn of(path: &Path) -> Self {
        let metadata = fs::metadata(path).ok();
        Self(metadata.map(|metadata| (metadata.len(), metadata.modified().ok())))
    }

    /// Whether the file may have changed at `time` or later.
    pub(super) fn is_since(&self, time: SystemTime) -> bool {
        matches!(self.0, Some((_, Some(modified))) if modified >= time)
    }
}

impl Look {
    pub(super) fn at(path: &Path) -> Self {
        // The stamp comes first: if the file changes meanwhile, the next look finds another one.
        let stamp = Stamp::of(path);
        let content = match hash(path) {
            Ok((length, hash)) => Content::Bytes { length, hash },
            Err(error) if error.kind() == io::ErrorKind::NotFound => Content::Missing,
            Err(error) => Content::Unreadable(error.to_string()),
        };
        Self { content, stamp }
    }
}

impl Content {
    /// Whether the file is missing or empty now and was not before: a save that empties or deletes the file first.
    pub(super) fn is_gone_since(&self, before: &Self) -> bool {
        let nothing = |content: &Self| matches!(content, Self::Missing | Self::Bytes { length: 0, .. });
        nothing(self) && !nothing(before)
    }
}

fn hash(path: &Path) -> io::Result<(u64, u64)> {
    let metadata = fs::metadata(path)?;
    if !metadata.is_file() {
        return Err(io::Error::other("no file"));
    }
    let max = LIMITS.texture_bytes_max.max(FIELD_LIMITS.scene_bytes_max);
    let Some(bytes) = read_at_most(path, max)? else { return Ok((metadata.len(), 0)) };
    let mut hasher = DefaultHasher::new();
    bytes.hash(&mut hasher);
    Ok((bytes.len() as u64, hasher.finish()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_content_counts_and_not_the_time() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        assert_eq!(Look::at(&path).content, Content::Missing);
        fs::write(&path, "one").unwrap();
        let first = Look::at(&path);
        let file = fs::File::options().append(true).open(&path).unwrap();
        file.set_modified(SystemTime::UNIX_EPOCH).unwrap();
        let touched = Look::at(&path);
        assert_eq!(first.content, touched.content);
        assert_ne!(first.stamp, touched.stamp);
        fs::write(&path, "two").unwrap();
        file.set_modified(SystemTime::UNIX_EPOCH).unwrap();
        let second = Look::at(&path);
        assert_eq!(second.stamp, touched.stamp);
        assert_ne!(second.content, touched.content);
        assert!(matches!(Look::at(folder.path()).content, Content::Unreadable(_)));
    }

    #[test]
    fn empty_after_something_is_gone_but_empty_from_the_start_is_not() {
        let [empty, full] = [0, 7].map(|length| Content::Bytes { length, hash: 1 });
        assert!(empty.is_gone_since(&full) && Content::Missing.is_gone_since(&full));
        assert!(!empty.is_gone_since(&Content::Missing) && !Content::Missing.is_gone_since(&empty));
        assert!(!full.is_gone_since(&full));
    }
}
