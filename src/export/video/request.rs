//! The options of a video.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::encoding::{Codec, EncodingQuality};
use crate::export::output::Output;
use crate::export::painter::SceneChoice;
use crate::export::showing::Showing;
use crate::export::shutter::Shutter;
use crate::frame::held_inputs::Setting;
use mariana_music::Gain;
use mariana_player::lyrics::Lyrics;
use mariana_player::song::Song;

/// Options of a video.
#[derive(Debug, Clone)]
pub struct VideoRequest {
    /// The song.
    pub song: Song,
    /// First moment, in seconds.
    pub start: f64,
    /// Length in seconds; `None` for the rest of the song.
    pub duration: Option<f64>,
    /// Frames per second.
    pub fps: f64,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Automatic gain.
    pub gain: Gain,
    /// True to dim flashes if there are more than three a second.
    pub limit_flashes: bool,
    /// The video file, or a folder (or path with a final slash) for stills. Standard output gets y4m without sound.
    pub output: Output,
    /// True to choose another name if a file of this name exists; false to replace the file.
    pub keeps_others: bool,
    /// The scenes or the show.
    pub showing: Showing,
    /// Options of drawing; the field `source` is ignored.
    pub scene: SceneChoice,
    /// Inputs that are held at a value.
    pub set: Vec<Setting>,
    /// Video codec; `None` selects it by the file's extension.
    pub codec: Option<Codec>,
    /// Quality of the encoding.
    pub quality: EncodingQuality,
    /// True if the video has sound.
    pub sound: bool,
    /// Sample rate of the sound, in hertz; `None` uses the song's rate or the format's default.
    pub sound_rate: Option<u32>,
    /// True to show title and artist during the first seconds.
    pub title_card: bool,
    /// Lyrics to show while they are sung.
    pub lyrics: Option<Lyrics>,
    /// Duration of the fade from a loop's end into its beginning, in seconds. Requires `duration`.
    pub seam: Option<f64>,
    /// The shutter of each frame.
    pub shutter: Shutter,
    /// The part to render; `None` for the whole video.
    pub part: Option<VideoPart>,
}

/// A finished video.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// The number of frames.
    pub frames: u64,
    /// The video's file; `None` for stills and standard output.
    pub file: Option<PathBuf>,
}

/// A part of a video: its number, from 1, and the number of parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct VideoPart {
    /// The number of the part, from 1.
    pub number: u64,
    /// The number of parts.
    pub of: u64,
}

impl VideoPart {
    /// The first frame of the part, and the first frame after it, of a video of `total` frames.
    pub(super) fn range(self, total: u64) -> (u64, u64) {
        let at = |number: u64| (u128::from(total) * u128::from(number) / u128::from(self.of)) as u64;
        (at(self.number - 1), at(self.number))
    }
}

/// The number of frames in a time.
pub(super) fn frames_in(seconds: f64, fps: f64) -> u64 {
    let frames = (seconds * fps).ceil() as u64;
    // 1.1 · 10 is slightly more than 11 in floating point.
    let last_begins = frames.saturating_sub(1) as f64 / fps;
    if last_begins < seconds { frames } else { frames.saturating_sub(1) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_cover_each_frame_once() {
        for (total, of) in [(10, 3), (7, 7), (3, 8), (100_000, 64)] {
            let ranges: Vec<_> = (1..=of).map(|number| VideoPart { number, of }.range(total)).collect();
            assert_eq!((ranges[0].0, ranges[ranges.len() - 1].1), (0, total));
            assert!(ranges.windows(2).all(|pair| pair[0].1 == pair[1].0));
        }
    }
}
