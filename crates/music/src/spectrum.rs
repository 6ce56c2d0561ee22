//! The power and the stereo image of each frequency, by one complex Fourier transform for both channels.

use std::sync::Arc;

use mariana_transforms::{Complex32, Fft};

use super::StereoFrame;
use super::decimate::Decimator;

/// Measures power spectra of stretches of samples. Only `new` allocates memory.
pub(super) struct Spectrum {
    fft: Arc<dyn Fft<f32>>,
    window: Vec<f32>,
    buffer: Vec<Complex32>,
    scratch: Vec<Complex32>,
    pub(super) power: Vec<f32>,
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

// The window function for Fourier transforms.

/// Returns the periodic Hann window, `length` weights 0..1: w(n) = ½ - ½·cos(2πn / length). The window's peak is at
/// `length / 2`, and its equivalent noise bandwidth is 1.5 bins (Harris 1978, table 1).
pub(super) fn hann(length: usize) -> Vec<f32> {
    let step = std::f64::consts::TAU / length as f64;
    (0..length).map(|n| (0.5 - 0.5 * (step * n as f64).cos()) as f32).collect()
}

// A long window at a lower sample rate, for low frequencies.

pub(super) struct SlowWindow {
    kept: Vec<StereoFrame>,
    decimator: Decimator,
    spectrum: Spectrum,
}

impl SlowWindow {
    /// Creates a window of `length` decimated frames. The power of each bin is divided by its `gain`.
    pub(super) fn new(decimator: Decimator, length: usize, gain: impl Fn(usize, &Decimator) -> f64) -> Self {
        let spectrum = Spectrum::new(length, |bin| gain(bin, &decimator));
        Self { kept: vec![[0.0; 2]; length], decimator, spectrum }
    }

    /// Advances the window by `count` frames. Afterwards the window ends at the newest of `frames`.
    pub(super) fn follow(&mut self, frames: &[StereoFrame], count: usize) {
        let new = count / self.decimator.step;
        self.kept.copy_within(new.., 0);
        let start = self.kept.len() - new;
        self.decimator.keep(frames, &mut self.kept[start..]);
    }

    pub(super) fn spectrum(&mut self) -> &Spectrum {
        self.spectrum.measure(&self.kept)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hann_has_its_known_gain_and_noise_bandwidth() {
        let window = hann(4096);
        let sum: f64 = window.iter().map(|&w| f64::from(w)).sum();
        let squares: f64 = window.iter().map(|&w| f64::from(w).powi(2)).sum();
        let noise_bandwidth = 4096.0 * squares / (sum * sum);
        assert!((sum / 4096.0 - 0.5).abs() < 1e-6, "coherent gain {}", sum / 4096.0);
        assert!((noise_bandwidth - 1.5).abs() < 1e-6, "noise bandwidth {noise_bandwidth} bins");
        assert_eq!(window[2048], 1.0);
        assert_eq!(window[0], 0.0);
    }
}
