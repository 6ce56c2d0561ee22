//! The strengths of onsets, relative to the usual strength nearby.

use super::heard::{Heard, Moment, SLOW_HOPS};
use super::key::likeliest_states;
use super::units::{chroma, distance, standardised};
use crate::onset::FLUX_MIN;

/// Onset strengths are relative to the largest flux within this many seconds before and after the moment.
const LARGEST_SECONDS: f64 = 1.5;
/// The time over which the mean onset strength is subtracted, and over which the strengths are scaled, in seconds.
const MEAN_SECONDS: f64 = 0.4;
const SCALE_SECONDS: f64 = 6.0;
/// The root mean square of the strengths counts as at least this much.
const SCALE_MIN: f32 = 0.02;

/// Returns onset strengths, 0..1, relative to the largest flux nearby ([`LARGEST_SECONDS`]).
pub(super) fn onset_strengths(heard: &Heard) -> Vec<f32> {
    let reach = (LARGEST_SECONDS / heard.hop_seconds) as usize;
    let flux: Vec<f32> = heard.moments.iter().map(|moment| moment.flux).collect();
    let largest = largest_around(&flux, reach);
    flux.iter().zip(largest).map(|(flux, largest)| flux / largest.max(FLUX_MIN)).collect()
}

/// Returns the largest value within `reach` of each index.
fn largest_around(values: &[f32], reach: usize) -> Vec<f32> {
    let largest = |index: usize| {
        let around = &values[index.saturating_sub(reach)..(index + reach + 1).min(values.len())];
        around.iter().fold(f32::MIN, |largest, value| largest.max(*value))
    };
    (0..values.len()).map(largest).collect()
}

/// Returns how much each value exceeds the mean around it, relative to the root mean square of these excesses nearby.
pub(super) fn excesses(values: &[f32], hop_seconds: f64) -> Vec<f32> {
    let reach = |seconds: f64| (0.5 * seconds / hop_seconds) as usize;
    let means = means_around(values.iter().copied(), reach(MEAN_SECONDS));
    let above: Vec<f32> = values.iter().zip(means).map(|(value, mean)| (value - mean).max(0.0)).collect();
    let squares = means_around(above.iter().map(|value| value * value), reach(SCALE_SECONDS));
    above.iter().zip(squares).map(|(value, square)| value / square.max(0.0).sqrt().max(SCALE_MIN)).collect()
}

/// Returns the mean of the values within `reach` of each value.
fn means_around(values: impl Iterator<Item = f32>, reach: usize) -> Vec<f32> {
    let mut sums = vec![0.0_f64];
    for value in values {
        sums.push(sums.last().copied().unwrap_or_default() + f64::from(value));
    }
    let count = sums.len() - 1;
    let mean = |index: usize| {
        let (from, to) = (index.saturating_sub(reach), (index + reach + 1).min(count));
        ((sums[to] - sums[from]) / (to - from) as f64) as f32
    };
    (0..count).map(mean).collect()
}

pub(super) fn deviation(values: &[f32]) -> f32 {
    let count = values.len().max(1) as f32;
    let mean = values.iter().sum::<f32>() / count;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f32>() / count).sqrt()
}

// The metrical level of a song's beats: all beats that were found, every second one, or twice as many. The likeliest
// level is decided for each stretch of the song. Bars speak for a level: of three or four beats, one has the change of
// harmony or the kick. Onsets at the thirds of beats speak against it.

/// The range of tempos, in beats per minute.
const TEMPO: (f64, f64) = (48.0, 225.0);
/// The level is decided in stretches of this length, in seconds.
const STRETCH_SECONDS: f64 = 60.0;
/// The cost of a change of level between two stretches.
const CHANGE: f32 = 4.0;

/// The minimum number of beats in a stretch, and the evidence for a level with fewer beats.
const BEATS_OF_STRETCH_MIN: usize = 5;
const NO_EVIDENCE: f32 = -30.0;
/// The evidence for a level: its likeliest tempo in beats per minute, the cost per squared octave of distance from this
/// tempo, and the weights of measurements: at beats, at their halves and thirds, and contrasts of every third or fourth
/// beat (the bar), every fourth and every sixth. The weights were fitted to game music and generated songs.
const LIKELY: (f64, f32) = (201.0, 2.67);
const STRUCK: f32 = 1.86;
const STRUCK_LOW: f32 = 1.29;
const ODDS: f32 = 3.01;
const HALF_HIGH: f32 = 1.33;
const THIRD_LOW: f32 = -7.68;
const THIRD_HARMONY: f32 = -5.2;
const BAR_HARMONY: f32 = 4.61;
const BAR_DRUMS: f32 = 4.76;
const FOURTH: f32 = -1.91;
const SIXTH_HIGH: f32 = 0.88;
/// The onset of a beat is searched within this many hops before and after the beat.
const AROUND: usize = 2;
/// The harmony of this time before a moment is compared with the harmony after it, in seconds.
const HARMONY_SECONDS: f64 = 0.46;

/// Returns the beats of the likeliest level in each stretch: all `beats`, every second one, or twice as many.
pub(super) fn leveled(heard: &Heard, beats: &[usize], odds: &[f32]) -> Vec<usize> {
    let every_second = |first: usize| beats.iter().copied().skip(first).step_by(2).collect::<Vec<usize>>();
    let between = beats.windows(2).flat_map(|pair| [pair[0], (pair[0] + pair[1]) / 2]);
    let levels = [beats.to_vec(), every_second(0), every_second(1), between.collect()];
    let hops = heard.moments.len();
    let length = (STRETCH_SECONDS / heard.hop_seconds) as usize;
    let count = (hops / length.max(1)).max(1);
    let evidence = Evidence::new(heard, odds);
    let inside = |level: &[usize], stretch: usize| {
        let place = |hop: usize| level.partition_point(|beat| *beat < hop);
        place(stretch * hops / count)..place((stretch + 1) * hops / count)
    };
    let of = |stretch: usize| {
        levels.iter().map(|level| evidence.of(&level[inside(level, stretch)])).collect::<Vec<f32>>()
    };
    let scores: Vec<Vec<f32>> = (0..count).map(of).collect();
    let mut found: Vec<usize> = Vec::new();
    for (stretch, choice) in likeliest_states(&scores, CHANGE).into_iter().enumerate() {
        let mine = levels.get(choice).map_or(&[][..], |level| &level[inside(level, stretch)]);
        let apart = mine.windows(2).next().map_or(1, |pair| 3 * (pair[1] - pair[0]) / 5);
        let after = found.last().map_or(0, |last| last + apart);
        found.extend(mine.iter().filter(|beat| **beat >= after));
    }
    found
}

/// Measures how likely beats are. The strengths are the largest nearby, relative to the usual strength.
struct Evidence {
    all: Vec<f32>,
    low: Vec<f32>,
    high: Vec<f32>,
    /// How much the harmony changes, standardised.
    harmony: Vec<f32>,
    odds: Vec<f32>,
    hop_seconds: f64,
}

impl Evidence {
    fn new(heard: &Heard, odds: &[f32]) -> Self {
        let hop_seconds = heard.hop_seconds;
        let of = |value: fn(&Moment) -> f32| {
            let values: Vec<f32> = heard.moments.iter().map(value).collect();
            let strengths = excesses(&values, hop_seconds);
            let scale = 0.5 / deviation(&strengths).max(1e-6);
            largest_around(&strengths, AROUND).into_iter().map(|strength| scale * strength).collect()
        };
        let change = |slow: usize| {
            let time = (slow * SLOW_HOPS) as f64 * hop_seconds;
            let chroma = |from, to| chroma(heard, from, to);
            distance(&chroma(time - HARMONY_SECONDS, time), &chroma(time, time + HARMONY_SECONDS))
        };
        let changes = standardised(&(0..heard.slow.len()).map(change).collect::<Vec<f32>>(), 0.03);
        let at = |hop: usize| changes.get(hop / SLOW_HOPS).copied().unwrap_or_default();
        Self {
            all: of(|moment| moment.flux),
            low: of(|moment| moment.low_rise),
            high: of(|moment| moment.high_rise),
            harmony: (0..heard.moments.len()).map(at).collect(),
            odds: largest_around(odds, AROUND),
            hop_seconds,
        }
    }

    fn of(&self, beats: &[usize]) -> f32 {
        let (Some(first), Some(last)) = (beats.first(), beats.last()) else { return NO_EVIDENCE };
        if beats.len() < BEATS_OF_STRETCH_MIN {
            return NO_EVIDENCE;
        }
        let tempo = 60.0 * (beats.len() - 1) as f64 / ((last - first) as f64 * self.hop_seconds);
        if !(TEMPO.0..TEMPO.1).contains(&tempo) {
            return NO_EVIDENCE;
        }
        let octaves = (tempo / LIKELY.0).log2() as f32;
        let get = |row: &[f32], place: usize| row.get(place).copied().unwrap_or_default();
        let mean = |row: &[f32], sixths: usize| {
            let at = |pair: &[usize]| get(row, pair[0] + sixths * (pair[1] - pair[0]) / 6);
            beats.windows(2).map(at).sum::<f32>() / (beats.len() - 1) as f32
        };
        let thirds = |row: &[f32]| (mean(row, 2) + mean(row, 4)) / 2.0;
        let of = |row: &[f32]| beats.iter().map(|beat| get(row, *beat)).collect::<Vec<f32>>();
        let high = of(&self.high);
        let drums: Vec<f32> = of(&self.low).iter().zip(&high).map(|(low, high)| low - high).collect();
        let of_bar = |row: &[f32]| contrast(row, 3).max(contrast(row, 4)).max(0.0).sqrt();
        STRUCK * mean(&self.all, 0)
            + STRUCK_LOW * mean(&self.low, 0)
            + ODDS * mean(&self.odds, 0)
            + HALF_HIGH * mean(&self.high, 3)
            + THIRD_LOW * thirds(&self.low)
            + THIRD_HARMONY * thirds(&self.harmony)
            + BAR_HARMONY * of_bar(&of(&self.harmony))
            + BAR_DRUMS * of_bar(&drums)
            + FOURTH * contrast(&of(&self.all), 4)
            + SIXTH_HIGH * contrast(&high, 6)
            - LIKELY.1 * octaves * octaves
    }
}

/// Returns how much the mean of every `period`th value exceeds the mean of all, for the best first value.
fn contrast(values: &[f32], period: usize) -> f32 {
    if values.len() < 2 * period {
        return 0.0;
    }
    let mean = |first: usize, step: usize| {
        let chosen = values.iter().skip(first).step_by(step);
        chosen.clone().sum::<f32>() / chosen.count() as f32
    };
    (0..period).map(|first| mean(first, period)).fold(f32::MIN, f32::max) - mean(0, 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_value_is_found_on_both_sides_and_at_the_ends() {
        let values = [1.0, 5.0, 2.0, -3.0, -4.0, -5.0, 0.5];
        assert_eq!(largest_around(&values, 0), values);
        assert_eq!(largest_around(&values, 1), [5.0, 5.0, 5.0, 2.0, -3.0, 0.5, 0.5]);
        assert_eq!(largest_around(&values, 25), [5.0; 7]);
        assert_eq!(largest_around(&[], 3), []);
    }
}
