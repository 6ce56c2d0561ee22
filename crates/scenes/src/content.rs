//! The content of a file at one time, to decide if the file has really changed.

use mariana_files::reading::read_at_most;
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io;
use std::path::Path;
use std::time::SystemTime;

use mariana_field::limits::LIMITS as FIELD_LIMITS;

use crate::limits::LIMITS;

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Look {
    pub content: Content,
    pub stamp: Stamp,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Content {
    Missing,
    /// Length and hash of a file. If the file is larger than any scene may read, `hash` is 0.
    Bytes {
        length: u64,
        hash: u64,
    },
    /// A folder, a pipe, or a file that the system refuses to read.
    Unreadable(String),
}

/// Length and modification time, known without reading the file. Equal stamps do not prove that a file is unchanged:
/// two saves within one tick of the file system's clock have equal stamps.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Stamp(Option<(u64, Option<SystemTime>)>);

impl Stamp {
    pub(super) fn of(path: &Path) -> Self {
        let metadata = fs::metadata(path).ok();
        Self(metadata.map(|metadata| (metadata.len(), metadata.modified().ok())))
    }

    /// True if the file may have changed at `time` or later.
    pub(super) fn is_since(&self, time: SystemTime) -> bool {
        matches!(self.0, Some((_, Some(modified))) if modified >= time)
    }
}

impl Look {
    pub(super) fn at(path: &Path) -> Self {
        // Take the stamp first: if the file changes in between, the next check finds a different stamp.
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
    /// True if the file has become missing or empty, as in a save that first empties or deletes the file.
    pub(super) fn is_gone_since(&self, before: &Self) -> bool {
        let nothing = |content: &Self| matches!(content, Self::Missing | Self::Bytes { length: 0, .. });
        nothing(self) && !nothing(before)
    }
}

fn hash(path: &Path) -> io::Result<(u64, u64)> {
    let max = LIMITS.texture_bytes_max.max(FIELD_LIMITS.scene_bytes_max);
    let Some(bytes) = read_at_most(path, max)? else { return Ok((fs::metadata(path)?.len(), 0)) };
    let mut hasher = DefaultHasher::new();
    bytes.hash(&mut hasher);
    Ok((bytes.len() as u64, hasher.finish()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_decides_and_not_the_time() {
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
