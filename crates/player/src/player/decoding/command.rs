//! Commands to the decoding thread.

use std::path::PathBuf;
use std::time::Instant;

use crate::listed::{Edit, Edited};
use crate::output::OutputCallbackLink;
use crate::track::{Found, Repeat};

pub(crate) enum Command {
    /// Plays on this output from the moment `at` on.
    Output {
        link: OutputCallbackLink,
        at: Instant,
    },
    /// Seeks to a time of the track, in seconds.
    SeekTo(f64),
    /// Seeks by seconds, forward or back.
    SeekBy(f64),
    Skip {
        forward: bool,
    },
    Files(Vec<PathBuf>),
    PlayEntry(usize),
    Edit(Edit),
    Edited(Edited),
    Order(Repeat, bool),
    Found {
        id: u64,
        found: Found,
    },
    /// Answers when the thread begins to wait, because its ring is full or the song has ended.
    #[cfg(test)]
    AnswerWhenIdle(std::sync::mpsc::Sender<()>),
    Quit,
}
