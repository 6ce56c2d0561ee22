//! Events of the panels.

use std::ops::Range;

use crate::editor::EditorEvent;
use crate::scene_browser::SceneFilter;
use mariana_commands::Command;

/// A pass of egui over the panels, and the events in it.
pub(super) struct Pass<'a> {
    pub context: &'a egui::Context,
    pub events: &'a mut Vec<UiEvent>,
}

/// An event of a panel.
#[derive(Debug, Clone, PartialEq)]
pub enum UiEvent {
    /// A command for the session.
    Command(Command),
    /// The row of the table of keys with this index was clicked.
    Help(usize),
    /// An event of the scene editor.
    Editor(EditorEvent),
    /// An event of the scene list.
    Scenes(SceneListEvent),
    /// An event of the file list.
    Files(FileListEvent),
    /// An event of the track list.
    Tracks(TrackListEvent),
    /// An event of the settings panel.
    Settings(SettingEvent),
}

/// An event of the scene list. Indices count the matching scenes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SceneListEvent {
    /// A scene was chosen.
    Show {
        /// The scene's index.
        place: usize,
        /// True if the list closes.
        close: bool,
    },
    /// The mark of a scene was toggled.
    Mark(usize),
    /// These tiles were drawn.
    Drawn {
        /// The tiles' indices.
        places: Range<usize>,
        /// Number of tiles side by side.
        columns: usize,
        /// The tile whose thumbnail moves.
        moving: Option<usize>,
    },
    /// A filter was toggled.
    Filter(SceneFilter),
}

/// An event of the file list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FileListEvent {
    /// A matching entry was chosen.
    Open {
        /// The entry's index.
        place: usize,
        /// True to add a file to the tracks, false to replace the tracks.
        append: bool,
    },
    /// The matching entry with this index was chosen to be played; of a folder, everything in it.
    Play(usize),
    /// The whole shown folder was chosen.
    OpenFolder {
        /// True to add the folder's files to the tracks, false to replace the tracks.
        append: bool,
    },
    /// The shortcut with this index was chosen.
    EnterPlace(usize),
    /// The parent folder was chosen.
    Up,
    /// The mark of the shown folder was toggled.
    Mark,
    /// The matching entries from `first` up to, but without, `end` were drawn.
    Drawn(Range<usize>),
    /// The list was closed.
    Close,
}

/// An event of the track list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TrackListEvent {
    /// The search was opened or closed.
    Search,
    /// The pointer chose or moved the track in this row.
    Select(usize),
    /// The rows from `first` up to, but without, `end` were drawn.
    Drawn(Range<usize>),
}

/// An event of the settings panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SettingEvent {
    /// A value was chosen.
    Pick {
        /// Index of the row.
        row: usize,
        /// Index of the value in the row.
        value: usize,
    },
    /// A number was changed.
    Change {
        /// Index of the row.
        row: usize,
        /// The new number: milliseconds or percent.
        number: f64,
        /// True once the pointer has released the slider.
        settled: bool,
    },
    /// The panel was closed.
    Close,
}
