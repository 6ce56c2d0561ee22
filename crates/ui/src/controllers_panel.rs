//! The panel of knobs from outside: what can be turned, by what it is turned, and how that is changed.
//!
//! It is a plain value: the overlay draws it, keys and pointer change it, and what they ask for is done by the stage.

mod rows;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use mariana_commands::input::{Key, NamedKey};

use rows::rows_of;
pub use rows::words_of;

use mariana_commands::Command;
use mariana_control::Slider;
use mariana_control::midi::{Curve, Mapping, MidiState, Target};
use mariana_remote::{PairingAddress, RemoteState};
use mariana_settings::KnobEdit;

/// A row of the panel.
#[derive(Debug, Clone, PartialEq)]
pub enum ControllerRow {
    /// Words alone.
    Words {
        /// The words.
        text: String,
        /// Whether they are bad news.
        is_bad: bool,
    },
    /// By what a phone comes.
    Phone {
        /// The address and its code.
        pairing_address: Arc<PairingAddress>,
        /// What there is to say of it.
        about: String,
    },
    /// Whether a device's clock sets the tempo.
    Clock(bool),
    /// Something that can be turned.
    Target {
        /// What it is.
        target: Target,
        /// What people call it.
        name: String,
        /// How it stands, or what it does.
        about: String,
        /// Whether a knob is being learned for it.
        learns: bool,
    },
    /// What turns the thing above it.
    Knob {
        /// The mapping.
        mapping: Mapping,
        /// What it is, in words.
        words: String,
        /// Where the parameter stands, 0..1, if it is one of the scene on the stage.
        stands: Option<f32>,
    },
}

/// What can be changed of a mapping, from the left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Field {
    /// Where the knob's lower end leads.
    From,
    /// Where its upper end leads.
    To,
    /// The other way around.
    Invert,
    /// See [`Curve`].
    Curve,
    /// The smoothing time.
    Smoothing,
    /// Whether it takes hold only where it passes.
    PickUp,
    /// To forget it.
    Remove,
}

impl Field {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::From, Self::To, Self::Invert, Self::Curve, Self::Smoothing, Self::PickUp, Self::Remove];

    /// What it says of a mapping.
    pub fn words(self, mapping: &Mapping) -> String {
        let [from, to] = mapping.range;
        let end = |end: f32| {
            if matches!(mapping.target, Target::Action { .. }) && end > 1.0 {
                format!("{end:.0}")
            } else {
                format!("{:.0} %", 100.0 * end)
            }
        };
        match self {
            Self::From => format!("from {}", end(from)),
            Self::To => format!("to {}", end(to)),
            Self::Invert => "invert".to_owned(),
            Self::Curve => mapping.curve.name().to_owned(),
            Self::Smoothing if mapping.smoothing == 0.0 => "at once".to_owned(),
            Self::Smoothing => format!("{} s", mapping.smoothing),
            Self::PickUp => (if mapping.picks_up { "picks up" } else { "jumps" }).to_owned(),
            Self::Remove => "forget".to_owned(),
        }
    }

    /// The command that a click or Enter on it sends, where the parameter stands there.
    pub fn request(self, mapping: &Mapping, stands: Option<f32>) -> Option<Command> {
        let mut after = mapping.clone();
        let [from, to] = &mut after.range;
        match self {
            Self::From => *from = stands?,
            Self::To => *to = stands?,
            Self::Invert => after.invert(),
            Self::Curve => after.curve = next(&Curve::ALL, after.curve),
            Self::Smoothing => after.smoothing = next(&SMOOTHINGS, after.smoothing),
            Self::PickUp => after.picks_up = !after.picks_up,
            Self::Remove => return Some(Command::EditMappings(KnobEdit::Remove(after))),
        }
        Some(Command::EditMappings(KnobEdit::Change(mapping.clone(), after)))
    }
}

/// Smoothing times that are offered, in seconds.
const SMOOTHINGS: [f32; 7] = [0.0, 0.05, 0.1, 0.25, 0.5, 1.0, 2.0];

/// The value behind one of a list; the first behind the last, and for one that is not in it.
fn next<T: Copy + PartialEq>(all: &[T], present: T) -> T {
    let place = all.iter().position(|one| *one == present).map_or(0, |place| (place + 1) % all.len().max(1));
    all.get(place).copied().unwrap_or(present)
}

/// The page for phones.
#[derive(Debug, Clone, PartialEq)]
pub struct PhoneFacts {
    /// How it stands.
    pub state: RemoteState,
    /// How many phones there are.
    pub phones: usize,
}

/// What holds at present.
pub struct ControllersState<'a> {
    /// The title of the scene on the stage.
    pub scene: String,
    /// Its parameters.
    pub sliders: &'a [Slider],
    /// How it stands with OSC; none if it is not wanted.
    pub osc: Option<String>,
    /// How it stands with the page for phones; none if it is not wanted.
    pub phone: Option<PhoneFacts>,
    /// How it stands with MIDI; none if it is not wanted.
    pub midi: Option<MidiState>,
    /// Whether a device's clock sets the tempo.
    pub clock: bool,
    /// The tempo of the clock that is followed.
    pub clock_tempo: Option<f64>,
    /// Messages that came, and those that were ignored.
    pub counts: (u64, u64),
    /// What is mapped.
    pub mappings: &'a [Mapping],
    /// What is being learned.
    pub learning: Option<&'a Target>,
}

/// See the module.
#[derive(Debug, Default)]
pub struct ControllersPanel {
    rows: Vec<ControllerRow>,
    selected: usize,
    field: usize,
    revision: u64,
}

impl ControllersPanel {
    /// The rows, from the top.
    pub fn rows(&self) -> &[ControllerRow] {
        &self.rows
    }

    /// The place of the row that keys change.
    pub fn selected(&self) -> usize {
        self.selected
    }

    /// What of that row keys change, if it is a mapping.
    pub fn field(&self) -> Field {
        Field::ALL.get(self.field).copied().unwrap_or(Field::From)
    }

    /// A number that changes with what there is to see.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Brings the rows up to date.
    pub fn update(&mut self, facts: &ControllersState<'_>) {
        let rows = rows_of(facts);
        if rows != self.rows {
            // The same thing stays selected, wherever it is now.
            let before = self.rows.get(self.selected);
            let same = before.and_then(|before| rows.iter().position(|row| is_same(row, before)));
            self.selected = same.unwrap_or(self.selected);
            self.rows = rows;
            self.revision += 1;
        }
        if !self.rows.get(self.selected).is_some_and(is_changeable) {
            self.select_from(0, true);
        }
    }

    /// Takes a key. Returns whether it is the panel's, and the command that it sends.
    pub fn take_key(&mut self, key: &Key) -> (bool, Option<Command>) {
        let Key::Named(named) = key else { return (false, None) };
        let row = self.rows.get(self.selected);
        match named {
            NamedKey::ArrowDown => self.select_from(self.selected + 1, true),
            NamedKey::ArrowUp => {
                if let Some(above) = self.selected.checked_sub(1) {
                    self.select_from(above, false);
                }
            }
            NamedKey::ArrowLeft | NamedKey::ArrowRight if matches!(row, Some(ControllerRow::Knob { .. })) => {
                let last = Field::ALL.len() - 1;
                self.field = match named {
                    NamedKey::ArrowLeft => self.field.saturating_sub(1),
                    _ => (self.field + 1).min(last),
                };
            }
            NamedKey::Enter => {
                let request = match row {
                    Some(ControllerRow::Target { target, .. }) => Some(Command::Learn(target.clone())),
                    Some(ControllerRow::Clock(on)) => Some(Command::EditMappings(KnobEdit::Clock(!on))),
                    Some(ControllerRow::Knob { mapping, stands, .. }) => {
                        self.field().request(mapping, *stands)
                    }
                    Some(ControllerRow::Words { .. } | ControllerRow::Phone { .. }) | None => None,
                };
                return (true, request);
            }
            NamedKey::Delete | NamedKey::Backspace => {
                let Some(ControllerRow::Knob { mapping, .. }) = row else { return (true, None) };
                return (true, Some(Command::EditMappings(KnobEdit::Remove(mapping.clone()))));
            }
            _ => return (false, None),
        }
        self.revision += 1;
        (true, None)
    }

    /// Selects the next row that can be changed, from a place on, downwards or upwards; none leaves the selection.
    fn select_from(&mut self, place: usize, down: bool) {
        let found = if down {
            self.rows.iter().enumerate().skip(place).find(|(_, row)| is_changeable(row))
        } else {
            self.rows.iter().enumerate().take(place + 1).rfind(|(_, row)| is_changeable(row))
        };
        if let Some((found, _)) = found {
            self.selected = found;
        }
    }
}

/// Whether two rows are about the same thing, whatever they say of it.
fn is_same(a: &ControllerRow, b: &ControllerRow) -> bool {
    match (a, b) {
        (ControllerRow::Clock(_), ControllerRow::Clock(_)) => true,
        (ControllerRow::Target { target: a, .. }, ControllerRow::Target { target: b, .. }) => a == b,
        (ControllerRow::Knob { mapping: a, .. }, ControllerRow::Knob { mapping: b, .. }) => {
            (&a.device, a.source, &a.target) == (&b.device, b.source, &b.target)
        }
        _ => false,
    }
}

fn is_changeable(row: &ControllerRow) -> bool {
    !matches!(row, ControllerRow::Words { .. } | ControllerRow::Phone { .. })
}
