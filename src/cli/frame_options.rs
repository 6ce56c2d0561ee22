//! Flags for outputs besides the window: a monitor, the desktop's wallpaper, other programs.

use clap::Args;

use super::common::refuse_a_terminal;
use super::parse::{parse_fps, parse_size};
use crate::export::output::Output;
use crate::limits;
use crate::sending::SenderTarget;

#[derive(Args)]
pub(super) struct StagingArguments {
    /// Show the image without panels on a whole monitor, given by name or number, in addition to the window; 'list'
    /// lists the monitors, 'off' uses none [default: the last choice in the window]
    #[arg(long, value_name = "MONITOR")]
    pub(crate) output: Option<String>,
    /// Be the desktop's wallpaper, on X11 or on Wayland with layer shell: below all windows, on all monitors, without
    /// input; at most 30 frames a second unless --fps-cap is given. Pauses drawing while covered and on battery. Media
    /// keys pause the song
    #[arg(long, conflicts_with_all = ["output", "fullscreen", "size"])]
    pub(super) wallpaper: bool,
    /// Send the frames to another program: y4m:FIFO, y4m:- (standard output), mjpeg:PORT (HTTP on this machine, for OBS
    /// or a browser) or v4l2:/dev/videoN (a camera by v4l2loopback); can be given more than once
    #[arg(long, value_name = "TO")]
    pub(super) send: Vec<SenderTarget>,
    /// Size of the frames that are sent [default: the window's size at the start]
    #[arg(long, value_name = "WxH", value_parser = parse_size, allow_hyphen_values = true, requires = "send")]
    pub(super) send_size: Option<(u32, u32)>,
    /// Frames sent per second
    #[arg(long, value_name = "FPS", value_parser = parse_fps, default_value = "30", allow_negative_numbers = true, requires = "send")]
    pub(super) send_fps: f64,
}

impl StagingArguments {
    /// Checks the targets.
    ///
    /// # Errors
    /// Fails if there are too many targets, or if a target is a terminal.
    pub(super) fn check(&self) -> anyhow::Result<()> {
        anyhow::ensure!(
            self.send.len() <= limits::SENDS_MAX,
            "frames can be sent to at most {} targets, not {}: leave out some --send flags",
            limits::SENDS_MAX,
            self.send.len()
        );
        if self.send.contains(&SenderTarget::Y4m(None)) {
            refuse_a_terminal(&Output::Standard, "mariana --send y4m:- | mpv -")?;
        }
        Ok(())
    }

    pub(super) fn output(&self, remembered: Option<String>) -> Option<String> {
        match self.output.as_deref() {
            Some("off") => None,
            Some(name) => Some(name.to_owned()),
            None => remembered,
        }
    }
}
