//! What the user chooses for good: the rows of the panel of settings.
//!
//! It is a plain value: the overlay draws it, keys and pointer change it, and what they ask for is done by the stage.
//! Names of choices come from the tables of [`crate::config::Choice`].

mod staging;

use winit::keyboard::{Key, NamedKey};

use super::monitors::Monitor;
use super::sound::SHIFT_STEP_MS;
#[cfg(doc)]
use crate::config::StageChoices;
use crate::config::{Choice, Choices, FollowChoice, QualityChoice};
use crate::placement::{Crop, Flip};
use mariana_field::world::ToneMap;
use mariana_music::Gain;
use mariana_player::limits::LIMITS as PLAYER_LIMITS;

/// What a row is about.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Fact {
    /// The output with this id plays songs; none is the system's default.
    Output(Option<String>),
    /// The shift of the picture for the device in use.
    Latency,
    /// See [`Choices::quality`].
    Quality,
    /// See [`Choices::flash_limiter`].
    FlashLimiter,
    /// See [`Choices::tone_map`].
    ToneMap,
    /// See [`Choices::gain`].
    Gain,
    /// See [`Choices::follow_song`].
    Follow,
    /// See [`Choices::last_tracks`].
    LastTracks,
    /// See [`Choices::hints`].
    Hints,
    /// See [`Choices::next_scene`].
    NextScene,
    /// The picture also fills the monitor with this name; none is the window alone.
    Screen(Option<String>),
    /// See [`StageChoices::brightness`].
    Brightness,
    /// See [`StageChoices::blackout_fade`].
    BlackoutFade,
    /// See [`StageChoices::flip`].
    Flip,
    /// See [`StageChoices::crop`].
    Crop,
}

/// What there is to see and to change in a row.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// One of several rows, of which one holds.
    OneOfRows {
        /// Whether it does.
        holds: bool,
    },
    /// One of several names.
    Names {
        /// The names.
        names: Vec<&'static str>,
        /// The place of the one that holds.
        present: usize,
    },
    /// Milliseconds, negative for earlier.
    Milliseconds(f64),
    /// 0..100.
    Percent(f64),
}

/// A row of the panel.
#[derive(Debug, Clone, PartialEq)]
pub struct SettingRow {
    /// What it is about.
    pub fact: Fact,
    /// The same in a word or two.
    pub name: String,
    /// What it is for.
    pub meaning: String,
    /// What can be chosen.
    pub values: Values,
    /// Whether the command line says something else than what is remembered.
    pub for_this_run: bool,
}

/// A change that the user asks for.
#[derive(Debug, Clone, PartialEq)]
pub enum SettingChange {
    /// To play songs on the output with this id, or on the system's default.
    Output(Option<String>),
    /// To show the picture so many milliseconds later.
    Latency {
        /// Milliseconds.
        shift: f64,
        /// Whether it stays so, or the user still moves it.
        settled: bool,
    },
    /// See [`Choices::quality`].
    Quality(QualityChoice),
    /// See [`Choices::flash_limiter`].
    FlashLimiter(bool),
    /// See [`Choices::tone_map`].
    ToneMap(Option<ToneMap>),
    /// See [`Choices::gain`].
    Gain(Gain),
    /// See [`Choices::follow_song`].
    Follow(FollowChoice),
    /// See [`Choices::last_tracks`].
    LastTracks(bool),
    /// See [`Choices::hints`].
    Hints(bool),
    /// See [`Choices::next_scene`].
    NextScene(bool),
    /// To fill the monitor with this name with the picture, too, or none.
    Screen(Option<String>),
    /// See [`StageChoices::brightness`].
    Brightness {
        /// 0..100.
        percent: f64,
        /// Whether it stays so, or the user still moves it.
        settled: bool,
    },
    /// See [`StageChoices::blackout_fade`].
    BlackoutFade(f64),
    /// See [`StageChoices::flip`].
    Flip(Flip),
    /// See [`StageChoices::crop`].
    Crop(Crop),
}

/// An output that songs can play on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Output {
    /// Its id; none is the system's default.
    pub id: Option<String>,
    /// What people call it.
    pub name: String,
    /// Whether songs play on it, or would if it were there.
    pub is_chosen: bool,
}

/// What holds at present.
pub(super) struct Facts<'a> {
    /// In this run.
    pub choices: &'a Choices,
    /// From run to run.
    pub remembered: &'a Choices,
    /// The outputs; none where no song can play.
    pub outputs: Vec<Output>,
    /// The monitors that are there.
    pub monitors: Vec<Monitor>,
    /// Whether the command line names the output.
    pub output_for_this_run: bool,
    /// The shift of the picture, in milliseconds.
    pub shift: f64,
    /// What people call the device that it is for.
    pub device: Option<&'a str>,
}

/// See the module.
#[derive(Debug, Default)]
pub struct SettingsPanel {
    rows: Vec<SettingRow>,
    selected: usize,
    revision: u64,
}

impl SettingsPanel {
    /// The rows, from the top.
    pub fn rows(&self) -> &[SettingRow] {
        &self.rows
    }

    /// The place of the row that keys change.
    pub fn selected(&self) -> usize {
        self.selected
    }

    /// Grows with everything that changes its look.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Takes in what holds now. The selected row stays the same one, wherever it stands.
    pub(super) fn update(&mut self, facts: &Facts<'_>) {
        let rows = rows(facts);
        if rows == self.rows {
            return;
        }
        let fact = self.rows.get(self.selected).map(|row| row.fact.clone());
        let place = rows.iter().position(|row| Some(&row.fact) == fact.as_ref());
        self.selected = place.unwrap_or(self.selected).min(rows.len().saturating_sub(1));
        self.rows = rows;
        self.revision += 1;
    }

    /// Takes a key, if it is one of the panel's: arrows select and change, Enter chooses the next value. Returns whether
    /// it was, and the change that it asks for.
    pub(super) fn take_key(&mut self, key: &Key) -> (bool, Option<SettingChange>) {
        let change = match key {
            Key::Named(NamedKey::ArrowUp) => {
                self.select(self.selected.saturating_sub(1));
                None
            }
            Key::Named(NamedKey::ArrowDown) => {
                self.select(self.selected + 1);
                None
            }
            Key::Named(NamedKey::ArrowLeft) => self.step(false),
            Key::Named(NamedKey::ArrowRight) => self.step(true),
            Key::Named(NamedKey::Enter) => self.enter(),
            _ => return (false, None),
        };
        (true, change)
    }

    /// Selects the row at a place, and chooses its value at another place, if that is one.
    pub(super) fn pick(&mut self, row: usize, value: usize) -> Option<SettingChange> {
        self.select(row);
        let row = self.rows.get(row)?;
        let change = change_to(&row.fact, value);
        let holds = match row.values {
            Values::OneOfRows { holds } => holds,
            Values::Names { present, .. } => present == value && !row.for_this_run,
            Values::Milliseconds(_) | Values::Percent(_) => true,
        };
        change.filter(|_| !holds)
    }

    /// Selects the row at a place, and changes its number, if it has one.
    pub(super) fn shift(&mut self, row: usize, number: f64, settled: bool) -> Option<SettingChange> {
        self.select(row);
        match self.rows.get(row)?.values {
            Values::Milliseconds(_) => Some(SettingChange::Latency { shift: number, settled }),
            Values::Percent(_) => {
                Some(SettingChange::Brightness { percent: number.clamp(0.0, 100.0), settled })
            }
            Values::OneOfRows { .. } | Values::Names { .. } => None,
        }
    }

    fn select(&mut self, row: usize) {
        let row = row.min(self.rows.len().saturating_sub(1));
        self.revision += u64::from(row != self.selected);
        self.selected = row;
    }

    /// The next value of the selected row, or the one before.
    fn step(&mut self, forward: bool) -> Option<SettingChange> {
        let row = self.rows.get(self.selected)?;
        match &row.values {
            Values::OneOfRows { .. } => None,
            Values::Names { names, present } => {
                let last = names.len().saturating_sub(1);
                let value = if forward { (present + 1).min(last) } else { present.saturating_sub(1) };
                self.pick(self.selected, value)
            }
            Values::Milliseconds(shift) => {
                let shift = shift + if forward { SHIFT_STEP_MS } else { -SHIFT_STEP_MS };
                self.shift(self.selected, shift, true)
            }
            Values::Percent(percent) => {
                let percent = percent + if forward { PERCENT_STEP } else { -PERCENT_STEP };
                self.shift(self.selected, percent, true)
            }
        }
    }

    /// Chooses the selected row, or its next value, after the last the first.
    fn enter(&mut self) -> Option<SettingChange> {
        let value = match &self.rows.get(self.selected)?.values {
            Values::OneOfRows { .. } => 0,
            Values::Names { names, present } => (present + 1) % names.len().max(1),
            Values::Milliseconds(_) | Values::Percent(_) => return None,
        };
        self.pick(self.selected, value)
    }
}

/// The change that chooses the value at this place of a row.
fn change_to(fact: &Fact, value: usize) -> Option<SettingChange> {
    fn at<T: Choice>(value: usize) -> Option<T> {
        T::ALL.get(value).map(|(value, ..)| *value)
    }
    Some(match fact {
        Fact::Output(id) => SettingChange::Output(id.clone()),
        Fact::Latency | Fact::Brightness => return None,
        Fact::Quality => SettingChange::Quality(at(value)?),
        Fact::FlashLimiter => SettingChange::FlashLimiter(at(value)?),
        Fact::ToneMap => SettingChange::ToneMap(at(value)?),
        Fact::Gain => SettingChange::Gain(at(value)?),
        Fact::Follow => SettingChange::Follow(at(value)?),
        Fact::LastTracks => SettingChange::LastTracks(at(value)?),
        Fact::Hints => SettingChange::Hints(at(value)?),
        Fact::NextScene => SettingChange::NextScene(at(value)?),
        Fact::BlackoutFade => SettingChange::BlackoutFade(staging::fade(value)?),
        Fact::Screen(name) => SettingChange::Screen(name.clone()),
        Fact::Flip => SettingChange::Flip(at(value)?),
        Fact::Crop => SettingChange::Crop(staging::crop(value)?),
    })
}

/// The row of a choice, which is `now` in this run.
fn row_of<T: Choice>(fact: Fact, name: &str, meaning: &str, now: T, remembered: T) -> SettingRow {
    let of_value = T::ALL.iter().find(|(value, ..)| *value == now).map_or("", |(.., meaning)| meaning);
    let meaning = match of_value {
        "" => meaning.to_owned(),
        of_value => format!("{meaning} · {}: {of_value}", now.name()),
    };
    SettingRow {
        fact,
        name: name.to_owned(),
        meaning,
        values: Values::Names {
            names: T::ALL.iter().map(|(_, name, _)| *name).collect(),
            present: T::ALL.iter().position(|(value, ..)| *value == now).unwrap_or_default(),
        },
        for_this_run: now != remembered,
    }
}

/// What an arrow adds to percent.
const PERCENT_STEP: f64 = 5.0;

fn rows(facts: &Facts<'_>) -> Vec<SettingRow> {
    let Facts { choices: now, remembered, .. } = facts;
    let outputs = facts.outputs.iter().map(|output| SettingRow {
        fact: Fact::Output(output.id.clone()),
        name: output.name.clone(),
        meaning: "Songs play here; a song that plays moves at once, and comes back when the output does"
            .to_owned(),
        values: Values::OneOfRows { holds: output.is_chosen },
        for_this_run: output.is_chosen && facts.output_for_this_run,
    });
    let of_device = facts.device.map_or_else(String::new, |device| format!("; for {device}"));
    let latency = SettingRow {
        fact: Fact::Latency,
        name: "Latency".to_owned(),
        meaning: format!("The picture comes so much later, for headphones or a TV that lag{of_device}"),
        values: Values::Milliseconds(facts.shift),
        for_this_run: false,
    };
    let choices = [
        row_of(Fact::Quality, "Quality", "What a picture may cost", now.quality, remembered.quality),
        row_of(
            Fact::FlashLimiter,
            "Limit flashes",
            "Dims more than three flashes a second: those can cause seizures (WCAG 2.3.1)",
            now.flash_limiter,
            remembered.flash_limiter,
        ),
        row_of(
            Fact::ToneMap,
            "Tone map",
            "How light becomes colours of the screen",
            now.tone_map,
            remembered.tone_map,
        ),
        row_of(
            Fact::Gain,
            "Gain",
            "Auto levels quiet and loud music for the picture; what you hear stays as it is",
            now.gain,
            remembered.gain,
        ),
        row_of(
            Fact::Follow,
            "Follow the song",
            "Scenes change with the song's sections and drops, as a director would; A does the same",
            now.follow_song,
            remembered.follow_song,
        ),
        row_of(
            Fact::LastTracks,
            "Go on with tracks",
            "The next start goes on with these tracks where they are; off forgets them",
            now.last_tracks,
            remembered.last_tracks,
        ),
        row_of(
            Fact::Hints,
            "Hints",
            "First words, answers and the bar; without them G still opens this panel",
            now.hints,
            remembered.hints,
        ),
        row_of(
            Fact::NextScene,
            "Next scene",
            "A small picture of it in this window, too; beside a picture on another monitor it always shows",
            now.next_scene,
            remembered.next_scene,
        ),
    ];
    let screens =
        staging::screens(&facts.monitors, now.stage.output.as_deref(), remembered.stage.output.as_deref());
    outputs
        .chain([latency])
        .chain(choices)
        .chain(screens)
        .chain(staging::rows(&now.stage, &remembered.stage))
        .collect()
}

/// A shift by pointer, in milliseconds: in steps, and within the limits.
pub fn whole_steps(shift: f64) -> f64 {
    let limit = PLAYER_LIMITS.latency_ms_max;
    ((shift / SHIFT_STEP_MS).round() * SHIFT_STEP_MS).clamp(-limit, limit)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A panel with two outputs besides the default, of which `chosen` is chosen.
    pub(crate) fn panel(choices: &Choices, chosen: Option<&str>) -> SettingsPanel {
        let mut panel = SettingsPanel::default();
        update(&mut panel, choices, chosen, &["usb", "tv"]);
        panel
    }

    fn update(panel: &mut SettingsPanel, choices: &Choices, chosen: Option<&str>, ids: &[&str]) {
        let output = |id: Option<&str>| Output {
            id: id.map(str::to_owned),
            name: id.unwrap_or("the system's default").to_uppercase(),
            is_chosen: id == chosen,
        };
        panel.update(&Facts {
            choices,
            remembered: &Choices::default(),
            outputs: [None].into_iter().chain(ids.iter().copied().map(Some)).map(output).collect(),
            monitors: Vec::new(),
            output_for_this_run: false,
            shift: 35.0,
            device: Some("USB"),
        });
    }

    fn press(panel: &mut SettingsPanel, key: NamedKey) -> Option<SettingChange> {
        let (taken, change) = panel.take_key(&Key::Named(key));
        assert!(taken, "{key:?} is not the panel's");
        change
    }

    fn select(panel: &mut SettingsPanel, name: &str) {
        let row = panel.rows().iter().position(|row| row.name == name).unwrap();
        panel.select(row);
    }

    #[test]
    fn arrows_select_and_change_and_enter_goes_round() {
        use NamedKey::{ArrowDown, ArrowLeft, ArrowRight, ArrowUp, Enter};
        let mut panel = panel(&Choices::default(), None);
        assert_eq!((press(&mut panel, ArrowUp), panel.selected()), (None, 0));
        // The output that is chosen already is no change, and no arrow plays through the others.
        assert_eq!((press(&mut panel, Enter), press(&mut panel, ArrowRight)), (None, None));
        assert_eq!((press(&mut panel, ArrowDown), panel.selected()), (None, 1));
        assert_eq!(press(&mut panel, Enter), Some(SettingChange::Output(Some("usb".into()))));
        select(&mut panel, "Latency");
        let shift = |shift| Some(SettingChange::Latency { shift, settled: true });
        assert_eq!((press(&mut panel, ArrowLeft), press(&mut panel, ArrowRight)), (shift(30.0), shift(40.0)));
        select(&mut panel, "Brightness");
        let percent = |percent| Some(SettingChange::Brightness { percent, settled: true });
        assert_eq!(
            (press(&mut panel, ArrowLeft), press(&mut panel, ArrowRight)),
            (percent(95.0), percent(100.0))
        );
        select(&mut panel, "Blackout fade");
        assert_eq!(press(&mut panel, ArrowRight), Some(SettingChange::BlackoutFade(1.0)));
        select(&mut panel, "Quality");
        assert_eq!(press(&mut panel, ArrowLeft), None, "there is none before the first");
        assert_eq!(press(&mut panel, ArrowRight), Some(SettingChange::Quality(QualityChoice::Low)));
        select(&mut panel, "Limit flashes");
        assert_eq!(press(&mut panel, Enter), Some(SettingChange::FlashLimiter(false)));
        let off = Choices { flash_limiter: false, ..Choices::default() };
        update(&mut panel, &off, None, &["usb", "tv"]);
        assert_eq!(press(&mut panel, Enter), Some(SettingChange::FlashLimiter(true)));
        (0..99).for_each(|_| drop(press(&mut panel, ArrowDown)));
        assert_eq!(panel.rows()[panel.selected()].name, "Crop");
        assert_eq!(
            press(&mut panel, ArrowRight),
            Some(SettingChange::Crop(Crop::try_from([1.0; 4]).unwrap()))
        );
        for key in [Key::Character("q".into()), Key::Named(NamedKey::Escape), Key::Named(NamedKey::Space)] {
            assert_eq!(panel.take_key(&key), (false, None), "{key:?} is the show's");
        }
    }

    #[test]
    fn the_selected_row_stays_the_same_while_outputs_come_and_go() {
        let choices = Choices::default();
        let mut panel = panel(&choices, None);
        select(&mut panel, "Gain");
        let revision = panel.revision();
        update(&mut panel, &choices, None, &["usb", "tv"]);
        assert_eq!(panel.revision(), revision, "nothing has changed");
        update(&mut panel, &choices, None, &[]);
        assert_eq!(panel.rows()[panel.selected()].name, "Gain");
        assert!(panel.revision() > revision);
        select(&mut panel, "THE SYSTEM'S DEFAULT");
        update(&mut panel, &choices, None, &["a", "b"]);
        assert_eq!(panel.selected(), 0);
    }

    #[test]
    fn what_the_command_line_says_is_marked_and_can_be_made_to_stay() {
        let choices = Choices { quality: QualityChoice::High, ..Choices::default() };
        let mut panel = panel(&choices, None);
        let marked: Vec<&str> =
            panel.rows().iter().filter(|row| row.for_this_run).map(|row| &*row.name).collect();
        assert_eq!(marked, ["Quality"]);
        let row = panel.rows().iter().position(|row| row.fact == Fact::Quality).unwrap();
        assert_eq!(panel.pick(row, 3), Some(SettingChange::Quality(QualityChoice::High)));
        assert_eq!((panel.pick(row, 99), panel.pick(99, 0)), (None, None));
    }

    #[test]
    fn every_row_has_its_words() {
        let panel = panel(&Choices::default(), Some("tv"));
        for row in panel.rows() {
            assert!(!row.name.is_empty() && row.meaning.len() > 20, "{row:?}");
        }
        assert_eq!([whole_steps(12.4), whole_steps(-1e9), whole_steps(-2.6)], [10.0, -5_000.0, -5.0]);
    }
}
