//! Onset detection: the spectral flux and an adaptive threshold.

use super::scale::band_bins;
use super::whitening::{Band, Whitening};

/// The number of bin groups, in equal ratios from 30 Hz to 16 kHz.
const GROUPS: usize = 30;

/// The strength of the whitening ([`Whitening`]).
const WHITENING: f32 = 0.4;

/// The distance between the two compared spectra, in hops. At this distance their windows do not overlap.
const LAG: usize = 2;

/// The exponent of the frequency in the groups' weights. Low groups weigh more: drums and basses carry the beat.
const WEIGHT_POWER: f64 = -0.2;

/// A group's mean rise counts as at least this much.
const USUAL_MIN: f32 = 0.05;

/// The maximum rise of a group relative to its mean rise, so that a rise of one group alone is no onset.
const SUDDEN_MOST: f32 = 8.0;
/// The same maximum for low onsets, which are rises of few bins.
const LOW_SUDDEN_MOST: f32 = 24.0;

/// Low onsets are detected in each bin of a longer window up to this frequency, in hertz. There, a kick is separate
/// from the chord above it, and the chord's other groups do not hide its rise.
const LOW_HZ: f64 = 200.0;

/// The rises of groups of bins, each relative to the group's mean rise.
struct Groups {
    edges: Vec<usize>,
    /// The weights of the groups, with sum 1.
    weights: Vec<f32>,
    last: [Vec<f32>; LAG],
    bands: Vec<Band>,
    whitening: Whitening,
    /// The maximum rise of a group relative to its mean rise.
    most: f32,
    threshold: Threshold,
}

impl Groups {
    /// `weight` returns the weight of a group by its first bin.
    fn new(
        edges: Vec<usize>,
        weight: impl Fn(usize) -> f64,
        hop_seconds: f64,
        most: f32,
        spread: f32,
    ) -> Self {
        let count = edges.len() - 1;
        let weights: Vec<f64> = edges[..count].iter().map(|edge| weight(*edge)).collect();
        let all: f64 = weights.iter().sum();
        Self {
            edges,
            weights: weights.into_iter().map(|weight| (weight / all) as f32).collect(),
            last: std::array::from_fn(|_| vec![0.0; count]),
            bands: vec![Band::AT_FIRST; count],
            whitening: Whitening::new(WHITENING, USUAL_MIN, hop_seconds),
            most,
            threshold: Threshold::new(hop_seconds, spread),
        }
    }

    fn restart(&mut self) {
        self.last.iter_mut().for_each(|last| last.fill(0.0));
        self.bands.fill(Band::AT_FIRST);
        self.threshold.restart();
    }

    /// Returns the spectral flux, and true if the rise is sudden and was not.
    ///
    /// The flux is the weighted mean over groups of the rise of log(1 + 20·level), 0 or more. A group's level is relative
    /// to the loudest recent total amplitude and, in part, to the group's own loudest amplitude. Falling groups count as
    /// 0. The suddenness is the weighted mean over groups of each rise relative to the group's mean rise. In steady noise
    /// groups rise independently, so the suddenness stays near 1. At an onset the groups rise together.
    fn follow(&mut self, power: &[f32], all_loudest: f32) -> (f32, bool) {
        let (mut flux, mut sudden) = (0.0, 0.0);
        let [oldest, ..] = &mut self.last;
        let groups = self.edges.windows(2).zip(&self.weights).zip(&mut self.bands);
        for (((edges, weight), band), oldest) in groups.zip(oldest) {
            let bins = power.get(edges[0]..edges[1]).unwrap_or_default();
            let height = self.whitening.height(band, bins.iter().sum::<f32>().sqrt(), all_loudest);
            let rises = (height - std::mem::replace(oldest, height)).max(0.0);
            flux += weight * rises;
            sudden += weight * self.whitening.sudden(band, rises).min(self.most);
        }
        self.last.rotate_left(1);
        (flux, self.threshold.follow(sudden))
    }
}

/// The threshold of the suddenness is computed from this many past seconds.
const SUDDEN_SECONDS: f64 = 2.4;

/// The largest recent flux is the largest of this many past seconds.
const FLUX_SECONDS: f64 = 1.2;

/// The largest recent flux counts as at least this much, so that weak flux stays weak even after silence.
pub(super) const FLUX_MIN: f32 = 0.05;

/// At an onset, the suddenness exceeds the recent median by this multiple of the distance from the median to the
/// lower quartile. Noise does not reach this excess.
const SUDDEN_SPREADS: f32 = 11.0;
/// The required excess is clamped to this range, because the values spread less in noise than in dense music.
const SUDDEN_ABOVE: (f32, f32) = (0.6, 1.45);
/// The required excess is at least this fraction of the distance from the median to the largest value.
const SUDDEN_FRACTION: f32 = 0.25;

/// The number of silent moments assumed before the first moment.
const SILENT_BEFORE: usize = 16;

/// The minimum distance between two onsets, in seconds.
const ONSETS_APART: f64 = 0.05;

/// Low onsets exceed the threshold by this much more, because few bins vary more than many.
const LOW_SPREAD: f32 = 2.5;

/// An adaptive threshold, without lookahead.
struct Threshold {
    /// The newest value is first.
    values: Vec<f32>,
    sorted: Vec<f32>,
    taken: usize,
    above: bool,
    /// The factor of the required excess.
    spread: f32,
}

impl Threshold {
    fn new(hop_seconds: f64, spread: f32) -> Self {
        let values = vec![0.0; (SUDDEN_SECONDS / hop_seconds).ceil() as usize];
        Self { sorted: values.clone(), values, taken: 0, above: false, spread }
    }

    fn restart(&mut self) {
        self.values.fill(0.0);
        (self.taken, self.above) = (0, false);
    }

    /// Returns true if the value exceeds the threshold, and the previous value did not.
    fn follow(&mut self, value: f32) -> bool {
        self.values.rotate_right(1);
        self.values[0] = value;
        self.taken = (self.taken + 1).min(self.values.len());
        let above = value > self.threshold();
        let was_above = std::mem::replace(&mut self.above, above);
        above && !was_above
    }

    fn threshold(&mut self) -> f32 {
        // At first only a few values are used. They include some silence before the first moment, so that a sound at the
        // start of the stream is an onset.
        let count = self.taken.max(SILENT_BEFORE).min(self.values.len());
        let sorted = &mut self.sorted[..count];
        sorted.copy_from_slice(&self.values[..count]);
        let largest = sorted.iter().fold(0.0_f32, |largest, sudden| largest.max(*sudden));
        let half = sorted.len() / 2;
        let (lower, median, _) = sorted.select_nth_unstable_by(half, f32::total_cmp);
        let median = *median;
        let quarter = lower.len() / 2;
        let quartile = match lower.get(quarter) {
            Some(_) => *lower.select_nth_unstable_by(quarter, f32::total_cmp).1,
            None => median,
        };
        let above = (SUDDEN_SPREADS * (median - quartile)).clamp(SUDDEN_ABOVE.0, SUDDEN_ABOVE.1);
        median + (self.spread * above).max(SUDDEN_FRACTION * (largest - median))
    }
}

/// The onsets and the flux of a moment.
pub(super) struct Onset {
    pub(super) begins: bool,
    pub(super) flux: f32,
    /// The flux relative to the largest recent flux, 0..1.
    pub(super) relative_flux: f32,
}

/// Detects onsets: rises of all frequencies, in a short window, or of low frequencies alone, in a longer window.
pub(super) struct Onsets {
    all: Groups,
    low: Groups,
    /// The loudest recent amplitude of all frequencies.
    loudest: f32,
    /// The recent fluxes, the newest first.
    fluxes: Vec<f32>,
    apart: u32,
    since: u32,
}

impl Onsets {
    /// Creates a detector for a short window with `bins` bins of `bin_hz` hertz, and a window of twice its length.
    pub(super) fn new(bins: usize, bin_hz: f64, hop_seconds: f64) -> Self {
        let weight = |edge: usize| (edge.max(1) as f64 * bin_hz).powf(WEIGHT_POWER);
        let low_end = ((LOW_HZ / (0.5 * bin_hz)).round() as usize).clamp(2, (2 * bins).max(2));
        let apart = (ONSETS_APART / hop_seconds).round() as u32;
        Self {
            all: Groups::new(band_bins(GROUPS, bin_hz, bins), weight, hop_seconds, SUDDEN_MOST, 1.0),
            low: Groups::new((1..=low_end).collect(), |_| 1.0, hop_seconds, LOW_SUDDEN_MOST, LOW_SPREAD),
            loudest: 0.0,
            fluxes: vec![0.0; (FLUX_SECONDS / hop_seconds).ceil() as usize],
            apart,
            since: apart,
        }
    }

    pub(super) fn restart(&mut self) {
        self.all.restart();
        self.low.restart();
        self.fluxes.fill(0.0);
        (self.loudest, self.since) = (0.0, self.apart);
    }

    /// Processes the spectrum of the short window and, to detect low onsets, the longer window's spectrum.
    pub(super) fn follow(&mut self, short: &[f32], middle: Option<&[f32]>) -> Onset {
        let power =
            short.get(self.all.edges[0]..self.all.edges[GROUPS]).unwrap_or_default().iter().sum::<f32>();
        self.loudest = self.all.whitening.loudest(self.loudest, power.sqrt());
        let (flux, of_all) = self.all.follow(short, self.loudest);
        let of_low = middle.is_some_and(|middle| self.low.follow(middle, self.loudest).1);
        self.fluxes.rotate_right(1);
        self.fluxes[0] = flux;
        self.since = self.since.saturating_add(1);
        let begins = (of_all || of_low) && self.since >= self.apart;
        if begins {
            self.since = 0;
        }
        let strongest = self.fluxes.iter().fold(FLUX_MIN, |largest, flux| largest.max(*flux));
        Onset { begins, flux, relative_flux: (flux / strongest).min(1.0) }
    }
}
