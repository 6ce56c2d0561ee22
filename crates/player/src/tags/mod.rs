//! The tags of many files, read ahead of time for lists.
//!
//! A thread of low priority reads the headers of files: first the rows that a window shows, then the shown
//! folder, then the whole list of tracks. The tags stay in memory, and in a cache file between runs. A file whose size
//! and modification time are unchanged is not read again.
//!
//! Every method returns at once. The thread calls `wake` when new tags can be shown, at most ten times a second.

mod cache;
mod reader;

use std::borrow::Cow;
use std::collections::{HashMap, VecDeque};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use cache::TagCache;

use super::decode::TrackTags;
use super::limits::LIMITS;
use super::listed::{ListedTrack, ListedTracks};

/// The tags that are known so far, and the requests for more. Clones share everything; the thread ends with the last
/// clone.
#[derive(Debug, Clone, Default)]
pub struct TagLibrary(Arc<Handle>);

#[derive(Debug, Default)]
struct Handle {
    shared: Arc<Shared>,
}

#[derive(Debug, Default)]
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    known: HashMap<Arc<Path>, Known>,
    /// Grows with each use of an entry. The least recently used entries are forgotten first.
    uses: u64,
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
    over: bool,
}

#[derive(Debug, Clone)]
struct Known {
    stamp: Stamp,
    tags: Arc<TrackTags>,
    used: u64,
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
        let library = Self::default();
        let (shared, cache) = (library.0.shared.clone(), cache.map(TagCache::at));
        let work = move || reader::run(&shared, cache.as_ref(), &wake);
        std::thread::Builder::new().name("tags".into()).spawn(work)?;
        Ok(library)
    }

    /// Reads the files of this list in the background, and computes the list's [`Totals`].
    pub fn follow_list(&self, list: &Arc<ListedTracks>) {
        let mut state = self.lock();
        if !Arc::ptr_eq(&state.list, list) {
            (state.list, state.list_at) = (list.clone(), 0);
            self.0.shared.changed.notify_one();
        }
    }

    /// Reads these files before all others. Replaces the files of the last call.
    pub fn request<'a>(&self, files: impl IntoIterator<Item = &'a Path>) {
        let mut state = self.lock();
        state.urgent.clear();
        for file in files {
            if !state.is_current(file) {
                state.urgent.push_back(file.to_owned());
            }
        }
        if !state.urgent.is_empty() {
            self.0.shared.changed.notify_one();
        }
    }

    /// Reads these files of a folder before the files of the list, and looks whether they have changed. Replaces the
    /// files of the last call.
    pub fn request_folder(&self, files: impl IntoIterator<Item = PathBuf>) {
        self.lock().folder = files.into_iter().take(LIMITS.folder_tags_max).collect();
        self.0.shared.changed.notify_one();
    }

    /// The tags of a file; `None` until the file was examined. The tags of an unreadable file are empty.
    pub fn get(&self, file: &Path) -> Option<Arc<TrackTags>> {
        self.lock().current(file).map(|known| known.tags.clone())
    }

    /// The tags of a track of the list, as far as they are known. The data of a list are used for a part of a file, and
    /// where the file has no tags.
    pub fn of_track(&self, track: &ListedTrack) -> TrackTags {
        let whole = track.file.as_deref().filter(|_| track.start.is_none());
        merged(track, whole.and_then(|file| self.get(file)).as_deref())
    }

    /// The length of the list that [`Self::follow_list`] was given last, as far as its files are known.
    pub fn totals(&self) -> Totals {
        self.lock().totals
    }

    /// A number that grows when new tags or totals can be shown.
    pub fn revision(&self) -> u64 {
        self.lock().revision
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.0.shared.lock()
    }
}

impl Drop for Handle {
    fn drop(&mut self) {
        self.shared.lock().over = true;
        self.shared.changed.notify_one();
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
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

    /// Adds tags. At the limit, a quarter of all tags is forgotten, the least recently used first.
    fn insert(&mut self, file: &Path, stamp: Stamp, tags: Arc<TrackTags>, is_current: bool) {
        let file = &*key(file);
        if self.known.len() >= LIMITS.tags_kept_max && !self.known.contains_key(file) {
            let mut uses: Vec<u64> = self.known.values().map(|known| known.used).collect();
            uses.sort_unstable();
            let least = uses.get(uses.len() / 4).copied().unwrap_or_default();
            self.known.retain(|_, known| known.used >= least);
        }
        self.uses += 1;
        self.known.insert(file.into(), Known { stamp, tags, used: self.uses, is_current });
    }
}

/// The path under which a file is kept, so that the cache is valid in every working directory.
fn key(file: &Path) -> Cow<'_, Path> {
    let absolute = if file.is_relative() { std::path::absolute(file).ok() } else { None };
    absolute.map_or(file.into(), Cow::from)
}

fn merged(track: &ListedTrack, tags: Option<&TrackTags>) -> TrackTags {
    let of_list =
        TrackTags { title: track.title.clone(), artist: track.artist.clone(), duration: track.duration };
    match tags {
        Some(tags) if tags.title.is_some() => {
            TrackTags { duration: tags.duration.or(of_list.duration), ..tags.clone() }
        }
        Some(tags) => TrackTags { duration: tags.duration.or(of_list.duration), ..of_list },
        None => of_list,
    }
}

#[cfg(test)]
mod tests;
