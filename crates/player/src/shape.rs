//! The loudness of a track over its length, for the seek bar.

use crate::limits;
use crate::source::FrameSource;

const PARTS: usize = 600;

const PARTS_A_TIME: usize = 6;

/// The exponent from amplitude to loudness: 10 dB more make a sound twice as loud (Stevens 1955, in sones).
const LOUDNESS_POWER: f32 = 0.6;

/// The loudness of the parts of a track that are measured already.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LoudnessShape {
    /// The number of parts of equal length.
    pub parts: usize,
    /// The loudness of the measured parts from the start: 0 is silence, 1 the loudest part so far.
    pub levels: Vec<f32>,
}

impl LoudnessShape {
    /// Decodes a track as fast as possible. Passes the beginning of the shape to `publish`, again and again. Returns
    /// `None` as soon as `go_on` returns false, and `Some(None)` if the track is too long or its duration is unknown.
    pub fn measure(
        source: &mut dyn FrameSource,
        go_on: &dyn Fn() -> bool,
        publish: &dyn Fn(Self),
    ) -> Option<Option<Self>> {
        let duration = source.duration().filter(|duration| *duration <= limits::SHAPE_SECONDS_MAX);
        let sums = duration.and_then(|duration| Sums::new(duration * f64::from(source.sample_rate())));
        let Some(mut sums) = sums else { return Some(None) };
        let (mut block, mut reported) = (Vec::new(), 0);
        loop {
            if !go_on() {
                return None;
            }
            block.clear();
            match source.next_block(&mut block) {
                Ok(1..) => block.iter().for_each(|frame| sums.push(*frame)),
                // If a track breaks off, the remaining parts count as silent, as in playback.
                Ok(0) | Err(_) => break,
            }
            if sums.squares.len() == sums.parts {
                break;
            }
            if sums.squares.len() >= reported + PARTS_A_TIME {
                reported = sums.squares.len();
                publish(sums.shape());
            }
        }
        sums.squares.resize(sums.parts, 0.0);
        Some(Some(sums.shape()))
    }
}

struct Sums {
    parts: usize,
    frames_per_part: f64,
    squares: Vec<f32>,
    frames: u64,
    sum: f64,
    count: u32,
}

impl Sums {
    fn new(frames: f64) -> Option<Self> {
        let parts = (frames as usize).min(PARTS);
        let frames_per_part = frames / parts as f64;
        (parts > 0).then(|| Self {
            parts,
            frames_per_part,
            squares: Vec::new(),
            frames: 0,
            sum: 0.0,
            count: 0,
        })
    }

    fn push(&mut self, [left, right]: [f32; 2]) {
        // A track may be longer than its stated duration.
        if self.squares.len() == self.parts {
            return;
        }
        self.sum += f64::from(left * left + right * right) / 2.0;
        self.count += 1;
        self.frames += 1;
        if self.frames as f64 >= (self.squares.len() + 1) as f64 * self.frames_per_part {
            self.squares.push((self.sum / f64::from(self.count)) as f32);
            (self.sum, self.count) = (0.0, 0);
        }
    }

    fn shape(&self) -> LoudnessShape {
        let loudest = self.squares.iter().copied().fold(0.0, f32::max);
        // The exponent is halved for the square of the amplitude.
        let level =
            |square: &f32| if loudest > 0.0 { (square / loudest).powf(LOUDNESS_POWER / 2.0) } else { 0.0 };
        LoudnessShape { parts: self.parts, levels: self.squares.iter().map(level).collect() }
    }
}

#[cfg(test)]
#[path = "shape_tests.rs"]
mod tests;
