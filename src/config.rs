//! The settings of a run: what the command line chooses, with the defaults, and what is remembered from run to run.

pub use mariana_files::Folders;
pub use mariana_settings::limits::LIMITS as SETTING_LIMITS;
pub use mariana_settings::{
    Choice, Choices, DisplayChoices, FollowChoice, Kept, KeptSettings, KnobEdit, KnobMemory, KnobsError,
    LastShow, PerformanceFiles, QualityChoice, Setting, SettingRow, Settings, SettingsError, SettingsFile,
    Values, with_settings,
};

use std::collections::BTreeMap;

use crate::program_cache::ProgramCache;
use crate::sending::SenderTarget;
use crate::show::ShowSource;
use mariana_control::osc::Place;
use mariana_remote::RemotePlace;

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

/// What to listen to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ListenChoice {
    /// A microphone or another input.
    Microphone,
    /// What the computer plays.
    System,
}

/// What stands in the place of a device's name for the system's default.
pub const DEFAULT_DEVICE: &str = "default";

/// What is remembered, as it was found at the start.
#[derive(Debug)]
pub struct Memory {
    /// The file.
    pub file: SettingsFile,
    /// What is wrong with it, if anything.
    pub trouble: Option<SettingsError>,
    /// Where other things are kept.
    pub folders: Folders,
}

/// Which hands from outside there are.
#[derive(Debug, Clone, PartialEq)]
pub struct ControllerSettings {
    /// Where OSC is heard; none hears none.
    pub osc: Option<Place>,
    /// Where what is heard goes by OSC.
    pub osc_send: Option<Place>,
    /// How often a second it goes there.
    pub osc_rate: f64,
    /// Whether MIDI is heard.
    pub midi: bool,
    /// Where phones are listened to; none listens to none.
    pub remote: Option<RemotePlace>,
}

/// How the window plays and shows a song, or what it listens to.
#[derive(Debug, Clone)]
pub struct PlaySettings {
    /// What the user chose for good, and what the command line says of it for this run.
    pub choices: Choices,
    /// A show that the scenes follow instead of the director's.
    pub show: Option<ShowSource>,
    /// Whether the command line names a scene.
    pub names_scene: bool,
    /// Output device, or input device to listen to, by id, name or part of a name, or [`DEFAULT_DEVICE`]; none is the
    /// one that was chosen for good.
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
    /// Listen to this instead of playing a song.
    pub listen: Option<ListenChoice>,
    /// Most frames per second; none is the monitor's rate.
    pub fps_cap: Option<f64>,
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
    /// Size of the window in pixels at the start.
    pub size: (u32, u32),
    /// Where on the desktop the window opens, in pixels; none lets the system choose.
    pub place: Option<(i32, i32)>,
    /// The picture is the desktop's ground.
    pub wallpaper: bool,
    /// Hands from outside.
    pub controllers: ControllerSettings,
    /// Where pictures are sent.
    pub sends: Vec<SenderTarget>,
    /// Width and height of those pictures, in pixels; none is the window's size at the start.
    pub send_size: Option<(u32, u32)>,
    /// How many of them there are in a second.
    pub send_fps: f64,
    /// Print the OpenGL version and driver, and end.
    pub gl_info: bool,
}
