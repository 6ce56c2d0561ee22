//! The features of the last seconds, which can be read at any time.

use std::collections::VecDeque;
use std::sync::Arc;

use super::features::{Features, TimedFeatures};
use super::gain::amplitude;
use super::recent::{MOMENTS_PER_RECENT, RECENT_SECONDS, Recent};
use super::scale::SPECTRUM_POINTS;
use super::scale::WAVE_PER_HOP;
use super::song::SongMoment;
use super::tables::{
    HISTORY_POINTS, HISTORY_SECONDS, MOMENTS_PER_ROW, POINTS_PER_COLUMN, Sound, Tables, WAVEFORM_POINTS,
};
use crate::limits;

const DEFAULT_SECONDS: f64 = 20.0;

/// The shortest hop of any analyzer, in seconds.
const SHORTEST_HOP: f64 = 0.0075;

/// Number of rows beyond the time span that cubic interpolation needs at both ends.
const ROWS_BESIDES: usize = 4;

const HISTORY_ROWS: usize =
    (HISTORY_SECONDS / (MOMENTS_PER_ROW as f64 * SHORTEST_HOP)) as usize + 1 + ROWS_BESIDES;

/// A row of the history: the moment's number divided by [`MOMENTS_PER_ROW`], and the heights.
type Row = (u64, [f32; HISTORY_POINTS]);

/// A bounded record of features in order of time. Features are interpolated linearly between moments, so that they are
/// one function of time at any frame rate. After `new`, memory is allocated only for requested tables.
#[derive(Debug)]
pub struct FeatureTrack {
    moments: VecDeque<TimedFeatures>,
    /// The history rows, which reach further back in time than the moments.
    rows: VecDeque<Row>,
    /// Time and features of some moments, which reach further back in time than the other moments.
    recent: VecDeque<(f64, Features)>,
}

/// Adds a value at the end. If the queue is full, the first value is removed, so that the queue does not allocate.
fn push_newest<T>(queue: &mut VecDeque<T>, value: T) {
    if queue.len() == queue.capacity() {
        queue.pop_front();
    }
    queue.push_back(value);
}

impl FeatureTrack {
    /// Creates a track for at least the last `seconds` of an [`Analyzer`](super::Analyzer)'s features, clamped to 0 up
    /// to the limits' `feature_track_seconds_max`; NaN counts as 0. New moments replace the oldest.
    pub fn new(seconds: f64) -> Self {
        let seconds =
            if seconds.is_nan() { 0.0 } else { seconds.clamp(0.0, limits::FEATURE_TRACK_SECONDS_MAX) };
        let moments = (seconds / SHORTEST_HOP).ceil() as usize + 2;
        let recent = ((seconds + RECENT_SECONDS) / (SHORTEST_HOP * MOMENTS_PER_RECENT as f64)) as usize + 2;
        Self {
            moments: VecDeque::with_capacity(moments),
            rows: VecDeque::with_capacity(moments.div_ceil(MOMENTS_PER_ROW as usize) + HISTORY_ROWS),
            recent: VecDeque::with_capacity(recent),
        }
    }

    /// Adds a moment. Stored moments at or after the time of the new moment are dropped first, so that the newest
    /// analysis applies after a step back in time. Times that are not finite are ignored.
    pub fn push(&mut self, moment: &TimedFeatures) {
        if !moment.time.is_finite() {
            return;
        }
        while self.moments.pop_back_if(|last| last.time >= moment.time).is_some() {}
        while self.recent.pop_back_if(|(time, _)| *time >= moment.time).is_some() {}
        while self.rows.pop_back_if(|(row, _)| *row * MOMENTS_PER_ROW >= moment.number).is_some() {}
        push_newest(&mut self.moments, moment.clone());
        if moment.number.is_multiple_of(MOMENTS_PER_RECENT) {
            push_newest(&mut self.recent, (moment.time, moment.features));
        }
        if moment.number.is_multiple_of(MOMENTS_PER_ROW) {
            let row = moment.number / MOMENTS_PER_ROW;
            push_newest(&mut self.rows, (row, column_means(&moment.spectrum)));
        }
    }

    /// Returns the features at `time` in seconds of stream time, clamped to the first and last moment. Returns silence
    /// if the track is empty or `time` is NaN.
    pub fn at(&self, time: f64) -> Features {
        let Some((before, after, amount)) = self.around(time) else { return Features::SILENCE };
        before.features.lerp(&after.features, amount)
    }

    /// Returns the known moments of the last seconds before `time`, the oldest first, with unknown places in the song.
    pub fn recent(&self, time: f64) -> Vec<Recent> {
        let first = self.recent.partition_point(|(then, _)| *then < time - RECENT_SECONDS);
        let after = self.recent.partition_point(|(then, _)| *then < time);
        let recent = |(then, features): &(f64, Features)| Recent {
            age: time - then,
            features: *features,
            song: SongMoment::UNKNOWN,
            parts: Vec::new(),
        };
        self.recent.range(first.min(after)..after).map(recent).collect()
    }

    /// Returns the features and tables at `time`. In the tables, all sound before the first moment is silence.
    pub fn sound_at(&self, time: f64) -> Sound {
        let Some((before, after, amount)) = self.around(time) else { return Sound::default() };
        let features = before.features.lerp(&after.features, amount);
        let spectrum = before.spectrum.iter().zip(&after.spectrum).map(|(a, b)| a + (b - a) * amount);
        let (history, history_offset, history_span) = self.history(before, amount);
        let tables = Tables {
            spectrum: Some(spectrum.collect()),
            waveform: Some(self.waveform(before.number, amount, amplitude(features.gain_db))),
            history: Some(history),
            history_offset,
            history_span,
        };
        Sound { features, tables, ..Sound::default() }
    }

    /// Returns the moment at or before `time`, the next moment, and the position between the two moments, 0..1. Outside
    /// the track, both are the nearest moment.
    fn around(&self, time: f64) -> Option<(&TimedFeatures, &TimedFeatures, f32)> {
        if time.is_nan() {
            return None;
        }
        let after = self.moments.partition_point(|moment| moment.time <= time);
        let before = self.moments.get(after.saturating_sub(1))?;
        let after = self.moments.get(after).or(self.moments.back())?;
        let step = after.time - before.time;
        Some((before, after, if step > 0.0 { ((time - before.time) / step) as f32 } else { 0.0 }))
    }

    /// Returns the four hops of the waveform at the time `amount` hops after moment `number`.
    fn waveform(&self, number: u64, amount: f32, scale: f32) -> Arc<[f32]> {
        const HOPS: u64 = (WAVEFORM_POINTS / WAVE_PER_HOP) as u64;
        let skipped = (amount * WAVE_PER_HOP as f32).round() as usize;
        // Moments are in order of their numbers.
        let first = self.moments.partition_point(|moment| moment.number + HOPS <= number);
        let mut points = [0.0; WAVEFORM_POINTS + WAVE_PER_HOP];
        let hops = self.moments.range(first..).take_while(|moment| moment.number <= number + 1);
        for moment in hops {
            let place = (moment.number + HOPS - 1).saturating_sub(number) as usize;
            if let Some(hop) =
                points.get_mut(place * WAVE_PER_HOP..).and_then(|rest| rest.get_mut(..WAVE_PER_HOP))
            {
                hop.copy_from_slice(&moment.wave);
            }
        }
        points
            .iter()
            .skip(skipped)
            .take(WAVEFORM_POINTS)
            .map(|point| (point * scale).clamp(-1.0, 1.0))
            .collect()
    }

    /// Returns the history rows around the time `amount` hops after `moment`, the position of this time within the
    /// rows, and the number of rows in the time span.
    fn history(&self, moment: &TimedFeatures, amount: f32) -> (Arc<[f32]>, f32, f32) {
        let newest = moment.number / MOMENTS_PER_ROW + 2;
        let offset = 2.0 - ((moment.number % MOMENTS_PER_ROW) as f32 + amount) / MOMENTS_PER_ROW as f32;
        // The hop cannot be computed from the first moment, whose time is 0.
        let hop = moment.time / moment.number as f64;
        let hop = if hop.is_finite() { hop.max(SHORTEST_HOP) } else { SHORTEST_HOP };
        let span = HISTORY_SECONDS / (hop * MOMENTS_PER_ROW as f64);
        let mut values = vec![0.0; (span.ceil() as usize + ROWS_BESIDES).min(HISTORY_ROWS) * HISTORY_POINTS];
        let (lines, _) = values.as_chunks_mut::<HISTORY_POINTS>();
        // Until the next two rows are known, use the newest heights in their place.
        if let Some(ahead) = lines.get_mut(..2) {
            ahead.fill(column_means(&self.moments.back().unwrap_or(moment).spectrum));
        }
        let after = self.rows.partition_point(|(row, _)| *row <= newest);
        for (row, heights) in self.rows.range(..after).rev() {
            let Some(line) = lines.get_mut((newest - row) as usize) else { break };
            *line = *heights;
        }
        (values.into(), offset, span as f32)
    }

    /// Returns the times of the first and the last moment, in seconds; `None` if the track is empty.
    pub fn span(&self) -> Option<(f64, f64)> {
        Some((self.moments.front()?.time, self.moments.back()?.time))
    }

    /// Removes all features.
    pub fn clear(&mut self) {
        self.moments.clear();
        self.rows.clear();
        self.recent.clear();
    }
}

impl Default for FeatureTrack {
    /// Creates a track for the last 20 seconds.
    fn default() -> Self {
        Self::new(DEFAULT_SECONDS)
    }
}

fn column_means(spectrum: &[f32; SPECTRUM_POINTS]) -> [f32; HISTORY_POINTS] {
    let (groups, _) = spectrum.as_chunks::<POINTS_PER_COLUMN>();
    let mut row = [0.0; HISTORY_POINTS];
    for (column, group) in row.iter_mut().zip(groups) {
        *column = group.iter().sum::<f32>() / POINTS_PER_COLUMN as f32;
    }
    row
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moment(time: f64, volume: f32) -> TimedFeatures {
        let number = (time.max(0.0) / SHORTEST_HOP).round() as u64;
        TimedFeatures::new(time, number, Features { volume: [volume, -volume], ..Features::SILENCE })
    }

    fn track(moments: &[(f64, f32)]) -> FeatureTrack {
        let mut track = FeatureTrack::default();
        moments.iter().for_each(|&(time, volume)| track.push(&moment(time, volume)));
        track
    }

    #[test]
    fn features_are_interpolated_linearly() {
        let track = track(&[(1.0, 0.0), (2.0, 1.0), (4.0, 0.0)]);
        for (time, volume) in [(1.0, 0.0), (1.25, 0.25), (2.0, 1.0), (3.0, 0.5), (3.5, 0.25), (4.0, 0.0)] {
            assert_eq!(track.at(time).volume, [volume, -volume], "at {time} s");
        }
    }

    #[test]
    fn times_outside_the_track_read_the_nearest_moment() {
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
    fn recent_moments_are_every_second_one_of_the_last_seconds() {
        let mut track = FeatureTrack::new(1.0);
        (0..2000).for_each(|n| track.push(&moment(n as f64 * SHORTEST_HOP, n as f32)));
        let recent = track.recent(14.0);
        let volumes: Vec<f32> = recent.iter().map(|one| one.features.volume[0]).collect();
        assert!(volumes.windows(2).all(|pair| pair[1] == pair[0] + 2.0), "{volumes:?}");
        let (oldest, newest) = (&recent[0], &recent[recent.len() - 1]);
        assert!(oldest.age <= RECENT_SECONDS && oldest.age > RECENT_SECONDS - 2.0 * SHORTEST_HOP);
        assert!(newest.age > 0.0 && newest.age <= 2.0 * SHORTEST_HOP);
        assert!(track.recent(f64::NAN).is_empty() && track.recent(0.0).is_empty());
        track.push(&moment(10.0, 5.0));
        assert!(track.recent(14.0).iter().all(|one| one.age >= 4.0), "a step back forgets what followed");
    }

    #[test]
    fn clear_removes_all_features() {
        let mut track = track(&[(1.0, 0.5)]);
        track.clear();
        assert!(track.recent(9.0).is_empty());
        assert_eq!(track.at(1.0), Features::SILENCE);
    }

    #[test]
    fn length_is_bounded_and_at_least_as_requested() {
        let limit = limits::FEATURE_TRACK_SECONDS_MAX;
        for (asked, kept) in
            [(2.0, 2.0), (-1.0, 0.0), (f64::NAN, 0.0), (f64::INFINITY, limit), (2.0 * limit, limit)]
        {
            let mut track = FeatureTrack::new(asked);
            let capacity = track.moments.capacity();
            let count = (kept / SHORTEST_HOP) as usize + 10;
            (0..count).for_each(|n| track.push(&moment(n as f64 * SHORTEST_HOP, 0.0)));
            let (first, last) = (track.moments[0].time, track.moments[track.moments.len() - 1].time);
            assert!(
                (kept..kept + 3.0 * SHORTEST_HOP).contains(&(last - first)),
                "{asked}: {} s",
                last - first
            );
            assert_eq!(track.moments.capacity(), capacity, "the track must not reallocate");
        }
    }
}
