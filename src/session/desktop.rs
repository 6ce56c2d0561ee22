//! The interface of a session to media keys and the desktop's media controls.

use crate::commands::Command;
use mariana_player::PlayerStatus;

pub(crate) trait DesktopControls {
    /// Returns the next command from the desktop, if any.
    fn poll(&self) -> Option<Command>;

    /// Reports the state of playback to the desktop. A song that has not `started` waits for the first frame.
    fn show(&self, status: &PlayerStatus, started: bool, fullscreen: bool);
}

/// No desktop.
pub(super) struct NoDesktop;

impl DesktopControls for NoDesktop {
    fn poll(&self) -> Option<Command> {
        None
    }

    fn show(&self, _: &PlayerStatus, _: bool, _: bool) {}
}
