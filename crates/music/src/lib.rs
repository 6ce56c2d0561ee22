//! Audio analysis: stereo samples in, [`Features`] out. The analysis is pure: it has no I/O, clock, thread or device.
//!
//! ```text
//!                          ┌─ volumes ─────────────────────────────────┐
//! frames ─► Analyzer ──────┤                                  gain ────┼─ smoothing ─┐
//!           (fixed hops)   └─ three windows ─ spectra ─┬─ bands, lines ┘             ├─► TimedFeatures
//!                                                      └─ flux ─ onsets ─ beat ──────┘        │
//!                                       Sound: features and tables of a moment ◄─ FeatureTrack ◄┘
//! ```
//!
//! All features are computed on hops of samples, counted from the start of the stream. They do not depend on video
//! frames or on the sizes of arriving blocks. The features of a moment are therefore the same live and offline.
//!
//! ```
//! use mariana_music::{Alignment, Analyzer, StereoFrame};
//!
//! // One second of a low tone.
//! let tone = |n: usize| (std::f32::consts::TAU * 60.0 * n as f32 / 48_000.0).sin();
//! let frames: Vec<StereoFrame> = (0..48_000).map(|n| [0.5 * tone(n); 2]).collect();
//!
//! let mut moments = Vec::new();
//! let mut analyzer = Analyzer::new(48_000, Alignment::Centred);
//! analyzer.push(&frames, &mut |moment| moments.push(moment.clone()));
//! analyzer.finish(&mut |moment| moments.push(moment.clone()));
//!
//! let middle = moments[moments.len() / 2].features;
//! assert!(middle.bass > middle.treble);
//! assert!((middle.peak_hz - 60.0).abs() < 1.0);
//! ```

#[cfg(test)]
extern crate self as mariana_music;

mod activation;
mod analyzer;
mod bands;
mod beat;
mod decimate;
mod drums;
mod features;
mod gain;
mod hop_buffer;
pub mod limits;
mod lines;
mod live;
mod loudness;
mod notes;
mod onset;
mod parts;
mod pitch;
mod recent;
mod repetition;
mod resolution;
mod rhythm;
mod rises;
mod scale;
mod smoothing;
mod song;
mod sounds;
mod spectrum;
mod split;
mod stereo;
mod tables;
mod tap;
mod track;
mod trend;
mod volume;
mod whitening;

pub use analyzer::{Alignment, Analyzer};
pub use bands::band_edge;
pub use features::{Features, TimedFeatures};
pub use gain::Gain;
pub use live::{LiveEnergy, LiveSong};
pub use loudness::LOUDNESS_FLOOR;
pub use parts::{KeptNumber, PART_NAMES, PART_TRACK_VERSION, PartListener, PartTrack, PartTracks};
pub use recent::{RECENT_SECONDS, Recent};
pub use scale::{
    BAND_COUNT, BAND_HIGHEST_HZ, BAND_LOWEST_HZ, LEVEL_FLOOR_DB, NOTE_COUNT, SPECTRUM_POINTS, WAVE_PER_HOP,
    spectrum_hz, spectrum_place,
};
pub use song::{
    Chord, Meter, Mode, PITCH_CLASSES, PitchFractions, STRUCTURE_VERSION, Section, SectionSound, SongBeat,
    SongListener, SongMoment, SongStructure, Stretch, Tonality,
};
pub use tables::{HISTORY_POINTS, HISTORY_SECONDS, Sound, Tables, WAVEFORM_POINTS};
pub use tap::TapTempo;
pub use track::FeatureTrack;

/// One sample frame: one sample of the left channel, then one of the right channel, nominally -1..1.
pub type StereoFrame = [f32; 2];
