//! Builds and drops of a song. A build is a stretch of bars that become brighter and denser in onsets (Solberg 2014 on
//! builds in club music) and lead to a drop or into a louder section. A drop is a bar in which the missing low band
//! returns, and which begins some of the song's loudest and densest bars (Yadati et al. 2014), after a build or after a
//! pause. A drop needs several signs, because each sign alone also occurs elsewhere: a crescendo has the rise, an entry
//! of the bass has the low frequencies, a chorus after quiet bars has both and the loudness, and a pause before the last
//! chorus has the silence.

use super::heard::{Heard, TIMBRE_BANDS};
use super::units::{Unit, units};
use crate::trend::Trend;

/// The lengths of builds, in bars.
const BUILD_BARS: std::ops::RangeInclusive<usize> = 4..=16;
/// A song that begins with a rise has no build, unless the rise leads to a drop. This many bars precede other builds.
const BARS_BEFORE_BUILD: usize = 4;
/// The minimum rise of tension ([`tension`]) from the first bar of a build to its last bar, in decibels.
const RISE_MIN: f32 = 7.0;
/// The minimum correlation of tension and time in a build.
const STRAIGHT_MIN: f32 = 0.8;
/// The maximum step between two bars of a build, as a fraction of the rise. At a larger step, instruments enter.
const STEP_FRACTION: f32 = 0.7;
/// The minimum t statistic of the correlation of tension and time before a drop.
const SURE_MIN: f32 = 5.0;

/// The eve of a bar is this part of the previous bar. It covers most of the previous bar's last beat.
const EVE: (f64, f64) = (0.75, 0.9375);

/// A drop's level is the mean over this many bars, from its first bar on.
const LOUD_BARS: usize = 4;
/// The minimum level of a drop: quantile `LOUD.0` of the song's bar levels, minus `LOUD.1` decibels.
const LOUD: (f32, f32) = (0.7, 1.0);
/// The minimum difference between a drop's level and the level of the previous bars, in decibels.
const JUMP_MIN: f32 = 3.0;
/// The level of a drop is compared with the mean level of this many previous bars.
const JUMP_BARS: usize = 8;
/// The minimum onset density of a drop ([`Unit::onsets`]).
const ONSETS_MIN: f32 = 0.033;
/// The minimum difference between a drop's level and the level of its eve, in decibels.
const LOUDER_THAN_EVE: f32 = 4.0;
/// A drop's low band is at least this much louder than its eve's low band, in decibels.
const LOW_OVER_EVE: f32 = 8.0;
/// The level of a drop's low band is the mean over this many bars, from its first bar on.
const LOW_BARS: usize = 2;
/// A drop and its eve are compared with this many bars, and their eves, before the last bar.
const BARS_BEFORE: usize = 4;
/// A drop's low band is this much louder than in earlier bars, or its eve's this much quieter than in earlier eves.
const LOW_AWAY: f32 = 4.0;
/// After a build that is as loud as the drop, the drop's low band is this much louder than in earlier bars, in dB.
const LOW_AWAY_AFTER_BUILD: f32 = 8.0;
/// After a pause, a drop's low band is this much louder than in earlier bars, in dB: a pause alone makes no drop.
const LOW_AWAY_BEFORE_PAUSE: f32 = 5.0;
/// A pause is at least this much quieter than the bars after it, and than the eves of earlier bars, in decibels.
const PAUSE: (f32, f32) = (8.0, 4.0);
/// The minimum distance between two drops, in bars. If drops are closer, only the strongest drop is kept.
const APART: usize = 8;

/// Measures the eve within each bar, which is the eve of the next bar. `bar_times` are the borders of the bars.
pub(super) fn eves(heard: &Heard, bar_times: &[f64]) -> Vec<Unit> {
    let eve = |bar: &[f64]| {
        let at = |fraction: f64| bar[0] + fraction * (bar[1] - bar[0]);
        [at(EVE.0), at(EVE.1)]
    };
    let times: Vec<f64> = bar_times.windows(2).flat_map(eve).collect();
    // Every second unit covers the time between two eves and is left out.
    units(heard, &times).into_iter().step_by(2).collect()
}

/// Returns the bars of builds, and the first bars of drops. A build leads to a drop or into a louder section, whose
/// first bar is in `borders`. `eves` contains the eve within each bar.
pub(super) fn builds_and_drops(
    bars: &[Unit],
    eves: &[Unit],
    borders: &[usize],
) -> (Vec<std::ops::Range<usize>>, Vec<usize>) {
    let tension = tension(bars);
    let loud = loud(bars);
    // The last bar of a build may be a pause.
    let ended = |bar: usize| build(&tension, bar).or_else(|| build(&tension, bar - 1));
    let mut builds: Vec<std::ops::Range<usize>> = Vec::new();
    let mut drops: Vec<(usize, f32)> = Vec::new();
    for bar in *BUILD_BARS.start()..bars.len() {
        let build = ended(bar);
        let is_sure = build.as_ref().is_some_and(|build| build.sure >= SURE_MIN);
        let returns = returns(bars, eves, bar, loud, is_sure);
        let arrives = |build: &Build| {
            let arrives = || borders.contains(&bar) && arrives(bars, build.start, bar, loud);
            returns.is_some() || build.start >= BARS_BEFORE_BUILD && arrives()
        };
        if let Some(build) = build.filter(arrives) {
            match builds.last_mut() {
                // This build overlaps the previous build. If it leads to a drop, extend the previous build to the drop.
                Some(last) if last.end > build.start => {
                    if returns.is_some() {
                        last.end = bar;
                    }
                }
                _ => builds.push(build.start..bar),
            }
        }
        let Some(returns) = returns else { continue };
        match drops.last_mut() {
            Some(last) if bar - last.0 < APART => {
                if returns > last.1 {
                    *last = (bar, returns);
                }
            }
            _ => drops.push((bar, returns)),
        }
    }
    let drops: Vec<usize> = drops.into_iter().map(|(bar, _)| bar).collect();
    for build in &mut builds {
        if let Some(drop) = drops.iter().find(|drop| build.contains(drop) && **drop > build.start) {
            build.end = *drop;
        }
    }
    (builds, drops)
}

/// Returns the tension of each bar, a sum of its brightness and onset density, in decibels.
fn tension(bars: &[Unit]) -> Vec<f32> {
    let densest = bars.iter().map(|bar| bar.onsets).fold(1e-6_f32, f32::max);
    let of_bar = |bar: &Unit| {
        let high = &bar.timbre[TIMBRE_BANDS / 2..];
        high.iter().sum::<f32>() / high.len() as f32 + 10.0 * bar.onsets / densest + 20.0 * bar.brightness()
    };
    bars.iter().map(of_bar).collect()
}

fn loud(bars: &[Unit]) -> f32 {
    let levels = sorted(bars.iter().map(|bar| bar.level));
    levels.get((levels.len() as f32 * LOUD.0) as usize).map_or(f32::INFINITY, |level| level - LOUD.1)
}

/// Returns the rise of the low band, in decibels, if `bar` begins a drop after a build or after a pause.
fn returns(bars: &[Unit], eves: &[Unit], bar: usize, loud: f32, after_build: bool) -> Option<f32> {
    let last = bar.checked_sub(1)?;
    let eve = eves.get(last)?;
    let before = last.saturating_sub(BARS_BEFORE)..last;
    let (bars_before, eves_before) = (bars.get(before.clone())?, eves.get(before)?);
    let until = |count: usize| bars.get(bar..(bar + count).min(bars.len())).unwrap_or_default();
    let (level, low) = (mean(until(LOUD_BARS), |bar| bar.level), mean(until(LOW_BARS), |bar| bar.low));
    let jump = level - mean(bars.get(bar.saturating_sub(JUMP_BARS)..bar)?, |bar| bar.level);
    let lower = level.min(bars.get(bar)?.level) - eve.level;
    let back = low - eve.low;
    let away = low - median(bars_before, |bar| bar.low);
    let recent = eves_before.get(eves_before.len().saturating_sub(2)..)?;
    let gap = mean(recent, |eve| eve.low) - eve.low;
    let strikes = level >= loud
        && (jump >= JUMP_MIN || after_build && away >= LOW_AWAY_AFTER_BUILD)
        && mean(until(LOUD_BARS), |bar| bar.onsets) >= ONSETS_MIN
        && lower >= LOUDER_THAN_EVE
        && back >= LOW_OVER_EVE
        && away.max(gap) >= LOW_AWAY;
    let after_pause = || {
        away >= LOW_AWAY_BEFORE_PAUSE
            && level - eve.level >= PAUSE.0
            && median(eves_before, |eve| eve.level) - eve.level >= PAUSE.1
            && level - median(bars_before, |bar| bar.level) >= JUMP_MIN
    };
    (strikes && (after_build || after_pause())).then_some(back)
}

fn sorted(values: impl Iterator<Item = f32>) -> Vec<f32> {
    let mut values: Vec<f32> = values.collect();
    values.sort_by(f32::total_cmp);
    values
}

fn mean(units: &[Unit], of: fn(&Unit) -> f32) -> f32 {
    units.iter().map(of).sum::<f32>() / units.len().max(1) as f32
}

/// Returns the median of `of` over the units; 0 without units.
fn median(units: &[Unit], of: fn(&Unit) -> f32) -> f32 {
    let values = sorted(units.iter().map(of));
    let middle = values.get((values.len().saturating_sub(1)) / 2..values.len() / 2 + 1).unwrap_or_default();
    middle.iter().sum::<f32>() / middle.len().max(1) as f32
}

/// True if the bars from `end` on are among the song's loudest and much louder than the bars since `start`.
fn arrives(bars: &[Unit], start: usize, end: usize, loud: f32) -> bool {
    let level = |bars: Option<&[Unit]>| mean(bars.unwrap_or_default(), |bar| bar.level);
    let after = level(bars.get(end..(end + LOUD_BARS).min(bars.len())));
    after >= loud && after - level(bars.get(start..end)) >= JUMP_MIN
}

/// A rise of tension that ends at a given bar.
struct Build {
    start: usize,
    /// The t statistic of the correlation of tension and time.
    sure: f32,
}

/// Returns the stretch before `end` in which the rise of tension is most certain.
fn build(tension: &[f32], end: usize) -> Option<Build> {
    let rising = |start: usize| {
        let values = &tension[start..end];
        let count = values.len() as f32;
        let Trend { slope, straight } = Trend::of(values.iter().copied());
        let rise = slope * (count - 1.0);
        let step = values.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f32::max);
        let is_build = rise >= RISE_MIN && straight >= STRAIGHT_MIN && step <= STEP_FRACTION * rise;
        let sure = straight * ((count - 2.0) / (1.0 - straight * straight).max(1e-3)).sqrt();
        is_build.then_some(Build { start, sure })
    };
    BUILD_BARS
        .filter_map(|length| end.checked_sub(length))
        .filter_map(rising)
        .max_by(|a, b| a.sure.total_cmp(&b.sure))
}
