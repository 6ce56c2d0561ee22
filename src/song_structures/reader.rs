//! Analyses whole songs during a show, on a thread of low priority: first the current track, then the next track. The
//! thread abandons a track that is no longer wanted at once.

use std::collections::VecDeque;
use std::io;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use super::{StructureCache, find};
use mariana_music::SongStructure;
use mariana_player::track::TrackInfo;

/// Maximum number of structures of earlier tracks in memory.
const KNOWN_MAX: usize = 16;

/// Niceness of the thread after the first song: the lowest priority.
const NICENESS: i32 = 19;
/// Niceness for the first song, which already plays. Next to a software renderer, a higher niceness would starve it.
const FIRST_NICENESS: i32 = 5;

/// The analysis thread. Dropping this value ends the thread.
#[derive(Debug)]
pub struct SongReader {
    shared: Arc<Shared>,
}

#[derive(Debug, Default)]
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    /// Wanted tracks, the most urgent first.
    wanted: Vec<Arc<TrackInfo>>,
    /// Structures by track id, the newest last; `None` for a track that cannot be decoded.
    known: VecDeque<(u64, Option<Arc<SongStructure>>)>,
    over: bool,
}

impl State {
    fn find(&self, track: u64) -> Option<&Option<Arc<SongStructure>>> {
        self.known.iter().find(|(known, _)| *known == track).map(|(_, structure)| structure)
    }

    fn next(&self) -> Option<&Arc<TrackInfo>> {
        self.wanted.iter().find(|track| self.find(track.id).is_none())
    }
}

impl SongReader {
    /// Starts the thread, which waits for tracks. It calls `wake` after each analysed track.
    ///
    /// # Errors
    /// Fails if the system cannot start a thread.
    pub fn start(cache: StructureCache, wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let of_thread = shared.clone();
        std::thread::Builder::new().name("songs".into()).spawn(move || {
            lower_priority(FIRST_NICENESS);
            while let Some(track) = of_thread.next() {
                let begun = Instant::now();
                let go_on = || of_thread.wants_most(&track);
                let reopen = &track.reopen;
                if let Some(found) = find(reopen.content(), || reopen.open(), &cache, &go_on) {
                    let known = if found.is_some() { "is known" } else { "is not known" };
                    tracing::info!("the song {} {known} after {:.0?}", track.name, begun.elapsed());
                    of_thread.tell(track.id, found);
                    wake();
                    lower_priority(NICENESS);
                }
            }
        })?;
        Ok(Self { shared })
    }

    /// Replaces the list of wanted tracks, the most urgent first.
    pub fn want<'a>(&self, tracks: impl IntoIterator<Item = &'a Arc<TrackInfo>>) {
        let mut state = self.shared.lock();
        state.wanted.clear();
        for track in tracks {
            if track.reopen.is_possible() {
                state.wanted.push(track.clone());
            } else {
                // Silence has replaced a removed track under the same id: forget the structure of that track.
                state.known.retain(|(known, _)| *known != track.id);
            }
        }
        if state.next().is_some() {
            self.shared.changed.notify_one();
        }
    }

    /// Returns the structure of the track with this id ([`TrackInfo::id`]), once it is known.
    pub fn get(&self, track: u64) -> Option<Arc<SongStructure>> {
        self.shared.lock().find(track).cloned().flatten()
    }
}

impl Drop for SongReader {
    fn drop(&mut self) {
        self.shared.lock().over = true;
        self.shared.changed.notify_one();
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a track to analyse; `None` at the end.
    fn next(&self) -> Option<Arc<TrackInfo>> {
        let nothing_to_do = |state: &mut State| !state.over && state.next().is_none();
        let state = self.changed.wait_while(self.lock(), nothing_to_do);
        let state = state.unwrap_or_else(PoisonError::into_inner);
        if state.over { None } else { state.next().cloned() }
    }

    fn wants_most(&self, track: &TrackInfo) -> bool {
        let state = self.lock();
        !state.over && state.next().is_some_and(|next| next.id == track.id)
    }

    fn tell(&self, track: u64, structure: Option<SongStructure>) {
        let structure = structure.map(Arc::new);
        let mut state = self.lock();
        if state.known.len() == KNOWN_MAX {
            state.known.pop_front();
        }
        state.known.push_back((track, structure));
    }
}

#[cfg(target_os = "linux")]
fn lower_priority(niceness: i32) {
    if let Err(error) = rustix::process::setpriority_process(None, niceness) {
        tracing::debug!("the priority of the thread for songs cannot be changed: {error}");
    }
}

#[cfg(not(target_os = "linux"))]
fn lower_priority(_: i32) {}
