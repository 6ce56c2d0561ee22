//! Chooses the scenes for a song automatically.
//!
//! - Scenes change at the starts of sections, and about every eighth bar in long sections. Scenes do not change
//!   during a build; the next scene starts at the drop.
//! - When a section is repeated, its scene returns, with another camera if the scene has several.
//! - The choice depends on the song's energy, the contrast to the previous scene, and the time since a scene was last
//!   shown.
//! - Calm music gets melts and fades, and loud music gets cuts. Changes between the cameras of a scene follow the
//!   same rule.
//!
//! Random numbers decide between scenes with equal scores. The seed should be a hash of the song's content, so that a
//! song has the same show on every machine.

mod changes;

use std::collections::HashMap;

use super::bar_lines::BarLines;
use super::cue_list::{Anchor, CueList, Entry, Length, Transition, TransitionKind, When};
use changes::{Change, Reason, changes, in_build};
use mariana_field::lang::{About, TransitionStyle};
use mariana_field::world::{BlendKind, PortalShape};
use mariana_music::SongStructure;

/// Facts about a scene from which the director chooses.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneCard {
    /// The name or file of the scene.
    pub scene: String,
    /// The scene's `about` block.
    pub about: About,
    /// The names of the scene's cameras.
    pub cameras: Vec<String>,
}

/// Music is calm below this energy, and loud from [`LOUD`] on.
const CALM: f32 = 0.45;
const LOUD: f32 = 0.6;
/// From this energy on, cameras change twice as often as in loud music.
const VERY_LOUD: f32 = 0.8;

/// The rhythm of camera changes for a range of energy.
struct Turns {
    below: f32,
    bars: f64,
    /// Minimum time in seconds between two camera changes.
    seconds_min: f64,
    /// Duration of the fade in bars; 0 cuts.
    fade: f64,
}

/// From calm to very loud music.
const TURNS: [Turns; 4] = [
    Turns { below: CALM, bars: 6.0, seconds_min: 8.0, fade: 2.0 },
    Turns { below: LOUD, bars: 4.0, seconds_min: 8.0, fade: 1.0 },
    Turns { below: VERY_LOUD, bars: 4.0, seconds_min: 4.0, fade: 0.0 },
    Turns { below: f32::INFINITY, bars: 2.0, seconds_min: 4.0, fade: 0.0 },
];

/// Weights of a scene's score. Before the random bonus, a perfect scene scores 0.
mod points {
    /// Points for each unit of energy by which the music is outside the scene's range.
    pub(super) const OUTSIDE: f32 = -6.0;
    /// Points for each unit of energy between the music and the middle of the scene's range.
    pub(super) const OFF_MIDDLE: f32 = -1.0;
    /// Points for each mood that the scene shares with the previous scene.
    pub(super) const SAME_MOOD: f32 = -0.3;
    /// Points for a scene that was shown before, divided by the number of scene changes since then.
    pub(super) const SEEN: f32 = -2.0;
    /// Points for a scene that belongs to another section.
    pub(super) const TAKEN: f32 = -1.0;
    /// Maximum random bonus.
    pub(super) const CHANCE: f32 = 0.6;
}

/// Creates a cue list for a song from these scenes. The list is empty if there are no scenes.
pub fn direct(song: &SongStructure, cards: &[SceneCard], seed: u64) -> CueList {
    let lines = BarLines::of(song);
    let mut director =
        Director { cards, seed, of_letter: HashMap::new(), seen: Vec::new(), visits: vec![0; cards.len()] };
    let changes = changes(song, &lines);
    let mut cue_list = CueList::default();
    for (index, change) in changes.iter().enumerate() {
        let Some(card) = director.choose(index, change) else { return cue_list };
        let before = director.seen.last().and_then(|before| cards.get(*before));
        let coin = chance(seed, index, card) < 0.5;
        let transition = before.map(|before| transition(change, before, &cards[card], coin));
        director.seen.push(card);
        let end = changes.get(index + 1).map_or(song.seconds, |next| next.time);
        let views = director.views(card, index, change);
        // A blend starts before the section, so that it is half complete when the section starts.
        let lead = match transition {
            Some(Transition { kind: TransitionKind::Blend(_), length: Length::Bars(bars), .. }) => bars / 2.0,
            _ => 0.0,
        };
        let mut when = change.when.clone();
        if lead > 0.0 && when.offset == Length::ZERO {
            when.offset = Length::Bars(-lead);
        }
        cue_list.entries.push(Entry::new(
            when,
            &cards[card].scene,
            views.first().cloned().flatten(),
            transition,
        ));
        let turns = turns_at(change.energy);
        for (number, bar) in bars_of(turns, song, &lines, change, end).into_iter().enumerate() {
            let Some(camera) = views.get((number + 1) % views.len().max(1)) else { break };
            if views.len() < 2 {
                break;
            }
            let when = When { anchor: Anchor::Bar(bar), offset: Length::ZERO };
            let how = match turns.fade {
                0.0 => Transition::CUT,
                bars => Transition::new(TransitionStyle::Fade, Length::Bars(bars)),
            };
            cue_list.entries.push(Entry::new(when, &cards[card].scene, camera.clone(), Some(how)));
        }
    }
    cue_list
}

/// Chooses the scene that follows the scenes `seen` if only the energy of the music is known. Returns `None` if
/// `cards` is empty.
pub(super) fn next_scene(cards: &[SceneCard], seen: &[usize], energy: f32) -> Option<usize> {
    let (of_letter, visits) = (HashMap::new(), Vec::new());
    let mut director = Director { cards, seed: seen.len() as u64, of_letter, seen: seen.to_vec(), visits };
    let when = When { anchor: Anchor::Start, offset: Length::ZERO };
    let change = Change { when, time: 0.0, reason: Reason::Long, letter: None, before: energy, energy };
    director.choose(seen.len(), &change)
}

struct Director<'a> {
    cards: &'a [SceneCard],
    seed: u64,
    of_letter: HashMap<&'a str, usize>,
    seen: Vec<usize>,
    visits: Vec<usize>,
}

impl<'a> Director<'a> {
    fn choose(&mut self, index: usize, change: &Change<'a>) -> Option<usize> {
        let last = self.seen.last().copied();
        let its_own = change.letter.and_then(|letter| self.of_letter.get(letter)).copied();
        let is_first_of_section = change.reason != Reason::Long;
        let chosen = match its_own.filter(|own| is_first_of_section && Some(*own) != last) {
            Some(own) => own,
            None => {
                let others =
                    (0..self.cards.len()).filter(|scene| Some(*scene) != last || self.cards.len() == 1);
                others.max_by(|a, b| {
                    self.points(*a, index, change).total_cmp(&self.points(*b, index, change))
                })?
            }
        };
        if let Some(letter) = change.letter.filter(|_| is_first_of_section) {
            self.of_letter.entry(letter).or_insert(chosen);
        }
        Some(chosen)
    }

    fn points(&self, scene: usize, index: usize, change: &Change<'_>) -> f32 {
        let Some(card) = self.cards.get(scene) else { return f32::MIN };
        let (low, high) = card.about.energy;
        let outside = (low - change.energy).max(change.energy - high).max(0.0);
        let off_middle = (change.energy - 0.5 * (low + high)).abs();
        let before = self.seen.last().and_then(|last| self.cards.get(*last));
        let shared = before.map_or(0, |before| {
            card.about.moods.iter().filter(|mood| before.about.moods.contains(mood)).count()
        });
        let ago = self.seen.iter().rev().position(|seen| *seen == scene);
        let taken = self.of_letter.values().any(|other| *other == scene);
        points::OUTSIDE * outside
            + points::OFF_MIDDLE * off_middle
            + points::SAME_MOOD * shared as f32
            + ago.map_or(0.0, |ago| points::SEEN / (ago + 1) as f32)
            + if taken { points::TAKEN } else { 0.0 }
            + points::CHANCE * chance(self.seed, index, scene)
    }

    /// Returns the cameras of a scene in the order in which the show uses them; `None` is the default camera. When a
    /// scene is shown again, it starts with another camera.
    fn views(&mut self, scene: usize, index: usize, change: &Change<'_>) -> Vec<Option<String>> {
        let Some(card) = self.cards.get(scene) else { return Vec::new() };
        let mut views: Vec<Option<String>> = vec![None];
        let mut others: Vec<&String> = card.cameras.iter().collect();
        if change.energy >= LOUD {
            others.sort_by_key(|name| (1e6 * chance(self.seed ^ text_hash(name), index, scene)) as u32);
        }
        views.extend(others.into_iter().cloned().map(Some));
        let visits = self.visits.get_mut(scene).map_or(0, |visits| std::mem::replace(visits, *visits + 1));
        let count = views.len();
        views.rotate_left(visits % count);
        views
    }
}

/// Chooses the transition to a scene. The random `coin` decides if several kinds suit the music.
fn transition(change: &Change<'_>, from: &SceneCard, to: &SceneCard, coin: bool) -> Transition {
    if change.reason == Reason::Drop {
        return Transition::CUT;
    }
    let by_energy = match (change.before, change.energy) {
        (before, now) if before < CALM && now < CALM => TransitionStyle::Melt,
        (before, now) if before >= LOUD && now >= LOUD => TransitionStyle::Cut,
        (before, now) if now > before => TransitionStyle::Portal,
        _ if coin => TransitionStyle::Melt,
        _ => TransitionStyle::Fade,
    };
    let style = to.about.enter.or(from.about.leave).unwrap_or(by_energy);
    match style {
        TransitionStyle::Cut => Transition::CUT,
        TransitionStyle::Melt if change.energy < CALM => Transition::new(style, Length::Bars(4.0)),
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
        TransitionStyle::Fade => Transition::new(style, Length::Bars(1.0)),
    }
}

fn turns_at(energy: f32) -> &'static Turns {
    let [calm, even, loud, very_loud] = &TURNS;
    [calm, even, loud].into_iter().find(|turns| energy < turns.below).unwrap_or(very_loud)
}

/// Returns the bars in which the camera changes, between a scene change and the next scene change at `end` seconds.
fn bars_of(turns: &Turns, song: &SongStructure, lines: &BarLines, change: &Change<'_>, end: f64) -> Vec<u32> {
    let first = lines.bar_at(change.time + 0.05).floor();
    let bar = lines.time_of(first + 1.0) - lines.time_of(first);
    if song.beats.is_empty() || bar <= 0.0 {
        return Vec::new();
    }
    let mut step = turns.bars;
    while step * bar < turns.seconds_min {
        step *= 2.0;
    }
    let all = (1..).map(|number| first + f64::from(number) * step);
    let within = all.take_while(|bar| lines.time_of(*bar) + turns.seconds_min < end && *bar < 1e6);
    let fits = |bar: &f64| *bar >= 1.0 && !in_build(song, lines, lines.time_of(*bar));
    within.filter(fits).map(|bar| bar as u32).collect()
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

fn text_hash(text: &str) -> u64 {
    // FNV-1a.
    text.bytes()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests;
