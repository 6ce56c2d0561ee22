//! `mariana analyze`: the features of a song as text, one line for each frame.

use std::io::Write;

use serde::Serialize;

use super::error::ExportError;
use super::print::is_open;
use super::song_features::SongFeatures;
use mariana_music::{Features, SongMoment};

#[derive(Serialize)]
struct Line<'a> {
    t: f64,
    #[serde(flatten)]
    features: &'a Features,
    #[serde(flatten)]
    song: Option<&'a SongMoment>,
}

/// Prints a line for each of these times, in seconds, to `out`, up to the song's end: a JSON object or columns. With
/// `song_too`, prints the position in the whole song too.
///
/// # Errors
/// Fails if the song cannot be decoded, or `out` cannot be written. A closed pipe is no error.
pub fn print_features(
    song: &mut SongFeatures,
    times: impl Iterator<Item = f64>,
    song_too: bool,
    json: bool,
    out: &mut dyn Write,
) -> Result<(), ExportError> {
    if song_too {
        song.know_song();
    }
    for t in times {
        let Some(features) = song.at(t)? else { break };
        let place = song_too.then(|| song.place_in_song(t));
        let line = if json {
            serde_json::to_string(&Line { t, features: &features, song: place.as_ref() })
                .map_err(|error| ExportError::Print(error.into()))?
        } else {
            columns(t, &features) + &place.map_or_else(String::new, |place| song_columns(&place))
        };
        if !is_open(writeln!(out, "{line}"))? {
            return Ok(());
        }
    }
    is_open(out.flush()).map(drop)
}

fn song_columns(place: &SongMoment) -> String {
    let SongMoment { bar, beat_in_bar, section, section_phase, energy, build, drop, progress, .. } = place;
    format!(
        "  bar {bar:.3}  beat {beat_in_bar}  section {section}  {section_phase:.3}  energy {energy:.3}  \
         build {build:.3}  drop {drop:.3}  progress {progress:.3}"
    )
}

fn columns(t: f64, features: &Features) -> String {
    const HEIGHTS: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
    let bars: String =
        features.bands.iter().map(|band| HEIGHTS[((band * 8.0).round().clamp(0.0, 8.0)) as usize]).collect();
    let [left, right] = features.volume;
    format!("{t:9.3} s  left {left:.3}  right {right:.3}  {bars}")
}
