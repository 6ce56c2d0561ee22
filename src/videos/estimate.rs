//! The expected time and size of a video, from a few frames that the process renders.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::order::Order;
use mariana_player::ffmpeg::{CommandLine, Demuxer, ReadBy, Source};

/// Number of frames that are rendered to measure.
pub(super) const FRAMES: u64 = 6;
/// Bytes of sound for each second, at the rate that mp4 gets.
const SOUND_BYTES: f64 = 32_000.0;
/// ffmpeg's H.264 encoder writes a whole frame at least this often; the frames between contain only changes.
const WHOLE_EVERY: f64 = 250.0;
/// A measurement ends after this time, with the frames that are drawn by then.
const MEASURED_MAX: Duration = Duration::from_secs(60);

/// The expected time and size of a video.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Estimate {
    /// Nobody asked, or another video is being rendered.
    #[default]
    Unknown,
    /// The first frames are being rendered.
    Measuring,
    /// It is known.
    Known {
        /// Rendering time in seconds.
        seconds: f64,
        /// Size of the file in bytes; `None` if unknown.
        bytes: Option<u64>,
        /// Free space on the disk in bytes; `None` if unknown.
        free: Option<u64>,
    },
    /// Not even two frames were drawn in the time for a measurement.
    TooSlow,
    /// The video would fail, for this reason.
    Failed(String),
}

/// A measurement to make.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Measure {
    pub(super) arguments: Vec<String>,
    /// Number of frames of the whole video.
    frames: f64,
    /// Length of the video in seconds.
    seconds: f64,
    has_sound: bool,
    /// The path of the video.
    file: PathBuf,
}

impl Measure {
    /// Measures an order for a video of `seconds` at the path `file`.
    pub(super) fn of(order: &Order, seconds: f64, file: PathBuf) -> Self {
        let preset = order.preset();
        let length = FRAMES as f64 / preset.fps;
        let middle = order.start + (0.5 * (seconds - length)).max(0.0);
        let frames = (seconds + preset.seam.unwrap_or(0.0)) * preset.fps;
        Self { arguments: order.probe(middle, length), frames, seconds, has_sound: preset.sound, file }
    }
}

/// The times of a measurement.
pub(super) struct Measuring {
    pub(super) measure: Measure,
    begun: Instant,
    /// The time of the first frame, and the time and number of the last one.
    first: Option<Instant>,
    last: (Instant, u64),
}

impl Measuring {
    pub(super) fn begin(measure: Measure, now: Instant) -> Self {
        Self { measure, begun: now, first: None, last: (now, 0) }
    }

    /// Notes that `done` frames are drawn.
    pub(super) fn record(&mut self, done: u64, now: Instant) {
        self.first.get_or_insert(now);
        self.last = (now, done);
    }

    /// The time limit of the measurement.
    pub(super) fn ends_at(&self) -> Instant {
        self.begun + MEASURED_MAX
    }

    /// Returns the estimate at the time limit.
    pub(super) fn estimate_early(&self, file: &Path) -> Estimate {
        if self.last.1 < 2 { Estimate::TooSlow } else { self.estimate(file) }
    }

    /// Returns the estimate, once `file` contains the frames.
    pub(super) fn estimate(&self, file: &Path) -> Estimate {
        let Some(first) = self.first else { return Estimate::Unknown };
        let (last, done) = self.last;
        let start = first.saturating_duration_since(self.begun);
        let each = per_frame(last.saturating_duration_since(first), start, done);
        let Measure { frames, seconds, has_sound, .. } = self.measure;
        let sound = if has_sound { SOUND_BYTES * seconds } else { 0.0 };
        Estimate::Known {
            seconds: start.as_secs_f64() + frames * each,
            bytes: packets(file).map(|packets| (bytes_of(&packets, frames) + sound) as u64),
            free: free_space(&self.measure.file),
        }
    }
}

/// Seconds of each frame. The time until the first frame includes the compilation of programs.
fn per_frame(drawing: Duration, start: Duration, done: u64) -> f64 {
    match done {
        0 | 1 => start.as_secs_f64(),
        done => drawing.as_secs_f64() / (done - 1) as f64,
    }
}

/// Bytes of a video of `frames` frames, from the sizes of its first ones. The first one is a whole frame.
fn bytes_of(packets: &[u64], frames: f64) -> f64 {
    let Some((whole, changes)) = packets.split_first() else { return 0.0 };
    let whole = *whole as f64;
    let change = match changes.len() {
        0 => whole,
        count => changes.iter().sum::<u64>() as f64 / count as f64,
    };
    let wholes = (frames / WHOLE_EVERY).ceil().max(1.0);
    wholes * whole + (frames - wholes).max(0.0) * change
}

/// Sizes of the video's frames in the file, in bytes; `None` if they cannot be read.
fn packets(file: &Path) -> Option<Vec<u64>> {
    let none: [&str; 0] = [];
    let line = CommandLine::ffprobe()
        .options(["-select_streams", "v:0", "-show_entries", "packet=size", "-of", "csv=p=0"])
        .input(Source::File(file), ReadBy::Demuxer(Demuxer::MOV), none);
    let output = line.command().output().ok().filter(|output| output.status.success())?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let sizes: Vec<u64> = text.lines().filter_map(|line| line.trim_end_matches(',').parse().ok()).collect();
    Some(sizes).filter(|sizes| !sizes.is_empty())
}

#[cfg(unix)]
fn free_space(file: &Path) -> Option<u64> {
    // The folder may not exist yet.
    let disk = file.ancestors().skip(1).find_map(|folder| rustix::fs::statvfs(folder).ok())?;
    disk.f_bavail.checked_mul(disk.f_frsize)
}

#[cfg(not(unix))]
fn free_space(_: &Path) -> Option<u64> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_measurement_of_a_slow_scene_had_no_end() {
        let (now, file) = (Instant::now(), PathBuf::from("a.mp4"));
        let measure = Measure { arguments: Vec::new(), frames: 600.0, seconds: 10.0, has_sound: false, file };
        let mut measuring = Measuring::begin(measure, now);
        assert!(measuring.ends_at() <= now + Duration::from_secs(60));
        let none = Path::new("no such file");
        measuring.record(1, now + Duration::from_secs(30));
        assert_eq!(measuring.estimate_early(none), Estimate::TooSlow);
        measuring.record(2, now + Duration::from_secs(50));
        let Estimate::Known { seconds, bytes: None, .. } = measuring.estimate_early(none) else {
            panic!("two frames give a time")
        };
        assert!(seconds > 100.0, "{seconds}");
    }

    #[test]
    fn time_and_size_grow_with_the_length() {
        let seconds = Duration::from_secs;
        assert_eq!(per_frame(seconds(10), seconds(3), 6), 2.0);
        assert_eq!(per_frame(seconds(0), seconds(3), 1), 3.0, "the only frame");
        assert_eq!(bytes_of(&[], 100.0), 0.0);
        assert_eq!(bytes_of(&[1000], 100.0), 100_000.0);
        assert_eq!(bytes_of(&[1000, 10, 30], 100.0), 1000.0 + 99.0 * 20.0);
        assert_eq!(bytes_of(&[1000, 10, 30], 500.0), 2000.0 + 498.0 * 20.0);
    }
}
