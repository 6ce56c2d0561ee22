//! The table of commands: keys, controller names and help texts.

use std::collections::BTreeSet;

use super::values::{
    Bind, CROSSFADE_STEP, Delay, Files, MovedCorner, SEEK_SECONDS, SetSetting, TurnedNumbers, VOLUME_STEP,
};
use super::{Binding, Control, Edge, Group, Mark, Panel, Row, SceneName, Switch, VideoEdit};
use crate::input::{Key, NamedKey};
use mariana_control::midi::Target;
use mariana_player::track::Repeat;
use mariana_scenes::SceneSource;
use mariana_settings::KnobEdit;

use Command as C;
use Switch::Toggle;

commands! {
    /// Pauses or resumes playback.
    Pause(Switch) {
        name: Some("pause"),
        control: Some(Control::Switch(C::Pause)),
        is_on: Some(|state| state.paused),
        group: Some(Group::Playing),
        bindings: &[keys!(
            Key::Named(NamedKey::Space), Key::Named(NamedKey::MediaPlayPause) => C::Pause(Toggle),
            "Space or Shift+Space", "pause or resume; with Shift, refine the paused picture",
            shifted: Some(C::Refine)
        )],
    }
    /// Pauses, and draws the paused moment by paths of light until something changes.
    Refine {
        name: Some("refine"),
        control: Some(Control::Press(|| C::Refine)),
        help: "pause, and draw the paused moment by paths of light; again: end this",
    }
    /// Seeks by this many seconds.
    SeekBy(f64) {
        group: Some(Group::Playing),
        bindings: &[
            keys!(
                Key::Named(NamedKey::ArrowLeft) => C::SeekBy(-SEEK_SECONDS),
                "Left", "back 5 s; with Shift, the crossfader to deck A",
                shifted: Some(C::CrossfadeBy(-CROSSFADE_STEP)), repeats: true
            ),
            keys!(
                Key::Named(NamedKey::ArrowRight) => C::SeekBy(SEEK_SECONDS),
                "Right", "forward 5 s; with Shift, the crossfader to deck B",
                shifted: Some(C::CrossfadeBy(CROSSFADE_STEP)), repeats: true
            ),
        ],
    }
    /// Seeks to this time in the track, in seconds.
    SeekTo(f64) {}
    /// Seeks to this position in the track, 0..1.
    Position(f32) {
        name: Some("position"),
        control: Some(Control::Level(C::Position)),
        level: Some(|state| state.position),
        help: "seek to this position in the track, from 0 (start) to 1 (end)",
    }
    /// Changes the volume by this amount, on a scale of 0..1.
    VolumeBy(f32) {
        group: Some(Group::Playing),
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
        help: "set the volume, from 0 to 1",
    }
    /// Mutes or unmutes the song.
    Mute(Switch) {
        name: Some("mute"),
        control: Some(Control::Switch(C::Mute)),
        is_on: Some(|state| state.muted),
        group: Some(Group::Playing),
        bindings: &[keys!(Key::Character("m") => C::Mute(Toggle), "M", "mute or unmute; the image keeps moving")],
    }
    /// Counts this moment as a beat of a tapped tempo.
    Tap {
        name: Some("beat"),
        control: Some(Control::Press(|| C::Tap)),
        group: Some(Group::Playing),
        bindings: &[keys!(Key::Character("t") => C::Tap, "T", "tap the tempo; a single tap returns to the detected tempo")],
    }
    /// Sets the tempo in beats per minute; 0 returns to the detected tempo.
    Tempo(f32) {
        name: Some("tempo"),
        control: Some(Control::Number(C::Tempo, Some(0.0))),
        help: "set the tempo in beats per minute; 0 returns to the detected tempo",
    }
    /// Plays the next track.
    NextTrack {
        name: Some("next_track"),
        control: Some(Control::Press(|| C::NextTrack)),
        group: Some(Group::Playing),
        bindings: &[keys!(Key::Named(NamedKey::PageDown), Key::Named(NamedKey::MediaTrackNext) => C::NextTrack, "Page down", "next track")],
    }
    /// Returns to the start of the track, or plays the previous track.
    PreviousTrack {
        name: Some("previous_track"),
        control: Some(Control::Press(|| C::PreviousTrack)),
        group: Some(Group::Playing),
        bindings: &[keys!(
            Key::Named(NamedKey::PageUp), Key::Named(NamedKey::MediaTrackPrevious) => C::PreviousTrack,
            "Page up", "start of the track, or previous track"
        )],
    }
    /// Plays the tracks in random order or in list order.
    Shuffle(Switch) {
        control: Some(Control::Switch(C::Shuffle)),
        is_on: Some(|state| state.shuffled),
        group: Some(Group::Playing),
        bindings: &[keys!(Key::Character("s") => C::Shuffle(Toggle), "S", "play tracks in random order or in list order")],
    }
    /// Switches to the next repeat mode: all tracks, one track, or none.
    NextRepeat {
        group: Some(Group::Playing),
        bindings: &[keys!(Key::Character("l") => C::NextRepeat, "L", "repeat all tracks, one track, or none")],
    }
    /// Sets the repeat mode.
    Repeat(Repeat) {}
    /// Plays the entry of the track list with this index, from 0.
    PlayTrack(usize) {}
    /// Removes the entry with this index, from 0, from the track list.
    RemoveTrack(usize) {}
    /// Moves an entry of the track list from the first index to the second.
    MoveTrack((usize, usize)) {}
    /// Removes all entries from the track list.
    ClearTracks {}
    /// Takes back the last change of the track list, or its replacement.
    UndoTracks {}
    /// Keeps these folders as favourites, and forgets all others.
    MarkFolders(BTreeSet<String>) {}
    /// Plays the tracks and shows the scenes in this list of files.
    Open(Files) {}
    /// Switches to the next audio source.
    NextSource {
        group: Some(Group::Playing),
        bindings: &[keys!(
            Key::Character("d") => C::NextSource,
            "D", "next source: the song, the computer's sound, or an input"
        )],
    }
    /// Switches to this entry of the displayed source list.
    Listen(usize) {}
    /// Delays the image by this many steps of 5 ms.
    DelayBy(f64) {
        group: Some(Group::Playing),
        bindings: &[
            keys!(
                Key::Character("[") => C::DelayBy(-1.0),
                "[", "show the image 5 ms earlier; stored per device", repeats: true
            ),
            keys!(
                Key::Character("]") => C::DelayBy(1.0),
                "]", "show the image 5 ms later, for headphones or a slow TV", repeats: true
            ),
        ],
    }
    /// Sets the delay of the image.
    Delay(Delay) {}
    /// Opens this panel and closes any other panel. If this panel is already open, closes it.
    TogglePanel(Panel) {
        group: Some(Group::Playing),
        bindings: &[
            keys!(Key::Character("u") => C::TogglePanel(Panel::Tracks), "U", "track list"),
            keys!(Key::Character("o") => C::TogglePanel(Panel::Files), "O", "open music, folders, playlists or scenes"),
            keys!(Key::Character("b") => C::TogglePanel(Panel::Scenes), "B", "all scenes, with preview images", group: Some(Group::Scenes)),
            keys!(
                Key::Character("e") => C::TogglePanel(Panel::Editor),
                "E", "edit this scene, over the image; Esc closes the editor", group: Some(Group::Scenes)),
            keys!(Key::Character("g") => C::TogglePanel(Panel::Settings), "G", "settings: sound, image, scenes and more"),
            keys!(
                Key::Character("j") => C::TogglePanel(Panel::Controllers),
                "J", "controllers: MIDI, OSC, phones, and their mappings", group: Some(Group::Stage)),
            keys!(Key::Named(NamedKey::F10) => C::TogglePanel(Panel::Video), "F10", "make a video of this song"),
            keys!(
                Key::Character("y") => C::TogglePanel(Panel::Corners),
                "Y", "drag the image's corners, for a projector at an angle", group: Some(Group::Stage)),
        ],
    }
    /// Shows the next scene.
    NextScene {
        name: Some("next"),
        control: Some(Control::Press(|| C::NextScene)),
        group: Some(Group::Scenes),
        bindings: &[keys!(Key::Character("n") => C::NextScene, "N", "next scene")],
    }
    /// Shows the previous scene.
    PreviousScene {
        name: Some("previous"),
        control: Some(Control::Press(|| C::PreviousScene)),
        group: Some(Group::Scenes),
        bindings: &[keys!(Key::Character("p") => C::PreviousScene, "P", "previous scene")],
    }
    /// Shows the scene named by a controller.
    Scene(SceneName) {
        name: Some("scene"),
        control: Some(Control::Scene(C::Scene)),
        help: "show this scene, by title or by number; marked scenes come first",
    }
    /// Shows the entry of the scene list with this index, from 0. Marked scenes come first.
    SceneAt(usize) {
        group: Some(Group::Scenes),
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
            help: "the first ten scenes of the list; marked scenes come first",
            ..Binding::ONCE
        }],
    }
    /// Shows a scene.
    ShowScene(Box<SceneSource>) {}
    /// Reloads the scene. Unsaved edits in the editor are shown too.
    ReloadScene {}
    /// Shows a variation of the scene, made from this number; 0 takes a new number.
    Surprise(f32) {
        name: Some("surprise"),
        control: Some(Control::Number(C::Surprise, Some(0.0))),
        group: Some(Group::Looks),
        bindings: &[keys!(Key::Named(NamedKey::F5) => C::Surprise(0.0), "F5", "surprise me: another variation of this scene")],
    }
    /// Returns to the variation before, and at last to the scene itself.
    SurpriseBack {
        name: Some("surprise_back"),
        control: Some(Control::Press(|| C::SurpriseBack)),
        group: Some(Group::Looks),
        bindings: &[keys!(
            Key::Named(NamedKey::F6) => C::SurpriseBack,
            "F6", "back to the variation before, and at last to the scene itself"
        )],
    }
    /// Saves the shown variation as a scene of the user.
    KeepSurprise {
        name: Some("keep_surprise"),
        control: Some(Control::Press(|| C::KeepSurprise)),
        for_phones: false,
        group: Some(Group::Looks),
        bindings: &[keys!(Key::Named(NamedKey::F7) => C::KeepSurprise, "F7", "save this variation as a scene of your own")],
    }
    /// Changes numbers in a scene's text and shows the result without parsing the text again.
    TurnNumbers(TurnedNumbers) {}
    /// Marks the scenes with these titles, and removes all other marks.
    MarkScenes(BTreeSet<String>) {}
    /// Makes manual scene changes cuts or fades.
    Cut(Switch) {
        name: Some("cut"),
        control: Some(Control::Switch(C::Cut)),
        is_on: Some(|state| state.cuts),
        help: "cut instead of fading at manual scene changes",
    }
    /// Sets the duration of manual fades in seconds; 0 cuts.
    Fade(f32) {
        name: Some("fade"),
        control: Some(Control::Number(C::Fade, None)),
        help: "duration of manual fades in seconds; 0 cuts",
    }
    /// Turns automatic scene changes on or off.
    Follow(Switch) {
        name: Some("follow"),
        control: Some(Control::Switch(C::Follow)),
        is_on: Some(|state| state.follows),
        group: Some(Group::Scenes),
        bindings: &[keys!(Key::Character("a") => C::Follow(Toggle), "A", "turn automatic scene changes (the show) on or off")],
    }
    /// Keeps the current scene while scenes follow the song, or allows scene changes again.
    Keep(Switch) {
        name: Some("keep"),
        control: Some(Control::Switch(C::Keep)),
        is_on: Some(|state| state.kept),
        group: Some(Group::Scenes),
        bindings: &[keys!(Key::Character("k") => C::Keep(Toggle), "K", "keep this scene when scenes would follow the song")],
    }
    /// Plays two scenes on two decks, mixed by a crossfader, or one scene.
    Decks(Switch) {
        name: Some("decks"),
        control: Some(Control::Switch(C::Decks)),
        is_on: Some(|state| state.decks),
        group: Some(Group::Stage),
        bindings: &[keys!(Key::Named(NamedKey::F3) => C::Decks(Toggle), "F3", "two decks with a crossfader, or one scene")],
    }
    /// Moves the crossfader to this position, 0..1: 0 shows deck A, 1 shows deck B.
    Crossfade(f32) {
        name: Some("crossfade"),
        control: Some(Control::Level(C::Crossfade)),
        level: Some(|state| state.crossfade),
        help: "position of the crossfader, from 0 (deck A) to 1 (deck B)",
    }
    /// Moves the crossfader by this part of its way.
    CrossfadeBy(f32) {}
    /// Moves the crossfader to the other end within the duration of a fade.
    CrossOver {
        name: Some("cross"),
        control: Some(Control::Press(|| C::CrossOver)),
        group: Some(Group::Stage),
        bindings: &[keys!(
            Key::Named(NamedKey::F8) => C::CrossOver,
            "F8", "move the crossfader to the other deck; Shift+F8 at once",
            shifted: Some(C::SwapDecks)
        )],
    }
    /// Mirrors the position of the crossfader at once.
    SwapDecks {
        name: Some("swap"),
        control: Some(Control::Press(|| C::SwapDecks)),
        help: "swap the decks: mirror the position of the crossfader at once",
    }
    /// Mixes the decks in the way with this number, from 1: melt, fade, ball or plane. 0 takes the next way.
    MixDecks(usize) {
        name: Some("mix"),
        control: Some(Control::Numbered(C::MixDecks, 4)),
        help: "how the decks mix: 1 melt, 2 fade, 3 ball, 4 plane, 0 the next way",
    }
    /// Lets sliders and controllers change the scene on this deck: 1 is A, 2 is B.
    TakeDeck(usize) {
        name: Some("deck"),
        control: Some(Control::Numbered(C::TakeDeck, 2)),
        help: "the deck whose parameters sliders and controllers change: 1 is A, 2 is B",
    }
    /// Starts the next entry that waits for a key in the show file.
    NextCue {
        name: Some("cue"),
        control: Some(Control::Press(|| C::NextCue)),
        group: Some(Group::Stage),
        bindings: &[keys!(
            Key::Named(NamedKey::Enter) => C::NextCue,
            "Enter or Shift+Enter", "next cue of a show file; Shift shows all entries",
            shifted: Some(C::TogglePanel(Panel::Cues))
        )],
    }
    /// Goes back to the entry of the show before the present one.
    PreviousCue {
        name: Some("previous_cue"),
        control: Some(Control::Press(|| C::PreviousCue)),
        help: "back to the entry of the show before the present one",
    }
    /// Goes to the entry of the show with this number, from 1.
    CueAt(usize) {
        name: Some("cue_at"),
        control: Some(Control::Numbered(C::CueAt, 8)),
        help: "go to the entry of the show with this number",
    }
    /// Starts or ends a recording of the user's actions as a show.
    Record(Switch) {
        name: Some("record"),
        control: Some(Control::Switch(C::Record)),
        is_on: Some(|state| state.recording),
        for_phones: false,
        group: Some(Group::Stage),
        bindings: &[keys!(
            Key::Named(NamedKey::F9) => C::Record(Toggle),
            "F9", "start or stop recording your actions as a show"
        )],
    }
    /// Moves a mark on the seek bar. The marks are the ends of the part that a video shows.
    Mark(Mark) {
        group: Some(Group::Playing),
        bindings: &[
            keys!(
                Key::Character("<") => C::Mark(Mark { edge: Edge::Start, at: None }),
                "<", "mark the start of a part of the song, for a video"
            ),
            keys!(Key::Character(">") => C::Mark(Mark { edge: Edge::End, at: None }), ">", "mark the end of the part"),
        ],
    }
    /// Changes the choices for a video or the queue of videos.
    Video(VideoEdit) {}
    /// Saves the present frame without panels as a PNG, at this many times the window's size.
    SavePicture(u32) {
        for_phones: false,
        group: Some(Group::Looks),
        bindings: &[keys!(
            Key::Named(NamedKey::F12) => C::SavePicture(1),
            "F12 or Shift+F12", "save this moment as a PNG; Shift doubles its size",
            shifted: Some(C::SavePicture(2))
        )],
    }
    /// Switches between interpreting and compiling the scene.
    ToggleMode {
        group: Some(Group::Developers),
        bindings: &[keys!(
            Key::Character("c") => C::ToggleMode, "C", "interpreted or compiled formulas; the image is the same"
        )],
    }
    /// Switches between a shortened tape in each cell and the whole tape everywhere.
    ToggleRegions {
        group: Some(Group::Developers),
        bindings: &[keys!(
            Key::Character("r") => C::ToggleRegions,
            "R or Shift+R", "skip empty space or not; Shift+R: the pointer's ray, step by step",
            shifted: Some(C::ToggleRay)
        )],
    }
    /// Shows or hides the path and the steps of the ray under the pointer.
    ToggleRay {}
    /// Returns to the scene's own camera after manual camera moves.
    ResetCamera {
        name: Some("camera"),
        control: Some(Control::Press(|| C::ResetCamera)),
        group: Some(Group::Looks),
        bindings: &[keys!(
            Key::Named(NamedKey::Home) => C::ResetCamera, "Home", "return to the scene's camera after manual moves"
        )],
    }
    /// Orbits the camera by a pointer movement to the right and down, in window pixels.
    TurnCamera([f64; 2]) {}
    /// Moves the camera closer by this many notches of the wheel.
    ZoomCamera(f64) {}
    /// Probes the scene at this window position, in pixels, and shows the result in the editor.
    Inspect([f64; 2]) {}
    /// Shows the next diagnostic view.
    NextView {
        group: Some(Group::Developers),
        bindings: &[keys!(
            Key::Character("v") => C::NextView,
            "V or Shift+V", "next diagnostic view, such as ray steps; Shift goes back",
            shifted: Some(C::PreviousView)
        )],
    }
    /// Shows the previous diagnostic view.
    PreviousView {}
    /// Increases (`true`) or decreases the adjustable value of a diagnostic view, such as its scale.
    StepView(bool) {
        group: Some(Group::Developers),
        bindings: &[
            keys!(
                Key::Character(",") => C::StepView(false),
                ",", "decrease the value of the view, such as its scale", repeats: true
            ),
            keys!(Key::Character(".") => C::StepView(true), ".", "increase the value of the view", repeats: true),
        ],
    }
    /// Shows or hides the parameter sliders.
    ToggleSliders {
        group: Some(Group::Looks),
        bindings: &[keys!(
            Key::Named(NamedKey::Tab), Key::Named(NamedKey::Backspace) => C::ToggleSliders,
            "Tab or Backspace", "the scene's sliders; Shift+Tab, with a screen reader Tab: the bar"
        )],
    }
    /// Moves the slider with this index to this value.
    MoveSlider((usize, f32)) {}
    /// Binds a parameter of the current scene to a sound, or ends the binding.
    Bind(Bind) {}
    /// Writes the binding of this parameter into the scene's text, in the editor.
    WriteBinding(String) {}
    /// Recalls the snapshot of the sliders with this number, from 1. The first time, takes the snapshot.
    Snapshot(usize) {
        name: Some("snapshot"),
        control: Some(Control::Numbered(C::Snapshot, 8)),
        for_phones: false,
        group: Some(Group::Looks),
        bindings: &[Binding {
            digits: Some(C::Snapshot),
            written: "Shift+1 to Shift+8",
            help: "recall this snapshot of the sliders; the first press takes it",
            ..Binding::ONCE
        }],
    }
    /// Makes the next snapshot key take its snapshot, even if there is one.
    TakeNext(Switch) {
        name: Some("take_next"),
        control: Some(Control::Switch(C::TakeNext)),
        is_on: Some(|state| state.snapshots.takes),
        for_phones: false,
        group: Some(Group::Looks),
        bindings: &[keys!(
            Key::Named(NamedKey::F2) => C::TakeNext(Toggle),
            "F2", "the next snapshot key takes its snapshot again"
        )],
    }
    /// Recalls snapshots over some beats or at once.
    Morph(Switch) {
        name: Some("morph"),
        control: Some(Control::Switch(C::Morph)),
        is_on: Some(|state| state.snapshots.morphs),
        group: Some(Group::Looks),
        bindings: &[keys!(Key::Named(NamedKey::F4) => C::Morph(Toggle), "F4", "recall snapshots over some beats, or at once")],
    }
    /// Recalls snapshots over this number of beats; 0 recalls them at once.
    MorphBeats(f32) {
        name: Some("morph_beats"),
        control: Some(Control::Number(C::MorphBeats, Some(4.0))),
        help: "recall snapshots over this number of beats; 0 recalls them at once",
    }
    /// Writes the scene's snapshots as a show file with a cue for each snapshot.
    WriteSnapshots {
        name: Some("write_snapshots"),
        control: Some(Control::Press(|| C::WriteSnapshots)),
        for_phones: false,
        help: "write the scene's snapshots as a show file with a cue for each snapshot",
    }
    /// Shows or hides the line of scene information.
    ToggleSceneLine {
        group: Some(Group::Developers),
        bindings: &[keys!(Key::Character("i") => C::ToggleSceneLine, "I", "show or hide scene information")],
    }
    /// Fades the image to black, or from black back to the image.
    Blackout(Switch) {
        name: Some("blackout"),
        control: Some(Control::Switch(C::Blackout)),
        is_on: Some(|state| state.black),
        group: Some(Group::Stage),
        bindings: &[keys!(Key::Character("x") => C::Blackout(Toggle), "X", "fade to black, or back")],
    }
    /// Freezes or releases the image.
    Freeze(Switch) {
        name: Some("freeze"),
        control: Some(Control::Switch(C::Freeze)),
        is_on: Some(|state| state.frozen),
        group: Some(Group::Stage),
        bindings: &[keys!(Key::Character("z") => C::Freeze(Toggle), "Z", "freeze or release the image; the song continues")],
    }
    /// Sets the brightness of the image, 0..1, without saving it for the next run.
    Brightness(f32) {
        name: Some("brightness"),
        control: Some(Control::Level(C::Brightness)),
        level: Some(|state| Some(state.brightness)),
        help: "brightness of the image, from 0 to 1",
    }
    /// Hides all text and panels, or shows them again.
    Clean(Switch) {
        name: Some("clean"),
        control: Some(Control::Switch(C::Clean)),
        is_on: Some(|state| state.clean),
        group: Some(Group::Stage),
        bindings: &[keys!(Key::Character("w") => C::Clean(Toggle), "W", "hide or show all text and panels")],
    }
    /// Moves a corner of the image.
    MoveCorner(MovedCorner) {}
    /// Moves all corners of the image back to the corners of the screen.
    ResetCorners {}
    /// Enters or leaves full screen.
    Fullscreen(Switch) {
        name: Some("fullscreen"),
        control: Some(Control::Switch(C::Fullscreen)),
        is_on: Some(|state| state.fullscreen),
        group: Some(Group::Playing),
        bindings: &[keys!(
            Key::Character("f"), Key::Named(NamedKey::F11) => C::Fullscreen(Toggle),
            "F, F11 or double click", "enter or leave full screen"
        )],
    }
    /// Raises the window above others.
    Raise {}
    /// Changes a setting.
    Set(SetSetting) {}
    /// Learns a controller mapping for this target, or stops learning.
    Learn(Target) {}
    /// Learns a mapping for a parameter of the current scene, by name.
    LearnParameter(String) {}
    /// Changes the controller mappings.
    EditMappings(KnobEdit) {}
    /// Closes the open panel; without one, leaves full screen. Never quits.
    Leave {
        group: Some(Group::Playing),
        bindings: &[keys!(Key::Named(NamedKey::Escape) => C::Leave, "Esc", "close the panel, or leave full screen")],
    }
    /// Shows or hides the list of keys.
    ToggleHelp {
        group: Some(Group::Playing),
        bindings: &[keys!(Key::Character("h"), Key::Named(NamedKey::F1) => C::ToggleHelp, "H or F1", "show or hide the keys")],
    }
    /// Ends the program.
    Quit {
        group: Some(Group::Playing),
        bindings: &[keys!(Key::Character("q") => C::Quit, "Q", "quit; this row only closes the table")],
    }
}
