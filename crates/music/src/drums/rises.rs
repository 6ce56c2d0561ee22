//! The sudden rises of frequency bands.

use std::ops::Range;

/// The edges of the low bands, in hertz, which the middle window measures. They separate kicks, toms and snares.
const LOW_EDGES: [f64; LOW + 1] = [28.0, 65.0, 105.0, 150.0, 210.0, 300.0];
/// The edges of the high bands, in hertz, which the short window measures.
const HIGH_EDGES: [f64; HIGH + 1] =
    [300.0, 500.0, 800.0, 1_300.0, 2_100.0, 3_400.0, 5_400.0, 8_500.0, 16_000.0];

pub(super) const LOW: usize = 5;
const HIGH: usize = 8;
pub(super) const BANDS: usize = LOW + HIGH;

/// Strength of the logarithmic compression of a band's level: log(1 + `COMPRESSION` · level).
const COMPRESSION: f32 = 20.0;

/// Amplitudes below this (-70 dB) are too weak for a stroke.
const AMPLITUDE_MIN: f32 = 3e-4;

/// The strength of the adaptive whitening (Stowell and Plumbley 2007): 1 scales each band by its loudest recent
/// amplitude, 0 scales no band.
const WHITENING: f32 = 0.6;

/// Time constant of the decay of the loudest amplitudes, in seconds.
const LOUDEST_SECONDS: f64 = 4.0;

/// A band's loudest amplitude counts as at least this fraction of the total amplitude (-50 dB).
const BAND_MIN: f32 = 3e-3;

/// The distance between the two compared moments, in hops, for the middle and the short window.
const LAGS: [usize; 2] = [3, 2];

/// The height of a band is compared with its height this many hops ago, before the stroke.
pub(super) const BEFORE: usize = 5;

/// Time constant of the mean rise of a band, in seconds.
const USUAL_SECONDS: f64 = 2.0;
/// A band's mean rise counts as at least this much.
const USUAL_MIN: f32 = 0.1;
/// The initial mean rise. Noise has about this mean rise.
const USUAL_AT_FIRST: f32 = 0.2;
/// The maximum rise relative to the mean rise.
const SUDDEN_MOST: f32 = 8.0;
/// The maximum rise that enters a band's mean, relative to the mean, so that strokes do not raise the mean much.
const TEACHES_MOST: f32 = 3.0;

/// What is measured of each band at a moment.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Measured {
    /// The square root of the rise relative to the mean rise, 0..2.8.
    pub(super) sudden: [f32; BANDS],
    /// The compressed level.
    pub(super) height: [f32; BANDS],
    /// The compressed level [`BEFORE`] hops ago.
    pub(super) before: [f32; BANDS],
}

/// Measures how suddenly the level of each band rises.
pub(super) struct BandRises {
    ranges: [Range<usize>; BANDS],
    /// The heights of the last moments, the newest first.
    last: [[f32; BANDS]; BEFORE],
    loudest_of: [f32; BANDS],
    loudest: f32,
    usual: [f32; BANDS],
    kept: f32,
    learned: f32,
}

impl BandRises {
    /// Creates bands for a short window with `bins` bins of `bin_hz` hertz, and a middle window of twice its length.
    pub(super) fn new(bins: usize, bin_hz: f64, hop_seconds: f64) -> Self {
        let range = |edges: &[f64], bins: usize, bin_hz: f64| {
            let bin = |hz: f64| (hz / bin_hz).round() as usize;
            // A band above half the sample rate is empty. A band that the rate cuts off would be mostly silence.
            if edges[0] >= 0.7 * bins as f64 * bin_hz {
                0..0
            } else {
                bin(edges[0]).max(1)..bin(edges[1]).min(bins)
            }
        };
        Self {
            ranges: std::array::from_fn(|band| match LOW_EDGES.get(band..band + 2) {
                Some(edges) => range(edges, 2 * bins, 0.5 * bin_hz),
                None => range(&HIGH_EDGES[band - LOW..], bins, bin_hz),
            }),
            last: Default::default(),
            loudest_of: [0.0; BANDS],
            loudest: 0.0,
            usual: [USUAL_AT_FIRST; BANDS],
            kept: (-hop_seconds / LOUDEST_SECONDS).exp() as f32,
            learned: (hop_seconds / USUAL_SECONDS) as f32,
        }
    }

    pub(super) fn restart(&mut self) {
        self.last = Default::default();
        (self.loudest_of, self.loudest) = ([0.0; BANDS], 0.0);
        self.usual = [USUAL_AT_FIRST; BANDS];
    }

    /// Returns the power of each band.
    pub(super) fn powers(&self, middle: &[f32], short: &[f32]) -> [f32; BANDS] {
        std::array::from_fn(|band| {
            let spectrum = if band < LOW { middle } else { short };
            spectrum.get(self.ranges[band].clone()).unwrap_or_default().iter().sum()
        })
    }

    /// Measures the bands from the powers of [`BandRises::powers`].
    pub(super) fn follow(&mut self, powers: [f32; BANDS]) -> Measured {
        let all = powers.iter().sum::<f32>().sqrt();
        self.loudest = all.max(self.loudest * self.kept).max(AMPLITUDE_MIN);
        let mut measured = Measured { before: self.last[BEFORE - 1], ..Measured::default() };
        for (band, power) in powers.into_iter().enumerate() {
            let amplitude = power.sqrt();
            let loudest = &mut self.loudest_of[band];
            *loudest = amplitude.max(*loudest * self.kept);
            let of_band = (*loudest / self.loudest).clamp(BAND_MIN, 1.0);
            let level = amplitude / self.loudest / of_band.powf(WHITENING);
            let height = (1.0 + COMPRESSION * level).ln();
            let lag = LAGS[usize::from(band >= LOW)];
            let rise = (height - self.last[lag - 1][band]).max(0.0);
            let usual = &mut self.usual[band];
            measured.sudden[band] = (rise / (USUAL_MIN + *usual)).min(SUDDEN_MOST).sqrt();
            measured.height[band] = height;
            *usual += self.learned * (rise.min(TEACHES_MOST * (USUAL_MIN + *usual)) - *usual);
        }
        self.last.rotate_right(1);
        self.last[0] = measured.height;
        measured
    }
}
