//! What the pointer asks for in the panels.

use crate::app::keys::Action;

/// A panel that opens from the bar; one at a time is open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Panel {
    /// The list of tracks.
    Tracks,
    /// What can be listened to.
    Sources,
}

/// What the user asked for with the pointer.
#[derive(Debug, Clone, PartialEq)]
pub enum Request {
    /// What a key does, too.
    Act(Action),
    /// To go to this time of the track, in seconds.
    SeekTo(f64),
    /// This volume, 0..1.
    SetVolume(f32),
    /// Something with the list of tracks.
    Tracks(TrackRequest),
    /// To listen to the source at this place of the list that is shown.
    Listen(usize),
}

/// What is asked of the list of tracks; entries are counted from 0 in the list's own order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrackRequest {
    /// To play an entry.
    Play(usize),
    /// To take an entry out.
    Remove(usize),
    /// To move an entry.
    Move {
        /// Where it is.
        from: usize,
        /// Where it will be.
        to: usize,
    },
}
