//! The panel of knobs from outside: what can be turned, by what it is turned, and how that is changed.
//!
//! It is a plain value: the overlay draws it, keys and pointer change it, and what they ask for is done by the stage.

use winit::keyboard::{Key, NamedKey};

use super::deeds;
use super::midi::words_of;
use crate::app::overlay::Slider;
use mariana_control::Param;
use mariana_control::deed::Takes;
use mariana_control::midi::{Curve, Mapping, MidiState, Target};

/// A row of the panel.
#[derive(Debug, Clone, PartialEq)]
pub enum HandRow {
    /// Words alone.
    Words {
        /// The words.
        text: String,
        /// Whether they are bad news.
        is_bad: bool,
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

/// What is asked of the panel.
#[derive(Debug, Clone, PartialEq)]
pub enum HandsRequest {
    /// To learn what turns this, or to stop.
    Learn(Target),
    /// To change the first mapping into the second.
    Change(Mapping, Mapping),
    /// To forget a mapping.
    Remove(Mapping),
    /// To let a device's clock set the tempo, or not.
    Clock(bool),
    /// To close the panel.
    Close,
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
            if matches!(mapping.target, Target::Deed { .. }) && end > 1.0 {
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

    /// What a click or Enter on it asks for, where the parameter stands there.
    pub fn request(self, mapping: &Mapping, stands: Option<f32>) -> Option<HandsRequest> {
        let mut after = mapping.clone();
        let [from, to] = &mut after.range;
        match self {
            Self::From => *from = stands?,
            Self::To => *to = stands?,
            Self::Invert => after.invert(),
            Self::Curve => after.curve = next(&Curve::ALL, after.curve),
            Self::Smoothing => after.smoothing = next(&SMOOTHINGS, after.smoothing),
            Self::PickUp => after.picks_up = !after.picks_up,
            Self::Remove => return Some(HandsRequest::Remove(after)),
        }
        Some(HandsRequest::Change(mapping.clone(), after))
    }
}

/// Smoothing times that are offered, in seconds.
const SMOOTHINGS: [f32; 7] = [0.0, 0.05, 0.1, 0.25, 0.5, 1.0, 2.0];

/// The value behind one of a list; the first behind the last, and for one that is not in it.
fn next<T: Copy + PartialEq>(all: &[T], present: T) -> T {
    let place = all.iter().position(|one| *one == present).map_or(0, |place| (place + 1) % all.len().max(1));
    all.get(place).copied().unwrap_or(present)
}

/// What holds at present.
pub(in crate::app) struct HandFacts<'a> {
    /// The title of the scene on the stage.
    pub scene: String,
    /// Its parameters.
    pub sliders: &'a [Slider],
    /// How it stands with OSC; none if it is not wanted.
    pub osc: Option<String>,
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
pub struct HandsPanel {
    rows: Vec<HandRow>,
    selected: usize,
    field: usize,
    revision: u64,
}

impl HandsPanel {
    /// The rows, from the top.
    pub fn rows(&self) -> &[HandRow] {
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
    pub(in crate::app) fn update(&mut self, facts: &HandFacts<'_>) {
        let rows = rows_of(facts);
        if rows != self.rows {
            self.rows = rows;
            self.revision += 1;
        }
        if !self.rows.get(self.selected).is_some_and(is_changeable) {
            self.select_from(0, true);
        }
    }

    /// Takes a key. Returns whether it is the panel's, and what it asks for.
    pub fn take_key(&mut self, key: &Key) -> (bool, Option<HandsRequest>) {
        let Key::Named(named) = key else { return (false, None) };
        let row = self.rows.get(self.selected);
        match named {
            NamedKey::ArrowDown => self.select_from(self.selected + 1, true),
            NamedKey::ArrowUp => {
                if let Some(above) = self.selected.checked_sub(1) {
                    self.select_from(above, false);
                }
            }
            NamedKey::ArrowLeft | NamedKey::ArrowRight if matches!(row, Some(HandRow::Knob { .. })) => {
                let last = Field::ALL.len() - 1;
                self.field = match named {
                    NamedKey::ArrowLeft => self.field.saturating_sub(1),
                    _ => (self.field + 1).min(last),
                };
            }
            NamedKey::Enter => {
                let request = match row {
                    Some(HandRow::Target { target, .. }) => Some(HandsRequest::Learn(target.clone())),
                    Some(HandRow::Clock(on)) => Some(HandsRequest::Clock(!on)),
                    Some(HandRow::Knob { mapping, stands, .. }) => self.field().request(mapping, *stands),
                    Some(HandRow::Words { .. }) | None => None,
                };
                return (true, request);
            }
            NamedKey::Delete | NamedKey::Backspace => {
                let Some(HandRow::Knob { mapping, .. }) = row else { return (true, None) };
                return (true, Some(HandsRequest::Remove(mapping.clone())));
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

fn is_changeable(row: &HandRow) -> bool {
    !matches!(row, HandRow::Words { .. })
}

fn rows_of(facts: &HandFacts<'_>) -> Vec<HandRow> {
    let words = |text: String| HandRow::Words { text, is_bad: false };
    let mut rows = vec![words(osc_words(facts))];
    rows.extend(midi_words(facts));
    if facts.midi.as_ref().is_some_and(|midi| midi.trouble.is_none()) {
        rows.push(HandRow::Clock(facts.clock));
    }
    let mut is_shown = vec![false; facts.mappings.len()];
    let mut add = |rows: &mut Vec<HandRow>, target: Target, name: String, about: String, stands| {
        let learns = facts.learning == Some(&target);
        let about = if learns { "move a knob, or press a key or a pad".to_owned() } else { about };
        rows.push(HandRow::Target { target: target.clone(), name, about, learns });
        let mapped = facts.mappings.iter().zip(&mut is_shown).filter(|(one, _)| one.target == target);
        rows.extend(mapped.map(|(mapping, is_shown)| {
            *is_shown = true;
            HandRow::Knob { mapping: mapping.clone(), words: knob_words(mapping, facts), stands }
        }));
    };
    if !facts.sliders.is_empty() {
        rows.push(words(format!("Parameters of {}", facts.scene)));
    }
    for slider in facts.sliders {
        let target = Target::Param { scene: facts.scene.clone(), name: slider.name.clone() };
        let param = Param { name: &slider.name, min: slider.min, max: slider.max, default: slider.default };
        let about = format!("{} · {}", slider.value_text(), slider.hand.name());
        add(&mut rows, target, slider.name.clone(), about, Some(param.share_of(slider.value)));
    }
    rows.push(words("Actions".to_owned()));
    for row in deeds::table() {
        let deed = |value: Option<String>| Target::Deed { name: row.name.to_owned(), value };
        if row.takes == Takes::Choice {
            let here = deed(Some(facts.scene.clone()));
            add(
                &mut rows,
                here,
                format!("{} {}", row.name, facts.scene),
                "this scene, by a pad".to_owned(),
                None,
            );
            add(&mut rows, deed(None), "scenes".to_owned(), "all, by program numbers".to_owned(), None);
        } else {
            add(&mut rows, deed(None), row.name.replace('_', " "), row.meaning.to_owned(), None);
        }
    }
    let others: Vec<&Mapping> =
        facts.mappings.iter().zip(&is_shown).filter(|(_, shown)| !**shown).map(|(one, _)| one).collect();
    if !others.is_empty() {
        rows.push(words("In other scenes".to_owned()));
    }
    rows.extend(others.into_iter().map(|mapping| HandRow::Knob {
        mapping: mapping.clone(),
        words: format!("{} · {}", words_of(&mapping.target), knob_words(mapping, facts)),
        stands: None,
    }));
    rows
}

fn osc_words(facts: &HandFacts<'_>) -> String {
    let osc = facts.osc.as_deref().unwrap_or("off; begin with --osc 9000");
    match facts.counts {
        (0, 0) => format!("OSC: {osc}"),
        (messages, 0) => format!("OSC: {osc} · {messages} messages came"),
        (messages, ignored) => format!("OSC: {osc} · {messages} messages came, {ignored} were ignored"),
    }
}

fn midi_words(facts: &HandFacts<'_>) -> Vec<HandRow> {
    let words = |text: String, is_bad| HandRow::Words { text, is_bad };
    let Some(midi) = &facts.midi else { return vec![words("MIDI: off (--midi off)".to_owned(), false)] };
    if let Some(trouble) = &midi.trouble {
        return vec![words(format!("MIDI: {trouble}"), true)];
    }
    let devices = match &midi.devices[..] {
        [] if !midi.is_known => "looking for devices".to_owned(),
        [] => "no device is there; plug one in".to_owned(),
        devices => devices.join(", "),
    };
    let mut rows = vec![words(format!("MIDI: {devices}"), false)];
    rows.extend(midi.refused.iter().map(|(name, why)| words(format!("{name} cannot be heard: {why}"), true)));
    if let (Some(device), Some(tempo)) = (&midi.clock_of, facts.clock_tempo) {
        rows.push(words(format!("The clock of {device}: {tempo:.1} beats per minute"), false));
    }
    rows
}

fn knob_words(mapping: &Mapping, facts: &HandFacts<'_>) -> String {
    let devices = facts.midi.as_ref().map(|midi| &midi.devices[..]).unwrap_or_default();
    let gone = if devices.contains(&mapping.device) { "" } else { ", which is not there" };
    format!("{} of {}{gone}", mapping.source, mapping.device)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_control::Hand;
    use mariana_control::midi::Source;

    fn slider() -> Slider {
        Slider { name: "size".into(), value: 1.0, min: 0.0, max: 4.0, default: 1.0, hand: Hand::Midi }
    }

    fn size() -> Target {
        Target::Param { scene: "orb".to_owned(), name: "size".to_owned() }
    }

    fn knob(target: Target) -> Mapping {
        Mapping::learned("desk", Source::Control { channel: 0, number: 7 }, target)
    }

    fn panel(mappings: &[Mapping], learning: Option<&Target>) -> HandsPanel {
        let midi = MidiState { devices: vec!["pads".to_owned()], is_known: true, ..MidiState::default() };
        let mut panel = HandsPanel::default();
        panel.update(&HandFacts {
            scene: "orb".to_owned(),
            sliders: &[slider()],
            osc: None,
            midi: Some(midi),
            clock: true,
            clock_tempo: None,
            counts: (7, 2),
            mappings,
            learning,
        });
        panel
    }

    fn key(named: NamedKey) -> Key {
        Key::Named(named)
    }

    #[test]
    fn everything_that_can_be_turned_has_a_row_with_what_turns_it_below() {
        let other = Target::Param { scene: "city".to_owned(), name: "fog".to_owned() };
        let panel = panel(&[knob(size()), knob(other)], None);
        let place = panel
            .rows()
            .iter()
            .position(|row| matches!(row, HandRow::Target { target, .. } if *target == size()));
        let below = &panel.rows()[place.unwrap() + 1];
        assert!(
            matches!(below, HandRow::Knob { words, stands: Some(0.25), .. }
                if words == "cc 7 on channel 1 of desk, which is not there"),
            "{below:?}"
        );
        let targets = panel.rows().iter().filter(|row| matches!(row, HandRow::Target { .. })).count();
        assert_eq!(targets, 1 + deeds::table().len() + 1);
        let last = panel.rows().last();
        assert!(
            matches!(last, Some(HandRow::Knob { words, .. }) if words.starts_with("fog in city")),
            "{last:?}"
        );
        let first = &panel.rows()[0];
        assert!(
            matches!(first, HandRow::Words { text, .. } if text.contains("7 messages came, 2 were ignored"))
        );
    }

    #[test]
    fn keys_learn_change_and_forget() {
        let mut panel = panel(&[knob(size())], None);
        assert_eq!(panel.take_key(&key(NamedKey::Enter)), (true, Some(HandsRequest::Clock(false))));
        panel.take_key(&key(NamedKey::ArrowDown));
        assert_eq!(panel.take_key(&key(NamedKey::Enter)).1, Some(HandsRequest::Learn(size())));
        panel.take_key(&key(NamedKey::ArrowDown));
        // The lower end of its way is where the parameter stands.
        let mut after = knob(size());
        after.range = [0.25, 1.0];
        assert_eq!(panel.take_key(&key(NamedKey::Enter)).1, Some(HandsRequest::Change(knob(size()), after)));
        panel.take_key(&key(NamedKey::ArrowRight));
        panel.take_key(&key(NamedKey::ArrowRight));
        let mut after = knob(size());
        after.range = [1.0, 0.0];
        assert_eq!(panel.take_key(&key(NamedKey::Enter)).1, Some(HandsRequest::Change(knob(size()), after)));
        assert_eq!(panel.take_key(&key(NamedKey::Delete)).1, Some(HandsRequest::Remove(knob(size()))));
        assert_eq!(panel.take_key(&Key::Character("n".into())), (false, None), "letters are the show's");
        for _ in 0..100 {
            panel.take_key(&key(NamedKey::ArrowDown));
        }
        assert!(panel.selected() < panel.rows().len());
        for _ in 0..100 {
            panel.take_key(&key(NamedKey::ArrowUp));
        }
        assert!(matches!(panel.rows()[panel.selected()], HandRow::Clock(true)));
    }

    #[test]
    fn every_field_says_what_holds_and_goes_round() {
        let mut mapping = knob(size());
        for field in [Field::Curve, Field::Smoothing, Field::PickUp] {
            let first = field.words(&mapping);
            let mut seen = Vec::new();
            loop {
                seen.push(field.words(&mapping));
                let Some(HandsRequest::Change(_, after)) = field.request(&mapping, None) else { panic!() };
                mapping = after;
                if field.words(&mapping) == first {
                    break;
                }
                assert!(!seen.contains(&field.words(&mapping)), "{field:?}");
            }
            assert!(seen.len() > 1, "{field:?}");
        }
        assert_eq!(Field::To.request(&mapping, None), None, "nobody knows where it stands");
        assert_eq!(Field::To.words(&mapping), "to 100 %");
    }

    #[test]
    fn what_is_learned_says_what_to_do() {
        let panel = panel(&[], Some(&size()));
        let row = panel.rows().iter().find(|row| matches!(row, HandRow::Target { learns: true, .. }));
        assert!(
            matches!(row, Some(HandRow::Target { about, .. }) if about.contains("move a knob")),
            "{row:?}"
        );
    }
}
