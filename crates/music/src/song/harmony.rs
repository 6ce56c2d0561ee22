//! The likeness of two stretches of a song in harmony. Stretches are compared beat by beat, along a diagonal of the
//! self-similarity matrix (Goto 2003), so that sequences of chords and melodies count instead of sets of notes.
//! Distances are relative to the song's mean, so that the notes of its key do not count. Transpositions are allowed:
//! Goto rotates the pitch classes in the same way.

use std::ops::Range;

use super::units::Unit;

/// A variation of the harmony below this distance from the song's mean is noise. The chroma vectors have the length 1.
const NOISE: f32 = 0.2;
/// A stretch may begin or end outside the other stretch by one part in this many of its length.
const OVERHANG: usize = 4;
/// The largest transposition in semitones, and the distance that it adds.
const TRANSPOSED: (usize, f32) = (3, 0.15);
/// The least mean squared variation of the harmony within two stretches that are compared in a transposition. Held
/// chords have less: every held chord is the transposition of another.
const MOVING_MIN: f32 = 0.02;

pub(super) struct Harmony {
    /// The square roots of each beat's chroma fractions, less their mean over the song; 0 without pitches.
    beats: Vec<[f32; 12]>,
    mean: [f32; 12],
}

impl Harmony {
    pub(super) fn new(units: &[Unit]) -> Self {
        let at = |index: usize| units.get(index).map_or([0.0; 12], |unit| unit.chroma);
        // Average each beat with its neighbours, because notes may begin a little early or late.
        let roots: Vec<[f32; 12]> = (0..units.len())
            .map(|index| {
                let [before, here, after] = [index.saturating_sub(1), index, index + 1].map(at);
                std::array::from_fn(|class| ((before[class] + here[class] + after[class]) / 3.0).sqrt())
            })
            .collect();
        let pitched = roots.iter().filter(|beat| is_pitched(beat)).count().max(1) as f32;
        let mean = std::array::from_fn(|class| roots.iter().map(|beat| beat[class]).sum::<f32>() / pitched);
        let less_mean = |beat: [f32; 12]| {
            if is_pitched(&beat) { std::array::from_fn(|class| beat[class] - mean[class]) } else { beat }
        };
        Self { beats: roots.into_iter().map(less_mean).collect(), mean }
    }

    /// Returns the distance of two stretches of beats at their best alignment and transposition: 0 for equal stretches,
    /// about 0.8 for unrelated ones.
    pub(super) fn distance(&self, a: Range<usize>, b: Range<usize>) -> f32 {
        let (Some(a), Some(b)) = (self.beats.get(a), self.beats.get(b)) else { return f32::INFINITY };
        let (short, long) = if a.len() <= b.len() { (a, b) } else { (b, a) };
        let moving = variation(short).min(variation(long)) >= MOVING_MIN;
        let overhang = short.len() / OVERHANG;
        let last = long.len() - short.len() + 2 * overhang;
        // `start` is the beat of `long` at which `raised` begins, plus the overhang.
        let aligned = |raised: &[[f32; 12]], start: usize, step: usize| {
            let skipped = overhang.saturating_sub(start);
            let (a, b) = (raised.get(skipped..), long.get((start + skipped).saturating_sub(overhang)..));
            distance(a.unwrap_or_default(), b.unwrap_or_default(), step)
        };
        let mut least = f32::INFINITY;
        for up in (0..12).filter(|up| (*up).min(12 - up) <= if moving { TRANSPOSED.0 } else { 0 }) {
            let raised: Vec<[f32; 12]> = short.iter().map(|beat| self.transposed(beat, up)).collect();
            // Every second beat suffices to find the best alignment, because beats include their neighbours.
            let starts = (0..=last).step_by(2).map(|start| (start, aligned(&raised, start, 2)));
            let Some((start, _)) = starts.min_by(|a, b| a.1.total_cmp(&b.1)) else { continue };
            let extra = if up == 0 { 0.0 } else { TRANSPOSED.1 };
            for start in start.saturating_sub(1)..=(start + 1).min(last) {
                least = least.min(aligned(&raised, start, 1) + extra);
            }
        }
        least
    }

    fn transposed(&self, beat: &[f32; 12], up: usize) -> [f32; 12] {
        if up == 0 || !is_pitched(beat) {
            return *beat;
        }
        std::array::from_fn(|class| {
            let from = (class + 12 - up) % 12;
            beat[from] + self.mean[from] - self.mean[class]
        })
    }
}

fn is_pitched(beat: &[f32; 12]) -> bool {
    beat.iter().any(|x| *x != 0.0)
}

/// Returns the mean squared distance of the beats from their mean.
fn variation(beats: &[[f32; 12]]) -> f32 {
    let count = beats.len().max(1) as f32;
    let of_class = |class: usize| {
        let sum: f32 = beats.iter().map(|beat| beat[class]).sum();
        let squares: f32 = beats.iter().map(|beat| beat[class] * beat[class]).sum();
        (squares - sum * sum / count) / count
    };
    (0..12).map(of_class).sum()
}

/// Returns the root mean square of the squared distances of every `step`-th beat, relative to their squared distances
/// from the song's mean. Due to the root mean square, sequences that are equal in one half are farther apart than
/// sequences that differ a little everywhere.
fn distance(a: &[[f32; 12]], b: &[[f32; 12]], step: usize) -> f32 {
    let (mut squares, mut away, mut count) = (0.0, 0.0, 0.0_f32);
    for (a, b) in a.iter().zip(b).step_by(step) {
        let mut apart = 0.0;
        for (x, y) in a.iter().zip(b) {
            apart += (x - y) * (x - y);
            away += x * x + y * y;
        }
        squares += apart * apart;
        count += 1.0;
    }
    if count == 0.0 { f32::INFINITY } else { (squares * count).sqrt() / (away + 2.0 * NOISE * NOISE * count) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Beats of triads on these roots.
    fn triads(roots: &[usize]) -> Vec<Unit> {
        let triad = |root: &usize| {
            let class = |class: usize| [0, 4, 7].contains(&((class + 12 - root) % 12));
            let chroma = std::array::from_fn(|index| if class(index) { 1.0 / 3.0 } else { 0.0 });
            Unit { chroma, level: 60.0, low: 0.0, onsets: 0.0, timbre: [0.0; 20] }
        };
        roots.iter().flat_map(|root| std::iter::repeat_n(triad(root), 4)).collect()
    }

    #[test]
    fn sequences_are_found_late_and_transposed_but_held_chords_are_not_transposed() {
        let harmony = Harmony::new(&triads(&[0, 5, 7, 2, 9, 9, 2, 7, 7, 0, 5, 7, 2, 1, 6, 8, 3]));
        assert!(harmony.distance(0..16, 36..52) < 0.1);
        assert!(harmony.distance(0..16, 32..52) < 0.1, "a beat late");
        let raised = harmony.distance(0..16, 52..68);
        assert!((0.1..0.25).contains(&raised), "{raised}");
        assert!(harmony.distance(0..16, 16..32) > 0.5);
        let held = Harmony::new(&triads(&[0, 0, 0, 0, 2, 2, 2, 2, 0, 0, 0, 0]));
        assert!(held.distance(1..15, 17..31) > 0.5 && held.distance(1..15, 33..47) < 0.01);
        assert_eq!(held.distance(0..4, 80..84), f32::INFINITY);
    }
}
