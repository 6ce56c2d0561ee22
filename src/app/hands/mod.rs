//! Hands from outside: what devices and networks wish for, and what the show tells them.
//!
//! Everything that a hand can do stands in one table ([`deeds`]). What hands wish for comes in by [`Wishes`], the newest
//! value of each parameter; the show takes it once for each picture.

pub(super) mod deeds;
mod network;
pub mod page;

use std::time::{Duration, Instant};

use network::Network;

use super::overlay::Slider;
use super::window_thread::Waker;
use crate::config::HandSettings;
use mariana_control::{Board, Heard, Present, PresentParam, Wishes};
use mariana_music::{Features, SongMoment};

/// How often wishes are taken at most: a flood must not keep the show from drawing.
const INTERVAL: Duration = Duration::from_millis(4);
/// How old what is put up for others gets at most while the show is awake.
const BOARD_AGE: Duration = Duration::from_millis(40);

/// See the module.
pub(super) struct Hands {
    wishes: Wishes,
    board: Board,
    network: Network,
    /// When wishes may be taken again.
    free: Instant,
    /// When the board is put up again.
    board_due: Instant,
    /// The titles of all scenes, as they were when this scene came on.
    scenes: (String, Vec<String>),
}

impl Hands {
    /// Hands that wake the show when they wish for something.
    pub(super) fn start(settings: &HandSettings, waker: &Waker) -> Self {
        let of_wishes = waker.clone();
        let wishes = Wishes::new(move || of_wishes.wake());
        let board = Board::default();
        let network = Network::start(settings, &wishes, &board, waker);
        let now = Instant::now();
        Self { wishes, board, network, free: now, board_due: now, scenes: Default::default() }
    }

    /// What is new of devices and networks: a sentence, and whether it is bad news.
    pub(super) fn news(&mut self) -> Option<(String, bool)> {
        self.network.news()
    }

    /// What is heard now, for those outside.
    pub(super) fn note_sound(&mut self, features: &Features, song: &SongMoment, now: Instant) {
        self.network.note_sound(features, song, now);
    }

    /// Whether the board is to be put up now; `turned` if something was turned or done.
    pub(super) fn board_is_due(&mut self, turned: bool, now: Instant) -> bool {
        let is_due = self.network.is_asked() && (turned || now >= self.board_due);
        if is_due {
            self.board_due = now + BOARD_AGE;
        }
        is_due
    }

    /// Puts up how the show stands. `titles` are those of all scenes, which are asked for when another scene is on.
    pub(super) fn put_up(
        &mut self,
        scene: String,
        sliders: &[Slider],
        (switches, tempo): (Vec<(&'static str, bool)>, f32),
        titles: impl FnOnce() -> Vec<String>,
    ) {
        if self.scenes.0 != scene || self.scenes.1.is_empty() {
            self.scenes = (scene.clone(), titles());
        }
        let param = |slider: &Slider| PresentParam {
            name: slider.name.clone(),
            value: slider.value,
            min: slider.min,
            max: slider.max,
            default: slider.default,
            hand: slider.hand,
        };
        let params = sliders.iter().map(param).collect();
        self.board.put(Present { scene, scenes: self.scenes.1.clone(), params, switches, tempo });
    }

    /// What was wished for, if it is time to look.
    pub(super) fn take(&mut self, now: Instant) -> Option<Heard> {
        if now < self.free || !self.wishes.has_any() {
            return None;
        }
        self.free = now + INTERVAL;
        Some(self.wishes.take())
    }

    /// When there is something to do for hands.
    pub(super) fn due(&self) -> Option<Instant> {
        let wishes = self.wishes.has_any().then_some(self.free);
        wishes.into_iter().chain(self.network.sample_due()).min()
    }

    /// Counts what nothing here is meant by.
    pub(super) fn note_unknown(&self) {
        self.wishes.refuse(|refusals| refusals.unknown += 1);
    }
}
