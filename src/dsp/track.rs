//! The features of the last seconds, to be asked for at any moment.

use std::collections::VecDeque;

use super::features::{Features, TimedFeatures};
use crate::limits::LIMITS;

/// What [`FeatureTrack::default`] keeps, in seconds.
const DEFAULT_SECONDS: f64 = 20.0;

/// No analyzer's hop is shorter, in seconds.
const SHORTEST_HOP: f64 = 0.0075;

/// A bounded record of features in order of time.
///
/// Between two moments the features are interpolated linearly, so they are one function of time, whatever the
/// frame rate at which they are asked for. Nothing is allocated after `new`.
#[derive(Clone, Debug)]
pub struct FeatureTrack {
    moments: VecDeque<TimedFeatures>,
    capacity: usize,
}

impl FeatureTrack {
    /// Keeps at least the last `seconds` of an [`Analyzer`](super::Analyzer)'s features (0 up to the limits'
    /// `feature_track_seconds_max`; others are clamped, no number is 0); the oldest make room for the newest.
    pub fn new(seconds: f64) -> Self {
        let seconds =
            if seconds.is_nan() { 0.0 } else { seconds.clamp(0.0, LIMITS.feature_track_seconds_max) };
        let capacity = (seconds / SHORTEST_HOP).ceil() as usize + 2;
        Self { moments: VecDeque::with_capacity(capacity), capacity }
    }

    /// Adds a moment. Moments kept at or after its time are dropped first: after a step back in time the newest
    /// analysis holds. A time that is not finite is ignored.
    pub fn push(&mut self, moment: TimedFeatures) {
        if !moment.time.is_finite() {
            return;
        }
        while self.moments.back().is_some_and(|last| last.time >= moment.time) {
            self.moments.pop_back();
        }
        if self.moments.len() == self.capacity {
            self.moments.pop_front();
        }
        self.moments.push_back(moment);
    }

    /// The features at `time` in seconds of stream time. Before the first moment kept they are the first one's, after
    /// the last the last one's; silence if none is kept or `time` is not a number.
    pub fn at(&self, time: f64) -> Features {
        if time.is_nan() {
            return Features::SILENCE;
        }
        let after = self.moments.partition_point(|moment| moment.time <= time);
        let before = after.checked_sub(1).and_then(|index| self.moments.get(index));
        match (before, self.moments.get(after)) {
            (Some(a), Some(b)) => {
                let amount = (time - a.time) / (b.time - a.time);
                a.features.lerp(&b.features, amount as f32)
            }
            (Some(only), None) | (None, Some(only)) => only.features,
            (None, None) => Features::SILENCE,
        }
    }

    /// The times of the first and the last moment kept, in seconds; none if empty.
    pub fn span(&self) -> Option<(f64, f64)> {
        Some((self.moments.front()?.time, self.moments.back()?.time))
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.moments.clear();
    }
}

impl Default for FeatureTrack {
    /// Keeps the last 20 seconds.
    fn default() -> Self {
        Self::new(DEFAULT_SECONDS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moment(time: f64, volume: f32) -> TimedFeatures {
        TimedFeatures { time, features: Features { volume: [volume, -volume], ..Features::SILENCE } }
    }

    fn track(moments: &[(f64, f32)]) -> FeatureTrack {
        let mut track = FeatureTrack::default();
        moments.iter().for_each(|&(time, volume)| track.push(moment(time, volume)));
        track
    }

    #[test]
    fn moments_are_joined_by_straight_lines() {
        let track = track(&[(1.0, 0.0), (2.0, 1.0), (4.0, 0.0)]);
        for (time, volume) in [(1.0, 0.0), (1.25, 0.25), (2.0, 1.0), (3.0, 0.5), (3.5, 0.25), (4.0, 0.0)] {
            assert_eq!(track.at(time).volume, [volume, -volume], "at {time} s");
        }
    }

    #[test]
    fn outside_its_span_the_nearest_moment_holds() {
        let filled = track(&[(1.0, 0.3), (2.0, 0.6)]);
        assert_eq!(filled.span(), Some((1.0, 2.0)));
        for (time, volume) in [(f64::NEG_INFINITY, 0.3), (-5.0, 0.3), (9.0, 0.6), (f64::INFINITY, 0.6)] {
            assert_eq!(filled.at(time).volume[0], volume, "at {time} s");
        }
        assert_eq!(filled.at(f64::NAN), Features::SILENCE);
        assert_eq!(track(&[]).at(1.0), Features::SILENCE);
        assert_eq!(track(&[]).span(), None);
    }

    #[test]
    fn a_step_back_in_time_replaces_what_followed() {
        let track = track(&[(1.0, 0.1), (2.0, 0.2), (3.0, 0.3), (1.5, 0.9), (f64::NAN, 7.0)]);
        let times: Vec<f64> = track.moments.iter().map(|moment| moment.time).collect();
        assert_eq!(times, [1.0, 1.5]);
        assert_eq!(track.at(2.0).volume[0], 0.9);
    }

    #[test]
    fn clear_forgets() {
        let mut track = track(&[(1.0, 0.5)]);
        track.clear();
        assert_eq!(track.at(1.0), Features::SILENCE);
    }

    #[test]
    fn length_is_bounded_and_at_least_what_was_asked_for() {
        let limit = LIMITS.feature_track_seconds_max;
        for (asked, kept) in
            [(2.0, 2.0), (-1.0, 0.0), (f64::NAN, 0.0), (f64::INFINITY, limit), (2.0 * limit, limit)]
        {
            let mut track = FeatureTrack::new(asked);
            let capacity = track.moments.capacity();
            let count = (kept / SHORTEST_HOP) as usize + 10;
            (0..count).for_each(|n| track.push(moment(n as f64 * SHORTEST_HOP, 0.0)));
            let (first, last) = (track.moments[0].time, track.moments[track.moments.len() - 1].time);
            assert!(
                (kept..kept + 3.0 * SHORTEST_HOP).contains(&(last - first)),
                "{asked}: {} s",
                last - first
            );
            assert_eq!(track.moments.capacity(), capacity, "it grew");
        }
    }
}
