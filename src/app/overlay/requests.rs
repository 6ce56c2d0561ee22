//! What the pointer asks for in the panels.

use std::ops::Range;

use crate::app::editor::EditorRequest;
use crate::app::hands::panel::HandsRequest;
use crate::app::keys::Action;

/// A panel that opens from the bar; one at a time is open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Panel {
    /// The list of tracks.
    Tracks,
    /// What can be listened to.
    Sources,
    /// The scenes.
    Scenes,
    /// Files to open.
    Files,
    /// What the user chooses for good.
    Settings,
    /// The text of the scene.
    Editor,
    /// Knobs from outside.
    Hands,
    /// The corners of the picture.
    Corners,
}

/// What the user asked for with the pointer.
#[derive(Debug, Clone, PartialEq)]
pub enum Request {
    /// Something with the text.
    Editor(EditorRequest),
    /// What a key does, too.
    Act(Action),
    /// To go to this time of the track, in seconds.
    SeekTo(f64),
    /// This volume, 0..1.
    SetVolume(f32),
    /// Something with the list of tracks.
    Tracks(TrackRequest),
    /// To listen to the source at this place of the list that is shown.
    Listen(usize),
    /// Something with the list of scenes.
    Scenes(SceneRequest),
    /// Something with the list of files.
    Files(FileRequest),
    /// Something with the settings.
    Settings(SettingRequest),
    /// Something with knobs from outside.
    Hands(HandsRequest),
    /// To learn what turns a parameter of the scene on the stage, by its name, or to stop.
    LearnParam(String),
    /// To move a corner of the picture.
    Corner {
        /// Which, clockwise from the upper left.
        corner: usize,
        /// Where to, as shares of the screen to the right and down.
        place: [f64; 2],
        /// Whether the pointer has let go of it.
        settled: bool,
    },
}

/// What is asked of the list of tracks; entries are counted from 0 in the list's own order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrackRequest {
    /// To play an entry.
    Play(usize),
    /// To take an entry out.
    Remove(usize),
    /// To move an entry.
    Move {
        /// Where it is.
        from: usize,
        /// Where it will be.
        to: usize,
    },
}

/// What is asked of the list of scenes; places are those among the scenes that were found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SceneRequest {
    /// To show the scene at a place.
    Show {
        /// The place.
        place: usize,
        /// Whether the list closes.
        close: bool,
    },
    /// To mark the scene at a place, or to take its mark away.
    Mark(usize),
    /// Nothing: these places were drawn, so many side by side.
    Drawn {
        /// The places.
        places: Range<usize>,
        /// Tiles side by side.
        columns: usize,
    },
    /// To close the list.
    Close,
}

/// What is asked of the list of files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileRequest {
    /// To open the entry at a place among those that match.
    Open {
        /// The place.
        place: usize,
        /// Whether a file follows the tracks that are there.
        append: bool,
    },
    /// To open the folder with everything in it.
    OpenFolder {
        /// Whether it follows the tracks that are there.
        append: bool,
    },
    /// To go to one of the places to begin with.
    EnterPlace(usize),
    /// To go to the folder above.
    Up,
    /// To close the list.
    Close,
}

/// What is asked of the panel of settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SettingRequest {
    /// To choose a value of a row.
    Pick {
        /// The place of the row.
        row: usize,
        /// The place of the value in it.
        value: usize,
    },
    /// To shift the picture.
    Shift {
        /// The place of the row.
        row: usize,
        /// Milliseconds, negative for earlier.
        shift: f64,
        /// Whether the pointer has let go of it.
        settled: bool,
    },
    /// To close the panel.
    Close,
}
