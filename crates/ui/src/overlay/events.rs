//! What the pointer and the keys of the controls do in the panels.

use std::ops::Range;

use crate::editor::EditorEvent;
use mariana_commands::Command;

/// Something that was done in a panel.
#[derive(Debug, Clone, PartialEq)]
pub enum UiEvent {
    /// A command to the show.
    Command(Command),
    /// Something in the text of the editor.
    Editor(EditorEvent),
    /// Something in the list of scenes.
    Scenes(SceneListEvent),
    /// Something in the list of files.
    Files(FileListEvent),
    /// Something in the panel of settings.
    Settings(SettingEvent),
}

/// What was done in the list of scenes; places are those among the scenes that were found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SceneListEvent {
    /// The scene at a place was chosen.
    Show {
        /// The place.
        place: usize,
        /// Whether the list closes.
        close: bool,
    },
    /// The scene at a place was marked, or its mark was taken away.
    Mark(usize),
    /// These places were drawn, so many side by side.
    Drawn {
        /// The places.
        places: Range<usize>,
        /// Tiles side by side.
        columns: usize,
    },
}

/// What was done in the list of files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileListEvent {
    /// The entry at a place among those that match was chosen.
    Open {
        /// The place.
        place: usize,
        /// Whether a file follows the tracks that are there.
        append: bool,
    },
    /// The folder was chosen with everything in it.
    OpenFolder {
        /// Whether it follows the tracks that are there.
        append: bool,
    },
    /// One of the places to begin with was chosen.
    EnterPlace(usize),
    /// The folder above was chosen.
    Up,
    /// The list was closed.
    Close,
}

/// What was done in the panel of settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SettingEvent {
    /// A value of a row was chosen.
    Pick {
        /// The place of the row.
        row: usize,
        /// The place of the value in it.
        value: usize,
    },
    /// The number of a row was changed.
    Change {
        /// The place of the row.
        row: usize,
        /// The number: milliseconds or percent.
        number: f64,
        /// Whether the pointer has let go of it.
        settled: bool,
    },
    /// The panel was closed.
    Close,
}
