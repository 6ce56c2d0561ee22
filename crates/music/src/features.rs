//! The audio features of one moment.

use serde::{Serialize, Serializer};

use super::live::LiveSong;
use super::loudness::LOUDNESS_FLOOR;
use super::scale::{BAND_COUNT, LEVEL_FLOOR_DB, NOTE_COUNT, SPECTRUM_POINTS, WAVE_PER_HOP, spectrum_place};

macro_rules! features {
    ($($(#[$attribute:meta])+ $name:ident: $type:ty = $silence:expr, $between:ident;)+) => {
        /// The audio features of one moment. Every number is finite, whatever the samples are. Values in decibels and
        /// hertz are measurements. All other values are for drawing: [`Gain`](super::Gain) levels them, and they are
        /// smoothed with attack and release.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize)]
        pub struct Features {
            $($(#[$attribute])+ pub $name: $type,)+
        }

        impl Features {
            /// The features of silence.
            pub const SILENCE: Self = Self { $($name: $silence,)+ };

            fn between(&self, other: &Self, amount: f32) -> Self {
                Self { $($name: $between(self.$name, other.$name, amount),)+ }
            }

            /// True if the number called `name` in scenes is interpolated linearly between moments.
            pub(super) fn is_mixed(name: &str) -> bool {
                match name {
                    "volume.x" | "volume.y" | "loudness" => true,
                    $(stringify!($name) => stringify!($between) == "mixed",)+
                    _ => false,
                }
            }

            fn row(&self, name: &str) -> Option<f32> {
                match name {
                    $(stringify!($name) => self.$name.number_alone(),)+
                    _ => None,
                }
            }
        }
    };
}

// Each feature has a description, a type, a value in silence, and a rule for interpolation between two moments.
features! {
    /// Loudness of the left and the right channel: the mean of |sample| over a sixtieth of a second (Abt 2022, section
    /// 5, eq. 1), times the gain, smoothed with attack and release. Silence has 0. At a gain of 0 dB, a full-scale sine
    /// has 2/π = 0.637 and a full-scale square wave has 1. Only samples beyond full scale give more than 1 (at most 8).
    volume: [f32; 2] = [0.0; 2], mixed;
    /// Loudness of the mid channel, (left + right) / 2.
    volume_mid: f32 = 0.0, mixed;
    /// Loudness of the side channel, (left - right) / 2. It is 0 for mono and large for wide stereo.
    volume_side: f32 = 0.0, mixed;
    /// Height of each band for drawing, 0..1, low frequencies first. The band's level plus the gain is mapped linearly
    /// from -66..-6 dB and smoothed with attack and release. [`band_edge`](super::band_edge) returns the edges.
    bands: [f32; BAND_COUNT] = [0.0; BAND_COUNT], mixed;
    /// The position of each band between the channels: (|R|² - |L|²) / (|L|² + |R|²), from -1 (only left) to 1 (only
    /// right). It is 0 for mono and in silence. The powers are averaged over 0.2 s.
    pan: [f32; BAND_COUNT] = [0.0; BAND_COUNT], mixed;
    /// The width of each band's stereo image: 2·(√(|L|²·|R|²) - Re(L·R*)) / (|L|² + |R|²), clamped to 0..1. A single
    /// sound has 0 at any pan. Channels of equal level have 1 minus their correlation: 1 if they are independent or
    /// opposite. In silence it is 0.
    width: [f32; BAND_COUNT] = [0.0; BAND_COUNT], mixed;
    /// The level of each semitone from A0 to C8, 0..1, without the partials of lower notes: 1 for the loudest note of
    /// the last seconds, 0 at 34 dB below it.
    #[serde(serialize_with = "numbers")]
    notes: [f32; NOTE_COUNT] = [0.0; NOTE_COUNT], mixed;
    /// Mean height of the bands below 144 Hz, 0..1.
    bass: f32 = 0.0, mixed;
    /// Mean height of the bands from 144 Hz to 1.85 kHz, 0..1.
    mid: f32 = 0.0, mixed;
    /// Mean height of the bands from 1.85 kHz to 16 kHz, 0..1.
    treble: f32 = 0.0, mixed;
    /// The spectral centroid, from 0 at the lowest band to 1 at the highest: the mean of the band numbers, weighted by
    /// power. It is smoothed like the bands, and falls to 0 in silence.
    brightness: f32 = 0.0, mixed;
    /// 1 at the onset of a sound, then falling by a factor of e in 0.15 s.
    beat: f32 = 0.0, mixed;
    /// The strength of a kick at its onset, 0..1, then falling like `beat`. The strength is relative to the strongest
    /// kick of the last seconds. In files a stroke is detected one hop (about 10 ms) earlier than in live input.
    kick: f32 = 0.0, mixed;
    /// The same for the snare.
    snare: f32 = 0.0, mixed;
    /// The same for the hi-hat and other short high sounds.
    hat: f32 = 0.0, mixed;
    /// Beats per minute; 0 while unknown.
    tempo: f32 = 0.0, known;
    /// Phase between the last beat and the next beat, 0 up to 1; 0 while the tempo is unknown. The next beat is
    /// predicted `60 · (1 - phase) / tempo` seconds later.
    phase: f32 = 0.0, held;
    /// The number of the beat in its bar, from 1, for live input; 0 while uncertain. It is always 0 for files, because
    /// the [`SongStructure`](super::SongStructure) has the bars of files.
    bar_beat: f32 = 0.0, held;
    /// The number of beats in the bar; 0 while uncertain.
    bar_beats: f32 = 0.0, held;
    /// What is heard of the song in live input. For files nothing is known, because the
    /// [`SongStructure`](super::SongStructure) has it.
    #[serde(skip)]
    live: LiveSong = LiveSong::UNKNOWN, mixed;
    /// The leaky integral of `bass` over seconds: b' = bass - b / 4 s, so 1/e of a value is left after 4 s. A scene
    /// that moves with `time + bass_drive` runs faster with each low note, and on average as fast as time.
    bass_drive: f32 = 0.0, mixed;
    /// The gain that was applied to the values above, in decibels; 0 if automatic gain is off.
    gain_db: f32 = 0.0, mixed;
    /// The total level from 30 Hz to 16 kHz in decibels, measured like the band levels.
    level_db: f32 = LEVEL_FLOOR_DB, mixed;
    /// Height of the tones, 0..1: the height of the total level, mapped like `bands`, times the fraction of the power
    /// from 60 Hz to 6 kHz that belongs to tones. A new tone counts after about 0.1 s.
    tonal: f32 = 0.0, mixed;
    /// The same for strokes, which are short and cover many frequencies.
    percussive: f32 = 0.0, mixed;
    /// Root of the current chord in semitones above C, 0..11. It is kept while the chord is uncertain; 0 without notes.
    chord_root: f32 = 0.0, held;
    /// 1 if the current chord is minor; 0 if it is major or unknown.
    chord_minor: f32 = 0.0, held;
    /// How well a major or minor chord fits the sounding notes, 0..1; 0 while no chord is known.
    chord_certainty: f32 = 0.0, mixed;
    /// The most prominent note above the bass in semitones above A0, 0..87, with cents as fraction; 0 without notes.
    melody: f32 = 0.0, held;
    /// How much more prominent the melody is than other notes, 0..1.
    melody_certainty: f32 = 0.0, mixed;
    /// Short-term loudness in LUFS (ITU-R BS.1770-4, over the last 3 s), at least [`LOUDNESS_FLOOR`], without the gain.
    /// In the first 3 s of a stream or after a restart it is the loudness since the start.
    loudness_lufs: f32 = LOUDNESS_FLOOR, mixed;
    /// Frequency of the strongest tone in hertz, exact to 0.06 Hz (1 % of a bin of the long window); 0 below -80 dB.
    peak_hz: f32 = 0.0, held;
    /// The level of each band in decibels, both channels together, not smoothed, at least [`LEVEL_FLOOR_DB`]. A sine of
    /// amplitude a in both channels has 20·log10(a) dB, summed over its bands. A sine in only one channel has 3.01 dB
    /// less. The phase between the channels makes no difference.
    band_levels_db: [f32; BAND_COUNT] = [LEVEL_FLOOR_DB; BAND_COUNT], mixed;
}

impl Features {
    /// Returns the value called `name` in scenes: a feature, a channel of a feature (`volume.x`), `pitch` (0..1), or
    /// `loudness` (0 at -70 LUFS, 1 at 0 LUFS).
    pub fn number(&self, name: &str) -> Option<f32> {
        match name {
            "volume.x" => Some(self.volume[0]),
            "volume.y" => Some(self.volume[1]),
            "loudness" => Some(((self.loudness_lufs - LOUDNESS_FLOOR) / -LOUDNESS_FLOOR).clamp(0.0, 1.0)),
            "pitch" => Some(spectrum_place(f64::from(self.peak_hz)) as f32),
            _ => self.row(name),
        }
    }

    /// Interpolates linearly from `self` (`amount` 0) to `other` (`amount` 1), number by number. The phase wraps from 1
    /// to 0. If a tempo or frequency is unknown in `self` or `other`, the value of `self` is kept.
    pub fn lerp(&self, other: &Self, amount: f32) -> Self {
        let mut between = self.between(other, amount);
        if self.tempo > 0.0 && other.tempo > 0.0 {
            // A tracker may step back a little to correct itself. A step back of more than half a beat is a new beat.
            let ahead = if other.phase < self.phase - 0.5 { 1.0 } else { 0.0 };
            let phase = mixed(self.phase, other.phase + ahead, amount);
            between.phase = phase - phase.floor();
            if phase >= 1.0 {
                (between.bar_beat, between.bar_beats) = (other.bar_beat, other.bar_beats);
            }
        }
        between
    }
}

/// Serializes an array that is longer than serde's own arrays.
fn numbers<S: Serializer>(array: &[f32; NOTE_COUNT], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(array)
}

trait Numbers: Sized {
    fn mixed(self, other: Self, amount: f32) -> Self;

    /// The number as scenes read it; `None` for lists.
    fn number_alone(self) -> Option<f32> {
        None
    }
}

impl Numbers for f32 {
    fn mixed(self, other: Self, amount: f32) -> Self {
        self + (other - self) * amount
    }

    fn number_alone(self) -> Option<f32> {
        Some(self)
    }
}

impl<const N: usize> Numbers for [f32; N] {
    fn mixed(self, other: Self, amount: f32) -> Self {
        std::array::from_fn(|i| self[i].mixed(other[i], amount))
    }
}

impl Numbers for LiveSong {
    /// Keeps the key of `self`.
    fn mixed(self, other: Self, amount: f32) -> Self {
        Self {
            chroma: self.chroma.mixed(other.chroma, amount),
            key: self.key,
            build: self.build.mixed(other.build, amount),
            drop: self.drop.mixed(other.drop, amount),
            novelty: self.novelty.mixed(other.novelty, amount),
        }
    }
}

fn mixed<T: Numbers>(a: T, b: T, amount: f32) -> T {
    a.mixed(b, amount)
}

/// Interpolates from `a` to `b` if both values are known (above 0); otherwise returns `a`.
fn known(a: f32, b: f32, amount: f32) -> f32 {
    if a > 0.0 && b > 0.0 { mixed(a, b, amount) } else { a }
}

fn held(a: f32, _: f32, _: f32) -> f32 {
    a
}

impl Default for Features {
    fn default() -> Self {
        Self::SILENCE
    }
}

/// The features and tables of a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedFeatures {
    /// The time in the stream, in seconds.
    pub time: f64,
    /// The number of the moment: its distance from the start of the stream in hops.
    pub number: u64,
    /// The features of the moment.
    pub features: Features,
    /// Heights of the spectrum, 0..1, at frequencies in equal ratios ([`spectrum_hz`](super::spectrum_hz)), smoothed
    /// like the bands.
    pub spectrum: [f32; SPECTRUM_POINTS],
    /// One hop of the mean of both channels, -8..8. A waveform consists of four such hops ([`Tables`](super::Tables)).
    pub wave: [f32; WAVE_PER_HOP],
}

impl TimedFeatures {
    /// Creates a moment with silent tables.
    pub const fn new(time: f64, number: u64, features: Features) -> Self {
        Self { time, number, features, spectrum: [0.0; SPECTRUM_POINTS], wave: [0.0; WAVE_PER_HOP] }
    }
}
