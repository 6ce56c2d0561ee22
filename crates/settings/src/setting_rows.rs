//! The rows of the settings panel: each setting with its possible values.

use super::{Choice, Setting};
use mariana_render::placement::Crop;

/// A group of rows in the settings panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SettingGroup {
    /// Outputs, and how sound moves the image.
    Sound,
    /// The look of the image.
    Picture,
    /// Automatic scene changes.
    Scenes,
    /// The monitor for the clean image.
    Screens,
    /// Text over the image, and the next start.
    Window,
    /// Settings that few users need. The panel hides them until the user asks for them.
    Advanced,
}

impl SettingGroup {
    /// The heading of the group.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sound => "Sound",
            Self::Picture => "Image",
            Self::Scenes => "Scenes",
            Self::Screens => "Screens",
            Self::Window => "This window",
            Self::Advanced => "Advanced",
        }
    }

    /// True if the image shows what the settings of this group change.
    pub fn is_seen(self) -> bool {
        matches!(self, Self::Sound | Self::Picture | Self::Advanced)
    }
}

/// A row of the settings panel.
#[derive(Debug, Clone, PartialEq)]
pub struct SettingRow {
    /// The setting's name in one or two words.
    pub name: String,
    /// A sentence that explains the setting.
    pub purpose: String,
    /// The values that can be chosen.
    pub values: Values,
    /// True if the value comes from the command line and applies to this run only.
    pub for_this_run: bool,
    /// The group of the row. The rows of a group are below each other.
    pub group: SettingGroup,
}

/// The values of a row.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// The row belongs to a group of rows, of which one row is chosen.
    OneOfRows {
        /// True if this row is chosen.
        chosen: bool,
        /// The setting that chooses this row.
        setting: Setting,
    },
    /// A choice among names.
    Names {
        /// The names, each with the setting that chooses it.
        options: Vec<(&'static str, Setting)>,
        /// The index of the chosen name; `options.len()` if no name is chosen.
        chosen: usize,
    },
    /// The brightness of the image in percent, 0..100.
    Brightness(f64),
    /// The delay of the image for a device, in milliseconds; a negative delay shows the image earlier.
    Delay(f64),
    /// The row shows or hides the other rows of its group.
    Fold {
        /// True if the rows are shown.
        open: bool,
    },
}

pub(super) trait Shown: Sized {
    /// Returns the possible values. `setting` turns a value into a setting.
    fn values(&self, setting: fn(Self) -> Setting) -> Values;

    /// Returns the explanation of the row while this value is chosen.
    fn purpose(&self, purpose: &str) -> String {
        purpose.to_owned()
    }
}

impl<T: Choice> Shown for T {
    fn values(&self, setting: fn(Self) -> Setting) -> Values {
        Values::Names {
            options: T::ALL.iter().map(|(value, ..)| (value.word(), setting(*value))).collect(),
            chosen: T::ALL.iter().position(|(value, ..)| value == self).unwrap_or(T::ALL.len()),
        }
    }

    fn purpose(&self, purpose: &str) -> String {
        match T::ALL.iter().find(|(value, ..)| value == self) {
            Some((value, _, meaning)) if !meaning.is_empty() => {
                format!("{purpose} · {}: {meaning}", value.word())
            }
            _ => purpose.to_owned(),
        }
    }
}

/// A percentage.
impl Shown for u8 {
    fn values(&self, _: fn(Self) -> Setting) -> Values {
        Values::Brightness(f64::from(*self))
    }
}

/// The fade durations in the panel, in seconds. The command line takes any duration.
const FADES: [(f64, &str); 5] = [(0.0, "0 s"), (0.5, "0.5 s"), (1.0, "1 s"), (2.0, "2 s"), (5.0, "5 s")];

/// A fade duration in seconds.
impl Shown for f64 {
    fn values(&self, setting: fn(Self) -> Setting) -> Values {
        Values::Names {
            options: FADES.iter().map(|(seconds, name)| (*name, setting(*seconds))).collect(),
            chosen: FADES.iter().position(|(seconds, _)| seconds == self).unwrap_or(FADES.len()),
        }
    }
}

/// The crops in the panel, in percent of each edge. The command line takes any value, separately for each edge.
const CROPS: [(f64, &str); 6] =
    [(0.0, "0 %"), (1.0, "1 %"), (2.0, "2 %"), (3.0, "3 %"), (5.0, "5 %"), (10.0, "10 %")];

impl Shown for Crop {
    fn values(&self, setting: fn(Self) -> Setting) -> Values {
        let crops =
            CROPS.iter().filter_map(|(percent, name)| Some((*name, Crop::try_from([*percent; 4]).ok()?)));
        let crops: Vec<(&'static str, Self)> = crops.collect();
        Values::Names {
            chosen: crops.iter().position(|(_, crop)| crop == self).unwrap_or(crops.len()),
            options: crops.into_iter().map(|(name, crop)| (name, setting(crop))).collect(),
        }
    }
}
