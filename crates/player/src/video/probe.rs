//! Reads the size, rate and length of a video with ffprobe.

use std::fs;
use std::path::Path;
use std::time::Duration;

use super::error::VideoError;
use crate::ffmpeg::probe::Answer;
use crate::ffmpeg::{CommandLine, Demuxer, ReadBy, Source};
use crate::limits;

/// Minimum number of frames per second of the grid on which a video is read.
const RATE_MIN: f64 = 10.0;

const ENTRIES: &str = "format=format_name,duration:\
    stream=codec_name,width,height,avg_frame_rate,r_frame_rate,duration,nb_read_packets:stream_tags=DURATION";

/// The size, the rate and the length of a video.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VideoInfo {
    /// Width and height of the file's frames in pixels, before rotation and scaling.
    pub size: (u32, u32),
    /// Frames per second of the grid on which the video is read, as numerator and denominator.
    pub rate: (u32, u32),
    /// The number of frames of the grid; at least 1. A video that ends earlier keeps its last frame.
    pub frames: u64,
}

impl VideoInfo {
    /// Frames per second.
    pub fn rate(&self) -> f64 {
        f64::from(self.rate.0) / f64::from(self.rate.1.max(1))
    }

    /// The length in seconds.
    pub fn seconds(&self) -> f64 {
        self.frames as f64 / self.rate()
    }

    /// The number of the frame that is shown at `seconds` of the song. It counts on when the video is repeated: frame
    /// `number % frames` of the file has this number. Times before 0 show the first frame.
    pub fn number_at(&self, seconds: f64) -> u64 {
        // Times of frames are rounded to 32-bit floats.
        const ROUNDING: f64 = 0.02;
        (seconds * self.rate() + ROUNDING) as u64
    }
}

/// Asks ffprobe about a video.
pub(super) fn probe(path: &Path, name: &str) -> Result<(VideoInfo, Demuxer), VideoError> {
    let unreadable = |error| VideoError::unreadable(name, &error);
    // Check before opening: opening a pipe blocks until another program writes to it.
    if !fs::metadata(path).map_err(unreadable)?.is_file() {
        return Err(unreadable(std::io::Error::other("it is not a file")));
    }
    let answer = run_ffprobe(path, name, &[])?;
    let answer = match answer.streams.first() {
        // Some files, such as recordings of browsers, do not name their length.
        Some(stream) if answer.duration(stream).is_none() => run_ffprobe(path, name, &["-count_packets"])?,
        _ => answer,
    };
    let no_video = |what| VideoError(format!("{name} has no moving picture ({what}): choose a video"));
    let demuxer = Demuxer::of_video(&answer.format.format_name);
    let demuxer = demuxer.ok_or_else(|| no_video("ffmpeg finds no video format in it"))?;
    let stream = answer.streams.first().ok_or_else(|| no_video("it has no video stream"))?;
    let (width, height, max) = (stream.width, stream.height, limits::VIDEO_SIDE_MAX);
    if width == 0 || height == 0 || !stream.is_known() {
        return Err(no_video("its video stream cannot be decoded"));
    }
    if width > max || height > max {
        return Err(VideoError(format!(
            "{name} has {width} x {height} pixels, more than {max} on a side: convert it to a smaller size"
        )));
    }
    let rate = rate_of(&stream.avg_frame_rate, &stream.r_frame_rate);
    let per_second = f64::from(rate.0) / f64::from(rate.1);
    let frames = match answer.duration(stream) {
        Some(seconds) => (seconds * per_second).round() as u64,
        None => stream.nb_read_packets.as_deref().and_then(|count| count.parse().ok()).unwrap_or(0),
    };
    Ok((VideoInfo { size: (width, height), rate, frames: frames.max(1) }, demuxer))
}

fn run_ffprobe(path: &Path, name: &str, options: &[&str]) -> Result<Answer, VideoError> {
    let line = CommandLine::ffprobe()
        .options(["-select_streams", "V:0"])
        .options(options.iter().copied())
        .input(Source::File(path), ReadBy::AnyVideoDemuxer, [""; 0]);
    let patience = Duration::from_secs_f64(limits::FFMPEG_WAIT_SECONDS);
    Answer::of(line, ENTRIES, patience, path).map_err(|failure| VideoError::of(name, failure))
}

/// The rate of the grid: the average rate, or the highest rate of a file with a variable rate.
fn rate_of(average: &str, highest: &str) -> (u32, u32) {
    let fraction = |text: &str| {
        let (above, below) = text.split_once('/')?;
        let (above, below) = (above.parse::<u32>().ok()?, below.parse::<u32>().ok()?);
        (above > 0 && below > 0).then_some((above, below))
    };
    let value = |(above, below): (u32, u32)| f64::from(above) / f64::from(below);
    let known = [fraction(average), fraction(highest)].into_iter().flatten();
    let (above, below) = known.max_by(|a, b| value(*a).total_cmp(&value(*b))).unwrap_or((25, 1));
    let (max, rate) = (limits::VIDEO_RATE_MAX, value((above, below)));
    if rate > f64::from(max) {
        return (max, 1);
    }
    // A multiple of a low rate shows each frame near its own time.
    let times = (RATE_MIN / rate).ceil().clamp(1.0, 1e6) as u32;
    above.checked_mul(times).map_or((max, 1), |above| (above, below))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_limited_and_variable_rates_take_the_highest() {
        assert_eq!(rate_of("25/1", "25/1"), (25, 1));
        assert_eq!(rate_of("30000/1001", "30000/1001"), (30_000, 1_001));
        assert_eq!(rate_of("12/1", "50/1"), (50, 1));
        assert_eq!(rate_of("12/1", "90000/1"), (60, 1));
        assert_eq!(rate_of("4/1", "4/1"), (12, 1));
        for broken in ["", "0/0", "-1/2", "x/y", "1/0", "99999999999/1"] {
            assert_eq!(rate_of(broken, broken), (25, 1), "{broken}");
        }
        assert_eq!(rate_of("1/4294967295", "0/0"), (1_000_000, 4_294_967_295));
    }

    #[test]
    fn a_frame_stays_for_its_whole_step_and_the_count_goes_on_in_loops() {
        let info = VideoInfo { size: (1, 1), rate: (25, 1), frames: 75 };
        assert_eq!(
            [0.0, 0.039, 0.04, 2.96, 3.0, 3.04].map(|time| info.number_at(time)),
            [0, 0, 1, 74, 75, 76]
        );
        for number in 0..10_000_u64 {
            assert_eq!(info.number_at(f64::from((number as f64 / 25.0) as f32)), number);
        }
        assert_eq!([-1.0, f64::NAN, f64::NEG_INFINITY].map(|time| info.number_at(time)), [0; 3]);
    }
}
