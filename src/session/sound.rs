//! The source of the sound, a song or a live input, and the delay of the frames.

mod reported_problems;

use std::sync::Arc;
use std::time::{Duration, Instant};

use reported_problems::{Hints, ReportedProblems};

use crate::clock;
use crate::commands::SHIFT_STEP_MS;
use crate::config::{DEFAULT_DEVICE, KeptSettings, ListenChoice, Memory, PlaySettings, Settings};
use crate::session::SessionError;
use crate::ui::overlay::SourceList;
use crate::ui::settings_panel;
use mariana_music::{self, Gain, Recent};
use mariana_player::device_list::{DeviceList, DeviceWatch, ListedDevice};
use mariana_player::input::{Live, LiveStatus};
use mariana_player::limits as player_limits;
use mariana_player::{Moment, Player, PlayerStatus, Target};
use mariana_work::once;

const LIST_STANDS: Duration = Duration::from_secs(4);

/// An audio input; `None` for the song.
type Source = Option<Target>;

pub(crate) struct Sound {
    /// The player, even if an input is the current source.
    pub(super) player: Option<Player>,
    live: Option<Live>,
    paused: bool,
    pub(super) kept: KeptSettings,
    /// The delay of this run in milliseconds, if set on the command line.
    asked_ms: Option<f64>,
    gain: Gain,
    /// The output for songs; `None` for intended silence.
    output: Option<Target>,
    pub(crate) device: Option<ListedDevice>,
    watch: Option<Arc<DeviceWatch>>,
    list: Option<(Vec<(Source, String)>, Instant)>,
    /// The chosen source, saved only when the source list disappears: choices on the way are not saved.
    unremembered: Option<Target>,
    hints: Hints,
    reported_problems: ReportedProblems,
}

impl Sound {
    /// Starts the sound: an input if the settings name one, and the player's song, which waits until it is resumed.
    pub(crate) fn start(
        player: Option<Player>,
        output: Option<Target>,
        memory: Memory,
        settings: &PlaySettings,
    ) -> Result<Self, SessionError> {
        let gain = settings.choices.gain;
        let mut sound = Self {
            player,
            live: None,
            paused: true,
            kept: KeptSettings::of(memory.file),
            asked_ms: settings.latency.map(|seconds| 1000.0 * seconds),
            gain,
            output,
            device: None,
            watch: None,
            list: None,
            unremembered: None,
            hints: Hints::default(),
            reported_problems: ReportedProblems::default(),
        };
        if let Some(trouble) = memory.trouble {
            sound.reported_problems.add(&trouble.to_string());
        }
        if let Some(choice) = settings.listen {
            let target = wanted(choice, settings.device.clone(), sound.kept.settings());
            sound.live = Some(Live::start(target, gain)?);
        }
        Ok(sound)
    }

    pub(crate) fn player(&mut self) -> Option<&mut Player> {
        self.player.as_mut().filter(|_| self.live.is_none())
    }

    pub(crate) fn plays_song(&self) -> bool {
        self.live.is_none() && self.player.is_some()
    }

    pub(crate) fn set_paused(&mut self, paused: bool) {
        self.paused = paused;
        if let Some(live) = &mut self.live {
            live.set_paused(paused);
        } else if let Some(player) = &self.player {
            player.set_paused(paused);
        }
    }

    pub(crate) fn now(&mut self) -> Option<Moment> {
        let shift = self.shift_ms() / 1000.0;
        match (&mut self.live, &mut self.player) {
            (Some(live), _) => Some(live.now(shift)),
            (None, Some(player)) => Some(player.now(shift)),
            (None, None) => None,
        }
    }

    /// The sound with its curves at the moment that [`Sound::now`] last returned, or at an earlier one as far as it is
    /// known.
    pub(crate) fn heard_at(&self, song_time: f64) -> mariana_music::Sound {
        match (&self.live, &self.player) {
            (Some(live), _) => live.sound_at(song_time),
            (None, Some(player)) => player.sound_at(song_time),
            (None, None) => mariana_music::Sound::default(),
        }
    }

    /// The sound of the last seconds before a moment, as far as it is known.
    pub(crate) fn recent(&self, song_time: f64) -> Vec<Recent> {
        match (&self.live, &self.player) {
            (Some(live), _) => live.recent(song_time),
            (None, Some(player)) => player.recent(song_time),
            (None, None) => Vec::new(),
        }
    }

    /// The state of the song, if it is the current source. Updates the device in use.
    pub(crate) fn song_status(&mut self) -> Option<PlayerStatus> {
        let status = self.player()?.status();
        if let Some(device) = status.device.as_ref().filter(|device| self.device.as_ref() != Some(device)) {
            tracing::debug!("the song plays on {}", device.id);
        }
        self.device.clone_from(&status.device);
        Some(status)
    }

    /// The state of the input, if it is the current source. Prints news on the terminal.
    pub(crate) fn live_status(&mut self) -> Option<LiveStatus> {
        if self.list(false, clock::now()).is_none() {
            self.remember_choice();
        }
        let status = self.live.as_mut()?.status();
        self.device.clone_from(&status.device);
        self.hints.drain(&status);
        Some(status)
    }

    /// Changes the delay of the frames by steps of [`SHIFT_STEP_MS`] and saves it for the device. Returns a message.
    pub(crate) fn shift(&mut self, steps: f64) -> String {
        let shift = self.shift_to(self.shift_ms() + steps * SHIFT_STEP_MS, true);
        shift_in_words(shift, self.device.as_ref().map(|device| &*device.name))
    }

    /// Sets the delay of the frames in milliseconds, within limits, and returns it. `settled` saves it for the device.
    pub(crate) fn shift_to(&mut self, shift: f64, settled: bool) -> f64 {
        // Live sound cannot be shown before it arrives.
        let least = if self.live.is_some() { 0.0 } else { -player_limits::LATENCY_MS_MAX };
        let shift = shift.clamp(least, player_limits::LATENCY_MS_MAX);
        self.asked_ms = Some(shift);
        if let Some(device) = self.device.clone().filter(|_| settled) {
            // From now on the saved value applies, so that another device gets its own delay.
            self.asked_ms = None;
            self.kept.change(move |settings| {
                settings.latency_ms.insert(device.id.clone(), shift);
            });
        }
        shift
    }

    /// Plays songs on the output `id` while this output is connected, otherwise on the system's default output.
    pub(crate) fn choose_output(&mut self, id: Option<String>) {
        let target = id.map_or(Target::Default, Target::Preferred);
        if let Some(player) = &self.player {
            player.choose_output(target.clone());
        }
        if self.live.is_none() {
            // A delay from the command line was meant for the previous device.
            self.asked_ms = None;
        }
        self.output = Some(target);
    }

    pub(crate) fn set_gain(&mut self, gain: Gain) {
        self.gain = gain;
        if let Some(player) = &self.player {
            player.set_gain(gain);
        }
        if let Some(live) = &self.live {
            live.set_gain(gain);
        }
    }

    /// The outputs for songs, the system's default first; empty without songs.
    pub(crate) fn outputs(&mut self) -> Vec<settings_panel::Output> {
        if self.player.is_none() {
            return Vec::new();
        }
        let device_list = self.device_list().unwrap_or_default();
        let open = self.device.as_ref().filter(|_| self.live.is_none());
        outputs_of(&device_list, self.output.as_ref(), open)
    }

    /// The delay of the frames in milliseconds, in addition to the device's own latency.
    pub(crate) fn shift_ms(&self) -> f64 {
        let remembered = || self.kept.settings().latency_ms.get(&self.device.as_ref()?.id).copied();
        self.asked_ms.or_else(remembered).unwrap_or(0.0)
    }

    fn latest_sources(&mut self) -> Option<Vec<(Source, String)>> {
        let device_list = self.device_list()?;
        Some(self.sources(&device_list))
    }

    fn device_list(&mut self) -> Option<Arc<DeviceList>> {
        if let Some(watch) = &self.watch {
            return Some(watch.latest().1);
        }
        match DeviceWatch::shared() {
            Ok(watch) => Some(self.watch.insert(watch).latest().1),
            Err(error) => {
                self.reported_problems.add(&error.to_string());
                None
            }
        }
    }

    /// Switches from an input to the song. Returns the player; `None` if the session started with an input.
    pub(crate) fn listen_to_song(&mut self) -> Option<&mut Player> {
        if self.player.is_some() && self.live.is_some() {
            self.choose(None);
        }
        self.player()
    }

    pub(crate) fn show_list(&mut self) {
        if let Some(sources) = self.latest_sources() {
            self.list = Some((sources, clock::now()));
        }
    }

    pub(crate) fn choose_from_list(&mut self, place: usize) {
        let Some((sources, since)) = &mut self.list else { return };
        let Some((source, _)) = sources.get(place) else { return };
        let source = source.clone();
        *since = clock::now();
        if source != self.present() {
            self.choose(source);
        }
    }

    /// Switches to the next source, or to a suggested source that has a signal, and shows the list.
    pub(crate) fn next_source(&mut self) {
        let Some(sources) = self.latest_sources() else { return };
        let present = self.present();
        let place = sources.iter().position(|(source, _)| *source == present);
        let suggested = self.hints.suggestion.take().map(|entry| Some(Target::Named(entry.id)));
        let next = suggested.or_else(|| {
            let after = place.map_or(0, |place| (place + 1) % sources.len().max(1));
            sources.get(after).map(|(source, _)| source.clone())
        });
        if let Some(next) = next {
            self.choose(next);
        }
        self.list = Some((sources, clock::now()));
    }

    fn present(&self) -> Source {
        self.live.as_ref().map(|live| live.target().clone())
    }

    fn sources(&self, device_list: &DeviceList) -> Vec<(Source, String)> {
        let name_of =
            |entry: Option<&ListedDevice>| entry.map_or("currently none", |entry| &*entry.name).to_owned();
        let mut sources = Vec::new();
        if self.player.is_some() {
            sources.push((None, "the song".to_owned()));
        }
        let monitor = name_of(device_list.default_monitor());
        let input = device_list.default_input.as_deref().and_then(|id| device_list.input(id));
        sources.push((Some(Target::Monitor), format!("the computer's sound ({monitor})")));
        sources.push((Some(Target::Default), format!("the default input ({})", name_of(input))));
        for entry in &device_list.inputs {
            sources.push((Some(Target::Named(entry.id.clone())), entry.name.clone()));
        }
        let present = self.present();
        if let Some(Target::Named(name)) = &present
            && !sources.iter().any(|(source, _)| *source == present)
        {
            sources.push((present.clone(), name.clone()));
        }
        sources
    }

    fn choose(&mut self, source: Source) {
        self.hints.forget();
        self.device = None;
        // The previous delay was meant for another device.
        self.asked_ms = None;
        match source {
            None => {
                // Use a thread: closing waits for the sound system, and frames must not wait.
                if let Some(live) = self.live.take() {
                    // Without a thread, the input is closed here, within a time limit.
                    if let Err(error) = once("closing", || {}, move || drop(live)) {
                        tracing::warn!(
                            "cannot start a thread to close the input ({error}): closed it on the show's thread"
                        );
                    }
                }
                self.unremembered = None;
                if let Some(player) = &self.player {
                    player.set_paused(self.paused);
                }
            }
            Some(target) => {
                if let Some(player) = &self.player {
                    player.set_paused(true);
                }
                match &mut self.live {
                    Some(live) => live.choose(target.clone()),
                    None => match Live::start(target.clone(), self.gain) {
                        Ok(mut live) => {
                            live.set_paused(self.paused);
                            self.live = Some(live);
                        }
                        Err(error) => return self.reported_problems.add(&error.to_string()),
                    },
                }
                self.unremembered = Some(target);
            }
        }
    }

    pub(crate) fn hint(&self) -> Option<&str> {
        self.hints.shown.as_deref().filter(|_| self.live.is_some())
    }

    /// The list of sources while it is visible. `stays_open` is true while the user keeps it open.
    pub(crate) fn list(&self, stays_open: bool, now: Instant) -> Option<SourceList> {
        let (sources, since) = self.list.as_ref()?;
        let present = self.present();
        (stays_open || now.saturating_duration_since(*since) < LIST_STANDS).then(|| SourceList {
            names: sources.iter().map(|(_, name)| name.clone()).collect(),
            present: sources.iter().position(|(source, _)| *source == present),
        })
    }

    fn remember_choice(&mut self) {
        if let Some(target) = self.unremembered.take() {
            self.kept.change(move |settings| record_choice(settings, &target));
        }
    }

    /// Reports a problem, once.
    pub(crate) fn report(&mut self, problem: &str) {
        self.reported_problems.add(problem);
    }

    pub(crate) fn drain_reported_problems(&mut self) -> Vec<String> {
        while let Some(error) = self.kept.poll() {
            self.reported_problems.add(&error.to_string());
        }
        self.reported_problems.drain()
    }
}

impl Drop for Sound {
    fn drop(&mut self) {
        self.remember_choice();
        for error in self.kept.finish() {
            self.reported_problems.add(&error.to_string());
        }
    }
}

/// The input to open: the requested device, otherwise the saved one, otherwise the default.
fn wanted(choice: ListenChoice, device: Option<String>, settings: &Settings) -> Target {
    let (remembered, default) = match choice {
        ListenChoice::Microphone => (&settings.microphone, Target::Default),
        ListenChoice::System => (&settings.system, Target::Monitor),
    };
    let asked = device.map(|name| match choice {
        _ if name == DEFAULT_DEVICE => default.clone(),
        ListenChoice::Microphone => Target::Named(name),
        ListenChoice::System => Target::MonitorOf(name),
    });
    asked.or_else(|| remembered.clone().map(Target::Named)).unwrap_or(default)
}

fn record_choice(settings: &mut Settings, target: &Target) {
    match target {
        Target::Default => settings.microphone = None,
        Target::Monitor => settings.system = None,
        // This input was set on the command line, for one run only.
        Target::MonitorOf(_) => {}
        Target::Named(id) | Target::Preferred(id) => {
            let entry = ListedDevice { id: id.clone(), name: String::new() };
            let place = if entry.is_monitor() { &mut settings.system } else { &mut settings.microphone };
            *place = Some(id.clone());
        }
    }
}

/// Returns the outputs as rows of the settings panel, with `target` marked. A song plays on the device `open`.
fn outputs_of(
    device_list: &DeviceList,
    target: Option<&Target>,
    open: Option<&ListedDevice>,
) -> Vec<settings_panel::Output> {
    let default = device_list.default_output.as_ref();
    let default = device_list.outputs.iter().find(|entry| Some(&entry.id) == default);
    let chosen = match target {
        Some(Target::Preferred(id)) => Some(id),
        // A name on the command line may be incomplete, so mark the open device.
        Some(Target::Named(_)) => open.map(|entry| &entry.id),
        _ => None,
    };
    let name = default.map_or_else(
        || "The system's default output".to_owned(),
        |entry| format!("The system's default output ({})", entry.name),
    );
    let mut outputs =
        vec![settings_panel::Output { id: None, name, is_chosen: target == Some(&Target::Default) }];
    outputs.extend(device_list.outputs.iter().map(|entry| settings_panel::Output {
        id: Some(entry.id.clone()),
        name: entry.name.clone(),
        is_chosen: chosen == Some(&entry.id),
    }));
    if let Some(id) = chosen.filter(|id| !device_list.outputs.iter().any(|entry| entry.id == **id)) {
        let name = format!("{id} (not connected)");
        outputs.push(settings_panel::Output { id: Some(id.clone()), name, is_chosen: true });
    }
    outputs
}

fn shift_in_words(shift: f64, device: Option<&str>) -> String {
    let words = match shift {
        0.0 => "frames are shown without a delay".to_owned(),
        later if later > 0.0 => format!("frames are shown {later:.0} ms later"),
        sooner => format!("frames are shown {:.0} ms earlier", -sooner),
    };
    match device {
        Some(device) => format!("{words} · {device}"),
        None => words,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_requested_device_has_priority_over_the_saved_one() {
        let settings = Settings {
            microphone: Some("p:mic".into()),
            system: Some("p:tv.monitor".into()),
            ..Settings::default()
        };
        let named = |name: &str| Target::Named(name.into());
        let (mic, system) = (ListenChoice::Microphone, ListenChoice::System);
        assert_eq!(wanted(mic, None, &settings), named("p:mic"));
        assert_eq!(wanted(system, None, &settings), named("p:tv.monitor"));
        assert_eq!(wanted(mic, Some("usb".into()), &settings), named("usb"));
        assert_eq!(wanted(system, Some("hdmi".into()), &settings), Target::MonitorOf("hdmi".into()));
        assert_eq!(wanted(system, Some("default".into()), &settings), Target::Monitor);
        let none = Settings::default();
        assert_eq!(
            (wanted(mic, None, &none), wanted(system, None, &none)),
            (Target::Default, Target::Monitor)
        );
    }

    #[test]
    fn outputs_are_listed_and_the_chosen_one_is_marked() {
        let entry = |id: &str| ListedDevice { id: id.into(), name: id.to_uppercase() };
        let device_list = DeviceList {
            known: true,
            outputs: vec![entry("p:a"), entry("p:b")],
            default_output: Some("p:b".into()),
            ..DeviceList::default()
        };
        let rows = |target: Option<Target>, open: Option<&str>| {
            let open = open.map(entry);
            let rows = outputs_of(&device_list, target.as_ref(), open.as_ref());
            let mark = |row: &settings_panel::Output| if row.is_chosen { ">" } else { "" };
            rows.iter().map(|row| format!("{}{}", mark(row), row.name)).collect::<Vec<_>>()
        };
        let default = "The system's default output (P:B)";
        assert_eq!(rows(Some(Target::Default), Some("p:b")), [&format!(">{default}"), "P:A", "P:B"]);
        assert_eq!(rows(Some(Target::Preferred("p:a".into())), None), [default, ">P:A", "P:B"]);
        assert_eq!(rows(Some(Target::Named("A".into())), Some("p:a")), [default, ">P:A", "P:B"]);
        assert_eq!(rows(None, None), [default, "P:A", "P:B"], "intended silence");
        let gone = rows(Some(Target::Preferred("p:usb".into())), Some("p:b"));
        assert_eq!(gone[3], ">p:usb (not connected)");
    }

    #[test]
    fn choices_are_saved_by_kind_of_input() {
        let mut settings = Settings::default();
        for name in ["p:mic", "p:tv.monitor"] {
            record_choice(&mut settings, &Target::Named(name.into()));
        }
        assert_eq!(
            (settings.microphone.as_deref(), settings.system.as_deref()),
            (Some("p:mic"), Some("p:tv.monitor"))
        );
        record_choice(&mut settings, &Target::Monitor);
        assert_eq!((settings.microphone.as_deref(), settings.system), (Some("p:mic"), None));
    }

    #[test]
    fn delays_are_reported_with_their_direction() {
        assert!(shift_in_words(35.0, Some("TV")).contains("35 ms later · TV"));
        assert!(shift_in_words(-5.0, None).contains("5 ms earlier"));
        assert!(!shift_in_words(0.0, None).contains("ms"));
    }
}
