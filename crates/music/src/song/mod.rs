//! The structure of a whole song: beats, bars, sections, energy, builds, drops, key and chords.
//!
//! ```text
//! frames ─► SongListener ─┬─ flux, powers of each hop ─┬─► beats ─► bars ─┬─► units ─┬─► sections
//!                         └─ timbre, chroma ───────────┘                  │          ├─► builds, drops
//!                                                                         └──────────┴─► key, chords
//! ```
//!
//! The analysis of the whole song runs at its end, on compact measurements.

/// The version of the analysis. It increases when the same samples give another structure, so that cached structures
/// are not reused.
pub const STRUCTURE_VERSION: u32 = 3;

mod bars;
mod beats;
mod chroma;
mod drops;
mod energy;
mod heard;
mod key;
mod listener;
mod moment;
mod sections;
mod structure;
mod units;

pub use bars::Meter;
pub use key::{Mode, PITCH_CLASSES, Tonality};
pub use listener::SongListener;
pub use moment::SongMoment;
pub use structure::{Chord, PitchFractions, Section, SongBeat, SongStructure, Stretch};
