//! When a segment is handed over, and where the song is while nothing of it is heard.

use std::sync::Arc;
use std::time::Duration;

use super::*;
use crate::output::{Controls, OutputCallback};
use crate::track::Track;
use mariana_music::{Features, TimedFeatures};

const RATE: u32 = 48_000;

/// A segment that starts at 2 s, and the callback that it is for.
fn begun(goal: Goal) -> (CurrentSegment, OutputCallback) {
    let mut segment = CurrentSegment::new(SharedAudibleSegments::default());
    let controls = Arc::new(Controls::new(1.0, false));
    let (callback, link) = OutputCallback::new(RATE, 480, controls, Arc::default());
    segment.set_output(link);
    segment.aim(goal);
    begin(&mut segment, goal.time);
    (segment, callback)
}

fn begin(segment: &mut CurrentSegment, target: f64) {
    let resampler = Resampler::new(RATE, RATE).expect("a rate within the limits");
    let info = Track::silence(0, 1).info;
    segment.begin(SegmentStart { passage: 1, info, target, resampler, skip: 0, from_start: false });
}

fn feed(segment: &mut CurrentSegment, seconds: f64) {
    let frames = vec![[0.5; 2]; (seconds * f64::from(RATE)) as usize];
    let filling = segment.filling().expect("there is a segment");
    filling.feed(&frames, &mut Vec::new()).expect("nothing is converted");
}

#[test]
fn what_is_heard_first_has_its_features() {
    let (mut segment, callback) = begun(Goal::seek(2.0));
    feed(&mut segment, PREFILL + 0.01);
    assert!(segment.push() && !callback.is_offered());
    segment.audible_segments().lock().push_features(1, &TimedFeatures::new(2.01, 0, Features::SILENCE));
    assert!(segment.push() && callback.is_offered());
}

#[test]
fn a_full_ring_waits_for_no_features_and_takes_no_more() {
    let (mut segment, callback) = begun(Goal::seek(2.0));
    feed(&mut segment, RING + 0.01);
    assert!(!segment.push() && callback.is_offered());
}

#[test]
fn a_short_end_is_heard_too() {
    let (mut segment, callback) = begun(Goal::seek(2.0));
    feed(&mut segment, 0.01);
    segment.filling().expect("there is a segment").exhausted = true;
    assert!(!segment.push() && callback.is_offered() && segment.is_finished());
}

#[test]
fn what_is_not_heard_yet_runs_only_if_it_is_due() {
    let at = Instant::now();
    let seek = Goal::seek(2.0);
    let later = at + Duration::from_secs(3);
    let (segment, _callback) = begun(seek);
    let stands = Goal { same_run: true, ..seek };
    assert_eq!(segment.course(later, 1), (1, stands), "a seek waits for its segment");
    let due = Goal { time: 2.0, same_run: true, due: Some(at) };
    let (mut segment, _callback) = begun(due);
    let runs = Goal { time: 5.0, same_run: true, due: Some(later) };
    assert_eq!(segment.course(later, 1), (1, runs), "another output meets the time");
    segment.note_standstill();
    assert_eq!(segment.course(later, 1), (1, stands), "while the process stood still so did the song");
}

#[test]
fn only_seeks_and_skips_begin_a_run() {
    let (mut segment, _callback) = begun(Goal::seek(2.0));
    let run = segment.run;
    segment.aim(Goal { time: 2.5, same_run: true, due: None });
    assert_eq!((segment.run, segment.start()), (run, 2.0), "the old segment is there until it is abandoned");
    segment.abandon();
    assert_eq!(segment.start(), 2.5);
    segment.aim(Goal::seek(-1.0));
    assert_eq!((segment.run, segment.start()), (run + 1, 0.0));
}
