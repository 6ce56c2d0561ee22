//! The likeliest beats of a whole song, from the odds of a beat at each hop.
//!
//! The model is the bar pointer of [`crate::beat`]: a state is a period and a phase within the period. The likeliest
//! path of states is decoded (Viterbi 1967; for beats Krebs, Böck and Widmer 2015). The result is final after
//! [`SETTLED_SECONDS`], so that the memory does not grow with the song.

use super::heard::{Heard, Moment};
use super::strengths::{leveled, onset_strengths};
use crate::activation::STEP_HOPS;

/// The range of tempos, in beats per minute.
const TEMPO: (f64, f64) = (54.0, 216.0);
/// The cost of a change of the period at a beat, per relative change, and the largest change in hops.
const STIFFNESS: f32 = 150.0;
const REACH: usize = 10;
/// A beat lasts this many hops.
const START: usize = 2;
/// The log odds at which a beat is worth its place.
const USUAL: f32 = -3.5;
/// The range of the log odds.
const ODDS: (f32, f32) = (-6.0, 6.0);

/// The path is decoded in stretches of this length, and older beats than this are final, in seconds.
const STRETCH_SECONDS: f64 = 240.0;
const SETTLED_SECONDS: f64 = 60.0;

struct Ring {
    period: usize,
    /// The index of phase 0.
    head: usize,
    /// The value of the best path to each state.
    best: Vec<f32>,
}

impl Ring {
    fn at(&self, phase: usize) -> f32 {
        self.best[(self.head + phase) % self.period]
    }
}

struct Path {
    rings: Vec<Ring>,
    /// For each hop since `first` and each ring, the ring from which the best path comes at a beat.
    came_from: Vec<u8>,
    first: usize,
    leaving: Vec<f32>,
}

impl Path {
    fn new(hop_seconds: f64) -> Self {
        let period = |tempo: f64| (60.0 / tempo / hop_seconds).round().max(3.0) as usize;
        let ring = |period: usize| Ring { period, head: 0, best: vec![0.0; period] };
        let rings: Vec<Ring> = (period(TEMPO.1)..=period(TEMPO.0)).take(256).map(ring).collect();
        Self { leaving: vec![0.0; rings.len()], rings, came_from: Vec::new(), first: 0 }
    }

    fn follow(&mut self, odds: f32) {
        for (ring, leaving) in self.rings.iter_mut().zip(&mut self.leaving) {
            ring.head = (ring.head + ring.period - 1) % ring.period;
            *leaving = ring.best[ring.head];
        }
        let shortest = self.rings.first().map_or(0, |ring| ring.period);
        let reward = odds.clamp(ODDS.0, ODDS.1) - USUAL;
        for (index, ring) in self.rings.iter_mut().enumerate() {
            let first = index.saturating_sub(REACH);
            let near = self.leaving.iter().enumerate().take(index + REACH + 1).skip(first);
            let (from, value) = near.fold((index, f32::MIN), |best, (from, value)| {
                let change = (shortest + from).abs_diff(ring.period) as f32 / ring.period as f32;
                let value = value - STIFFNESS * change;
                if value > best.1 { (from, value) } else { best }
            });
            ring.best[ring.head] = value;
            self.came_from.push(from as u8);
            for phase in 0..START {
                ring.best[(ring.head + phase) % ring.period] += reward;
            }
        }
    }

    /// Returns the beats of the best path, as hops.
    fn beats(&self) -> Vec<usize> {
        let states = self
            .rings
            .iter()
            .enumerate()
            .flat_map(|(index, ring)| (0..ring.period).map(move |phase| (index, phase, ring.at(phase))));
        let Some((mut index, phase, _)) = states.max_by(|a, b| a.2.total_cmp(&b.2)) else {
            return Vec::new();
        };
        let count = self.came_from.len() / self.rings.len();
        let mut beats = Vec::new();
        let mut hop = count.checked_sub(1 + phase);
        while let Some(here) = hop {
            beats.push(self.first + here);
            index = usize::from(self.came_from[here * self.rings.len() + index]);
            hop = here.checked_sub(self.rings[index].period);
        }
        beats.reverse();
        beats
    }

    /// Forgets all hops before `hop`.
    fn forget(&mut self, hop: usize) {
        self.came_from.drain(..(hop - self.first) * self.rings.len());
        self.first = hop;
        let states = self.rings.iter().flat_map(|ring| &ring.best);
        let largest = states.fold(f32::MIN, |largest, value| largest.max(*value));
        self.rings.iter_mut().flat_map(|ring| &mut ring.best).for_each(|value| *value -= largest);
    }
}

/// Returns the likeliest beats, as hops.
pub(super) fn likeliest_beats(odds: &[f32], hop_seconds: f64) -> Vec<usize> {
    let hops = |seconds: f64| (seconds / hop_seconds) as usize;
    let (stretch, settled) = (hops(STRETCH_SECONDS), hops(SETTLED_SECONDS));
    let mut path = Path::new(hop_seconds);
    let mut beats: Vec<usize> = Vec::new();
    // Two paths may differ where they meet.
    let apart = hops(0.5 * 60.0 / TEMPO.1);
    let join = |beats: &mut Vec<usize>, more: Vec<usize>, end: usize| {
        let after = beats.last().map_or(0, |last| last + apart);
        beats.extend(more.into_iter().filter(|beat| (after..end).contains(beat)));
    };
    for (hop, odds) in odds.iter().enumerate() {
        path.follow(*odds);
        if hop + 1 - path.first >= stretch + settled {
            let end = hop + 1 - settled;
            join(&mut beats, path.beats(), end);
            path.forget(end);
        }
    }
    join(&mut beats, path.beats(), usize::MAX);
    // If a song begins with a beat, the rounding of the period may put this beat just before the song.
    if let [first, second, ..] = beats[..]
        && first.abs_diff(second - first) <= EARLY
    {
        beats.insert(0, 0);
    }
    beats
}

// The beats of a whole song: the likeliest path ([`super::pulse`]) through the odds of a beat at each moment
// ([`crate::activation`]), at the likeliest metrical level ([`super::strengths`]), from the first to the last stretch of
// the song with a steady beat.

/// Onsets appear in the flux this many hops late.
const FLUX_LATE: f64 = 0.6;
/// The onset of a beat is searched within this many hops before and after the beat.
const AROUND: usize = 2;
/// The first beat may be this many hops before its sound: 64 ms, about the usual tolerance for beats.
const EARLY: usize = 6;
const BEATS_MIN: usize = 8;
/// A stretch of this many successive beats may be steady.
const STRETCH_BEATS: usize = 32;
/// The least mean log odds of the beats of a steady stretch.
const STEADY_MIN: f32 = -2.2;
/// At a tenth of the beats, the flux is at least this. In swelling chords and in vibrato it is less than 0.2.
const FLUX_LOUD_MIN: f32 = 0.25;

/// Returns the times of the beats in seconds; empty if there is no steady beat.
pub(super) fn beats(heard: &Heard) -> Vec<f64> {
    let odds = each_hop(&heard.beat_odds, heard.moments.len());
    let found = likeliest_beats(&odds, heard.hop_seconds);
    let found = steady(&found, &odds);
    let found = leveled(heard, found, &odds);
    let found = sounding(&found, &heard.moments);
    if found.len() < BEATS_MIN || loud_flux(found, &heard.moments) < FLUX_LOUD_MIN {
        return Vec::new();
    }
    let strengths = onset_strengths(heard);
    found.iter().map(|moment| refined(*moment, &strengths) * heard.hop_seconds).collect()
}

/// Interpolates the log odds of the steps for each of `hops` hops.
fn each_hop(odds: &[f32], hops: usize) -> Vec<f32> {
    let at = |step: usize| odds.get(step).or(odds.last()).copied().unwrap_or_default();
    let between = |hop: usize| {
        let (step, rest) = (hop / STEP_HOPS, (hop % STEP_HOPS) as f32 / STEP_HOPS as f32);
        at(step) * (1.0 - rest) + at(step + 1) * rest
    };
    (0..hops).map(between).collect()
}

/// Returns the beats from the first to the last stretch with likely beats.
fn steady<'a>(beats: &'a [usize], odds: &[f32]) -> &'a [usize] {
    let likely = |stretch: &[usize]| {
        let sum: f32 = stretch.iter().filter_map(|beat| odds.get(*beat)).sum();
        sum >= STEADY_MIN * stretch.len() as f32
    };
    let length = STRETCH_BEATS.min(beats.len()).max(1);
    let first = beats.windows(length).position(likely);
    let last = beats.windows(length).rposition(likely);
    let range = first.zip(last).map(|(first, last)| first..last + length);
    range.and_then(|range| beats.get(range)).unwrap_or_default()
}

/// Removes the beats before the first sound and after the last sound.
fn sounding<'a>(beats: &'a [usize], moments: &[Moment]) -> &'a [usize] {
    let loudest = moments.iter().fold(0.0_f32, |loudest, moment| loudest.max(moment.power));
    let sounds = |moment: &Moment| moment.power > (loudest * 1e-5).max(1e-9);
    let (Some(first), Some(last)) = (moments.iter().position(sounds), moments.iter().rposition(sounds))
    else {
        return &[];
    };
    let from = beats.partition_point(|beat| beat + EARLY < first);
    let to = beats.partition_point(|beat| *beat <= last);
    beats.get(from..to).unwrap_or_default()
}

/// Returns the flux that is exceeded near a tenth of the beats.
fn loud_flux(beats: &[usize], moments: &[Moment]) -> f32 {
    let near = |beat: &usize| {
        let around = beat.saturating_sub(AROUND)..(beat + AROUND + 1).min(moments.len());
        moments.get(around).unwrap_or_default().iter().fold(0.0_f32, |most, moment| most.max(moment.flux))
    };
    let mut flux: Vec<f32> = beats.iter().map(near).collect();
    flux.sort_by(f32::total_cmp);
    flux.get(flux.len() * 9 / 10).copied().unwrap_or_default()
}

/// Returns the position of the onset near `beat`, in hops, with a fraction.
fn refined(beat: usize, strengths: &[f32]) -> f64 {
    let around = beat.saturating_sub(2)..(beat + 3).min(strengths.len());
    let (mut sum, mut weight) = (0.0, 0.0);
    for moment in around {
        let strength = f64::from(strengths[moment]);
        sum += strength * moment as f64;
        weight += strength;
    }
    let place = if weight > 0.3 { sum / weight } else { beat as f64 };
    (place - FLUX_LATE).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The song is longer than two stretches. The period changes from 45 to 60 hops and back.
    #[test]
    fn beats_of_a_long_song_are_found_where_stretches_meet() {
        let hop_seconds = 0.012;
        let mut truth = vec![20];
        while truth.last().is_some_and(|last| *last < 60_000) {
            let last = truth[truth.len() - 1];
            truth.push(last + if (22_000..30_000).contains(&last) { 60 } else { 45 });
        }
        let mut odds = vec![-5.0; 60_100];
        truth.iter().for_each(|beat| odds[*beat] = 1.0);
        let found = likeliest_beats(&odds, hop_seconds);
        let hit = |beat: &&usize| found.iter().any(|found| found.abs_diff(**beat) <= 1);
        let hits = truth.iter().filter(hit).count();
        assert!(hits + 12 >= truth.len(), "{hits} of {} beats", truth.len());
        assert!(found.len() <= truth.len() + 6, "{} instead of {} beats", found.len(), truth.len());
    }
}
