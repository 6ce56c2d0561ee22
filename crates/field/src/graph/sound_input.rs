//! The numbers of the sound that scenes read by name, one row each. A row gives the number's name and description for
//! the language, tapes, GLSL, the uniform block, bounds, and `mariana eval --set`.
//!
//! The numbers from `bar` on describe the whole song. Levels that are read by number (`band(i)`) are in
//! [`LevelList`](super::LevelList), tables (`spectrum(u)`) in [`FrameInputs`](super::FrameInputs).

use std::ops::{Index, IndexMut};

macro_rules! sound_inputs {
    ($(
        $(#[doc = $doc:literal])+
        $input:ident, $name:literal, $least:literal..$most:literal $(else $unknown:literal)?, $reported:literal;
    )+) => {
        /// A number that describes the sound; the same at all points of a frame.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[repr(u8)]
        pub enum SoundInput {
            $($(#[doc = $doc])+ $input,)+
        }

        /// Name, least and greatest value, and the description on the language's page.
        const ROWS: &[(&str, f32, f32, &str)] = &[$(($name, $least, $most, $reported),)+];

        /// The value of each input in silence, or while it is unknown: 0 unless the row states another one.
        const AT_REST: [f32; ROWS.len()] = [$(0.0 $(+ $unknown)?,)+];

        impl SoundInput {
            /// All inputs, in the order in which frames hold them.
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
    Beat, "beat", 0.0..1.0, "1 where a sound begins; then falls by a factor of e every 0.15 s";
    /// Beats per minute.
    Tempo, "tempo", 0.0..1000.0, "beats per minute; 0 while unknown";
    /// Position in the beat.
    Phase, "phase", 0.0..1.0, "position between the last beat and the next, 0..1";
    /// Volume of the mid signal, the sum of both channels.
    VolumeMid, "volume_mid", 0.0..1.0, "volume of the mid signal (what both channels have in common), 0..1";
    /// Volume of the side signal, the difference between the channels.
    VolumeSide, "volume_side", 0.0..1.0,
        "volume of the side signal (the difference between the channels), 0..1; 0 for mono";
    /// The integral of the low frequencies over the last seconds.
    BassDrive, "bass_drive", 0.0..4.0,
        "bass integrated over time, decaying over 4 s, 0..4: t + bass_drive is a time that runs faster with more bass";
    /// The spectral centroid, as a position in the spectrum.
    Brightness, "brightness", 0.0..1.0, "the spectral centroid, 0 low .. 1 high";
    /// Position of the strongest tone in the spectrum.
    Pitch, "pitch", 0.0..1.0, "position of the strongest tone, 0..1 as u in spectrum(u)";
    /// 1 on a kick, then decaying.
    Kick, "kick", 0.0..1.0, "rises to the strength of each kick, 0..1; then falls like beat";
    /// 1 on a snare, then decaying.
    Snare, "snare", 0.0..1.0, "the same for the snare";
    /// 1 on a hi-hat, then decaying.
    Hat, "hat", 0.0..1.0, "the same for hi-hats and other short high sounds";
    /// Level of sustained tones.
    Tonal, "tonal", 0.0..1.0, "level of sustained tones, 0..1";
    /// Level of strokes.
    Percussive, "percussive", 0.0..1.0, "level of strokes and other short sounds, 0..1";
    /// Root of the chord.
    ChordRoot, "chord_root", 0.0..11.0, "root of the chord in semitones above C, 0..11";
    /// 1 if the chord is minor.
    ChordMinor, "chord_minor", 0.0..1.0, "1 if the chord is minor, else 0";
    /// Certainty of the chord.
    ChordCertainty, "chord_certainty", 0.0..1.0, "certainty of the chord, 0..1";
    /// The most prominent tone.
    Melody, "melody", 0.0..88.0, "the most prominent tone in semitones above A0, 0..88";
    /// Certainty of the melody.
    MelodyCertainty, "melody_certainty", 0.0..1.0, "certainty of the melody, 0..1";
    /// Short-term loudness.
    Loudness, "loudness", 0.0..1.0, "loudness of the last 3 s: 0 at -70 LUFS, 1 at 0 LUFS";
    /// Position in the bar.
    Bar, "bar", 0.0..1.0, "position in the bar, 0..1";
    /// Number of the beat in its bar.
    BeatInBar, "beat_in_bar", 0.0..4.0, "number of the beat in its bar, 1 to 4; 0 while unknown";
    /// Number of the section's letter: 1 for A.
    Section, "section", 0.0..26.0,
        "section of the song: 1 for A, 2 for B, ..; a repeated section has the same number; 0 while unknown";
    /// Position in the section.
    SectionPhase, "section_phase", 0.0..1.0, "position in the section, 0..1";
    /// Loudness of the current second, relative to the loudest second of the song.
    Energy, "energy", 0.0..1.0,
        "loudness of the current second: 1 for the loudest second of the song, 0 at 36 dB below it and less";
    /// Progress of a build-up.
    Build, "build", 0.0..1.0, "rises from 0 to 1 during a build-up; 0 elsewhere";
    /// 1 at a drop, then falling to 0.
    Drop, "drop", 0.0..1.0, "1 where a drop begins; then falls to 0 over two bars";
    /// Root of the key.
    Key, "key", 0.0..11.0, "root of the song's key in semitones above C, 0..11; 0 while unknown";
    /// 1 if the key is minor.
    Minor, "minor", 0.0..1.0, "1 if the song's key is minor, else 0";
    /// Position in the song.
    Progress, "progress", 0.0..1.0, "position in the song, 0..1";
    /// Time until the next beat.
    ToBeat, "to_beat", 0.0..1000.0 else 1000.0, "seconds until the next beat; 1000 while unknown";
    /// Time until the next bar.
    ToBar, "to_bar", 0.0..1000.0 else 1000.0, "seconds until the next bar; 1000 while unknown";
    /// Time until the next section.
    ToSection, "to_section", 0.0..1000.0 else 1000.0,
        "seconds until the next section; 1000 while unknown and in the last section";
    /// Time until the next drop.
    ToDrop, "to_drop", 0.0..1000.0 else 1000.0,
        "seconds until the next drop; 1000 while unknown and after the last drop";
    /// Number of the line of lyrics.
    Line, "line", 0.0..10000.0, "number of the line of lyrics that is sung, from 1; 0 between lines";
    /// Number of the word in the line of lyrics.
    Word, "word", 0.0..1000.0, "number of the word in its line, from 1; 0 between lines";
    /// Position in the line of lyrics.
    LinePhase, "line_phase", 0.0..1.0, "position in the line of lyrics, 0..1";
}

impl SoundInput {
    /// Returns the name in a scene. The name of a vector's component has a dot.
    pub const fn name(self) -> &'static str {
        ROWS[self as usize].0
    }

    /// Least and greatest value.
    pub const fn range(self) -> (f32, f32) {
        (ROWS[self as usize].1, ROWS[self as usize].2)
    }

    /// Returns the input's description, as printed in docs/language.md.
    pub const fn doc(self) -> &'static str {
        ROWS[self as usize].3
    }

    /// True for a number that describes the whole song. Until the song is analysed, such a number has its value in
    /// silence.
    pub const fn is_of_song(self) -> bool {
        self as usize >= Self::Bar as usize
    }

    /// True if a scene may declare a value of the same name, which hides this number. The first numbers cannot be
    /// hidden; scenes that are older than the others may use their names.
    pub const fn may_be_hidden(self) -> bool {
        self as usize >= Self::Kick as usize
    }

    /// Returns the input with that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|input| input.name() == name)
    }

    /// Clamps a value to the range. A value that is not finite becomes the value in silence.
    pub fn clamp(self, value: f32) -> f32 {
        let (least, most) = self.range();
        if value.is_finite() { value.clamp(least, most) } else { AT_REST[self as usize] }
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
    pub const SILENCE: Self = Self(AT_REST);

    /// Returns a number for each input, computed by `value`.
    pub fn each(value: impl FnMut(SoundInput) -> f32) -> Self {
        Self(SoundInput::ALL.map(value))
    }

    /// Returns silence, except that the inputs in `values` have the given numbers.
    pub fn with(values: &[(SoundInput, f32)]) -> Self {
        let mut sound = Self::SILENCE;
        for &(input, value) in values {
            sound[input] = value;
        }
        sound
    }

    /// Returns the values in the order of [`SoundInput::ALL`].
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
    fn rows_are_in_the_order_of_their_numbers() {
        for (number, input) in SoundInput::ALL.into_iter().enumerate() {
            assert_eq!(input as usize, number);
            assert_eq!(SoundInput::named(input.name()), Some(input), "two rows are called {}", input.name());
            let (least, most) = input.range();
            assert!(least < most && (least..=most).contains(&SoundInputs::SILENCE[input]), "{input:?}");
            assert!(
                [f32::NAN, f32::INFINITY, -1.0, 0.5]
                    .iter()
                    .all(|v| (least..=most).contains(&input.clamp(*v)))
            );
        }
    }
}
