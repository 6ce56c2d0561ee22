//! Decoding with an installed `ffmpeg`, for files that [`native`](super::native) refuses. `ffprobe`
//! describes the file; `ffmpeg` writes 32-bit floats with the file's own rate and channels to a pipe. A seek restarts
//! `ffmpeg` with `-ss`. The seek is exact to the frame in lossless formats, and to some milliseconds in others.
//!
//! The programs are started without a shell. They get the file as `file:` with its absolute path, so that no name is
//! taken for an option or an address. [`CommandLine`] prevents them from opening other files and addresses.

use std::path::{Path, PathBuf};
use std::time::Duration;

use mariana_music::StereoFrame;
use symphonia::core::audio::{Channels, Position};

use super::downmix::Downmix;
use super::{Problem, StreamInfo, sniff};
use crate::ffmpeg::probe::{Answer, Stream};
use crate::ffmpeg::process::{Failure, Process};
use crate::ffmpeg::{CommandLine, Demuxer, ReadBy, Source};
use crate::limits;

/// For a forward seek of at most this many seconds, `ffmpeg` is not restarted, but decodes up to the target.
const NEAR_SECONDS: u64 = 1;

/// The entries of a file that ffprobe reports.
const ENTRIES: &str = "format=format_name,duration:format_tags:\
    stream=index,codec_type,codec_name,sample_rate,channels,channel_layout,duration:stream_tags";

#[derive(Debug, Clone)]
pub(super) struct Programs {
    ffprobe: PathBuf,
    ffmpeg: PathBuf,
    patience: Duration,
}

impl Default for Programs {
    fn default() -> Self {
        let patience = Duration::from_secs_f64(limits::FFMPEG_WAIT_SECONDS);
        Self { ffprobe: "ffprobe".into(), ffmpeg: "ffmpeg".into(), patience }
    }
}

pub(super) struct FfmpegDecoder {
    programs: Programs,
    path: PathBuf,
    stream: u32,
    pub(super) info: StreamInfo,
    downmix: Downmix,
    process: Process,
    rest: Vec<u8>,
    pending: Vec<StereoFrame>,
    position: u64,
    /// The number of frames to drop before the next audible frame.
    skip: u64,
    ended: bool,
}

impl FfmpegDecoder {
    pub(super) fn open(
        path: &Path,
        name: &str,
        refusal: &Problem,
        programs: &Programs,
    ) -> Result<Self, Problem> {
        let failed = |failure| match failure {
            Failure::Missing => Problem::NeedsFfmpeg(describe(refusal)),
            failure => failure.into(),
        };
        let path = std::path::absolute(path)?;
        let ffprobe = CommandLine::of(&programs.ffprobe);
        let line = ffprobe.input(Source::File(&path), ReadBy::AnySongDemuxer, [""; 0]);
        let answer = Answer::of(line, ENTRIES, programs.patience, &path).map_err(failed)?;
        let stream = answer.sound().ok_or(Problem::NoAudioTrack)?;
        if !stream.is_known() {
            return Err(Problem::UnsupportedCodec("an unknown codec".into()));
        }
        if stream.channels == 0 || stream.rate() == 0 {
            return Err(Problem::Damaged("ffmpeg finds no audio in it".into()));
        }
        sniff::check(stream.channels, stream.rate())?;
        let demuxer = Demuxer::of_song(&answer.format.format_name)
            .ok_or_else(|| Problem::Damaged("ffmpeg finds no audio format in it".into()))?;
        let info = StreamInfo {
            name: name.to_owned(),
            demuxer,
            sample_rate: stream.rate(),
            source_channels: stream.channels,
            duration: answer.duration(stream),
            title: answer.tag(stream, "title"),
            artist: answer.tag(stream, "artist"),
            lyrics: None,
            scene_gain: answer.loudness(stream).scene_gain(),
        };
        let process = start(programs, &path, stream.index, &info, 0.0).map_err(failed)?;
        let mut decoder = Self {
            programs: programs.clone(),
            path,
            stream: stream.index,
            downmix: downmix(stream),
            info,
            process,
            rest: Vec::new(),
            pending: Vec::new(),
            position: 0,
            skip: 0,
            ended: false,
        };
        decoder.advance()?;
        if decoder.pending.is_empty() {
            return Err(failed(decoder.process.refusal(&decoder.path)));
        }
        Ok(decoder)
    }

    pub(super) fn next_block(&mut self, out: &mut Vec<StereoFrame>) -> Result<usize, Problem> {
        self.advance()?;
        let count = self.pending.len();
        out.append(&mut self.pending);
        self.position += count as u64;
        Ok(count)
    }

    pub(super) fn seek(&mut self, seconds: f64) -> Result<f64, Problem> {
        let rate = f64::from(self.info.sample_rate);
        // NaN becomes the start. A little sound may follow the claimed end, to which seeks are limited.
        let latest = self.info.duration.unwrap_or(limits::CLAIMED_DURATION_MAX);
        let target = (seconds.clamp(0.0, latest) * rate).round() as u64;
        let near = u64::from(self.info.sample_rate) * NEAR_SECONDS;
        if self.ended || !(self.position..=self.position + near).contains(&target) {
            let time = target as f64 / rate;
            self.process = start(&self.programs, &self.path, self.stream, &self.info, time)?;
            self.rest.clear();
            self.pending.clear();
            (self.position, self.skip, self.ended) = (target, 0, false);
        }
        self.skip = target - self.position;
        self.drop_skipped();
        self.advance()?;
        Ok(self.position as f64 / rate)
    }

    fn advance(&mut self) -> Result<(), Problem> {
        while self.pending.is_empty() && !self.ended {
            match self.process.next() {
                Ok(Some(piece)) => self.append(&piece),
                Ok(None) => self.ended = true,
                Err(failure) => {
                    self.ended = true;
                    return Err(failure.into());
                }
            }
        }
        Ok(())
    }

    fn append(&mut self, piece: &[u8]) {
        self.rest.extend_from_slice(piece);
        let frame_bytes = 4 * self.downmix.channels();
        let whole = self.rest.len() / frame_bytes * frame_bytes;
        let rest = self.rest.split_off(whole);
        let sample = |bytes: &[u8; 4]| f32::from_le_bytes(*bytes);
        let frames = self.rest.as_chunks::<4>().0.chunks(self.downmix.channels());
        self.pending.extend(frames.map(|frame| self.downmix.mix_frame(frame.iter().map(sample))));
        self.rest = rest;
        self.drop_skipped();
    }

    fn drop_skipped(&mut self) {
        let skipped = usize::try_from(self.skip).unwrap_or(usize::MAX).min(self.pending.len());
        self.pending.drain(..skipped);
        self.position += skipped as u64;
        self.skip -= skipped as u64;
    }
}

fn start(
    programs: &Programs,
    path: &Path,
    stream: u32,
    info: &StreamInfo,
    seconds: f64,
) -> Result<Process, Failure> {
    let from = (seconds > 0.0).then(|| ["-ss".to_owned(), format!("{seconds:.6}")]);
    let line = CommandLine::of(&programs.ffmpeg)
        .options(["-nostdin"])
        .input(Source::File(path), ReadBy::Demuxer(info.demuxer), from.into_iter().flatten())
        .options(["-map".to_owned(), format!("0:{stream}")])
        .options(["-ar".to_owned(), info.sample_rate.to_string()])
        .options(["-ac".to_owned(), info.source_channels.to_string()])
        .options(["-c:a", "pcm_f32le", "-f", "f32le", "pipe:1"]);
    Process::start(line, programs.patience)
}

impl From<Failure> for Problem {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Missing => Self::NeedsFfmpeg("is a file".into()),
            Failure::Start(reason) => Self::Read(reason),
            Failure::Refused(complaint) => Self::Damaged(format!("ffmpeg cannot decode it ({complaint})")),
            Failure::Useless(what) => Self::Damaged(what),
        }
    }
}

fn describe(refusal: &Problem) -> String {
    match refusal {
        Problem::UnsupportedFormat(what) => format!("is {what}"),
        Problem::UnsupportedCodec(codec) => format!("holds sound in {codec}"),
        other => other.to_string(),
    }
}

/// ffmpeg orders channels like WAVE files. Layouts that are unusual for a number of channels are recognised by name.
fn downmix(stream: &Stream) -> Downmix {
    const FRONT: Position = Position::FRONT_LEFT.union(Position::FRONT_RIGHT);
    let mask = match stream.channel_layout.as_str() {
        "2.1" => Some(FRONT | Position::LFE1),
        "3.0(back)" => Some(FRONT | Position::REAR_CENTER),
        "4.0" => Some(FRONT | Position::FRONT_CENTER | Position::REAR_CENTER),
        "4.1" => Some(FRONT | Position::FRONT_CENTER | Position::LFE1 | Position::REAR_CENTER),
        _ => None,
    };
    let by_count = Channels::Discrete(u16::try_from(stream.channels.max(1)).unwrap_or(1));
    Downmix::new(&mask.map_or(by_count, Channels::Positioned))
}

#[cfg(test)]
mod tests;
