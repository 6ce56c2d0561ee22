//! The tags of many files, read ahead of time for lists.
//!
//! A thread of low priority reads the headers of files: first the rows that a window shows, then the shown
//! folder, then the whole list of tracks. The tags stay in memory, and in a cache file between runs. A file whose size
//! and modification time are unchanged is not read again.
//!
//! Every method returns at once. The thread calls `wake` when new tags can be shown, at most ten times a second.

use std::borrow::Cow;
use std::collections::{HashMap, VecDeque};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant, UNIX_EPOCH};

use mariana_files::atomic_file::AtomicFile;
use mariana_files::reading::read_at_most;
use mariana_work::{Latest, Shared, looping};

use super::listed::{ListedTrack, ListedTracks};
use crate::decode::{TrackTags, tags_of};
use crate::one_line::one_line;
use crate::{limits, lower_priority};

/// The tags that are known so far, and the requests for more. Clones share everything; the thread ends with the last
/// clone.
#[derive(Debug, Clone, Default)]
pub struct TagLibrary(Arc<Latest<State>>);

#[derive(Debug, Default)]
struct State {
    known: HashMap<Arc<Path>, Known>,
    /// Files in visible rows.
    urgent: VecDeque<PathBuf>,
    folder: VecDeque<PathBuf>,
    list: Arc<ListedTracks>,
    /// The entries of the list before this index need no reading.
    list_at: usize,
    totals: Totals,
    /// The revision of the list to which the totals belong.
    totals_of: Option<u64>,
    revision: u64,
}

#[derive(Debug, Clone)]
struct Known {
    stamp: Stamp,
    tags: Arc<TrackTags>,
    /// True once this run has compared the stamp with the file.
    is_current: bool,
}

/// The size of a file in bytes, and its modification time in nanoseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Stamp {
    size: u64,
    modified: u64,
}

/// The length of the whole list of tracks.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Totals {
    /// The sum of all known lengths, in seconds.
    pub seconds: f64,
    /// The number of tracks whose length is not known.
    pub unknown: usize,
}

impl TagLibrary {
    /// Starts the thread. It keeps its results in the file `cache`, if there is one.
    ///
    /// # Errors
    /// Fails if the system cannot start a thread.
    pub fn start(cache: Option<PathBuf>, wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        let work = move |shared: &Shared<State>| read_all(shared, cache.as_deref(), &wake);
        looping("tags", State::default(), work).map(|library| Self(Arc::new(library)))
    }

    /// Reads the files of this list in the background, and computes the list's [`Totals`].
    pub fn follow_list(&self, list: &Arc<ListedTracks>) {
        if !Arc::ptr_eq(&self.0.lock().list, list) {
            self.0.change(|state| (state.list, state.list_at) = (list.clone(), 0));
        }
    }

    /// Reads these files before all others. Replaces the files of the last call.
    pub fn request<'a>(&self, files: impl IntoIterator<Item = &'a Path>) {
        self.0.change(|state| {
            let unread = files.into_iter().filter(|file| !state.is_current(file)).map(Path::to_owned);
            state.urgent = unread.collect();
        });
    }

    /// Reads these files of a folder before the files of the list, and looks whether they have changed. Replaces the
    /// files of the last call.
    pub fn request_folder(&self, files: impl IntoIterator<Item = PathBuf>) {
        let files = files.into_iter().take(limits::FOLDER_TAGS_MAX).collect();
        self.0.change(|state| state.folder = files);
    }

    /// The tags of a file; `None` until the file was examined. The tags of an unreadable file are empty.
    pub fn get(&self, file: &Path) -> Option<Arc<TrackTags>> {
        self.0.lock().current(file).map(|known| known.tags.clone())
    }

    /// The tags of a track of the list, as far as they are known. The data of a list are used for a part of a file, and
    /// where the file has no tags.
    pub fn of_track(&self, track: &ListedTrack) -> TrackTags {
        self.0.lock().of_track(track)
    }

    /// The length of the list that [`Self::follow_list`] was given last, as far as its files are known.
    pub fn totals(&self) -> Totals {
        self.0.lock().totals
    }

    /// A number that grows when new tags or totals can be shown.
    pub fn revision(&self) -> u64 {
        self.0.lock().revision
    }
}

/// Examines a file, and reads it unless it is unchanged. Returns true if the cache file must change.
fn examine(shared: &Shared<State>, file: &Path) -> bool {
    let stamp = stamp_of(file);
    let mut state = shared.lock();
    if let Some(known) = state.known.get_mut(&*key(file)).filter(|known| Some(known.stamp) == stamp) {
        known.is_current = true;
        return false;
    }
    drop(state);
    let tags = match stamp {
        Some(_) => tags_of(file).unwrap_or_else(|error| {
            tracing::debug!("the tags of {} are not known: {error}", file.display());
            TrackTags::default()
        }),
        None => TrackTags::default(),
    };
    shared.lock().insert(file, stamp.unwrap_or_default(), Arc::new(tags), true);
    stamp.is_some()
}

/// Computes the totals of the list and makes all results visible.
fn publish(shared: &Shared<State>) {
    let list = shared.lock().list.clone();
    let mut totals = Totals::default();
    for part in list.entries.chunks(ENTRIES_AT_ONCE) {
        let state = shared.lock();
        for track in part {
            match state.of_track(track).duration {
                Some(seconds) => totals.seconds += seconds,
                None => totals.unknown += 1,
            }
        }
    }
    let mut state = shared.lock();
    (state.totals, state.totals_of) = (totals, Some(list.revision));
    state.revision += 1;
}

/// Replaces the cache file. Paths that are no UTF-8 are left out. After an error, the next run reads the tags
/// again.
fn save(shared: &Shared<State>, cache: &Path) {
    let known = shared.lock().known.clone();
    let mut text = FIRST_LINE.as_bytes().to_vec();
    for (file, Known { stamp, tags, .. }) in &known {
        let Some(file) = file.to_str().filter(|_| *stamp != Stamp::default()) else { continue };
        let (title, artist) = (tags.title.as_deref(), tags.artist.as_deref());
        let line: Line<&str> = (file, stamp.size, stamp.modified, title, artist, tags.duration);
        if let Ok(line) = serde_json::to_vec(&line) {
            text.push(b'\n');
            text.extend(line);
        }
    }
    if let Err(error) = AtomicFile::create_with_folder(cache).and_then(|file| file.write(&text)) {
        tracing::debug!("the tags are not kept for the next run: {error}");
    }
}

impl State {
    /// The tags of a file that was examined in this run.
    fn current(&self, file: &Path) -> Option<&Known> {
        self.known.get(&*key(file)).filter(|known| known.is_current)
    }

    fn is_current(&self, file: &Path) -> bool {
        self.current(file).is_some()
    }

    fn of_track(&self, track: &ListedTrack) -> TrackTags {
        let whole = track.file.as_deref().filter(|_| track.start.is_none());
        let tags = whole.and_then(|file| self.current(file)).map(|known| &known.tags);
        let duration = tags.and_then(|tags| tags.duration).or(track.duration);
        let named = tags.filter(|tags| tags.title.is_some()).map(|tags| (&tags.title, &tags.artist));
        let (title, artist) = named.unwrap_or((&track.title, &track.artist));
        TrackTags { title: title.clone(), artist: artist.clone(), duration }
    }

    /// Adds tags. At the limit, all other tags are forgotten, and the list is read again for its total
    /// length.
    fn insert(&mut self, file: &Path, stamp: Stamp, tags: Arc<TrackTags>, is_current: bool) {
        let file = &*key(file);
        if self.known.len() >= limits::TAGS_KEPT_MAX && !self.known.contains_key(file) {
            self.known.clear();
            self.list_at = 0;
        }
        self.known.insert(file.into(), Known { stamp, tags, is_current });
    }

    /// Returns the next file to read.
    fn next(&mut self) -> Option<PathBuf> {
        while let Some(file) = self.urgent.pop_front() {
            if !self.is_current(&file) {
                return Some(file);
            }
        }
        if let Some(file) = self.folder.pop_front() {
            return Some(file);
        }
        let list = self.list.clone();
        while let Some(track) = list.entries.get(self.list_at) {
            self.list_at += 1;
            let whole = track.file.as_ref().filter(|_| track.start.is_none());
            if let Some(file) = whole.filter(|file| !self.is_current(file)) {
                return Some(file.clone());
            }
        }
        None
    }

    fn has_work(&self) -> bool {
        !self.urgent.is_empty()
            || !self.folder.is_empty()
            || self.list_at < self.list.entries.len()
            || self.has_new_list()
    }

    /// True if the totals belong to an earlier list.
    fn has_new_list(&self) -> bool {
        self.totals_of != Some(self.list.revision)
    }
}

/// The path under which a file is kept, so that the cache is valid in every working directory.
fn key(file: &Path) -> Cow<'_, Path> {
    let absolute = if file.is_relative() { std::path::absolute(file).ok() } else { None };
    absolute.map_or(file.into(), Cow::from)
}

// The cache file of tags. After a first line, each line is a JSON array: path, size, modification time, title, artist
// and length. Lines that cannot be understood are left out. The file may be deleted at any time. If two windows write
// it, the last one wins, and the next run reads the other tags again.

/// The first line. The number changes when a new version reads other tags from the same file.
const FIRST_LINE: &str = "Mariana's tags, version 2";

type Line<Text> = (Text, u64, u64, Option<Text>, Option<Text>, Option<f64>);

/// Reads the file. A missing or damaged file has no entries.
fn load(cache: &Path) -> Vec<(PathBuf, Stamp, TrackTags)> {
    let bytes = read_at_most(cache, limits::TAG_CACHE_BYTES_MAX).ok().flatten().unwrap_or_default();
    let mut lines = bytes.split(|byte| *byte == b'\n');
    if lines.next() != Some(FIRST_LINE.as_bytes()) {
        return Vec::new();
    }
    lines.filter_map(understood).take(limits::TAGS_KEPT_MAX).collect()
}

fn understood(line: &[u8]) -> Option<(PathBuf, Stamp, TrackTags)> {
    let (file, size, modified, title, artist, duration): Line<String> = serde_json::from_slice(line).ok()?;
    let believed = |seconds: &f64| *seconds > 0.0 && *seconds <= limits::CLAIMED_DURATION_MAX;
    let text = |text: Option<String>| text.map(|text| one_line(&text)).filter(|text| !text.is_empty());
    let tags = TrackTags { title: text(title), artist: text(artist), duration: duration.filter(believed) };
    Some((file.into(), Stamp { size, modified }, tags))
}

// The thread that reads tags.

/// Minimum interval between two publications. Each one makes the window lay out its lists again.
const PUBLISH_EVERY: Duration = Duration::from_millis(100);
/// Maximum number of entries that are added up under one lock, because the drawing thread takes the lock too.
const ENTRIES_AT_ONCE: usize = 256;
/// The work is short, and a user may wait for it: next to a software renderer, a higher niceness would starve it.
const NICENESS: i32 = 5;

fn read_all(shared: &Shared<State>, cache: Option<&Path>, wake: &dyn Fn()) {
    lower_priority(NICENESS);
    if let Some(cache) = cache {
        let kept = load(cache);
        let mut state = shared.lock();
        for (file, stamp, tags) in kept {
            state.insert(&file, stamp, Arc::new(tags), false);
        }
    }
    let (mut unpublished, mut unsaved) = (false, false);
    let mut published = Instant::now();
    loop {
        let is_over = shared.is_over();
        let next = if is_over { None } else { shared.lock().next() };
        let is_idle = next.is_none();
        if let Some(file) = next {
            unsaved |= examine(shared, &file);
            unpublished = true;
        }
        let publishes = is_idle || published.elapsed() >= PUBLISH_EVERY;
        if !is_over && (unpublished && publishes || is_idle && shared.lock().has_new_list()) {
            publish(shared);
            wake();
            (unpublished, published) = (false, Instant::now());
        }
        if let Some(cache) = cache.filter(|_| is_idle && unsaved) {
            save(shared, cache);
            unsaved = false;
        }
        if is_over {
            return;
        }
        if is_idle {
            drop(shared.wait_while(Duration::MAX, |state| !state.has_work()));
        }
    }
}

/// Returns the stamp of a regular file.
fn stamp_of(file: &Path) -> Option<Stamp> {
    let about = std::fs::metadata(file).ok().filter(std::fs::Metadata::is_file)?;
    let modified = about.modified().ok().and_then(|time| time.duration_since(UNIX_EPOCH).ok());
    let modified = modified.and_then(|time| u64::try_from(time.as_nanos()).ok()).unwrap_or_default();
    Some(Stamp { size: about.len(), modified })
}

#[cfg(test)]
mod tests;
