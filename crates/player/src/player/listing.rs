//! The list thread: finds and opens tracks while others play, so that neither a slow disk nor a list of missing files
//! keeps anything waiting.

use std::sync::mpsc::{Receiver, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::decoding::Command;
use crate::listed::Edit;
use crate::track::{Repeat, TrackList, Wanted};

/// What the decoding thread asks for.
pub(crate) enum Request {
    /// Find a track; the answer carries `id`.
    Find { id: u64, wanted: Wanted },
    /// Change the order and the repeating of tracks; a new random order begins with the entry whose id is `current`.
    Order { repeat: Repeat, shuffled: bool, current: u64 },
    /// Change the list, while the entry with id `playing` plays.
    Edit { edit: Edit, playing: u64 },
}

/// Works until the decoding thread ends.
pub(crate) fn run(
    mut list: Box<dyn TrackList>,
    inbox: &Receiver<Request>,
    answers: &Sender<Command>,
    track_errors: &SharedTrackErrors,
) {
    for request in inbox {
        match request {
            Request::Order { repeat, shuffled, current } => list.set_order(repeat, shuffled, current),
            // If the decoding thread has ended, nobody waits for an answer any more.
            Request::Find { id, wanted } => {
                let found = list.find(&wanted, &mut |trouble| track_errors.tell(trouble));
                let _ = answers.send(Command::Found { id, found });
            }
            Request::Edit { edit, playing } => {
                let edited = list.edit(&edit, playing, &mut |trouble| track_errors.tell(trouble));
                let _ = answers.send(Command::Edited(edited));
            }
        }
    }
}

/// What went wrong with tracks, for the window to report.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct TrackErrors {
    /// How many there were.
    pub count: u64,
    /// The last one, as a sentence.
    pub last: Option<String>,
}

/// [`TrackErrors`] shared by threads.
#[derive(Clone, Default)]
pub(crate) struct SharedTrackErrors(Arc<Mutex<TrackErrors>>);

impl SharedTrackErrors {
    pub(crate) fn tell(&self, trouble: String) {
        tracing::debug!("{trouble}");
        let mut track_errors = self.lock();
        track_errors.count += 1;
        track_errors.last = Some(trouble);
    }

    pub(crate) fn get(&self) -> TrackErrors {
        self.lock().clone()
    }

    fn lock(&self) -> MutexGuard<'_, TrackErrors> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
