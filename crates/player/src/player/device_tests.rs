//! Tests of lost, found and changed devices, with simulated callbacks and time.

use std::sync::mpsc::Sender;
use std::sync::{Arc, mpsc};
use std::time::{Duration, Instant};

use super::analysis::AnalysisInput;
use super::decoding::{Command, Decoding};
use super::listing;
use super::listing::SharedTrackErrors;
use super::tests::{RATE, Ramp, Ramps, wait_until_idle};
use crate::audible_segments::SharedAudibleSegments;
use crate::clock::{Clock, SpanHistory};
use crate::output::{Controls, OutputCallback};
use crate::track::Repeat;
use mariana_work::Background;

const LOOK_MS: u64 = 5;

const STEP_MAX: f64 = 0.05;

struct Device {
    output_callback: OutputCallback,
    history: Arc<SpanHistory>,
    rate: u32,
    buffer: usize,
    latency: Duration,
    next_call: Instant,
    /// The time at which the last buffer's first frame is audible, and its song time; `None` in a fade.
    heard: Option<(Instant, f64)>,
}

impl Device {
    /// Serves all calls until `now`. With `commands`, each call waits for the decoding thread.
    fn run(&mut self, now: Instant, commands: Option<&Sender<Command>>) {
        while self.next_call <= now {
            if let Some(commands) = commands {
                wait_until_idle(commands);
            }
            let mut data = vec![0.0_f32; 2 * self.buffer];
            self.output_callback.fill(&mut data, 2, self.next_call, Some(self.latency));
            let place = |frame: usize| f64::from(data[2 * frame]) * f64::from(1 << 24) / f64::from(RATE);
            let lasts = place(self.buffer - 1) - place(0);
            let clear = (lasts * f64::from(self.rate) / (self.buffer - 1) as f64 - 1.0).abs() < 0.05;
            self.heard = clear.then_some((self.next_call + self.latency, place(0)));
            self.next_call += Duration::from_secs_f64(self.buffer as f64 / f64::from(self.rate));
        }
    }
}

struct TestPlayback {
    commands: Sender<Command>,
    audible_segments: SharedAudibleSegments,
    worker: Background,
    device: Device,
    before: Option<(Device, Instant)>,
    now: Instant,
    clock: Clock,
    last: f64,
    looks: u32,
    still: Duration,
    stillest: Duration,
}

impl TestPlayback {
    fn new() -> Self {
        let list = Ramps::new(vec![Ramp::new(1 << 24)], Repeat::All);
        let (audible_segments, track_errors) =
            (SharedAudibleSegments::default(), SharedTrackErrors::default());
        let (to_analysis, inbox) = mpsc::sync_channel(1);
        std::thread::spawn(move || inbox.into_iter().for_each(|_: AnalysisInput| {}));
        let (commands, inbox) = mpsc::channel();
        let (to_list, requests) = mpsc::channel();
        let work = Decoding::new(
            list.track(0),
            to_list,
            audible_segments.clone(),
            to_analysis,
            track_errors.clone(),
        );
        let answers = commands.clone();
        std::thread::spawn(move || listing::run(Box::new(list), &requests, &answers, &track_errors));
        let worker = Background::start("decoding", move || work.run(&inbox)).expect("a thread");
        // The simulated time is an hour ahead, so that waits for threads never reach it in real time.
        let now = Instant::now() + Duration::from_secs(3600);
        let device = open(&commands, now, Duration::ZERO, RATE, 512, Duration::from_millis(20));
        Self {
            commands,
            audible_segments,
            worker,
            device,
            before: None,
            now,
            clock: Clock::default(),
            last: 0.0,
            looks: 0,
            still: Duration::ZERO,
            stillest: Duration::ZERO,
        }
    }

    fn change(
        &mut self,
        closing: Duration,
        first_call: Duration,
        rate: u32,
        buffer: usize,
        latency: Duration,
    ) {
        let device = open(&self.commands, self.now, first_call, rate, buffer, latency);
        self.before = Some((std::mem::replace(&mut self.device, device), self.now + closing));
    }

    fn pass(&mut self, ms: u64, lost: bool) {
        for _ in 0..ms / LOOK_MS {
            self.now += Duration::from_millis(LOOK_MS);
            if let Some((before, _)) = self.before.as_mut().filter(|(_, until)| *until > self.now) {
                before.run(self.now, None);
            }
            if !lost {
                self.device.run(self.now, Some(&self.commands));
            }
            self.look();
        }
    }

    fn look(&mut self) {
        let audible_segments = self.audible_segments.lock();
        let carry = |from, to| audible_segments.carry(from, to);
        let audible = self.clock.at(Some(&self.device.history), self.now, 0.0, carry);
        let Some(place) = audible.and_then(|audible| audible_segments.place(audible, 0.0)) else { return };
        let passed = LOOK_MS as f64 / 1000.0;
        let step = place.song_time - self.last;
        if self.looks > 0 {
            assert!(step >= 0.0, "back by {} s at {} s, look {}", -step, self.last, self.looks);
            assert!((step - passed).abs() <= STEP_MAX, "a step of {step} s at {} s", self.last);
        }
        self.still = if step > 0.0 { Duration::ZERO } else { self.still + Duration::from_millis(LOOK_MS) };
        self.stillest = self.stillest.max(self.still);
        self.last = place.song_time;
        self.looks += 1;
    }

    fn ahead(&self) -> f64 {
        let (at, place) = self.device.heard.expect("an audible frame");
        let since = |moment: Instant| {
            if self.now >= moment {
                (self.now - moment).as_secs_f64()
            } else {
                -(moment - self.now).as_secs_f64()
            }
        };
        self.last - (place + since(at))
    }
}

impl Drop for TestPlayback {
    fn drop(&mut self) {
        let _ = self.commands.send(Command::Quit);
        assert!(self.worker.finish(Duration::from_secs(5)) || std::thread::panicking());
    }
}

fn open(
    commands: &Sender<Command>,
    now: Instant,
    first_call: Duration,
    rate: u32,
    buffer: usize,
    latency: Duration,
) -> Device {
    let (output_callback, link) = OutputCallback::new(rate, buffer, Arc::new(Controls::new(1.0, false)));
    let history = link.history.clone();
    commands.send(Command::Output { link, at: now }).expect("the thread runs");
    wait_until_idle(commands);
    assert!(output_callback.is_offered(), "no frames are decoded for the output");
    Device { output_callback, history, rate, buffer, latency, next_call: now + first_call, heard: None }
}

const MS: Duration = Duration::from_millis(1);

#[test]
fn the_position_is_smooth_while_a_device_is_lost() {
    let mut evening = TestPlayback::new();
    evening.pass(3000, false);
    let from = (evening.last, evening.now);
    evening.stillest = Duration::ZERO;
    // The device is lost, and the loss is noticed after 1.1 s. The silent clock starts, with a delay.
    evening.pass(1100, true);
    evening.change(Duration::ZERO, 180 * MS, RATE, 480, Duration::ZERO);
    evening.pass(700, false);
    assert!(evening.ahead().abs() < 0.002, "{} s ahead on the silent clock", evening.ahead());
    // The device returns, with a long latency.
    evening.change(3 * MS, 250 * MS, 44_100, 1024, 230 * MS);
    evening.pass(1500, false);
    assert!(evening.ahead().abs() < 0.002, "{} s ahead on the new device", evening.ahead());
    let drift = evening.last - from.0 - (evening.now - from.1).as_secs_f64();
    assert!(drift.abs() < 0.002, "the song is {drift} s from where it would be");
    assert!(evening.stillest.is_zero(), "the clock stopped for {:?}", evening.stillest);
}

#[test]
fn the_position_is_smooth_during_many_device_changes() {
    let mut evening = TestPlayback::new();
    evening.pass(1000, false);
    evening.stillest = Duration::ZERO;
    let mut state = 11_u32;
    let mut random = |limit: u64| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        u64::from(state >> 8) % limit
    };
    for _ in 0..60 {
        let rate = [RATE, 44_100, 96_000][random(3) as usize];
        let buffer = [240, 512, 1024, 4096][random(4) as usize];
        let latency = Duration::from_millis(random(250));
        let first_call = Duration::from_millis(random(400));
        match random(4) {
            // The device is lost, and the loss is noticed late.
            0 => {
                evening.pass(random(1100), true);
                evening.change(Duration::ZERO, first_call, rate, buffer, latency);
            }
            // Another device opens while the previous device still plays.
            1 => evening.change(Duration::from_millis(random(120)), first_call, rate, buffer, latency),
            // The device is silent for a while and then resumes.
            2 => {
                evening.pass(random(900), true);
                evening.device.next_call = evening.now;
            }
            _ => evening.device.latency = latency,
        }
        evening.pass(random(1200), false);
    }
    assert!(evening.looks > 5000, "{} looks", evening.looks);
    assert!(evening.stillest <= Duration::from_millis(100), "the clock stopped for {:?}", evening.stillest);
    // At the end the clock agrees with the sound.
    evening.pass(12_000, false);
    assert!(evening.ahead().abs() < 0.002, "{} s ahead of the sound", evening.ahead());
}
