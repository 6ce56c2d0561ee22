//! The keys: one table from which the handling, the help and README are derived.

use winit::keyboard::{Key, ModifiersState, NamedKey};

use super::overlay::Panel;

/// What a key does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Action {
    /// Pause or go on.
    TogglePause,
    /// Seek by this many seconds.
    Seek(f64),
    /// Change the volume by this much of 0..1.
    ChangeVolume(f32),
    /// Mute or unmute.
    ToggleMute,
    /// Take this moment as a beat.
    Tap,
    /// The next track, or the previous one.
    SkipTrack {
        /// Whether it is the next.
        forward: bool,
    },
    /// Play the tracks in random order, or in the list's.
    ToggleShuffle,
    /// Repeat all tracks, one, or none.
    ChangeRepeat,
    /// Show the picture later by this many steps.
    Shift(f64),
    /// Listen to the next source.
    ChangeSource,
    /// Change between the interpreted and the compiled scene.
    ToggleMode,
    /// Use the cells of regions, or the whole tape everywhere.
    ToggleRegions,
    /// The next view of how the picture is made, or the one before.
    ChangeView {
        /// Whether it is the next.
        forward: bool,
    },
    /// The number of the view, larger or smaller.
    ChangeNumber {
        /// Whether it is larger.
        larger: bool,
    },
    /// Return from a camera that was moved by hand to the scene's own.
    GiveCameraBack,
    /// The next scene, or the previous one.
    ChangeScene {
        /// Whether it is the next.
        forward: bool,
    },
    /// The scene at this place of the list of scenes, from 0.
    ShowScene {
        /// The place.
        place: usize,
    },
    /// Let the scenes follow the song, or not.
    ToggleFollow,
    /// Keep the scene that is on while scenes follow the song, or not.
    ToggleKeep,
    /// Bring what a show file holds for a key.
    NextCue,
    /// Record what hands do as a show, or end that.
    ToggleRecording,
    /// Show or hide the parameters' sliders.
    ToggleSliders,
    /// Show or hide the line about the scene.
    ToggleCorner,
    /// Let the picture fade to black, or come back.
    ToggleBlackout,
    /// Hold the picture that shows, or let it go.
    ToggleFreeze,
    /// Hide all words and panels, or not.
    ToggleClean,
    /// Let the corners of the picture be moved, or be done with that.
    ToggleCorners,
    /// Enter or leave full screen.
    ToggleFullscreen,
    /// Close the panel that is open, or else leave full screen; never quits.
    Leave,
    /// Show the keys or hide them.
    ToggleHelp,
    /// Open a panel that takes the pointer, or close it.
    TogglePanel(Panel),
    /// End the program.
    Quit,
}

/// Seconds of a seek by key.
pub const SEEK_SECONDS: f64 = 5.0;
/// Step of the volume by key, of 0..1.
pub const VOLUME_STEP: f32 = 0.05;

/// One row of the table.
pub struct Binding {
    /// The keys as winit reports them, letters in lower case.
    pub keys: &'static [Key<&'static str>],
    /// The keys as people write them.
    pub written: &'static str,
    /// What they do.
    pub action: Action,
    /// The same in words.
    pub meaning: &'static str,
    /// Whether holding the key repeats it.
    pub repeats: bool,
}

/// Every key that does something.
pub const BINDINGS: &[Binding] = &[
    Binding {
        keys: &[Key::Named(NamedKey::Space), Key::Named(NamedKey::MediaPlayPause)],
        written: "Space",
        action: Action::TogglePause,
        meaning: "pause, or go on",
        repeats: false,
    },
    Binding {
        keys: &[Key::Named(NamedKey::ArrowLeft)],
        written: "Left",
        action: Action::Seek(-SEEK_SECONDS),
        meaning: "back 5 s",
        repeats: true,
    },
    Binding {
        keys: &[Key::Named(NamedKey::ArrowRight)],
        written: "Right",
        action: Action::Seek(SEEK_SECONDS),
        meaning: "forward 5 s",
        repeats: true,
    },
    Binding {
        keys: &[Key::Named(NamedKey::ArrowUp)],
        written: "Up",
        action: Action::ChangeVolume(VOLUME_STEP),
        meaning: "louder",
        repeats: true,
    },
    Binding {
        keys: &[Key::Named(NamedKey::ArrowDown)],
        written: "Down",
        action: Action::ChangeVolume(-VOLUME_STEP),
        meaning: "quieter",
        repeats: true,
    },
    Binding {
        keys: &[Key::Character("m")],
        written: "M",
        action: Action::ToggleMute,
        meaning: "mute, or unmute; the picture goes on",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("t")],
        written: "T",
        action: Action::Tap,
        meaning: "tap the tempo; a single tap returns to the detected one",
        repeats: false,
    },
    Binding {
        keys: &[Key::Named(NamedKey::PageDown), Key::Named(NamedKey::MediaTrackNext)],
        written: "Page down",
        action: Action::SkipTrack { forward: true },
        meaning: "the next track",
        repeats: false,
    },
    Binding {
        keys: &[Key::Named(NamedKey::PageUp), Key::Named(NamedKey::MediaTrackPrevious)],
        written: "Page up",
        action: Action::SkipTrack { forward: false },
        meaning: "the track's start, or the previous track",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("s")],
        written: "S",
        action: Action::ToggleShuffle,
        meaning: "tracks in random order, or in list order",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("l")],
        written: "L",
        action: Action::ChangeRepeat,
        meaning: "repeat all tracks, this one, or none",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("d")],
        written: "D",
        action: Action::ChangeSource,
        meaning: "the next source: the song, what the computer plays, inputs",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("[")],
        written: "[",
        action: Action::Shift(-1.0),
        meaning: "the picture 5 ms sooner; remembered for the device",
        repeats: true,
    },
    Binding {
        keys: &[Key::Character("]")],
        written: "]",
        action: Action::Shift(1.0),
        meaning: "the picture 5 ms later, for headphones or a TV that lags",
        repeats: true,
    },
    Binding {
        keys: &[Key::Character("u")],
        written: "U",
        action: Action::TogglePanel(Panel::Tracks),
        meaning: "the list of tracks",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("o")],
        written: "O",
        action: Action::TogglePanel(Panel::Files),
        meaning: "open music, folders, lists, scenes",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("n")],
        written: "N",
        action: Action::ChangeScene { forward: true },
        meaning: "the next scene",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("p")],
        written: "P",
        action: Action::ChangeScene { forward: false },
        meaning: "the previous scene",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("b")],
        written: "B",
        action: Action::TogglePanel(Panel::Scenes),
        meaning: "all scenes, with pictures",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("e")],
        written: "E",
        action: Action::TogglePanel(Panel::Editor),
        meaning: "the editor: the text of this scene, over the picture",
        repeats: false,
    },
    Binding {
        keys: &[
            Key::Character("1"),
            Key::Character("2"),
            Key::Character("3"),
            Key::Character("4"),
            Key::Character("5"),
            Key::Character("6"),
            Key::Character("7"),
            Key::Character("8"),
            Key::Character("9"),
            Key::Character("0"),
        ],
        written: "1 to 9, 0",
        action: Action::ShowScene { place: 0 },
        meaning: "the first ten scenes of that list, marked ones first",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("a")],
        written: "A",
        action: Action::ToggleFollow,
        meaning: "turn the show on or off: scenes that follow the song",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("k")],
        written: "K",
        action: Action::ToggleKeep,
        meaning: "keep this scene while scenes follow the song, or not",
        repeats: false,
    },
    Binding {
        keys: &[Key::Named(NamedKey::Enter)],
        written: "Enter",
        action: Action::NextCue,
        meaning: "the next cue of a show file",
        repeats: false,
    },
    Binding {
        keys: &[Key::Named(NamedKey::F9)],
        written: "F9",
        action: Action::ToggleRecording,
        meaning: "record what hands do as a show, to be rendered; again to end",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("c")],
        written: "C",
        action: Action::ToggleMode,
        meaning: "interpreted, or compiled; the picture is the same",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("r")],
        written: "R",
        action: Action::ToggleRegions,
        meaning: "skip empty space, or not; the picture is the same",
        repeats: false,
    },
    Binding {
        keys: &[Key::Named(NamedKey::Home)],
        written: "Home",
        action: Action::GiveCameraBack,
        meaning: "back to the scene's own camera, after dragging or zooming",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("v")],
        written: "V or Shift+V",
        action: Action::ChangeView { forward: true },
        meaning: "how the picture is made, view by view; Shift goes back",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character(",")],
        written: ",",
        action: Action::ChangeNumber { larger: false },
        meaning: "a smaller number for the view, such as its scale",
        repeats: true,
    },
    Binding {
        keys: &[Key::Character(".")],
        written: ".",
        action: Action::ChangeNumber { larger: true },
        meaning: "a larger one",
        repeats: true,
    },
    Binding {
        keys: &[Key::Named(NamedKey::Tab)],
        written: "Tab or Shift+Tab",
        action: Action::ToggleSliders,
        meaning: "the scene's sliders; with Shift, keys go through the bar",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("g")],
        written: "G",
        action: Action::TogglePanel(Panel::Settings),
        meaning: "settings: output, latency, quality, flashes, tone map, gain",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("j")],
        written: "J",
        action: Action::TogglePanel(Panel::Hands),
        meaning: "knobs from outside, learning them: MIDI, OSC, phones",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("i")],
        written: "I",
        action: Action::ToggleCorner,
        meaning: "a line about the scene",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("x")],
        written: "X",
        action: Action::ToggleBlackout,
        meaning: "blackout, or light again",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("z")],
        written: "Z",
        action: Action::ToggleFreeze,
        meaning: "hold the picture, or let it go; the song goes on",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("w")],
        written: "W",
        action: Action::ToggleClean,
        meaning: "hide every word and panel, or not",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("y")],
        written: "Y",
        action: Action::ToggleCorners,
        meaning: "drag the picture's corners, for a slanted projector",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("f"), Key::Named(NamedKey::F11)],
        written: "F, F11 or double click",
        action: Action::ToggleFullscreen,
        meaning: "full screen, or back",
        repeats: false,
    },
    Binding {
        keys: &[Key::Named(NamedKey::Escape)],
        written: "Esc",
        action: Action::Leave,
        meaning: "close what is open, or leave full screen",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("h"), Key::Named(NamedKey::F1)],
        written: "H or F1",
        action: Action::ToggleHelp,
        meaning: "show the keys, or hide them",
        repeats: false,
    },
    Binding {
        keys: &[Key::Character("q")],
        written: "Q",
        action: Action::Quit,
        meaning: "quit",
        repeats: false,
    },
];

/// What `key` does, if anything; `repeated` while it is held. With Ctrl, Alt or the system's key it does nothing:
/// those belong to the desktop and to later keys.
pub fn action_of(key: &Key, repeated: bool, held: ModifiersState) -> Option<Action> {
    if held.intersects(ModifiersState::CONTROL | ModifiersState::ALT | ModifiersState::SUPER) {
        return None;
    }
    let lower = match key {
        Key::Character(text) => Key::Character(text.to_lowercase()),
        Key::Named(named) => Key::Named(*named),
        _ => return None,
    };
    let same = |bound: &Key<&str>| match (bound, &lower) {
        (Key::Character(bound), Key::Character(typed)) => *bound == typed,
        (Key::Named(bound), Key::Named(typed)) => bound == typed,
        _ => false,
    };
    let found = |binding: &'static Binding| Some((binding, binding.keys.iter().position(same)?));
    let (binding, place) = BINDINGS.iter().find_map(found)?;
    let action = match binding.action {
        Action::ShowScene { .. } => Action::ShowScene { place },
        Action::ChangeView { forward } => Action::ChangeView { forward: forward != held.shift_key() },
        other => other,
    };
    (binding.repeats || !repeated).then_some(action)
}

/// The row of the table that has this action.
pub fn binding_of(action: Action) -> Option<&'static Binding> {
    BINDINGS.iter().find(|binding| binding.action == action)
}

/// The keys as the rows of README's table.
pub fn markdown_table() -> String {
    let mut text = String::from("| key | what it does |\n|---|---|\n");
    for binding in BINDINGS {
        text.push_str(&format!("| {} | {} |\n", binding.written, binding.meaning));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_is_bound_twice() {
        let all: Vec<_> = BINDINGS.iter().flat_map(|binding| binding.keys).collect();
        for (index, key) in all.iter().enumerate() {
            assert!(!all[..index].contains(key), "{key:?} stands twice");
        }
    }

    #[test]
    fn letters_work_with_caps_lock_and_only_some_keys_repeat() {
        let action =
            |key: &str, repeated| action_of(&Key::Character(key.into()), repeated, ModifiersState::empty());
        assert_eq!(action("M", false), Some(Action::ToggleMute));
        assert_eq!(action("m", true), None);
        assert_eq!(action("ß", false), None);
        assert_eq!(
            ["1", "9", "0"].map(|key| action(key, false)),
            [0, 8, 9].map(|place| Some(Action::ShowScene { place }))
        );
        let left = action_of(&Key::Named(NamedKey::ArrowLeft), true, ModifiersState::empty());
        assert_eq!(left, Some(Action::Seek(-SEEK_SECONDS)));
        // With caps lock on, V is typed as with Shift.
        assert_eq!(action("V", false), Some(Action::ChangeView { forward: true }));
        let back = action_of(&Key::Character("V".into()), false, ModifiersState::SHIFT);
        assert_eq!(back, Some(Action::ChangeView { forward: false }));
    }

    #[test]
    fn keys_with_ctrl_or_alt_are_no_letters() {
        let key = Key::Character("s".into());
        assert_eq!(action_of(&key, false, ModifiersState::empty()), Some(Action::ToggleShuffle));
        for held in
            [ModifiersState::CONTROL, ModifiersState::ALT, ModifiersState::SUPER | ModifiersState::SHIFT]
        {
            assert_eq!(action_of(&key, false, held), None, "{held:?}");
        }
    }

    #[test]
    fn the_words_of_a_seek_name_its_length() {
        for binding in BINDINGS {
            if let Action::Seek(seconds) = binding.action {
                assert!(binding.meaning.contains(&format!("{} s", seconds.abs())), "{}", binding.meaning);
            }
        }
    }
}
