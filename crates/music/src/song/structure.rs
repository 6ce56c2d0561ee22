//! The structure of a song, as stored and used by scenes and shows.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::bars::{Meter, bars};
use super::drops::{builds_and_drops, eves};
use super::energy::{ENERGY_STEP, energy, peaks};
use super::heard::Heard;
use super::key::{Tonality, chords, key, pitches_of};
use super::pulse::beats;
use super::sections::{SectionSound, section_sound, sections};
use super::strengths::onset_strengths;
use super::units::{Unit, units};

/// If a song has no beats, sections may start at multiples of this time, in seconds.
const STEP_WITHOUT_BEATS: f64 = 2.0;
/// If a song has no beats, harmony is compared in steps of this time, in seconds.
const SHORT_STEP: f64 = 0.5;
/// A song whose loudest moment has less power than this (-80 dB) is silent.
const SILENT: f32 = 1e-8;

/// A beat of a song.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct SongBeat {
    /// The time in seconds.
    pub time: f64,
    /// The number of the beat in its bar; 1 is the downbeat.
    pub of_bar: u8,
    /// The tempo around the beat, in beats per minute.
    pub tempo: f32,
}

/// A stretch of time.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct Stretch {
    /// The start in seconds.
    pub start: f64,
    /// The end in seconds.
    pub end: f64,
}

/// A section of a song.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Section {
    /// The start in seconds.
    pub start: f64,
    /// The end in seconds.
    pub end: f64,
    /// The letter: A, B, C and so on by first appearance, then AA, AB and so on. Similar sections have the same letter.
    pub letter: String,
    /// Mean energy, 0..1.
    pub energy: f32,
}

/// A stretch with one chord.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct Chord {
    /// The start in seconds.
    pub start: f64,
    /// The end in seconds.
    pub end: f64,
    /// The triad; `None` if no triad fits.
    pub triad: Option<Tonality>,
}

/// The pitch classes from one beat to the next.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct PitchFractions {
    /// The start in seconds.
    pub start: f64,
    /// The fraction of each pitch class, C first. The fractions sum to 1, or to 0 without pitches.
    pub fractions: [f32; 12],
}

/// The structure of a song. Times are seconds from the song's start; all numbers are finite.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct SongStructure {
    /// The length of the analysed part, in seconds.
    pub seconds: f64,
    /// True if the song is longer than the limits' `song_seconds_max`. The part beyond this limit is not analysed.
    pub cut_short: bool,
    /// True if the song is silent.
    pub silent: bool,
    /// The integrated loudness by EBU R128 in LUFS (-70 and more). Mono is measured as it is played: as two equal
    /// channels. The loudness is `None` if the song is shorter than 0.4 s or too quiet.
    pub loudness: Option<f32>,
    /// The median tempo in beats per minute; `None` without a steady beat.
    pub tempo: Option<f32>,
    /// The meter; `None` without beats.
    pub meter: Option<Meter>,
    /// The beats; empty without a steady beat.
    pub beats: Vec<SongBeat>,
    /// The sections. They cover the song unless the song is silent. If the song has bars, sections begin with bars.
    pub sections: Vec<Section>,
    /// How each section sounds, in the order of the sections.
    pub sounds: Vec<SectionSound>,
    /// `energy` and `peaks` have one value every this many seconds.
    pub energy_step: f64,
    /// The energy of each step: 1 in the song's loudest second, 0 at 36 dB or more below the loudest second.
    pub energy: Vec<f32>,
    /// The largest sample magnitude in each step.
    pub peaks: Vec<f32>,
    /// The builds.
    pub builds: Vec<Stretch>,
    /// The starts of drops, in seconds.
    pub drops: Vec<f64>,
    /// The key; `None` if no key fits.
    pub key: Option<Tonality>,
    /// The frequency to which the instruments tune the tone a', in hertz.
    pub tuning_hz: f64,
    /// The chords, which change on beats and cover the song.
    pub chords: Vec<Chord>,
    /// The pitch classes, beat by beat.
    pub chroma: Vec<PitchFractions>,
}

impl SongStructure {
    /// The times of the downbeats.
    pub fn downbeats(&self) -> impl Iterator<Item = f64> {
        self.beats.iter().filter(|beat| beat.of_bar == 1).map(|beat| beat.time)
    }

    pub(super) fn of(heard: &Heard) -> Self {
        let seconds = heard.seconds;
        let mut structure = Self {
            seconds,
            cut_short: heard.cut_short,
            loudness: heard.loudness,
            energy_step: ENERGY_STEP,
            energy: energy(heard),
            peaks: peaks(heard),
            tuning_hz: 440.0 * (heard.tuning.semitones / 12.0).exp2(),
            ..Self::default()
        };
        structure.silent = heard.moments.iter().all(|moment| moment.power < SILENT);
        if structure.silent {
            return structure;
        }
        let mut beats = beats(heard);
        beats.retain(|beat| *beat < seconds);
        // If the song has no beats, a bar and a beat are the same, and harmony is compared in shorter steps.
        let (bar_times, beat_times, steps) = if beats.is_empty() {
            let times = grid(&[], STEP_WITHOUT_BEATS, seconds);
            (times.clone(), times, grid(&[], SHORT_STEP, seconds))
        } else {
            let times = grid(&beats, period(&beats), seconds);
            (structure.set_beats(heard, &beats), times.clone(), times)
        };
        // Silence before and after the song does not belong to a bar's sound.
        let sounding = heard.sounding();
        let of_sound: Vec<f64> =
            bar_times.iter().map(|time| time.clamp(sounding.start, sounding.end)).collect();
        let mut bars = units(heard, &of_sound);
        let of_beats = units(heard, &beat_times);
        let fractions =
            |(start, unit): (&f64, &Unit)| PitchFractions { start: *start, fractions: unit.chroma };
        structure.chroma = beat_times.iter().zip(&of_beats).map(fractions).collect();
        let triads = chords(&of_beats);
        structure.chords = joined(&beat_times, &triads);
        let mut of_steps = units(heard, &steps);
        if pitches_of(&of_beats).is_none() {
            // Without harmony the measured pitches are random.
            bars.iter_mut().chain(&mut of_steps).for_each(|unit| unit.chroma = [0.0; 12]);
        }
        let firsts: Vec<usize> =
            bar_times.iter().map(|bar| steps.partition_point(|step| *step < bar - 1e-3)).collect();
        let sections = sections(&with_edges_filled(&bars, &bar_times, &sounding), &of_steps, &firsts);
        let borders: Vec<usize> = sections.iter().skip(1).map(|section| section.bars.start).collect();
        for section in sections {
            let (start, end) = (bar_times[section.bars.start], bar_times[section.bars.end]);
            let energy = structure.mean_energy(start, end);
            structure.sounds.push(section_sound(heard, start, end));
            structure.sections.push(Section { start, end, letter: letter(section.letter), energy });
        }
        let firsts = structure.sections.iter().map(|section| {
            let beat = beat_times.partition_point(|time| *time < section.start + 1e-3);
            triads.get(beat).copied().flatten()
        });
        structure.key = key(&of_beats, &triads, &firsts.collect::<Vec<_>>());
        if !beats.is_empty() {
            let (builds, drops) = builds_and_drops(&bars, &eves(heard, &of_sound), &borders);
            structure.builds = builds
                .into_iter()
                .map(|bars| Stretch { start: bar_times[bars.start], end: bar_times[bars.end] })
                .collect();
            structure.drops = drops.into_iter().map(|bar| bar_times[bar]).collect();
        }
        structure
    }

    /// Sets beats, meter and tempo. Returns the times of the bars over the whole song.
    fn set_beats(&mut self, heard: &Heard, beats: &[f64]) -> Vec<f64> {
        let of_beats = units(heard, beats);
        let (meter, positions) = bars(heard, &onset_strengths(heard), beats, &of_beats);
        self.meter = Some(meter);
        let beat = |index: usize| {
            // Average the tempo over four beats, so that the rounding to hops does not show.
            let (from, to) = (index.saturating_sub(2), (index + 2).min(beats.len() - 1));
            let tempo = (60.0 * (to - from) as f64 / (beats[to] - beats[from]).max(1e-3)) as f32;
            SongBeat { time: beats[index], of_bar: positions[index] as u8 + 1, tempo }
        };
        self.beats = (0..beats.len()).map(beat).collect();
        self.tempo = Some((60.0 / period(beats)) as f32);
        let downbeats: Vec<f64> = self.downbeats().collect();
        grid(&downbeats, period(beats) * meter.beats() as f64, self.seconds)
    }

    fn mean_energy(&self, start: f64, end: f64) -> f32 {
        let place = |time: f64| ((time / ENERGY_STEP).round() as usize).min(self.energy.len());
        let values = self.energy.get(place(start)..place(end)).unwrap_or_default();
        values.iter().sum::<f32>() / values.len().max(1) as f32
    }
}

/// Returns the chords of the beats that begin at `times`. Equal chords in a row become one.
fn joined(times: &[f64], triads: &[Option<Tonality>]) -> Vec<Chord> {
    let mut chords: Vec<Chord> = Vec::new();
    for (times, triad) in times.windows(2).zip(triads.iter().copied()) {
        match chords.last_mut() {
            Some(last) if last.triad == triad => last.end = times[1],
            _ => chords.push(Chord { start: times[0], end: times[1], triad }),
        }
    }
    chords
}

/// Returns the mean of the middle half of the periods; a median would show the rounding of times to hops.
fn period(times: &[f64]) -> f64 {
    let mut periods: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    periods.sort_by(f64::total_cmp);
    let middle = &periods[periods.len() / 4..(periods.len() * 3).div_ceil(4)];
    if middle.is_empty() { 1.0 } else { middle.iter().sum::<f64>() / middle.len() as f64 }
}

/// Extends the times in steps of `period` to both ends of the song, and adds both ends. No stretch is shorter than half
/// a period, unless the song is shorter.
fn grid(times: &[f64], period: f64, seconds: f64) -> Vec<f64> {
    let mut before = Vec::new();
    let mut first = times.first().copied().unwrap_or(0.0);
    while first - period > 0.5 * period {
        first -= period;
        before.push(first);
    }
    let mut grid = vec![0.0];
    grid.extend(before.into_iter().rev());
    grid.extend(times.iter().copied().filter(|time| *time > 0.5 * period));
    let last = |grid: &[f64]| grid.last().copied().unwrap_or_default();
    while last(&grid) + 1.5 * period < seconds {
        let next = last(&grid) + period;
        grid.push(next);
    }
    if grid.len() > 1 && seconds - last(&grid) < 0.5 * period {
        grid.pop();
    }
    grid.push(seconds);
    grid
}

/// Replaces bars that are mostly outside the `sounding` time by the nearest other bar, so that the silence around a
/// song does not become a section.
fn with_edges_filled(bars: &[Unit], bar_times: &[f64], sounding: &Range<f64>) -> Vec<Unit> {
    let sounds = |times: &[f64]| {
        let heard = times[1].min(sounding.end) - times[0].max(sounding.start);
        heard >= 0.5 * (times[1] - times[0])
    };
    let inside: Vec<bool> = bar_times.windows(2).map(sounds).collect();
    let first = inside.iter().position(|inside| *inside).unwrap_or_default();
    let last = inside.iter().rposition(|inside| *inside).unwrap_or(bars.len().saturating_sub(1));
    (0..bars.len()).filter_map(|index| bars.get(index.clamp(first, last.max(first))).copied()).collect()
}

fn letter(index: usize) -> String {
    let last = char::from(b'A' + (index % 26) as u8);
    if index < 26 { last.to_string() } else { letter(index / 26 - 1) + &last.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_continue_after_z() {
        assert_eq!([0, 25, 26, 51, 52].map(letter), ["A", "Z", "AA", "AZ", "BA"]);
    }

    #[test]
    fn the_grid_covers_the_song() {
        assert_eq!(grid(&[3.0, 5.0], 2.0, 10.2), [0.0, 3.0, 5.0, 7.0, 9.0, 10.2]);
        assert_eq!(grid(&[0.3, 2.3], 2.0, 4.2), [0.0, 2.3, 4.2]);
        assert_eq!(grid(&[], 2.0, 1.0), [0.0, 1.0]);
    }
}
