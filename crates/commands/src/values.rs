//! The values that commands carry.

use std::path::PathBuf;

use mariana_control::SoundBinding;
use mariana_settings::Setting;

/// The step of the seek keys, in seconds.
pub const SEEK_SECONDS: f64 = 5.0;
/// The step of the volume keys, on a scale of 0..1.
pub const VOLUME_STEP: f32 = 0.05;

/// The step of the crossfader's keys, as a part of its way.
pub const CROSSFADE_STEP: f32 = 0.05;

/// The step of the image delay keys, in milliseconds.
pub const SHIFT_STEP_MS: f64 = 5.0;

/// Files to open.
#[derive(Debug, Clone, PartialEq)]
pub struct Files {
    /// Songs, folders, lists of tracks, and scenes.
    pub files: Vec<PathBuf>,
    /// True to append the tracks to the list, false to replace it.
    pub append: bool,
}

/// A parameter of the current scene with its new binding.
#[derive(Debug, Clone, PartialEq)]
pub struct Bind {
    /// The parameter's name.
    pub name: String,
    /// The binding; `None` ends the present binding.
    pub binding: Option<SoundBinding>,
}

/// New values for numbers in a scene's text.
#[derive(Debug, Clone, PartialEq)]
pub struct TurnedNumbers {
    /// The file of the text.
    pub file: PathBuf,
    /// The byte offset of each number in the text as last loaded, and the number's value.
    pub values: Vec<(usize, f32)>,
}

/// A delay of the image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Delay {
    /// Milliseconds; a negative delay shows the image earlier.
    pub milliseconds: f64,
    /// True once the user has released the control: then the value is saved.
    pub settled: bool,
}

/// A corner of the image and its new position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovedCorner {
    /// The index of the corner, from 0, clockwise from the upper left.
    pub corner: usize,
    /// The position as fractions of the screen, to the right and down.
    pub place: [f64; 2],
    /// True once the pointer is released.
    pub settled: bool,
}

/// A setting with its new value.
#[derive(Debug, Clone, PartialEq)]
pub struct SetSetting {
    /// The setting.
    pub setting: Setting,
    /// True once the user has released the control: then the value is saved.
    pub settled: bool,
}
