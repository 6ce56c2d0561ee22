//! Onset detection: the spectral flux and an adaptive threshold.

use super::scale::{BAND_HIGHEST_HZ, BAND_LOWEST_HZ};

/// The number of bin groups, in equal ratios from 30 Hz to 16 kHz.
const GROUPS: usize = 30;

/// Strength of the logarithmic compression of a group's level: log(1 + `COMPRESSION` · level).
const COMPRESSION: f32 = 20.0;

/// Amplitudes below this (-70 dB) are too weak for an onset.
const AMPLITUDE_MIN: f32 = 3e-4;

/// The strength of the adaptive whitening (Stowell and Plumbley 2007). At 1 each group is scaled by its loudest recent
/// amplitude; at 0 no group is scaled. Whitening makes quiet changes detectable while other groups play a loud chord.
const WHITENING: f32 = 0.4;

/// Time constant of the decay of the loudest amplitudes, in seconds.
const LOUDEST_SECONDS: f64 = 4.0;

/// A group's loudest amplitude counts as at least this fraction of the total amplitude (-50 dB).
const GROUP_MIN: f32 = 3e-3;

/// The distance between the two compared spectra, in hops. At this distance their windows do not overlap.
const LAG: usize = 2;

/// The exponent of the frequency in the groups' weights. Low groups weigh more: drums and basses carry the beat.
const WEIGHT_POWER: f64 = -0.2;

/// Time constant of the mean rise of a group, in seconds.
const USUAL_SECONDS: f64 = 2.0;

/// A group's mean rise counts as at least this much.
const USUAL_MIN: f32 = 0.05;

/// The initial mean rise. Noise has about this mean rise.
const USUAL_AT_FIRST: f32 = 0.2;

/// The maximum rise of a group relative to its mean rise, so that a rise of one group alone is no onset.
const SUDDEN_MOST: f32 = 8.0;

/// The maximum rise that enters a group's mean, relative to the mean, so that onsets do not raise the mean much.
const TEACHES_MOST: f32 = 3.0;

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

pub(super) struct Flux {
    edges: [usize; GROUPS + 1],
    /// The weights of the groups, with sum 1.
    weights: [f32; GROUPS],
    last: [[f32; GROUPS]; LAG],
    loudest: f32,
    loudest_of: [f32; GROUPS],
    usual: [f32; GROUPS],
    /// The fraction of the loudest amplitude that is left after a hop.
    kept: f32,
    learned: f32,
}

impl Flux {
    pub(super) fn new(bins: usize, bin_hz: f64, hop_seconds: f64) -> Self {
        let hz = |group: f64| BAND_LOWEST_HZ * (BAND_HIGHEST_HZ / BAND_LOWEST_HZ).powf(group / GROUPS as f64);
        let mut edges = [0; GROUPS + 1];
        let mut least = 1;
        for (group, edge) in edges.iter_mut().enumerate() {
            // Each group has at least one bin, so the edges of the low groups are higher than equal ratios would give.
            *edge = ((hz(group as f64) / bin_hz).round() as usize).max(least).min(bins);
            least = *edge + 1;
        }
        let weight = |group: usize| (edges[group].max(1) as f64 * bin_hz).powf(WEIGHT_POWER);
        let all: f64 = (0..GROUPS).map(weight).sum();
        Self {
            edges,
            weights: std::array::from_fn(|group| (weight(group) / all) as f32),
            last: [[0.0; GROUPS]; LAG],
            loudest: 0.0,
            loudest_of: [0.0; GROUPS],
            usual: [USUAL_AT_FIRST; GROUPS],
            kept: (-hop_seconds / LOUDEST_SECONDS).exp() as f32,
            learned: (hop_seconds / USUAL_SECONDS) as f32,
        }
    }

    pub(super) fn restart(&mut self) {
        self.last = [[0.0; GROUPS]; LAG];
        self.loudest = 0.0;
        self.loudest_of = [0.0; GROUPS];
        self.usual = [USUAL_AT_FIRST; GROUPS];
    }

    pub(super) fn follow(&mut self, power: &[f32]) -> Rise {
        let amplitudes: [f32; GROUPS] = std::array::from_fn(|group| {
            let bins = power.get(self.edges[group]..self.edges[group + 1]).unwrap_or_default();
            bins.iter().sum::<f32>().sqrt()
        });
        let all = amplitudes.iter().map(|amplitude| amplitude * amplitude).sum::<f32>().sqrt();
        self.loudest = all.max(self.loudest * self.kept).max(AMPLITUDE_MIN);
        let mut rise = Rise::default();
        let mut now = [0.0; GROUPS];
        let [before, ..] = self.last;
        for (group, amplitude) in amplitudes.into_iter().enumerate() {
            let loudest = &mut self.loudest_of[group];
            *loudest = amplitude.max(*loudest * self.kept);
            let of_group = (*loudest / self.loudest).clamp(GROUP_MIN, 1.0);
            let level = amplitude / self.loudest / of_group.powf(WHITENING);
            now[group] = (1.0 + COMPRESSION * level).ln();
            let rises = (now[group] - before[group]).max(0.0);
            let usual = &mut self.usual[group];
            let sudden = rises / (USUAL_MIN + *usual);
            *usual += self.learned * (rises.min(TEACHES_MOST * (USUAL_MIN + *usual)) - *usual);
            rise.flux += self.weights[group] * rises;
            rise.sudden += self.weights[group] * sudden.min(SUDDEN_MOST);
        }
        self.last.rotate_left(1);
        self.last[LAG - 1] = now;
        rise
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

/// Detects onsets with an adaptive threshold, without lookahead.
pub(super) struct Onsets {
    sudden: Vec<f32>,
    flux: Vec<f32>,
    moment: usize,
    taken: usize,
    sorted: Vec<f32>,
    above: bool,
    apart: u32,
    since: u32,
}

impl Onsets {
    pub(super) fn new(hop_seconds: f64) -> Self {
        let ring = |seconds: f64| vec![0.0; (seconds / hop_seconds).ceil() as usize];
        let apart = (ONSETS_APART / hop_seconds).round() as u32;
        Self {
            sudden: ring(SUDDEN_SECONDS),
            flux: ring(FLUX_SECONDS),
            moment: 0,
            taken: 0,
            sorted: ring(SUDDEN_SECONDS),
            above: false,
            apart,
            since: apart,
        }
    }

    pub(super) fn restart(&mut self) {
        self.sudden.fill(0.0);
        self.flux.fill(0.0);
        (self.moment, self.taken) = (0, 0);
        (self.above, self.since) = (false, self.apart);
    }

    /// Returns true at an onset, and the moment's flux relative to the largest recent flux, 0..1.
    pub(super) fn follow(&mut self, rise: Rise) -> (bool, f32) {
        for (ring, value) in [(&mut self.sudden, rise.sudden), (&mut self.flux, rise.flux)] {
            let place = self.moment % ring.len();
            ring[place] = value;
        }
        self.moment = self.moment.wrapping_add(1);
        self.taken = (self.taken + 1).min(self.sudden.len());
        let above = rise.sudden > self.threshold();
        let was_above = std::mem::replace(&mut self.above, above);
        self.since = self.since.saturating_add(1);
        let begins = above && !was_above && self.since >= self.apart;
        if begins {
            self.since = 0;
        }
        let strongest = self.flux.iter().fold(FLUX_MIN, |largest, flux| largest.max(*flux));
        (begins, (rise.flux / strongest).min(1.0))
    }

    fn threshold(&mut self) -> f32 {
        // Until the ring is full, only its first entries are used. These entries include some silence before the first
        // moment, so that a sound at the start of the stream is an onset.
        let count = self.taken.max(SILENT_BEFORE).min(self.sudden.len());
        let sorted = &mut self.sorted[..count];
        sorted.copy_from_slice(&self.sudden[..count]);
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
        median + above.max(SUDDEN_FRACTION * (largest - median))
    }
}
