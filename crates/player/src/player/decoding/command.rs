//! What the decoding thread is asked for.

use std::path::PathBuf;
use std::time::Instant;

use crate::listed::{Edit, Edited};
use crate::output::OutputCallbackLink;
use crate::track::{Found, Repeat};

/// What the window, the supervisor and the list thread ask for or deliver.
pub(crate) enum Command {
    /// Play on this output from `at` on.
    Output {
        /// The output.
        link: OutputCallbackLink,
        /// When it came.
        at: Instant,
    },
    /// Go to a time of the track, in seconds.
    SeekTo(f64),
    /// Go forward or back by seconds.
    SeekBy(f64),
    /// Go to the next track, or back.
    Skip {
        /// Whether it is the next.
        forward: bool,
    },
    /// Play these files instead of the list.
    Files(Vec<PathBuf>),
    /// Play the track at this index of the list.
    PlayEntry(usize),
    /// Change the list.
    Edit(Edit),
    /// What a change of the list means for what plays.
    Edited(Edited),
    /// Change the order and the repeating of tracks.
    Order(Repeat, bool),
    /// The list thread's answer to request `id`.
    Found {
        /// The request.
        id: u64,
        /// The answer.
        found: Found,
    },
    /// End the thread.
    Quit,
}
