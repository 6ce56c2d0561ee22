//! MIDI input: connected devices, mappings of knobs, and learning.

use std::time::Instant;

use crate::clock;
use crate::commands;
use crate::config::{ControllerSettings, Folders, KnobEdit, KnobMemory};
use crate::session::scene::SceneSession;
use crate::session::waker::Waker;
use crate::ui::controllers_panel::words_of;
use mariana_control::InputQueue;
use mariana_control::midi::{
    ClockReading, KnobMove, Learning, Mapping, MidiHub, MidiState, Outcome, Ports, SystemPorts, Target,
};

pub(crate) struct Midi {
    hub: Option<MidiHub>,
    pub(crate) memory: KnobMemory,
    learning: Option<Learning>,
    /// The connected devices in the last report; `None` before the first check.
    reported: Option<Vec<String>>,
    /// Messages to report; `true` for bad news.
    news: Vec<(String, bool)>,
    zero: Instant,
}

impl Midi {
    pub(super) fn start(
        settings: &ControllerSettings,
        folders: &Folders,
        input_queue: &InputQueue,
        waker: &Waker,
    ) -> Self {
        let (memory, trouble) = KnobMemory::among(folders);
        let mut news: Vec<(String, bool)> =
            trouble.into_iter().map(|error| (error.to_string(), true)).collect();
        let hub = settings.midi.then(|| MidiHub::start(ports(folders), input_queue.clone(), waker.waking()));
        let hub = hub.and_then(|started| {
            started.map_err(|error| news.push((format!("cannot receive MIDI: {error}"), true))).ok()
        });
        Self { hub, memory, learning: None, reported: None, news, zero: clock::now() }
    }

    /// The next message about devices; `true` for bad news.
    pub(super) fn news(&mut self) -> Option<(String, bool)> {
        self.update_devices();
        while let Some(kept) = self.memory.poll() {
            self.news.extend(kept.err().map(|error| (error.to_string(), true)));
        }
        (!self.news.is_empty()).then(|| self.news.remove(0))
    }

    fn update_devices(&mut self) {
        let Some(state) = self.state().filter(|state| state.is_known) else { return };
        if self.reported.as_ref() == Some(&state.devices) {
            return;
        }
        let before = self.reported.replace(state.devices.clone());
        let is_first = before.is_none();
        let before = before.unwrap_or_default();
        for gone in before.iter().filter(|name| !state.devices.contains(name)) {
            let learning =
                if self.learning.is_some() { "; learning continues with the other devices" } else { "" };
            self.news.push((format!("{gone} was disconnected{learning}"), true));
        }
        for come in state.devices.iter().filter(|name| !before.contains(name)) {
            // Devices connected at the start are not announced over the frame.
            self.news.push((format!("receiving MIDI from {come}"), !is_first));
        }
    }

    pub(super) fn state(&self) -> Option<MidiState> {
        self.hub.as_ref().map(MidiHub::state)
    }

    /// The last reading of the MIDI clock, if it is followed, and that clock's current time in seconds.
    pub(crate) fn clock(&self) -> Option<(ClockReading, f64)> {
        self.hub.as_ref().filter(|_| self.memory.file.clock)?.clock()
    }

    pub(super) fn learning(&self) -> Option<&Target> {
        self.learning.as_ref().map(Learning::target)
    }

    pub(crate) fn start_learning(&mut self, target: Target) {
        let is_same = self.learning() == Some(&target);
        self.learning = (!is_same).then(|| Learning::of(target));
    }

    pub(crate) fn stop_learning(&mut self) -> bool {
        self.learning.take().is_some()
    }

    /// Returns the effects of the moved `knobs`. `levels` are the values of actions. While a mapping is learned, knobs
    /// have no effect.
    pub(crate) fn apply(
        &mut self,
        knobs: &[KnobMove],
        scene: &SceneSession,
        levels: &[(&str, f32)],
    ) -> Vec<Outcome> {
        let title = scene.parameters_in_hand().title().unwrap_or_default();
        let stands = |target: &Target| match target {
            Target::Param { scene: of, name } => {
                let params = Some(scene.parameters_in_hand()).filter(|_| *of == title)?;
                let slider = params.sliders().iter().rfind(|slider| slider.name == *name)?;
                let (to, _) = params.target(name)?;
                Some(slider.param().fraction_of(to))
            }
            Target::Action { name, .. } => {
                levels.iter().find(|(level, _)| level == name).map(|(_, value)| *value)
            }
        };
        let now = clock::since(self.zero).as_secs_f64();
        let mut outcomes = Vec::new();
        for knob in knobs {
            match &mut self.learning {
                Some(learning) => learning.notice(knob, now),
                None => {
                    self.record_encoder(knob);
                    let mappings = &mut self.memory.file.mappings;
                    outcomes.extend(mappings.apply(knob, commands::for_controllers(), stands));
                }
            }
        }
        outcomes
    }

    /// Keeps the encoding of a knob that turned out to be an encoder.
    fn record_encoder(&mut self, knob: &KnobMove) {
        let KnobMove { source, device, encoding: Some(encoding), .. } = knob else { return };
        let is_new = |one: &&Mapping| one.encoding.is_none() && one.is_moved_by(knob);
        let new: Vec<Mapping> = self.memory.file.mappings.list().iter().filter(is_new).cloned().collect();
        if !new.is_empty() {
            self.news.push((format!("{source} of {device} is an endless knob"), true));
        }
        for before in new {
            let after = Mapping { encoding: Some(*encoding), ..before.clone() };
            self.memory.change(&KnobEdit::Change(before, after));
        }
    }

    pub(crate) fn finish_learning(&mut self) -> Option<String> {
        let now = clock::since(self.zero).as_secs_f64();
        let mapping = self.learning.as_ref()?.learned(now)?;
        self.learning = None;
        let is_known = self.memory.file.mappings.list().iter().any(|one| {
            (&one.device, one.source, &one.target) == (&mapping.device, mapping.source, &mapping.target)
        });
        let (device, source, target) = (mapping.device.clone(), mapping.source, words_of(&mapping.target));
        self.memory.change(&KnobEdit::Add(mapping));
        let again = if is_known { " already" } else { "" };
        Some(format!("{source} of {device} turns {target}{again}"))
    }

    pub(super) fn due(&self) -> Option<Instant> {
        let at = self.learning.as_ref()?.known_at()?;
        Some(self.zero + std::time::Duration::try_from_secs_f64(at).unwrap_or_default())
    }
}

fn ports(folders: &Folders) -> Box<dyn Ports> {
    #[cfg(all(unix, any(debug_assertions, feature = "fake-midi")))]
    if let Some(folder) = &folders.midi_ports {
        return Box::new(mariana_control::midi::FolderPorts(folder.clone()));
    }
    #[cfg(not(all(unix, any(debug_assertions, feature = "fake-midi"))))]
    let _ = folders;
    Box::new(SystemPorts)
}
