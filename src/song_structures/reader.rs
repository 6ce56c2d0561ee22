//! Reads whole songs during a show, on a thread of low priority: first the current track, then the next track. The
//! thread abandons a track that is no longer wanted at once.

use std::collections::VecDeque;
use std::io;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use super::{ReadSong, StructureCache, find, lyrics_of};
use mariana_player::lower_priority;
use mariana_player::track::TrackInfo;

/// Maximum number of structures of earlier tracks in memory.
const KNOWN_MAX: usize = 16;

/// Niceness of the thread after the first song: the lowest priority.
const NICENESS: i32 = 19;
/// Niceness for the first song, which already plays. Next to a software renderer, a higher niceness would starve it.
const FIRST_NICENESS: i32 = 5;

/// The thread that reads songs and finds a `T` for each track. Dropping this value ends the thread.
#[derive(Debug)]
pub struct SongReader<T = ReadSong> {
    shared: Arc<Shared<T>>,
}

#[derive(Debug)]
struct Shared<T> {
    state: Mutex<State<T>>,
    changed: Condvar,
    /// Maximum number of results in memory.
    known_max: usize,
}

#[derive(Debug)]
struct State<T> {
    /// Wanted tracks, the most urgent first.
    wanted: Vec<Arc<TrackInfo>>,
    /// Results by track id, the newest last; `None` for a track that cannot be decoded.
    known: VecDeque<(u64, Option<Arc<T>>)>,
    /// The beginning of the result for a track, while the rest is being found.
    begun: Option<(u64, Arc<T>)>,
    over: bool,
}

impl<T> State<T> {
    fn find(&self, track: u64) -> Option<&Option<Arc<T>>> {
        self.known.iter().find(|(known, _)| *known == track).map(|(_, found)| found)
    }

    fn next(&self) -> Option<&Arc<TrackInfo>> {
        self.wanted.iter().find(|track| self.find(track.id).is_none())
    }
}

impl SongReader {
    /// Starts a thread that analyses tracks and reads their lyrics. It calls `wake` after each track.
    ///
    /// # Errors
    /// Fails if the system cannot start a thread.
    pub fn start(cache: StructureCache, wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        let read = move |track: &TrackInfo, go_on: &(dyn Fn() -> bool + Sync), _: &dyn Fn(_)| {
            let reopen = &track.reopen;
            let structure = find(reopen.content(), || reopen.open(), &cache, go_on)?;
            // The times of lyrics are those of the whole file.
            let whole = reopen.content().filter(|content| content.cut.is_none());
            let lyrics = Arc::new(whole.map(|content| lyrics_of(&content.song)).unwrap_or_default());
            Some(structure.map(|structure| ReadSong { structure: Arc::new(structure), lyrics }))
        };
        Self::of("songs", KNOWN_MAX, read, wake)
    }
}

impl<T: Send + Sync + 'static> SongReader<T> {
    /// Starts a thread called `name` that finds something for each track and keeps up to `known_max` results. `find`
    /// returns `None` as soon as its second argument returns false, and `Some(None)` for a track without a result. It
    /// may pass the beginning of a result to its third argument. The thread calls `wake` after each track.
    ///
    /// # Errors
    /// Fails if the system cannot start a thread.
    pub fn of(
        name: &'static str,
        known_max: usize,
        find: impl Fn(&TrackInfo, &(dyn Fn() -> bool + Sync), &dyn Fn(T)) -> Option<Option<T>> + Send + 'static,
        wake: impl Fn() + Send + 'static,
    ) -> io::Result<Self> {
        let state = State { wanted: Vec::new(), known: VecDeque::new(), begun: None, over: false };
        let shared = Arc::new(Shared { state: Mutex::new(state), changed: Condvar::new(), known_max });
        let of_thread = shared.clone();
        std::thread::Builder::new().name(name.into()).spawn(move || {
            lower_priority(FIRST_NICENESS);
            while let Some(track) = of_thread.next() {
                let begun = Instant::now();
                let go_on = || of_thread.wants_most(&track);
                let publish = |begun| of_thread.lock().begun = Some((track.id, Arc::new(begun)));
                if let Some(found) = find(&track, &go_on, &publish) {
                    let known = if found.is_some() { "known" } else { "not known" };
                    tracing::info!("{name}: {} is {known} after {:.0?}", track.name, begun.elapsed());
                    of_thread.publish(track.id, found);
                    wake();
                    lower_priority(NICENESS);
                }
            }
        })?;
        Ok(Self { shared })
    }

    /// Replaces the list of wanted tracks, the most urgent first.
    pub fn request<'a>(&self, tracks: impl IntoIterator<Item = &'a Arc<TrackInfo>>) {
        let mut state = self.shared.lock();
        state.wanted.clear();
        for track in tracks {
            if track.reopen.is_possible() {
                state.wanted.push(track.clone());
            } else {
                // Silence has replaced a removed track under the same id: forget the result of that track.
                state.known.retain(|(known, _)| *known != track.id);
            }
        }
        if state.next().is_some() {
            self.shared.changed.notify_one();
        }
    }

    /// Returns the result of the track with this id ([`TrackInfo::id`]), or its beginning, once it is known.
    pub fn get(&self, track: u64) -> Option<Arc<T>> {
        let state = self.shared.lock();
        let begun = || state.begun.as_ref().filter(|(of, _)| *of == track).map(|(_, begun)| begun.clone());
        state.find(track).cloned().unwrap_or_else(begun)
    }
}

impl<T> Drop for SongReader<T> {
    fn drop(&mut self) {
        self.shared.lock().over = true;
        self.shared.changed.notify_one();
    }
}

impl<T> Shared<T> {
    fn lock(&self) -> MutexGuard<'_, State<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a track to analyse; `None` at the end.
    fn next(&self) -> Option<Arc<TrackInfo>> {
        let nothing_to_do = |state: &mut State<T>| !state.over && state.next().is_none();
        let state = self.changed.wait_while(self.lock(), nothing_to_do);
        let state = state.unwrap_or_else(PoisonError::into_inner);
        if state.over { None } else { state.next().cloned() }
    }

    fn wants_most(&self, track: &TrackInfo) -> bool {
        let state = self.lock();
        !state.over && state.next().is_some_and(|next| next.id == track.id)
    }

    fn publish(&self, track: u64, found: Option<T>) {
        let mut state = self.lock();
        state.begun = None;
        if state.known.len() == self.known_max {
            state.known.pop_front();
        }
        state.known.push_back((track, found.map(Arc::new)));
    }
}
