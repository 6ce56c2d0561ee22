//! The tones of a moment: peaks of the spectrum, one amplitude for each semitone.

use crate::resolution::Resolution;
use crate::scale::NOTE_COUNT;

/// The number of semitones from A0 on, including two octaves for the partials of the highest notes.
pub(super) const PLACES: usize = NOTE_COUNT + 24;

/// The long window is used below this frequency, in hertz, and the middle window above it.
const BORDER_HZ: f64 = 1_200.0;

/// Peaks below this power (-80 dB) are not tones.
const POWER_MIN: f32 = 1e-8;

/// The minimum power of a peak relative to the mean power of the bins around it. Noise and drums have few such peaks.
const PEAK_OVER_MEAN: f32 = 2.5;
/// The mean around a peak is taken over this many bins on each side.
const AROUND: usize = 7;

/// The factor from a peak's power to the squared amplitude of its tone: Hann's noise bandwidth of 1.5 bins.
const NOISE_BANDWIDTH: f32 = 1.5;

pub(super) struct Peaks {
    /// Hertz per bin, first bin and end of the long and of the middle window.
    windows: [(f64, usize, usize); 2],
    /// The deviation of the peak of each semitone, in semitones.
    fine: [f32; PLACES],
}

impl Peaks {
    pub(super) fn new(hop: usize, rate: f64) -> Self {
        let bin_hz = |resolution: Resolution| rate / (hop * resolution.hops()) as f64;
        let (long, middle) = (bin_hz(Resolution::Long), bin_hz(Resolution::Middle));
        let end = (27.5 * (PLACES as f64 / 12.0).exp2() / middle) as usize;
        let border = |bin_hz: f64| (BORDER_HZ / bin_hz).round() as usize;
        Self { windows: [(long, 4, border(long)), (middle, border(middle), end)], fine: [0.0; PLACES] }
    }

    /// The deviation of the last peak at a semitone, -0.5..0.5.
    pub(super) fn fine(&self, semitone: usize) -> f32 {
        self.fine.get(semitone).copied().unwrap_or_default()
    }

    /// Returns the square root of the amplitude of the strongest peak at each semitone; 0 without a peak. The frequency
    /// of a peak is the vertex of a parabola through the logarithms of three bins (Smith and Serra 1987).
    pub(super) fn amplitudes(&mut self, long: &[f32], middle: &[f32]) -> [f32; PLACES] {
        let mut found = [0.0; PLACES];
        for ((bin_hz, first, end), power) in self.windows.into_iter().zip([long, middle]) {
            for (three, bin) in power.windows(3).zip(1..end).skip(first.saturating_sub(1)) {
                let [left, here, right] = [three[0], three[1], three[2]];
                if here < POWER_MIN || here < left || here <= right {
                    continue;
                }
                let around = &power[bin.saturating_sub(AROUND)..(bin + AROUND + 1).min(power.len())];
                if here * (around.len() as f32) < PEAK_OVER_MEAN * around.iter().sum::<f32>() {
                    continue;
                }
                let [l, h, r] = [left, here, right].map(|power| power.max(1e-20).ln());
                let bend = l - 2.0 * h + r;
                let offset = if bend < 0.0 { (0.5 * (l - r) / bend).clamp(-0.5, 0.5) } else { 0.0 };
                let semitones = 12.0 * ((bin as f64 + f64::from(offset)) * bin_hz / 27.5).log2();
                let place = semitones.round();
                if place < 0.0 {
                    continue;
                }
                let Some(amplitude) = found.get_mut(place as usize) else { break };
                let root = (NOISE_BANDWIDTH * here).powf(0.25);
                if root > *amplitude {
                    *amplitude = root;
                    self.fine[place as usize] = (semitones - place) as f32;
                }
            }
        }
        found
    }
}
