//! Decoding of audio files to stereo frames. [`Decoder`] finds the container by its content and picks the first audio
//! track that can be decoded, or a given track. It yields the track's frames, mixed down to stereo ([`downmix`]), at
//! the rate of the file. [`native`] decodes common formats. Files that `native` refuses go to [`ffmpeg`], if it is
//! installed.

use std::path::Path;

use mariana_music::StereoFrame;

use crate::ffmpeg::Demuxer;
use crate::song::Song;
use crate::source::{FrameSource, SourceError};
use ffmpeg::{FfmpegDecoder, Programs};
use input::MediaInput;
use native::NativeDecoder;

mod clock;
mod codecs;
mod containment;
mod downmix;
mod error;
mod ffmpeg;
mod gapless;
mod input;
pub(crate) mod loudness;
mod mended;
mod native;
mod old_tags;
mod packets;
mod sniff;
mod tags;

use containment::contained;
pub use containment::quiet_contained_panics;
pub(crate) use downmix::Downmix;
pub use error::{DecodeError, Problem};
use tags::cover_of;
pub use tags::{Cover, CoverKind, TrackTags, tags_of};

/// Metadata of a stream.
#[derive(Debug, Clone, PartialEq)]
pub struct StreamInfo {
    /// The file's name without its folders.
    pub name: String,
    /// ffmpeg's demuxer for the container.
    pub demuxer: Demuxer,
    /// Frames per second.
    pub sample_rate: u32,
    /// Channels before the down-mix.
    pub source_channels: usize,
    /// Length in seconds, as the container claims it. For MP3 files without a header the length is an estimate.
    pub duration: Option<f64>,
    /// Title, if the file has one.
    pub title: Option<String>,
    /// Artist, if the file has one.
    pub artist: Option<String>,
    /// Lyrics, if the file has some that are not too long.
    pub lyrics: Option<String>,
    /// The factor for samples before analysis, from the ReplayGain tag; 1 without a tag.
    pub scene_gain: f32,
}

/// Reads the cover image inside a song, without decoding sound. Returns `None` for a song without one.
///
/// # Errors
/// Fails if the song cannot be read, or if only ffmpeg can read it.
pub fn embedded_cover(song: &Song) -> Result<Option<Cover>, DecodeError> {
    cover_of(&match song {
        Song::File(path) => MediaInput::file(path)?,
        Song::Embedded { name, bytes } => MediaInput::bytes(name, bytes),
    })
}

/// A decoder of one file.
pub struct Decoder(By);

enum By {
    Native(Box<NativeDecoder>),
    Ffmpeg(Box<FfmpegDecoder>),
}

impl Decoder {
    /// Opens a file and decodes its first packet.
    pub fn open(path: &Path) -> Result<Self, DecodeError> {
        let input = MediaInput::file(path)?;
        let name = input.name.clone();
        let refusal = match NativeDecoder::open(input, None) {
            Ok(decoder) => return Ok(Self(By::Native(Box::new(decoder)))),
            Err(refusal) => refusal,
        };
        if !refusal.is_for_ffmpeg() {
            return Err(refusal.of(&name));
        }
        match FfmpegDecoder::open(path, &name, &refusal, &Programs::default()) {
            Ok(decoder) => Ok(Self(By::Ffmpeg(Box::new(decoder)))),
            // If the format is known, the error of ffmpeg explains more.
            Err(error) if refusal.is_unsupported() => Err(error.of(&name)),
            Err(_) => Err(refusal.of(&name)),
        }
    }

    /// Opens one of a file's audio tracks, numbered from 0, and decodes its first packet.
    ///
    /// # Errors
    /// Fails if the file has no such track, or its format needs ffmpeg.
    pub fn open_track(path: &Path, track: usize) -> Result<Self, DecodeError> {
        Self::native(MediaInput::file(path)?, Some(track))
    }

    /// Opens an embedded file.
    pub fn from_bytes(name: &str, bytes: &'static [u8]) -> Result<Self, DecodeError> {
        Self::native(MediaInput::bytes(name, bytes), None)
    }

    fn native(input: MediaInput, track: Option<usize>) -> Result<Self, DecodeError> {
        let name = input.name.clone();
        let decoder = NativeDecoder::open(input, track).map_err(|problem| problem.of(&name))?;
        Ok(Self(By::Native(Box::new(decoder))))
    }

    /// The file's cover image. Returns `None` if the file has no cover or is decoded by ffmpeg.
    ///
    /// # Errors
    /// Fails if the demuxer fails.
    pub fn cover(&self) -> Result<Option<Cover>, DecodeError> {
        match &self.0 {
            By::Native(decoder) => cover_of(&decoder.input),
            By::Ffmpeg(_) => Ok(None),
        }
    }

    /// The stream's metadata.
    pub fn info(&self) -> &StreamInfo {
        match &self.0 {
            By::Native(decoder) => &decoder.info,
            By::Ffmpeg(decoder) => &decoder.info,
        }
    }

    /// Appends the next frames (at most one packet) to `out` and returns their number, which is 0 at the end. An error
    /// also ends the stream. A seek restarts the stream.
    pub fn next_block(&mut self, out: &mut Vec<StereoFrame>) -> Result<usize, DecodeError> {
        let decoded = match &mut self.0 {
            By::Native(decoder) => decoder.next_block(out),
            By::Ffmpeg(decoder) => decoder.next_block(out),
        };
        decoded.map_err(|problem| problem.of(&self.info().name))
    }

    /// Moves to the frame nearest to `seconds` (clamped to the stream) and returns the time reached, in seconds.
    pub fn seek(&mut self, seconds: f64) -> Result<f64, DecodeError> {
        let reached = match &mut self.0 {
            By::Native(decoder) => decoder.seek(seconds),
            By::Ffmpeg(decoder) => decoder.seek(seconds),
        };
        reached.map_err(|problem| problem.of(&self.info().name))
    }
}

impl FrameSource for Decoder {
    fn sample_rate(&self) -> u32 {
        self.info().sample_rate
    }

    fn duration(&self) -> Option<f64> {
        self.info().duration
    }

    fn next_block(&mut self, out: &mut Vec<StereoFrame>) -> Result<usize, SourceError> {
        Ok(Self::next_block(self, out)?)
    }

    fn seek(&mut self, seconds: f64) -> Result<f64, SourceError> {
        Ok(Self::seek(self, seconds)?)
    }
}
