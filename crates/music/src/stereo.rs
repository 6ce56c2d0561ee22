//! The stereo image of each band: its position between the channels, and its width.
//!
//! The sums of |L|² + |R|², |R|² - |L|² and 2·Re(L·R*) over a band are three of the Stokes parameters of the pair of
//! channels. They give the level difference and the correlation of the channels, the cues of parametric stereo
//! (Breebaart et al. 2005). The real part of the correlation counts, so that opposite channels are wide. Each sum is
//! averaged over time before the division: a loud sound sets the image at once, and the phases of noise cancel.

use super::scale::BAND_COUNT;

/// Below this power (-90 dB), pan and width fall to 0.
const POWER_MIN: f32 = 1e-9;
/// Smaller averages count as 0. Decaying sums would become subnormal numbers, which are slow.
const SILENT: f32 = 1e-20;

pub(super) struct StereoImage {
    kept: f32,
    /// The averages of |L|² + |R|², |R|² - |L|² and 2·Re(L·R*), all times 2.
    sums: [[f32; 3]; BAND_COUNT],
}

impl StereoImage {
    /// Creates an image whose sums are averaged with the time constant `seconds`.
    pub(super) fn new(seconds: f64, hop_seconds: f64) -> Self {
        Self { kept: (-hop_seconds / seconds).exp() as f32, sums: [[0.0; 3]; BAND_COUNT] }
    }

    /// Processes a moment. Returns the pan, -1..1, and the width, 0..1, of each band.
    pub(super) fn follow(
        &mut self,
        powers: &[f32; BAND_COUNT],
        stereo: &[[f32; 2]; BAND_COUNT],
    ) -> [[f32; BAND_COUNT]; 2] {
        let (mut pans, mut widths) = ([0.0; BAND_COUNT], [0.0; BAND_COUNT]);
        for ((sums, (power, [difference, common])), (pan, width)) in
            self.sums.iter_mut().zip(powers.iter().zip(stereo)).zip(pans.iter_mut().zip(&mut widths))
        {
            for (sum, value) in sums.iter_mut().zip([power, difference, common]) {
                *sum = value + self.kept * (*sum - value);
            }
            if sums[0] < SILENT {
                *sums = [0.0; 3];
            }
            let [power, difference, common] = *sums;
            let most = power.max(POWER_MIN);
            *pan = (difference / most).clamp(-1.0, 1.0);
            // 2·√(|L|²·|R|²) - 2·Re(L·R*): 0 for one sound at any pan, also if one channel is silent.
            let apart = (power * power - difference * difference).max(0.0).sqrt() - common;
            *width = (apart / most).clamp(0.0, 1.0);
        }
        [pans, widths]
    }
}
