//! The parts of a song, such as its drums, and the numbers that scenes read from each part.
//!
//! Each part has the numbers of [`SoundInput`] that are heard from moment to moment, and the frequency bands. The
//! numbers of all parts form one table, which the operator `Op::Part` reads by index.

use super::{LevelList, SoundInput};

/// A separated part of a song.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum SongPart {
    /// Drums.
    Drums,
    /// The bass.
    Bass,
    /// Voices.
    Vocals,
    /// Everything else.
    Other,
}

impl SongPart {
    /// All parts, in the order in which frames hold them.
    pub const ALL: [Self; 4] = [Self::Drums, Self::Bass, Self::Vocals, Self::Other];

    /// Names in a scene, and descriptions on the language's page.
    const ROWS: [(&'static str, &'static str); 4] = [
        ("drums", "drums, as in drums.beat"),
        ("bass", "the bass instrument, as in bass.volume (bass alone is the input: low frequencies)"),
        ("vocals", "voices, as in vocals.melody"),
        ("other", "all other instruments, as in other.band(3)"),
    ];

    /// Returns the name in a scene.
    pub const fn name(self) -> &'static str {
        Self::ROWS[self as usize].0
    }

    /// Returns the description on the language's page.
    pub const fn doc(self) -> &'static str {
        Self::ROWS[self as usize].1
    }
}

/// A number of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum PartNumber {
    /// A number that describes the sound of the moment ([`PartInput::sounds`]).
    Sound(SoundInput),
    /// A frequency band, low to high.
    Band(u8),
}

/// Number of a part's inputs before its bands.
const SOUNDS: usize = SoundInput::Bar as usize;

/// Number of a part's bands.
const BANDS: usize = LevelList::Band.count();

/// A part and one of its numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PartInput {
    /// The part.
    pub part: SongPart,
    /// The number.
    pub number: PartNumber,
}

impl PartInput {
    /// Number of numbers of one part.
    pub const OF_ONE: usize = SOUNDS + BANDS;
    /// Number of numbers of all parts.
    pub const COUNT: usize = SongPart::ALL.len() * Self::OF_ONE;

    /// The first band of a part. The other bands follow.
    pub const fn first_band(part: SongPart) -> Self {
        Self { part, number: PartNumber::Band(0) }
    }

    /// The inputs of the sound that each part has. The other inputs describe the whole song.
    pub fn sounds() -> impl Iterator<Item = SoundInput> {
        SoundInput::ALL.into_iter().take(SOUNDS)
    }

    /// Index in the table of all parts.
    pub const fn index(self) -> usize {
        let number = match self.number {
            PartNumber::Sound(input) => input as usize,
            PartNumber::Band(band) => SOUNDS + band as usize,
        };
        self.part as usize * Self::OF_ONE + number
    }

    /// Returns the number with this index.
    pub fn at(index: usize) -> Option<Self> {
        let (part, number) = (*SongPart::ALL.get(index / Self::OF_ONE)?, index % Self::OF_ONE);
        let number = match number.checked_sub(SOUNDS) {
            Some(band) => PartNumber::Band(band as u8),
            None => PartNumber::Sound(*SoundInput::ALL.get(number)?),
        };
        Some(Self { part, number })
    }

    /// Returns the index that `Op::Part` reads for its operand: the operand rounded down and clamped
    /// to the table; 0 for a NaN.
    pub fn clamped(index: f32) -> usize {
        (index.max(0.0) as usize).min(Self::COUNT - 1)
    }

    /// Returns the number with a name such as `drums.volume.x` or `vocals.band(3)`.
    pub fn named(name: &str) -> Option<Self> {
        let (part, number) = name.split_once('.')?;
        let part = SongPart::ALL.into_iter().find(|one| one.name() == part)?;
        let band = number.strip_prefix("band(").and_then(|rest| rest.strip_suffix(')'));
        let number = match band {
            Some(band) => PartNumber::Band(band.trim().parse().ok().filter(|at| usize::from(*at) < BANDS)?),
            None => PartNumber::Sound(Self::sounds().find(|input| input.name() == number)?),
        };
        Some(Self { part, number })
    }

    /// Least and greatest value.
    pub const fn range(self) -> (f32, f32) {
        match self.number {
            PartNumber::Sound(input) => input.range(),
            PartNumber::Band(_) => (0.0, 1.0),
        }
    }

    /// Clamps a value to the range. A value that is not finite becomes 0.
    pub fn clamp(self, value: f32) -> f32 {
        let (least, most) = self.range();
        if value.is_finite() { value.clamp(least, most) } else { 0.0 }
    }
}

impl std::fmt::Display for PartInput {
    /// Returns the name in a scene, such as `drums.volume.x`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.number {
            PartNumber::Sound(input) => write!(f, "{}.{}", self.part.name(), input.name()),
            PartNumber::Band(band) => write!(f, "{}.band({band})", self.part.name()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_one_place_one_name_and_rest_at_0() {
        for index in 0..PartInput::COUNT {
            let input = PartInput::at(index).unwrap();
            assert_eq!(input.index(), index);
            assert_eq!(PartInput::named(&input.to_string()), Some(input));
            assert_eq!(input.range().0, 0.0, "{input}: a part that is unknown is 0");
        }
        assert_eq!(PartInput::at(PartInput::COUNT), None);
        for name in
            ["drums", "drums.", "drums.bar", "drums.chroma(0)", "drums.band(32)", "horns.beat", "bass.volume"]
        {
            assert_eq!(PartInput::named(name), None, "{name}");
        }
        assert_eq!(
            [-1.0, f32::NAN, 2.9, f32::INFINITY].map(PartInput::clamped),
            [0, 0, 2, PartInput::COUNT - 1]
        );
    }
}
