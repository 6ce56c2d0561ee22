//! The thread that reads tags.

use std::path::{Path, PathBuf};
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant, UNIX_EPOCH};

use super::cache::TagCache;
use super::{Known, Shared, Stamp, State, Totals, key, merged};
use crate::decode::{TrackTags, tags_of};
use crate::priority;

/// Minimum interval between two publications. Each one makes the window lay out its lists again.
const PUBLISH_EVERY: Duration = Duration::from_millis(100);
/// Interval at which new tags are saved while the thread is busy. An idle thread saves at once.
const SAVE_EVERY: Duration = Duration::from_secs(20);
/// Maximum number of entries that are examined under one lock, because the drawing thread takes the lock too.
const ENTRIES_AT_ONCE: usize = 256;
/// The work is short, and a user may wait for it: next to a software renderer, a higher niceness would starve it.
const NICENESS: i32 = 5;

pub(super) enum Next {
    /// Reads this file.
    File(PathBuf),
    /// Looks for more files: the lock was released between two parts of the list.
    Again,
    Idle,
    Over,
}

/// Results that are not published or not saved, with the time of the last publication and save.
struct Waiting {
    unpublished: bool,
    unsaved: bool,
    published: Instant,
    saved: Instant,
}

pub(super) fn run(shared: &Shared, cache: Option<&TagCache>, wake: &dyn Fn()) {
    priority::lower(NICENESS);
    if let Some(cache) = cache {
        let kept = cache.load();
        let mut state = shared.lock();
        for (file, stamp, tags) in kept {
            state.insert(&file, stamp, Arc::new(tags), false);
        }
    }
    let begun = Instant::now();
    let mut waiting = Waiting { unpublished: false, unsaved: false, published: begun, saved: begun };
    loop {
        let next = shared.next();
        match &next {
            Next::File(file) => {
                waiting.unsaved |= shared.examine(file);
                waiting.unpublished = true;
            }
            Next::Again | Next::Idle | Next::Over => {}
        }
        let is_idle = matches!(next, Next::Idle);
        let publishes = is_idle || waiting.published.elapsed() >= PUBLISH_EVERY;
        if waiting.unpublished && publishes || is_idle && shared.lock().has_new_list() {
            shared.publish();
            wake();
            (waiting.unpublished, waiting.published) = (false, Instant::now());
        }
        let saves = !matches!(next, Next::File(_) | Next::Again) || waiting.saved.elapsed() >= SAVE_EVERY;
        if waiting.unsaved && saves {
            if let Some(cache) = cache {
                shared.save(cache);
            }
            (waiting.unsaved, waiting.saved) = (false, Instant::now());
        }
        match next {
            Next::Over => return,
            Next::Idle => shared.wait(),
            Next::File(_) | Next::Again => {}
        }
    }
}

impl State {
    /// Returns the next file to read.
    pub(super) fn next(&mut self) -> Next {
        if self.over {
            return Next::Over;
        }
        while let Some(file) = self.urgent.pop_front() {
            if !self.is_current(&file) {
                return Next::File(file);
            }
        }
        if let Some(file) = self.folder.pop_front() {
            return Next::File(file);
        }
        let list = self.list.clone();
        for track in list.entries.iter().skip(self.list_at).take(ENTRIES_AT_ONCE) {
            self.list_at += 1;
            let whole = track.file.as_ref().filter(|_| track.start.is_none());
            if let Some(file) = whole.filter(|file| !self.is_current(file)) {
                return Next::File(file.clone());
            }
        }
        if self.list_at < list.entries.len() { Next::Again } else { Next::Idle }
    }

    fn has_work(&self) -> bool {
        self.over
            || !self.urgent.is_empty()
            || !self.folder.is_empty()
            || self.list_at < self.list.entries.len()
            || self.has_new_list()
    }

    /// True if the totals belong to an earlier list.
    fn has_new_list(&self) -> bool {
        self.totals_of != Some(self.list.revision)
    }
}

impl Shared {
    fn next(&self) -> Next {
        self.lock().next()
    }

    fn wait(&self) {
        let state = self.changed.wait_while(self.lock(), |state| !state.has_work());
        drop(state.unwrap_or_else(PoisonError::into_inner));
    }

    /// Examines a file, and reads it unless it is unchanged. Returns true if the cache file must change.
    fn examine(&self, file: &Path) -> bool {
        let stamp = stamp_of(file);
        let mut state = self.lock();
        let uses = state.uses + 1;
        if let Some(known) = state.known.get_mut(&*key(file)).filter(|known| Some(known.stamp) == stamp) {
            (known.is_current, known.used) = (true, uses);
            state.uses = uses;
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
        self.lock().insert(file, stamp.unwrap_or_default(), Arc::new(tags), true);
        stamp.is_some()
    }

    /// Computes the totals of the list and makes all results visible.
    fn publish(&self) {
        let list = self.lock().list.clone();
        let mut totals = Totals::default();
        for part in list.entries.chunks(ENTRIES_AT_ONCE) {
            let state = self.lock();
            for track in part {
                let whole = track.file.as_deref().filter(|_| track.start.is_none());
                let known = whole.and_then(|file| state.current(file));
                match merged(track, known.map(|known| &*known.tags)).duration {
                    Some(seconds) => totals.seconds += seconds,
                    None => totals.unknown += 1,
                }
            }
        }
        let mut state = self.lock();
        (state.totals, state.totals_of) = (totals, Some(list.revision));
        state.revision += 1;
    }

    fn save(&self, cache: &TagCache) {
        let mut known: Vec<(Arc<Path>, Known)> =
            self.lock().known.iter().map(|(file, known)| (file.clone(), known.clone())).collect();
        known.sort_by_key(|(_, known)| known.used);
        cache.save(known.iter().map(|(file, known)| (&**file, known.stamp, &*known.tags)));
    }
}

/// Returns the stamp of a regular file.
fn stamp_of(file: &Path) -> Option<Stamp> {
    let about = std::fs::metadata(file).ok().filter(std::fs::Metadata::is_file)?;
    let modified = about.modified().ok().and_then(|time| time.duration_since(UNIX_EPOCH).ok());
    let modified = modified.and_then(|time| u64::try_from(time.as_nanos()).ok()).unwrap_or_default();
    Some(Stamp { size: about.len(), modified })
}
