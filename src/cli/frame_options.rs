//! Flags of where pictures go: to which monitor, behind the windows of the desktop, to other programs.

use clap::Args;

use super::common::refuse_a_terminal;
use super::parse::{parse_fps, parse_size};
use crate::config::PlaySettings;
use crate::export::output::Output;
use crate::limits::LIMITS;
use crate::sending::SenderTarget;

#[derive(Args)]
pub(super) struct StagingArguments {
    /// Fill a monitor with the clean picture, by its name or number, while the window stays beside it; 'list' tells which
    /// there are, 'off' fills none [default: what was chosen in the window]
    #[arg(long, value_name = "MONITOR")]
    output: Option<String>,
    /// Be the desktop's ground, on X11 or on Wayland with layer shell: below every window, on every monitor, for the eyes
    /// alone; at most 30 frames a second unless --fps-cap says otherwise. It rests while nobody sees it, and on battery.
    /// Media keys pause the song
    #[arg(long, conflicts_with_all = ["output", "fullscreen", "size"])]
    wallpaper: bool,
    /// Send the picture to another program: y4m:FIFO, y4m:- (standard output), mjpeg:PORT (HTTP on this machine, for OBS
    /// or a browser) or v4l2:/dev/videoN (a camera by v4l2loopback); can be given more than once
    #[arg(long, value_name = "TO")]
    send: Vec<SenderTarget>,
    /// Size of the pictures that are sent [default: the window's at the start]
    #[arg(long, value_name = "WxH", value_parser = parse_size, allow_hyphen_values = true, requires = "send")]
    send_size: Option<(u32, u32)>,
    /// How many pictures are sent in a second
    #[arg(long, value_name = "FPS", value_parser = parse_fps, default_value = "30", allow_negative_numbers = true, requires = "send")]
    send_fps: f64,
}

impl StagingArguments {
    /// Whether the monitors are to be listed.
    pub(super) fn lists_monitors(&self) -> bool {
        self.output.as_deref() == Some("list")
    }

    /// Notes in `settings` where pictures go.
    ///
    /// # Errors
    /// More places than there may be, or a terminal.
    pub(super) fn tell(&self, settings: &mut PlaySettings) -> anyhow::Result<()> {
        anyhow::ensure!(
            self.send.len() <= LIMITS.sends_max,
            "pictures can be sent to at most {} places, not {}: give fewer",
            LIMITS.sends_max,
            self.send.len()
        );
        if self.send.contains(&SenderTarget::Y4m(None)) {
            refuse_a_terminal(&Output::Standard, "mariana --send y4m:- | mpv -")?;
        }
        settings.wallpaper = self.wallpaper;
        (settings.sends, settings.send_size) = (self.send.clone(), self.send_size);
        settings.send_fps = self.send_fps;
        Ok(())
    }

    /// The output of a run, if that of the last one was `remembered`.
    pub(super) fn output(&self, remembered: Option<String>) -> Option<String> {
        match self.output.as_deref() {
            Some("off") => None,
            Some(name) => Some(name.to_owned()),
            None => remembered,
        }
    }
}
