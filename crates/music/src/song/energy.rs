//! Energy from moment to moment, builds that rise, and the drops they lead to.
//!
//! A build is a stretch of bars in which the sound becomes brighter and is struck more often (Solberg 2014 on how club
//! music builds up), and which ends. A drop is the bar after a build in which the low band returns and the song is at its
//! loudest (Yadati et al. 2014).

use super::listener::{Heard, Moment, TIMBRE_BANDS};
use super::units::Unit;

/// Seconds from one value of the energy to the next.
pub(super) const ENERGY_STEP: f64 = 0.25;

/// Levels that are drawn as 0, in decibels below the loudest.
const ENERGY_RANGE_DB: f32 = 36.0;

/// Lengths of builds, in bars.
const BUILD_BARS: std::ops::RangeInclusive<usize> = 4..=16;
/// By how much a build's tension rises from its first bar to its last, in decibels.
const RISE_MIN: f32 = 7.0;
/// How straight it rises: the correlation of tension and time.
const STRAIGHT_MIN: f32 = 0.8;
/// No step from bar to bar is more than this share of the rise: that is an entry, not a build.
const STEP_SHARE: f32 = 0.6;
/// By how much the low band is stronger after a drop than in the two bars before it, in decibels.
const LOW_RETURNS: f32 = 5.0;
/// A drop is as loud as this share of the song's bars, less some decibels.
const LOUD: (f32, f32) = (0.7, 2.0);
/// A drop's bars whose means count.
const DROP_BARS: usize = 2;
/// Of drops closer than this, in bars, only the strongest counts.
const APART: usize = 8;

/// Mean power of each [`ENERGY_STEP`] as a height 0..1 in decibels, relative to the loudest, smoothed over a second.
pub(super) fn energy(heard: &Heard) -> Vec<f32> {
    let powers = steps(heard, |moments| {
        moments.iter().map(|moment| moment.power).sum::<f32>() / moments.len().max(1) as f32
    });
    let smooth: Vec<f32> = (0..powers.len())
        .map(|index| {
            let around = &powers[index.saturating_sub(2)..(index + 3).min(powers.len())];
            around.iter().sum::<f32>() / around.len() as f32
        })
        .collect();
    let loudest = smooth.iter().copied().fold(0.0_f32, f32::max);
    let height = |power: &f32| {
        if loudest < 1e-9 {
            return 0.0;
        }
        (1.0 + 10.0 * (power / loudest).max(1e-12).log10() / ENERGY_RANGE_DB).clamp(0.0, 1.0)
    };
    smooth.iter().map(height).collect()
}

/// Largest magnitude of the samples of each [`ENERGY_STEP`].
pub(super) fn peaks(heard: &Heard) -> Vec<f32> {
    steps(heard, |moments| moments.iter().map(|moment| moment.peak).fold(0.0, f32::max))
}

fn steps(heard: &Heard, of: impl Fn(&[Moment]) -> f32) -> Vec<f32> {
    let count = (heard.seconds / ENERGY_STEP).ceil() as usize;
    let place =
        |step: usize| ((step as f64 * ENERGY_STEP / heard.hop_seconds) as usize).min(heard.moments.len());
    (0..count).map(|step| of(&heard.moments[place(step)..place(step + 1)])).collect()
}

/// Bars of builds, and bars with which drops begin. A build leads to a drop, or into another section: `borders` are the
/// bars with which sections begin.
pub(super) fn builds_and_drops(
    bars: &[Unit],
    borders: &[usize],
) -> (Vec<std::ops::Range<usize>>, Vec<usize>) {
    let mut levels: Vec<f32> = bars.iter().map(|bar| bar.level).collect();
    levels.sort_by(f32::total_cmp);
    let loud =
        levels.get((levels.len() as f32 * LOUD.0) as usize).map_or(f32::INFINITY, |level| level - LOUD.1);
    let densest = bars.iter().map(|bar| bar.onsets).fold(1e-6_f32, f32::max);
    let tension: Vec<f32> = bars
        .iter()
        .map(|bar| {
            let high = &bar.timbre[TIMBRE_BANDS / 2..];
            high.iter().sum::<f32>() / high.len() as f32
                + 10.0 * bar.onsets / densest
                + 20.0 * bar.brightness()
        })
        .collect();
    let mean = |of: &dyn Fn(&Unit) -> f32, range: std::ops::Range<usize>| {
        let bars = bars.get(range).unwrap_or_default();
        bars.iter().map(of).sum::<f32>() / bars.len().max(1) as f32
    };
    let returns = |bar: usize| {
        let back =
            mean(&|bar| bar.low, bar..bar + DROP_BARS) - mean(&|bar| bar.low, bar.saturating_sub(2)..bar);
        let step = bars[bar].low - bars[bar - 1].low;
        back.min(step)
    };
    // The last bar of a build may be a pause.
    let ended = |bar: usize| build(&tension, bar).or_else(|| build(&tension, bar - 1));
    let mut builds: Vec<std::ops::Range<usize>> = Vec::new();
    // With how much of the low band returns.
    let mut drops: Vec<(usize, f32)> = Vec::new();
    for bar in *BUILD_BARS.start()..bars.len() {
        let is_border = borders.contains(&bar);
        let drops_here = returns(bar) >= LOW_RETURNS && mean(&|bar| bar.level, bar..bar + DROP_BARS) >= loud;
        if !drops_here && !is_border {
            continue;
        }
        let Some(build) = ended(bar) else { continue };
        match builds.last_mut() {
            // The same one, which led on to its drop.
            Some(last) if last.end > build.start => {
                if drops_here {
                    last.end = bar;
                }
            }
            _ => builds.push(build.start..bar),
        }
        if !drops_here {
            continue;
        }
        match drops.last_mut() {
            Some(last) if bar - last.0 < APART => {
                if returns(bar) > last.1 {
                    *last = (bar, returns(bar));
                }
            }
            _ => drops.push((bar, returns(bar))),
        }
    }
    // A build ends with its drop.
    let drops: Vec<usize> = drops.into_iter().map(|(bar, _)| bar).collect();
    for build in &mut builds {
        if let Some(drop) = drops.iter().find(|drop| build.contains(drop) && **drop > build.start) {
            build.end = *drop;
        }
    }
    (builds, drops)
}

/// The stretch before `end` in which tension rises most surely: with the largest t statistic of its correlation with time.
fn build(tension: &[f32], end: usize) -> Option<std::ops::Range<usize>> {
    let sureness = |start: usize| {
        let values = &tension[start..end];
        let count = values.len() as f32;
        let (x_mean, y_mean) = ((count - 1.0) / 2.0, values.iter().sum::<f32>() / count);
        let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
        for (x, y) in values.iter().enumerate() {
            let (x, y) = (x as f32 - x_mean, y - y_mean);
            xy += x * y;
            xx += x * x;
            yy += y * y;
        }
        let rise = xy / xx * (count - 1.0);
        let straight = xy / (xx * yy).sqrt().max(1e-9);
        let step = values.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f32::max);
        let is_build = rise >= RISE_MIN && straight >= STRAIGHT_MIN && step <= STEP_SHARE * rise;
        is_build.then(|| (start, straight * ((count - 2.0) / (1.0 - straight * straight).max(1e-3)).sqrt()))
    };
    BUILD_BARS
        .filter_map(|length| end.checked_sub(length))
        .filter_map(sureness)
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(start, _)| start..end)
}
