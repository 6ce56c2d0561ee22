//! Onsets: where sounds begin.

use super::bands::{BAND_HIGHEST_HZ, BAND_LOWEST_HZ};

/// Groups of bins whose rise is measured, in equal ratios from 30 Hz to 16 kHz.
const GROUPS: usize = 20;

/// Strength of the logarithmic compression of a group's amplitude: log(1 + this · amplitude).
const COMPRESSION: f32 = 20.0;

/// Powers below this (-70 dB) are too weak for a sound to begin.
const POWER_MIN: f32 = 1e-7;

/// Moments between the two spectra that are compared: windows of two hops that do not overlap.
const LAG: usize = 2;

/// Groups below this frequency have weight 1, those above have less: drums and basses carry the beat, hats fill it.
const WEIGHT_HZ: f64 = 300.0;

/// Spectral flux of a moment: the sum over groups of the rise of log(1 + 20·a), where a is the group's amplitude
/// relative to that of the loudest recent moment. Falls count nothing. A group is compared with the largest value
/// that it and its neighbours had two moments ago, so that a gliding tone causes no rise (Böck and Widmer 2013,
/// "maximum filter vibrato suppression").
pub(super) struct Flux {
    /// First bins of the groups, and the end of the last.
    edges: [usize; GROUPS + 1],
    weights: [f32; GROUPS],
    last: [[f32; GROUPS]; LAG],
}

impl Flux {
    /// For power spectra of `bins` bins of `bin_hz` hertz.
    pub(super) fn new(bins: usize, bin_hz: f64) -> Self {
        let hz = |group: f64| BAND_LOWEST_HZ * (BAND_HIGHEST_HZ / BAND_LOWEST_HZ).powf(group / GROUPS as f64);
        let mut edges = [0; GROUPS + 1];
        let mut least = 1;
        for (group, edge) in edges.iter_mut().enumerate() {
            // Each group has at least one bin, so the low ones lie higher than equal ratios would put them.
            *edge = ((hz(group as f64) / bin_hz).round() as usize).max(least).min(bins);
            least = *edge + 1;
        }
        let weights = std::array::from_fn(|group| {
            let middle = edges[group] as f64 * bin_hz;
            (WEIGHT_HZ / middle.max(WEIGHT_HZ)).powf(0.5) as f32
        });
        Self { edges, weights, last: [[0.0; GROUPS]; LAG] }
    }

    /// Forgets everything.
    pub(super) fn restart(&mut self) {
        self.last = [[0.0; GROUPS]; LAG];
    }

    /// The flux of the next moment, 0 or more, from its power per bin and the power of the loudest recent moment.
    pub(super) fn follow(&mut self, power: &[f32], loudest: f32) -> f32 {
        let scale = 1.0 / loudest.max(POWER_MIN);
        let now: [f32; GROUPS] = std::array::from_fn(|group| {
            let bins = power.get(self.edges[group]..self.edges[group + 1]).unwrap_or_default();
            (1.0 + COMPRESSION * (bins.iter().sum::<f32>() * scale).sqrt()).ln()
        });
        let [before, ..] = self.last;
        let flux = (0..GROUPS).map(|group| {
            let around = &before[group.saturating_sub(1)..(group + 2).min(GROUPS)];
            let base = around.iter().fold(0.0_f32, |largest, value| largest.max(*value));
            self.weights[group] * (now[group] - base).max(0.0)
        });
        let flux = flux.sum();
        self.last.rotate_left(1);
        self.last[LAG - 1] = now;
        flux
    }
}

/// How far back the flux is compared, in seconds.
const THRESHOLD_SECONDS: f64 = 1.5;

/// An onset exceeds the mean flux of that time by this share of the way from the mean to the largest.
const THRESHOLD_SHARE: f32 = 0.4;

/// Less flux than this is no onset: noise reaches as much, drums have 5 to 20.
const FLUX_MIN: f32 = 2.5;

/// Two onsets are never closer than this, in seconds.
const ONSETS_APART: f64 = 0.1;

/// Finds onsets in the flux with an adaptive threshold, at once: nothing that comes later is needed.
pub(super) struct Onsets {
    recent: Vec<f32>,
    next: usize,
    above: bool,
    apart: u32,
    since: u32,
}

impl Onsets {
    /// For moments `hop_seconds` apart.
    pub(super) fn new(hop_seconds: f64) -> Self {
        let recent = vec![0.0; (THRESHOLD_SECONDS / hop_seconds).ceil() as usize];
        let apart = (ONSETS_APART / hop_seconds).round() as u32;
        Self { recent, next: 0, above: false, apart, since: apart }
    }

    /// Forgets everything.
    pub(super) fn restart(&mut self) {
        self.recent.fill(0.0);
        (self.above, self.since) = (false, self.apart);
    }

    /// Takes the flux of a moment. Returns whether a sound begins there, and the flux relative to the largest recent
    /// one, 0..1.
    pub(super) fn follow(&mut self, flux: f32) -> (bool, f32) {
        if let Some(slot) = self.recent.get_mut(self.next) {
            *slot = flux;
        }
        self.next = (self.next + 1) % self.recent.len();
        // Summed from the oldest on, so that the sum does not depend on where the ring begins.
        let (newer, older) = self.recent.split_at(self.next);
        let mean = older.iter().chain(newer).sum::<f32>() / self.recent.len() as f32;
        let largest = self.recent.iter().fold(FLUX_MIN, |largest, flux| largest.max(*flux));
        let was_above = std::mem::replace(
            &mut self.above,
            flux >= FLUX_MIN && flux > mean + THRESHOLD_SHARE * (largest - mean),
        );
        self.since = self.since.saturating_add(1);
        let begins = self.above && !was_above && self.since >= self.apart;
        if begins {
            self.since = 0;
        }
        (begins, (flux / largest).min(1.0))
    }
}
