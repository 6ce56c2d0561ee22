//! What live input tells about the song that plays.

use crate::song::{PITCH_CLASSES, Tonality};

/// The harmony and the form of live input, heard without knowledge of the music to come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiveSong {
    /// Level of each pitch class, C first, relative to the strongest, 0..1. Noise has low levels.
    pub chroma: [f32; PITCH_CLASSES.len()],
    /// The key of about the last 30 s; `None` while unknown.
    pub key: Option<Tonality>,
    /// Progress of a build, 0..1: how far the high frequencies have risen while the low ones are withdrawn.
    pub build: f32,
    /// 1 at a drop, falling to 0 over two bars.
    pub drop: f32,
    /// How much the last 4 s differ from the 12 s before, in standard deviations, 0 and more. Above about 0.8 a new
    /// section is likely.
    pub novelty: f32,
}

impl LiveSong {
    /// Nothing is known.
    pub const UNKNOWN: Self =
        Self { chroma: [0.0; PITCH_CLASSES.len()], key: None, build: 0.0, drop: 0.0, novelty: 0.0 };
}

impl Default for LiveSong {
    fn default() -> Self {
        Self::UNKNOWN
    }
}
