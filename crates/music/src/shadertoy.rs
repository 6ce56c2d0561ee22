//! The sound as Shadertoy gives it to its shaders: a texture of 512 by 2 bytes.
//!
//! Row 0 is the first half of what the Web Audio API's `AnalyserNode` tells of frequencies (`getByteFrequencyData`), row 1
//! the first 512 samples of its waveform (`getByteTimeDomainData`), both by its definition and with its defaults: 2048
//! samples, smoothing 0.8, -100..-30 dB. (W3C, Web Audio API, "FFT windowing and smoothing over time".)

use std::f64::consts::TAU;
use std::sync::Arc;

use rustfft::num_complex::Complex32;
use rustfft::{Fft, FftPlanner};

use super::StereoFrame;

/// Samples that are looked at.
const LENGTH: usize = 2048;

/// Width of the texture: a quarter of the sample rate, 23 Hz for each texel at 48 kHz.
pub const SHADERTOY_WIDTH: usize = 512;

/// Share of the last look that stays in the next.
const SMOOTHING: f32 = 0.8;

/// The decibels that are written as 0 and as 255.
const RANGE_DB: (f32, f32) = (-100.0, -30.0);

/// Looks at the sound. Allocates in `new` only.
pub struct ShadertoyTexture {
    fft: Arc<dyn Fft<f32>>,
    window: Vec<f32>,
    samples: Vec<f32>,
    buffer: Vec<Complex32>,
    scratch: Vec<Complex32>,
    smoothed: [f32; SHADERTOY_WIDTH],
    rows: [[u8; SHADERTOY_WIDTH]; 2],
}

impl Default for ShadertoyTexture {
    fn default() -> Self {
        Self::new()
    }
}

impl ShadertoyTexture {
    /// A texture of silence.
    pub fn new() -> Self {
        let fft = FftPlanner::new().plan_fft_forward(LENGTH);
        // Blackman with alpha 0.16, divided by the length as the transform is.
        let weight = |n: usize| {
            let angle = TAU * n as f64 / LENGTH as f64;
            (0.42 - 0.5 * angle.cos() + 0.08 * (2.0 * angle).cos()) / LENGTH as f64
        };
        Self {
            window: (0..LENGTH).map(|n| weight(n) as f32).collect(),
            samples: vec![0.0; LENGTH],
            buffer: vec![Complex32::default(); LENGTH],
            scratch: vec![Complex32::default(); fft.get_inplace_scratch_len()],
            smoothed: [0.0; SHADERTOY_WIDTH],
            rows: [[0; SHADERTOY_WIDTH], [128; SHADERTOY_WIDTH]],
            fft,
        }
    }

    /// Looks at the newest of `frames`, before which there is silence if they are fewer than 2048, and gives both rows.
    /// Smoothing counts looks: Shadertoy takes one for each picture.
    pub fn look(&mut self, frames: &[StereoFrame]) -> &[[u8; SHADERTOY_WIDTH]; 2] {
        let newest = &frames[frames.len().saturating_sub(LENGTH)..];
        let (before, samples) = self.samples.split_at_mut(LENGTH - newest.len());
        before.fill(0.0);
        for (sample, [left, right]) in samples.iter_mut().zip(newest) {
            let mono = 0.5 * (left + right);
            *sample = if mono.is_finite() { mono } else { 0.0 };
        }
        for ((z, sample), weight) in self.buffer.iter_mut().zip(&self.samples).zip(&self.window) {
            *z = Complex32::new(sample * weight, 0.0);
        }
        self.fft.process_with_scratch(&mut self.buffer, &mut self.scratch);
        let [frequencies, waveform] = &mut self.rows;
        for ((byte, smoothed), z) in frequencies.iter_mut().zip(&mut self.smoothed).zip(&self.buffer) {
            let next = SMOOTHING * *smoothed + (1.0 - SMOOTHING) * z.norm();
            *smoothed = if next.is_finite() { next } else { 0.0 };
            let above = (20.0 * smoothed.log10() - RANGE_DB.0) / (RANGE_DB.1 - RANGE_DB.0);
            // A cast clamps to 0..=255.
            *byte = (255.0 * above).floor() as u8;
        }
        for (byte, sample) in waveform.iter_mut().zip(&self.samples) {
            *byte = (128.0 * (1.0 + sample)).floor() as u8;
        }
        &self.rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tone(amplitude: f64, cycles: f64) -> Vec<StereoFrame> {
        (0..LENGTH)
            .map(|n| [(amplitude * (TAU * cycles * n as f64 / LENGTH as f64).cos()) as f32; 2])
            .collect()
    }

    /// The definition again, term by term, without a fast transform.
    fn by_definition(frames: &[StereoFrame], bin: usize, looks: i32) -> u8 {
        let n = LENGTH as f64;
        let (mut re, mut im) = (0.0, 0.0);
        for (index, [left, right]) in frames.iter().enumerate() {
            let at = TAU * index as f64 / n;
            let weight = 0.42 - 0.5 * at.cos() + 0.08 * (2.0 * at).cos();
            let value = 0.5 * f64::from(left + right) * weight / n;
            re += value * (bin as f64 * at).cos();
            im -= value * (bin as f64 * at).sin();
        }
        // Looking at the same again and again: 1 - 0.8^looks of it.
        let smoothed = re.hypot(im) * (1.0 - 0.8_f64.powi(looks));
        (255.0 / 70.0 * (20.0 * smoothed.log10() + 100.0)).floor().clamp(0.0, 255.0) as u8
    }

    #[test]
    fn frequencies_are_those_of_the_definition() {
        let mut frames = tone(0.01, 40.3);
        for (frame, other) in frames.iter_mut().zip(tone(0.002, 200.0)) {
            frame[1] += other[0];
        }
        let mut texture = ShadertoyTexture::new();
        for looks in 1..5 {
            let [row, _] = *texture.look(&frames);
            for bin in [0, 30, 38, 39, 40, 41, 42, 43, 100, 199, 200, 201, 511] {
                let expected = by_definition(&frames, bin, looks);
                let distance = row[bin].abs_diff(expected);
                // Below -100 dB single precision rounds as it likes.
                assert!(
                    distance <= u8::from(expected < 8),
                    "bin {bin}, look {looks}: {}, not {expected}",
                    row[bin]
                );
            }
        }
    }

    #[test]
    fn waveform_and_silence_are_bytes_around_128() {
        let mut texture = ShadertoyTexture::new();
        assert_eq!(*texture.look(&[]), [[0; SHADERTOY_WIDTH], [128; SHADERTOY_WIDTH]]);
        let mut frames = vec![[0.0; 2]; LENGTH];
        frames[..6].copy_from_slice(&[
            [1.0; 2],
            [-1.0; 2],
            [0.5, 0.0],
            [-0.25; 2],
            [f32::NAN, 0.0],
            [9.0; 2],
        ]);
        assert_eq!(texture.look(&frames)[1][..7], [255, 0, 160, 96, 128, 255, 128]);
    }
}
