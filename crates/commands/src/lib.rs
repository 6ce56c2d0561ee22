//! The commands of Mariana: one [`Command`] for each thing a user can ask for, and one table with its keys, controller
//! name and help text.
//!
//! Keys, buttons, the settings panel, OSC, MIDI, phones, media keys and dropped files all send commands, and the show
//! carries them out in one function (`session::carrying_out`). The key help, the key table in `docs/reference.md`, the
//! OSC addresses, the MIDI targets and the buttons of the phone page are made from the table.
//!
//! A new command needs two edits: a row in the table (`table.rs`), and a match arm in `session::carrying_out`.
//!
//! ```
//! use mariana_commands::input::{Key, Modifiers};
//! use mariana_commands::{Command, Switch};
//! use mariana_control::action::{Action, ActionValue};
//!
//! let typed = Command::of_key(&Key::Character("m".to_owned()), Modifiers::empty(), false);
//! assert_eq!(typed, Some(Command::Mute(Switch::Toggle)));
//! let sent = Command::of_controller(&Action { name: "mute", given: ActionValue::Number(1.0) });
//! assert_eq!(sent, Some(Command::Mute(Switch::On)));
//! ```

mod binding;
#[macro_use]
mod define;
pub mod input;
mod state;
mod table;
mod values;
mod video;

use std::sync::OnceLock;

pub use binding::Binding;
pub use state::{ShowState, SnapshotKeys};
pub use table::{Command, ROWS};
pub use values::{
    Bind, CROSSFADE_STEP, Delay, Files, MovedCorner, SEEK_SECONDS, SHIFT_STEP_MS, SetSetting, TurnedNumbers,
    VOLUME_STEP,
};

pub use video::{Edge, JobAction, Mark, VideoChoice, VideoEdit};

use crate::input::{Key, KeyPress, Modifiers};
use mariana_control::action::{Action, ActionRow, ActionValue, ValueType};

/// A new state for a switch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Switch {
    /// On.
    On,
    /// Off.
    Off,
    /// The opposite of the current state.
    Toggle,
}

impl Switch {
    /// Returns the new state of a switch whose current state is `on`.
    pub fn applied_to(self, on: bool) -> bool {
        match self {
            Self::On => true,
            Self::Off => false,
            Self::Toggle => !on,
        }
    }
}

impl From<bool> for Switch {
    fn from(on: bool) -> Self {
        if on { Self::On } else { Self::Off }
    }
}

/// A panel over the image. Only one is open at a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Panel {
    /// The track list.
    Tracks,
    /// The audio sources.
    Sources,
    /// The list of scenes.
    Scenes,
    /// The file browser.
    Files,
    /// The settings.
    Settings,
    /// The scene editor.
    Editor,
    /// MIDI, OSC, phones and their mappings.
    Controllers,
    /// The corners of the image on the screen.
    Corners,
    /// The entries of the show.
    Cues,
    /// The videos of the song.
    Video,
}

/// A group of keys in the help and in `docs/reference.md`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Group {
    /// Songs, sound and the window.
    Playing,
    /// Choosing and editing scenes.
    Scenes,
    /// Changing the look of a scene.
    Looks,
    /// Performing for an audience.
    Stage,
    /// Looking at how the image is made.
    Developers,
}

impl Group {
    /// All groups, in the order of the help.
    pub const ALL: [Self; 5] = [Self::Playing, Self::Scenes, Self::Looks, Self::Stage, Self::Developers];

    /// The heading of the group.
    pub fn name(self) -> &'static str {
        match self {
            Self::Playing => "Playing",
            Self::Scenes => "Scenes",
            Self::Looks => "Looks",
            Self::Stage => "Stage",
            Self::Developers => "For developers",
        }
    }
}

/// The title or number by which a controller names a scene.
#[derive(Debug, Clone, PartialEq)]
pub enum SceneName {
    /// The title.
    Title(String),
    /// The number in the list of scenes, counted from 1. Marked scenes come first.
    Number(usize),
}

/// The origin of a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sender {
    /// A key, the pointer, or a dropped file.
    Window,
    /// A controller: MIDI, OSC or a phone. A phone may send only the rows that [`Row::for_phones`] allows.
    Controller,
    /// Media keys and the desktop's media player controls.
    Desktop,
}

/// The kind of value that a controller sends for a command, and the function that makes the command.
#[derive(Debug, Clone, Copy)]
pub enum Control {
    /// A button without a value.
    Press(fn() -> Command),
    /// On or off. Without a value, the switch toggles. The second field returns the switch's state.
    Switch(fn(Switch) -> Command, fn(&ShowState) -> bool),
    /// A value from 0 to 1. The second field returns the present value, if there is one.
    Level(fn(f32) -> Command, fn(&ShowState) -> Option<f32>),
    /// A number in the command's unit. Without a value, the default in the second field applies, if there is one.
    Number(fn(f32) -> Command, Option<f32>),
    /// A scene.
    Scene(fn(SceneName) -> Command),
    /// A number from 1; the second field is the number of pads that are offered for it.
    Numbered(fn(usize) -> Command, u8),
}

/// A command's entry in the table.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    /// The name in OSC addresses, MIDI mappings and phone requests, and the value that controllers send. Never change the
    /// name: users' files contain it. It is empty if only the desktop sends values.
    pub control: Option<(&'static str, Control)>,
    /// The keys of the command.
    pub bindings: &'static [Binding],
    /// The group of the keys in the help.
    pub group: Group,
    /// The help text of a command without keys.
    pub help: &'static str,
    /// True if phones may send the command. Phones must not cause files to be written.
    pub for_phones: bool,
}

impl Row {
    /// The defaults of a row: without keys and a name, only panels send the command.
    pub const PLAIN: Self =
        Self { control: None, bindings: &[], group: Group::Playing, help: "", for_phones: true };

    fn named(&self) -> Option<(&'static str, Control)> {
        self.control.filter(|(name, _)| !name.is_empty())
    }

    fn for_controllers(&self) -> Option<ActionRow> {
        let (name, control) = self.named()?;
        let takes = match control {
            Control::Press(_) => ValueType::Press,
            Control::Switch(..) => ValueType::Switch,
            Control::Level(..) => ValueType::Level,
            Control::Number(..) => ValueType::Number,
            Control::Scene(_) => ValueType::Choice,
            Control::Numbered(_, most) => ValueType::Index(most),
        };
        Some(ActionRow { name, takes, meaning: self.words() })
    }

    /// Returns the help text.
    pub fn words(&self) -> &'static str {
        self.bindings.first().map_or(self.help, |binding| binding.help)
    }
}

impl Command {
    /// Returns the command for a controller's action, or `None` if the name is unknown or the value does not fit.
    pub fn of_controller(action: &Action) -> Option<Self> {
        let (_, control) =
            ROWS.iter().find_map(|row| row.named().filter(|(name, _)| *name == action.name))?;
        let number = match action.given {
            ActionValue::Number(number) => Some(number),
            ActionValue::Nothing | ActionValue::Text(_) => None,
        };
        Some(match control {
            Control::Press(command) => command(),
            Control::Switch(command, _) => {
                command(number.map_or(Switch::Toggle, |number| Switch::from(number >= 0.5)))
            }
            Control::Level(command, _) => command(number?),
            Control::Number(command, default) => command(number.or(default)?),
            Control::Scene(command) => command(match &action.given {
                ActionValue::Text(title) => SceneName::Title(title.clone()),
                ActionValue::Number(number) => SceneName::Number(number.round().max(0.0) as usize),
                ActionValue::Nothing => return None,
            }),
            Control::Numbered(command, _) => command(match &action.given {
                ActionValue::Text(text) => text.trim().parse().ok()?,
                ActionValue::Number(number) => number.round().max(0.0) as usize,
                ActionValue::Nothing => return None,
            }),
        })
    }

    /// Returns the command for a key press. `repeated` is true for the repeats of a held key. Returns `None` while
    /// Ctrl, Alt or Super is held: these keys belong to the desktop.
    pub fn of_key(key: &Key, held: Modifiers, repeated: bool) -> Option<Self> {
        if held.intersects(Modifiers::CONTROL | Modifiers::ALT | Modifiers::SUPER) {
            return None;
        }
        let lower = match key {
            Key::Character(text) => text.to_lowercase(),
            Key::Named(_) | Key::Other => String::new(),
        };
        let same = |bound: &Key<&str>| match (bound, key) {
            (Key::Character(bound), Key::Character(_)) => *bound == lower,
            (Key::Named(bound), Key::Named(pressed)) => bound == pressed,
            _ => false,
        };
        let (binding, place) = bindings()
            .find_map(|binding| Some((binding, binding.keys.iter().position(|(bound, _)| same(bound))?)))?;
        if repeated && !binding.repeats {
            return None;
        }
        let shifted = binding.shifted.as_ref().filter(|_| held.contains(Modifiers::SHIFT) && place == 0);
        shifted.or(binding.keys.get(place).map(|(_, command)| command)).cloned()
    }

    /// Returns the command for a key press, including commands of Shift and a digit key.
    pub fn of_press(press: &KeyPress, held: Modifiers) -> Option<Self> {
        let digit = press.latin.and_then(|latin| latin.to_digit(10)).filter(|_| held == Modifiers::SHIFT);
        let of_digit = |digit: u32| {
            // On some keyboards, digits need Shift: there the digit has its own command.
            let command = bindings().find_map(|binding| binding.digits)?;
            (!press.repeat).then(|| command(digit as usize))
        };
        Self::of_key(&press.key, held, press.repeat).or_else(|| digit.and_then(of_digit))
    }

    /// Returns the binding with a key that sends exactly this command.
    pub fn binding(&self) -> Option<&'static Binding> {
        self.row().bindings.iter().find(|binding| binding.keys.iter().any(|(_, bound)| bound == self))
    }

    /// Returns true if the command sets a switch to the state that the switch already has.
    pub fn is_done_already(&self, state: impl FnOnce() -> ShowState) -> bool {
        match self.row().control {
            Some((_, Control::Switch(command, is_on))) => *self == command(Switch::from(is_on(&state()))),
            _ => false,
        }
    }
}

/// Returns the named commands. MIDI and OSC may send only these.
pub fn for_controllers() -> &'static [ActionRow] {
    static TABLE: OnceLock<Vec<ActionRow>> = OnceLock::new();
    TABLE.get_or_init(|| ROWS.iter().filter_map(Row::for_controllers).collect())
}

/// Returns the named commands that phones may send.
pub fn for_phones() -> &'static [ActionRow] {
    static TABLE: OnceLock<Vec<ActionRow>> = OnceLock::new();
    TABLE.get_or_init(|| ROWS.iter().filter(|row| row.for_phones).filter_map(Row::for_controllers).collect())
}

/// Returns the named switches with their states.
pub fn switches(state: &ShowState) -> Vec<(&'static str, bool)> {
    let state_of = |row: &Row| match row.named()? {
        (name, Control::Switch(_, is_on)) => Some((name, is_on(state))),
        _ => None,
    };
    ROWS.iter().filter_map(state_of).collect()
}

/// Returns the values, 0..1, of the named levels. Leaves out levels that have no value now.
pub fn levels(state: &ShowState) -> Vec<(&'static str, f32)> {
    let value_of = |row: &Row| match row.named()? {
        (name, Control::Level(_, level)) => Some((name, level(state)?)),
        _ => None,
    };
    ROWS.iter().filter_map(value_of).collect()
}

/// Returns all key bindings, in the order of the table.
pub fn bindings() -> impl Iterator<Item = &'static Binding> {
    ROWS.iter().flat_map(|row| row.bindings)
}

/// Returns the key bindings of a group, in the order of the help.
pub fn bindings_of(group: Group) -> impl Iterator<Item = &'static Binding> {
    let of_row = move |row: &'static Row| {
        row.bindings.iter().filter(move |binding| binding.group.unwrap_or(row.group) == group)
    };
    ROWS.iter().flat_map(of_row)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::NamedKey;

    fn pressed(key: &str, held: Modifiers, repeated: bool) -> Option<Command> {
        Command::of_key(&Key::Character(key.to_owned()), held, repeated)
    }

    const NONE: Modifiers = Modifiers::empty();

    #[test]
    fn no_key_is_bound_twice() {
        let all: Vec<_> = bindings().flat_map(|binding| binding.keys).map(|(key, _)| *key).collect();
        for (index, key) in all.iter().enumerate() {
            assert!(!all[..index].contains(key), "{key:?} is bound twice");
        }
    }

    #[test]
    fn every_binding_is_in_one_group_and_has_a_command() {
        let grouped: usize = Group::ALL.into_iter().map(|group| bindings_of(group).count()).sum();
        assert_eq!(grouped, bindings().count());
        for binding in bindings() {
            assert!(binding.command().is_some(), "{}", binding.written);
        }
    }

    #[test]
    fn letters_work_with_caps_lock_and_only_some_keys_repeat() {
        assert_eq!(pressed("M", NONE, false), Some(Command::Mute(Switch::Toggle)));
        assert_eq!(pressed("m", NONE, true), None);
        assert_eq!(["ß", "ab"].map(|key| pressed(key, NONE, false)), [None, None]);
        assert_eq!(
            ["1", "9", "0"].map(|key| pressed(key, NONE, false)),
            [0, 8, 9].map(|place| Some(Command::SceneAt(place)))
        );
        let left = Command::of_key(&Key::Named(NamedKey::ArrowLeft), NONE, true);
        assert_eq!(left, Some(Command::SeekBy(-SEEK_SECONDS)));
        // With Caps Lock on, the V key types "V" without Shift.
        assert_eq!(pressed("V", NONE, false), Some(Command::NextView));
        assert_eq!(pressed("V", Modifiers::SHIFT, false), Some(Command::PreviousView));
    }

    #[test]
    fn shift_and_a_digit_key_recall_a_snapshot() {
        let press = |text: &str, latin, repeat| KeyPress {
            key: Key::Character(text.to_owned()),
            latin,
            text: None,
            repeat,
        };
        let of = |press: &KeyPress, held| Command::of_press(press, held);
        assert_eq!(of(&press("!", Some('1'), false), Modifiers::SHIFT), Some(Command::Snapshot(1)));
        assert_eq!(of(&press("!", Some('1'), true), Modifiers::SHIFT), None);
        assert_eq!(of(&press("1", Some('1'), false), NONE), Some(Command::SceneAt(0)));
        assert_eq!(of(&press("!", Some('1'), false), Modifiers::SHIFT | Modifiers::ALT), None);
        // On a French keyboard, Shift types the digits.
        assert_eq!(of(&press("1", Some('1'), false), Modifiers::SHIFT), Some(Command::SceneAt(0)));
        assert_eq!(of(&press("V", Some('v'), false), Modifiers::SHIFT), Some(Command::PreviousView));
    }

    #[test]
    fn keys_with_ctrl_or_alt_are_no_letters() {
        assert_eq!(pressed("s", NONE, false), Some(Command::Shuffle(Switch::Toggle)));
        for held in [Modifiers::CONTROL, Modifiers::ALT, Modifiers::SUPER | Modifiers::SHIFT] {
            assert_eq!(pressed("s", held, false), None, "{held:?}");
        }
    }

    #[test]
    fn seek_help_names_the_seconds() {
        for (binding, (_, command)) in bindings().flat_map(|b| b.keys.iter().map(move |key| (b, key))) {
            if let Command::SeekBy(seconds) = command {
                assert!(binding.help.contains(&format!("{} s", seconds.abs())), "{}", binding.help);
            }
        }
    }

    #[test]
    fn names_are_unique_valid_in_addresses_and_have_help() {
        let rows = for_controllers();
        assert!(rows.len() > 20, "{}", rows.len());
        for (place, row) in rows.iter().enumerate() {
            assert!(row.name.chars().all(|c| c.is_ascii_lowercase() || c == '_'), "{}", row.name);
            assert!(!row.meaning.is_empty(), "{} has no help text", row.name);
            assert!(rows[..place].iter().all(|other| other.name != row.name), "{} appears twice", row.name);
            assert!(
                !["param", "query", "sound"].contains(&row.name),
                "{} is reserved for another OSC address",
                row.name
            );
        }
    }

    #[test]
    fn phones_cannot_start_a_recording() {
        assert!(for_controllers().iter().any(|row| row.name == "record"));
        assert!(for_phones().iter().all(|row| row.name != "record"));
    }

    #[test]
    fn a_switch_already_in_the_requested_state_is_done() {
        let action = |given| Action { name: "pause", given };
        let pause = |given| Command::of_controller(&action(given)).unwrap();
        let (playing, paused) = (ShowState::default(), ShowState { paused: true, ..ShowState::default() });
        assert!(pause(ActionValue::Number(1.0)).is_done_already(|| paused));
        assert!(!pause(ActionValue::Number(1.0)).is_done_already(|| playing));
        assert!(pause(ActionValue::Number(0.0)).is_done_already(|| playing));
        assert!(!pause(ActionValue::Nothing).is_done_already(|| playing));
        assert!(!pause(ActionValue::Nothing).is_done_already(|| paused));
    }

    #[test]
    fn values_become_commands_or_are_ignored() {
        let of = |name, given| Command::of_controller(&Action { name, given });
        assert_eq!(of("next", ActionValue::Nothing), Some(Command::NextScene));
        assert_eq!(of("volume", ActionValue::Number(0.5)), Some(Command::Volume(0.5)));
        assert_eq!(of("tempo", ActionValue::Nothing), Some(Command::Tempo(0.0)));
        let orb = Command::Scene(SceneName::Title("orb".to_owned()));
        assert_eq!(of("scene", ActionValue::Text("orb".to_owned())), Some(orb));
        assert_eq!(of("scene", ActionValue::Number(3.0)), Some(Command::Scene(SceneName::Number(3))));
        assert_eq!(of("scene", ActionValue::Nothing), None);
        assert_eq!(of("no_such_name", ActionValue::Nothing), None);
        let text = |text: &str| ActionValue::Text(text.to_owned());
        assert_eq!(of("snapshot", ActionValue::Number(3.0)), Some(Command::Snapshot(3)));
        assert_eq!(of("snapshot", text("2")), Some(Command::Snapshot(2)));
        assert_eq!(of("snapshot", text("two")), None);
    }
}
