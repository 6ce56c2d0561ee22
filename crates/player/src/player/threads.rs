//! The threads of a player, and how they end.

use std::sync::mpsc::Sender;
use std::time::Duration;

use super::decoding::Command;
use crate::output::Supervisor;
use crate::worker::Worker;

/// How long to wait for the end of each thread.
const END_LIMIT: Duration = Duration::from_secs(1);

/// The threads that [`Player::start`](super::Player::start) starts. Dropping them ends them, within a limit.
pub(super) struct Threads {
    pub(super) commands: Sender<Command>,
    /// Taken when dropped.
    pub(super) supervisor: Option<Supervisor>,
    pub(super) decoding: Worker,
    pub(super) analysis: Worker,
    /// Ends when the decoding does.
    pub(super) list: Worker,
}

impl Threads {
    pub(super) fn send(&self, command: Command) {
        // If the decoding thread has ended there is nothing to seek in.
        let _ = self.commands.send(command);
    }
}

impl Drop for Threads {
    fn drop(&mut self) {
        self.send(Command::Quit);
        self.supervisor = None;
        let decoded = self.decoding.join_within(END_LIMIT) && self.analysis.join_within(END_LIMIT);
        if !decoded || !self.list.join_within(END_LIMIT) {
            tracing::warn!("the decoding of the song does not end and is abandoned");
        }
    }
}
