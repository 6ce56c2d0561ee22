//! Changes of the two decks of a scene session.

use super::decks::{Decks, LETTERS, MIXES};
use super::session::SceneSession;
use crate::scenes::SceneSource;

/// Write access to the decks. Without decks, most changes only explain how to get decks.
pub(crate) struct DeckChanges<'a>(pub(super) &'a mut SceneSession);

impl DeckChanges<'_> {
    /// Begins with the requested scene and the next one.
    pub(super) fn begin(&mut self) {
        let shown = self.0.foremost().clone();
        let next = self.0.preparation.library.next_after(&shown, true);
        if next == shown {
            return self.0.messages.answer("there is no second scene for another deck: open more scenes");
        }
        let (on_a, on_b) = (shown.title(), next.title());
        self.0.messages.answer(format!(
            "two decks: {on_a} on A, {on_b} on B; Shift+Left and Shift+Right move the crossfader"
        ));
        self.0.decks = Some(Decks::new([shown, next], self.0.parameters.song_time));
        self.show();
    }

    /// Returns to one scene, the more visible one.
    pub(super) fn end(&mut self) -> Option<SceneSource> {
        let decks = self.0.decks.take()?;
        self.0.show.end_decks();
        self.0.messages.answer("one scene again: press F3 for two decks");
        Some(decks.foremost(self.0.parameters.clock()).clone())
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
        if let Some(decks) = &self.0.decks {
            self.0.messages.answer(format!("the decks mix by {}", MIXES[decks.mix].1));
        }
    }

    /// Lets the sliders and controllers change the parameters of this deck's scene.
    pub(crate) fn hold_deck(&mut self, deck: usize) {
        self.change(|decks, _| decks.hold_deck(deck));
        if let Some(decks) = &self.0.decks {
            let (title, letter) = (decks.scene_in_hand().title(), LETTERS[decks.in_hand]);
            self.0.messages.answer(format!("{title} on deck {letter} in hand: the sliders change it"));
        }
    }

    /// Loads a scene into the deck with this index, and takes it in hand. Returns `false` if it is on the other deck.
    pub(crate) fn load(&mut self, deck: usize, source: SceneSource) -> bool {
        let (title, time) = (source.title(), self.0.parameters.song_time);
        let mut is_loaded = false;
        self.change(|decks, _| {
            is_loaded = decks.load(deck, source, time);
            decks.hold_deck(if is_loaded { deck } else { decks.in_hand });
        });
        if is_loaded {
            self.show();
            self.0.messages.answer(format!("{title} on deck {}", LETTERS[deck.min(1)]));
        } else if self.0.decks.is_some() {
            self.0.messages.answer(format!("{title} is on the other deck: choose another scene"));
        }
        is_loaded
    }

    /// Loads a scene into the less visible deck. Returns the scene if there are no decks.
    pub(super) fn load_cued(&mut self, source: SceneSource) -> Option<SceneSource> {
        let Some(decks) = &self.0.decks else { return Some(source) };
        self.load(decks.cued(self.0.parameters.clock()), source);
        None
    }

    /// Returns the neighbour in the list of the less visible deck's scene, but not the scene of the other deck.
    pub(super) fn neighbour(&self, forward: bool) -> Option<SceneSource> {
        let decks = self.0.decks.as_ref()?;
        let deck = decks.cued(self.0.parameters.clock());
        let [of, other] = [decks.scenes().get(deck)?, decks.scenes().get(1 - deck)?];
        let next = self.0.preparation.library.next_after(of, forward);
        Some(if next == *other { self.0.preparation.library.next_after(&next, forward) } else { next })
    }

    /// Lets the decks choose the scenes, if there are decks.
    fn show(&mut self) {
        if let Some(decks) = &self.0.decks {
            self.0.show.set_decks(decks.show(), decks.fader(self.0.parameters.clock()));
        }
    }

    fn change(&mut self, change: impl FnOnce(&mut Decks, f64)) {
        match &mut self.0.decks {
            Some(decks) => {
                let now = self.0.parameters.clock();
                change(decks, now);
                self.0.show.set_fader(decks.fader(now));
            }
            None => self.0.messages.answer("there is one scene: press F3 for two decks"),
        }
    }
}
