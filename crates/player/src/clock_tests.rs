//! Tests of spans and clocks with artificial times.

use super::*;
use proptest::prelude::*;

fn span(start_ms: u64, segment: u64, frame: u64, frames: u32, moving: bool) -> Span {
    Span { start_ns: start_ms * 1_000_000, segment, frame, frames, moving }
}

fn at_ms(history: &SpanHistory, ms: u64) -> Option<Audible> {
    history.at(history.epoch + Duration::from_millis(ms))
}

#[test]
fn the_frame_moves_with_time_and_stops_after_the_last_delivered_frame() {
    let (mut writer, history) = SpanHistory::new(1000);
    assert_eq!(at_ms(&history, 5), None);
    writer.push(span(10, 1, 0, 20, true));
    writer.push(span(30, 1, 20, 10, false));
    writer.push(span(40, 2, 0, 10, true));
    for (ms, segment, frame) in
        [(0, 1, 0.0), (10, 1, 0.0), (15, 1, 5.0), (30, 1, 20.0), (39, 1, 20.0), (44, 2, 4.0), (900, 2, 10.0)]
    {
        assert_eq!(at_ms(&history, ms), Some(Audible { segment, frame }), "at {ms} ms");
    }
}

#[test]
fn old_spans_are_forgotten_and_the_oldest_kept_answers_for_them() {
    let (mut writer, history) = SpanHistory::new(1000);
    let count = SPANS_KEPT as u64 + 100;
    (0..count).for_each(|n| writer.push(span(10 * n, 1, 10 * n, 10, true)));
    assert_eq!(at_ms(&history, 10 * count - 5).map(|audible| audible.frame), Some(10.0 * count as f64 - 5.0));
    assert_eq!(at_ms(&history, 0).map(|audible| audible.frame), Some(1000.0));
}

#[test]
fn jitter_is_smoothed_and_a_real_change_of_latency_is_taken_at_once() {
    let (mut writer, history) = SpanHistory::new(48_000);
    let period = Duration::from_millis(10);
    let latency = Duration::from_millis(20);
    let mut previous: Option<f64> = None;
    for n in 0..200_u32 {
        let jitter = Duration::from_millis(u64::from(n * 7919 % 5));
        let start = writer.place(history.epoch + period * n + jitter, latency, 480);
        if let Some(previous) = previous.filter(|_| n > 50) {
            let step = start as f64 - previous;
            assert!((step - 10e6).abs() < 0.5e6, "a step of {step} ns at callback {n}");
        }
        previous = Some(start as f64);
    }
    let start = writer.place(history.epoch + period * 200, latency + Duration::from_millis(100), 480);
    assert_eq!(start, (period * 200 + latency).as_nanos() as u64 + 100_000_000);
}

#[test]
fn readers_never_see_a_span_half_written() {
    let (mut writer, history) = SpanHistory::new(1_000_000_000);
    let done = AtomicU64::new(0);
    std::thread::scope(|scope| {
        let reader = scope.spawn(|| {
            let mut seen = 0_u64;
            // On a busy machine the writer may end before the reader begins.
            while done.load(Ordering::Acquire) == 0 || seen == 0 {
                if let Some(Found { span, .. }) = history.find_span(u64::MAX) {
                    assert_eq!(span.frame, span.segment);
                    seen += 1;
                }
            }
            seen
        });
        for n in 1..=400_000_u64 {
            writer.push(Span { start_ns: n, segment: n, frame: n, frames: 0, moving: true });
        }
        done.store(1, Ordering::Release);
        assert!(reader.join().expect("the reader saw a torn span") > 0);
    });
}

fn apart(_: Audible, _: u64) -> Option<f64> {
    None
}

fn reported(clock: &mut Clock, history: &Arc<SpanHistory>, ms: u64) -> f64 {
    let moment = history.epoch + Duration::from_millis(ms);
    let carry = |from: Audible, _| Some(from.frame);
    clock.at(Some(history), moment, 0.0, carry).map_or(f64::NAN, |audible| audible.frame)
}

#[test]
fn a_silent_device_does_not_stop_the_clock() {
    let (mut writer, history) = SpanHistory::new(1000);
    let mut clock = Clock::default();
    writer.push(span(0, 1, 0, 100, true));
    for ms in (0..=1100).step_by(20) {
        assert!((reported(&mut clock, &history, ms) - ms as f64).abs() < 1e-6, "at {ms} ms");
    }
    // The device resumes a second late. No frame was lost, and the clock waits for the device without stopping.
    writer.push(span(1120, 1, 100, 20_000, true));
    let mut last = reported(&mut clock, &history, 1120);
    for ms in (1140..=7000).step_by(20) {
        let now = reported(&mut clock, &history, ms);
        assert!((15.9..=24.1).contains(&(now - last)), "a step of {} at {ms} ms", now - last);
        last = now;
    }
    assert!((last - (7000.0 - 1020.0)).abs() < 1e-6, "{last} is not the audible frame");
}

#[test]
fn repeated_stalls_do_not_drive_the_clock_away_from_the_sound() {
    let (mut writer, history) = SpanHistory::new(1000);
    let mut clock = Clock::default();
    for stall in 0..20 {
        // Each second contains 0.2 s of sound.
        writer.push(span(1000 * stall, 1, 200 * stall, 200, true));
        for look in 0..50 {
            let ahead = reported(&mut clock, &history, 1000 * stall + 20 * look) - (200 * (stall + 1)) as f64;
            assert!(ahead <= 1000.0 * (AHEAD_MAX + 1.0), "{ahead} ahead after {stall} stalls");
        }
    }
}

#[test]
fn a_process_that_was_stopped_does_not_race_to_catch_up() {
    for late in [0, 40] {
        let (mut writer, history) = SpanHistory::new(1000);
        let mut clock = Clock::default();
        writer.push(span(0, 1, 0, 100, true));
        let _ = (0..5).fold(0.0, |_, look| reported(&mut clock, &history, look * 20));
        // The process is suspended at 80 ms for 5 s. The callback runs before or after the first read.
        if late == 0 {
            writer.push(span(5080, 1, 100, 20_000, true));
        }
        let mut last = reported(&mut clock, &history, 5080);
        assert!((last - 100.0).abs() < 1e-6, "{last}");
        if late > 0 {
            writer.push(span(5080 + late, 1, 100, 20_000, true));
        }
        for ms in (5100..=9000).step_by(20) {
            let now = reported(&mut clock, &history, ms);
            assert!((15.9..=24.1).contains(&(now - last)), "a step of {} at {ms} ms", now - last);
            last = now;
        }
        assert!((last - (9000 - late - 4980) as f64).abs() < 1e-6, "{last} is not the audible frame");
    }
}

#[test]
fn an_output_counts_from_its_first_audible_frame_on() {
    let (mut writer, first) = SpanHistory::new(1000);
    let mut clock = Clock::default();
    writer.push(span(0, 1, 0, 100, true));
    assert_eq!(reported(&mut clock, &first, 60), 60.0);
    let (mut writer, second) = SpanHistory::new(1000);
    let offset = (second.epoch - first.epoch).as_millis() as u64;
    assert!((reported(&mut clock, &second, 140 - offset) - 140.0).abs() < 1.5);
    writer.push(span(200 - offset, 2, 200, 1000, true));
    assert!((reported(&mut clock, &second, 180 - offset) - 180.0).abs() < 1.5);
    assert!((reported(&mut clock, &second, 220 - offset) - 220.0).abs() < 1.5);
    assert!(clock.history().is_some_and(|history| Arc::ptr_eq(history, &second)));
}

proptest! {
    #[test]
    fn the_clock_never_steps_back(
        callbacks in prop::collection::vec((0_u64..25, 0_u64..60, 1_usize..2000, 0_u8..10), 1..60),
        looks in prop::collection::vec(0_u64..15, 1..8),
    ) {
        let (mut writer, history) = SpanHistory::new(48_000);
        let mut clock = Clock::default();
        let (mut now_ms, mut segment, mut frame) = (0, 1, 0);
        let mut last: Option<Audible> = None;
        for (gap, latency, frames, event) in callbacks {
            now_ms += gap;
            if event == 0 {
                segment += 1;
                frame = 0;
            }
            let moving = event != 1;
            let start_ns = writer.place(history.epoch + Duration::from_millis(now_ms), Duration::from_millis(latency), frames);
            writer.push(Span { start_ns, segment, frame, frames: frames as u32, moving });
            frame += if moving { frames as u64 } else { 0 };
            for look in &looks {
                let moment = history.epoch + Duration::from_millis(now_ms + look);
                let audible = clock.at(Some(&history), moment, 0.0, apart).expect("a span was written");
                prop_assert!(last.is_none_or(|last| (last.segment, last.frame) <= (audible.segment, audible.frame)));
                let exact = history.at(moment).expect("a span was written");
                prop_assert!(exact.segment < segment || exact.frame <= frame as f64, "more frames than were delivered");
                last = Some(audible);
            }
        }
    }
}
