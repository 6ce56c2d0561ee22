//! The structure of a whole song: beats, bars, sections, energy, builds, drops, key and chords.
//!
//! ```text
//! frames ─► SongListener ─┬─ flux, odds of a beat ─────┬─► beats ─► bars ─┬─► units ─┬─► sections
//!                         └─ timbre, chroma ───────────┘                  │          ├─► builds, drops
//!                                                                         └──────────┴─► key, chords
//! ```
//!
//! The analysis runs at the end of the song, on compact measurements.

/// The version of the analysis. It increases when a change to the analysis gives the same samples another structure, so
/// that outdated cached structures are not used.
pub const STRUCTURE_VERSION: u32 = 10;

mod bars;
mod chroma;
mod drops;
mod energy;
mod harmony;
mod heard;
mod key;
mod listener;
mod moment;
mod pulse;
mod sections;
mod strengths;
mod structure;
mod units;

pub use bars::Meter;
pub(crate) use bars::reward;
pub use key::{Mode, PITCH_CLASSES, Tonality};
pub(crate) use key::{are_varied, largest};
pub use listener::SongListener;
pub use moment::SongMoment;
pub use sections::SectionSound;
pub use structure::{Chord, PitchFractions, Section, SongBeat, SongStructure, Stretch};
