//! Onset detection: the spectral flux and an adaptive threshold.

use super::scale::band_bins;
use super::whitening::{AMPLITUDE_MIN, Band, Whitening};

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

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Rise {
    /// The spectral flux: the weighted mean over groups of the rise of log(1 + 20·level), 0 or more. A group's level is
    /// relative to the loudest recent total amplitude and, in part, to the group's own loudest amplitude. Falling
    /// groups count as 0.
    pub(super) flux: f32,
    /// The weighted mean over groups of each rise relative to the group's mean rise, 0 to [`SUDDEN_MOST`]. In steady
    /// noise groups rise independently, so the value stays near 1. At an onset the groups rise together.
    pub(super) sudden: f32,
}

/// The rises of groups of bins.
struct Groups {
    edges: Vec<usize>,
    /// The weights of the groups, with sum 1.
    weights: Vec<f32>,
    last: [Vec<f32>; LAG],
    bands: Vec<Band>,
    whitening: Whitening,
    /// The maximum rise of a group relative to its mean rise.
    most: f32,
}

impl Groups {
    fn new(edges: Vec<usize>, weight: impl Fn(usize) -> f64, hop_seconds: f64, most: f32) -> Self {
        let count = edges.len() - 1;
        let all: f64 = (0..count).map(&weight).sum();
        Self {
            edges,
            weights: (0..count).map(|group| (weight(group) / all) as f32).collect(),
            last: std::array::from_fn(|_| vec![0.0; count]),
            bands: vec![Band::AT_FIRST; count],
            whitening: Whitening::new(WHITENING, USUAL_MIN, hop_seconds),
            most,
        }
    }

    fn restart(&mut self) {
        self.last.iter_mut().for_each(|last| last.fill(0.0));
        self.bands.fill(Band::AT_FIRST);
    }

    fn power(&self, power: &[f32]) -> f32 {
        let (first, end) = (self.edges.first(), self.edges.last());
        let inside = first.zip(end).and_then(|(first, end)| power.get(*first..*end));
        inside.unwrap_or_default().iter().sum()
    }

    fn follow(&mut self, power: &[f32], all_loudest: f32) -> Rise {
        let mut rise = Rise::default();
        let [oldest, ..] = &mut self.last;
        let groups = self.edges.windows(2).zip(&self.weights).zip(&mut self.bands);
        for (((edges, weight), band), oldest) in groups.zip(oldest) {
            let bins = power.get(edges[0]..edges[1]).unwrap_or_default();
            let height = self.whitening.height(band, bins.iter().sum::<f32>().sqrt(), all_loudest);
            let rises = (height - std::mem::replace(oldest, height)).max(0.0);
            let sudden = self.whitening.sudden(band, rises);
            rise.flux += weight * rises;
            rise.sudden += weight * sudden.min(self.most);
        }
        self.last.rotate_left(1);
        rise
    }
}

/// Measures the rises of all frequencies, in a short window.
pub(super) struct Flux {
    groups: Groups,
    loudest: f32,
}

impl Flux {
    pub(super) fn new(bins: usize, bin_hz: f64, hop_seconds: f64) -> Self {
        let edges = band_bins(GROUPS, bin_hz, bins);
        let weights: Vec<f64> =
            edges.iter().map(|edge| ((*edge).max(1) as f64 * bin_hz).powf(WEIGHT_POWER)).collect();
        Self { groups: Groups::new(edges, |group| weights[group], hop_seconds, SUDDEN_MOST), loudest: 0.0 }
    }

    pub(super) fn restart(&mut self) {
        self.groups.restart();
        self.loudest = 0.0;
    }

    pub(super) fn follow(&mut self, power: &[f32]) -> Rise {
        self.loudest = self.groups.whitening.loudest(self.loudest, self.groups.power(power).sqrt());
        self.groups.follow(power, self.loudest)
    }
}

/// Measures the rises of low frequencies, in a longer window.
pub(super) struct LowFlux(Groups);

impl LowFlux {
    pub(super) fn new(bins: usize, bin_hz: f64, hop_seconds: f64) -> Self {
        let end = ((LOW_HZ / bin_hz).round() as usize).clamp(2, bins.max(2));
        Self(Groups::new((1..=end).collect(), |_| 1.0, hop_seconds, LOW_SUDDEN_MOST))
    }

    pub(super) fn restart(&mut self) {
        self.0.restart();
    }

    /// Returns the mean rise of the bins, relative to each bin's mean rise. `flux` has processed the same moment.
    pub(super) fn follow(&mut self, power: &[f32], flux: &Flux) -> f32 {
        self.0.follow(power, flux.loudest.max(AMPLITUDE_MIN)).sudden
    }
}

/// The threshold of [`Rise::sudden`] is computed from this many past seconds.
const SUDDEN_SECONDS: f64 = 2.4;

/// The largest recent flux is the largest of this many past seconds.
const FLUX_SECONDS: f64 = 1.2;

/// The largest recent flux counts as at least this much, so that weak flux stays weak even after silence.
pub(super) const FLUX_MIN: f32 = 0.05;

/// At an onset, [`Rise::sudden`] exceeds the recent median by this multiple of the distance from the median to the
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
    values: Vec<f32>,
    sorted: Vec<f32>,
    moment: usize,
    taken: usize,
    above: bool,
    /// The factor of the required excess.
    spread: f32,
}

impl Threshold {
    fn new(hop_seconds: f64, spread: f32) -> Self {
        let ring = vec![0.0; (SUDDEN_SECONDS / hop_seconds).ceil() as usize];
        Self { sorted: ring.clone(), values: ring, moment: 0, taken: 0, above: false, spread }
    }

    fn restart(&mut self) {
        self.values.fill(0.0);
        (self.moment, self.taken, self.above) = (0, 0, false);
    }

    /// Returns true if the value exceeds the threshold, and the previous value did not.
    fn follow(&mut self, value: f32) -> bool {
        let place = self.moment % self.values.len();
        self.values[place] = value;
        self.moment = self.moment.wrapping_add(1);
        self.taken = (self.taken + 1).min(self.values.len());
        let above = value > self.threshold();
        let was_above = std::mem::replace(&mut self.above, above);
        above && !was_above
    }

    fn threshold(&mut self) -> f32 {
        // Until the ring is full, only its first entries are used. These entries include some silence before the first
        // moment, so that a sound at the start of the stream is an onset.
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

/// Detects onsets: rises of all frequencies, or of low frequencies alone.
pub(super) struct Onsets {
    all: Threshold,
    low: Threshold,
    flux: Vec<f32>,
    moment: usize,
    apart: u32,
    since: u32,
}

impl Onsets {
    pub(super) fn new(hop_seconds: f64) -> Self {
        let apart = (ONSETS_APART / hop_seconds).round() as u32;
        Self {
            all: Threshold::new(hop_seconds, 1.0),
            low: Threshold::new(hop_seconds, LOW_SPREAD),
            flux: vec![0.0; (FLUX_SECONDS / hop_seconds).ceil() as usize],
            moment: 0,
            apart,
            since: apart,
        }
    }

    pub(super) fn restart(&mut self) {
        self.all.restart();
        self.low.restart();
        self.flux.fill(0.0);
        (self.moment, self.since) = (0, self.apart);
    }

    /// Returns true at an onset, and the moment's flux relative to the largest recent flux, 0..1. `low` is the sudden
    /// rise of [`LowFlux`].
    pub(super) fn follow(&mut self, rise: Rise, low: f32) -> (bool, f32) {
        let place = self.moment % self.flux.len();
        self.flux[place] = rise.flux;
        self.moment = self.moment.wrapping_add(1);
        let [of_all, of_low] = [self.all.follow(rise.sudden), self.low.follow(low)];
        self.since = self.since.saturating_add(1);
        let begins = (of_all || of_low) && self.since >= self.apart;
        if begins {
            self.since = 0;
        }
        let strongest = self.flux.iter().fold(FLUX_MIN, |largest, flux| largest.max(*flux));
        (begins, (rise.flux / strongest).min(1.0))
    }
}
