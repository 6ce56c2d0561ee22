//! The sudden rises of frequency bands.

use std::ops::Range;

use crate::whitening::{Band, Whitening};

/// The edges of the low bands, in hertz, which the middle window measures. They separate kicks, toms and snares.
const LOW_EDGES: [f64; LOW + 1] = [28.0, 65.0, 105.0, 150.0, 210.0, 300.0];
/// The edges of the high bands, in hertz, which the short window measures.
const HIGH_EDGES: [f64; HIGH + 1] =
    [300.0, 500.0, 800.0, 1_300.0, 2_100.0, 3_400.0, 5_400.0, 8_500.0, 16_000.0];

pub(super) const LOW: usize = 5;
const HIGH: usize = 8;
pub(super) const BANDS: usize = LOW + HIGH;

/// The strength of the whitening ([`Whitening`]).
const WHITENING: f32 = 0.6;

/// The distance between the two compared moments, in hops, for the middle and the short window.
const LAGS: [usize; 2] = [3, 2];

/// The height of a band is compared with its height this many hops ago, before the stroke.
pub(super) const BEFORE: usize = 5;

/// A band's mean rise counts as at least this much.
const USUAL_MIN: f32 = 0.1;
/// The maximum rise relative to the mean rise.
const SUDDEN_MOST: f32 = 8.0;
/// The measurements of the bands at a moment.
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
    bands: [Band; BANDS],
    loudest: f32,
    whitening: Whitening,
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
            bands: [Band::AT_FIRST; BANDS],
            loudest: 0.0,
            whitening: Whitening::new(WHITENING, USUAL_MIN, hop_seconds),
        }
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
        self.loudest = self.whitening.loudest(self.loudest, powers.iter().sum::<f32>().sqrt());
        let mut measured = Measured { before: self.last[BEFORE - 1], ..Measured::default() };
        for (band, power) in powers.into_iter().enumerate() {
            let height = self.whitening.height(&mut self.bands[band], power.sqrt(), self.loudest);
            let lag = LAGS[usize::from(band >= LOW)];
            let rise = (height - self.last[lag - 1][band]).max(0.0);
            let sudden = self.whitening.sudden(&mut self.bands[band], rise);
            measured.sudden[band] = sudden.min(SUDDEN_MOST).sqrt();
            measured.height[band] = height;
        }
        self.last.rotate_right(1);
        self.last[0] = measured.height;
        measured
    }
}
