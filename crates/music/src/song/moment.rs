//! The values of a song's structure that a scene reads at a moment, as a fast, pure function of structure and time.

use serde::Serialize;

use super::structure::{Section, SongBeat, SongStructure};
use super::{Mode, PITCH_CLASSES, Tonality};
use crate::features::Features;

/// The duration of a drop's fade in bars, or in seconds if the song has no bars.
const DROP_BARS: f64 = 2.0;
const DROP_SECONDS: f64 = 4.0;
/// The number of the letter Z. Letters after Z have the same number.
const LETTERS: u8 = 26;

/// The position of a moment in its song. Every number is finite. Unknown numbers are 0, and times until events that are
/// unknown or do not follow are 1000.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SongMoment {
    /// Position in the bar, 0 up to 1. Bars continue at their tempo before the first beat and after the last.
    pub bar: f32,
    /// The number of the beat in its bar, from 1; 0 without a steady beat.
    pub beat_in_bar: f32,
    /// The section's letter: 1 for A, 26 for Z and for all later letters; 0 without sections.
    pub section: f32,
    /// Position in the section, 0..1.
    pub section_phase: f32,
    /// Loudness over about a second: 1 in the song's loudest second, 0 at 36 dB or more below the loudest second.
    pub energy: f32,
    /// Position in a build, 0..1; 0 outside builds.
    pub build: f32,
    /// 1 at the start of a drop, falling to 0 over two bars.
    pub drop: f32,
    /// Root of the song's key, from 0 for C to 11 for B; 0 if no key fits.
    pub key: f32,
    /// 1 if the key is minor.
    pub minor: f32,
    /// Position in the song, 0..1.
    pub progress: f32,
    /// Seconds until the next beat, 0..1000. Beats continue at their tempo before the first beat and after the last.
    pub to_beat: f32,
    /// Seconds until the next bar, 0..1000.
    pub to_bar: f32,
    /// Seconds until the next section, 0..1000; 1000 in the last section.
    pub to_section: f32,
    /// Seconds until the next drop, 0..1000; 1000 if none follows.
    pub to_drop: f32,
    /// The number of the line of lyrics that is sung, from 1; 0 if none is sung. The structure does not contain the
    /// lyrics, so this and the next two numbers are 0 until their owner writes them.
    pub line: f32,
    /// The number of the word in its line, from 1; 0 if no line is sung.
    pub word: f32,
    /// Position in the line of lyrics, 0..1.
    pub line_phase: f32,
    /// Strength of each pitch class, C first, relative to the strongest in the beat. Values are interpolated linearly
    /// between the middles of beats.
    pub chroma: [f32; PITCH_CLASSES.len()],
}

impl SongMoment {
    /// The moment of an unknown song.
    pub const UNKNOWN: Self = Self {
        bar: 0.0,
        beat_in_bar: 0.0,
        section: 0.0,
        section_phase: 0.0,
        energy: 0.0,
        build: 0.0,
        drop: 0.0,
        key: 0.0,
        minor: 0.0,
        progress: 0.0,
        to_beat: NEVER,
        to_bar: NEVER,
        to_section: NEVER,
        to_drop: NEVER,
        line: 0.0,
        word: 0.0,
        line_phase: 0.0,
        chroma: [0.0; PITCH_CLASSES.len()],
    };

    /// Returns the value called `name` in scenes, such as `bar`.
    pub fn number(&self, name: &str) -> Option<f32> {
        Some(match name {
            "bar" => self.bar,
            "beat_in_bar" => self.beat_in_bar,
            "section" => self.section,
            "section_phase" => self.section_phase,
            "energy" => self.energy,
            "build" => self.build,
            "drop" => self.drop,
            "key" => self.key,
            "minor" => self.minor,
            "progress" => self.progress,
            "to_beat" => self.to_beat,
            "to_bar" => self.to_bar,
            "to_section" => self.to_section,
            "to_drop" => self.to_drop,
            "line" => self.line,
            "word" => self.word,
            "line_phase" => self.line_phase,
            _ => return None,
        })
    }

    /// Returns the moment of live input: its energy, 0..1, the time of the next beat at a steady tempo, its position in
    /// the bar while the position is certain, and the [`LiveSong`](crate::LiveSong).
    pub fn of_live(energy: f32, features: &Features) -> Self {
        let Features { phase, tempo, bar_beat, bar_beats, live, .. } = *features;
        let is_sure = bar_beat >= 1.0 && bar_beats >= bar_beat;
        let place = f64::from(bar_beat - 1.0 + phase) / f64::from(bar_beats);
        let (bar, beat_in_bar) = if is_sure { (below_one(place), bar_beat) } else { (0.0, 0.0) };
        let after = |beats: f32| if tempo > 0.0 { limited(f64::from(60.0 * beats / tempo)) } else { NEVER };
        let to_bar = if is_sure { after(bar_beats * (1.0 - bar)) } else { NEVER };
        let (key, minor) = numbers_of(live.key);
        Self {
            bar,
            beat_in_bar,
            energy: unit(energy),
            build: unit(live.build),
            drop: unit(live.drop),
            key,
            minor,
            to_beat: after(1.0 - phase),
            to_bar,
            chroma: live.chroma.map(unit),
            ..Self::UNKNOWN
        }
    }
}

impl Default for SongMoment {
    fn default() -> Self {
        Self::UNKNOWN
    }
}

impl SongStructure {
    /// Returns the moment at `time` in seconds, clamped to the song. If `time` is NaN, returns [`SongMoment::UNKNOWN`].
    pub fn moment(&self, time: f64) -> SongMoment {
        if time.is_nan() {
            return SongMoment::UNKNOWN;
        }
        let time = time.clamp(0.0, self.seconds.max(0.0));
        let [bar, beat_in_bar, to_beat, to_bar] = in_bar(self, time).unwrap_or([0.0, 0.0, NEVER, NEVER]);
        let (section, next_section) = around(&self.sections, |section| section.start, time);
        let section = section.or(self.sections.first());
        let (build, _) = around(&self.builds, |build| build.start, time);
        let (drop, next_drop) = around(&self.drops, |drop| *drop, time);
        let (key, minor) = numbers_of(self.key);
        SongMoment {
            bar,
            beat_in_bar,
            section: section.map_or(0.0, number_of),
            section_phase: section.map_or(0.0, |section| fraction(time, section.start, section.end)),
            energy: energy(self, time),
            build: build
                .filter(|build| time < build.end)
                .map_or(0.0, |build| fraction(time, build.start, build.end)),
            drop: drop.map_or(0.0, |drop| 1.0 - fraction(time, *drop, drop + seconds_of_drop(self, *drop))),
            key,
            minor,
            progress: fraction(time, 0.0, self.seconds),
            to_beat,
            to_bar,
            to_section: next_section.map_or(NEVER, |section| limited(section.start - time)),
            to_drop: next_drop.map_or(NEVER, |drop| limited(drop - time)),
            chroma: chroma(self, time),
            ..SongMoment::UNKNOWN
        }
    }
}

impl Features {
    /// Replaces the tempo and the phase, which were predicted without knowledge of the song, with the song's own at
    /// `time` seconds, so that they match [`SongMoment::bar`]. Keeps both if the song has no beats.
    pub fn follow_song(&mut self, song: &SongStructure, time: f64) {
        if let Some(Place { beats, tempo, .. }) = place(song, time).filter(|_| time.is_finite()) {
            (self.tempo, self.phase) = (tempo, below_one(beats.rem_euclid(1.0)));
        }
    }
}

/// Returns the last item that started at or before `time`, and the next one.
fn around<T>(items: &[T], start: impl Fn(&T) -> f64, time: f64) -> (Option<&T>, Option<&T>) {
    let after = items.partition_point(|item| start(item) <= time);
    (items[..after].last(), items.get(after))
}

/// Interpolates between the middles of the steps, because each step is a mean.
fn energy(song: &SongStructure, time: f64) -> f32 {
    let place = (time / song.energy_step.max(1e-3) - 0.5).max(0.0);
    let first = (place as usize).min(song.energy.len().saturating_sub(1));
    let at = |index: usize| song.energy.get(index).copied().map(unit);
    let Some(from) = at(first) else { return 0.0 };
    mixed(from, at(first + 1).unwrap_or(from), unit((place - first as f64) as f32))
}

fn seconds_of_drop(song: &SongStructure, drop: f64) -> f64 {
    let Some(meter) = song.meter else { return DROP_SECONDS };
    let beats = DROP_BARS * meter.beats() as f64;
    let first = song.beats.partition_point(|beat| beat.time < drop - 1e-3);
    let last = song.beats.get(first + beats as usize).map(|beat| beat.time - drop);
    let by_tempo = || song.tempo.map(|tempo| 60.0 * beats / f64::from(tempo));
    last.or_else(by_tempo).filter(|seconds| *seconds > 0.0 && seconds.is_finite()).unwrap_or(DROP_SECONDS)
}

fn chroma(song: &SongStructure, time: f64) -> [f32; PITCH_CLASSES.len()] {
    let beats = &song.chroma;
    let Some(last) = beats.len().checked_sub(1) else { return SongMoment::UNKNOWN.chroma };
    let middle = |beat: usize| {
        let end = beats.get(beat + 1).map_or(song.seconds, |next| next.start);
        0.5 * (beats[beat].start + end)
    };
    let here = beats.partition_point(|beat| beat.start <= time).saturating_sub(1);
    let next = if time < middle(here) { here } else { here + 1 };
    let (from, to) = (next.saturating_sub(1), next.min(last));
    let amount = fraction(time, middle(from), middle(to));
    let [from, to] = [from, to].map(|beat| {
        let fractions = beats[beat].fractions;
        let strongest = fractions.iter().copied().fold(0.0, f32::max);
        fractions.map(|fraction| if strongest > 0.0 { unit(fraction / strongest) } else { 0.0 })
    });
    std::array::from_fn(|class| mixed(from[class], to[class], amount))
}

/// Returns the root of a key, and 1 for minor; 0 without a key.
fn numbers_of(key: Option<Tonality>) -> (f32, f32) {
    key.map_or((0.0, 0.0), |key| {
        (f32::from(key.root.min(11)), if key.mode == Mode::Minor { 1.0 } else { 0.0 })
    })
}

/// Returns 1 for A, 2 for B and so on, up to [`LETTERS`].
fn number_of(section: &Section) -> f32 {
    let number = match section.letter.as_bytes() {
        [letter] if letter.is_ascii_uppercase() => letter - b'A' + 1,
        _ => LETTERS,
    };
    f32::from(number)
}

fn fraction(time: f64, start: f64, end: f64) -> f32 {
    let length = end - start;
    if length > 0.0 { unit(((time - start) / length) as f32) } else { 0.0 }
}

/// Interpolates from `a` to `b`. Rounding never produces a value outside the range from `a` to `b`.
fn mixed(a: f32, b: f32, amount: f32) -> f32 {
    (a * (1.0 - amount) + b * amount).clamp(a.min(b), a.max(b))
}

/// Clamps to 0..1; NaN becomes 0.
fn unit(value: f32) -> f32 {
    if value > 0.0 { value.min(1.0) } else { 0.0 }
}

fn below_one(value: f64) -> f32 {
    unit(value as f32).min(1.0 - f32::EPSILON)
}

// The position of a moment among the beats of a song.

/// A position among the beats. Before the first beat and after the last, beats continue at the tempo of that beat.
struct Place<'a> {
    /// Beats since the start of a bar, with a fraction.
    beats: f64,
    /// The time between beats here, in seconds.
    period: f64,
    /// Beats per minute, 0 or more.
    tempo: f32,
    /// The beats that follow; none outside the beats.
    following: &'a [SongBeat],
}

/// Returns the position at `time` in seconds; `None` if the song has no beats.
fn place(song: &SongStructure, time: f64) -> Option<Place<'_>> {
    let after = song.beats.partition_point(|beat| beat.time <= time);
    // Use the last beat at or before the time, or the first beat if the time is earlier.
    let beat = song.beats.get(after.saturating_sub(1))?;
    let following: &[SongBeat] = if after > 0 { &song.beats[after..] } else { &[] };
    let period = following.first().map_or(60.0 / f64::from(beat.tempo), |next| next.time - beat.time);
    // If two beats are extremely close, treat them as one second apart, so that the result stays finite.
    let passed = (time - beat.time) / if period > 1e-3 { period } else { 1.0 };
    let beats = f64::from(beat.of_bar) - 1.0 + if passed.is_finite() { passed } else { 0.0 };
    let tempo = if beat.tempo.is_finite() { beat.tempo.max(0.0) } else { 0.0 };
    Some(Place { beats, period, tempo, following })
}

/// The time in seconds until an event that does not follow or that is unknown. Longer times are limited to it.
const NEVER: f32 = 1_000.0;

/// Returns the position in the bar, the number of the beat in it, and the times from `time` until the next beat and the
/// next bar, 0..=[`NEVER`]. A beat at `time` has passed. Returns `None` if the song has no beats.
fn in_bar(song: &SongStructure, time: f64) -> Option<[f32; 4]> {
    let in_bar = song.meter?.beats();
    let here = place(song, time)?;
    let of_bar = here.beats.rem_euclid(in_bar as f64);
    let number = (of_bar.floor() + 1.0).min(in_bar as f64);
    let until = |beat: &SongBeat| beat.time - time;
    let beat = here.following.first().map_or((1.0 - here.beats.rem_euclid(1.0)) * here.period, until);
    let downbeat = here.following.iter().take(in_bar).find(|beat| beat.of_bar == 1);
    let bar = downbeat.map_or((in_bar as f64 - of_bar) * here.period, until);
    Some([below_one(of_bar / in_bar as f64), number as f32, limited(beat), limited(bar)])
}

/// Clamps to 0..=[`NEVER`]; NaN becomes [`NEVER`].
fn limited(seconds: f64) -> f32 {
    if seconds < f64::from(NEVER) { seconds.max(0.0) as f32 } else { NEVER }
}

#[cfg(test)]
#[path = "moment_tests.rs"]
mod tests;
