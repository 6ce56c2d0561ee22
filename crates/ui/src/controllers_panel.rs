//! The state of the controllers panel: parameters and actions, the MIDI controls mapped to them, and the phone page.
//! The overlay draws the panel. Keys and the pointer change it. Its commands go to the session.

mod rows;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use mariana_commands::input::{Key, NamedKey};

use rows::rows_of;
pub use rows::words_of;

use mariana_commands::Command;
use mariana_control::Slider;
use mariana_control::midi::{Curve, Encoding, Mapping, MidiState, Target};
use mariana_remote::{PairingAddress, RemoteState};
use mariana_settings::KnobEdit;

/// A row of the panel.
#[derive(Debug, Clone, PartialEq)]
pub enum ControllerRow {
    /// A line of text.
    Words {
        /// The text.
        text: String,
        /// True for an error.
        is_bad: bool,
    },
    /// The connection code for phones.
    Phone {
        /// The address and its QR code.
        pairing_address: Arc<PairingAddress>,
        /// Who can connect, or the number of connected phones.
        about: String,
    },
    /// The switch that lets MIDI clock set the tempo; true if it is on.
    Clock(bool),
    /// A parameter or an action to which a control can be mapped.
    Target {
        /// The mapping's target.
        target: Target,
        /// The target's display name.
        name: String,
        /// The parameter's value or the action's meaning.
        about: String,
        /// True while the panel waits for a control to map.
        learns: bool,
    },
    /// A mapping. Its row is below the row of its target.
    Knob {
        /// The mapping.
        mapping: Mapping,
        /// The control and its device, and a note if the device is not connected.
        words: String,
        /// The present position of the target parameter, 0..1; `None` if the shown scene lacks this parameter.
        stands: Option<f32>,
    },
}

/// An editable part of a mapping, from left to right.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MappingField {
    /// The position that the parameter takes at the lower end of the control.
    From,
    /// The position that the parameter takes at the upper end of the control.
    To,
    /// Swaps the positions for the two ends of the control.
    Invert,
    /// The response curve, a [`Curve`].
    Curve,
    /// The smoothing time.
    Smoothing,
    /// Soft takeover: the control acts only after it has passed the parameter's value. An encoder acts at once; a
    /// click makes it a knob that sends its position.
    PickUp,
    /// Removes the mapping.
    Remove,
}

impl MappingField {
    /// All parts, from left to right.
    pub const ALL: [Self; 7] =
        [Self::From, Self::To, Self::Invert, Self::Curve, Self::Smoothing, Self::PickUp, Self::Remove];

    /// The label of the part.
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
            Self::PickUp if mapping.is_in_steps() => "endless".to_owned(),
            Self::PickUp => (if mapping.picks_up { "picks up" } else { "jumps" }).to_owned(),
            Self::Remove => "forget".to_owned(),
        }
    }

    /// The end of the description of the part: the effect of a click.
    pub fn hint(self) -> &'static str {
        match self {
            Self::From | Self::To => " · a click sets this end to the parameter's present value",
            Self::PickUp => " · picks up: acts once the knob reaches the value · jumps: acts at once",
            _ => "",
        }
    }

    /// The command for a click or Enter on the part. `From` and `To` get `stands`, the parameter's position.
    pub fn request(self, mapping: &Mapping, stands: Option<f32>) -> Option<Command> {
        let mut after = mapping.clone();
        let [from, to] = &mut after.range;
        match self {
            Self::From => *from = stands?,
            Self::To => *to = stands?,
            Self::Invert => after.invert(),
            Self::Curve => after.curve = next(&Curve::ALL, after.curve),
            Self::Smoothing => after.smoothing = next(&SMOOTHINGS, after.smoothing),
            Self::PickUp if mapping.is_in_steps() => after.encoding = Some(Encoding::Absolute),
            Self::PickUp => after.picks_up = !after.picks_up,
            Self::Remove => return Some(Command::EditMappings(KnobEdit::Remove(after))),
        }
        Some(Command::EditMappings(KnobEdit::Change(mapping.clone(), after)))
    }
}

/// The smoothing times on offer, in seconds.
const SMOOTHINGS: [f32; 7] = [0.0, 0.05, 0.1, 0.25, 0.5, 1.0, 2.0];

/// Returns the value after `present` in `all`. After the last value or an unlisted value, returns the first value.
fn next<T: Copy + PartialEq>(all: &[T], present: T) -> T {
    let place = all.iter().position(|one| *one == present).map_or(0, |place| (place + 1) % all.len().max(1));
    all.get(place).copied().unwrap_or(present)
}

/// The state of the phone page.
#[derive(Debug, Clone, PartialEq)]
pub struct PhoneFacts {
    /// The server's state.
    pub state: RemoteState,
    /// The number of connected phones.
    pub phones: usize,
}

/// The state from which the rows are made.
pub struct ControllersState<'a> {
    /// The title of the shown scene.
    pub scene: String,
    /// The parameters of the shown scene.
    pub sliders: &'a [Slider],
    /// The state of OSC in words; `None` if it is off.
    pub osc: Option<String>,
    /// The state of the phone page; `None` if it is off.
    pub phone: Option<PhoneFacts>,
    /// The state of MIDI; `None` if it is off.
    pub midi: Option<MidiState>,
    /// True if a device's clock sets the tempo.
    pub clock: bool,
    /// The tempo that MIDI clock sets, in beats per minute.
    pub clock_tempo: Option<f64>,
    /// Received messages, and how many of them were ignored.
    pub counts: (u64, u64),
    /// All mappings.
    pub mappings: &'a [Mapping],
    /// The target to which the next moved control is mapped.
    pub learning: Option<&'a Target>,
}

/// The panel's rows and selection.
#[derive(Debug, Default)]
pub struct ControllersPanel {
    /// The rows, from the top.
    pub rows: Vec<ControllerRow>,
    /// The index of the selected row.
    pub selected: usize,
    field: usize,
    /// A number that grows whenever the rows change.
    pub revision: u64,
}

impl ControllersPanel {
    /// The selected part of a mapping.
    pub fn field(&self) -> MappingField {
        MappingField::ALL.get(self.field).copied().unwrap_or(MappingField::From)
    }

    /// Updates the rows.
    pub fn update(&mut self, facts: &ControllersState<'_>) {
        let rows = rows_of(facts);
        if rows != self.rows {
            // Keep the same item selected when its row moves.
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

    /// Handles a key. Returns the key's commands; `None` for a key that belongs to the show.
    pub fn handle_key(&mut self, key: &Key) -> Option<Vec<Command>> {
        let Key::Named(named) = key else { return None };
        let row = self.rows.get(self.selected);
        match named {
            NamedKey::ArrowDown => self.select_from(self.selected + 1, true),
            NamedKey::ArrowUp => {
                if let Some(above) = self.selected.checked_sub(1) {
                    self.select_from(above, false);
                }
            }
            NamedKey::ArrowLeft | NamedKey::ArrowRight if matches!(row, Some(ControllerRow::Knob { .. })) => {
                let last = MappingField::ALL.len() - 1;
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
                return Some(Vec::from_iter(request));
            }
            NamedKey::Delete | NamedKey::Backspace => {
                let Some(ControllerRow::Knob { mapping, .. }) = row else { return Some(Vec::new()) };
                return Some(vec![Command::EditMappings(KnobEdit::Remove(mapping.clone()))]);
            }
            _ => return None,
        }
        Some(Vec::new())
    }

    /// Selects the first changeable row at or below `place` if `down`, otherwise at or above `place`, if there is one.
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

/// True if two rows are about the same item, even if their texts differ.
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
