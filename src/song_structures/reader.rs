//! Reads whole songs during a show, on a thread of low priority: first the current track, then the next track. The
//! thread abandons a track that is no longer wanted at once.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Instant;

use super::{ReadSong, find, lyrics_of};
use crate::cached_files::CachedFiles;
use mariana_player::track::TrackInfo;
use mariana_player::{LoudnessShape, lower_priority};
use mariana_work::{Latest, Shared, contained, latest};

/// Maximum number of results for earlier tracks in memory.
const KNOWN_MAX: usize = 16;

/// Niceness of the thread after the first song: the lowest priority.
const NICENESS: i32 = 19;
/// Niceness for the first song, which already plays. Next to a software renderer, a higher niceness would starve it.
const FIRST_NICENESS: i32 = 5;

/// The thread that reads songs and finds a `T` for each track. Dropping this value ends the thread.
#[derive(Debug)]
pub struct SongReader<T = ReadSong> {
    /// `None` if the thread could not start: then nothing is known.
    shared: Option<Latest<Reading<T>>>,
}

#[derive(Debug)]
struct Reading<T> {
    /// Wanted tracks, the most urgent first.
    wanted: Vec<Arc<TrackInfo>>,
    /// Results by track id, the newest last; `None` for a track that cannot be decoded.
    known: VecDeque<(u64, Option<Arc<T>>)>,
    /// The beginning of the result for a track, while the rest is being found.
    begun: Option<(u64, Arc<T>)>,
}

impl<T> Reading<T> {
    fn find(&self, track: u64) -> Option<&Option<Arc<T>>> {
        self.known.iter().find(|(known, _)| *known == track).map(|(_, found)| found)
    }

    fn next(&self) -> Option<&Arc<TrackInfo>> {
        self.wanted.iter().find(|track| self.find(track.id).is_none())
    }

    /// Stores a result, and keeps at most `known_max`.
    fn publish(&mut self, track: u64, found: Option<T>, known_max: usize) {
        self.begun = None;
        if self.known.len() == known_max {
            self.known.pop_front();
        }
        self.known.push_back((track, found.map(Arc::new)));
    }
}

impl SongReader {
    /// Starts a thread that analyses tracks and reads their lyrics. It calls `wake` after each track.
    pub fn start(cache: CachedFiles, wake: impl Fn() + Send + 'static) -> Self {
        let read = move |track: &TrackInfo, go_on: &(dyn Fn() -> bool + Sync), _: &dyn Fn(_)| {
            let Some(content) = &track.content else { return Some(None) };
            let structure = find(content, &cache, go_on)?;
            // The times of lyrics are those of the whole file.
            let whole = Some(content).filter(|content| content.cut.is_none());
            let lyrics = Arc::new(whole.map(|content| lyrics_of(&content.song)).unwrap_or_default());
            Some(structure.map(|structure| ReadSong { structure: Arc::new(structure), lyrics }))
        };
        Self::of("songs", "analyse whole songs", KNOWN_MAX, read, wake)
    }
}

impl SongReader<LoudnessShape> {
    /// Starts a thread of the lowest priority that measures the loudness of tracks. It calls `wake` after each track.
    pub fn of_loudness(wake: impl Fn() + Send + 'static) -> Self {
        let measure = |track: &TrackInfo, go_on: &(dyn Fn() -> bool + Sync), publish: &dyn Fn(_)| {
            lower_priority(NICENESS);
            let Some(content) = &track.content else { return Some(None) };
            let mut source = match content.open() {
                Ok(source) => source,
                // The player reports it.
                Err(error) => {
                    tracing::debug!("no loudness: {error}");
                    return Some(None);
                }
            };
            LoudnessShape::measure(&mut *source, go_on, publish)
        };
        Self::of("loudness", "measure the loudness of songs", KNOWN_MAX, measure, wake)
    }
}

impl<T: Send + Sync + 'static> SongReader<T> {
    /// Starts a thread called `name` that finds something for each track and keeps up to `known_max` results. `find`
    /// returns `None` as soon as its second argument returns false, and `Some(None)` for a track without a result. It
    /// may pass the beginning of a result to its third argument. The thread calls `wake` after each track. If the system
    /// cannot start a thread, a warning says that Mariana cannot do what `doing` says.
    pub fn of(
        name: &'static str,
        doing: &str,
        known_max: usize,
        find: impl Fn(&TrackInfo, &(dyn Fn() -> bool + Sync), &dyn Fn(T)) -> Option<Option<T>> + Send + 'static,
        wake: impl Fn() + Send + 'static,
    ) -> Self {
        let state = Reading { wanted: Vec::new(), known: VecDeque::new(), begun: None };
        let mut niceness = FIRST_NICENESS;
        let work = move |track: Arc<TrackInfo>, shared: &Shared<Reading<T>>| {
            lower_priority(niceness);
            let begun = Instant::now();
            let is_next = |next: &Arc<TrackInfo>| next.id == track.id;
            let go_on = || !shared.is_over() && shared.lock().next().is_some_and(is_next);
            let publish = |begun| shared.lock().begun = Some((track.id, Arc::new(begun)));
            // After a panic the thread must not try the track again.
            if let Some(found) = contained(|| find(&track, &go_on, &publish)).unwrap_or(Some(None)) {
                let known = if found.is_some() { "known" } else { "not known" };
                tracing::info!("{name}: {} is {known} after {:.0?}", track.name, begun.elapsed());
                shared.lock().publish(track.id, found, known_max);
                wake();
                niceness = NICENESS;
            }
        };
        let shared = latest(name, state, |state| state.next().cloned(), work);
        Self { shared: shared.inspect_err(|error| tracing::warn!("cannot {doing}: {error}")).ok() }
    }

    /// Replaces the list of wanted tracks, the most urgent first.
    pub fn request<'a>(&self, tracks: impl IntoIterator<Item = &'a Arc<TrackInfo>>) {
        let Some(shared) = &self.shared else { return };
        let mut state = shared.lock();
        state.wanted.clear();
        for track in tracks {
            if track.content.is_some() {
                state.wanted.push(track.clone());
            } else {
                // Silence has replaced a removed track under the same id: forget the result of that track.
                state.known.retain(|(known, _)| *known != track.id);
            }
        }
        if state.next().is_some() {
            drop(state);
            shared.change(|_| ());
        }
    }

    /// Returns the result of the track with this id ([`TrackInfo::id`]), or its beginning, once it is known.
    pub fn get(&self, track: u64) -> Option<Arc<T>> {
        let state = self.shared.as_ref()?.lock();
        let begun = || state.begun.as_ref().filter(|(of, _)| *of == track).map(|(_, begun)| begun.clone());
        state.find(track).cloned().unwrap_or_else(begun)
    }
}
