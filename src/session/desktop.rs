//! Media keys and the desktop's controls for players, as a session sees them.

use crate::commands::Command;
use mariana_player::PlayerStatus;

/// See the module.
pub(crate) trait DesktopControls {
    /// Returns the next command that the desktop has sent, if any.
    fn poll(&self) -> Option<Command>;

    /// Reports the state of playback to the desktop. A song that has not `started` waits for the first picture.
    fn show(&self, status: &PlayerStatus, started: bool, fullscreen: bool);
}
