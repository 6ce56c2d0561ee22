//! The list thread finds and opens tracks while other tracks play, so that neither a slow disk nor a list of missing
//! files delays the sound.

use std::sync::mpsc::{Receiver, Sender};
use std::sync::{Arc, Mutex};

use super::decoding::Command;
use crate::listed::Edit;
use crate::track::{Repeat, TrackList, Wanted};
use mariana_work::lock;

pub(crate) enum Request {
    /// Finds a track. The answer contains `id`.
    Find { id: u64, wanted: Wanted },
    /// Changes the repeat mode and the order. A new random order begins with the entry whose id is `current`.
    Order { repeat: Repeat, shuffled: bool, current: u64 },
    /// Edits the list while the entry with id `playing` plays.
    Edit { edit: Edit, playing: u64 },
}

pub(crate) fn run(
    mut list: Box<dyn TrackList>,
    inbox: &Receiver<Request>,
    answers: &Sender<Command>,
    track_errors: &SharedTrackErrors,
) {
    for request in inbox {
        match request {
            Request::Order { repeat, shuffled, current } => list.set_order(repeat, shuffled, current),
            // A failed send means that the decoding thread has ended.
            Request::Find { id, wanted } => {
                let found = list.find(&wanted, &mut |trouble| track_errors.report(trouble));
                let _ = answers.send(Command::Found { id, found });
            }
            Request::Edit { edit, playing } => {
                let edited = list.edit(&edit, playing, &mut |trouble| track_errors.report(trouble));
                let _ = answers.send(Command::Edited(edited));
            }
        }
    }
}

/// Errors of tracks, for the window to report.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct TrackErrors {
    /// The number of errors.
    pub count: u64,
    /// The message of the last error.
    pub last: Option<String>,
}

#[derive(Clone, Default)]
pub(crate) struct SharedTrackErrors(Arc<Mutex<TrackErrors>>);

impl SharedTrackErrors {
    pub(crate) fn report(&self, trouble: String) {
        tracing::debug!("{trouble}");
        let mut track_errors = lock(&self.0);
        track_errors.count += 1;
        track_errors.last = Some(trouble);
    }

    pub(crate) fn get(&self) -> TrackErrors {
        lock(&self.0).clone()
    }
}
