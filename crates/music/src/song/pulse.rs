//! The likeliest beats of a whole song, from the odds of a beat at each hop.
//!
//! The model is the bar pointer of [`crate::beat`]: a state is a period and a phase within the period. The likeliest
//! path of states is decoded (Viterbi 1967; for beats Krebs, Böck and Widmer 2015). The result is final after
//! [`SETTLED_SECONDS`], so that the memory does not grow with the song.

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
    beats
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
