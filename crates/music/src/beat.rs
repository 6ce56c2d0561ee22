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

/// The states of a period, one for each hop of it.
struct Ring {
    /// The belief in each state.
    states: Vec<f32>,
    /// The index of the state that is at the start of the beat.
    head: usize,
    /// The sum of the states.
    total: f32,
    /// The part of the redistributed belief that each state gets.
    doubt: f32,
    /// `passing[REACH + from - to]` is the probability of a change from ring `from` to this ring `to`.
    passing: [f32; 2 * REACH + 1],
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

pub(super) struct BeatTracker {
    moments_per_second: f32,
    rings: Vec<Ring>,
    /// The belief that leaves each ring at the end of a beat, padded with zeros at both ends.
    leaving: Vec<f32>,
    /// The number of hops that count as the start of a beat.
    start: usize,
    /// The fluxes of the last hops, the newest first. The oldest [`HELD`] are as late as the odds.
    fluxes: Vec<f32>,
    /// The number of onsets.
    onsets: u32,
    /// The number of hops since the last onset.
    since: u32,
    /// The number of hops without an onset after which all is forgotten.
    forget: u32,
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
        let periods: Vec<usize> = (period(TEMPO.0)..=period(TEMPO.1)).collect();
        let likely = periods.iter().map(|period| {
            let tempo = 60.0 / (*period as f64 * hop_seconds);
            (-0.5 * ((tempo / LIKELY.0).log2() / LIKELY.1).powi(2)).exp()
        });
        let likely: Vec<f64> = likely.collect();
        let sum: f64 = likely.iter().sum();
        let most = likely.iter().fold(0.0_f64, |most, l| most.max(*l));
        let weight = |to: usize, from: usize| {
            let moments = periods[to].abs_diff(periods[from]) as f32;
            let beyond = (moments - 1.0).max(0.0) / periods[from] as f32;
            (-TEMPO_STIFFNESS * beyond - NEIGHBOUR * moments.min(1.0)).exp()
        };
        let count = periods.len();
        let near = |ring: usize| ring.saturating_sub(REACH)..(ring + REACH + 1).min(count);
        let ring = |to: usize| {
            let (doubt, again) = ((likely[to] / sum / periods[to] as f64) as f32, (likely[to] / most) as f32);
            let mut passing = [0.0; 2 * REACH + 1];
            for from in near(to) {
                let all: f32 = near(from).map(|to| weight(to, from)).sum();
                passing[REACH + from - to] = again * weight(to, from) / all;
            }
            Ring { states: vec![doubt; periods[to]], head: 0, total: 0.0, doubt, passing }
        };
        let forget = (FORGET_SECONDS / hop_seconds) as u32;
        Self {
            moments_per_second: (1.0 / hop_seconds) as f32,
            rings: (0..count).map(ring).collect(),
            leaving: vec![0.0; count + 2 * REACH],
            start: (START_SECONDS / hop_seconds).round().clamp(1.0, 4.0) as usize,
            fluxes: vec![0.0; later + HELD],
            onsets: 0,
            since: forget,
            forget,
            late,
            repetition: Repetition::new(hop_seconds),
            reported: Beat::default(),
        }
    }

    pub(super) fn restart(&mut self) {
        for ring in &mut self.rings {
            ring.head = 0;
            ring.states.fill(ring.doubt);
        }
        self.fluxes.fill(0.0);
        (self.since, self.onsets) = (self.forget, 0);
        self.repetition.restart();
        self.reported = Beat::default();
    }

    /// Processes a hop with the log `odds` of a beat. `flux` is relative to the largest recent flux, 0..1. `begins` is
    /// true at the onset of a sound.
    pub(super) fn follow(&mut self, odds: f32, flux: f32, begins: bool) -> Beat {
        self.since = if begins { 0 } else { self.since.saturating_add(1) };
        self.onsets = self.onsets.saturating_add(u32::from(begins));
        if self.since >= self.forget {
            if self.reported != Beat::default() || self.since == self.forget {
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
            ring.head = (ring.head + ring.states.len() - 1) % ring.states.len();
            *leaving = ring.states[ring.head];
        }
        for (ring, near) in self.rings.iter_mut().zip(self.leaving.windows(2 * REACH + 1)) {
            let entering = ring.passing.iter().zip(near).map(|(passing, leaving)| passing * leaving).sum();
            ring.states[ring.head] = entering;
        }
    }

    fn observe(&mut self, odds: f32, flux: f32) {
        let onset = (flux + 0.03) / (1.03 - flux);
        let [beat, half] = ONSET_WEIGHTS.map(|weight| onset.powf(weight));
        let beat = beat * (WEIGHT * (odds.clamp(ODDS.0, ODDS.1) - USUAL)).exp();
        let mut sum = 0.0;
        for ring in &mut self.rings {
            let period = ring.states.len();
            for (first, likelihood) in [(ring.head, beat), (ring.head + period.div_ceil(2), half)] {
                for place in first..first + self.start {
                    ring.states[place % period] *= likelihood;
                }
            }
            ring.total = sum_of(&ring.states);
            sum += ring.total;
        }
        let scale = if sum > 0.0 { (1.0 - DOUBT) / sum } else { 0.0 };
        for ring in &mut self.rings {
            let doubt = DOUBT * ring.doubt;
            ring.states.iter_mut().for_each(|state| *state = *state * scale + doubt);
            ring.total = ring.total * scale + doubt * ring.states.len() as f32;
        }
    }

    fn current(&mut self) -> Beat {
        let best = self.chosen();
        let [mut x, mut y, mut mass, mut moments] = [0.0_f32; 4];
        for ring in &self.rings[self.around(best)] {
            let period = ring.states.len() as f32;
            let step = TAU / period;
            let (mut sine, mut cosine) = (0.0_f32, 1.0_f32);
            let (step_sine, step_cosine) = step.sin_cos();
            let (before, beat) = ring.states.split_at(ring.head);
            for state in beat.iter().chain(before) {
                x += state * cosine;
                y += state * sine;
                (sine, cosine) =
                    (sine * step_cosine + cosine * step_sine, cosine * step_cosine - sine * step_sine);
            }
            mass += ring.total;
            moments += ring.total * period;
        }
        let sure = x.hypot(y);
        let period = moments / mass.max(f32::MIN_POSITIVE);
        let is_reported = self.reported.tempo > 0.0;
        let enough = if is_reported { REPORTED.1 } else { REPORTED.0 };
        let repeats = is_reported || self.repetition.at(period) >= REPEATED_MIN;
        if sure < enough || self.onsets < ONSETS_MIN || !repeats {
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
        let shortest = self.rings.first().map_or(0, |ring| ring.states.len());
        let period = (60.0 * self.moments_per_second / self.reported.tempo).round() as usize;
        let reported = self.likeliest(self.around(period.saturating_sub(shortest).min(self.rings.len() - 1)));
        let belief = |ring: usize| self.rings[self.around(ring)].iter().map(|ring| ring.total).sum::<f32>();
        if belief(best) < INERTIA * belief(reported) { reported } else { best }
    }

    /// Returns the rings whose tempo is within a twelfth of the tempo of `ring`.
    fn around(&self, ring: usize) -> Range<usize> {
        let reach = self.rings.get(ring).map_or(0, |ring| (ring.states.len() / 12).max(1));
        ring.saturating_sub(reach)..(ring + reach + 1).min(self.rings.len())
    }

    fn likeliest(&self, among: Range<usize>) -> usize {
        let likelier = |a: &usize, b: &usize| self.rings[*a].total.total_cmp(&self.rings[*b].total);
        // `max_by` returns the last of equal rings, so the first is compared last.
        among.rev().max_by(likelier).unwrap_or_default()
    }
}
