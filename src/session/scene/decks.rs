//! Two decks, each with a scene, and the crossfader that mixes them.
//!
//! For the rest of the program, decks are a show of two clips whose transition follows a fader
//! ([`PreparedShow::of_decks`]). The fader leads to the deck that was loaded last.

use crate::scenes::SceneSource;
use crate::show::{PreparedShow, TransitionKind};
use crate::ui::overlay::{Deck, DeckStrip};
use mariana_control::Glide;
use mariana_field::world::{BlendKind, PortalShape};

/// The ways to mix two scenes, with their names for users.
pub(crate) const MIXES: [(TransitionKind, &str); 4] = [
    (TransitionKind::Blend(BlendKind::Melt), "melt"),
    (TransitionKind::Fade, "fade"),
    (TransitionKind::Blend(BlendKind::Portal(PortalShape::Ball)), "ball"),
    (TransitionKind::Blend(BlendKind::Portal(PortalShape::Plane)), "plane"),
];

/// The letters of the decks, by their index.
pub(crate) const LETTERS: [char; 2] = ['A', 'B'];

pub(crate) struct Decks {
    scenes: [SceneSource; 2],
    /// Index of the deck that was loaded last.
    last: usize,
    /// 0 shows the first deck, 1 the second.
    crossfade: Glide,
    /// Index in [`MIXES`].
    pub(crate) mix: usize,
    /// When a deck was loaded last, in seconds of the song.
    pub(super) loaded: f64,
    /// Index of the deck whose parameters the sliders and controllers change.
    pub(crate) in_hand: usize,
}

impl Decks {
    /// Starts with these scenes; shows the first one.
    pub(super) fn new(scenes: [SceneSource; 2], loaded: f64) -> Self {
        Self { scenes, last: 1, crossfade: Glide::at(0.0), mix: 0, loaded, in_hand: 0 }
    }

    pub(super) fn show(&self) -> PreparedShow {
        let [from, to] = self.pair();
        PreparedShow::of_decks([from.clone(), to.clone()], self.transition(), self.loaded)
    }

    /// The scenes at the beginning and at the end of the fader.
    pub(super) fn pair(&self) -> [&SceneSource; 2] {
        [&self.scenes[1 - self.last], &self.scenes[self.last]]
    }

    pub(super) fn transition(&self) -> TransitionKind {
        MIXES[self.mix].0
    }

    /// Returns the position of the fader of [`Self::show`].
    pub(super) fn fader(&self, now: f64) -> f32 {
        let crossfade = self.crossfade(now);
        if self.last == 1 { crossfade } else { 1.0 - crossfade }
    }

    /// Returns the position of the crossfader: 0 shows the first deck, 1 the second.
    pub(crate) fn crossfade(&self, now: f64) -> f32 {
        self.crossfade.value(now)
    }

    pub(super) fn moves(&self, now: f64) -> bool {
        self.crossfade.moves(now)
    }

    pub(super) fn set_crossfade(&mut self, position: f32) {
        if position.is_finite() {
            self.crossfade = Glide::at(position.clamp(0.0, 1.0));
        }
    }

    /// Moves the crossfader to the other end within `seconds`; if it is moving, back to where it came from.
    pub(super) fn cross_over(&mut self, seconds: f32, now: f64) {
        let to = if self.crossfade.target() < 0.5 { 1.0 } else { 0.0 };
        self.crossfade = self.crossfade.ramp(to, seconds, now);
    }

    /// Moves the crossfader to its mirrored position at once: at one end, this cuts to the other deck.
    pub(super) fn swap(&mut self, now: f64) {
        self.crossfade = Glide::at(1.0 - self.crossfade(now));
    }

    /// The index of the deck that is less visible, into which scenes are loaded.
    pub(crate) fn cued(&self, now: f64) -> usize {
        usize::from(self.crossfade(now) <= 0.5)
    }

    /// The scene of the more visible deck.
    pub(super) fn foremost(&self, now: f64) -> &SceneSource {
        &self.scenes[1 - self.cued(now)]
    }

    /// Loads a scene into a deck. Returns `false` if the scene is on the other deck.
    pub(super) fn load(&mut self, deck: usize, source: SceneSource, time: f64) -> bool {
        let other = &self.scenes[1 - deck];
        if *other == source {
            return false;
        }
        (self.scenes[deck], self.last, self.loaded) = (source, deck, time);
        true
    }

    pub(super) fn mix_by(&mut self, mix: usize) {
        self.mix = mix.min(MIXES.len() - 1);
    }

    pub(crate) fn scenes(&self) -> &[SceneSource; 2] {
        &self.scenes
    }

    /// Returns the content of the decks' strip. `is_ready` tells whether the next frame can show a scene.
    pub(super) fn strip(&self, now: f64, is_ready: impl Fn(&SceneSource) -> bool) -> DeckStrip {
        let deck = |index: usize| Deck {
            letter: LETTERS[index],
            title: self.scenes[index].title(),
            is_in_hand: self.in_hand == index,
            is_ready: is_ready(&self.scenes[index]),
        };
        let mixes = MIXES.map(|(_, name)| name).to_vec();
        DeckStrip { decks: [deck(0), deck(1)], crossfade: self.crossfade(now), mixes, mix: self.mix }
    }

    pub(super) fn hold_deck(&mut self, deck: usize) {
        self.in_hand = deck.min(1);
    }

    /// The scene whose parameters the sliders and controllers change.
    pub(super) fn scene_in_hand(&self) -> &SceneSource {
        &self.scenes[self.in_hand]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fader_leads_to_the_deck_loaded_last() {
        let [orb, city, heart] = ["orb", "city", "heart"].map(|name| SceneSource::Shipped(name.to_owned()));
        let mut decks = Decks::new([orb.clone(), city.clone()], 0.0);
        assert_eq!((decks.pair(), decks.fader(0.0), decks.cued(0.0)), ([&orb, &city], 0.0, 1));
        decks.set_crossfade(0.75);
        assert_eq!((decks.fader(0.0), decks.cued(0.0)), (0.75, 0));
        assert!(decks.load(0, heart.clone(), 4.0));
        assert_eq!((decks.pair(), decks.fader(0.0), decks.loaded), ([&city, &heart], 0.25, 4.0));
        assert!(!decks.load(0, city.clone(), 5.0), "a scene cannot be mixed with itself");
        let show = decks.show();
        let moment = show.timeline().map(|timeline| timeline.at_end_with(decks.fader(0.0))).unwrap();
        assert_eq!((moment.clip.scene.as_str(), moment.leaving.map(|(_, at)| at)), ("heart", Some(0.25)));
    }

    #[test]
    fn the_crossfader_crosses_over_and_turns_back() {
        let [orb, city] = ["orb", "city"].map(|name| SceneSource::Shipped(name.to_owned()));
        let mut decks = Decks::new([orb, city], 0.0);
        decks.cross_over(2.0, 10.0);
        assert!(decks.moves(11.0));
        assert_eq!([10.0, 11.0, 12.0].map(|now| decks.crossfade(now)), [0.0, 0.5, 1.0]);
        decks.cross_over(2.0, 11.0);
        assert_eq!([11.0, 13.0].map(|now| decks.crossfade(now)), [0.5, 0.0]);
        decks.swap(13.0);
        assert_eq!((decks.crossfade(13.0), decks.moves(13.0)), (1.0, false));
        decks.set_crossfade(f32::NAN);
        decks.set_crossfade(-3.0);
        assert_eq!(decks.crossfade(14.0), 0.0);
        decks.mix_by(99);
        assert_eq!(MIXES[decks.mix].1, "plane");
    }
}
