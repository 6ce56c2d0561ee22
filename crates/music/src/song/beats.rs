//! The beats of a whole song. The tempo comes from [`super::pulse`]. Beats are then placed on onsets, nearly a period
//! apart, by dynamic programming (Ellis 2007): once for each metrical level, which is a simple multiple of the tempo.
//! The likeliest level is decided for each stretch of the song, from how strong the onsets at its beats are, how low
//! and high onsets alternate, and how common its tempo is.

use std::collections::VecDeque;

use super::heard::{Heard, Moment};
use super::pulse::{excesses, periods};
use crate::onset::FLUX_MIN;

/// The tempos of the metrical levels, relative to the tempo of the pulse.
const LEVELS: [f32; 7] = [1.0 / 3.0, 0.5, 2.0 / 3.0, 1.0, 1.5, 2.0, 3.0];
/// The range of tempos, in beats per minute.
const TEMPO: (f64, f64) = (48.0, 225.0);

/// The cost of a beat that is not a period after the previous beat, per squared natural logarithm of the ratio.
const STIFFNESS: f32 = 200.0;
/// The range of distances between beats, relative to the period.
const DISTANCE: (f32, f32) = (0.7, 1.4);

/// The level is decided in stretches of this length, in seconds.
const STRETCH_SECONDS: f64 = 30.0;
/// The cost of a change of level between two stretches.
const CHANGE: f32 = 1.0;

/// Onset strengths are relative to the largest flux within this many seconds before and after the moment.
const LARGEST_SECONDS: f64 = 1.5;
/// Onsets appear in the flux this many hops late.
const FLUX_LATE: f64 = 0.6;
/// The onset of a beat is searched within this many hops before and after the beat.
const AROUND: usize = 2;
const BEATS_MIN: usize = 8;
/// The minimum number of beats in a stretch, and the evidence for a level with fewer beats.
const BEATS_OF_STRETCH_MIN: usize = 5;
const NO_EVIDENCE: f32 = -10.0;
/// The minimum repetition of onsets in a stretch with a steady pulse. Noise and speech reach 0.065.
const REPEATED_MIN: f32 = 0.08;
/// At a tenth of the beats, the flux is at least this. In swelling chords and in vibrato it is less than 0.2.
const FLUX_LOUD_MIN: f32 = 0.25;
/// The evidence for a level: its likeliest tempo in beats per minute, the cost per squared octave of distance from this
/// tempo, the weights of all onsets and of low onsets at the beats, and the cost of an off-beat. The weights were
/// fitted to songs by logistic regression.
const LIKELY: (f64, f32) = (162.0, 3.1);
const STRUCK: f32 = 3.5;
const STRUCK_LOW: f32 = 1.3;
const OFF_BEAT: f32 = 2.3;

/// Returns onset strengths, 0..1, relative to the largest flux nearby ([`LARGEST_SECONDS`]).
pub(super) fn onset_strengths(heard: &Heard) -> Vec<f32> {
    let reach = (LARGEST_SECONDS / heard.hop_seconds) as usize;
    let flux: Vec<f32> = heard.moments.iter().map(|moment| moment.flux).collect();
    let largest = largest_around(&flux, reach);
    flux.iter().zip(largest).map(|(flux, largest)| flux / largest.max(FLUX_MIN)).collect()
}

/// Returns the largest value within `reach` of each index. The queue holds decreasing candidates (Lemire 2006).
fn largest_around(values: &[f32], reach: usize) -> Vec<f32> {
    let mut queue = VecDeque::new();
    let mut ahead = values.iter().copied().enumerate();
    let enter = |queue: &mut VecDeque<(usize, f32)>, (index, value): (usize, f32)| {
        while queue.back().is_some_and(|(_, smaller)| *smaller <= value) {
            queue.pop_back();
        }
        queue.push_back((index, value));
    };
    ahead.by_ref().take(reach).for_each(|entry| enter(&mut queue, entry));
    let largest = |middle: usize| {
        if let Some(entry) = ahead.next() {
            enter(&mut queue, entry);
        }
        while queue.front().is_some_and(|(index, _)| index + reach < middle) {
            queue.pop_front();
        }
        queue.front().map_or(0.0, |(_, value)| *value)
    };
    (0..values.len()).map(largest).collect()
}

/// The onsets of a song, as excesses over the mean nearby.
struct Onsets {
    all: Vec<f32>,
    low: Vec<f32>,
    hop_seconds: f64,
}

/// A hypothesis about the beats.
struct Level {
    /// True if the beats are halfway between the beats with the strongest onsets.
    is_off_beat: bool,
    /// The places of the beats, in hops.
    beats: Vec<f32>,
}

/// Returns the times of the beats in seconds; empty if there is no steady beat.
pub(super) fn beats(heard: &Heard) -> Vec<f64> {
    let of = |value: fn(&Moment) -> f32| {
        let values: Vec<f32> = heard.moments.iter().map(value).collect();
        excesses(&values, heard.hop_seconds)
    };
    let onsets = Onsets {
        all: of(|moment| moment.flux),
        low: of(|moment| moment.low_rise),
        hop_seconds: heard.hop_seconds,
    };
    let (periods, repeated) = periods(&onsets.all, heard.hop_seconds);
    let levels = levels(&onsets, &periods);
    let found = chosen(&onsets, &levels, &repeated);
    let found: Vec<usize> = found.into_iter().map(|beat| beat.round() as usize).collect();
    let strengths = onset_strengths(heard);
    let found = sounding(&found, &heard.moments);
    if found.len() < BEATS_MIN || loud_flux(found, &heard.moments) < FLUX_LOUD_MIN {
        return Vec::new();
    }
    found.iter().map(|moment| refined(*moment, &strengths) * heard.hop_seconds).collect()
}

fn levels(onsets: &Onsets, periods: &[f32]) -> Vec<Level> {
    let mut levels = Vec::new();
    let rewards = rewards(&onsets.all);
    let mean = periods.iter().sum::<f32>() / periods.len().max(1) as f32;
    for ratio in LEVELS {
        let tempo = 60.0 * f64::from(ratio) / (f64::from(mean) * onsets.hop_seconds);
        if !(TEMPO.0..TEMPO.1).contains(&tempo) {
            continue;
        }
        let beats = path(&rewards, |hop| periods[hop] / ratio);
        let between = beats.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        levels.push(Level { is_off_beat: false, beats });
        levels.push(Level { is_off_beat: true, beats: between });
    }
    levels
}

/// Returns the reward of a beat at each hop: the smoothed onset strength, with a root mean square of about 1.
fn rewards(strengths: &[f32]) -> Vec<f32> {
    const KERNEL: [f32; 5] = [0.054, 0.244, 0.404, 0.244, 0.054];
    let at = |index: usize, k: usize| (index + k).checked_sub(2).and_then(|index| strengths.get(index));
    let smooth = |index: usize| {
        KERNEL
            .iter()
            .enumerate()
            .map(|(k, weight)| weight * at(index, k).copied().unwrap_or_default())
            .sum::<f32>()
    };
    let smoothed: Vec<f32> = (0..strengths.len()).map(smooth).collect();
    let scale = 1.0 / deviation(&smoothed).max(1e-6);
    smoothed.into_iter().map(|strength| scale * strength).collect()
}

fn deviation(values: &[f32]) -> f32 {
    let count = values.len().max(1) as f32;
    let mean = values.iter().sum::<f32>() / count;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f32>() / count).sqrt()
}

/// Returns the best path of beats, given the expected period at each hop.
fn path(rewards: &[f32], period: impl Fn(usize) -> f32) -> Vec<f32> {
    let mut best: Vec<f32> = Vec::with_capacity(rewards.len());
    let mut came_from: Vec<Option<usize>> = Vec::with_capacity(rewards.len());
    for (hop, reward) in rewards.iter().enumerate() {
        let period = period(hop).max(2.0);
        let nearest = (DISTANCE.0 * period) as usize;
        let farthest = (DISTANCE.1 * period) as usize + 1;
        let earlier = |distance: usize| {
            let from = hop.checked_sub(distance)?;
            let off = (distance as f32 / period).ln();
            Some((from, best.get(from)? - STIFFNESS * off * off))
        };
        let from = (nearest.max(1)..=farthest).filter_map(earlier).max_by(|a, b| a.1.total_cmp(&b.1));
        best.push(reward + from.map_or(0.0, |(_, value)| value));
        came_from.push(from.map(|(from, _)| from));
    }
    let last = period(rewards.len().saturating_sub(1)) as usize;
    let ends = rewards.len().saturating_sub(last.max(1))..rewards.len();
    let mut beat = ends.max_by(|a, b| best[*a].total_cmp(&best[*b]));
    let mut beats = Vec::new();
    while let Some(hop) = beat {
        beats.push(hop as f32);
        beat = came_from[hop];
    }
    beats.reverse();
    beats
}

/// Returns the beats of the likeliest level in each stretch, from the first to the last stretch with a steady pulse.
fn chosen(onsets: &Onsets, levels: &[Level], repeated: &[f32]) -> Vec<f32> {
    let hops = onsets.all.len();
    let length = (STRETCH_SECONDS / onsets.hop_seconds) as usize;
    let count = (hops / length.max(1)).max(1);
    let border = |stretch: usize| (stretch * hops / count) as f32;
    let evidence = Evidence::new(onsets);
    let inside = |level: &Level, stretch: usize| {
        let place = |hop: f32| level.beats.partition_point(|beat| *beat < hop);
        place(border(stretch))..place(border(stretch + 1))
    };
    let scores: Vec<Vec<f32>> = (0..count)
        .map(|stretch| {
            let of = |level: &Level| evidence.of(&level.beats[inside(level, stretch)], level.is_off_beat);
            levels.iter().map(of).collect()
        })
        .collect();
    let choices = choices(&scores);
    let is_steady = |stretch: &usize| {
        let inside = &repeated[border(*stretch) as usize..border(stretch + 1) as usize];
        inside.iter().sum::<f32>() >= REPEATED_MIN * inside.len() as f32
    };
    let (Some(first), Some(last)) = ((0..count).find(is_steady), (0..count).rfind(is_steady)) else {
        return Vec::new();
    };
    let mut beats: Vec<f32> = Vec::new();
    for (stretch, choice) in choices.into_iter().enumerate().take(last + 1).skip(first) {
        let Some(level) = levels.get(choice) else { continue };
        let mine = &level.beats[inside(level, stretch)];
        let apart = mine.windows(2).next().map_or(1.0, |pair| 0.6 * (pair[1] - pair[0]));
        let after = beats.last().map_or(f32::NEG_INFINITY, |last| last + apart);
        beats.extend(mine.iter().filter(|beat| **beat > after));
    }
    beats
}

/// Returns the likeliest level of each stretch (Viterbi 1967).
fn choices(scores: &[Vec<f32>]) -> Vec<usize> {
    let likeliest =
        |best: &[f32]| (0..best.len()).max_by(|a, b| best[*a].total_cmp(&best[*b])).unwrap_or_default();
    let mut best: Vec<f32> = Vec::new();
    let mut came_from = Vec::new();
    for score in scores {
        let leap = likeliest(&best);
        let stays = |level: usize| best.get(level).is_none_or(|own| *own >= best[leap] - CHANGE);
        let from: Vec<usize> =
            (0..score.len()).map(|level| if stays(level) { level } else { leap }).collect();
        let value = |level: usize| match best.get(from[level]) {
            Some(value) if from[level] == level => value + score[level],
            Some(value) => value - CHANGE + score[level],
            None => score[level],
        };
        best = (0..score.len()).map(value).collect();
        came_from.push(from);
    }
    let mut level = likeliest(&best);
    let mut choices = vec![0; scores.len()];
    for (choice, from) in choices.iter_mut().zip(&came_from).rev() {
        *choice = level;
        level = from.get(level).copied().unwrap_or_default();
    }
    choices
}

/// Measures how likely beats are. The strengths are the largest nearby, relative to the usual strength.
struct Evidence {
    all: Vec<f32>,
    low: Vec<f32>,
    hop_seconds: f64,
}

impl Evidence {
    fn new(onsets: &Onsets) -> Self {
        let of = |strengths: &[f32]| {
            let scale = 0.5 / deviation(strengths).max(1e-6);
            largest_around(strengths, AROUND).into_iter().map(|strength| scale * strength).collect()
        };
        let Onsets { all, low, hop_seconds } = onsets;
        Self { all: of(all), low: of(low), hop_seconds: *hop_seconds }
    }

    fn of(&self, beats: &[f32], is_off_beat: bool) -> f32 {
        let (Some(first), Some(last)) = (beats.first(), beats.last()) else { return NO_EVIDENCE };
        if beats.len() < BEATS_OF_STRETCH_MIN {
            return NO_EVIDENCE;
        }
        let tempo = 60.0 * (beats.len() - 1) as f64 / (f64::from(last - first) * self.hop_seconds);
        let octaves = (tempo / LIKELY.0).log2() as f32;
        let mean = |strengths: &[f32]| {
            let at = |place: &f32| strengths.get(place.round() as usize).copied().unwrap_or_default();
            beats.iter().map(at).sum::<f32>() / beats.len() as f32
        };
        let off_beat = if is_off_beat { OFF_BEAT } else { 0.0 };
        STRUCK * mean(&self.all) + STRUCK_LOW * mean(&self.low) - LIKELY.1 * octaves * octaves - off_beat
    }
}

/// Removes the beats before the first sound and after the last sound.
fn sounding<'a>(beats: &'a [usize], moments: &[Moment]) -> &'a [usize] {
    let loudest = moments.iter().fold(0.0_f32, |loudest, moment| loudest.max(moment.power));
    let sounds = |moment: &Moment| moment.power > (loudest * 1e-5).max(1e-9);
    let (Some(first), Some(last)) = (moments.iter().position(sounds), moments.iter().rposition(sounds))
    else {
        return &[];
    };
    let from = beats.partition_point(|beat| beat + 4 < first);
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

    #[test]
    fn largest_around_matches_a_plain_search() {
        let values: Vec<f32> = (0..40_u32).map(|n| ((n * 7919) % 101) as f32).collect();
        for reach in [1, 3, 8, 25] {
            let plain = (0..values.len()).map(|index: usize| {
                values[index.saturating_sub(reach)..(index + reach + 1).min(values.len())]
                    .iter()
                    .fold(0.0_f32, |a, b| a.max(*b))
            });
            assert_eq!(largest_around(&values, reach), plain.collect::<Vec<f32>>(), "reach {reach}");
        }
    }
}
