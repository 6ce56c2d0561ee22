//! Tempo and beat tracking: estimates the phase within the beat and predicts the next beat.
//!
//! The tracker is a causal hidden Markov model of the odds of a beat ([`crate::activation`]). A state is a period and a
//! phase within the period, both in whole hops (the bar pointer of Whiteley, Cemgil and Godsill 2006, with the states of
//! Krebs, Böck and Widmer 2015). At each hop, every state advances by one hop. At the end of a beat, a state may change
//! to a similar period. The model also expects an onset at the start of a beat and perhaps halfway through it. The states
//! of a period form a ring. They advance together, so that the ring is rotated and not copied.
//!
//! The reported tempo changes only to a much likelier tempo. The model keeps only windowed, held and leaky quantities,
//! which forget the distant past. So after a seek, it is enough to analyse 13 s before the target.

use std::f32::consts::TAU;
use std::ops::Range;

use super::repetition::Repetition;

/// Range of tempos, in beats per minute.
const TEMPO: (f64, f64) = (215.0, 52.0);

/// The start of a beat or of its half lasts this long, in seconds.
const START_SECONDS: f64 = 0.021;

/// The range of the log odds, the log odds at which a beat is as likely as none, and the weight of a hop's odds.
/// Successive hops depend on each other.
const ODDS: (f32, f32) = (-6.0, 6.0);
const USUAL: f32 = -3.5;
const WEIGHT: f32 = 0.3;
/// The weights of the odds of an onset at the start of a beat and at its half. Onsets at halves distinguish a beat from
/// half a beat.
const ONSET_WEIGHTS: [f32; 2] = [0.4, 0.08];
/// The number of hops for which the flux of an onset is held.
const HELD: usize = 3;

/// The most likely tempo in beats per minute, and the distance in octaves at which a tempo is less likely by exp(-1/2).
const LIKELY: (f64, f64) = (98.0, 0.75);

/// The cost of a tempo change at the end of a beat: the likelihood is exp(-`TEMPO_STIFFNESS` · relative change of the
/// period). A change by one hop costs only [`NEIGHBOUR`], because most tempos are between two periods, and their beats
/// alternate between both periods.
const TEMPO_STIFFNESS: f32 = 90.0;
const NEIGHBOUR: f32 = 2.0;
/// The largest change of the period from one beat to the next, in hops.
const REACH: usize = 8;

/// The fraction of the belief that is redistributed over all states at each hop, so that a new tempo can be found.
const DOUBT: f32 = 1e-5;

/// Thresholds of the total belief in the states near the likeliest state: within a tenth of a beat and a twelfth of its
/// tempo. A tempo is reported once this belief reaches the first value, until it falls below the second value.
const REPORTED: (f32, f32) = (0.5, 0.2);

/// A tempo is first reported when the probability of a beat repeats this much at its period. Noise and speech hardly
/// repeat.
const REPEATED_MIN: f32 = 0.12;

/// Another tempo replaces the reported tempo only if it is likelier by this factor.
const INERTIA: f32 = 3.0;

/// A tempo is reported only after this many onsets.
const ONSETS_MIN: u32 = 2;

/// The time without an onset after which the tracker restarts, in seconds.
const FORGET_SECONDS: f64 = 5.0;

/// The fraction of the phase error that is corrected at each hop.
const PULL: f32 = 0.12;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Beat {
    /// Beats per minute; 0 while unknown.
    pub(super) tempo: f32,
    /// The phase within the beat, 0 up to 1.
    pub(super) phase: f32,
}

struct Ring {
    /// The index of the first state in the belief.
    start: usize,
    period: usize,
    /// The offset within the ring of the state that is at the start of the beat.
    head: usize,
}

/// Returns the sum of `values`. It is computed as eight partial sums, so that the compiler can vectorize the loop.
fn sum_of(values: &[f32]) -> f32 {
    let (chunks, rest) = values.as_chunks::<8>();
    let mut sums = [0.0; 8];
    for chunk in chunks {
        sums.iter_mut().zip(chunk).for_each(|(sum, value)| *sum += value);
    }
    sums.iter().sum::<f32>() + rest.iter().sum::<f32>()
}

struct RecentOnsets {
    /// Number of hops without an onset after which all is forgotten.
    forget: u32,
    /// Number of hops since the last onset.
    since: u32,
    count: u32,
}

pub(super) struct BeatTracker {
    moments_per_second: f32,
    rings: Vec<Ring>,
    belief: Vec<f32>,
    /// For each ring: the share of the redistributed belief that each of its states gets.
    doubt: Vec<f32>,
    /// `passing[to][REACH + from - to]` is the probability of a change from period `from` to period `to`.
    passing: Vec<[f32; 2 * REACH + 1]>,
    /// The belief that leaves each ring at the end of a beat, padded with zeros at both ends.
    leaving: Vec<f32>,
    totals: Vec<f32>,
    /// The number of hops that count as the start of a beat.
    start: usize,
    /// The fluxes of the last hops, the newest first. The oldest [`HELD`] are as late as the odds.
    fluxes: Vec<f32>,
    onsets: RecentOnsets,
    /// The delay of the odds, in hops.
    late: f32,
    repetition: Repetition,
    reported: Beat,
}

impl BeatTracker {
    /// Creates a tracker for hops of `hop_seconds`, whose odds show beats `late` hops after they happened, and `later`
    /// hops after the flux shows them.
    pub(super) fn new(hop_seconds: f64, late: f32, later: usize) -> Self {
        let period = |tempo: f64| (60.0 / tempo / hop_seconds).round() as usize;
        let mut rings: Vec<Ring> = Vec::new();
        let mut states = 0;
        for period in period(TEMPO.0)..=period(TEMPO.1) {
            rings.push(Ring { start: states, period, head: 0 });
            states += period;
        }
        let likely = rings.iter().map(|ring| {
            let tempo = 60.0 / (ring.period as f64 * hop_seconds);
            (-0.5 * ((tempo / LIKELY.0).log2() / LIKELY.1).powi(2)).exp()
        });
        let likely: Vec<f64> = likely.collect();
        let sum: f64 = likely.iter().sum();
        let doubt = rings.iter().zip(&likely).map(|(ring, l)| (l / sum / ring.period as f64) as f32);
        let most = likely.iter().fold(0.0_f64, |most, l| most.max(*l));
        let again: Vec<f32> = likely.iter().map(|l| (l / most) as f32).collect();
        let weight = |to: usize, from: usize| {
            let moments = rings[to].period.abs_diff(rings[from].period) as f32;
            let beyond = (moments - 1.0).max(0.0) / rings[from].period as f32;
            (-TEMPO_STIFFNESS * beyond - NEIGHBOUR * moments.min(1.0)).exp()
        };
        let count = rings.len();
        let near = |ring: usize| ring.saturating_sub(REACH)..(ring + REACH + 1).min(count);
        let passing = (0..count).map(|to| {
            let mut row = [0.0; 2 * REACH + 1];
            for from in near(to) {
                let all: f32 = near(from).map(|to| weight(to, from)).sum();
                row[REACH + from - to] = again[to] * weight(to, from) / all;
            }
            row
        });
        let passing = passing.collect();
        let mut tracker = Self {
            moments_per_second: (1.0 / hop_seconds) as f32,
            doubt: doubt.collect(),
            belief: vec![0.0; states],
            passing,
            leaving: vec![0.0; count + 2 * REACH],
            totals: vec![0.0; count],
            rings,
            start: (START_SECONDS / hop_seconds).round().clamp(1.0, 4.0) as usize,
            fluxes: vec![0.0; later + HELD],
            onsets: RecentOnsets { forget: (FORGET_SECONDS / hop_seconds) as u32, since: 0, count: 0 },
            late,
            repetition: Repetition::new(hop_seconds),
            reported: Beat::default(),
        };
        tracker.restart();
        tracker
    }

    pub(super) fn restart(&mut self) {
        for (ring, doubt) in self.rings.iter_mut().zip(&self.doubt) {
            ring.head = 0;
            self.belief[ring.start..ring.start + ring.period].fill(*doubt);
        }
        self.fluxes.fill(0.0);
        (self.onsets.since, self.onsets.count) = (self.onsets.forget, 0);
        self.repetition.restart();
        self.reported = Beat::default();
    }

    /// Processes a hop with the log `odds` of a beat. `flux` is relative to the largest recent flux, 0..1. `begins` is
    /// true at the onset of a sound.
    pub(super) fn follow(&mut self, odds: f32, flux: f32, begins: bool) -> Beat {
        let onsets = &mut self.onsets;
        onsets.since = if begins { 0 } else { onsets.since.saturating_add(1) };
        onsets.count = onsets.count.saturating_add(u32::from(begins));
        if onsets.since >= onsets.forget {
            if self.reported != Beat::default() || onsets.since == onsets.forget {
                self.restart();
            }
            return Beat::default();
        }
        self.repetition.follow(1.0 / (1.0 + (-odds).exp()));
        self.move_on();
        self.fluxes.rotate_right(1);
        self.fluxes[0] = flux;
        let held = self.fluxes.iter().rev().take(HELD).fold(0.0_f32, |largest, flux| largest.max(*flux));
        self.observe(odds, held);
        self.current()
    }

    fn move_on(&mut self) {
        for (ring, leaving) in self.rings.iter_mut().zip(&mut self.leaving[REACH..]) {
            ring.head = (ring.head + ring.period - 1) % ring.period;
            *leaving = self.belief[ring.start + ring.head];
        }
        let near = self.leaving.windows(2 * REACH + 1);
        for ((ring, passing), near) in self.rings.iter().zip(&self.passing).zip(near) {
            let entering = passing.iter().zip(near).map(|(passing, leaving)| passing * leaving).sum();
            self.belief[ring.start + ring.head] = entering;
        }
    }

    fn observe(&mut self, odds: f32, flux: f32) {
        let onset = (flux + 0.03) / (1.03 - flux);
        let [beat, half] = ONSET_WEIGHTS.map(|weight| onset.powf(weight));
        let beat = beat * (WEIGHT * (odds.clamp(ODDS.0, ODDS.1) - USUAL)).exp();
        let mut sum = 0.0;
        for (ring, total) in self.rings.iter().zip(&mut self.totals) {
            let states = &mut self.belief[ring.start..ring.start + ring.period];
            for (first, likelihood) in [(ring.head, beat), (ring.head + ring.period.div_ceil(2), half)] {
                for place in first..first + self.start {
                    states[place % ring.period] *= likelihood;
                }
            }
            *total = sum_of(states);
            sum += *total;
        }
        let scale = if sum > 0.0 { (1.0 - DOUBT) / sum } else { 0.0 };
        for ((ring, total), doubt) in self.rings.iter().zip(&mut self.totals).zip(&self.doubt) {
            let doubt = DOUBT * doubt;
            for state in &mut self.belief[ring.start..ring.start + ring.period] {
                *state = *state * scale + doubt;
            }
            *total = *total * scale + doubt * ring.period as f32;
        }
    }

    fn current(&mut self) -> Beat {
        let best = self.chosen();
        let around = self.around(best);
        let (mut x, mut y, mut mass, mut moments) = (0.0, 0.0, 0.0, 0.0);
        for (ring, total) in self.rings[around.clone()].iter().zip(&self.totals[around]) {
            let step = TAU / ring.period as f32;
            let (mut sine, mut cosine) = (0.0_f32, 1.0_f32);
            let (step_sine, step_cosine) = step.sin_cos();
            let states = &self.belief[ring.start..ring.start + ring.period];
            for state in states[ring.head..].iter().chain(&states[..ring.head]) {
                x += state * cosine;
                y += state * sine;
                (sine, cosine) =
                    (sine * step_cosine + cosine * step_sine, cosine * step_cosine - sine * step_sine);
            }
            mass += total;
            moments += total * ring.period as f32;
        }
        let sure = x.hypot(y);
        let period = moments / mass.max(f32::MIN_POSITIVE);
        let is_reported = self.reported.tempo > 0.0;
        let enough = if is_reported { REPORTED.1 } else { REPORTED.0 };
        let repeats = is_reported || self.repetition.at(period) >= REPEATED_MIN;
        if sure < enough || self.onsets.count < ONSETS_MIN || !repeats {
            self.reported = Beat::default();
            return self.reported;
        }
        let turns = y.atan2(x) / TAU + self.late / period;
        let phase = turns - turns.floor();
        let expected = self.reported.phase + 1.0 / period;
        let error = phase - expected - (phase - expected).round();
        let same = self.reported.tempo > 0.0 && error.abs() < 0.2;
        // The phase never moves back, so that no beat is reported twice.
        let next = if same { expected + (PULL * error).max(-0.7 / period) } else { phase };
        let next = next - next.floor();
        self.reported = Beat {
            tempo: 60.0 * self.moments_per_second / period,
            phase: if next < 1.0 { next } else { 0.0 },
        };
        self.reported
    }

    /// Returns the ring of the reported tempo, unless another ring is much likelier.
    fn chosen(&self) -> usize {
        let best = self.likeliest(0..self.rings.len());
        if self.reported.tempo <= 0.0 {
            return best;
        }
        let shortest = self.rings.first().map_or(0, |ring| ring.period);
        let period = (60.0 * self.moments_per_second / self.reported.tempo).round() as usize;
        let reported = self.likeliest(self.around(period.saturating_sub(shortest).min(self.rings.len() - 1)));
        let belief = |ring: usize| self.totals[self.around(ring)].iter().sum::<f32>();
        if belief(best) < INERTIA * belief(reported) { reported } else { best }
    }

    /// Returns the rings whose tempo is within a twelfth of the tempo of `ring`.
    fn around(&self, ring: usize) -> Range<usize> {
        let reach = self.rings.get(ring).map_or(0, |ring| (ring.period / 12).max(1));
        ring.saturating_sub(reach)..(ring + reach + 1).min(self.rings.len())
    }

    fn likeliest(&self, among: Range<usize>) -> usize {
        let likelier = |a: &usize, b: &usize| self.totals[*a].total_cmp(&self.totals[*b]);
        // `max_by` returns the last of equal rings, so the first is compared last.
        among.rev().max_by(likelier).unwrap_or_default()
    }
}
