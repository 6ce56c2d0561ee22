//! The cache file of tags. After a first line, each line is a JSON array: path, size, modification time, title, artist
//! and length. Lines that cannot be understood are left out. The file may be deleted at any time. If two windows write
//! it, the last one wins, and the next run reads the other tags again.

use std::fs::{self, File};
use std::io::Read as _;
use std::path::{Path, PathBuf};

use super::Stamp;
use crate::decode::TrackTags;
use crate::limits::LIMITS;
use crate::one_line::one_line;
use mariana_files::atomic_file::AtomicFile;

/// The first line. The number changes when a new version reads other tags from the same file.
const FIRST_LINE: &str = "Mariana's tags, version 2";

#[derive(Debug)]
pub(super) struct TagCache(PathBuf);

type Line<Text> = (Text, u64, u64, Option<Text>, Option<Text>, Option<f64>);

impl TagCache {
    pub(super) fn at(path: PathBuf) -> Self {
        Self(path)
    }

    /// Reads the file, the least recently used entry first. A missing or damaged file has no entries.
    pub(super) fn load(&self) -> Vec<(PathBuf, Stamp, TrackTags)> {
        let is_file = fs::symlink_metadata(&self.0).is_ok_and(|about| about.is_file());
        let Some(file) = is_file.then(|| File::open(&self.0).ok()).flatten() else { return Vec::new() };
        let mut bytes = Vec::new();
        if let Err(error) = file.take(LIMITS.tag_cache_bytes_max).read_to_end(&mut bytes) {
            tracing::debug!("the cache of tags cannot be read: {error}");
            return Vec::new();
        }
        let mut lines = bytes.split(|byte| *byte == b'\n');
        if lines.next() != Some(FIRST_LINE.as_bytes()) {
            return Vec::new();
        }
        lines.filter_map(understood).take(LIMITS.tags_kept_max).collect()
    }

    /// Replaces the file. Paths that are no UTF-8 are left out. After an error, the next run reads the tags again.
    pub(super) fn save<'a>(&self, entries: impl Iterator<Item = (&'a Path, Stamp, &'a TrackTags)>) {
        let mut text = FIRST_LINE.as_bytes().to_vec();
        for (file, stamp, tags) in entries.filter(|(_, stamp, _)| *stamp != Stamp::default()) {
            let Some(file) = file.to_str() else { continue };
            let (title, artist) = (tags.title.as_deref(), tags.artist.as_deref());
            let line: Line<&str> = (file, stamp.size, stamp.modified, title, artist, tags.duration);
            if let Ok(line) = serde_json::to_vec(&line) {
                text.push(b'\n');
                text.extend(line);
            }
        }
        let folder = self.0.parent().map_or(Ok(()), fs::create_dir_all).map_err(|error| error.to_string());
        let written = folder.and_then(|()| {
            AtomicFile::create(&self.0).and_then(|file| file.write(&text)).map_err(|error| error.to_string())
        });
        if let Err(reason) = written {
            tracing::debug!("the tags are not kept for the next run: {reason}");
        }
    }
}

fn understood(line: &[u8]) -> Option<(PathBuf, Stamp, TrackTags)> {
    let (file, size, modified, title, artist, duration): Line<String> = serde_json::from_slice(line).ok()?;
    let believed = |seconds: &f64| *seconds > 0.0 && *seconds <= LIMITS.claimed_duration_max;
    let text = |text: Option<String>| text.map(|text| one_line(&text)).filter(|text| !text.is_empty());
    let tags = TrackTags { title: text(title), artist: text(artist), duration: duration.filter(believed) };
    Some((file.into(), Stamp { size, modified }, tags))
}
