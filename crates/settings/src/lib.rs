//! The user's settings, stored from run to run.
//!
//! One table (`setting_table`) defines the record [`Choices`], the enum [`Setting`] for commands, the rows of the
//! settings panel and the command-line flags. [`SettingsFile`] stores the values that differ from the defaults and
//! keeps unknown entries. Users may edit the file.
//!
//! ```
//! use mariana_settings::{Choices, Setting};
//!
//! let remembered = Choices::default();
//! let mut choices = remembered.clone();
//! choices.set(&Setting::Hints(false));
//! let changed: Vec<_> = choices.rows(&remembered).into_iter().filter(|row| row.for_this_run).collect();
//! assert_eq!(changed[0].name, "Hints");
//! ```
//!
//! The crate also stores controller mappings ([`KnobMemory`]), recorded performances ([`PerformanceFiles`]) and the
//! state of the last show ([`LastShow`]).

mod choices;
mod kept_settings;
mod knobs;
mod last_show;
pub mod limits;
mod performances;
mod setting_rows;
mod setting_table;
mod settings;
mod stored_file;
mod understood;

pub use choices::{Choice, Choices, DisplayChoices, Setting};
pub use kept_settings::KeptSettings;
pub use knobs::{KnobEdit, KnobMemory};
pub use last_show::LastShow;
pub use performances::{Kept, PerformanceFiles};
pub use setting_rows::{SettingGroup, SettingRow, Values};
pub use settings::{Settings, SettingsFile, Snapshot};
pub use stored_file::StoredFileError;

/// The rendering quality in the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum QualityChoice {
    /// The best quality that keeps the frame rate.
    #[default]
    Auto,
    /// About half the window's width and height, without expensive effects.
    Low,
    /// Between low and high.
    Medium,
    /// Almost the best.
    High,
    /// Full resolution and all effects, as in stills and videos.
    Best,
}

/// The audio sources for which scenes change automatically.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FollowChoice {
    /// Songs, unless the command line names a scene.
    #[default]
    Songs,
    /// Songs and inputs.
    On,
    /// No source: the scene stays until the user changes it.
    Off,
}
