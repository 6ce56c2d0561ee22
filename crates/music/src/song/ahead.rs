//! The times until the next beat, bar, section and drop of a song, which is known in advance.

use super::structure::SongStructure;

/// The time in seconds until an event that does not follow or that is unknown. Longer times are limited to it.
pub(super) const NEVER: f32 = 1_000.0;

/// Times in seconds, 0..=[`NEVER`].
pub(super) struct Ahead {
    pub(super) beat: f32,
    pub(super) bar: f32,
    pub(super) section: f32,
    pub(super) drop: f32,
}

/// Returns the times from `time` until the next events. An event at `time` has passed.
pub(super) fn ahead(song: &SongStructure, time: f64) -> Ahead {
    let after = |start: Option<f64>| start.map_or(NEVER, |start| limited(start - time));
    let section = song.sections.partition_point(|section| section.start <= time);
    let drop = song.drops.partition_point(|drop| *drop <= time);
    let (beat, bar) = beat_and_bar(song, time).unwrap_or((NEVER, NEVER));
    Ahead {
        beat,
        bar,
        section: after(song.sections.get(section).map(|section| section.start)),
        drop: after(song.drops.get(drop).copied()),
    }
}

/// Before the first beat and after the last one, beats continue at the tempo of this beat.
fn beat_and_bar(song: &SongStructure, time: f64) -> Option<(f32, f32)> {
    let in_bar = song.meter?.beats() as f64;
    let next = song.beats.partition_point(|beat| beat.time <= time);
    let here = song.beats.get(next.saturating_sub(1))?;
    let period = 60.0 / f64::from(here.tempo);
    // The beats since `here`, which may be negative, and since the start of its bar.
    let passed = (time - here.time) / period;
    let in_song = song.beats.get(next).filter(|_| next > 0);
    let beat = in_song.map_or((1.0 - passed.rem_euclid(1.0)) * period, |beat| beat.time - time);
    let downbeat = song.beats.iter().skip(next).take(song.meter?.beats()).find(|beat| beat.of_bar == 1);
    let place = (f64::from(here.of_bar) - 1.0 + passed).rem_euclid(in_bar);
    let bar = downbeat.filter(|_| next > 0).map_or((in_bar - place) * period, |beat| beat.time - time);
    Some((limited(beat), limited(bar)))
}

/// Clamps to 0..=[`NEVER`]; NaN becomes [`NEVER`].
pub(super) fn limited(seconds: f64) -> f32 {
    if seconds < f64::from(NEVER) { seconds.max(0.0) as f32 } else { NEVER }
}
