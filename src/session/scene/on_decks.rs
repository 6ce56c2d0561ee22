//! Changes of the two decks of a scene session.

use super::decks::{Decks, LETTERS, MIXES};
use super::library::SceneLibrary;
use super::messages::Messages;
use super::show_follower::ShowFollower;
use crate::scenes::SceneSource;

/// Write access to the decks. Without decks, most changes only explain how to get decks.
pub(crate) struct DeckChanges<'a> {
    pub(super) decks: &'a mut Option<Decks>,
    pub(super) show: &'a mut ShowFollower,
    pub(super) library: &'a SceneLibrary,
    pub(super) messages: &'a mut Messages,
    /// The time of the parameters' clock, and the time of the song, in seconds.
    pub(super) times: (f64, f64),
}

impl DeckChanges<'_> {
    /// Begins with the requested scene and the next one.
    pub(super) fn begin(&mut self) {
        let shown = match &self.library.wanted {
            SceneSource::Blend(blend) => blend.to.source.clone(),
            source => source.clone(),
        };
        let next = self.library.next_after(&shown, true);
        if next == shown {
            return self.messages.answer("there is no second scene for another deck: open more scenes");
        }
        let (on_a, on_b) = (shown.title(), next.title());
        self.messages.answer(format!(
            "two decks: {on_a} on A, {on_b} on B; Shift+Left and Shift+Right move the crossfader"
        ));
        *self.decks = Some(Decks::new([shown, next], self.times.1));
        self.show();
    }

    /// Returns to one scene, the more visible one.
    pub(super) fn end(&mut self) -> Option<SceneSource> {
        let decks = self.decks.take()?;
        self.show.end_decks();
        self.messages.answer("one scene again: press F3 for two decks");
        let stays = 1 - decks.cued(self.times.0);
        decks.scenes().get(stays).cloned()
    }

    pub(crate) fn set_crossfade(&mut self, position: f32) {
        self.change(|decks, _| decks.set_crossfade(position));
    }

    /// Moves the crossfader by a part of its way.
    pub(crate) fn crossfade_by(&mut self, way: f32) {
        self.change(|decks, now| decks.set_crossfade(decks.crossfade(now) + way));
    }

    /// Moves the crossfader to its other end within `seconds`.
    pub(crate) fn cross_over(&mut self, seconds: f64) {
        self.change(|decks, now| decks.cross_over(seconds as f32, now));
    }

    pub(crate) fn swap(&mut self) {
        self.change(|decks, now| decks.swap(now));
    }

    /// Mixes the decks in another way, by its index in [`MIXES`]; `None` for the next way.
    pub(crate) fn mix_by(&mut self, mix: Option<usize>) {
        self.change(|decks, _| decks.mix_by(mix.unwrap_or((decks.mix + 1) % MIXES.len())));
        self.show();
        if let Some(decks) = &*self.decks {
            self.messages.answer(format!("the decks mix by {}", MIXES[decks.mix].1));
        }
    }

    /// Lets the sliders and controllers change the parameters of this deck's scene.
    pub(crate) fn hold_deck(&mut self, deck: usize) {
        self.change(|decks, _| decks.hold_deck(deck));
        if let Some(decks) = &*self.decks {
            let (title, letter) = (decks.scene_in_hand().title(), LETTERS[decks.in_hand]);
            self.messages.answer(format!("{title} on deck {letter} in hand: the sliders change it"));
        }
    }

    /// Loads a scene into the deck with this index, and takes it in hand.
    pub(crate) fn load(&mut self, deck: usize, source: SceneSource) {
        let (title, time) = (source.title(), self.times.1);
        let mut is_loaded = false;
        self.change(|decks, _| {
            is_loaded = decks.load(deck, source, time);
            decks.hold_deck(if is_loaded { deck } else { decks.in_hand });
        });
        if is_loaded {
            self.show();
            self.messages.answer(format!("{title} on deck {}", LETTERS[deck.min(1)]));
        } else if self.decks.is_some() {
            self.messages.answer(format!("{title} is on the other deck: choose another scene"));
        }
    }

    /// Loads a scene into the less visible deck. Returns the scene if there are no decks.
    pub(super) fn load_cued(&mut self, source: SceneSource) -> Option<SceneSource> {
        let Some(decks) = &*self.decks else { return Some(source) };
        self.load(decks.cued(self.times.0), source);
        None
    }

    /// Returns the neighbour in the list of the less visible deck's scene, but not the scene of the other deck.
    pub(super) fn neighbour(&self, forward: bool) -> Option<SceneSource> {
        let decks = self.decks.as_ref()?;
        let deck = decks.cued(self.times.0);
        let [of, other] = [decks.scenes().get(deck)?, decks.scenes().get(1 - deck)?];
        let next = self.library.next_after(of, forward);
        Some(if next == *other { self.library.next_after(&next, forward) } else { next })
    }

    /// Lets the decks choose the scenes, if there are decks.
    fn show(&mut self) {
        if let Some(decks) = &*self.decks {
            self.show.set_decks(decks.show(), decks.fader(self.times.0));
        }
    }

    fn change(&mut self, change: impl FnOnce(&mut Decks, f64)) {
        match &mut *self.decks {
            Some(decks) => {
                change(decks, self.times.0);
                self.show.set_fader(decks.fader(self.times.0));
            }
            None => self.messages.answer("there is one scene: press F3 for two decks"),
        }
    }
}
