//! What the sound gives to a picture besides single numbers: curves and their history.

use std::sync::Arc;

use super::features::Features;
use super::scale::{SPECTRUM_POINTS, WAVE_PER_HOP};
use super::song::SongMoment;

/// Samples of a moment's waveform: four hops, 43 ms at 48 kHz.
pub const WAVEFORM_POINTS: usize = 4 * WAVE_PER_HOP;

/// Points of a row of the history, each the mean of four of the spectrum.
pub const HISTORY_POINTS: usize = SPECTRUM_POINTS / POINTS_PER_COLUMN;

/// Points of the spectrum that are averaged into one point of the history.
pub(super) const POINTS_PER_COLUMN: usize = 4;

/// Moments from one row of the history to the next: 43 ms at 48 kHz.
pub(super) const MOMENTS_PER_ROW: u64 = 4;

/// What the history spans, in seconds.
pub const HISTORY_SECONDS: f64 = 10.0;

/// The tables of one moment. A default one is empty: 0 everywhere.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tables {
    /// [`SPECTRUM_POINTS`] heights, 0..1, from 30 Hz to 16 kHz in equal ratios ([`spectrum_hz`](super::spectrum_hz)).
    pub spectrum: Option<Arc<[f32]>>,
    /// [`WAVEFORM_POINTS`] samples of the mean of both channels times the gain, -1..1, old to new. For a file the
    /// moment is in their middle, for live input at their end.
    pub waveform: Option<Arc<[f32]>>,
    /// Rows of [`HISTORY_POINTS`] heights, the newest first. The rows stand at fixed moments of the stream, so that
    /// pictures scroll without flicker.
    pub history: Option<Arc<[f32]>>,
    /// How far the moment lies behind the first row, in rows, 1..2: a cubic needs two rows ahead.
    pub history_offset: f32,
    /// Rows in [`HISTORY_SECONDS`]: age a, 0..1, is at row `history_offset` + a · `history_span`.
    pub history_span: f32,
}

/// Everything that a picture hears of a moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sound {
    /// Single numbers.
    pub features: Features,
    /// Curves.
    pub tables: Tables,
    /// What is known of the whole song.
    pub song: SongMoment,
}

impl From<Features> for Sound {
    /// Without curves, of a song that is not known.
    fn from(features: Features) -> Self {
        Self { features, ..Self::default() }
    }
}
