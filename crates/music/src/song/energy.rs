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
const BUILD_BARS: std::ops::RangeInclusive<usize> = 3..=16;
/// By how much a build's tension rises from its first bar to its last, in decibels.
const RISE_MIN: f32 = 7.0;
/// How straight it rises: the correlation of tension and time.
const STRAIGHT_MIN: f32 = 0.75;
/// By how much the low band is stronger after a drop than in the two bars before it, in decibels.
const LOW_RETURNS: f32 = 5.0;
/// A drop is as loud as this share of the song's bars, less some decibels.
const LOUD: (f32, f32) = (0.7, 2.0);
/// A drop's bars whose means count.
const DROP_BARS: usize = 4;
/// By how much tension must differ from what follows a build, in decibels: a build ends.
const ENDS: f32 = 3.0;

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
    let place = |step: usize| ((step as f64 * ENERGY_STEP / heard.hop_seconds) as usize).min(heard.moments.len());
    (0..count).map(|step| of(&heard.moments[place(step)..place(step + 1)])).collect()
}

/// Bars of builds, and bars with which drops begin.
pub(super) fn builds_and_drops(bars: &[Unit]) -> (Vec<std::ops::Range<usize>>, Vec<usize>) {
    let mut levels: Vec<f32> = bars.iter().map(|bar| bar.level).collect();
    levels.sort_by(f32::total_cmp);
    let loud = levels.get((levels.len() as f32 * LOUD.0) as usize).map_or(f32::INFINITY, |level| level - LOUD.1);
    let densest = bars.iter().map(|bar| bar.onsets).fold(1e-6_f32, f32::max);
    let tension: Vec<f32> = bars
        .iter()
        .map(|bar| {
            let high = &bar.timbre[TIMBRE_BANDS / 2..];
            high.iter().sum::<f32>() / high.len() as f32 + 10.0 * bar.onsets / densest + 20.0 * bar.brightness()
        })
        .collect();
    let mean = |of: &dyn Fn(&Unit) -> f32, range: std::ops::Range<usize>| {
        let bars = bars.get(range).unwrap_or_default();
        bars.iter().map(of).sum::<f32>() / bars.len().max(1) as f32
    };
    let (mut builds, mut drops): (Vec<std::ops::Range<usize>>, Vec<usize>) = Default::default();
    for end in *BUILD_BARS.start()..bars.len() {
        let after = end..(end + DROP_BARS).min(bars.len());
        let returns =
            mean(&|bar| bar.low, after.clone()) - mean(&|bar| bar.low, end - 2..end).max(0.0) >= LOW_RETURNS;
        let at_its_loudest = mean(&|bar| bar.level, after.clone()) >= loud;
        let changes = (tension[end] - tension[end - 1]).abs() >= ENDS;
        if !returns && !changes {
            continue;
        }
        // The last bar of a build may be a pause.
        let build = [end, end - 1].into_iter().filter_map(|to| build(&tension, to)).next();
        let Some(build) = build else { continue };
        if returns && at_its_loudest && drops.last().is_none_or(|last| end - last >= DROP_BARS) {
            drops.push(end);
        }
        if returns && at_its_loudest || tension[end] < tension[end - 1] - ENDS {
            match builds.last_mut() {
                Some(last) if last.end > build.start => *last = last.start..end,
                _ => builds.push(build.start..end),
            }
        }
    }
    (builds, drops)
}

/// The longest stretch before `end` in which tension rises.
fn build(tension: &[f32], end: usize) -> Option<std::ops::Range<usize>> {
    let rises = |start: usize| {
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
        rise >= RISE_MIN && xy >= STRAIGHT_MIN * (xx * yy).sqrt()
    };
    BUILD_BARS.rev().filter_map(|length| end.checked_sub(length)).find(|start| rises(*start)).map(|start| start..end)
}
