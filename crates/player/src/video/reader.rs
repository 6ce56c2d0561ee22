//! Reads the frames of a video file in any order.

use std::path::{Path, PathBuf};

use super::VideoFrame;
use super::error::VideoError;
use super::frames::Frames;
use super::probe::{VideoInfo, probe};
use crate::ffmpeg::{CommandLine, Demuxer, ReadBy, Source, file_address};

/// For a forward seek of at most this many seconds, ffmpeg is not restarted, but decodes up to the target.
const NEAR_SECONDS: f64 = 1.0;
/// In a format without an index, ffmpeg may find a place between two key frames. It starts earlier by this time, which
/// is longer than the usual distance of key frames.
const NO_INDEX_SECONDS: f64 = 10.0;

/// A video file. Reading waits for ffmpeg; frames in order are read without a seek.
pub struct VideoReader {
    path: PathBuf,
    name: String,
    demuxer: Demuxer,
    info: VideoInfo,
    /// The running ffmpeg; `None` before the first frame and after the last.
    frames: Option<Frames>,
    /// The index of the next frame from ffmpeg.
    next: u64,
    last: Option<(u64, VideoFrame)>,
    /// The number of frames, once the end was reached before the claimed end.
    end: Option<u64>,
}

impl VideoReader {
    /// Asks ffprobe about a video. `name` is the name in messages.
    ///
    /// # Errors
    /// Fails if ffmpeg is missing, or the file is no video that it can decode.
    pub fn open(path: &Path, name: &str) -> Result<Self, VideoError> {
        let path = std::path::absolute(path).map_err(|error| VideoError::unreadable(name, &error))?;
        let (info, demuxer) = probe(&path, name)?;
        let (frames, next, last, end) = (None, 0, None, None);
        Ok(Self { path, name: name.to_owned(), demuxer, info, frames, next, last, end })
    }

    /// The size, rate and length of the video.
    pub fn info(&self) -> VideoInfo {
        self.info
    }

    /// Returns the frame with this number ([`VideoInfo::number_at`]). A video that ends before its claimed end keeps
    /// its last frame.
    ///
    /// # Errors
    /// Fails if ffmpeg cannot start, stops for long, or decodes no frame at all.
    pub fn frame(&mut self, number: u64) -> Result<&VideoFrame, VideoError> {
        let index = number % self.info.frames;
        let index = self.end.map_or(index, |end| index.min(end.saturating_sub(1)));
        if self.last.as_ref().is_none_or(|(known, _)| *known != index) {
            self.read_to(index)?;
        }
        match &self.last {
            Some((_, frame)) => Ok(frame),
            None => Err(VideoError::damaged(&self.name, "ffmpeg decodes no frame of it")),
        }
    }

    fn read_to(&mut self, index: u64) -> Result<(), VideoError> {
        let near = (NEAR_SECONDS * self.info.rate()) as u64;
        let mut begin = self.next;
        let mut has_read = self.last.is_some();
        if self.frames.is_none() || !(self.next..=self.next + near).contains(&index) {
            begin = index;
            self.start(begin)?;
            has_read = false;
        }
        let mut back = near.max(1);
        loop {
            let Some(frames) = &mut self.frames else { return Ok(()) };
            match frames.next().map_err(|failure| VideoError::of(&self.name, failure))? {
                Some(frame) => {
                    self.last = Some((self.next, frame));
                    self.next += 1;
                    has_read = true;
                    if self.next > index {
                        return Ok(());
                    }
                }
                None if has_read => {
                    (self.frames, self.end) = (None, Some(self.next));
                    return Ok(());
                }
                None if begin == 0 => {
                    let what = frames.process.complaint(&file_address(&self.path).to_string_lossy());
                    self.frames = None;
                    return Err(VideoError::damaged(&self.name, &what));
                }
                // The video ends before this frame: find its last frame.
                None => {
                    begin = begin.saturating_sub(back);
                    back = back.saturating_mul(8);
                    self.start(begin)?;
                }
            }
        }
    }

    fn start(&mut self, index: u64) -> Result<(), VideoError> {
        let (above, below) = self.info.rate;
        let margin = if self.demuxer.has_index() { 0.0 } else { NO_INDEX_SECONDS };
        let seconds = (index as f64 / self.info.rate() - margin).max(0.0);
        // ffmpeg starts at the last key frame before `seconds`, and the filters leave out the frames up to `index`.
        // Without the times of the file, the steps of the grid would depend on the key frame.
        let options =
            ["-threads", "4", "-noaccurate_seek", "-ss", &format!("{seconds:.6}")].map(str::to_owned);
        let line = CommandLine::ffmpeg().options(["-copyts", "-start_at_zero"]).input(
            Source::File(&self.path),
            ReadBy::Demuxer(self.demuxer),
            options,
        );
        let filters = format!("fps={above}/{below},trim=start_pts={index},setpts=N");
        self.frames = None;
        let frames = Frames::start(line, &filters).map_err(|failure| VideoError::of(&self.name, failure))?;
        (self.frames, self.next) = (Some(frames), index);
        Ok(())
    }
}
