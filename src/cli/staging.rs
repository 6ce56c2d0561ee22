//! Flags of how pictures come onto screens. They hold for a run; what was chosen in the window holds otherwise.

use clap::Args;

use super::choices::choice;
use super::common::refuse_a_terminal;
use super::parse::{parse_corners, parse_crop, parse_fade, parse_fps, parse_percent, parse_size};
use crate::config::{PlaySettings, StageChoices};
use crate::export::output::Output;
use crate::limits::LIMITS;
use crate::placement::{Corners, Crop, Flip};
use crate::sending::SendWish;

#[derive(Args)]
pub(super) struct StagingArguments {
    /// How much of its light the picture has in the window, in percent [default: what was chosen there, at first 100]
    #[arg(long, value_name = "PERCENT", value_parser = parse_percent, allow_negative_numbers = true)]
    brightness: Option<u8>,
    /// How many seconds a blackout (X) takes to come and to go, and a picture that was held (Z) to give way [default:
    /// what was chosen in the window, at first 0.5]
    #[arg(long, value_name = "SECONDS", value_parser = parse_fade, allow_negative_numbers = true)]
    blackout_fade: Option<f64>,
    /// Mirror the picture in the window, for projectors [default: what was chosen there, at first off]
    #[arg(long, value_name = "WAY", value_parser = choice::<Flip>())]
    flip: Option<Flip>,
    /// What the picture in the window loses at its edges, in percent; what is left fills the window, unstretched
    /// [default: what was chosen last, at first 0,0,0,0]
    #[arg(long, value_name = "LEFT,TOP,RIGHT,BOTTOM", value_parser = parse_crop, allow_hyphen_values = true)]
    crop: Option<Crop>,
    /// Where the picture's corners lie in the window, in percent to the right and down, clockwise from the upper left:
    /// for a projector that stands aslant. 'off' is the window's own corners [default: where Y has put them]
    #[arg(long, value_name = "X,Y,X,Y,X,Y,X,Y", value_parser = parse_corners, allow_hyphen_values = true)]
    corners: Option<Corners>,
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
    send: Vec<SendWish>,
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
        if self.send.contains(&SendWish::Y4m(None)) {
            refuse_a_terminal(&Output::Standard, "mariana --send y4m:- | mpv -")?;
        }
        settings.wallpaper = self.wallpaper;
        (settings.sends, settings.send_size) = (self.send.clone(), self.send_size);
        settings.send_fps = self.send_fps;
        Ok(())
    }

    /// What holds in this run.
    pub(super) fn over(&self, remembered: &StageChoices) -> StageChoices {
        StageChoices {
            brightness: self.brightness.unwrap_or(remembered.brightness),
            blackout_fade: self.blackout_fade.unwrap_or(remembered.blackout_fade),
            flip: self.flip.unwrap_or(remembered.flip),
            crop: self.crop.unwrap_or(remembered.crop),
            corners: self.corners.unwrap_or(remembered.corners),
            output: match self.output.as_deref() {
                Some("off") => None,
                Some(name) => Some(name.to_owned()),
                None => remembered.output.clone(),
            },
        }
    }
}
