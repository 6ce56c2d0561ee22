//! The frequency of the strongest tone, with a resolution finer than a bin.

use super::resolution::Resolution;

/// Peaks below this power (-80 dB) are not tones.
const POWER_MIN: f32 = 1e-8;

/// The middle window is searched above the first frequency, the long window below the second, in hertz.
const BORDER_HZ: (f64, f64) = (400.0, 500.0);

/// The largest loss of peak power if a tone is between two bins, as a factor (Hann: 1.42 dB).
const SCALLOPING: f32 = 1.387;

#[derive(Clone, Copy, Debug, PartialEq)]
struct Line {
    bin: f32,
    power: f32,
}

/// Returns the frequency of the strongest tone in hertz, or 0 if no tone is loud enough. The spectra belong to the long
/// and the middle window, whose lengths are [`Resolution::hops`] times `hop` frames.
pub(super) fn strongest_hz([long, middle]: [&[f32]; 2], sample_rate: f64, hop: usize) -> f32 {
    let bin_hz = |resolution: Resolution| sample_rate / (hop * resolution.hops()) as f64;
    let (long_hz, middle_hz) = (bin_hz(Resolution::Long), bin_hz(Resolution::Middle));
    // The first bins contain the DC offset.
    let low = strongest_line(long, 2, (BORDER_HZ.1 / long_hz) as usize);
    let high = strongest_line(middle, (BORDER_HZ.0 / middle_hz) as usize, middle.len());
    match (low, high) {
        (Some(low), high) if high.is_none_or(|high| SCALLOPING * low.power >= high.power) => {
            low.bin * long_hz as f32
        }
        (_, Some(high)) => high.bin * middle_hz as f32,
        _ => 0.0,
    }
}

/// Finds the strongest peak among the bins from `first` up to `end` of a Hann window's power spectrum. Let alpha =
/// |X(k±1)| / |X(k)| be the ratio of the larger neighbour's magnitude to the peak's magnitude. Then the tone is
/// (2·alpha - 1) / (alpha + 1) bins from the peak towards this neighbour. For Hann this is exact except for leakage
/// from other tones, including the tone's mirror image (Jain, Collins and Davis 1979; Grandke 1983).
fn strongest_line(power: &[f32], first: usize, end: usize) -> Option<Line> {
    let end = end.min(power.len().saturating_sub(1));
    let inner = power.get(first..end)?;
    let largest = inner.iter().fold(POWER_MIN, |largest, power| largest.max(*power));
    let peak = first + inner.iter().position(|power| *power >= largest && *power > POWER_MIN)?;
    let (below, here, above) = (*power.get(peak.checked_sub(1)?)?, *power.get(peak)?, *power.get(peak + 1)?);
    let alpha = (below.max(above) / here).sqrt();
    let towards = ((2.0 * alpha - 1.0) / (alpha + 1.0)).clamp(0.0, 0.5);
    Some(Line { bin: peak as f32 + if above > below { towards } else { -towards }, power: here })
}
