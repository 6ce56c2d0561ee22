//! `mariana video`: a part of a song as a video (encoded by ffmpeg), as numbered stills or as a stream of raw frames.

mod encoder;
mod encoder_process;
mod encoding;
mod lyric_captions;
mod place;
mod report;
mod seam;
mod sink;
mod title_card;

use std::path::PathBuf;

use super::error::ExportError;
use super::output::Output;
use super::painter::SceneChoice;
use super::show_painter::ShowPainter;
use super::showing::{Holding, Showing};
use super::song_features::SongFeatures;
use super::still::refuse_the_song;
use crate::frame::held_inputs::Setting;
use mariana_music::Gain;
use mariana_player::lyrics::Lyrics;
use mariana_player::song::Song;

pub use encoding::{Codec, EncodingQuality};
use lyric_captions::LyricCaptions;
pub use place::{Preset, VideoPlace};
pub use report::{CONTINUE, PAUSE, VideoReport};
use seam::Seam;
use sink::{FrameWriter, Sink};
use title_card::TitleCard;

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
    /// True to leave the sky transparent.
    pub alpha: bool,
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
}

/// A finished video.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// The number of frames.
    pub frames: u64,
    /// The video's file; `None` for stills and standard output.
    pub file: Option<PathBuf>,
}

/// Writes the video or stills. `progress` gets the number so far and the known total.
///
/// # Errors
/// Fails if the song cannot be decoded, the driver or ffmpeg fails, or the output cannot be written. An incomplete
/// video never replaces an existing file.
pub fn write_video(
    request: &VideoRequest,
    progress: &mut dyn FnMut(u64, Option<u64>),
) -> Result<Written, ExportError> {
    if request.alpha {
        encoding::require_alpha(&request.output)?;
    }
    if let Output::Path(path) = &request.output {
        refuse_the_song(&request.song, path)?;
        encoding::require_fit(request.codec, request.fps, path)?;
    }
    let mut song = SongFeatures::open_with(&request.song, request.start, request.gain)?;
    song.require(request.start)?;
    let asked = request.duration.map(|seconds| frames_in(seconds, request.fps));
    let left = song.duration().map(|seconds| frames_in(seconds - request.start, request.fps));
    let mut seam = match (request.seam, asked) {
        (Some(seconds), Some(frames)) => Some(Seam::new(frames, frames_in(seconds, request.fps))?),
        _ => None,
    };
    let asked = seam.as_ref().map(Seam::needed).or(asked);
    let expected = asked.into_iter().chain(left).min();
    let too_long = |left: u64| {
        let seconds = |frames: u64| frames as f64 / request.fps;
        let (length, needed) = (request.duration.unwrap_or(0.0), asked.map_or(0.0, seconds));
        ExportError::LoopTooLong { length, needed, left: seconds(left) }
    };
    if seam.is_some() && expected < asked {
        return Err(too_long(expected.unwrap_or(0)));
    }
    let card = request.title_card.then(|| TitleCard::of(&request.song, request.size)).transpose()?;
    if let Some(lyrics) = &request.lyrics {
        song.sing(lyrics.clone());
    }
    let mut captions = request.lyrics.clone().map(|lyrics| LyricCaptions::new(lyrics, request.size));
    let prepared_show = request.showing.prepared_show(&mut song, request.start)?;
    let mut painter = ShowPainter::open(&request.scene, prepared_show, &request.set)?;
    if request.limit_flashes {
        painter.headless_renderer().add_flash_limiter(&request.scene.shaders)?;
    }
    painter.graphs().for_each(|graph| song.know_for(graph));
    painter.headless_renderer().hear(&song)?;
    painter.headless_renderer().expect_video();
    let writer = FrameWriter::start(Sink::open(request)?)?;
    let mut holding = Holding::new(request.gain, request.start);
    let (mut drawn, mut written) = (0, 0);
    while asked.is_none_or(|asked| drawn < asked) {
        let time = request.start + drawn as f64 / request.fps;
        let Some(sound) = song.sound_at(time)? else { break };
        let held = holding.at(&painter, &mut song, time)?;
        painter.draw((time, sound), held, request.size)?;
        painter.headless_renderer().limit_flashes(1.0 / request.fps)?;
        drawn += 1;
        let picture = painter.headless_renderer().read();
        let next = match &mut seam {
            Some(seam) => seam.pass(picture)?,
            None => Some(picture),
        };
        if let Some(mut picture) = next {
            let seconds = written as f64 / request.fps;
            // The title covers the place of the lyrics.
            let is_titled = card.as_ref().is_some_and(|card| card.draw_over(&mut picture, seconds));
            if let Some(captions) = captions.as_mut().filter(|_| !is_titled) {
                captions.draw_over(&mut picture, request.start + seconds);
            }
            if !writer.take(picture) {
                break;
            }
            written += 1;
        }
        progress(drawn, expected);
    }
    if let (Some(_), Some(asked)) = (&seam, asked)
        && song.is_over(request.start + drawn as f64 / request.fps)
        && drawn < asked
    {
        return Err(too_long(drawn));
    }
    Ok(Written { frames: written, file: writer.finish()? })
}

fn frames_in(seconds: f64, fps: f64) -> u64 {
    let frames = (seconds * fps).ceil() as u64;
    // 1.1 · 10 is slightly more than 11 in floating point.
    let last_begins = frames.saturating_sub(1) as f64 / fps;
    if last_begins < seconds { frames } else { frames.saturating_sub(1) }
}
