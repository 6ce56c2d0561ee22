//! Chooses the scenes for a song automatically.
//!
//! - Scenes change at the starts of sections and at drops. In between, the camera changes after a while, and the scene
//!   changes once all its cameras were shown. Nothing changes during a build.
//! - When a section is repeated, its scene returns, with another camera if the scene has several.
//! - The choice depends on the character of the music, the contrast to the previous scene, and the time since a scene
//!   was last shown, in this song or in an earlier one.
//! - Calm music gets melts and long fades, and loud music gets portals and short fades. Only a drop gets a cut, unless
//!   a scene asks for one, and the camera springs back.
//! - During a build, a parameter of the scene or the camera's zoom moves.
//!
//! Random numbers decide between scenes with equal scores. The seed should be a hash of the song's content, so that a
//! song has the same show on every machine.

mod changes;
mod character;
mod moods;
mod rises;

use std::collections::HashMap;

use super::bar_lines::BarLines;
use super::cue_list::{Anchor, CueList, Entry, Length, Transition, TransitionKind, When};
use super::scene_card::SceneCard;
use changes::{Change, Reason, changes};
use character::Character;
use mariana_field::lang::TransitionStyle;
use mariana_field::world::{BlendKind, PortalShape};
use mariana_music::SongStructure;

/// Music is calm below this energy, and loud from [`LOUD`] on.
const CALM: f32 = 0.45;
const LOUD: f32 = 0.6;
/// Weights of a scene's score. Before the random bonus, a perfect scene scores 0.
mod points {
    /// Points for each unit of energy by which the music is outside the scene's range.
    pub(super) const OUTSIDE: f32 = -6.0;
    /// Points for each unit of energy between the music and the middle of the scene's range.
    pub(super) const OFF_MIDDLE: f32 = -1.0;
    /// Points for a scene that follows what the music has most of.
    pub(super) const FOLLOWS: f32 = 1.0;
    /// Points for moods that suit the music perfectly.
    pub(super) const MOOD: f32 = 5.0;
    /// Points for each mood that the scene shares with the previous scene.
    pub(super) const SAME_MOOD: f32 = -0.3;
    /// Points for a scene that was shown before, divided by the number of scene changes since then.
    pub(super) const SEEN: f32 = -2.0;
    /// Points for the scene that an earlier song showed last. They fall to 0 for scenes that were shown as many scene
    /// changes ago as there are scenes.
    pub(super) const EARLIER_SONG: f32 = -5.0;
    /// Points for a scene that belongs to another section.
    pub(super) const TAKEN: f32 = -1.0;
    /// Maximum random bonus.
    pub(super) const CHANCE: f32 = 0.6;
}

/// Creates a cue list for a song from these scenes. Prefers scenes that are not among the scenes `recent`, which earlier
/// songs have shown, the last one at the end. The list is empty if there are no scenes.
pub fn direct(song: &SongStructure, cards: &[SceneCard], recent: &[String], seed: u64) -> CueList {
    let lines = BarLines::of(song);
    let place = |scene: &String| cards.iter().position(|card| card.scene == *scene);
    let earlier = recent.iter().rev().filter_map(place).collect();
    let mut director = Director { earlier, ..Director::new(cards, seed) };
    let mut cue_list = CueList::default();
    let mut shown: Vec<Shown<'_>> = Vec::new();
    for (index, change) in changes(song, &lines).iter().enumerate() {
        let before = director.seen.last().copied();
        let Some(scene) = director.choose(index, change) else { break };
        let Some(card) = cards.get(scene) else { break };
        let views = 1 + card.cameras.len();
        if before == Some(scene) && views < 2 {
            continue;
        }
        let mut when = change.when.clone();
        let transition = match before.and_then(|before| cards.get(before)) {
            None => None,
            Some(_) if before == Some(scene) => Some(camera_change(change)),
            Some(before) => Some(transition(change, before, card, chance(seed, index, scene) < 0.5)),
        };
        // A blend starts before the section, so that it is half complete when the section starts.
        if change.reason == Reason::Section
            && let Some(Transition { kind: TransitionKind::Blend(_), length: Length::Bars(bars), .. }) =
                transition
        {
            when.offset = Length::Bars(-0.5 * bars);
        }
        let view = director.view(scene);
        cue_list.entries.push(Entry::new(when, &card.scene, view, transition));
        shown.push(Shown { card, time: change.time, is_drop: change.reason == Reason::Drop });
    }
    rises::add(song, &lines, &shown, &mut cue_list);
    cue_list
}

/// The scene of an entry, and its time in seconds.
struct Shown<'a> {
    card: &'a SceneCard,
    time: f64,
    is_drop: bool,
}

/// Returns the cards from which the director chooses: without scenes that are not for shows, unless there are no
/// others.
pub(super) fn for_shows(cards: Vec<SceneCard>) -> Vec<SceneCard> {
    let (outside, others): (Vec<_>, Vec<_>) =
        cards.into_iter().partition(|card| moods::is_outside_shows(&card.about));
    if others.is_empty() { outside } else { others }
}

/// Chooses the scene that follows the scenes `seen` if only the energy of the music is known. Returns `None` if
/// `cards` is empty.
pub(super) fn next_scene(cards: &[SceneCard], seen: &[usize], energy: f32) -> Option<usize> {
    let mut director = Director { seen: seen.to_vec(), ..Director::new(cards, seen.len() as u64) };
    let when = When { anchor: Anchor::Start, offset: Length::ZERO };
    let music = Character::of_energy(energy);
    let change = Change { when, time: 0.0, reason: Reason::Start, letter: None, before: energy, music };
    director.choose(seen.len(), &change)
}

#[derive(Default)]
struct Director<'a> {
    cards: &'a [SceneCard],
    seed: u64,
    of_letter: HashMap<&'a str, usize>,
    /// The scenes in the order of their appearance. The last scene is the current scene.
    seen: Vec<usize>,
    /// The scenes of earlier songs, from the last one back.
    earlier: Vec<usize>,
    /// The letter for which the current scene was chosen; `None` if the scene changed within a section.
    letter: Option<&'a str>,
    /// How many changes of camera the current scene has had.
    turns: usize,
    /// How often each scene was shown with another camera.
    visits: Vec<usize>,
}

impl<'a> Director<'a> {
    fn new(cards: &'a [SceneCard], seed: u64) -> Self {
        Self { cards, seed, visits: vec![0; cards.len()], ..Self::default() }
    }

    /// Chooses the scene from a change on. If the current scene stays, another camera shows it.
    fn choose(&mut self, index: usize, change: &Change<'a>) -> Option<usize> {
        let last = self.seen.last().copied();
        let is_of_section = change.reason != Reason::Long;
        let its_own = change.letter.filter(|_| is_of_section).and_then(|letter| self.of_letter.get(letter));
        let cameras = last.and_then(|last| self.cards.get(last)).map_or(0, |card| card.cameras.len());
        let stays = match change.reason {
            Reason::Start | Reason::Drop => false,
            Reason::Section => last.is_some() && its_own.copied() == last && self.letter == change.letter,
            Reason::Long => self.turns < cameras,
        };
        if let Some(last) = last.filter(|_| stays) {
            self.turns += 1;
            return Some(last);
        }
        let chosen = match its_own.copied().filter(|own| Some(*own) != last) {
            Some(own) => own,
            None => {
                let others =
                    (0..self.cards.len()).filter(|scene| Some(*scene) != last || self.cards.len() == 1);
                others.max_by(|a, b| {
                    self.points(*a, index, change).total_cmp(&self.points(*b, index, change))
                })?
            }
        };
        self.letter = change.letter.filter(|_| is_of_section);
        if let Some(letter) = self.letter {
            self.of_letter.entry(letter).or_insert(chosen);
        }
        self.turns = 0;
        self.seen.push(chosen);
        Some(chosen)
    }

    fn points(&self, scene: usize, index: usize, change: &Change<'_>) -> f32 {
        let Some(card) = self.cards.get(scene) else { return f32::MIN };
        let (low, high) = card.about.energy;
        let energy = change.music.energy();
        let outside = (low - energy).max(energy - high).max(0.0);
        let off_middle = (energy - 0.5 * (low + high)).abs();
        let before = self.seen.last().and_then(|last| self.cards.get(*last));
        let shared = before.map_or(0, |before| {
            card.about.moods.iter().filter(|mood| before.about.moods.contains(mood)).count()
        });
        let ago = self.seen.iter().rev().position(|seen| *seen == scene);
        let changes_since =
            self.earlier.iter().position(|seen| *seen == scene).map(|ago| ago + self.seen.len());
        let forgotten = changes_since.map_or(1.0, |ago| ago as f32 / self.cards.len() as f32);
        let taken = self.of_letter.values().any(|other| *other == scene);
        points::OUTSIDE * outside
            + points::OFF_MIDDLE * off_middle
            + points::MOOD * moods::fit(&card.about, &change.music)
            + points::FOLLOWS * moods::moves(&card.about, &change.music)
            + points::SAME_MOOD * shared as f32
            + ago.map_or(0.0, |ago| points::SEEN / (ago + 1) as f32)
            + points::EARLIER_SONG * (1.0 - forgotten).max(0.0)
            + if taken { points::TAKEN } else { 0.0 }
            + points::CHANCE * chance(self.seed, index, scene)
    }

    /// Returns the camera of a scene; `None` is the default camera. Each time, it is the next of the scene's cameras.
    fn view(&mut self, scene: usize) -> Option<String> {
        let cameras = &self.cards.get(scene)?.cameras;
        let visits = self.visits.get_mut(scene).map_or(0, |visits| std::mem::replace(visits, *visits + 1));
        let view = visits % (cameras.len() + 1);
        view.checked_sub(1).and_then(|view| cameras.get(view)).cloned()
    }
}

/// Returns the fade from one camera of a scene to another.
fn camera_change(change: &Change<'_>) -> Transition {
    let length = match change.music.energy() {
        energy if energy < CALM => Length::Bars(2.0),
        energy if energy < LOUD => Length::Bars(1.0),
        _ => Length::Beats(1.0),
    };
    Transition::new(TransitionStyle::Fade, length)
}

/// Chooses the transition to a scene. The random `coin` decides if several kinds suit the music.
fn transition(change: &Change<'_>, from: &SceneCard, to: &SceneCard, coin: bool) -> Transition {
    if change.reason == Reason::Drop {
        return Transition::CUT;
    }
    let energy = change.music.energy();
    let is_loud = change.before >= LOUD && energy >= LOUD;
    let by_energy = match (change.before, energy) {
        (before, now) if before < CALM && now < CALM => TransitionStyle::Melt,
        _ if is_loud && !coin => TransitionStyle::Fade,
        (before, now) if is_loud || now > before => TransitionStyle::Portal,
        _ if coin => TransitionStyle::Melt,
        _ => TransitionStyle::Fade,
    };
    let style = to.about.enter.or(from.about.leave).unwrap_or(by_energy);
    match style {
        TransitionStyle::Cut => Transition::CUT,
        TransitionStyle::Melt if energy < CALM => Transition::new(style, Length::Bars(4.0)),
        TransitionStyle::Melt => Transition::new(style, Length::Bars(2.0)),
        TransitionStyle::Portal => {
            let shape = match to.about.portal {
                Some(_) => PortalShape::Own,
                None if coin => PortalShape::Ball,
                None => PortalShape::Plane,
            };
            let portal = TransitionKind::Blend(BlendKind::Portal(shape));
            Transition::new(portal, Length::Bars(2.0))
        }
        TransitionStyle::Fade if is_loud => Transition::new(style, Length::Beats(1.0)),
        TransitionStyle::Fade => Transition::new(style, Length::Bars(1.0)),
    }
}

/// Returns a number in 0..1 that looks random and depends only on the arguments (SplitMix64, Steele et al. 2014).
fn chance(seed: u64, index: usize, scene: usize) -> f32 {
    let mut value = seed
        ^ (index as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15)
        ^ (scene as u64).wrapping_mul(0xD1B5_4A32_D192_ED03);
    value = (value ^ (value >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    value = (value ^ (value >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((value ^ (value >> 31)) >> 40) as f32 / (1u64 << 24) as f32
}

#[cfg(test)]
mod tests;
