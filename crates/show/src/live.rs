//! Chooses scenes for live input, without knowledge of the music to come.
//!
//! When a scene appears, the director chooses the next scene at once, so that the next scene can be prepared. The
//! next scene appears at a drop, on a beat after a new section has begun, or after a long time.

use super::director::next_scene;
use super::scene_card::SceneCard;
use super::timeline::{Clip, TimedTransition, Timeline};
use mariana_field::lang::TransitionStyle;

/// Minimum and approximate maximum time in seconds between two scene changes.
const CLIP: [f64; 2] = [12.0, 45.0];
/// Time constants of the short and the long average of the energy, in seconds.
const OVER: [f64; 2] = [2.0, 20.0];
/// A section is new if the novelty reaches this value and the peaks of the last sections.
const NOVEL: f32 = 0.8;
/// Time constant of the decay of those peaks, in seconds.
const PEAK: f64 = 15.0;
/// After a section was recognised as new, the scene changes on a beat within this time, in seconds.
const FRESH: f64 = 1.0;
/// Minimum time in seconds between a scene change and a change at a drop.
const BEFORE_DROP: f64 = 4.0;
/// A drop begins if its value rises by more than this.
const DROP_RISE: f32 = 0.5;
/// Below this energy, music is calm and scenes fade slowly. From [`LOUD`] on, scenes cut.
const CALM: f32 = 0.4;
const LOUD: f32 = 0.65;
/// Number of past clips that stay in the timeline.
const KEPT: usize = 2;
/// Placeholder for the start of the next scene in seconds, until the real start is known.
const SOME_DAY: f64 = 1e12;

/// Features of the live input at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hearing {
    /// Time since the input started, in seconds.
    pub time: f64,
    /// Energy, 0..1.
    pub energy: f32,
    /// Tempo in beats per minute; 0 if unknown.
    pub tempo: f32,
    /// Position between the last beat and the next, 0..1.
    pub phase: f32,
    /// How much the last seconds differ from the seconds before ([`LiveSong`](mariana_music::LiveSong)).
    pub novelty: f32,
    /// 1 at a drop, then falling to 0.
    pub drop: f32,
}

/// Chooses scenes for live input.
#[derive(Debug, Clone, Default)]
pub struct LiveDirector {
    cards: Vec<SceneCard>,
    clips: Vec<Clip>,
    seen: Vec<usize>,
    last: Option<Hearing>,
    /// Averages of the energy, with the time constants of [`OVER`].
    energies: [f32; 2],
    /// The decaying peak of the novelty.
    peak: f32,
    /// The time at which a section was last recognised as new.
    new_at: f64,
}

impl LiveDirector {
    /// A director that chooses among these scenes.
    pub fn new(cards: Vec<SceneCard>) -> Self {
        Self { cards, ..Self::default() }
    }

    /// Processes the features of a moment. Returns a new timeline if the scene changes.
    pub fn process(&mut self, heard: Hearing) -> Option<Timeline> {
        let step = self.last.map_or(0.0, |last| heard.time - last.time);
        let has_jumped = !(0.0..5.0).contains(&step);
        let is_beat = heard.tempo <= 0.0 || self.last.is_some_and(|last| heard.phase < last.phase);
        let is_drop = self.last.is_some_and(|last| heard.drop > last.drop + DROP_RISE);
        self.last = Some(heard);
        if self.clips.is_empty() || has_jumped {
            // The input has just started, or has been replaced.
            self.energies = [heard.energy; 2];
            (self.peak, self.new_at) = (0.0, f64::NEG_INFINITY);
            self.clips.clear();
            return self.enter(heard, TimedTransition::new(TransitionStyle::Fade, 1.0));
        }
        for (energy, over) in self.energies.iter_mut().zip(OVER) {
            *energy += (heard.energy - *energy) * (step / over).min(1.0) as f32;
        }
        let [now, before] = self.energies;
        let since = self.clips.iter().rev().nth(1).map_or(0.0, |clip| heard.time - clip.start);
        self.peak *= (-step / PEAK).exp() as f32;
        if heard.novelty >= NOVEL.max(self.peak) {
            (self.peak, self.new_at) = (heard.novelty, heard.time);
        }
        if is_drop && since >= BEFORE_DROP {
            return self.enter(heard, TimedTransition::CUT);
        }
        let is_new = heard.time - self.new_at <= FRESH;
        if !is_beat || since < CLIP[0] || !(is_new || since >= CLIP[1]) {
            return None;
        }
        let (style, seconds) = match is_new {
            true if now > before => (TransitionStyle::Cut, 0.0),
            true => (TransitionStyle::Fade, 2.0),
            // Use no blend, because it would have to start before the music changes.
            false if now < CALM => (TransitionStyle::Fade, 4.0),
            false if now < LOUD => (TransitionStyle::Fade, 2.0),
            false => (TransitionStyle::Cut, 0.0),
        };
        self.enter(heard, TimedTransition::new(style, seconds))
    }

    /// Shows the prepared scene now and chooses the next scene.
    fn enter(&mut self, heard: Hearing, transition: TimedTransition) -> Option<Timeline> {
        self.energies[1] = self.energies[0];
        let expected = self.clips.pop();
        let clip = match expected {
            Some(clip) => Clip { start: heard.time, transition, ..clip },
            None => self.chosen(heard.time, transition)?,
        };
        self.clips.push(clip);
        let next = self.chosen(SOME_DAY, TimedTransition::CUT)?;
        self.clips.push(next);
        let surplus = self.clips.len().saturating_sub(KEPT + 2);
        self.clips.drain(..surplus);
        Timeline::new(self.clips.clone())
    }

    fn chosen(&mut self, start: f64, transition: TimedTransition) -> Option<Clip> {
        let scene = next_scene(&self.cards, &self.seen, self.energies[0])?;
        self.seen.push(scene);
        let scene = self.cards.get(scene)?.scene.clone();
        Some(Clip { start, scene, camera: None, transition, moves: Vec::new() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_field::lang::About;

    fn director() -> LiveDirector {
        let ranges = [(0.0, 0.4), (0.1, 0.5), (0.5, 1.0), (0.6, 1.0)];
        let card = |(index, energy): (usize, (f32, f32))| SceneCard {
            scene: format!("scene {index}"),
            about: About { energy, ..About::default() },
            cameras: Vec::new(),
            params: Vec::new(),
            rise: None,
        };
        LiveDirector::new(ranges.into_iter().enumerate().map(card).collect())
    }

    const QUIET: Hearing =
        Hearing { time: 0.0, energy: 0.3, tempo: 120.0, phase: 0.0, novelty: 0.0, drop: 0.0 };

    /// Returns the start and transition of each scene at 120 beats a minute, if `hearing` returns the energy, the
    /// novelty and the drop at a time.
    fn starts(seconds: usize, hearing: impl Fn(f64) -> Hearing) -> Vec<(f64, TransitionStyle)> {
        let mut director = director();
        let mut found = Vec::new();
        for step in 0..seconds * 50 {
            let time = step as f64 / 50.0;
            let heard = Hearing { time, phase: (time * 2.0).fract() as f32, ..hearing(time) };
            if let Some(timeline) = director.process(heard) {
                let clip = timeline.at(time + 10.0).clip;
                found.push((clip.start, clip.transition.kind.style()));
            }
        }
        found
    }

    #[test]
    fn scenes_change_at_new_sections_or_after_a_while_and_on_a_beat() {
        let even = starts(200, |_| QUIET);
        assert!((4..=6).contains(&even.len()), "{even:?}");
        assert!(even.iter().skip(1).all(|(_, style)| *style == TransitionStyle::Fade), "{even:?}");
        assert!(even.iter().all(|(start, _)| (start * 2.0).fract() < 0.05), "on a beat: {even:?}");
        // A section begins at 30 s, and its novelty rises and falls.
        let novelty = |time: f64| (1.5 - 0.3 * (time - 33.0).abs()).max(0.2) as f32;
        let calm = starts(60, |time| Hearing { novelty: novelty(time), ..QUIET });
        let louder = starts(60, |time| Hearing {
            novelty: novelty(time),
            energy: if time < 30.0 { 0.2 } else { 0.9 },
            ..QUIET
        });
        for (found, style) in [(&calm, TransitionStyle::Fade), (&louder, TransitionStyle::Cut)] {
            let changes: Vec<_> = found.iter().filter(|(start, _)| (1.0..45.0).contains(start)).collect();
            assert!(changes.len() == 1 && (30.5..33.0).contains(&changes[0].0), "{found:?}");
            assert_eq!(changes[0].1, style, "{found:?}");
        }
        // Constant novelty marks no section, and every scene is shown for the minimum time.
        let flicker = starts(100, |time| Hearing { novelty: (3.0 * time).sin() as f32 + 1.0, ..QUIET });
        assert!(flicker.windows(2).all(|pair| pair[1].0 - pair[0].0 >= CLIP[0]), "{flicker:?}");
    }

    #[test]
    fn scenes_cut_at_a_drop_at_once() {
        let drop = |time: f64| if time < 20.3 { 0.0 } else { (1.0 - (time - 20.3) / 4.0).max(0.0) as f32 };
        let found = starts(30, |time| Hearing { drop: drop(time), ..QUIET });
        assert_eq!(found[1], (20.3, TransitionStyle::Cut), "{found:?}");
        assert_eq!(found.len(), 2, "{found:?}");
    }

    #[test]
    fn a_new_input_starts_over_and_no_scene_follows_itself() {
        let mut director = director();
        let mut hear = |time| {
            director
                .process(Hearing { time, energy: 0.5, tempo: 0.0, ..QUIET })
                .map(|timeline| timeline.clips().iter().map(|clip| clip.scene.clone()).collect::<Vec<_>>())
        };
        assert_eq!(hear(100.0).map(|scenes| scenes.len()), Some(2));
        assert_eq!(hear(100.1), None);
        let again = hear(3.0).unwrap();
        assert!(again.windows(2).all(|pair| pair[0] != pair[1]), "{again:?}");
        assert!(hear(f64::NAN).is_some());
    }
}
