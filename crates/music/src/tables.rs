//! The curves of a moment of sound, and their history.

use std::sync::Arc;

use super::features::Features;
use super::recent::Recent;
use super::scale::{SPECTRUM_POINTS, WAVE_PER_HOP};
use super::song::SongMoment;

/// The number of samples of a moment's waveform: four hops, 43 ms at 48 kHz.
pub const WAVEFORM_POINTS: usize = 4 * WAVE_PER_HOP;

/// The number of points of a history row, each the mean of four spectrum points.
pub const HISTORY_POINTS: usize = SPECTRUM_POINTS / POINTS_PER_COLUMN;

pub(super) const POINTS_PER_COLUMN: usize = 4;

/// The history has one row every this many moments: every 43 ms at 48 kHz.
pub(super) const MOMENTS_PER_ROW: u64 = 4;

/// The time span of the history, in seconds.
pub const HISTORY_SECONDS: f64 = 10.0;

/// The tables of one moment. The default tables are empty; their values are 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tables {
    /// [`SPECTRUM_POINTS`] heights, 0..1, from 30 Hz to 16 kHz in equal ratios ([`spectrum_hz`](super::spectrum_hz)).
    pub spectrum: Option<Arc<[f32]>>,
    /// [`WAVEFORM_POINTS`] samples of the mean of both channels times the gain, -1..1, oldest first. The moment is in
    /// the middle for files and at the end for live input.
    pub waveform: Option<Arc<[f32]>>,
    /// Rows of [`HISTORY_POINTS`] heights, the newest first. The rows are at fixed moments of the stream, so that a
    /// scrolling history does not flicker.
    pub history: Option<Arc<[f32]>>,
    /// The distance from the first row to the moment, in rows, 1..2: cubic interpolation also needs newer rows.
    pub history_offset: f32,
    /// The number of rows in [`HISTORY_SECONDS`]. Age `a`, 0..1, is at row `history_offset + a · history_span`.
    pub history_span: f32,
}

/// The sound of a moment, as read by a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sound {
    /// The single numbers.
    pub features: Features,
    /// The curves.
    pub tables: Tables,
    /// The position in the song.
    pub song: SongMoment,
    /// The numbers of the song's parts, in the order in which scenes number them; empty without stems.
    pub parts: Vec<f32>,
    /// The last seconds, the oldest moment first; empty unless a scene needs them.
    pub recent: Arc<[Recent]>,
}

impl From<Features> for Sound {
    /// Creates a sound without curves and without a song position.
    fn from(features: Features) -> Self {
        Self { features, ..Self::default() }
    }
}
