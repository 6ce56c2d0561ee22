//! Sends the shown frames to other programs.

use std::time::Instant;

use super::Playback;
use crate::export::print::print_message;
use crate::session::SessionError;
use crate::session::screen::Screen;

impl Playback {
    /// Sends due frames. Returns when to call again, if no event comes first.
    pub(super) fn send(
        &mut self,
        screen: &mut dyn Screen,
        now: Instant,
    ) -> Result<Option<Instant>, SessionError> {
        for sentence in self.frame_senders.news() {
            print_message(&sentence);
            self.reports.announce(sentence);
        }
        if self.pace.shown.is_none() {
            return Ok(None);
        }
        Ok(self.frame_senders.send_due(screen.gl(), &mut self.renderer, now)?)
    }
}
