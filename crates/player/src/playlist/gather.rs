//! Expansion of files, folders and lists to the entries of one list.

use std::cmp::Ordering;
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs;
use std::io::{self, ErrorKind};
use std::iter::Peekable;
use std::path::{Path, PathBuf};
use std::str::Chars;

use mariana_files::reading::read_at_most;

use super::error::{PlaylistError, name_of};
use super::lists::{Cut, Item, Kind};
use super::text::Reference;
use crate::decode::TrackTags;
use crate::limits;
use crate::listed::ListedTrack;
use crate::one_line::one_line;
use crate::song::{Song, track_name};
use crate::stems::is_folder_of_stems;
use crate::track::Content;

/// Extensions of the files that are taken from a folder, in lower case.
pub const AUDIO_EXTENSIONS: &[&str] = &[
    "aac", "ac3", "aif", "aifc", "aiff", "alac", "amr", "ape", "au", "bw64", "caf", "dsf", "dts", "eac3",
    "flac", "it", "m4a", "m4b", "mka", "mkv", "mod", "mp1", "mp2", "mp3", "mp4", "mpc", "oga", "ogg", "opus",
    "rf64", "s3m", "snd", "spx", "tta", "voc", "w64", "wav", "wave", "webm", "wma", "wv", "xm",
];

const TRACK_ERRORS_KEPT: usize = 20;

#[derive(Debug, Clone, PartialEq)]
pub(super) struct PlaylistEntry {
    pub content: Content,
    /// What a list says about the song.
    pub tags: TrackTags,
}

impl From<Song> for PlaylistEntry {
    fn from(song: Song) -> Self {
        Self { content: Content { song, cut: None }, tags: TrackTags::default() }
    }
}

impl PlaylistEntry {
    pub(super) fn listed(&self) -> ListedTrack {
        let (name, file) = match &self.content.song {
            Song::Embedded { name, .. } => ((*name).to_owned(), None),
            Song::File(path) => (name_of(path), Some(path.clone())),
        };
        let length = |cut: Cut| {
            let (start, end) = cut.seconds();
            cut.end.map(|_| (end - start).max(0.0))
        };
        let TrackTags { title, artist, duration } = &self.tags;
        let tag = |text: &Option<String>| text.as_deref().map(one_line).filter(|text| !text.is_empty());
        ListedTrack {
            name: track_name(artist.as_deref(), title.as_deref(), &name),
            title: tag(title),
            artist: tag(artist),
            duration: duration.or_else(|| self.content.cut.and_then(length)),
            file,
            start: self.content.cut.map(|cut| cut.seconds().0),
        }
    }
}

#[derive(Debug, Default)]
pub(super) struct Gathered {
    pub entries: Vec<PlaylistEntry>,
    pub track_errors: Vec<PlaylistError>,
    /// Lists and folders that are being read. They reveal a list or folder that contains itself.
    open: Vec<PathBuf>,
    /// Folders that were read. Each folder is read only once, because several links may lead to it.
    folders: BTreeSet<PathBuf>,
    lists: usize,
    looked_at: usize,
    full: bool,
}

pub(super) fn is_many(path: &Path) -> bool {
    path.is_dir() || Kind::of(path).is_some()
}

/// Gathers the given files, the entries of lists, and the audio files in folders and subfolders in natural order.
pub(super) fn gather(paths: &[PathBuf]) -> Gathered {
    let mut gathered = Gathered::default();
    for path in paths {
        gathered.folders.clear();
        gathered.add(path, None);
    }
    gathered
}

impl Gathered {
    fn report(&mut self, trouble: PlaylistError) {
        if self.track_errors.len() < TRACK_ERRORS_KEPT {
            self.track_errors.push(trouble);
        }
    }

    /// True if the list has room for more entries. Adds an error when the limit is reached for the first time.
    fn has_room(&mut self) -> bool {
        let (tracks, looks) = (limits::PLAYLIST_TRACKS_MAX, limits::PLAYLIST_LOOKS_MAX);
        let over = if self.entries.len() >= tracks {
            Some(("tracks", tracks))
        } else {
            (self.looked_at >= looks).then_some(("files and entries to examine", looks))
        };
        if let (Some((what, limit)), false) = (over, self.full) {
            self.full = true;
            // Insert the error at the front: if there are many errors, errors in the middle are not reported.
            self.track_errors.insert(0, PlaylistError::too_many(what, limit));
        }
        self.looked_at += 1;
        over.is_none()
    }

    fn add(&mut self, path: &Path, item: Option<&Item>) {
        if !self.has_room() {
            return;
        }
        if path.is_dir() {
            return self.add_folder(path);
        }
        if let Some(kind) = Kind::of(path).filter(|_| path.exists()) {
            return self.add_list(path, kind);
        }
        // Problems with the file are reported when it is played.
        let song = Song::File(path.to_owned());
        self.entries.push(match item {
            Some(item) => PlaylistEntry { content: Content { song, cut: item.cut }, tags: item.tags.clone() },
            None => song.into(),
        });
    }

    /// Marks the list or folder at `path` as being read. Returns false if reading it would never end.
    fn enter(&mut self, path: &Path) -> bool {
        let limit = limits::PLAYLIST_DEPTH_MAX;
        let real = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let name = name_of(path);
        let trouble = if self.open.contains(&real) {
            format!("{name} contains itself, so this entry was left out; remove the entry")
        } else if self.open.len() >= limit {
            format!(
                "{name} is nested more than {limit} levels deep, so it was left out; open {name} directly"
            )
        } else {
            self.open.push(real);
            return true;
        };
        self.report(PlaylistError(trouble));
        false
    }

    fn add_list(&mut self, path: &Path, kind: Kind) {
        let limit = limits::PLAYLIST_LISTS_MAX;
        if self.lists >= limit {
            return self.report(PlaylistError::too_many("lists", limit));
        }
        self.lists += 1;
        if !self.enter(path) {
            return;
        }
        match read_bounded(path).and_then(|bytes| kind.read(path, &bytes)) {
            Err(error) => self.report(error),
            Ok(items) => {
                for item in &items {
                    if self.full {
                        break;
                    }
                    match &item.reference {
                        Reference::Path(path) => self.add(path, Some(item)),
                        Reference::Address(address) => {
                            let (address, list) = (one_line(address), name_of(path));
                            self.report(PlaylistError(format!(
                                "{address} in {list} is a network address, which is not supported; download it to a \
                                 file first"
                            )));
                        }
                    }
                }
            }
        }
        self.open.pop();
    }

    fn add_folder(&mut self, path: &Path) {
        let real = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        if !self.folders.insert(real) || !self.enter(path) {
            return;
        }
        let before = self.entries.len();
        match fs::read_dir(path) {
            Err(error) => self.report(unreadable(path, &error)),
            Ok(children) => {
                let mut found = Vec::new();
                // Entries that cannot be examined count as missing.
                for child in children.flatten() {
                    if !self.has_room() {
                        break;
                    }
                    let path = child.path();
                    let hidden = child.file_name().as_encoded_bytes().first() == Some(&b'.');
                    let is_folder = path.is_dir() && !is_folder_of_stems(&path);
                    if !hidden && (is_folder || (is_audio(&path) && path.is_file())) {
                        found.push((child.file_name().to_string_lossy().into_owned(), path));
                    }
                }
                found.sort_by(|(a, x), (b, y)| compare(a, b).then_with(|| x.cmp(y)));
                found.iter().for_each(|(_, path)| self.add(path, None));
            }
        }
        self.open.pop();
        if self.open.is_empty() && self.entries.len() == before && self.track_errors.is_empty() {
            self.report(PlaylistError::empty(&name_of(path)));
        }
    }
}

pub(crate) fn is_audio(path: &Path) -> bool {
    let extension = path.extension().and_then(OsStr::to_str).unwrap_or_default();
    AUDIO_EXTENSIONS.iter().any(|known| extension.eq_ignore_ascii_case(known))
}

fn read_bounded(path: &Path) -> Result<Vec<u8>, PlaylistError> {
    let limit = limits::PLAYLIST_BYTES_MAX;
    let bytes = read_at_most(path, limit).map_err(|error| match error.kind() {
        ErrorKind::InvalidInput => {
            let path = path.display();
            PlaylistError(format!("{path} is not a regular file; save the list to a file first"))
        }
        _ => unreadable(path, &error),
    })?;
    bytes.ok_or_else(|| {
        let name = name_of(path);
        PlaylistError(format!("{name} is too large for a list (more than {limit} bytes); split the list"))
    })
}

fn unreadable(path: &Path, error: &io::Error) -> PlaylistError {
    PlaylistError(format!("{} cannot be read ({error}); check its permissions and the disk", path.display()))
}

// Natural order: "track 2" before "track 10".

/// Compares digits as numbers, and letters without case. If two names are then equal, compares them by characters.
pub fn compare(a: &str, b: &str) -> Ordering {
    let (mut left, mut right) = (a.chars().peekable(), b.chars().peekable());
    loop {
        let (Some(x), Some(y)) = (left.peek().copied(), right.peek().copied()) else {
            let lengths = left.peek().is_some().cmp(&right.peek().is_some());
            return lengths.then_with(|| a.cmp(b));
        };
        let order = if x.is_ascii_digit() && y.is_ascii_digit() {
            let (x, y) = (number(&mut left), number(&mut right));
            // Without leading zeros, the number with more digits is larger.
            x.len().cmp(&y.len()).then_with(|| x.cmp(&y))
        } else {
            left.next();
            right.next();
            x.to_lowercase().cmp(y.to_lowercase())
        };
        if order != Ordering::Equal {
            return order;
        }
    }
}

fn number(characters: &mut Peekable<Chars<'_>>) -> String {
    let mut digits = String::new();
    while let Some(digit) = characters.next_if(char::is_ascii_digit) {
        if digit != '0' || !digits.is_empty() {
            digits.push(digit);
        }
    }
    digits
}

#[cfg(test)]
#[path = "gather_tests.rs"]
mod tests;

#[cfg(test)]
mod natural_tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn numbers_are_compared_by_value() {
        let wanted = ["1 a", "1 B", "2", "10", "010b", "A1", "a2", "a10", "a10x", "b", "é"];
        let mut names = wanted;
        names.reverse();
        names.sort_by(|a, b| compare(a, b));
        assert_eq!(names, wanted);
        let long = format!("{}1", "9".repeat(500));
        assert_eq!(compare(&long, &format!("{}2", "9".repeat(500))), Ordering::Less);
    }

    proptest! {
        #[test]
        fn it_is_a_total_order(names in prop::collection::vec("[aB0-2 é.]{0,6}", 3)) {
            let order = |x: usize, y: usize| compare(&names[x], &names[y]);
            for (x, y, z) in [(0, 1, 2), (1, 2, 0), (2, 0, 1), (1, 0, 2), (0, 2, 1), (2, 1, 0)] {
                prop_assert_eq!(order(x, y), order(y, x).reverse());
                prop_assert_eq!(order(x, y) == Ordering::Equal, names[x] == names[y]);
                if order(x, y) != Ordering::Greater && order(y, z) != Ordering::Greater {
                    prop_assert_ne!(order(x, z), Ordering::Greater);
                }
            }
        }
    }
}
