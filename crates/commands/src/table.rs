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
    [Playing]
    /// Pauses or resumes playback.
    Pause(Switch) {
        control: Some(("pause", Control::Switch(C::Pause, |state| state.paused))),
        bindings: &[keys!(
            Key::Named(NamedKey::Space), Key::Named(NamedKey::MediaPlayPause) => C::Pause(Toggle),
            "Space or Shift+Space", "pause or resume; with Shift, refine the paused picture",
            shifted: Some(C::Refine)
        )],
    }
    /// Pauses, and draws the paused moment by paths of light until something changes.
    Refine {
        control: Some(("refine", Control::Press(|| C::Refine))),
        help: "pause, and draw the paused moment by paths of light; again: end this",
    }
    /// Seeks by this many seconds.
    SeekBy(f64) {
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
        control: Some(("position", Control::Level(C::Position, |state| state.position))),
        help: "seek to this position in the track, from 0 (start) to 1 (end)",
    }
    /// Changes the volume by this amount, on a scale of 0..1.
    VolumeBy(f32) {
        bindings: &[
            keys!(Key::Named(NamedKey::ArrowUp) => C::VolumeBy(VOLUME_STEP), "Up", "louder", repeats: true),
            keys!(Key::Named(NamedKey::ArrowDown) => C::VolumeBy(-VOLUME_STEP), "Down", "quieter", repeats: true),
        ],
    }
    /// Sets the volume, 0..1.
    Volume(f32) {
        control: Some(("volume", Control::Level(C::Volume, |state| state.volume))),
        help: "set the volume, from 0 to 1",
    }
    /// Mutes or unmutes the song.
    Mute(Switch) {
        control: Some(("mute", Control::Switch(C::Mute, |state| state.muted))),
        bindings: &[keys!(Key::Character("m") => C::Mute(Toggle), "M", "mute or unmute; the image keeps moving")],
    }
    /// Counts this moment as a beat of a tapped tempo.
    Tap {
        control: Some(("beat", Control::Press(|| C::Tap))),
        bindings: &[keys!(Key::Character("t") => C::Tap, "T", "tap the tempo; a single tap returns to the detected tempo")],
    }
    /// Sets the tempo in beats per minute; 0 returns to the detected tempo.
    Tempo(f32) {
        control: Some(("tempo", Control::Number(C::Tempo, Some(0.0)))),
        help: "set the tempo in beats per minute; 0 returns to the detected tempo",
    }
    /// Plays the next track.
    NextTrack {
        control: Some(("next_track", Control::Press(|| C::NextTrack))),
        bindings: &[keys!(Key::Named(NamedKey::PageDown), Key::Named(NamedKey::MediaTrackNext) => C::NextTrack, "Page down", "next track")],
    }
    /// Returns to the start of the track, or plays the previous track.
    PreviousTrack {
        control: Some(("previous_track", Control::Press(|| C::PreviousTrack))),
        bindings: &[keys!(
            Key::Named(NamedKey::PageUp), Key::Named(NamedKey::MediaTrackPrevious) => C::PreviousTrack,
            "Page up", "start of the track, or previous track"
        )],
    }
    /// Plays the tracks in random order or in list order.
    Shuffle(Switch) {
        control: Some(("", Control::Switch(C::Shuffle, |state| state.shuffled))),
        bindings: &[keys!(Key::Character("s") => C::Shuffle(Toggle), "S", "play tracks in random order or in list order")],
    }
    /// Switches to the next repeat mode: all tracks, one track, or none.
    NextRepeat {
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
        bindings: &[keys!(
            Key::Character("d") => C::NextSource,
            "D", "next source: the song, the computer's sound, or an input"
        )],
    }
    /// Switches to this entry of the displayed source list.
    Listen(usize) {}
    /// Delays the image by this many steps of 5 ms.
    DelayBy(f64) {
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

    [Scenes]
    /// Shows the next scene.
    NextScene {
        control: Some(("next", Control::Press(|| C::NextScene))),
        bindings: &[keys!(Key::Character("n") => C::NextScene, "N", "next scene")],
    }
    /// Shows the previous scene.
    PreviousScene {
        control: Some(("previous", Control::Press(|| C::PreviousScene))),
        bindings: &[keys!(Key::Character("p") => C::PreviousScene, "P", "previous scene")],
    }
    /// Shows the scene named by a controller.
    Scene(SceneName) {
        control: Some(("scene", Control::Scene(C::Scene))),
        help: "show this scene, by title or by number; marked scenes come first",
    }
    /// Shows the entry of the scene list with this index, from 0. Marked scenes come first.
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
            help: "the first ten scenes of the list; marked scenes come first",
            ..Binding::ONCE
        }],
    }
    /// Shows a scene.
    ShowScene(Box<SceneSource>) {}
    /// Reloads the scene. Unsaved edits in the editor are shown too.
    ReloadScene {}

    [Looks]
    /// Shows a variation of the scene, made from this number; 0 takes a new number.
    Surprise(f32) {
        control: Some(("surprise", Control::Number(C::Surprise, Some(0.0)))),
        bindings: &[keys!(Key::Named(NamedKey::F5) => C::Surprise(0.0), "F5", "surprise me: another variation of this scene")],
    }
    /// Returns to the variation before, and at last to the scene itself.
    SurpriseBack {
        control: Some(("surprise_back", Control::Press(|| C::SurpriseBack))),
        bindings: &[keys!(
            Key::Named(NamedKey::F6) => C::SurpriseBack,
            "F6", "back to the variation before, and at last to the scene itself"
        )],
    }
    /// Saves the shown variation as a scene of the user.
    KeepSurprise {
        control: Some(("keep_surprise", Control::Press(|| C::KeepSurprise))),
        for_phones: false,
        bindings: &[keys!(Key::Named(NamedKey::F7) => C::KeepSurprise, "F7", "save this variation as a scene of your own")],
    }
    /// Changes numbers in a scene's text and shows the result without parsing the text again.
    TurnNumbers(TurnedNumbers) {}
    /// Marks the scenes with these titles, and removes all other marks.
    MarkScenes(BTreeSet<String>) {}
    /// Makes manual scene changes cuts or fades.
    Cut(Switch) {
        control: Some(("cut", Control::Switch(C::Cut, |state| state.cuts))),
        help: "cut instead of fading at manual scene changes",
    }
    /// Sets the duration of manual fades in seconds; 0 cuts.
    Fade(f32) {
        control: Some(("fade", Control::Number(C::Fade, None))),
        help: "duration of manual fades in seconds; 0 cuts",
    }

    [Scenes]
    /// Turns automatic scene changes on or off.
    Follow(Switch) {
        control: Some(("follow", Control::Switch(C::Follow, |state| state.follows))),
        bindings: &[keys!(Key::Character("a") => C::Follow(Toggle), "A", "turn automatic scene changes (the show) on or off")],
    }
    /// Keeps the current scene while scenes follow the song, or allows scene changes again.
    Keep(Switch) {
        control: Some(("keep", Control::Switch(C::Keep, |state| state.kept))),
        bindings: &[keys!(Key::Character("k") => C::Keep(Toggle), "K", "keep this scene when scenes would follow the song")],
    }

    [Stage]
    /// Plays two scenes on two decks, mixed by a crossfader, or one scene.
    Decks(Switch) {
        control: Some(("decks", Control::Switch(C::Decks, |state| state.decks))),
        bindings: &[keys!(Key::Named(NamedKey::F3) => C::Decks(Toggle), "F3", "two decks with a crossfader, or one scene")],
    }
    /// Moves the crossfader to this position, 0..1: 0 shows deck A, 1 shows deck B.
    Crossfade(f32) {
        control: Some(("crossfade", Control::Level(C::Crossfade, |state| state.crossfade))),
        help: "position of the crossfader, from 0 (deck A) to 1 (deck B)",
    }
    /// Moves the crossfader by this part of its way.
    CrossfadeBy(f32) {}
    /// Moves the crossfader to the other end within the duration of a fade.
    CrossOver {
        control: Some(("cross", Control::Press(|| C::CrossOver))),
        bindings: &[keys!(
            Key::Named(NamedKey::F8) => C::CrossOver,
            "F8", "move the crossfader to the other deck; Shift+F8 at once",
            shifted: Some(C::SwapDecks)
        )],
    }
    /// Mirrors the position of the crossfader at once.
    SwapDecks {
        control: Some(("swap", Control::Press(|| C::SwapDecks))),
        help: "swap the decks: mirror the position of the crossfader at once",
    }
    /// Mixes the decks in the way with this number, from 1: melt, fade, ball or plane. 0 takes the next way.
    MixDecks(usize) {
        control: Some(("mix", Control::Numbered(C::MixDecks, 4))),
        help: "how the decks mix: 1 melt, 2 fade, 3 ball, 4 plane, 0 the next way",
    }
    /// Lets sliders and controllers change the scene on this deck: 1 is A, 2 is B.
    TakeDeck(usize) {
        control: Some(("deck", Control::Numbered(C::TakeDeck, 2))),
        help: "the deck whose parameters sliders and controllers change: 1 is A, 2 is B",
    }
    /// Starts the next entry that waits for a key in the show file.
    NextCue {
        control: Some(("cue", Control::Press(|| C::NextCue))),
        bindings: &[keys!(
            Key::Named(NamedKey::Enter) => C::NextCue,
            "Enter or Shift+Enter", "next cue of a show file; Shift shows all entries",
            shifted: Some(C::TogglePanel(Panel::Cues))
        )],
    }
    /// Goes back to the entry of the show before the present one.
    PreviousCue {
        control: Some(("previous_cue", Control::Press(|| C::PreviousCue))),
        help: "back to the entry of the show before the present one",
    }
    /// Goes to the entry of the show with this number, from 1.
    CueAt(usize) {
        control: Some(("cue_at", Control::Numbered(C::CueAt, 8))),
        help: "go to the entry of the show with this number",
    }
    /// Starts or ends a recording of the user's actions as a show.
    Record(Switch) {
        control: Some(("record", Control::Switch(C::Record, |state| state.recording))),
        for_phones: false,
        bindings: &[keys!(
            Key::Named(NamedKey::F9) => C::Record(Toggle),
            "F9", "start or stop recording your actions as a show"
        )],
    }

    [Playing]
    /// Moves a mark on the seek bar. The marks are the ends of the part that a video shows.
    Mark(Mark) {
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

    [Looks]
    /// Saves the present frame without panels as a PNG, at this many times the window's size.
    SavePicture(u32) {
        for_phones: false,
        bindings: &[keys!(
            Key::Named(NamedKey::F12) => C::SavePicture(1),
            "F12 or Shift+F12", "save this moment as a PNG; Shift doubles its size",
            shifted: Some(C::SavePicture(2))
        )],
    }

    [Developers]
    /// Switches between interpreting and compiling the scene.
    ToggleMode {
        bindings: &[keys!(
            Key::Character("c") => C::ToggleMode, "C", "interpreted or compiled formulas; the image is the same"
        )],
    }
    /// Switches between a shortened tape in each cell and the whole tape everywhere.
    ToggleRegions {
        bindings: &[keys!(
            Key::Character("r") => C::ToggleRegions,
            "R or Shift+R", "skip empty space or not; Shift+R: the pointer's ray, step by step",
            shifted: Some(C::ToggleRay)
        )],
    }
    /// Shows or hides the path and the steps of the ray under the pointer.
    ToggleRay {}

    [Looks]
    /// Returns to the scene's own camera after manual camera moves.
    ResetCamera {
        control: Some(("camera", Control::Press(|| C::ResetCamera))),
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

    [Developers]
    /// Shows the next diagnostic view.
    NextView {
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
        bindings: &[
            keys!(
                Key::Character(",") => C::StepView(false),
                ",", "decrease the value of the view, such as its scale", repeats: true
            ),
            keys!(Key::Character(".") => C::StepView(true), ".", "increase the value of the view", repeats: true),
        ],
    }

    [Looks]
    /// Shows or hides the parameter sliders.
    ToggleSliders {
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
        control: Some(("snapshot", Control::Numbered(C::Snapshot, 8))),
        for_phones: false,
        bindings: &[Binding {
            digits: Some(C::Snapshot),
            written: "Shift+1 to Shift+8",
            help: "recall this snapshot of the sliders; the first press takes it",
            ..Binding::ONCE
        }],
    }
    /// Makes the next snapshot key take its snapshot, even if there is one.
    TakeNext(Switch) {
        control: Some(("take_next", Control::Switch(C::TakeNext, |state| state.snapshots.takes))),
        for_phones: false,
        bindings: &[keys!(
            Key::Named(NamedKey::F2) => C::TakeNext(Toggle),
            "F2", "the next snapshot key takes its snapshot again"
        )],
    }
    /// Recalls snapshots over some beats or at once.
    Morph(Switch) {
        control: Some(("morph", Control::Switch(C::Morph, |state| state.snapshots.morphs))),
        bindings: &[keys!(Key::Named(NamedKey::F4) => C::Morph(Toggle), "F4", "recall snapshots over some beats, or at once")],
    }
    /// Recalls snapshots over this number of beats; 0 recalls them at once.
    MorphBeats(f32) {
        control: Some(("morph_beats", Control::Number(C::MorphBeats, Some(4.0)))),
        help: "recall snapshots over this number of beats; 0 recalls them at once",
    }
    /// Writes the scene's snapshots as a show file with a cue for each snapshot.
    WriteSnapshots {
        control: Some(("write_snapshots", Control::Press(|| C::WriteSnapshots))),
        for_phones: false,
        help: "write the scene's snapshots as a show file with a cue for each snapshot",
    }

    [Developers]
    /// Shows or hides the line of scene information.
    ToggleSceneLine {
        bindings: &[keys!(Key::Character("i") => C::ToggleSceneLine, "I", "show or hide scene information")],
    }

    [Stage]
    /// Fades the image to black, or from black back to the image.
    Blackout(Switch) {
        control: Some(("blackout", Control::Switch(C::Blackout, |state| state.black))),
        bindings: &[keys!(Key::Character("x") => C::Blackout(Toggle), "X", "fade to black, or back")],
    }
    /// Freezes or releases the image.
    Freeze(Switch) {
        control: Some(("freeze", Control::Switch(C::Freeze, |state| state.frozen))),
        bindings: &[keys!(Key::Character("z") => C::Freeze(Toggle), "Z", "freeze or release the image; the song continues")],
    }
    /// Sets the brightness of the image, 0..1, without saving it for the next run.
    Brightness(f32) {
        control: Some(("brightness", Control::Level(C::Brightness, |state| Some(state.brightness)))),
        help: "brightness of the image, from 0 to 1",
    }
    /// Hides all text and panels, or shows them again.
    Clean(Switch) {
        control: Some(("clean", Control::Switch(C::Clean, |state| state.clean))),
        bindings: &[keys!(Key::Character("w") => C::Clean(Toggle), "W", "hide or show all text and panels")],
    }
    /// Moves a corner of the image.
    MoveCorner(MovedCorner) {}
    /// Moves all corners of the image back to the corners of the screen.
    ResetCorners {}

    [Playing]
    /// Enters or leaves full screen.
    Fullscreen(Switch) {
        control: Some(("fullscreen", Control::Switch(C::Fullscreen, |state| state.fullscreen))),
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
        bindings: &[keys!(Key::Named(NamedKey::Escape) => C::Leave, "Esc", "close the panel, or leave full screen")],
    }
    /// Shows or hides the list of keys.
    ToggleHelp {
        bindings: &[keys!(Key::Character("h"), Key::Named(NamedKey::F1) => C::ToggleHelp, "H or F1", "show or hide the keys")],
    }
    /// Ends the program.
    Quit {
        bindings: &[keys!(Key::Character("q") => C::Quit, "Q", "quit; this row only closes the table")],
    }
}
