//! Tests of the callback without a device.

use super::*;
use cpal::I24;
use proptest::prelude::*;

const RATE: u32 = 48_000;
const FADE_FRAMES: usize = (FADE * RATE as f32) as usize;

struct Bench {
    output_callback: OutputCallback,
    link: OutputCallbackLink,
    controls: Arc<Controls>,
    now: Instant,
}

impl Bench {
    fn new() -> Self {
        let controls = Arc::new(Controls::new(1.0, false));
        let (output_callback, link) = OutputCallback::new(RATE, 512, controls.clone());
        Self { output_callback, link, controls, now: Instant::now() }
    }

    fn offer(&mut self, id: u64, frames: &[StereoFrame]) -> (Producer<StereoFrame>, Arc<AtomicU64>) {
        let (mut producer, end, segment) = Segment::new(id, frames.len().max(1) * 2);
        producer.push_entire_slice(frames).expect("there is room");
        assert!(self.link.offer(segment).is_ok(), "the previous segment was not taken");
        (producer, end)
    }

    fn play(&mut self, frames: usize) -> Vec<StereoFrame> {
        let mut data = vec![0.0_f32; 2 * frames];
        self.output_callback.fill(&mut data, 2, self.now, Some(Duration::ZERO));
        self.now += Duration::from_secs_f64(frames as f64 / f64::from(RATE));
        data.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
    }

    fn underruns(&self) -> u64 {
        self.controls.underruns.load(Ordering::Relaxed)
    }
}

/// Frames whose samples encode their index exactly.
fn ramp(range: std::ops::Range<usize>) -> Vec<StereoFrame> {
    range.map(|n| [n as f32 / (1 << 24) as f32, -(n as f32) / (1 << 24) as f32]).collect()
}

fn assert_same(heard: &[StereoFrame], wanted: &[StereoFrame]) {
    assert_eq!(heard.len(), wanted.len());
    let odd = heard.iter().zip(wanted).position(|(heard, wanted)| heard != wanted);
    assert!(odd.is_none(), "from frame {odd:?} on");
}

#[test]
fn after_the_fade_in_every_frame_comes_once_and_in_order() {
    let mut bench = Bench::new();
    assert_eq!(bench.play(100), vec![[0.0; 2]; 100], "silence before the first segment");
    let frames = ramp(0..20_000);
    bench.offer(1, &frames);
    let mut heard = Vec::new();
    for size in [1, 255, 256, 257, 4096, 3, 999, 1024, 0, 7] {
        heard.extend(bench.play(size));
    }
    assert_same(&heard[FADE_FRAMES..], &frames[FADE_FRAMES..heard.len()]);
    assert!(heard[1][0] < frames[1][0], "no fade in");
    assert_eq!(bench.underruns(), 0);
}

#[test]
fn a_pause_takes_no_frames_and_resumes_where_it_stopped() {
    let mut bench = Bench::new();
    let frames = ramp(0..20_000);
    bench.offer(1, &frames);
    bench.play(1000);
    bench.controls.set_paused(true);
    let fading = bench.play(2000);
    assert!(fading[..FADE_FRAMES - 1].iter().all(|frame| frame[0] > 0.0));
    assert_eq!(fading[FADE_FRAMES..], vec![[0.0; 2]; 2000 - FADE_FRAMES]);
    let stands = bench.link.history.at(bench.now).expect("spans were written");
    assert_eq!(stands.frame, (1000 + FADE_FRAMES) as f64);
    bench.controls.set_paused(false);
    let heard = bench.play(1000);
    let first = 1000 + FADE_FRAMES;
    assert_same(&heard[FADE_FRAMES..], &frames[first + FADE_FRAMES..first + 1000]);
}

#[test]
fn a_new_segment_follows_a_fade_and_the_old_one_comes_back() {
    let mut bench = Bench::new();
    bench.offer(1, &ramp(0..10_000));
    bench.play(1000);
    let frames = ramp(50_000..60_000);
    bench.offer(2, &frames);
    let (_, _, third) = Segment::new(3, 10);
    assert!(bench.link.offer(third).is_err(), "only one can wait");
    let heard = bench.play(1000);
    assert_same(&heard[2 * FADE_FRAMES..], &frames[FADE_FRAMES..1000 - FADE_FRAMES]);
    let returned = bench.link.outgoing.pop().expect("the old segment");
    assert_eq!((returned.id, returned.next), (1, (1000 + FADE_FRAMES) as u64));
    let at = |frame: usize| {
        let begin = bench.now - Duration::from_secs_f64(1000.0 / f64::from(RATE));
        bench.link.history.at(begin + Duration::from_secs_f64((frame as f64 + 0.5) / f64::from(RATE)))
    };
    for (offset, segment, frame) in [(10, 1, 1010.5), (FADE_FRAMES + 10, 2, 10.5), (990, 2, 750.5)] {
        let audible = at(offset).expect("spans were written");
        assert_eq!(audible.segment, segment);
        assert!((audible.frame - frame).abs() < 0.01, "{} at {offset}", audible.frame);
    }
}

#[test]
fn a_paused_callback_takes_a_new_segment_in_silence() {
    let mut bench = Bench::new();
    bench.offer(1, &ramp(0..1000));
    bench.controls.set_paused(true);
    bench.play(500);
    bench.offer(2, &ramp(0..1000));
    assert_eq!(bench.play(500), vec![[0.0; 2]; 500]);
    assert_eq!(
        bench.link.history.at(bench.now).map(|audible| (audible.segment, audible.frame)),
        Some((2, 0.0))
    );
}

#[test]
fn an_underrun_is_counted_once_and_fades_out_and_in() {
    let mut bench = Bench::new();
    let (mut producer, _end) = bench.offer(1, &[[0.5, 0.5]; 2000]);
    let heard = bench.play(4000);
    assert_eq!(heard[1999], [0.5; 2]);
    assert!(heard[2000..2000 + FADE_FRAMES - 1].iter().all(|frame| frame[0] > 0.0), "no fade out");
    assert_same(&heard[2000 + FADE_FRAMES..], &vec![[0.0; 2]; 2000 - FADE_FRAMES]);
    bench.play(4000);
    assert_eq!(bench.underruns(), 1);
    producer.push_entire_slice(&[[0.5, 0.5]; 100]).expect("there is room");
    assert_eq!(bench.play(50), vec![[0.0; 2]; 50], "too few frames to resume");
    producer.push_entire_slice(&[[0.5, 0.5]; 3000]).expect("there is room");
    let heard = bench.play(1000);
    assert!(heard[1][0] > 0.0 && heard[1][0] < 0.1 && heard[999] == [0.5; 2]);
    assert_eq!(bench.underruns(), 1);
}

#[test]
fn the_end_does_not_count_as_underrun() {
    let mut bench = Bench::new();
    let (_producer, end) = bench.offer(1, &ramp(0..1000));
    end.store(1000, Ordering::Release);
    let heard = bench.play(3000);
    assert_same(&heard[FADE_FRAMES..1000], &ramp(0..1000)[FADE_FRAMES..]);
    assert_same(&heard[1000 + FADE_FRAMES..], &vec![[0.0; 2]; 2000 - FADE_FRAMES]);
    assert_eq!(bench.underruns(), 0);
    assert_eq!(bench.link.history.at(bench.now).map(|audible| audible.frame), Some(1000.0));
}

#[test]
fn a_callback_without_its_link_falls_silent() {
    let mut bench = Bench::new();
    bench.offer(1, &[[0.5; 2]; 10_000]);
    bench.play(1000);
    let (_, unused) = OutputCallback::new(RATE, 0, bench.controls.clone());
    drop(std::mem::replace(&mut bench.link, unused));
    assert_eq!(bench.play(1000)[FADE_FRAMES..], vec![[0.0; 2]; 1000 - FADE_FRAMES]);
}

fn one_buffer<T: Sample + FromSample<f32>>(frame: StereoFrame, channels: usize, rest: usize) -> Vec<T> {
    let mut bench = Bench::new();
    bench.offer(1, &[frame; 1000]);
    let mut data = vec![T::EQUILIBRIUM; 500 * channels + rest];
    bench.output_callback.fill(&mut data, channels, bench.now, None);
    data[499 * channels..].to_vec()
}

#[test]
fn stereo_is_mixed_into_the_devices_channels() {
    assert_eq!(one_buffer::<f32>([0.5, -0.25], 1, 0), [0.125]);
    assert_eq!(one_buffer::<f32>([0.5, -0.25], 2, 1), [0.5, -0.25, 0.0]);
    assert_eq!(one_buffer::<f32>([0.5, -0.25], 4, 0), [0.5, -0.25, 0.0, 0.0]);
}

#[test]
fn samples_fit_the_devices_format() {
    assert_eq!(one_buffer::<f32>([f32::NAN, f32::INFINITY], 2, 0), [0.0, 0.0]);
    assert_eq!(one_buffer::<i16>([2.0, -2.0], 2, 0), [i16::MAX, i16::MIN]);
    assert_eq!(one_buffer::<u8>([2.0, -2.0], 3, 0), [255, 0, 128]);
    let [left, right] = one_buffer::<I24>([2.0, -2.0], 2, 0)[..] else { panic!("two channels") };
    assert_eq!((left.inner(), right.inner()), ((1 << 23) - 1, -(1 << 23)));
    assert_eq!(one_buffer::<i32>([-2.0, 0.0], 2, 0), [i32::MIN, 0]);
}

#[test]
fn the_volume_is_a_third_power_and_stays_in_range() {
    let mut bench = Bench::new();
    bench.offer(1, &[[0.5; 2]; 20_000]);
    for (volume, factor) in [(0.5, 0.125), (7.0, 1.0), (-1.0, 0.0), (f32::NAN, 0.0)] {
        bench.controls.set_volume(volume);
        assert_eq!(bench.play(2000)[1999], [0.5 * factor; 2], "volume {volume}");
    }
}

proptest! {
    /// The signal is constant, so a click is a step that is larger than the ramps allow.
    #[test]
    fn no_sequence_of_events_clicks(events in prop::collection::vec((0_u8..8, 0_usize..2000), 1..80)) {
        let mut bench = Bench::new();
        let (mut producer, _) = bench.offer(1, &[[0.5; 2]; 1000]);
        let mut waiting = None;
        let mut before = 0.0_f32;
        for (id, (event, size)) in events.into_iter().enumerate() {
            match event {
                0 => bench.controls.set_paused(!bench.controls.paused()),
                1 => bench.controls.set_muted(!bench.controls.muted()),
                2 => bench.controls.set_volume(size as f32 / 2000.0),
                3 => {
                    let (mut next, _, segment) = Segment::new(id as u64 + 2, 2000);
                    next.push_entire_slice(&vec![[0.5; 2]; size]).expect("there is room");
                    if bench.link.offer(segment).is_ok() {
                        waiting = Some(next);
                    }
                }
                _ => {
                    producer = waiting.take().unwrap_or(producer);
                    let room = producer.slots().min(size * 2);
                    producer.push_entire_slice(&vec![[0.5; 2]; room]).expect("there is room");
                }
            }
            for frame in bench.play(size) {
                let step = (frame[0] - before).abs();
                prop_assert!(step < 0.5 * (1.0 / FADE_FRAMES as f32 + 1.0 / 480.0) + 1e-5, "a step of {}", step);
                before = frame[0];
            }
            bench.link.clean_up();
        }
    }
}
