//! The threads of a player, and their shutdown.

use std::sync::mpsc::Sender;
use std::time::Duration;

use super::decoding::Command;
use crate::output::Supervisor;
use crate::worker::Worker;

const END_LIMIT: Duration = Duration::from_secs(1);

/// The threads that [`Player::start`](super::Player::start) starts. Dropping this value ends them, within a time limit.
pub(super) struct Threads {
    pub(super) commands: Sender<Command>,
    /// Ends first when this value is dropped, and is `None` from then on.
    pub(super) supervisor: Option<Supervisor>,
    pub(super) decoding: Worker,
    pub(super) analysis: Worker,
    /// This thread ends when the decoding thread ends.
    pub(super) list: Worker,
}

impl Threads {
    pub(super) fn send(&self, command: Command) {
        // A failed send means that the decoding thread has ended.
        let _ = self.commands.send(command);
    }
}

impl Drop for Threads {
    fn drop(&mut self) {
        self.send(Command::Quit);
        self.supervisor = None;
        let decoded = self.decoding.join_within(END_LIMIT) && self.analysis.join_within(END_LIMIT);
        if !decoded || !self.list.join_within(END_LIMIT) {
            tracing::warn!("the song's decoder does not stop and is abandoned");
        }
    }
}
