//! The table of commands.

use std::collections::BTreeSet;
use std::path::PathBuf;

use super::{Control, Panel, Row, SceneName, Switch};
use crate::input::{Key, NamedKey};
use mariana_control::midi::Target;
use mariana_player::track::Repeat;
use mariana_scenes::SceneSource;
use mariana_settings::{KnobEdit, Setting};

/// Seconds of a seek by key.
pub const SEEK_SECONDS: f64 = 5.0;
/// Step of the volume by key, as a share of 1.
pub const VOLUME_STEP: f32 = 0.05;

/// Step of the picture's delay by key, in milliseconds.
pub const SHIFT_STEP_MS: f64 = 5.0;

/// Makes [`Command`] and its table from one row for each command.
macro_rules! commands {
    ($( $(#[$doc:meta])* $variant:ident $( ( $value:ty ) )? { $($field:ident: $of_row:expr),* $(,)? } )*) => {
        /// Something that a user asks for.
        #[derive(Debug, Clone, PartialEq)]
        pub enum Command {
            $( $(#[$doc])* $variant $( ($value) )?, )*
        }

        /// The table: one row for each command, in the order of the help.
        pub static ROWS: &[Row] = &[$( Row { $($field: $of_row,)* ..Row::PLAIN } ),*];

        /// The places of the rows.
        enum Place { $($variant),* }

        impl Command {
            /// Returns the command's row.
            pub fn row(&self) -> &'static Row {
                let place = match self { $( Self::$variant { .. } => Place::$variant ),* };
                &ROWS[place as usize]
            }
        }
    };
}

/// Binds keys that all send the same command.
macro_rules! keys {
    ($($key:expr),+ => $command:expr, $written:literal, $help:literal $(, $field:ident: $value:expr)*) => {
        Binding { keys: &[$(($key, $command)),+], written: $written, help: $help, $($field: $value,)* ..Binding::ONCE }
    };
}

use Command as C;
use Switch::Toggle;

commands! {
    /// Pauses the sound, or lets it run.
    Pause(Switch) {
        name: Some("pause"),
        control: Some(Control::Switch(C::Pause)),
        is_on: Some(|state| state.paused),
        bindings: &[keys!(Key::Named(NamedKey::Space), Key::Named(NamedKey::MediaPlayPause) => C::Pause(Toggle), "Space", "pause, or go on")],
    }
    /// Seeks by this many seconds.
    SeekBy(f64) {
        bindings: &[
            keys!(Key::Named(NamedKey::ArrowLeft) => C::SeekBy(-SEEK_SECONDS), "Left", "back 5 s", repeats: true),
            keys!(Key::Named(NamedKey::ArrowRight) => C::SeekBy(SEEK_SECONDS), "Right", "forward 5 s", repeats: true),
        ],
    }
    /// Goes to this time of the track, in seconds.
    SeekTo(f64) {}
    /// Goes to this share of the track, 0..1.
    Position(f32) {
        name: Some("position"),
        control: Some(Control::Level(C::Position)),
        level: Some(|state| state.position),
        help: "this place in the track, from 0 at its start to 1 at its end",
    }
    /// Changes the volume by this much of 0..1.
    VolumeBy(f32) {
        bindings: &[
            keys!(Key::Named(NamedKey::ArrowUp) => C::VolumeBy(VOLUME_STEP), "Up", "louder", repeats: true),
            keys!(Key::Named(NamedKey::ArrowDown) => C::VolumeBy(-VOLUME_STEP), "Down", "quieter", repeats: true),
        ],
    }
    /// Sets the volume, 0..1.
    Volume(f32) {
        name: Some("volume"),
        control: Some(Control::Level(C::Volume)),
        level: Some(|state| state.volume),
        help: "this volume, from 0 to 1",
    }
    /// Mutes the song, or unmutes it.
    Mute(Switch) {
        name: Some("mute"),
        control: Some(Control::Switch(C::Mute)),
        is_on: Some(|state| state.muted),
        bindings: &[keys!(Key::Character("m") => C::Mute(Toggle), "M", "mute, or unmute; the picture goes on")],
    }
    /// Takes this moment as a beat.
    Tap {
        name: Some("beat"),
        control: Some(Control::Press(|| C::Tap)),
        bindings: &[keys!(
            Key::Character("t") => C::Tap, "T", "tap the tempo; a single tap returns to the detected one"
        )],
    }
    /// Sets the tempo, in beats per minute; 0 returns to the detected one.
    Tempo(f32) {
        name: Some("tempo"),
        control: Some(Control::Number(C::Tempo, Some(0.0))),
        help: "this tempo, in beats per minute; 0 returns to the detected one",
    }
    /// Goes to the next track.
    NextTrack {
        name: Some("next_track"),
        control: Some(Control::Press(|| C::NextTrack)),
        bindings: &[keys!(Key::Named(NamedKey::PageDown), Key::Named(NamedKey::MediaTrackNext) => C::NextTrack, "Page down", "the next track")],
    }
    /// Goes to the start of the track, or to the previous one.
    PreviousTrack {
        name: Some("previous_track"),
        control: Some(Control::Press(|| C::PreviousTrack)),
        bindings: &[keys!(
            Key::Named(NamedKey::PageUp), Key::Named(NamedKey::MediaTrackPrevious) => C::PreviousTrack,
            "Page up", "the track's start, or the previous track"
        )],
    }
    /// Plays the tracks in random order, or in the list's.
    Shuffle(Switch) {
        control: Some(Control::Switch(C::Shuffle)),
        is_on: Some(|state| state.shuffled),
        bindings: &[keys!(
            Key::Character("s") => C::Shuffle(Toggle), "S", "tracks in random order, or in list order"
        )],
    }
    /// Repeats all tracks, then one, then none.
    NextRepeat {
        bindings: &[keys!(Key::Character("l") => C::NextRepeat, "L", "repeat all tracks, this one, or none")],
    }
    /// Sets which tracks are repeated.
    Repeat(Repeat) {}
    /// Plays the entry at this place of the list of tracks, from 0.
    PlayTrack(usize) {}
    /// Removes the entry at this place of the list of tracks.
    RemoveTrack(usize) {}
    /// Moves an entry of the list of tracks from the first place to the second.
    MoveTrack((usize, usize)) {}
    /// Plays files and shows the scenes among them.
    Open(Files) {}
    /// Listens to the next source.
    NextSource {
        bindings: &[keys!(
            Key::Character("d") => C::NextSource,
            "D", "the next source: the song, what the computer plays, inputs"
        )],
    }
    /// Listens to the source at this place of the list that is shown.
    Listen(usize) {}
    /// Shows the picture later by this many steps of 5 ms.
    DelayBy(f64) {
        bindings: &[
            keys!(
                Key::Character("[") => C::DelayBy(-1.0),
                "[", "the picture 5 ms sooner; remembered for the device", repeats: true
            ),
            keys!(
                Key::Character("]") => C::DelayBy(1.0),
                "]", "the picture 5 ms later, for headphones or a TV that lags", repeats: true
            ),
        ],
    }
    /// Shows the picture this much later.
    Delay(Delay) {}
    /// Opens a panel instead of the one that is open, or closes it.
    TogglePanel(Panel) {
        bindings: &[
            keys!(Key::Character("u") => C::TogglePanel(Panel::Tracks), "U", "the list of tracks"),
            keys!(Key::Character("o") => C::TogglePanel(Panel::Files), "O", "open music, folders, lists, scenes"),
            keys!(Key::Character("b") => C::TogglePanel(Panel::Scenes), "B", "all scenes, with pictures"),
            keys!(
                Key::Character("e") => C::TogglePanel(Panel::Editor),
                "E", "the editor: the text of this scene, over the picture"
            ),
            keys!(
                Key::Character("g") => C::TogglePanel(Panel::Settings),
                "G", "settings: output, latency, quality, flashes, tone map, gain"
            ),
            keys!(
                Key::Character("j") => C::TogglePanel(Panel::Controllers),
                "J", "knobs from outside, learning them: MIDI, OSC, phones"
            ),
            keys!(
                Key::Character("y") => C::TogglePanel(Panel::Corners),
                "Y", "drag the picture's corners, for a slanted projector"
            ),
        ],
    }
    /// Shows the next scene.
    NextScene {
        name: Some("next"),
        control: Some(Control::Press(|| C::NextScene)),
        bindings: &[keys!(Key::Character("n") => C::NextScene, "N", "the next scene")],
    }
    /// Shows the previous scene.
    PreviousScene {
        name: Some("previous"),
        control: Some(Control::Press(|| C::PreviousScene)),
        bindings: &[keys!(Key::Character("p") => C::PreviousScene, "P", "the previous scene")],
    }
    /// Shows the scene that a controller names.
    Scene(SceneName) {
        name: Some("scene"),
        control: Some(Control::Scene(C::Scene)),
        help: "this scene, by its name or its number; marked ones come first",
    }
    /// Shows the scene at this place of the list of scenes, from 0, marked ones first.
    SceneAt(usize) {
        bindings: &[Binding {
            keys: &[
                (Key::Character("1"), C::SceneAt(0)),
                (Key::Character("2"), C::SceneAt(1)),
                (Key::Character("3"), C::SceneAt(2)),
                (Key::Character("4"), C::SceneAt(3)),
                (Key::Character("5"), C::SceneAt(4)),
                (Key::Character("6"), C::SceneAt(5)),
                (Key::Character("7"), C::SceneAt(6)),
                (Key::Character("8"), C::SceneAt(7)),
                (Key::Character("9"), C::SceneAt(8)),
                (Key::Character("0"), C::SceneAt(9)),
            ],
            written: "1 to 9, 0",
            help: "the first ten scenes of that list, marked ones first",
            ..Binding::ONCE
        }],
    }
    /// Shows a scene.
    ShowScene(Box<SceneSource>) {}
    /// Loads the scene again, with the texts that are being edited.
    ReloadScene {}
    /// Gives numbers of a scene's text other values for the next frames, without reading the text again.
    TurnNumbers(TurnedNumbers) {}
    /// Marks the scenes with these titles, and no others.
    MarkScenes(BTreeSet<String>) {}
    /// Cuts from scene to scene by hand, or fades.
    Cut(Switch) {
        name: Some("cut"),
        control: Some(Control::Switch(C::Cut)),
        is_on: Some(|state| state.cuts),
        help: "cut from scene to scene by hand, or fade",
    }
    /// Fades from scene to scene by hand in this many seconds; 0 cuts.
    Fade(f32) {
        name: Some("fade"),
        control: Some(Control::Number(C::Fade, None)),
        help: "so many seconds for a fade from scene to scene by hand; 0 cuts",
    }
    /// Lets the scenes follow the song, or not.
    Follow(Switch) {
        name: Some("follow"),
        control: Some(Control::Switch(C::Follow)),
        is_on: Some(|state| state.follows),
        bindings: &[keys!(
            Key::Character("a") => C::Follow(Toggle), "A", "turn the show on or off: scenes that follow the song"
        )],
    }
    /// Keeps the scene while scenes follow the song, or not.
    Keep(Switch) {
        name: Some("keep"),
        control: Some(Control::Switch(C::Keep)),
        is_on: Some(|state| state.kept),
        bindings: &[keys!(
            Key::Character("k") => C::Keep(Toggle), "K", "keep this scene while scenes follow the song, or not"
        )],
    }
    /// Goes to the next entry of a show file that waits for a key.
    NextCue {
        name: Some("cue"),
        control: Some(Control::Press(|| C::NextCue)),
        bindings: &[keys!(Key::Named(NamedKey::Enter) => C::NextCue, "Enter", "the next cue of a show file")],
    }
    /// Records what users do as a show, or ends the recording.
    Record(Switch) {
        name: Some("record"),
        control: Some(Control::Switch(C::Record)),
        is_on: Some(|state| state.recording),
        for_phones: false,
        bindings: &[keys!(
            Key::Named(NamedKey::F9) => C::Record(Toggle),
            "F9", "record what hands do as a show, to be rendered; again to end"
        )],
    }
    /// Changes between the interpreted and the compiled scene.
    ToggleMode {
        bindings: &[keys!(
            Key::Character("c") => C::ToggleMode, "C", "interpreted, or compiled; the picture is the same"
        )],
    }
    /// Uses the cells of regions, or the whole tape everywhere.
    ToggleRegions {
        bindings: &[keys!(
            Key::Character("r") => C::ToggleRegions, "R", "skip empty space, or not; the picture is the same"
        )],
    }
    /// Returns from a camera that was moved by hand to the scene's own.
    ResetCamera {
        name: Some("camera"),
        control: Some(Control::Press(|| C::ResetCamera)),
        bindings: &[keys!(
            Key::Named(NamedKey::Home) => C::ResetCamera, "Home", "back to the scene's own camera, after dragging or zooming"
        )],
    }
    /// Turns the camera by a movement of the pointer to the right and down, in pixels of the window.
    TurnCamera([f64; 2]) {}
    /// Moves the camera nearer by this many notches of the wheel.
    ZoomCamera(f64) {}
    /// Reports in the editor what is at this place of the window, in pixels.
    Inspect([f64; 2]) {}
    /// Shows the next view of how the picture is made.
    NextView {
        bindings: &[keys!(
            Key::Character("v") => C::NextView,
            "V or Shift+V", "how the picture is made, view by view; Shift goes back",
            shifted: Some(C::PreviousView)
        )],
    }
    /// Shows the previous view of how the picture is made.
    PreviousView {}
    /// Makes the number of the view larger (`true`) or smaller.
    StepView(bool) {
        bindings: &[
            keys!(
                Key::Character(",") => C::StepView(false),
                ",", "a smaller number for the view, such as its scale", repeats: true
            ),
            keys!(Key::Character(".") => C::StepView(true), ".", "a larger one", repeats: true),
        ],
    }
    /// Shows or hides the sliders of the scene's parameters.
    ToggleSliders {
        bindings: &[keys!(
            Key::Named(NamedKey::Tab) => C::ToggleSliders,
            "Tab or Shift+Tab", "the scene's sliders; with Shift, keys go through the bar"
        )],
    }
    /// Shows or hides the line about the scene.
    ToggleSceneLine {
        bindings: &[keys!(Key::Character("i") => C::ToggleSceneLine, "I", "a line about the scene")],
    }
    /// Fades the picture to black, or back.
    Blackout(Switch) {
        name: Some("blackout"),
        control: Some(Control::Switch(C::Blackout)),
        is_on: Some(|state| state.black),
        bindings: &[keys!(Key::Character("x") => C::Blackout(Toggle), "X", "blackout, or light again")],
    }
    /// Holds the picture that shows, or lets it go.
    Freeze(Switch) {
        name: Some("freeze"),
        control: Some(Control::Switch(C::Freeze)),
        is_on: Some(|state| state.frozen),
        bindings: &[keys!(
            Key::Character("z") => C::Freeze(Toggle), "Z", "hold the picture, or let it go; the song goes on"
        )],
    }
    /// Gives every picture of this run this share of its light, 0..1.
    Brightness(f32) {
        name: Some("brightness"),
        control: Some(Control::Level(C::Brightness)),
        level: Some(|state| Some(state.brightness)),
        help: "this share of the light of every picture, from 0 to 1",
    }
    /// Hides all words and panels, or shows them again.
    Clean(Switch) {
        name: Some("clean"),
        control: Some(Control::Switch(C::Clean)),
        is_on: Some(|state| state.clean),
        bindings: &[keys!(Key::Character("w") => C::Clean(Toggle), "W", "hide every word and panel, or not")],
    }
    /// Moves a corner of the picture.
    MoveCorner(MovedCorner) {}
    /// Moves all corners of the picture back to those of the screen.
    ResetCorners {}
    /// Enters full screen, or leaves it.
    Fullscreen(Switch) {
        name: Some("fullscreen"),
        control: Some(Control::Switch(C::Fullscreen)),
        is_on: Some(|state| state.fullscreen),
        bindings: &[keys!(
            Key::Character("f"), Key::Named(NamedKey::F11) => C::Fullscreen(Toggle),
            "F, F11 or double click", "full screen, or back"
        )],
    }
    /// Shows the window in front of others.
    Raise {}
    /// Changes a setting.
    Set(SetSetting) {}
    /// Learns which knob or button controls this, or stops learning it.
    Learn(Target) {}
    /// The same for a parameter of the scene, by its name.
    LearnParameter(String) {}
    /// Changes the mappings of knobs.
    EditMappings(KnobEdit) {}
    /// Closes the panel that is open, or else leaves full screen; never quits.
    Leave {
        bindings: &[keys!(Key::Named(NamedKey::Escape) => C::Leave, "Esc", "close what is open, or leave full screen")],
    }
    /// Shows the keys, or hides them.
    ToggleHelp {
        bindings: &[keys!(
            Key::Character("h"), Key::Named(NamedKey::F1) => C::ToggleHelp, "H or F1", "show the keys, or hide them"
        )],
    }
    /// Ends the program.
    Quit {
        bindings: &[keys!(Key::Character("q") => C::Quit, "Q", "quit")],
    }
}

/// One or several keys that send a command, with their words in the help and in README.
#[derive(Debug)]
pub struct Binding {
    /// The keys, each with the command that it sends.
    pub keys: &'static [(Key<&'static str>, Command)],
    /// The command that the first key sends while Shift is held, where it differs.
    pub shifted: Option<Command>,
    /// The keys as people write them, such as "F, F11 or double click".
    pub written: &'static str,
    /// The effect in words, such as "full screen, or back".
    pub help: &'static str,
    /// Whether a key that is held down sends the command again and again.
    pub repeats: bool,
}

impl Binding {
    /// A binding without keys that does not repeat.
    const ONCE: Self = Self { keys: &[], shifted: None, written: "", help: "", repeats: false };
}

/// Files to be opened.
#[derive(Debug, Clone, PartialEq)]
pub struct Files {
    /// Songs, folders, lists of tracks, and scenes.
    pub files: Vec<PathBuf>,
    /// Whether the tracks follow those that are there, instead of replacing them.
    pub append: bool,
}

/// Numbers of a text and their values.
#[derive(Debug, Clone, PartialEq)]
pub struct TurnedNumbers {
    /// The file of the text.
    pub file: PathBuf,
    /// The byte at which each number begins in the text as it was loaded last, and its value.
    pub values: Vec<(usize, f32)>,
}

/// How much later the picture is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Delay {
    /// Milliseconds, negative for earlier.
    pub milliseconds: f64,
    /// Whether the user has let go of it, so that it is remembered.
    pub settled: bool,
}

/// A corner of the picture and its new place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovedCorner {
    /// Which, clockwise from the upper left, from 0.
    pub corner: usize,
    /// The place, as shares of the screen to the right and down.
    pub place: [f64; 2],
    /// Whether the pointer has let go of it.
    pub settled: bool,
}

/// A setting with its new value.
#[derive(Debug, Clone, PartialEq)]
pub struct SetSetting {
    /// The setting.
    pub setting: Setting,
    /// Whether the user has let go of it, so that it is remembered.
    pub settled: bool,
}
