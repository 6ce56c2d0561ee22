//! The settings of a run: what the command line chooses, with the defaults, and what is remembered from run to run.

mod last_show;
mod settings;

pub use last_show::LastShow;
pub use settings::{Settings, SettingsError, SettingsFile};

use std::collections::BTreeMap;

use crate::program_cache::ProgramCache;
use mariana_music::Gain;

/// How a scene's expressions are run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SdfChoice {
    /// From the tape, by the interpreter shader.
    Interpreted,
    /// As GLSL that the driver compiles.
    Compiled,
    /// Interpreted at once, compiled as soon as the driver is ready.
    #[default]
    Auto,
}

/// How much a picture in the window may cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum QualityChoice {
    /// As much as the frame rate allows.
    #[default]
    Auto,
    /// About half of the window's width and height, without costly terms.
    Low,
    /// Between the two.
    Medium,
    /// Hardly less than the best.
    High,
    /// Every pixel and every term, as in stills and videos.
    Best,
}

/// What to listen to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ListenChoice {
    /// A microphone or another input.
    Microphone,
    /// What the computer plays.
    System,
}

/// How the window plays and shows a song, or what it listens to.
#[derive(Debug, Clone)]
pub struct PlaySettings {
    /// Output device, or input device to listen to, by id, name or part of a name; none is the default.
    pub device: Option<String>,
    /// No sound: the song runs on the silent clock.
    pub silent: bool,
    /// End after the song instead of looping it.
    pub once: bool,
    /// Volume at the start, 0..1.
    pub volume: f32,
    /// The sound is heard this much later than the device says, in seconds; none uses what is remembered for the
    /// device.
    pub latency: Option<f64>,
    /// Whether quiet and loud sound move the picture alike.
    pub gain: Gain,
    /// Listen to this instead of playing a song.
    pub listen: Option<ListenChoice>,
    /// Most frames per second; none is the monitor's rate.
    pub fps_cap: Option<f64>,
    /// How much a picture may cost.
    pub quality: QualityChoice,
    /// Whether more than three flashes a second are dimmed.
    pub limit_flashes: bool,
    /// How long one scene fades into another, in seconds; 0 is a cut.
    pub fade: f64,
    /// Whether the next and the previous scene are prepared while one is shown.
    pub prepare_ahead: bool,
    /// Where programs are kept from run to run.
    pub program_cache: ProgramCache,
    /// Start in full screen.
    pub fullscreen: bool,
    /// Where in the first track to begin, in seconds.
    pub begin_at: f64,
    /// The sliders of the scene at the start that were moved, by name.
    pub sliders: BTreeMap<String, f32>,
    /// Whether the next show goes on where this one ends.
    pub remembered: bool,
    /// Show nothing over the picture but what was asked for and what is wrong.
    pub clean: bool,
    /// Size of the window in pixels at the start.
    pub size: (u32, u32),
    /// Print the OpenGL version and driver, and end.
    pub gl_info: bool,
}
