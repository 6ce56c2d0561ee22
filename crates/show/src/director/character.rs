//! The character of a song and of its sections, on scales that suit most music.

use mariana_music::{Mode, SongStructure};

/// A property of the music. Each value is between -1 and 1; 0 is usual, or unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Trait {
    /// The tempo; -1 without a steady beat.
    Tempo,
    /// Onsets per second.
    Density,
    /// The balance of high and low frequencies.
    Brightness,
    /// -1 in major, 1 in minor.
    Minor,
    /// The share of percussion.
    Percussion,
    /// The energy, as in the `about` block, but from -1 to 1.
    Energy,
}

/// The values of a stretch of music, in the order of [`Trait`].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Character([f32; 6]);

/// The values of a property that count as -1 and 1: about 1.5 standard deviations around the mean of 38 songs of games.
struct Scale(f32, f32);

const TEMPO: Scale = Scale(90.0, 170.0);
const DENSITY: Scale = Scale(0.6, 6.6);
const BRIGHTNESS: Scale = Scale(0.24, 0.40);
const PERCUSSION: Scale = Scale(0.02, 0.09);
/// Half the value of a song with major (minor) key and only major (minor) chords. Modes lie at the ends of their scale,
/// so that they would otherwise outweigh the other properties.
const MODE: f32 = 0.2;
/// In LUFS.
const LOUDNESS: Scale = Scale(-20.0, -9.0);

/// The decibels between energy 0 and 1 of a section.
const ENERGY_DB: f32 = 36.0;
/// How much each property adds to the energy. The weights sum to 1.
const ENERGY_OF: [(Trait, f32); 3] = [(Trait::Density, 0.3), (Trait::Tempo, 0.2), (Trait::Percussion, 0.25)];
const ENERGY_OF_LOUDNESS: f32 = 0.25;
/// The difference in energy between the calmest and the loudest music, without regard to the rest of its song.
const ENERGY_RANGE: f32 = 0.9;
/// The difference in energy between the calmest and the loudest section of a song with full contrast.
const CONTRAST_RANGE: f32 = 0.6;
/// A song has full contrast if its sections differ in energy by at least this much (11 dB).
const FULL_CONTRAST: f32 = 0.3;
/// Percentiles of a song's energy that count as calm and as loud.
const SPREAD: [f64; 2] = [0.1, 0.9];
/// The energy of a song that has no sections.
const EVEN: f32 = 0.5;

impl Scale {
    fn place(&self, value: f32) -> f32 {
        let place = 2.0 * (value - self.0) / (self.1 - self.0) - 1.0;
        if place.is_finite() { place.clamp(-1.0, 1.0) } else { 0.0 }
    }
}

impl Character {
    pub(super) fn of(&self, which: Trait) -> f32 {
        self.0.get(which as usize).copied().unwrap_or_default()
    }

    fn set(&mut self, which: Trait, value: f32) {
        if let Some(place) = self.0.get_mut(which as usize) {
            *place = value;
        }
    }

    pub(super) fn add(&mut self, which: Trait, value: f32) {
        self.set(which, self.of(which) + value);
    }

    /// Returns the part of `music` that lies in the direction of these values, -1..1; 0 if all values are 0.
    pub(super) fn along(&self, music: &Self) -> f32 {
        let product = |a: &Self, b: &Self| a.0.iter().zip(b.0).map(|(a, b)| a * b).sum::<f32>();
        let length = product(self, self).sqrt();
        if length > 0.0 { (product(self, music) / length).clamp(-1.0, 1.0) } else { 0.0 }
    }

    /// Returns the energy, 0..1.
    pub(super) fn energy(&self) -> f32 {
        0.5 + 0.5 * self.of(Trait::Energy)
    }

    /// Music of which only the energy is known, 0..1.
    pub(super) fn of_energy(energy: f32) -> Self {
        let mut character = Self::default();
        character.set(Trait::Energy, 2.0 * energy.clamp(0.0, 1.0) - 1.0);
        character
    }
}

/// The characters of a song and its sections.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Characters {
    sections: Vec<Character>,
    /// How much the sections differ in energy: 0 not at all, 1 as much as in songs of great contrast.
    pub(super) contrast: f32,
}

impl Characters {
    pub(super) fn of(song: &SongStructure) -> Self {
        let spread = Spread::of(song);
        let contrast = ((spread.most - spread.least) / FULL_CONTRAST).clamp(0.0, 1.0);
        let mut sections: Vec<Character> =
            (0..song.sections.len()).map(|index| measured(song, index)).collect();
        for (character, section) in sections.iter_mut().zip(&song.sections) {
            let parts = ENERGY_OF.iter().map(|(which, weight)| weight * character.of(*which));
            let above = ENERGY_DB * (section.energy - spread.mean);
            let loudness = song.loudness.map_or(0.0, |loudness| LOUDNESS.place(loudness + above));
            let absolute = EVEN + 0.5 * ENERGY_RANGE * (parts.sum::<f32>() + ENERGY_OF_LOUDNESS * loudness);
            let relative = CONTRAST_RANGE * contrast * (spread.place(section.energy) - 0.5);
            character.set(Trait::Energy, (2.0 * (absolute + relative) - 1.0).clamp(-1.0, 1.0));
        }
        Self { sections: smoothed(song, sections), contrast }
    }

    /// Returns the character of the music at `time` seconds.
    pub(super) fn at(&self, song: &SongStructure, time: f64) -> Character {
        let section = song.sections.iter().rposition(|section| section.start <= time + 0.05);
        let character = section.and_then(|section| self.sections.get(section)).or(self.sections.first());
        character.copied().unwrap_or(Character::of_energy(EVEN))
    }
}

/// Mixes each section in equal parts with the song, so that a show keeps to the song's character. The energy stays.
fn smoothed(song: &SongStructure, mut sections: Vec<Character>) -> Vec<Character> {
    let lengths: Vec<f32> =
        song.sections.iter().map(|section| (section.end - section.start).max(0.0) as f32).collect();
    let seconds: f32 = lengths.iter().sum::<f32>().max(f32::MIN_POSITIVE);
    for which in [Trait::Tempo, Trait::Density, Trait::Brightness, Trait::Minor, Trait::Percussion] {
        let weighted = sections.iter().zip(&lengths).map(|(one, length)| one.of(which) * length);
        let mean = weighted.sum::<f32>() / seconds;
        sections.iter_mut().for_each(|one| one.set(which, 0.5 * (one.of(which) + mean)));
    }
    sections
}

/// Returns the character of a section, without its energy.
fn measured(song: &SongStructure, index: usize) -> Character {
    let mut character = Character::default();
    let (Some(section), Some(sound)) = (song.sections.get(index), song.sounds.get(index)) else {
        return character;
    };
    character.set(Trait::Tempo, song.tempo.map_or(-1.0, |tempo| TEMPO.place(tempo)));
    character.set(Trait::Density, DENSITY.place(sound.onsets));
    character.set(Trait::Brightness, BRIGHTNESS.place(sound.brightness));
    character.set(Trait::Percussion, PERCUSSION.place(sound.percussive));
    let (mut minor, mut all) = (0.0, 0.0);
    for chord in &song.chords {
        let seconds = (chord.end.min(section.end) - chord.start.max(section.start)).max(0.0) as f32;
        if let Some(triad) = chord.triad {
            all += seconds;
            minor += seconds * sign(triad.mode);
        }
    }
    let of_chords = if all > 0.0 { minor / all } else { 0.0 };
    let of_key = song.key.map_or(of_chords, |key| sign(key.mode));
    character.set(Trait::Minor, MODE * (of_chords + of_key));
    character
}

fn sign(mode: Mode) -> f32 {
    match mode {
        Mode::Major => -1.0,
        Mode::Minor => 1.0,
    }
}

/// The range of a song's energy.
struct Spread {
    least: f32,
    most: f32,
    mean: f32,
}

impl Spread {
    fn of(song: &SongStructure) -> Self {
        let mut sections: Vec<(f32, f64)> =
            song.sections.iter().map(|section| (section.energy, section.end - section.start)).collect();
        sections.sort_by(|a, b| a.0.total_cmp(&b.0));
        let all: f64 = sections.iter().map(|(_, seconds)| seconds).sum();
        // Weight sections by duration, so that a short calm ending does not make the rest of the song count as loud.
        let at = |fraction: f64| {
            let mut gone = 0.0;
            let found = sections.iter().find(|(_, seconds)| {
                gone += seconds;
                gone >= fraction * all
            });
            found.or(sections.last()).map_or(EVEN, |(energy, _)| *energy)
        };
        let sum: f64 = sections.iter().map(|(energy, seconds)| f64::from(*energy) * seconds).sum();
        let mean = if all > 0.0 { (sum / all) as f32 } else { EVEN };
        Self { least: at(SPREAD[0]), most: at(SPREAD[1]), mean }
    }

    /// Returns the place of an energy in the range, 0..1.
    fn place(&self, energy: f32) -> f32 {
        let range = self.most - self.least;
        if range > 1e-3 { ((energy - self.least) / range).clamp(0.0, 1.0) } else { 0.5 }
    }
}
