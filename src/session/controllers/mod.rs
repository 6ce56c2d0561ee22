//! External controllers: MIDI, OSC and phones. This module takes their input, and sends the show's state to them.
//!
//! The table of commands lists everything that a controller can do. Input arrives through [`InputQueue`], which keeps
//! the newest value of each parameter; the session takes it once per frame.

mod midi;
mod network;
mod phone;

use std::time::{Duration, Instant};

use crate::clock;
use crate::ui::controllers_panel::ControllersState;
use midi::Midi;
use network::Network;
pub use network::sent_addresses;
use phone::Phones;

use crate::config::{ControllerSettings, Folders};
use crate::scenes::SceneSource;
use crate::session::times::Times;
use crate::session::waker::Waker;
use mariana_control::midi::Target;
use mariana_control::{Board, InputBatch, InputQueue, Slider};

/// Minimum interval between two input batches: a flood of messages must not keep the session from drawing.
const INTERVAL: Duration = Duration::from_millis(4);
/// Maximum time between two updates of the state that controllers can read, while the session is awake.
const BOARD_AGE: Duration = Duration::from_millis(40);
/// Maximum time between two updates of the controllers panel.
const PANEL_AGE: Duration = Duration::from_millis(100);

pub(crate) struct Controllers {
    pub(crate) input_queue: InputQueue,
    pub(super) board: Board,
    pub(super) network: Network,
    pub(super) phones: Phones,
    pub(super) midi: Midi,
    /// The parts that could not start, as messages; `true` for bad news.
    news: Vec<(String, bool)>,
    /// Earliest time of the next input batch.
    free: Instant,
    /// Arrival time of the first input that no frame shows yet, and the first scene revision with this input.
    pub(super) unseen: Option<(Instant, u64)>,
    pub(crate) times: Times,
    board_due: Instant,
    panel_due: Instant,
    /// All scenes with their titles, and the scene that was shown when they were listed.
    pub(crate) scenes: (String, Vec<(String, SceneSource)>),
}

impl Controllers {
    pub(crate) fn start(settings: &ControllerSettings, folders: &Folders, waker: &Waker) -> Self {
        let input_queue = InputQueue::new(waker.waking());
        let board = Board::default();
        let mut news = Vec::new();
        let network = Network::start(settings, &input_queue, &board, waker, &mut news);
        let phones = Phones::start(settings, &input_queue, &board, waker, &mut news);
        let midi = Midi::start(settings, folders, &input_queue, waker);
        let now = clock::now();
        Self {
            input_queue,
            board,
            network,
            phones,
            midi,
            news,
            free: now,
            unseen: None,
            times: Times::default(),
            board_due: now,
            panel_due: now,
            scenes: Default::default(),
        }
    }

    /// The next message about devices and networks; `true` for bad news.
    pub(crate) fn news(&mut self) -> Option<(String, bool)> {
        let of_parts = || self.network.news().or_else(|| self.phones.news()).or_else(|| self.midi.news());
        self.news.pop().or_else(of_parts)
    }

    /// Returns `true` if the state that controllers can read must be updated. `turned` is true after input.
    pub(crate) fn board_is_due(&mut self, turned: bool, now: Instant) -> bool {
        let is_asked = self.network.receiver.is_some() || self.phones.remote.is_some();
        let is_due = is_asked && (turned || now >= self.board_due);
        if is_due {
            self.board_due = now + BOARD_AGE;
        }
        is_due
    }

    pub(crate) fn wants_scenes(&self, scene: &str) -> bool {
        self.scenes.0 != scene || self.scenes.1.is_empty()
    }

    pub(crate) fn wanted_pictures(&mut self) -> Vec<SceneSource> {
        let all = &self.scenes.1;
        let of =
            |title: String| all.iter().find(|(known, _)| *known == title).map(|(_, source)| source.clone());
        self.phones.album.drain_requested().into_iter().filter_map(of).collect()
    }

    pub(crate) fn drain(&mut self, now: Instant) -> Option<InputBatch> {
        if now < self.free || !self.input_queue.has_any() {
            return None;
        }
        self.free = now + INTERVAL;
        Some(self.input_queue.drain())
    }

    pub(crate) fn learning_param(&self, scene: Option<&SceneSource>) -> Option<&str> {
        match self.midi.learning()? {
            Target::Param { scene: of, name } if scene.is_some_and(|scene| scene.title() == *of) => {
                Some(name)
            }
            Target::Param { .. } | Target::Action { .. } => None,
        }
    }

    /// The reason why MIDI is not available, as the end of a message; `None` if MIDI is available.
    pub(crate) fn midi_trouble(&self) -> Option<String> {
        match self.midi.state() {
            None => Some("it is off (--midi off)".to_owned()),
            Some(state) => state.trouble,
        }
    }

    pub(crate) fn facts<'a>(&'a self, scene: String, sliders: &'a [Slider]) -> ControllersState<'a> {
        ControllersState {
            scene,
            sliders,
            osc: self.network.state(),
            phone: self.phones.facts(),
            midi: self.midi.state(),
            clock: self.midi.memory.file.clock,
            clock_tempo: self.midi.clock().map(|(reading, _)| reading.tempo),
            counts: self.input_queue.counts(),
            mappings: self.midi.memory.file.mappings.list(),
            learning: self.midi.learning(),
        }
    }

    pub(crate) fn panel_is_due(&mut self, now: Instant) -> bool {
        let is_due = now >= self.panel_due;
        if is_due {
            self.panel_due = now + PANEL_AGE;
        }
        is_due
    }

    /// Notes that input has changed the scene. The input arrived at `since` and is visible from `revision` on.
    pub(crate) fn record_turned(&mut self, since: Option<Instant>, revision: u64) {
        self.unseen = self.unseen.or(since.map(|since| (since, revision)));
    }

    pub(crate) fn record_shown(&mut self, revision: u64) {
        if let Some((since, _)) = self.unseen.take_if(|(_, turned)| revision >= *turned) {
            self.times.record(clock::since(since));
        }
    }

    pub(crate) fn due(&self) -> Option<Instant> {
        let input_queue = self.input_queue.has_any().then_some(self.free);
        // Wake also to update phones, so that they show the effects of their input.
        let board =
            self.phones.remote.as_ref().is_some_and(|remote| remote.phones() > 0).then_some(self.board_due);
        input_queue.into_iter().chain(board).chain(self.network.sample_due()).chain(self.midi.due()).min()
    }
}
