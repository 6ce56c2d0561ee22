//! Tests of transitions from track to track, with simulated callbacks.

use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use super::decoding::Command;
use super::tests::{Heard, RATE, Ramp, Ramps, Stepped};
use crate::track::Repeat;

fn songs(lengths: &[usize]) -> Vec<Ramp> {
    let firsts = lengths.iter().scan(0, |sum, length| {
        let first = *sum;
        *sum += length;
        Some(first)
    });
    lengths.iter().zip(firsts).map(|(frames, first)| Ramp { first, ..Ramp::new(*frames) }).collect()
}

fn first_of(lengths: &[usize], entry: usize) -> f64 {
    lengths[..entry].iter().sum::<usize>() as f64
}

#[test]
fn tracks_follow_each_other_to_the_frame_and_are_reported() {
    let lengths = [30_011, 7, 20_000, 1_153];
    let mut stepped = Stepped::of(Ramps::new(songs(&lengths), Repeat::All), RATE);
    stepped.begin();
    let heard = stepped.play(180_000);
    let mut whole = 0;
    let clear: Vec<Heard> = heard.iter().copied().filter(|heard| heard.index.is_some()).collect();
    assert!(clear.len() > 170_000, "only {} frames are clear", clear.len());
    for heard in &clear {
        let index = heard.index.expect("a clear frame") - first_of(&lengths, heard.entry);
        assert!(
            (index - heard.reported_index).abs() < 0.01,
            "{index} of {} is reported as {}",
            heard.entry,
            heard.reported_index
        );
    }
    // No frame is added or lost: each sample is the previous sample plus 1, or the list restarts.
    for pair in heard.windows(2) {
        let (Some(before), Some(after)) = (pair[0].index, pair[1].index) else { continue };
        assert!(after == before + 1.0, "{before} is followed by {after}");
        whole += 1;
    }
    assert!(whole > 170_000);
    let entries: std::collections::BTreeSet<usize> = heard.iter().map(|heard| heard.entry).collect();
    assert_eq!(entries.len(), 4);
    assert!(heard.iter().all(|heard| heard.segment == 1), "a track began a new segment");
}

#[test]
fn tracks_of_other_rates_are_resampled_into_the_same_stream() {
    // The three ramps have the same slope over time and last 1 s, 0.5 s and 1 s.
    let rates = [RATE, 44_100, 96_000];
    let songs = [1.0, 0.5, 1.0]
        .iter()
        .zip(rates)
        .map(|(seconds, rate)| Ramp { rate, ..Ramp::new((seconds * f64::from(rate)) as usize) });
    let mut stepped = Stepped::of(Ramps::new(songs.collect(), Repeat::Off), RATE);
    stepped.begin();
    let mut heard = Vec::new();
    let start = Instant::now();
    let ended = |stepped: &Stepped| {
        stepped.history.at(stepped.now).is_some_and(|audible| stepped.audible_segments.lock().is_end(audible))
    };
    while !ended(&stepped) && start.elapsed() < Duration::from_secs(20) {
        heard.extend(stepped.play(480));
    }
    let count = |entry: usize| heard.iter().filter(|heard| heard.entry == entry).count() as f64;
    // Part of the first track was heard before this loop, so it is not counted; the last callback ends in silence.
    for (entry, frames) in [(1, 24_000.0), (2, 48_000.0)] {
        assert!((count(entry) - frames).abs() <= 480.0, "track {entry} has {} frames", count(entry));
    }
    let audible = stepped.history.at(stepped.now).expect("a span");
    assert_eq!(audible.frame, 48_000.0 + 24_000.0 + 48_000.0);
}

#[test]
fn unplayable_tracks_are_skipped_and_reported() {
    let lengths = [10_000, 0, 0, 10_000];
    let mut stepped = Stepped::of(Ramps::new(songs(&lengths), Repeat::Off), RATE);
    stepped.begin();
    let heard = stepped.play(24_000);
    let clear: Vec<f64> = heard.iter().filter_map(|heard| heard.index).collect();
    assert_eq!(clear.last(), Some(&19_999.0));
    assert!(clear.windows(2).all(|pair| pair[1] == pair[0] + 1.0));
    let track_errors = stepped.track_errors.get();
    assert_eq!((track_errors.count, track_errors.last.as_deref()), (2, Some("song 2 is gone")));
}

#[test]
fn a_track_that_breaks_off_is_followed_by_the_next() {
    let mut list = songs(&[48_000, 48_000]);
    list[0].broken_at = 11_520;
    let mut stepped = Stepped::of(Ramps::new(list, Repeat::Off), RATE);
    stepped.begin();
    let heard = stepped.play(24_000);
    let join = heard.iter().position(|heard| heard.entry == 1).expect("the second track");
    assert_eq!(heard[join - 1].index, Some(11_519.0));
    assert!(heard[join + 1].index == Some(48_001.0) && heard[join + 1].reported_index < 2.0);
    assert_eq!(stepped.track_errors.get().last.as_deref(), Some("the song is damaged"));
}

#[test]
fn a_slow_list_leaves_a_pause() {
    let list =
        Ramps { delay: Duration::from_millis(400), ..Ramps::new(songs(&[9_600, 48_000]), Repeat::Off) };
    let mut stepped = Stepped::of(list, RATE);
    stepped.begin();
    let mut heard = Vec::new();
    let start = Instant::now();
    while !heard.iter().any(|heard: &Heard| heard.entry == 1) && start.elapsed() < Duration::from_secs(10) {
        heard.extend(stepped.play(480));
    }
    heard.extend(stepped.play(9_600));
    let clear: Vec<&Heard> = heard.iter().filter(|heard| heard.index.is_some()).collect();
    for heard in &clear {
        let index = heard.index.expect("a clear frame") - if heard.entry == 1 { 9_600.0 } else { 0.0 };
        assert!((index - heard.reported_index).abs() < 0.01);
    }
    assert!(clear.iter().filter(|heard| heard.entry == 1).count() > 8_000);
}

#[test]
fn many_skips_reach_their_target() {
    let lengths = [480_000; 7];
    let mut stepped = Stepped::of(Ramps::new(songs(&lengths), Repeat::All), RATE);
    stepped.begin();
    for (steps, entry) in [(1, 1), (3, 4), (-2, 2), (-4, 5), (9, 0)] {
        for _ in 0..i32::abs(steps) {
            stepped.send(Command::Skip { forward: steps > 0 });
        }
        let mut heard = Vec::new();
        let start = Instant::now();
        while heard.last().is_none_or(|heard: &Heard| heard.entry != entry) {
            assert!(start.elapsed() < Duration::from_secs(10), "track {entry} does not start");
            heard = stepped.play(4_800);
        }
        std::thread::sleep(Duration::from_millis(50));
        let heard = stepped.play(9_600);
        let last = heard.last().expect("frames");
        assert_eq!(last.entry, entry, "after {steps}");
        let index = last.index.expect("no fade") - first_of(&lengths, entry);
        assert!((index - last.reported_index).abs() < 0.01 && index < 96_000.0, "{index}");
    }
    stepped.send(Command::SeekTo(5.0));
    stepped.play(9_600);
    stepped.send(Command::Skip { forward: false });
    let last = stepped.play(9_600).pop().expect("frames");
    assert!(last.entry == 0 && last.reported_index < 20_000.0, "{} of {}", last.reported_index, last.entry);
}

#[test]
fn a_seek_at_the_end_of_a_track_stays_in_the_audible_track() {
    let lengths = [48_000, 100, 90_000];
    let mut stepped = Stepped::of(Ramps::new(songs(&lengths), Repeat::All), RATE);
    stepped.begin();
    // About 0.1 s before the end, the next two tracks are in the ring already.
    while stepped.play(480).last().is_some_and(|heard| heard.reported_index < 43_000.0) {}
    stepped.send(Command::SeekBy(-0.5));
    let heard = stepped.play(4_800 * 3);
    let last = heard.last().expect("frames");
    assert_eq!((last.entry, last.segment), (0, 2));
    assert!((0.0..40_000.0).contains(&last.reported_index), "{}", last.reported_index);
    // From there on all frames are heard again, in order.
    let heard = stepped.play(48_000);
    let clear: Vec<f64> = heard.iter().filter_map(|heard| heard.index).collect();
    assert!(clear.windows(2).all(|pair| pair[1] == pair[0] + 1.0));
    assert_eq!(heard.last().expect("frames").entry, 2);
}

#[test]
fn a_new_repeat_mode_applies_from_the_next_end_on() {
    let mut stepped = Stepped::of(Ramps::new(songs(&[24_000, 24_000]), Repeat::All), RATE);
    stepped.begin();
    stepped.send(Command::Order(Repeat::One, false));
    let heard = stepped.play(72_000);
    assert!(heard.iter().all(|heard| heard.entry == 0));
    assert!(heard.last().expect("frames").lap >= 2);
    stepped.send(Command::Order(Repeat::Off, false));
    stepped.play(96_000);
    let audible = stepped.history.at(stepped.now).expect("a span");
    assert!(stepped.audible_segments.lock().is_end(audible));
    assert_eq!(stepped.audible_segments.lock().place(audible, 0.0).map(|place| place.track.entry), Some(1));
}

#[test]
fn silence_replaces_unplayable_tracks_and_a_skip_retries() {
    let mut list = Ramps::new(songs(&[9_600, 9_600]), Repeat::All);
    list.gone.store(true, Ordering::Relaxed);
    // The open track also cannot restart.
    list.songs[0].seek_limit = -1.0;
    let gone = list.gone.clone();
    let mut stepped = Stepped::of(list, RATE);
    stepped.begin();
    let heard = stepped.play(48_000);
    assert!(heard.last().is_some_and(|heard| heard.reported_index > 4_800.0), "the show stops");
    assert!(stepped.track_errors.get().count > 0);
    gone.store(false, Ordering::Relaxed);
    stepped.send(Command::Skip { forward: true });
    let heard = stepped.play(9_600);
    assert!(heard.iter().filter(|heard| heard.index.is_some()).count() > 4_800, "no song is heard again");
}

#[test]
fn another_device_continues_the_audible_track() {
    let mut stepped = Stepped::of(Ramps::new(songs(&[48_000, 48_000]), Repeat::Off), RATE);
    stepped.begin();
    while stepped.play(480).last().is_some_and(|heard| heard.reported_index < 43_000.0) {}
    stepped.change_device(44_100);
    let mut heard = Vec::new();
    let start = Instant::now();
    while heard.last().is_none_or(|heard: &Heard| heard.entry == 0) {
        assert!(start.elapsed() < Duration::from_secs(10), "the next track does not start");
        heard.extend(stepped.play(480));
    }
    assert!(
        heard[0].entry == 0 && heard[0].segment == 2,
        "{} of segment {}",
        heard[0].entry,
        heard[0].segment
    );
    // The position never steps back.
    let times: Vec<f64> =
        heard.iter().filter(|heard| heard.entry == 0).map(|heard| heard.reported_index).collect();
    assert!(times.windows(2).all(|pair| pair[1] >= pair[0]));
    assert!(times.last().is_some_and(|last| *last > 44_000.0), "{:?}", times.last());
}

#[test]
fn parts_of_a_song_are_resampled_like_the_whole_song() {
    let parts = |lengths: &[usize]| {
        let songs = songs(lengths).into_iter();
        let songs = songs.map(|song| Ramp { rate: 44_100, first: song.first + 10_000, ..song });
        Stepped::of(Ramps::new(songs.collect(), Repeat::Off), RATE).samples(60_000)
    };
    let (whole, joined) = (parts(&[60_000]), parts(&[20_011, 17, 39_972]));
    let other = whole.iter().zip(&joined).position(|(whole, joined)| whole != joined);
    assert_eq!(other, None, "of {} frames", whole.len());
    assert!(whole[50_000] > whole[10_000] && whole[10_000] > 0.0);
}
