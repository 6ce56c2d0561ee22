//! Sample rate conversion of a stereo stream. The decoding thread uses it, but never the callback.
//!
//! The filter's delay is cut off at the start, and the frames left in the filter are appended at the end. Output frame
//! `m` is the signal at input time `m * from / to`, and `n` input frames become `round(n * to / from)` output frames.
//! Rates with a large common divisor (all usual rates) use rubato's FFT resampler, whose delay is then a whole number
//! of frames on both sides. For odd ratios an FFT block would hold seconds of sound. These ratios use the windowed-sinc
//! resampler, whose delay is compensated to within half an output frame.

use mariana_music::StereoFrame;
use mariana_music::limits as music_limits;
use mariana_transforms::{Indexing, InterleavedSlice, fourier_resampler, sinc_resampler};

/// Target length of an FFT block, in input frames (23 ms at 44.1 kHz). It allows a narrow transition and fast seeks.
const BLOCK_FRAMES: usize = 1024;

/// Maximum length of an FFT block, in input frames. Ratios that need a longer block use the sinc resampler.
const BLOCK_FRAMES_MAX: usize = 16_384;

/// Length of the windowed sinc for odd ratios, in input frames.
const SINC_LENGTH: usize = 256;

/// An error of sample rate conversion.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct ResampleError(String);

impl ResampleError {
    /// The resampling library failed. The cause is a bug of the program, not an error in the input.
    fn of_library(from: u32, to: u32, error: &dyn std::fmt::Display) -> Self {
        Self(format!("the conversion from {from} Hz to {to} Hz failed: {error}; please report this error"))
    }
}

/// A streaming sample rate converter for stereo frames.
pub struct Resampler {
    from: u32,
    to: u32,
    /// `None` for equal rates, at which frames pass through unchanged.
    engine: Option<Engine>,
}

struct Engine {
    inner: Box<dyn mariana_transforms::Resampler<f32>>,
    waiting: Vec<StereoFrame>,
    block: Vec<StereoFrame>,
    /// The number of output frames that must still be cut off as the filter's delay.
    delay_left: usize,
    frames_in: u64,
    frames_out: u64,
}

impl Resampler {
    /// Creates a converter between two rates in hertz, within the limits of [`mariana_music::limits`].
    pub fn new(from: u32, to: u32) -> Result<Self, ResampleError> {
        let (min, max) = (music_limits::SAMPLE_RATE_MIN, music_limits::SAMPLE_RATE_MAX);
        if !(min..=max).contains(&from) || !(min..=max).contains(&to) {
            return Err(ResampleError(format!(
                "cannot convert from {from} Hz to {to} Hz: rates must be {min} to {max} Hz; choose another device rate \
                 or file"
            )));
        }
        let made = || Engine::new(from, to).map_err(|error| ResampleError::of_library(from, to, &error));
        let engine = if from == to { None } else { Some(made()?) };
        Ok(Self { from, to, engine })
    }

    /// Creates a converter that passes frames on unchanged.
    pub(crate) fn passing(rate: u32) -> Self {
        Self { from: rate, to: rate, engine: None }
    }

    /// The input's rate, in hertz.
    pub fn from_hz(&self) -> u32 {
        self.from
    }

    /// Converts `input` and appends the finished frames to `output`.
    pub fn process(
        &mut self,
        input: &[StereoFrame],
        output: &mut Vec<StereoFrame>,
    ) -> Result<(), ResampleError> {
        let (from, to) = (self.from, self.to);
        match &mut self.engine {
            None => output.extend_from_slice(input),
            Some(engine) => {
                engine.waiting.extend_from_slice(input);
                engine.frames_in += input.len() as u64;
                engine.run(output).map_err(|error| ResampleError::of_library(from, to, &error))?;
            }
        }
        Ok(())
    }

    /// Ends the stream: appends the filter's remaining frames, so that the output is as long as the input.
    pub fn finish(&mut self, output: &mut Vec<StereoFrame>) -> Result<(), ResampleError> {
        let (from, to) = (self.from, self.to);
        if let Some(engine) = &mut self.engine {
            let total =
                (u128::from(engine.frames_in) * u128::from(to) + u128::from(from) / 2) / u128::from(from);
            let drained = engine.drain(total as u64, output);
            drained.map_err(|error| ResampleError::of_library(from, to, &error))?;
        }
        Ok(())
    }
}

impl Engine {
    fn new(from: u32, to: u32) -> Result<Self, mariana_transforms::ResamplerConstructionError> {
        // The shortest block whose half is a whole number of frames at both rates has two periods of the ratio.
        let unit = 2 * (from / gcd(from, to)) as usize;
        let (inner, delay) = if unit <= BLOCK_FRAMES_MAX {
            let fourier = fourier_resampler(from, to, unit * BLOCK_FRAMES.div_ceil(unit), 2)?;
            let delay = fourier.output_delay();
            (fourier, delay)
        } else {
            let ratio = f64::from(to) / f64::from(from);
            let sinc = sinc_resampler(ratio, SINC_LENGTH, BLOCK_FRAMES, 2)?;
            // By measurement, the first output is one output frame into the filter, and the library truncates the
            // reported delay to a whole number.
            let delay = (SINC_LENGTH as f64 / 2.0 * ratio - 1.0).round().max(0.0);
            (sinc, delay as usize)
        };
        let block = vec![[0.0; 2]; inner.output_frames_max()];
        Ok(Self { inner, waiting: Vec::new(), block, delay_left: delay, frames_in: 0, frames_out: 0 })
    }

    fn run(&mut self, output: &mut Vec<StereoFrame>) -> Result<(), String> {
        let mut taken = 0;
        while self.waiting.len() - taken >= self.inner.input_frames_next() {
            taken += self.convert(taken, None, u64::MAX, output)?;
        }
        self.waiting.drain(..taken);
        Ok(())
    }

    fn drain(&mut self, total: u64, output: &mut Vec<StereoFrame>) -> Result<(), String> {
        while self.frames_out < total {
            let rest = self.waiting.len();
            self.convert(0, Some(rest), total, output)?;
            self.waiting.clear();
        }
        Ok(())
    }

    /// Converts one block from `waiting[offset..]`; `partial` is the number of frames before a padding of silence.
    /// Drops the rest of the delay and all frames after `total`. Returns the number of input frames used.
    fn convert(
        &mut self,
        offset: usize,
        partial: Option<usize>,
        total: u64,
        output: &mut Vec<StereoFrame>,
    ) -> Result<usize, String> {
        let input = &self.waiting[offset..];
        let room = self.block.len();
        let source =
            InterleavedSlice::new(input.as_flattened(), 2, input.len()).map_err(|e| e.to_string())?;
        let mut sink =
            InterleavedSlice::new_mut(self.block.as_flattened_mut(), 2, room).map_err(|e| e.to_string())?;
        let indexing = partial.map(|frames| Indexing::new().partial_len(frames));
        let (taken, made) = self
            .inner
            .process_into_buffer(&source, &mut sink, indexing.as_ref())
            .map_err(|e| e.to_string())?;
        let skip = self.delay_left.min(made);
        self.delay_left -= skip;
        let keep = ((made - skip) as u64).min(total.saturating_sub(self.frames_out)) as usize;
        output.extend_from_slice(&self.block[skip..skip + keep]);
        self.frames_out += keep as u64;
        Ok(taken)
    }
}

fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn sine(hz: f64, rate: u32, frames: usize) -> Vec<StereoFrame> {
        (0..frames)
            .map(|n| {
                let phase = TAU * hz * n as f64 / f64::from(rate);
                [(0.5 * phase.sin()) as f32, (0.5 * phase.cos()) as f32]
            })
            .collect()
    }

    fn convert(from: u32, to: u32, input: &[StereoFrame]) -> Vec<StereoFrame> {
        let mut resampler = Resampler::new(from, to).unwrap();
        let mut output = Vec::new();
        let mut rest = input;
        for size in [1usize, 1152, 7, 4096, 576].iter().cycle() {
            if rest.is_empty() {
                break;
            }
            let (piece, after) = rest.split_at((*size).min(rest.len()));
            resampler.process(piece, &mut output).unwrap();
            rest = after;
        }
        resampler.finish(&mut output).unwrap();
        output
    }

    /// Returns the level of the best fitting sine relative to 0.5, and the residue relative to this sine, both in dB.
    fn level_and_residue(channel: &[f64], hz: f64, rate: u32) -> (f64, f64) {
        let n = channel.len() as f64;
        let (mut s, mut c) = (0.0, 0.0);
        for (i, x) in channel.iter().enumerate() {
            let phase = TAU * hz * i as f64 / f64::from(rate);
            s += x * phase.sin();
            c += x * phase.cos();
        }
        let (s, c) = (2.0 * s / n, 2.0 * c / n);
        let residue: f64 = channel
            .iter()
            .enumerate()
            .map(|(i, x)| {
                let phase = TAU * hz * i as f64 / f64::from(rate);
                (x - s * phase.sin() - c * phase.cos()).powi(2)
            })
            .sum::<f64>()
            / n;
        let power = (s * s + c * c) / 2.0;
        (10.0 * (power / 0.125).log10(), 10.0 * (residue / power).log10())
    }

    #[test]
    fn a_sine_keeps_its_level_and_gains_no_distortion() {
        for (from, to) in [(44_100, 48_000), (48_000, 44_100), (96_000, 48_000), (22_050, 48_000)] {
            let output = convert(from, to, &sine(1000.0, from, from as usize * 2));
            // Use one second from the middle, so that the sine has whole periods and the ends have no effect.
            let start = to as usize / 2;
            for side in 0..2 {
                let middle: Vec<f64> =
                    output[start..start + to as usize].iter().map(|f| f64::from(f[side])).collect();
                let (level, residue) = level_and_residue(&middle, 1000.0, to);
                assert!(level.abs() < 0.01, "{from} to {to}: level {level} dB");
                assert!(residue < -90.0, "{from} to {to}: residue {residue} dB");
            }
        }
    }

    #[test]
    fn output_time_is_input_time() {
        // The output must be the same sine at the new sample times: a shift by one frame at 1 kHz would leave an error
        // of about 0.06.
        for (from, to, tolerance) in [
            (44_100, 48_000, 1e-4),
            (48_000, 44_100, 1e-4),
            (8_000, 48_000, 1e-3),
            (44_100, 44_101, 0.05),
            (44_101, 48_000, 0.05),
        ] {
            let output = convert(from, to, &sine(1000.0, from, from as usize));
            let wanted = sine(1000.0, to, to as usize);
            assert_eq!(output.len(), to as usize, "{from} to {to}");
            for m in to as usize / 4..to as usize * 3 / 4 {
                for side in 0..2 {
                    let error = (output[m][side] - wanted[m][side]).abs();
                    assert!(error < tolerance, "{from} to {to}, frame {m}: off by {error}");
                }
            }
        }
    }

    #[test]
    fn lengths_follow_the_ratio() {
        for frames in [0usize, 1, 10, 1000, 44_101] {
            let output = convert(44_100, 48_000, &vec![[0.25; 2]; frames]);
            assert_eq!(output.len(), (frames as f64 * 48.0 / 44.1).round() as usize, "{frames} frames");
        }
    }

    #[test]
    fn equal_rates_pass_through() {
        let input = sine(440.0, 48_000, 5000);
        assert_eq!(convert(48_000, 48_000, &input), input);
        assert!(Resampler::new(48_000, 48_000).unwrap().engine.is_none());
    }

    #[test]
    fn rates_outside_the_limits_are_refused() {
        for (from, to) in [(0, 48_000), (48_000, 0), (music_limits::SAMPLE_RATE_MAX + 1, 48_000)] {
            let error = Resampler::new(from, to).map(|_| ()).unwrap_err().to_string();
            assert!(error.contains("rates must be"), "{error}");
        }
    }
}
