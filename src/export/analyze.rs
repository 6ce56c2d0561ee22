//! The features of a song as text, one line for each frame.

use std::io::Write;

use serde::Serialize;

use super::error::ExportError;
use super::song_features::SongFeatures;
use mariana_music::{Features, Gain};
use mariana_player::song::Song;

/// What to analyse.
#[derive(Debug, Clone)]
pub struct AnalyzeRequest {
    /// The song.
    pub song: Song,
    /// Lines per second.
    pub fps: f64,
    /// First moment, in seconds.
    pub start: f64,
    /// Length in seconds; none means to the end.
    pub duration: Option<f64>,
    /// Whether quiet and loud sound give the same values of 0..1.
    pub gain: Gain,
    /// JSON objects instead of columns.
    pub json: bool,
}

#[derive(Serialize)]
struct Line<'a> {
    t: f64,
    #[serde(flatten)]
    features: &'a Features,
}

/// Prints a line for each frame to `out`.
///
/// # Errors
/// The song cannot be decoded or ends before the start, or `out` cannot be written. A reader that closes `out` early
/// is no error.
pub fn print_features(request: &AnalyzeRequest, out: &mut dyn Write) -> Result<(), ExportError> {
    let mut song = SongFeatures::open_with(&request.song, request.start, request.gain)?;
    song.require(request.start)?;
    for index in 0u64.. {
        let offset = index as f64 / request.fps;
        if request.duration.is_some_and(|duration| offset >= duration) {
            break;
        }
        let t = request.start + offset;
        let Some(features) = song.at(t)? else { break };
        let line = if request.json {
            serde_json::to_string(&Line { t, features: &features })
                .map_err(|error| ExportError::Print(error.into()))?
        } else {
            columns(t, &features)
        };
        match writeln!(out, "{line}") {
            Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => return Ok(()),
            other => other.map_err(ExportError::Print)?,
        }
    }
    match out.flush() {
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        other => other.map_err(ExportError::Print),
    }
}

/// Time, volumes, and the bands as bars of eight heights.
fn columns(t: f64, features: &Features) -> String {
    const HEIGHTS: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
    let bars: String =
        features.bands.iter().map(|band| HEIGHTS[((band * 8.0).round().clamp(0.0, 8.0)) as usize]).collect();
    let [left, right] = features.volume;
    format!("{t:9.3} s  left {left:.3}  right {right:.3}  {bars}")
}
