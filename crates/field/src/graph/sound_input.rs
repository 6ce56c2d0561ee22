//! The numbers of the sound that scenes read by name, one row each. Everything else about them is derived from the
//! rows: the names of the language and their documentation, tapes, GLSL, the frame's block for the shaders, the
//! bounds that hold for any sound, the frames with which a scene is tried, and `mariana eval --set`.
//!
//! From `bar` on they are of the whole song ([`SoundInput::is_of_song`]). Bands and tables (`band(i)`, `spectrum(u)`) are
//! read by functions; they stand in [`FrameInputs`](super::FrameInputs). So is `chroma(i)`, but its twelve numbers are
//! rows here, because a function of twelve numbers needs no operator of its own.

use std::ops::{Index, IndexMut};

macro_rules! sound_inputs {
    ($($(#[doc = $doc:literal])+ $input:ident, $name:literal, $least:literal..$most:literal, $reported:literal;)+) => {
        /// A number of the sound; constant over a frame.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[repr(u8)]
        pub enum SoundInput {
            $($(#[doc = $doc])+ $input,)+
        }

        /// Name, least and greatest value, and the description on the language's page.
        const ROWS: &[(&str, f32, f32, &str)] = &[$(($name, $least, $most, $reported),)+];

        impl SoundInput {
            /// All of them, in the order in which frames hold them.
            pub const ALL: [Self; ROWS.len()] = [$(Self::$input,)+];
        }
    };
}

sound_inputs! {
    /// Volume of the left channel.
    VolumeLeft, "volume.x", 0.0..1.0, "volume of the left channel, 0..1";
    /// Volume of the right channel.
    VolumeRight, "volume.y", 0.0..1.0, "volume of the right channel, 0..1";
    /// Low frequencies.
    Bass, "bass", 0.0..1.0, "low frequencies, up to 144 Hz, 0..1";
    /// Middle frequencies.
    Mid, "mid", 0.0..1.0, "middle frequencies, 144 Hz to 1.85 kHz, 0..1";
    /// High frequencies.
    Treble, "treble", 0.0..1.0, "high frequencies, from 1.85 kHz, 0..1";
    /// 1 on an onset, then decaying.
    Beat, "beat", 0.0..1.0, "1 where a sound begins, falling by e in 0.15 s";
    /// Beats per minute.
    Tempo, "tempo", 0.0..1000.0, "beats per minute, 0 while unknown";
    /// Position in the beat.
    Phase, "phase", 0.0..1.0, "way from the last beat to the next, 0 up to 1";
    /// Volume of what both channels share.
    VolumeMid, "volume_mid", 0.0..1.0, "volume of what both channels share, 0..1";
    /// Volume of the difference between the channels.
    VolumeSide, "volume_side", 0.0..1.0, "volume of that in which they differ, 0..1; 0 for mono";
    /// The integral of the low frequencies over the last seconds.
    BassDrive, "bass_drive", 0.0..4.0,
        "bass summed over time in seconds and forgotten in 4 s, 0..4: t + bass_drive is a time that runs with the bass";
    /// The spectral centroid: where the middle of the sound lies in the spectrum.
    Brightness, "brightness", 0.0..1.0, "where the middle of the sound lies, 0 low .. 1 high: the spectral centroid";
    /// Where the strongest tone lies in the spectrum.
    Pitch, "pitch", 0.0..1.0, "where the strongest tone lies, 0..1 as in spectrum(u)";
    /// Position in the bar.
    Bar, "bar", 0.0..1.0, "way through the bar, 0 up to 1";
    /// Number of the beat in its bar.
    BeatInBar, "beat_in_bar", 0.0..4.0, "which beat of its bar it is, 1 to 4; 0 while unknown";
    /// Number of the section's letter.
    Section, "section", 0.0..26.0, "the part of the song: 1 for A, 2 for B, ..; what returns has its number again; 0 while unknown";
    /// Position in the section.
    SectionPhase, "section_phase", 0.0..1.0, "way through the section, 0..1";
    /// Loudness of a second relative to the loudest one.
    Energy, "energy", 0.0..1.0, "how loud a second of the song is: 1 like its loudest, 0 if 36 dB below that or less";
    /// Tension that rises.
    Build, "build", 0.0..1.0, "0 up to 1 over a build, and 0 elsewhere";
    /// Tension that was released.
    Drop, "drop", 0.0..1.0, "1 where a drop begins, falling to 0 over two bars";
    /// Root of the key.
    Key, "key", 0.0..11.0, "root of the song's key in semitones above C, 0..11; 0 while unknown";
    /// Whether the key is minor.
    Minor, "minor", 0.0..1.0, "1 if the song's key is minor, else 0";
    /// Position in the song.
    Progress, "progress", 0.0..1.0, "way through the song, 0..1";
    /// Share of C.
    ChromaC, "chroma(0)", 0.0..1.0, "how much C sounds, 0..1";
    /// Share of C sharp.
    ChromaCSharp, "chroma(1)", 0.0..1.0, "how much C sharp sounds, 0..1";
    /// Share of D.
    ChromaD, "chroma(2)", 0.0..1.0, "how much D sounds, 0..1";
    /// Share of E flat.
    ChromaEFlat, "chroma(3)", 0.0..1.0, "how much E flat sounds, 0..1";
    /// Share of E.
    ChromaE, "chroma(4)", 0.0..1.0, "how much E sounds, 0..1";
    /// Share of F.
    ChromaF, "chroma(5)", 0.0..1.0, "how much F sounds, 0..1";
    /// Share of F sharp.
    ChromaFSharp, "chroma(6)", 0.0..1.0, "how much F sharp sounds, 0..1";
    /// Share of G.
    ChromaG, "chroma(7)", 0.0..1.0, "how much G sounds, 0..1";
    /// Share of G sharp.
    ChromaGSharp, "chroma(8)", 0.0..1.0, "how much G sharp sounds, 0..1";
    /// Share of A.
    ChromaA, "chroma(9)", 0.0..1.0, "how much A sounds, 0..1";
    /// Share of B flat.
    ChromaBFlat, "chroma(10)", 0.0..1.0, "how much B flat sounds, 0..1";
    /// Share of B.
    ChromaB, "chroma(11)", 0.0..1.0, "how much B sounds, 0..1";
}

impl SoundInput {
    /// The name in a scene; a component of a vector has a dot in its name.
    pub const fn name(self) -> &'static str {
        ROWS[self as usize].0
    }

    /// Least and greatest value.
    pub const fn range(self) -> (f32, f32) {
        (ROWS[self as usize].1, ROWS[self as usize].2)
    }

    /// A description for readers.
    pub const fn doc(self) -> &'static str {
        ROWS[self as usize].3
    }

    /// How much each pitch class sounds, C first: what `chroma(i)` reads.
    pub const CHROMA: [Self; 12] = [
        Self::ChromaC,
        Self::ChromaCSharp,
        Self::ChromaD,
        Self::ChromaEFlat,
        Self::ChromaE,
        Self::ChromaF,
        Self::ChromaFSharp,
        Self::ChromaG,
        Self::ChromaGSharp,
        Self::ChromaA,
        Self::ChromaBFlat,
        Self::ChromaB,
    ];

    /// Whether it is a number of the whole song: known only to who has heard all of it, else 0. Scenes may have values
    /// of the same name, which hide it.
    pub const fn is_of_song(self) -> bool {
        self as usize >= Self::Bar as usize
    }

    /// The number with that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|input| input.name() == name)
    }

    /// The value clamped to the range; a value that is not finite becomes the least.
    pub fn clamp(self, value: f32) -> f32 {
        let (least, most) = self.range();
        if value.is_finite() { value.clamp(least, most) } else { least }
    }
}

/// A value for each [`SoundInput`]; silence by default.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SoundInputs([f32; ROWS.len()]);

impl Default for SoundInputs {
    fn default() -> Self {
        Self::SILENCE
    }
}

impl SoundInputs {
    /// Silence.
    pub const SILENCE: Self = Self([0.0; ROWS.len()]);

    /// For each number the result of `value`.
    pub fn each(value: impl FnMut(SoundInput) -> f32) -> Self {
        Self(SoundInput::ALL.map(value))
    }

    /// Silence except for the given values.
    pub fn with(values: &[(SoundInput, f32)]) -> Self {
        let mut sound = Self::SILENCE;
        for &(input, value) in values {
            sound[input] = value;
        }
        sound
    }

    /// The values in the order of [`SoundInput::ALL`].
    pub fn numbers(&self) -> &[f32] {
        &self.0
    }
}

impl Index<SoundInput> for SoundInputs {
    type Output = f32;

    fn index(&self, input: SoundInput) -> &f32 {
        &self.0[input as usize]
    }
}

impl IndexMut<SoundInput> for SoundInputs {
    fn index_mut(&mut self, input: SoundInput) -> &mut f32 {
        &mut self.0[input as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_at_the_numbers_of_their_inputs() {
        for (number, input) in SoundInput::ALL.into_iter().enumerate() {
            assert_eq!(input as usize, number);
            assert_eq!(SoundInput::named(input.name()), Some(input), "two rows are called {}", input.name());
            let (least, most) = input.range();
            assert!(least <= 0.0 && 0.0 < most, "{input:?}: silence reads 0");
            assert!(
                [f32::NAN, f32::INFINITY, -1.0, 0.5]
                    .iter()
                    .all(|v| (least..=most).contains(&input.clamp(*v)))
            );
        }
        for (class, input) in SoundInput::CHROMA.into_iter().enumerate() {
            assert_eq!(input.name(), format!("chroma({class})"));
        }
    }
}
