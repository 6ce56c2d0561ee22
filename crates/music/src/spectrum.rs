//! The power and the stereo image of each frequency, by one complex Fourier transform for both channels.

use std::sync::Arc;

use mariana_transforms::{Complex32, Fft};

use super::StereoFrame;
use super::window::hann;

/// Measures power spectra of stretches of samples. Only `new` allocates memory.
pub(super) struct Spectrum {
    fft: Arc<dyn Fft<f32>>,
    window: Vec<f32>,
    buffer: Vec<Complex32>,
    scratch: Vec<Complex32>,
    power: Vec<f32>,
    scales: Vec<f32>,
}

impl Spectrum {
    /// Creates a spectrum for stretches of `length` frames, an even number. The power of each bin is divided by
    /// `gain`, the power gain of a filter that the samples passed.
    pub(super) fn new(length: usize, gain: impl Fn(usize) -> f64) -> Self {
        let fft = mariana_transforms::forward(length);
        let window = hann(length);
        let squares: f64 = window.iter().map(|&w| f64::from(w).powi(2)).sum();
        Self {
            window,
            buffer: vec![Complex32::default(); length],
            scratch: vec![Complex32::default(); fft.get_inplace_scratch_len()],
            power: vec![0.0; length / 2],
            scales: (0..length / 2).map(|bin| (1.0 / (length as f64 * squares * gain(bin))) as f32).collect(),
            fft,
        }
    }

    /// Transforms a stretch of samples.
    ///
    /// Left and right are the real and the imaginary part of one signal z = l + i·r, so |L(k)|² + |R(k)|² = (|Z(k)|² +
    /// |Z(N-k)|²) / 2: the powers add, and opposite phases do not cancel. (Bin 0 is doubled, but no band uses it.) The
    /// scale divides by N·Σw² (Parseval), so that powers sum correctly: a sine of amplitude a in both channels gives a²
    /// at any frequency, and noise of the same power also gives a². For Hann, the scale is the squared coherent gain
    /// (½)² times the noise bandwidth of 1.5 bins.
    pub(super) fn measure(&mut self, frames: &[StereoFrame]) -> &Self {
        for ((z, &[left, right]), &w) in self.buffer.iter_mut().zip(frames).zip(&self.window) {
            *z = Complex32::new(left * w, right * w);
        }
        self.fft.process_with_scratch(&mut self.buffer, &mut self.scratch);
        let mirrored = self.buffer[1..].iter().rev();
        let bins = self.power.iter_mut().zip(&self.scales);
        for ((power, scale), (z, mirror)) in bins.skip(1).zip(self.buffer[1..].iter().zip(mirrored)) {
            *power = (z.norm_sqr() + mirror.norm_sqr()) * scale;
        }
        self.power[0] = 2.0 * self.buffer[0].norm_sqr() * self.scales[0];
        self
    }

    /// The power in each bin from 0 Hz to just below half the sample rate. Bin k has k · rate / length hertz.
    pub(super) fn power(&self) -> &[f32] {
        &self.power
    }

    /// Returns the weighted sums of 2·(|R|² - |L|²) and of 4·Re(L·R*) over the bins from `first` on, on the scale of
    /// [`Spectrum::power`], which is 2·(|L|² + |R|²).
    ///
    /// Z(k) = L + i·R and Z(N-k)* = L - i·R, so the product Z(k)·Z(N-k) is |L|² - |R|² + 2i·Re(L·R*).
    pub(super) fn stereo(&self, first: usize, weights: &[f32]) -> [f32; 2] {
        let first = first.max(1);
        let (bins, scales) = (self.buffer.iter().skip(first), self.scales.iter().skip(first));
        let mirrored = self.buffer.iter().rev().skip(first - 1);
        let mut sums = [0.0; 2];
        for (((z, mirror), scale), weight) in bins.zip(mirrored).zip(scales).zip(weights) {
            let product = z * mirror * (2.0 * scale * weight);
            sums[0] -= product.re;
            sums[1] += product.im;
        }
        sums
    }
}
