//! The frequency of the strongest tone, finer than a bin.

use super::resolution::Resolution;

/// Lines below this power (-80 dB) are not tones.
const POWER_MIN: f32 = 1e-8;

/// In hertz: below the second frequency tones are sought in the long window, above the first in the middle one.
const BORDER_HZ: (f64, f64) = (400.0, 500.0);

/// A tone between two bins has this much less power at its peak than at a bin (Hann: 1.42 dB).
const SCALLOPING: f32 = 1.387;

/// A line: its place in bins, and its power at the largest bin.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Line {
    bin: f32,
    power: f32,
}

/// The frequency of the strongest tone in hertz, from the power per bin of the long and the middle window, each
/// [`Resolution::hops`] times `hop` frames long; 0 if no tone is loud enough.
pub(super) fn strongest_hz([long, middle]: [&[f32]; 2], sample_rate: f64, hop: usize) -> f32 {
    let bin_hz = |resolution: Resolution| sample_rate / (hop * resolution.hops()) as f64;
    let (long_hz, middle_hz) = (bin_hz(Resolution::Long), bin_hz(Resolution::Middle));
    // The first bins hold the constant offset.
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

/// The strongest line among the bins from `first` up to `end`, of a Hann window's power.
///
/// The ratio of the peak's magnitude to that of its larger neighbour, alpha = |X(k±1)| / |X(k)|, says how far a tone
/// lies towards that neighbour: (2·alpha - 1) / (alpha + 1) bins. For Hann this is exact except for what other tones,
/// including the mirrored one, leak (Jain, Collins and Davis 1979; Grandke 1983).
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
