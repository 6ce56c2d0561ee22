//! Commands to the decoding thread.

use std::path::PathBuf;
use std::time::Instant;

use crate::listed::{Edit, Edited};
use crate::output::OutputCallbackLink;
use crate::track::{Found, Repeat};

/// A command from the window, the supervisor or the list thread.
pub(crate) enum Command {
    /// Plays on this output from `at` on.
    Output {
        /// The output.
        link: OutputCallbackLink,
        /// The time at which it opened.
        at: Instant,
    },
    /// Seeks to a time of the track, in seconds.
    SeekTo(f64),
    /// Seeks by seconds, forward or back.
    SeekBy(f64),
    /// Skips to the next or the previous track.
    Skip {
        /// True for the next track.
        forward: bool,
    },
    /// Replaces the list by these files.
    Files(Vec<PathBuf>),
    /// Plays the track at this index of the list.
    PlayEntry(usize),
    /// Edits the list.
    Edit(Edit),
    /// The result of an edit.
    Edited(Edited),
    /// Changes the repeat mode and the order.
    Order(Repeat, bool),
    /// The list thread's answer to request `id`.
    Found {
        /// The request's id.
        id: u64,
        /// The answer.
        found: Found,
    },
    /// Ends the thread.
    Quit,
}
