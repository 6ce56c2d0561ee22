//! The interface of a session to media keys and the desktop's media controls.

use crate::commands::Command;
use mariana_player::PlayerStatus;

/// Media keys and media controls.
pub trait DesktopControls {
    /// Returns the next command from the desktop, if any.
    fn poll(&self) -> Option<Command>;

    /// Reports the state of playback to the desktop. A song that has not `started` waits for the first frame.
    fn show(&self, status: &PlayerStatus, started: bool, fullscreen: bool);
}
