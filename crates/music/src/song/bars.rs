//! The bars of a song: the meter and the downbeats. The meter is found from the similarity of beats that are a bar
//! apart (the beat spectrum of Foote and Uchihashi 2001; Gouyon and Herrera 2003 for meters). Downbeats are found from
//! low drums and changes of harmony and timbre, which are likelier at the start of a bar, and from snares in between
//! (Goto 2001). The likeliest path is decoded over the whole song, so that an extra beat disturbs only one bar.

use serde::{Deserialize, Serialize};

use super::heard::{Heard, Moment};
use super::key::largest;
use super::units::{Unit, distance, standardised};

/// The grouping of beats into bars.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
pub enum Meter {
    /// Four beats.
    #[serde(rename = "4/4")]
    FourFour,
    /// Three beats.
    #[serde(rename = "3/4")]
    ThreeFour,
    /// Two beats of three parts each.
    #[serde(rename = "6/8")]
    SixEight,
}

impl Meter {
    /// The number of beats in a bar.
    pub fn beats(self) -> usize {
        match self {
            Self::FourFour => 4,
            Self::ThreeFour => 3,
            Self::SixEight => 2,
        }
    }

    /// The usual notation.
    pub fn name(self) -> &'static str {
        match self {
            Self::FourFour => "4/4",
            Self::ThreeFour => "3/4",
            Self::SixEight => "6/8",
        }
    }
}

/// The cost of leaving a bar before its end, in standard deviations of the evidence.
const BREAK_COST: f32 = 12.0;
/// A song is in three if beats three apart are more similar than beats four apart by at least this much.
const THREE_OVER_FOUR: f32 = 0.06;
/// The onset of a beat is searched within this many hops before and after the beat.
const AROUND: usize = 3;
/// In a ternary meter, the least onset strength at both thirds of a beat, relative to the beat and to its half.
const TERNARY: (f32, f32) = (0.12, 1.5);

struct Evidence {
    low: Vec<f32>,
    high: Vec<f32>,
    struck: Vec<f32>,
    harmony: Vec<f32>,
    sound: Vec<f32>,
    half: Vec<f32>,
    low_half: Vec<f32>,
}

/// Returns the meter, and the position of each beat in its bar, from 0.
pub(super) fn bars(heard: &Heard, strengths: &[f32], beats: &[f64], units: &[Unit]) -> (Meter, Vec<usize>) {
    let row = |of: fn(&Moment) -> f32| heard.moments.iter().map(of).collect::<Vec<f32>>();
    let (lows, highs) = (row(|moment| moment.low_rise), row(|moment| moment.high_rise));
    let near = |row: &[f32], time: f64, reach: usize| {
        let middle = (time / heard.hop_seconds).round() as usize;
        let end = (middle + reach + 1).min(row.len());
        row[middle.saturating_sub(reach).min(end)..end].iter().fold(0.0_f32, |a, b| a.max(*b))
    };
    let evidence = evidence([&lows, &highs, strengths], beats, units, &near);
    let meter = if [strengths, highs.as_slice()].into_iter().any(|row| has_thirds(row, beats, &near)) {
        Meter::SixEight
    } else {
        three_or_four(beats.len(), &evidence)
    };
    let positions = path(meter.beats(), &evidence);
    (meter, positions)
}

/// Returns the largest value of a row within some hops of a time.
type Near<'a> = &'a dyn Fn(&[f32], f64, usize) -> f32;

fn evidence(
    [lows, highs, strengths]: [&[f32]; 3],
    beats: &[f64],
    units: &[Unit],
    near: Near<'_>,
) -> Evidence {
    let count = beats.len();
    let next = |index: usize| beats.get(index + 1).unwrap_or(&beats[index]);
    let halves: Vec<f64> = (0..count).map(|index| (beats[index] + next(index)) / 2.0).collect();
    let of = |row: &[f32], times: &[f64]| {
        standardised(&times.iter().map(|time| near(row, *time, AROUND)).collect::<Vec<f32>>(), 0.1)
    };
    // Compare the two beats before with the two beats after, so that a passing note counts less than a new chord.
    let mean = |from: usize, to: usize| {
        let mut sum = [0.0_f32; 12];
        for unit in units.get(from..to.min(units.len())).unwrap_or_default() {
            sum.iter_mut().zip(unit.chroma).for_each(|(sum, fraction)| *sum += fraction / (to - from) as f32);
        }
        sum
    };
    let harmony = (0..count).map(|index| {
        if index == 0 || index + 1 >= units.len() {
            return 0.0;
        }
        let near = distance(&mean(index - 1, index), &mean(index, index + 1));
        let wide = distance(&mean(index.saturating_sub(2), index), &mean(index, index + 2));
        near + wide
    });
    let mut sound = vec![0.0_f32; count];
    for (sound, pair) in sound.iter_mut().skip(1).zip(units.windows(2)) {
        *sound = pair[0].timbre.iter().zip(&pair[1].timbre).map(|(b, a)| (a - b).max(0.0)).sum();
    }
    Evidence {
        low: of(lows, beats),
        high: of(highs, beats),
        struck: of(strengths, beats),
        half: of(strengths, &halves),
        low_half: of(lows, &halves),
        harmony: standardised(&harmony.collect::<Vec<f32>>(), 0.02),
        sound: standardised(&sound, 5.0),
    }
}

fn three_or_four(beats: usize, evidence: &Evidence) -> Meter {
    let Evidence { low, high, struck, half, low_half, harmony, .. } = evidence;
    let rows = [low, high, struck, half, low_half, harmony];
    // The mean product of standardised values is their correlation.
    let alike = |lag: usize| {
        let of_row = |row: &&Vec<f32>| {
            let pairs = row.iter().zip(&row[lag.min(row.len())..]);
            pairs.map(|(a, b)| a.clamp(-2.0, 2.0) * b.clamp(-2.0, 2.0)).sum::<f32>()
        };
        rows.iter().map(of_row).sum::<f32>() / (beats.saturating_sub(lag).max(1) * rows.len()) as f32
    };
    let four = (alike(4) + alike(8)) / 2.0;
    let three = (alike(3) + alike(6) + alike(9)) / 3.0;
    if three > four + THREE_OVER_FOUR { Meter::ThreeFour } else { Meter::FourFour }
}

/// True if the second and third parts of ternary beats both have onsets. Swing has onsets only at the third part.
fn has_thirds(row: &[f32], beats: &[f64], near: Near<'_>) -> bool {
    let mean_at = |fraction: f64| {
        let at = |pair: &[f64]| near(row, pair[0] + fraction * (pair[1] - pair[0]), 2);
        beats.windows(2).map(at).sum::<f32>() / beats.len().max(1) as f32
    };
    let thirds = mean_at(1.0 / 3.0).min(mean_at(2.0 / 3.0));
    thirds > TERNARY.0 * mean_at(0.0) && thirds > TERNARY.1 * mean_at(0.5)
}

/// Returns how much the evidence of a beat speaks for a position in a bar of `beats`: the low onsets, the high onsets,
/// all onsets, and the changes of harmony and of sound, each standardised.
pub(crate) fn reward(beats: usize, position: usize, evidence: [f32; 5]) -> f32 {
    let [low, high, struck, harmony, sound] = evidence;
    let snare = 0.5 * (high + struck) - low;
    match (beats, position) {
        (_, 0) => 0.7 * low + harmony + 0.7 * sound,
        (4, 2) => 0.3 * low,
        (4, _) => 0.5 * snare,
        _ => 0.3 * snare,
    }
}

/// Returns the likeliest position of each beat in its bar of `beats` (Viterbi 1967).
fn path(beats: usize, evidence: &Evidence) -> Vec<usize> {
    let Evidence { low, high, struck, harmony, sound, .. } = evidence;
    let reward = |index: usize, position: usize| {
        let at = |row: &Vec<f32>| row.get(index).copied().unwrap_or_default().clamp(-2.0, 3.0);
        reward(beats, position, [low, high, struck, harmony, sound].map(at))
    };
    let count = low.len();
    let mut best: Vec<f32> = (0..beats).map(|position| reward(0, position)).collect();
    let mut came_from = vec![vec![0; beats]];
    for index in 1..count {
        let likeliest = largest(&best);
        let mut next = vec![0.0; beats];
        let mut from = vec![0; beats];
        for position in 0..beats {
            let regular = (position + beats - 1) % beats;
            // A bar may end early, so the first position may follow any position.
            let broken = position == 0 && best[likeliest] - BREAK_COST > best[regular];
            from[position] = if broken { likeliest } else { regular };
            let before = if broken { best[likeliest] - BREAK_COST } else { best[regular] };
            next[position] = before + reward(index, position);
        }
        best = next;
        came_from.push(from);
    }
    let mut position = largest(&best);
    let mut positions = vec![0; count];
    for index in (0..count).rev() {
        positions[index] = position;
        position = came_from[index][position];
    }
    positions
}
