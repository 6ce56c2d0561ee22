//! The position of a moment among the beats of a song.

use super::structure::SongStructure;

/// A position among the beats. Before the first beat and after the last, beats continue at the tempo of that beat.
pub(super) struct Place {
    /// Beats since the start of a bar, with a fraction.
    pub(super) beats: f64,
    /// The time between beats here, in seconds.
    pub(super) period: f64,
    /// Beats per minute, 0 or more.
    pub(super) tempo: f32,
    /// The number of the next beat; `None` outside the beats.
    pub(super) next: Option<usize>,
}

/// Returns the position at `time` in seconds; `None` if the song has no beats.
pub(super) fn place(song: &SongStructure, time: f64) -> Option<Place> {
    let after = song.beats.partition_point(|beat| beat.time <= time);
    // Use the last beat at or before the time, or the first beat if the time is earlier.
    let beat = song.beats.get(after.saturating_sub(1))?;
    let next = song.beats.get(after).filter(|_| after > 0);
    let period = next.map_or(60.0 / f64::from(beat.tempo), |next| next.time - beat.time);
    // If two beats are extremely close, treat them as one second apart, so that the result stays finite.
    let passed = (time - beat.time) / if period > 1e-3 { period } else { 1.0 };
    let beats = f64::from(beat.of_bar) - 1.0 + if passed.is_finite() { passed } else { 0.0 };
    let tempo = if beat.tempo.is_finite() { beat.tempo.max(0.0) } else { 0.0 };
    Some(Place { beats, period, tempo, next: next.map(|_| after) })
}
