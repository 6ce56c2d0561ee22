//! The beats of a whole song. The model is the same as in the causal tracker ([`crate::beat`]), but the likeliest path
//! through the whole song is decoded by dynamic programming (Viterbi 1967). A path branches only at beats, so one path
//! is stored for each moment and period: the best path with a beat at this moment and the next beat a period later. The
//! value of the path includes the rewards of the beat's half and quarters (Krebs, Böck and Widmer 2015; Ellis 2007).

use std::collections::VecDeque;
use std::f64::consts::TAU;

use super::heard::{Heard, Moment};
use crate::onset::FLUX_MIN;

/// Range of tempos, in beats per minute.
const TEMPO: (f64, f64) = (215.0, 52.0);
/// The likeliest tempo in beats per minute, and the cost per beat and per squared octave of distance from this tempo.
const LIKELY: (f64, f64) = (108.0, 0.6);

/// The rewards of a beat, its half and its quarters: a constant, and a factor of the onset strength's log odds.
const BEAT: (f32, f32) = (0.0, 1.5);
const HALF: (f32, f32) = (0.15, 0.15);
const QUARTER: (f32, f32) = (0.0, -0.15);

/// The cost of a change of period, per relative change beyond the first hop.
const TEMPO_STIFFNESS: f32 = 250.0;
/// The cost of a change of period by one hop. The cost is small because most tempos are between two periods.
const NEIGHBOUR: f32 = 0.25;
/// The largest change of the period from one beat to the next, in hops.
const REACH: usize = 6;

/// Onset strengths are relative to the largest flux within this many seconds before and after the moment.
const LARGEST_SECONDS: f64 = 1.5;
/// Onsets appear in the flux this many hops late.
const FLUX_LATE: f64 = 0.6;

/// The number of moments decoded at once: 10 minutes.
const STRETCH: usize = 56_250;
/// Consecutive stretches overlap by this many moments: 20 seconds.
const OVERLAP: usize = 1_875;

/// The minimum fraction of beats with an onset. Noise and swelling chords have no onsets.
const STRUCK_MIN: f32 = 0.25;
/// The minimum agreement of the onsets' positions within the beats, for one to four onsets per beat. The agreement is
/// the length of the mean of the positions as points on a circle. Music has 0.3 and more, speech and rain less than
/// 0.2.
const AGREE_MIN: f64 = 0.25;
const PARTS: [f64; 4] = [1.0, 2.0, 3.0, 4.0];
/// The level of music with beats has at least this standard deviation, in decibels; a held note with vibrato less.
const LEVEL_DEVIATION_MIN: f32 = 1.0;
/// Quieter levels count as this many decibels below the loudest level.
const LEVEL_RANGE: f32 = 60.0;
/// An onset within this many hops of a beat belongs to the beat.
const AROUND: usize = 2;
const BEATS_MIN: usize = 8;

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

/// Returns the times of the beats in seconds; empty if there is no steady beat.
pub(super) fn beats(heard: &Heard) -> Vec<f64> {
    let strengths = onset_strengths(heard);
    let mut found: Vec<usize> = Vec::new();
    let mut start = 0;
    while start < strengths.len() {
        let end = (start + STRETCH).min(strengths.len());
        let from = if start == 0 { 0 } else { start + OVERLAP / 2 };
        let to = if end == strengths.len() { end } else { end - OVERLAP / 2 };
        let path = path_through(&strengths[start..end], heard.hop_seconds);
        let inside =
            path.into_iter().map(|moment| moment + start).filter(|moment| (from..to).contains(moment));
        let apart = 60.0 / TEMPO.0 / heard.hop_seconds * 0.8;
        for moment in inside {
            if found.last().is_none_or(|last| (moment - last) as f64 > apart) {
                found.push(moment);
            }
        }
        if end == strengths.len() {
            break;
        }
        start = end - OVERLAP;
    }
    let found = sounding(&found, &heard.moments);
    if is_steady(found, &heard.moments) {
        found.iter().map(|moment| refined(*moment, &strengths) * heard.hop_seconds).collect()
    } else {
        Vec::new()
    }
}

fn odds(strengths: &[f32]) -> Vec<f32> {
    let at = |index: usize| strengths.get(index).copied().unwrap_or_default();
    let odds = |index: usize| {
        let held = at(index).max(0.9 * at(index + 1)).max(0.9 * at(index.wrapping_sub(1))).min(1.0);
        ((held + 0.03) / (1.03 - held)).ln()
    };
    (0..strengths.len()).map(odds).collect()
}

fn path_through(strengths: &[f32], hop_seconds: f64) -> Vec<usize> {
    let period = |tempo: f64| (60.0 / tempo / hop_seconds).round().max(2.0) as usize;
    let (shortest, longest) = (period(TEMPO.0), period(TEMPO.1));
    let count = longest - shortest + 1;
    let odds = odds(strengths);
    let worth = |(sum, factor): (f32, f32), moment: usize| sum + factor * odds[moment];
    let likely: Vec<f32> = (shortest..=longest)
        .map(|period| {
            let octaves = (60.0 / (period as f64 * hop_seconds) / LIKELY.0).log2();
            -(LIKELY.1 * octaves * octaves) as f32
        })
        .collect();
    let changing = |from: usize, to: usize| {
        let moments = from.abs_diff(to) as f32;
        -TEMPO_STIFFNESS * (moments - 1.0).max(0.0) / (shortest + from) as f32 - NEIGHBOUR * moments.min(1.0)
    };
    // `costs[to][k]` is the cost of a change from the period `to - REACH + k` to the period `to`.
    let costs: Vec<[f32; 2 * REACH + 1]> =
        (0..count).map(|to| std::array::from_fn(|k| changing((to + k).saturating_sub(REACH), to))).collect();
    // For a beat at each of the last `longest` moments and each period to the next beat: the value of the best path.
    let rows = longest + 1;
    let mut best = vec![0.0_f32; rows * count];
    let mut came_from = vec![0_u8; strengths.len() * count];
    // For each period that ends at the moment: the value of the best path. Padded at both ends.
    let mut arriving = vec![f32::NEG_INFINITY; count + 2 * REACH];
    for moment in 0..strengths.len() {
        let reward = worth(BEAT, moment);
        for (index, arrives) in arriving[REACH..REACH + count].iter_mut().enumerate() {
            let period = shortest + index;
            *arrives = match moment.checked_sub(period) {
                // The first beat has no previous period to change.
                None => 0.0,
                Some(from) => {
                    let quarters = worth(QUARTER, from + period / 4) + worth(QUARTER, from + 3 * period / 4);
                    best[from % rows * count + index] + quarters + worth(HALF, from + period / 2)
                }
            };
        }
        let row = moment % rows * count;
        for to in 0..count {
            let near = &arriving[to..to + 2 * REACH + 1];
            let mut largest = (REACH, f32::NEG_INFINITY);
            for (k, (arrives, cost)) in near.iter().zip(&costs[to]).enumerate() {
                let value = arrives + cost;
                if value > largest.1 {
                    largest = (k, value);
                }
            }
            best[row + to] = largest.1 + reward + likely[to];
            came_from[moment * count + to] = largest.0 as u8;
        }
    }
    let mut beats = Vec::new();
    // The last beat is less than a period before the end of the song.
    let last = (strengths.len().saturating_sub(longest)..strengths.len())
        .flat_map(|moment| (0..count).map(move |index| (moment, index)))
        .filter(|(moment, index)| moment + shortest + index >= strengths.len())
        .max_by(|a, b| {
            let value = |(moment, index): (usize, usize)| best[moment % rows * count + index];
            value(*a).total_cmp(&value(*b))
        });
    let Some((mut moment, mut index)) = last else { return beats };
    loop {
        beats.push(moment);
        index = (index + came_from[moment * count + index] as usize).saturating_sub(REACH).min(count - 1);
        match moment.checked_sub(shortest + index) {
            Some(earlier) => moment = earlier,
            None => break,
        }
    }
    beats.reverse();
    beats
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

/// True if enough beats have onsets, the level varies, and onsets between beats are at even parts of beats.
fn is_steady(beats: &[usize], moments: &[Moment]) -> bool {
    let begins = |beat: usize| {
        let around = beat.saturating_sub(AROUND)..(beat + AROUND + 1).min(moments.len());
        moments.get(around).unwrap_or_default().iter().any(|moment| moment.begins)
    };
    let struck = beats.iter().filter(|beat| begins(**beat)).count();
    beats.len() >= BEATS_MIN
        && struck as f32 >= STRUCK_MIN * beats.len() as f32
        && level_deviation(beats, moments) >= LEVEL_DEVIATION_MIN
        && agreement(beats, moments) >= AGREE_MIN
}

/// Returns the agreement of the onsets' positions, as [`AGREE_MIN`] describes it; 0 without onsets.
fn agreement(beats: &[usize], moments: &[Moment]) -> f64 {
    let places: Vec<f64> = beats
        .windows(2)
        .flat_map(|pair| {
            let (from, to) = (pair[0], pair[1]);
            (from..to)
                .filter(|moment| moments.get(*moment).is_some_and(|moment| moment.begins))
                .map(move |moment| (moment - from) as f64 / (to - from) as f64)
        })
        .collect();
    let mean = |parts: &f64| {
        let turned = places.iter().map(|place| (TAU * parts * place).sin_cos());
        let (sine, cosine) = turned.fold((0.0, 0.0), |(s, c), (sine, cosine)| (s + sine, c + cosine));
        f64::hypot(sine, cosine) / places.len().max(1) as f64
    };
    PARTS.iter().map(mean).fold(0.0, f64::max)
}

/// Returns the standard deviation of the level between the first and the last beat, in decibels.
fn level_deviation(beats: &[usize], moments: &[Moment]) -> f32 {
    let (Some(first), Some(last)) = (beats.first(), beats.last()) else { return 0.0 };
    let moments = moments.get(*first..*last).unwrap_or_default();
    let loudest = moments.iter().fold(1e-12_f32, |loudest, moment| loudest.max(moment.power));
    let level = |moment: &Moment| (10.0 * (moment.power / loudest).max(1e-12).log10()).max(-LEVEL_RANGE);
    let count = moments.len().max(1) as f32;
    let mean = moments.iter().map(level).sum::<f32>() / count;
    (moments.iter().map(|moment| (level(moment) - mean).powi(2)).sum::<f32>() / count).sqrt()
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
