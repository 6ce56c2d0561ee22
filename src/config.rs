//! The settings of a run, from the command line and earlier runs. [`PlaySettings`] has all settings of the window.

use std::sync::Arc;

pub use mariana_files::Folders;
pub use mariana_settings::limits as setting_limits;
pub use mariana_settings::{
    Choice, Choices, DisplayChoices, FollowChoice, Kept, KeptSettings, KnobEdit, KnobMemory, LastShow,
    PerformanceFiles, QualityChoice, Setting, SettingRow, Settings, SettingsFile, Snapshot, StoredFileError,
    Values, with_settings,
};

use crate::program_cache::ProgramCache;
use crate::scenes::SceneSource;
use crate::sending::SenderTarget;
use crate::show::ShowSource;
use mariana_control::osc::Place;
use mariana_remote::RemotePlace;

/// The way in which the GPU evaluates a scene's expressions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SdfChoice {
    /// The interpreter shader runs the tape.
    Interpreted,
    /// The driver compiles the expressions as GLSL.
    Compiled,
    /// The expressions are interpreted until the driver has compiled them.
    #[default]
    Auto,
}

impl Choice for SdfChoice {
    const ALL: &'static [(Self, &'static str, &'static str)] =
        &[(Self::Interpreted, "interpreted", ""), (Self::Compiled, "compiled", ""), (Self::Auto, "auto", "")];
}

/// A live input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ListenChoice {
    /// A microphone or another input.
    Microphone,
    /// The sound that the computer plays.
    System,
}

/// The name of the system's default device.
pub const DEFAULT_DEVICE: &str = "default";

/// The saved settings at the start of a run.
#[derive(Debug)]
pub struct Memory {
    /// The settings file.
    pub file: SettingsFile,
    /// The error from reading that file, if any.
    pub trouble: Option<StoredFileError>,
    /// The folders for other saved files.
    pub folders: Folders,
}

/// The external controllers: OSC, MIDI and phones.
#[derive(Debug, Clone, PartialEq)]
pub struct ControllerSettings {
    /// The address at which OSC is received; `None` receives none.
    pub osc: Option<Place>,
    /// The address to which features are sent by OSC.
    pub osc_send: Option<Place>,
    /// OSC messages sent per second.
    pub osc_rate: f64,
    /// True if MIDI devices are opened.
    pub midi: bool,
    /// The address of the remote control's page; `None` serves none.
    pub remote: Option<RemotePlace>,
}

/// Everything that the window needs to know about a run, apart from the tracks and the scene.
#[derive(Debug, Clone)]
pub struct PlaySettings {
    /// The user's saved choices, overridden by the command line.
    pub choices: Choices,
    /// The show to play; `None` for the director's show.
    pub show: Option<ShowSource>,
    /// True if the command line names a scene.
    pub names_scene: bool,
    /// Output or input device by id, name or a part of its name, or [`DEFAULT_DEVICE`]; `None` uses the saved choice.
    pub device: Option<String>,
    /// Plays no sound; a silent clock keeps the song's time.
    pub silent: bool,
    /// Ends after the last track.
    pub once: bool,
    /// Volume at the start, 0..1.
    pub volume: f32,
    /// Delay of the sound in addition to the device's latency, in seconds; `None` uses the value saved for the device.
    pub latency: Option<f64>,
    /// The live input to listen to; `None` plays songs.
    pub listen: Option<ListenChoice>,
    /// Highest number of frames per second; `None` uses the monitor's rate.
    pub fps_cap: Option<f64>,
    /// Duration of fades between scenes in seconds; 0 cuts.
    pub fade: f64,
    /// True if the next and the previous scene are prepared while the current scene is shown.
    pub prepare_ahead: bool,
    /// The cache of compiled programs; `None` keeps none.
    pub program_cache: Option<Arc<ProgramCache>>,
    /// Starts in full screen.
    pub fullscreen: bool,
    /// Position in the first track at the start, in seconds.
    pub begin_at: f64,
    /// Values of the sliders that were moved in the first scene, and the sounds that move sliders.
    pub moved: Snapshot,
    /// The scene to show if the scene of the last show cannot be shown; `None` if the user has named a scene.
    pub resumed_scene_or: Option<SceneSource>,
    /// True if this run is saved, so that the next run can continue it.
    pub remembered: bool,
    /// Size of the window at the start, in pixels.
    pub size: (u32, u32),
    /// Position of the window on the desktop at the start, in pixels; `None` lets the system choose.
    pub place: Option<(i32, i32)>,
    /// True to draw the desktop's wallpaper, not a window.
    pub wallpaper: bool,
    /// The controllers to open.
    pub controllers: ControllerSettings,
    /// The programs to which frames are sent.
    pub sends: Vec<SenderTarget>,
    /// Width and height of the sent frames, in pixels; `None` uses the window's size at the start.
    pub send_size: Option<(u32, u32)>,
    /// Sent frames per second.
    pub send_fps: f64,
    /// Prints the OpenGL version and driver, and exits.
    pub gl_info: bool,
}
