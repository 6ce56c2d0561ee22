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
        let frames = duration.map_or(0.0, |duration| duration * f64::from(source.sample_rate()));
        let parts = (frames as usize).min(PARTS);
        if parts == 0 {
            return Some(None);
        }
        let part_of = |frame: u64| (frame as f64 * parts as f64 / frames) as usize;
        let mut sums = vec![Sum::default(); parts];
        let (mut block, mut frame, mut reported) = (Vec::new(), 0, 0);
        while part_of(frame) < parts {
            if !go_on() {
                return None;
            }
            block.clear();
            // If a track breaks off, the remaining parts count as silent, as in playback.
            if !matches!(source.next_block(&mut block), Ok(1..)) {
                break;
            }
            for [left, right] in &block {
                // A track may be longer than its stated duration.
                if let Some((sum, count)) = sums.get_mut(part_of(frame)) {
                    *sum += f64::from(left * left + right * right) / 2.0;
                    *count += 1;
                }
                frame += 1;
            }
            let measured = part_of(frame);
            if (reported + PARTS_A_TIME..parts).contains(&measured) {
                reported = measured;
                publish(Self::of(&sums, measured));
            }
        }
        Some(Some(Self::of(&sums, parts)))
    }

    /// Returns the shape of the first `measured` parts.
    fn of(sums: &[Sum], measured: usize) -> Self {
        let mean = |(sum, count): &Sum| (sum / f64::from((*count).max(1))) as f32;
        let squares: Vec<f32> = sums.iter().take(measured).map(mean).collect();
        let loudest = squares.iter().copied().fold(0.0, f32::max);
        // The exponent is halved for the square of the amplitude.
        let level =
            |square: &f32| if loudest > 0.0 { (square / loudest).powf(LOUDNESS_POWER / 2.0) } else { 0.0 };
        Self { parts: sums.len(), levels: squares.iter().map(level).collect() }
    }
}

/// The sum of the squares of a part's frames, and their number.
type Sum = (f64, u32);

#[cfg(test)]
#[path = "shape_tests.rs"]
mod tests;
