//! The beats of a whole song: the likeliest path ([`super::pulse`]) through the odds of a beat at each moment
//! ([`crate::activation`]), at the likeliest metrical level ([`super::levels`]), from the first to the last stretch of
//! the song with a steady beat.

use super::heard::{Heard, Moment};
use super::levels::leveled;
use super::pulse::likeliest_beats;
use super::strengths::onset_strengths;
use crate::activation::STEP_HOPS;

/// Onsets appear in the flux this many hops late.
const FLUX_LATE: f64 = 0.6;
/// The onset of a beat is searched within this many hops before and after the beat.
const AROUND: usize = 2;
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
