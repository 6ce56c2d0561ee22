//! Tests of the handover of segments, and of the song's position before a segment is audible.

use std::sync::Arc;
use std::time::Duration;

use super::*;
use crate::output::{Controls, OutputCallback};
use crate::track::Track;
use mariana_music::{Features, TimedFeatures};

const RATE: u32 = 48_000;

fn begun(goal: Goal) -> (CurrentSegment, OutputCallback) {
    let mut segment = CurrentSegment::new(SharedAudibleSegments::default());
    let controls = Arc::new(Controls::new(1.0, false));
    let (callback, link) = OutputCallback::new(RATE, 480, controls);
    segment.set_output(link);
    segment.aim(goal);
    begin(&mut segment, goal.time);
    (segment, callback)
}

fn begin(segment: &mut CurrentSegment, target: f64) {
    let resampler = Resampler::new(RATE, RATE).expect("a rate within the limits");
    let info = Track::silence(0, 1).info;
    segment.begin(1, info, target, resampler, 0, false);
}

fn feed(segment: &mut CurrentSegment, seconds: f64) {
    let frames = vec![[0.5; 2]; (seconds * f64::from(RATE)) as usize];
    let filling = segment.filling.as_mut().expect("there is a segment");
    filling.feed(&frames).expect("equal rates need no conversion");
}

#[test]
fn the_first_audible_frames_have_features() {
    let (mut segment, callback) = begun(Goal::seek(2.0));
    feed(&mut segment, PREFILL + 0.01);
    assert!(segment.push() && !callback.is_offered());
    segment.audible_segments.lock().push_features(1, &TimedFeatures::new(2.01, 0, Features::SILENCE));
    assert!(segment.push() && callback.is_offered());
}

#[test]
fn a_full_ring_does_not_wait_for_features() {
    let (mut segment, callback) = begun(Goal::seek(2.0));
    feed(&mut segment, RING + 0.01);
    assert!(!segment.push() && callback.is_offered());
}

#[test]
fn a_short_end_is_played() {
    let (mut segment, callback) = begun(Goal::seek(2.0));
    feed(&mut segment, 0.01);
    segment.filling.as_mut().expect("there is a segment").exhausted = true;
    assert!(!segment.push() && callback.is_offered() && segment.is_finished());
}

#[test]
fn an_inaudible_segment_runs_only_if_it_is_due() {
    let at = Instant::now();
    let seek = Goal::seek(2.0);
    let later = at + Duration::from_secs(3);
    let (segment, _callback) = begun(seek);
    let stands = Goal { same_run: true, ..seek };
    assert_eq!(segment.course(later, 1), (1, stands), "a seek waits for its segment");
    let due = Goal { time: 2.0, same_run: true, due: Some(at) };
    let (mut segment, _callback) = begun(due);
    let runs = Goal { time: 5.0, same_run: true, due: Some(later) };
    assert_eq!(segment.course(later, 1), (1, runs), "a new output meets the due time");
    segment.record_standstill();
    assert_eq!(
        segment.course(later, 1),
        (1, stands),
        "the song does not move while the process is suspended"
    );
}

#[test]
fn only_seeks_and_skips_start_a_run() {
    let (mut segment, _callback) = begun(Goal::seek(2.0));
    let run = segment.run;
    segment.aim(Goal { time: 2.5, same_run: true, due: None });
    assert_eq!((segment.run, segment.start()), (run, 2.0), "the old segment remains until it is abandoned");
    segment.abandon();
    assert_eq!(segment.start(), 2.5);
    segment.aim(Goal::seek(-1.0));
    assert_eq!((segment.run, segment.start()), (run + 1, 0.0));
}
