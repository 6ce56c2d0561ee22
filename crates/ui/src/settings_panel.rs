//! The state of the settings panel: a row for each setting of the table, and rows for outputs, monitors and the delay,
//! which depend on the connected devices. The overlay draws the panel. Keys and the pointer make commands.
//!
//! Rows that few users need are hidden until the user opens the fold above them.

mod screens;

use std::time::Instant;

use mariana_commands::input::{Key, NamedKey};

use crate::clock;
use crate::monitor::Monitor;
use mariana_commands::{Command, Delay, SHIFT_STEP_MS, SetSetting};
use mariana_player::limits as player_limits;
use mariana_settings::{Choices, Setting, SettingGroup, SettingRow, Values};

/// An output for songs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Output {
    /// The output's id; `None` for the system's default.
    pub id: Option<String>,
    /// The output's display name.
    pub name: String,
    /// True if songs play on this output, or will play on it once it is connected.
    pub is_chosen: bool,
}

/// The data from which the rows are made.
pub struct Facts<'a> {
    /// The choices of this run.
    pub choices: &'a Choices,
    /// The saved choices.
    pub remembered: &'a Choices,
    /// The outputs. The list is empty if songs cannot be played.
    pub outputs: Vec<Output>,
    /// The connected monitors.
    pub monitors: Vec<Monitor>,
    /// True if the output was chosen on the command line.
    pub output_for_this_run: bool,
    /// The delay of the image relative to the sound, in milliseconds.
    pub shift: f64,
    /// The display name of the device to which the delay applies.
    pub device: Option<&'a str>,
}

/// The rows and the selection.
#[derive(Debug, Default)]
pub struct SettingsPanel {
    /// All rows, without the fold.
    all: Vec<SettingRow>,
    /// The visible rows, and the fold.
    pub rows: Vec<SettingRow>,
    shows_advanced: bool,
    /// The index of the selected row.
    pub selected: usize,
    /// When the user last changed a setting that the image shows.
    pub turned: Option<Instant>,
    /// A number that grows whenever the rows change.
    pub revision: u64,
}

impl SettingsPanel {
    /// Updates the rows and keeps the same setting selected.
    pub fn update(&mut self, facts: &Facts<'_>) {
        let all = rows(facts);
        if all != self.all {
            self.all = all;
            self.unfold();
        }
    }

    /// Makes the visible rows, and keeps the same row selected.
    fn unfold(&mut self) {
        let is_shown = |row: &&SettingRow| row.group != SettingGroup::Advanced || self.shows_advanced;
        let mut rows: Vec<SettingRow> = self.all.iter().filter(is_shown).cloned().collect();
        let place = rows.iter().position(|row| row.group == SettingGroup::Advanced).unwrap_or(rows.len());
        rows.insert(place, fold(self.shows_advanced));
        let before = self.rows.get(self.selected);
        let place = before.and_then(|before| rows.iter().position(|row| is_same(row, before)));
        self.selected = place.unwrap_or(self.selected).min(rows.len().saturating_sub(1));
        self.rows = rows;
        self.revision += 1;
    }

    /// Handles a key: arrows select and change, Enter chooses the next value. Returns the key's commands;
    /// `None` for a key that belongs to the show.
    pub fn handle_key(&mut self, key: &Key) -> Option<Vec<Command>> {
        let command = match key {
            Key::Named(NamedKey::ArrowUp) => self.select(self.selected.saturating_sub(1)),
            Key::Named(NamedKey::ArrowDown) => self.select(self.selected + 1),
            Key::Named(NamedKey::ArrowLeft) => self.step(false),
            Key::Named(NamedKey::ArrowRight) => self.step(true),
            Key::Named(NamedKey::Enter) => self.enter(),
            _ => return None,
        };
        Some(Vec::from_iter(command))
    }

    /// Selects a row and chooses one of its values.
    pub fn pick(&mut self, row: usize, value: usize) -> Option<Command> {
        self.select(row);
        let row = self.rows.get(row)?;
        let setting = match &row.values {
            Values::Fold { open } => {
                self.shows_advanced = !open;
                self.unfold();
                return None;
            }
            Values::OneOfRows { chosen: false, setting } => setting,
            Values::Names { options, chosen } if *chosen != value || row.for_this_run => {
                &options.get(value)?.1
            }
            _ => return None,
        };
        let command = Command::Set(SetSetting { setting: setting.clone(), settled: true });
        self.record_turned();
        Some(command)
    }

    /// Selects a row and changes its number, if the row has a number.
    pub fn change_number(&mut self, row: usize, number: f64, settled: bool) -> Option<Command> {
        self.select(row);
        self.record_turned();
        match &self.rows.get(row)?.values {
            Values::Delay(_) => Some(Command::Delay(Delay { milliseconds: number, settled })),
            Values::Brightness(_) => {
                let setting = Setting::Brightness(number.round().clamp(0.0, 100.0) as u8);
                Some(Command::Set(SetSetting { setting, settled }))
            }
            Values::OneOfRows { .. } | Values::Names { .. } | Values::Fold { .. } => None,
        }
    }

    fn record_turned(&mut self) {
        let is_seen =
            |row: &SettingRow| row.group.is_seen() && !matches!(row.values, Values::OneOfRows { .. });
        if self.rows.get(self.selected).is_some_and(is_seen) {
            self.turned = Some(clock::now());
        }
    }

    fn select(&mut self, row: usize) -> Option<Command> {
        self.selected = row.min(self.rows.len().saturating_sub(1));
        None
    }

    fn step(&mut self, forward: bool) -> Option<Command> {
        let sign = if forward { 1.0 } else { -1.0 };
        match &self.rows.get(self.selected)?.values {
            Values::OneOfRows { .. } => None,
            Values::Fold { open } if *open == forward => None,
            Values::Fold { .. } => self.pick(self.selected, 0),
            Values::Names { options, chosen } => {
                let last = options.len().saturating_sub(1);
                let value = if forward { (chosen + 1).min(last) } else { chosen.saturating_sub(1) };
                self.pick(self.selected, value)
            }
            Values::Delay(shift) => self.change_number(self.selected, shift + sign * SHIFT_STEP_MS, true),
            Values::Brightness(percent) => {
                self.change_number(self.selected, percent + sign * PERCENT_STEP, true)
            }
        }
    }

    fn enter(&mut self) -> Option<Command> {
        let value = match &self.rows.get(self.selected)?.values {
            Values::OneOfRows { .. } | Values::Fold { .. } => 0,
            Values::Names { options, chosen } => (chosen + 1) % options.len().max(1),
            Values::Delay(_) | Values::Brightness(_) => return None,
        };
        self.pick(self.selected, value)
    }
}

/// True if two rows are about the same setting, even if their values differ.
fn is_same(a: &SettingRow, b: &SettingRow) -> bool {
    match (&a.values, &b.values) {
        (Values::OneOfRows { setting: a, .. }, Values::OneOfRows { setting: b, .. }) => a == b,
        _ => a.name == b.name,
    }
}

/// Step of an arrow key for percentages.
const PERCENT_STEP: f64 = 5.0;

fn rows(facts: &Facts<'_>) -> Vec<SettingRow> {
    let Facts { choices: now, remembered, .. } = facts;
    let outputs = facts.outputs.iter().map(|output| SettingRow {
        name: output.name.clone(),
        purpose: "Songs play on this output. The current song switches at once, and returns if a lost output reconnects"
            .to_owned(),
        values: Values::OneOfRows { chosen: output.is_chosen, setting: Setting::Output(output.id.clone()) },
        for_this_run: output.is_chosen && facts.output_for_this_run,
        group: SettingGroup::Sound,
    });
    let of_device = facts.device.map_or_else(String::new, |device| format!("; for {device}"));
    let delay = SettingRow {
        name: "Image delay".to_owned(),
        purpose: format!("Delays the image, for headphones or a TV that play late{of_device}"),
        values: Values::Delay(facts.shift),
        for_this_run: false,
        group: SettingGroup::Sound,
    };
    let screens =
        screens::rows(&facts.monitors, now.stage.output.as_deref(), remembered.stage.output.as_deref());
    let mut rows: Vec<SettingRow> = outputs
        .chain([delay])
        .chain(now.rows(remembered))
        .chain(screens)
        .chain(now.stage.rows(&remembered.stage))
        .collect();
    rows.sort_by_key(|row| row.group);
    rows
}

fn fold(open: bool) -> SettingRow {
    SettingRow {
        name: SettingGroup::Advanced.name().to_owned(),
        purpose: "Settings for projectors, performances and second monitors".to_owned(),
        values: Values::Fold { open },
        for_this_run: false,
        group: SettingGroup::Advanced,
    }
}

/// Rounds `shift`, a delay set with the pointer, to whole steps within the limits, in milliseconds.
pub fn whole_steps(shift: f64) -> f64 {
    let limit = player_limits::LATENCY_MS_MAX;
    ((shift / SHIFT_STEP_MS).round() * SHIFT_STEP_MS).clamp(-limit, limit)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use mariana_field::world::ToneMap;
    use mariana_render::placement::Crop;
    use mariana_settings::QualityChoice;

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

    fn press(panel: &mut SettingsPanel, key: NamedKey) -> Option<Command> {
        let commands = panel.handle_key(&Key::Named(key));
        commands.unwrap_or_else(|| panic!("the panel ignores {key:?}")).pop()
    }

    fn set(setting: Setting) -> Option<Command> {
        Some(Command::Set(SetSetting { setting, settled: true }))
    }

    fn select(panel: &mut SettingsPanel, name: &str) {
        let row = panel.rows.iter().position(|row| row.name == name).unwrap();
        panel.select(row);
    }

    #[test]
    fn arrows_select_and_change_and_enter_cycles() {
        use NamedKey::{ArrowDown, ArrowLeft, ArrowRight, ArrowUp, Enter};
        let mut panel = panel(&Choices::default(), None);
        assert_eq!((press(&mut panel, ArrowUp), panel.selected), (None, 0));
        // Enter on the chosen output has no effect, and arrows do not try other outputs.
        assert_eq!((press(&mut panel, Enter), press(&mut panel, ArrowRight)), (None, None));
        assert_eq!((press(&mut panel, ArrowDown), panel.selected), (None, 1));
        assert_eq!(press(&mut panel, Enter), set(Setting::Output(Some("usb".into()))));
        select(&mut panel, "Image delay");
        let shift = |milliseconds| Some(Command::Delay(Delay { milliseconds, settled: true }));
        assert_eq!((press(&mut panel, ArrowLeft), press(&mut panel, ArrowRight)), (shift(30.0), shift(40.0)));
        select(&mut panel, "Brightness");
        let percent = |percent| set(Setting::Brightness(percent));
        assert_eq!(
            (press(&mut panel, ArrowLeft), press(&mut panel, ArrowRight)),
            (percent(95), percent(100))
        );
        select(&mut panel, "Advanced");
        assert_eq!(press(&mut panel, ArrowLeft), None, "the fold is closed already");
        assert_eq!(press(&mut panel, ArrowRight), None);
        select(&mut panel, "Blackout fade");
        assert_eq!(press(&mut panel, ArrowRight), set(Setting::BlackoutFade(1.0)));
        select(&mut panel, "Quality");
        assert_eq!(press(&mut panel, ArrowLeft), None, "the first value has no previous one");
        assert_eq!(press(&mut panel, ArrowRight), set(Setting::Quality(QualityChoice::Low)));
        select(&mut panel, "Limit flashes");
        assert_eq!(press(&mut panel, Enter), set(Setting::FlashLimiter(false)));
        let off = Choices { flash_limiter: false, ..Choices::default() };
        update(&mut panel, &off, None, &["usb", "tv"]);
        assert_eq!(press(&mut panel, Enter), set(Setting::FlashLimiter(true)));
        (0..99).for_each(|_| drop(press(&mut panel, ArrowDown)));
        assert_eq!(panel.rows[panel.selected].name, "Crop");
        assert_eq!(press(&mut panel, ArrowRight), set(Setting::Crop(Crop::try_from([1.0; 4]).unwrap())));
        for key in [Key::Character("q".into()), Key::Named(NamedKey::Escape), Key::Named(NamedKey::Space)] {
            assert_eq!(panel.handle_key(&key), None, "{key:?} belongs to the show");
        }
    }

    #[test]
    fn the_selected_row_stays_the_same_while_outputs_come_and_go() {
        let choices = Choices::default();
        let mut panel = panel(&choices, None);
        select(&mut panel, "Lift quiet music");
        let revision = panel.revision;
        update(&mut panel, &choices, None, &["usb", "tv"]);
        assert_eq!(panel.revision, revision, "nothing has changed");
        update(&mut panel, &choices, None, &[]);
        assert_eq!(panel.rows[panel.selected].name, "Lift quiet music");
        assert!(panel.revision > revision);
        select(&mut panel, "THE SYSTEM'S DEFAULT");
        update(&mut panel, &choices, None, &["a", "b"]);
        assert_eq!(panel.selected, 0);
    }

    #[test]
    fn values_from_the_command_line_are_marked_and_can_be_saved() {
        let choices = Choices { quality: QualityChoice::High, ..Choices::default() };
        let mut panel = panel(&choices, None);
        let marked: Vec<&str> =
            panel.rows.iter().filter(|row| row.for_this_run).map(|row| &*row.name).collect();
        assert_eq!(marked, ["Quality"]);
        let row = panel.rows.iter().position(|row| row.name == "Quality").unwrap();
        assert_eq!(panel.pick(row, 3), set(Setting::Quality(QualityChoice::High)));
        assert_eq!((panel.pick(row, 99), panel.pick(99, 0)), (None, None));
    }

    #[test]
    fn every_row_has_a_description_without_flags_and_code() {
        let mut panel = panel(&Choices::default(), Some("tv"));
        select(&mut panel, "Advanced");
        let folded = panel.rows.len();
        let _ = press(&mut panel, NamedKey::Enter);
        assert!(panel.rows.len() > folded + 2 && panel.rows[panel.selected].name == "Advanced");
        let mut rows = panel.rows.to_vec();
        // Each value of a setting may have an explanation of its own.
        for tone_map in [None].into_iter().chain(ToneMap::ALL.map(Some)) {
            rows.extend(Choices { tone_map, ..Choices::default() }.rows(&Choices::default()));
        }
        for row in &rows {
            assert!(!row.name.is_empty() && row.purpose.len() > 20, "{row:?}");
            let mut words = vec![row.name.as_str(), row.purpose.as_str()];
            if let Values::Names { options, .. } = &row.values {
                words.extend(options.iter().map(|(name, _)| *name));
            }
            for text in words {
                let technical = ["--", "`", "agx", "aces", "reinhard", "auto:"];
                let found = technical.iter().find(|word| text.to_lowercase().contains(**word));
                assert!(found.is_none_or(|word| *word == "auto:" && row.name == "Quality"), "{text}");
            }
        }
        let _ = press(&mut panel, NamedKey::ArrowLeft);
        assert_eq!(panel.rows.len(), folded);
        assert_eq!([whole_steps(12.4), whole_steps(-1e9), whole_steps(-2.6)], [10.0, -5_000.0, -5.0]);
    }
}
