//! MIDI in the show: devices that are heard, what their knobs turn, and what is being learned.

use std::time::Instant;

use crate::clock;
use crate::commands;
use crate::config::{ControllerSettings, Folders, KnobEdit, KnobMemory};
use crate::session::scene::SceneSession;
use crate::session::waker::Waker;
use crate::ui::controllers_panel::words_of;
use mariana_control::midi::{
    ClockReading, KnobMove, Learning, Mapping, MidiHub, MidiState, Outcome, Ports, SystemPorts, Target,
};
use mariana_control::{InputQueue, Param};

/// See the module.
pub(super) struct Midi {
    hub: Option<MidiHub>,
    memory: KnobMemory,
    learning: Option<Learning>,
    /// The devices when they were last told; none before the first look.
    reported: Option<Vec<String>>,
    /// Sentences that are to be told, and whether each is bad news.
    news: Vec<(String, bool)>,
    /// The zero of the seconds of learning.
    zero: Instant,
    /// Counts the changes of what is mapped and learned.
    revision: u64,
}

impl Midi {
    /// Hears devices from now on, if they are wanted.
    pub(super) fn start(
        settings: &ControllerSettings,
        folders: &Folders,
        input_queue: &InputQueue,
        waker: &Waker,
    ) -> Self {
        let (memory, trouble) = KnobMemory::among(folders);
        let mut news: Vec<(String, bool)> =
            trouble.into_iter().map(|error| (error.to_string(), true)).collect();
        let of_hub = waker.clone();
        let hub =
            settings.midi.then(|| MidiHub::start(ports(folders), input_queue.clone(), move || of_hub.wake()));
        let hub = hub.and_then(|started| {
            started.map_err(|error| news.push((format!("MIDI is not heard: {error}"), true))).ok()
        });
        Self { hub, memory, learning: None, reported: None, news, zero: clock::now(), revision: 0 }
    }

    /// What is new of devices: a sentence, and whether it is bad news.
    pub(super) fn news(&mut self) -> Option<(String, bool)> {
        self.look_at_devices();
        while let Some(kept) = self.memory.poll() {
            self.revision += 1;
            self.news.extend(kept.err().map(|error| (error.to_string(), true)));
        }
        (!self.news.is_empty()).then(|| self.news.remove(0))
    }

    fn look_at_devices(&mut self) {
        let Some(state) = self.state().filter(|state| state.is_known) else { return };
        if self.reported.as_ref() == Some(&state.devices) {
            return;
        }
        let before = self.reported.replace(state.devices.clone());
        self.revision += 1;
        let is_first = before.is_none();
        let before = before.unwrap_or_default();
        for gone in before.iter().filter(|name| !state.devices.contains(name)) {
            let learning = if self.learning.is_some() { "; learning goes on with what is there" } else { "" };
            self.news.push((format!("{gone} was pulled{learning}"), true));
        }
        for come in state.devices.iter().filter(|name| !before.contains(name)) {
            // What was there at the start is no news to anybody who looks at the picture.
            self.news.push((format!("MIDI is heard from {come}"), !is_first));
        }
    }

    /// How it stands with devices; none if MIDI is not wanted.
    pub(super) fn state(&self) -> Option<MidiState> {
        self.hub.as_ref().map(MidiHub::state)
    }

    /// What is mapped.
    pub(super) fn mappings(&self) -> &[Mapping] {
        self.memory.file().mappings.list()
    }

    /// Whether a device's clock sets the tempo, if one has a clock.
    pub(super) fn follows_clock(&self) -> bool {
        self.memory.file().clock
    }

    /// What the clock says that is followed, and its seconds now.
    pub(super) fn clock(&self) -> Option<(ClockReading, f64)> {
        self.hub.as_ref().filter(|_| self.follows_clock())?.clock()
    }

    /// A number that changes with what is mapped and learned, and with the devices.
    pub(super) fn revision(&self) -> u64 {
        self.revision
    }

    /// What is being learned.
    pub(super) fn learning(&self) -> Option<&Target> {
        self.learning.as_ref().map(Learning::target)
    }

    /// Learns what turns something, or stops learning it.
    pub(super) fn learn(&mut self, target: Target) {
        let is_same = self.learning() == Some(&target);
        self.learning = (!is_same).then(|| Learning::of(target));
        self.revision += 1;
    }

    /// Stops learning. Returns whether something was being learned.
    pub(super) fn stop_learning(&mut self) -> bool {
        let learned = self.learning.take().is_some();
        self.revision += u64::from(learned);
        learned
    }

    /// Changes what is mapped. What cannot be kept is told.
    pub(super) fn edit(&mut self, edit: &KnobEdit) {
        self.memory.change(edit);
        self.revision += 1;
    }

    /// What follows from knobs that moved. A knob that is being learned turns nothing meanwhile.
    pub(super) fn take(&mut self, knobs: &[KnobMove], scene: &SceneSession) -> Vec<Outcome> {
        let title = scene.scenes().name().unwrap_or_default();
        let stands = |name: &str| {
            let slider = scene.scenes().sliders().iter().rfind(|slider| slider.name == name)?;
            let (to, _) = scene.shown_parameters().target(name)?;
            let (min, max, default) = (slider.min, slider.max, slider.default);
            Some(Param { name, min, max, default }.fraction_of(to))
        };
        let now = clock::since(self.zero).as_secs_f64();
        let mut outcomes = Vec::new();
        for knob in knobs {
            match &mut self.learning {
                Some(learning) => learning.notice(knob, now),
                None => {
                    let mappings = &mut self.memory.file_mut().mappings;
                    outcomes.extend(mappings.apply(knob, &title, commands::for_controllers(), stands));
                }
            }
        }
        outcomes
    }

    /// Notes what was learned, once that is known, and says it.
    pub(super) fn finish_learning(&mut self) -> Option<String> {
        let now = clock::since(self.zero).as_secs_f64();
        let mapping = self.learning.as_ref()?.learned(now)?;
        self.learning = None;
        let is_known = self.mappings().iter().any(|one| {
            (&one.device, one.source, &one.target) == (&mapping.device, mapping.source, &mapping.target)
        });
        let (device, source, target) = (mapping.device.clone(), mapping.source, words_of(&mapping.target));
        self.edit(&KnobEdit::Add(mapping));
        let again = if is_known { " already" } else { "" };
        Some(format!("{source} of {device} turns {target}{again}"))
    }

    /// When something that is being learned is known.
    pub(super) fn due(&self) -> Option<Instant> {
        let at = self.learning.as_ref()?.known_at()?;
        Some(self.zero + std::time::Duration::try_from_secs_f64(at).unwrap_or_default())
    }
}

/// The system's ports, or in builds for tests those of a folder.
fn ports(folders: &Folders) -> Box<dyn Ports> {
    #[cfg(all(unix, any(debug_assertions, feature = "fake-midi")))]
    if let Some(folder) = &folders.midi_ports {
        return Box::new(mariana_control::midi::FolderPorts(folder.clone()));
    }
    #[cfg(not(all(unix, any(debug_assertions, feature = "fake-midi"))))]
    let _ = folders;
    Box::new(SystemPorts)
}
