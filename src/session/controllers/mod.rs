//! Hands from outside: what devices and networks wish for, and what the show tells them.
//!
//! Everything that a hand can do stands in the table of commands. What hands wish for comes in by [`InputQueue`], the newest
//! value of each parameter; the show takes it once for each picture.

mod midi;
mod network;
pub mod page;
mod phone;

use std::time::{Duration, Instant};

use crate::clock;
use crate::ui::controllers_panel::ControllersState;
use midi::Midi;
use network::Network;
use phone::Phones;

use crate::config::{ControllerSettings, Folders, KnobEdit};
use crate::scenes::SceneSource;
use crate::session::frame_times::FrameTimes;
use crate::session::scene::SceneSession;
use crate::session::waker::Waker;
use crate::thumbnails::Looked;
use mariana_control::midi::{ClockReading, KnobMove, Outcome, Target};
use mariana_control::{Board, InputBatch, InputQueue, Present, Slider};
use mariana_music::{Features, SongMoment};

/// How often wishes are taken at most: a flood must not keep the show from drawing.
const INTERVAL: Duration = Duration::from_millis(4);
/// How old what is put up for others gets at most while the show is awake.
const BOARD_AGE: Duration = Duration::from_millis(40);
/// The same of the panel.
const PANEL_AGE: Duration = Duration::from_millis(100);

/// See the module.
pub(crate) struct Controllers {
    input_queue: InputQueue,
    board: Board,
    network: Network,
    phones: Phones,
    midi: Midi,
    /// When wishes may be taken again.
    free: Instant,
    /// When the first of the wishes came that no frame shows yet, and the revision of the scene that shows them.
    unseen: Option<(Instant, u64)>,
    /// From messages to frames.
    times: FrameTimes,
    /// When the board is put up again.
    board_due: Instant,
    /// When the panel is brought up to date again, and what it knew of mappings.
    panel_due: Instant,
    panel_revision: u64,
    /// All scenes with their titles, as they were when this scene came on.
    scenes: (String, Vec<(String, SceneSource)>),
}

impl Controllers {
    /// Hands that wake the show when they wish for something.
    pub(crate) fn start(settings: &ControllerSettings, folders: &Folders, waker: &Waker) -> Self {
        let of_input_queue = waker.clone();
        let input_queue = InputQueue::new(move || of_input_queue.wake());
        let board = Board::default();
        let network = Network::start(settings, &input_queue, &board, waker);
        let phones = Phones::start(settings, &input_queue, &board, waker);
        let midi = Midi::start(settings, folders, &input_queue, waker);
        let now = clock::now();
        Self {
            input_queue,
            board,
            network,
            phones,
            midi,
            free: now,
            unseen: None,
            times: FrameTimes::default(),
            board_due: now,
            panel_due: now,
            panel_revision: u64::MAX,
            scenes: Default::default(),
        }
    }

    /// What is new of devices and networks: a sentence, and whether it is bad news.
    pub(crate) fn news(&mut self) -> Option<(String, bool)> {
        self.network.news().or_else(|| self.phones.news()).or_else(|| self.midi.news())
    }

    /// What is heard now, for those outside.
    pub(crate) fn note_sound(&mut self, features: &Features, song: &SongMoment, now: Instant) {
        self.network.note_sound(features, song, now);
    }

    /// Whether the board is to be put up now; `turned` if something was turned or done.
    pub(crate) fn board_is_due(&mut self, turned: bool, now: Instant) -> bool {
        let is_asked = self.network.is_asked() || self.phones.is_asked();
        let is_due = is_asked && (turned || now >= self.board_due);
        if is_due {
            self.board_due = now + BOARD_AGE;
        }
        is_due
    }

    /// Whether all scenes are to be noted, because another one is on the stage.
    pub(crate) fn wants_scenes(&self, scene: &str) -> bool {
        self.scenes.0 != scene || self.scenes.1.is_empty()
    }

    /// Notes all scenes, in the order of their numbers, while this one is on the stage.
    pub(crate) fn note_scenes(&mut self, scene: String, scenes: Vec<SceneSource>) {
        self.scenes = (scene, scenes.into_iter().map(|source| (source.title(), source)).collect());
    }

    /// The scenes of which phones want small pictures that nobody looks for yet.
    pub(crate) fn wanted_pictures(&mut self) -> Vec<SceneSource> {
        let all = &self.scenes.1;
        let of =
            |title: String| all.iter().find(|(known, _)| *known == title).map(|(_, source)| source.clone());
        self.phones.wanted_pictures().into_iter().filter_map(of).collect()
    }

    /// Takes in what was found out about a scene, for phones.
    pub(crate) fn note_picture(&mut self, looked: &Looked) {
        self.phones.note_picture(looked);
    }

    /// Puts up how the show stands, with these sliders.
    pub(crate) fn put_up(&mut self, present: Present, sliders: &[Slider]) {
        let scenes = self.scenes.1.iter().map(|(title, _)| title.clone()).collect();
        self.board.put(Present { scenes, params: sliders.to_vec(), ..present });
    }

    /// What was wished for, if it is time to look.
    pub(crate) fn take(&mut self, now: Instant) -> Option<InputBatch> {
        if now < self.free || !self.input_queue.has_any() {
            return None;
        }
        self.free = now + INTERVAL;
        Some(self.input_queue.take())
    }

    /// What follows from knobs that moved, and what was learned by them, in words.
    pub(crate) fn take_knobs(
        &mut self,
        knobs: &[KnobMove],
        scene: &SceneSession,
    ) -> (Vec<Outcome>, Option<String>) {
        (self.midi.take(knobs, scene), self.midi.finish_learning())
    }

    /// The parameter of a scene that a knob is being learned for.
    pub(crate) fn learning_param(&self, scene: Option<&SceneSource>) -> Option<&str> {
        match self.midi.learning()? {
            Target::Param { scene: of, name } if scene.is_some_and(|scene| scene.title() == *of) => {
                Some(name)
            }
            Target::Param { .. } | Target::Action { .. } => None,
        }
    }

    /// Learns what turns something, or stops learning it.
    pub(crate) fn learn(&mut self, target: Target) {
        self.midi.learn(target);
    }

    /// Stops learning. Returns whether something was being learned.
    pub(crate) fn stop_learning(&mut self) -> bool {
        self.midi.stop_learning()
    }

    /// Changes what is mapped.
    pub(crate) fn edit(&mut self, edit: &KnobEdit) {
        self.midi.edit(edit);
    }

    /// Whether MIDI is heard at all, or why not, as the end of a sentence.
    pub(crate) fn midi_trouble(&self) -> Option<String> {
        match self.midi.state() {
            None => Some("it is off (--midi off)".to_owned()),
            Some(state) => state.trouble,
        }
    }

    /// What the panel shows, of a scene with these sliders.
    pub(crate) fn facts<'a>(&'a self, scene: String, sliders: &'a [Slider]) -> ControllersState<'a> {
        let (messages, refusals) = self.input_queue.counts();
        ControllersState {
            scene,
            sliders,
            osc: self.network.state(),
            phone: self.phones.facts(),
            midi: self.midi.state(),
            clock: self.midi.follows_clock(),
            clock_tempo: self.midi.clock().map(|(reading, _)| reading.tempo),
            counts: (messages, refusals.count()),
            mappings: self.midi.mappings(),
            learning: self.midi.learning(),
        }
    }

    /// Whether the panel is to be brought up to date: something was changed, or it is a while since.
    pub(crate) fn panel_is_due(&mut self, now: Instant) -> bool {
        let is_due = now >= self.panel_due || self.midi.revision() != self.panel_revision;
        if is_due {
            (self.panel_due, self.panel_revision) = (now + PANEL_AGE, self.midi.revision());
        }
        is_due
    }

    /// What a device's clock says, and the clock's seconds now; none without one.
    pub(crate) fn clock(&self) -> Option<(ClockReading, f64)> {
        self.midi.clock()
    }

    /// Whether messages have changed the scene and no picture shows it yet.
    pub(crate) fn are_unseen(&self) -> bool {
        self.unseen.is_some()
    }

    /// Wishes that came first at `since` have changed the scene, which shows them from this revision on.
    pub(crate) fn note_turned(&mut self, since: Option<Instant>, revision: u64) {
        self.unseen = self.unseen.or(since.map(|since| (since, revision)));
    }

    /// A frame is on the screen that shows the scene at this revision.
    pub(crate) fn note_shown(&mut self, revision: u64) {
        if let Some((since, _)) = self.unseen.take_if(|(_, turned)| revision >= *turned) {
            self.times.note(clock::since(since));
        }
    }

    /// How long it took from messages to frames, for the log.
    pub(crate) fn times(&self) -> &FrameTimes {
        &self.times
    }

    /// When there is something to do for hands.
    pub(crate) fn due(&self) -> Option<Instant> {
        let input_queue = self.input_queue.has_any().then_some(self.free);
        // What a phone has done is to be seen there also where nothing else wakes the show.
        let board = self.phones.are_there().then_some(self.board_due);
        input_queue.into_iter().chain(board).chain(self.network.sample_due()).chain(self.midi.due()).min()
    }

    /// Counts what nothing here is meant by.
    pub(crate) fn note_unknown(&self) {
        self.input_queue.refuse(|refusals| refusals.unknown += 1);
    }
}
