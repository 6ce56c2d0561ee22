//! The times until the next beat, bar, section and drop of a song, which is known in advance.

use super::place::place;
use super::structure::{SongBeat, SongStructure};

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

fn beat_and_bar(song: &SongStructure, time: f64) -> Option<(f32, f32)> {
    let in_bar = song.meter?.beats();
    let here = place(song, time)?;
    let following = song.beats.get(here.next.unwrap_or(song.beats.len())..).unwrap_or_default();
    let until = |beat: &SongBeat| beat.time - time;
    let beat = following.first().map_or((1.0 - here.beats.rem_euclid(1.0)) * here.period, until);
    let in_beats = in_bar as f64 - here.beats.rem_euclid(in_bar as f64);
    let downbeat = following.iter().take(in_bar).find(|beat| beat.of_bar == 1);
    let bar = downbeat.map_or(in_beats * here.period, until);
    Some((limited(beat), limited(bar)))
}

/// Clamps to 0..=[`NEVER`]; NaN becomes [`NEVER`].
pub(super) fn limited(seconds: f64) -> f32 {
    if seconds < f64::from(NEVER) { seconds.max(0.0) as f32 } else { NEVER }
}
