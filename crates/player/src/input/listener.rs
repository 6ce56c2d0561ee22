//! The listening thread analyses the input's frames and sends moments to the window.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

use rtrb::Producer;

use super::input_callback::InputCallbackLink;
use crate::gain_switch::GainSwitch;
use mariana_music::{Alignment, Analyzer, StereoFrame, TimedFeatures};
use mariana_work::Shared;

/// Maximum sleep of the thread if no callback wakes it.
const PATIENCE: Duration = Duration::from_millis(50);

/// If no frames arrive for this long, in seconds, silence replaces them.
const GAP: f64 = 0.1;

/// Seconds of silence that are analysed after the last frame, so that every feature settles.
const REST: f64 = 20.0;

/// The smallest range of sample values in a batch that counts as a signal: -80 dB. A constant offset has no range.
pub(super) const FLAT: f32 = 1e-4;

#[derive(Debug, Clone)]
pub(super) struct Heard {
    /// The stream's number, which grows with each opened device.
    pub(super) stream: u64,
    #[cfg_attr(not(test), expect(dead_code, reason = "tests distinguish the moments by it"))]
    pub(super) position: u64,
    /// The moment. Its time is when its sample arrived, in seconds since the epoch. Its number grows over all streams.
    pub(super) heard: TimedFeatures,
}

pub(super) struct Ear {
    pub(super) epoch: Instant,
    /// The time of the last signal, or of the current stream's start if that is later, in nanoseconds since the epoch.
    flat_since_ns: AtomicU64,
}

impl Ear {
    pub(super) fn new() -> Self {
        Self { epoch: Instant::now(), flat_since_ns: AtomicU64::new(0) }
    }

    pub(super) fn now(&self) -> f64 {
        self.epoch.elapsed().as_secs_f64()
    }

    /// Seconds without a signal in the current stream.
    pub(super) fn flat_for(&self) -> f64 {
        self.now() - self.flat_since_ns.load(Ordering::Relaxed) as f64 / 1e9
    }

    fn record_signal(&self) {
        self.flat_since_ns.store(self.epoch.elapsed().as_nanos() as u64, Ordering::Relaxed);
    }
}

pub(super) struct Listener {
    ear: Arc<Ear>,
    moments: Producer<Heard>,
    link: Option<InputCallbackLink>,
    analyzer: Analyzer,
    gain: GainSwitch,
    stream: u64,
    /// The number of hops before the stream began. This number is added to the numbers of the stream's moments.
    first_number: u64,
    last_number: u64,
    /// The time of the last frames or of the last inserted silence, in seconds since the epoch.
    last: f64,
    /// Seconds of silence that remain to be analysed.
    rest: f64,
    last_time: f64,
    position: u64,
    /// True while the analysis rests: there is no signal, and every feature has settled.
    resting: bool,
    batch: Vec<StereoFrame>,
}

impl Listener {
    pub(super) fn new(ear: Arc<Ear>, moments: Producer<Heard>, gain: GainSwitch) -> Self {
        let analyzer = Analyzer::with_gain(48_000, Alignment::Trailing, gain.get());
        Self {
            ear,
            moments,
            link: None,
            analyzer,
            gain,
            stream: 0,
            first_number: 0,
            last_number: 0,
            last: 0.0,
            rest: 0.0,
            last_time: 0.0,
            position: 0,
            resting: false,
            batch: Vec::new(),
        }
    }

    pub(super) fn run(mut self, links: &Receiver<Option<InputCallbackLink>>, shared: &Shared<()>) {
        while !shared.is_over() {
            for link in links.try_iter() {
                self.attach(link);
            }
            self.listen();
            std::thread::park_timeout(PATIENCE);
        }
    }

    fn attach(&mut self, link: Option<InputCallbackLink>) {
        if let Some(link) = &link {
            self.stream += 1;
            (self.position, self.resting) = (0, false);
            if self.analyzer.sample_rate() == link.rate {
                self.analyzer.restart(0);
            } else {
                self.analyzer = Analyzer::with_gain(link.rate, Alignment::Trailing, self.gain.get());
            }
            let hop = self.analyzer.hop() as f64 / f64::from(self.analyzer.sample_rate());
            self.first_number = ((self.ear.now() / hop) as u64).max(self.last_number + 1);
            self.ear.record_signal();
            (self.last, self.rest) = (self.ear.now(), REST);
        }
        self.link = link;
    }

    fn listen(&mut self) {
        let now = self.ear.now();
        self.analyzer.set_gain(self.gain.get());
        self.batch.clear();
        if let Some(link) = &mut self.link {
            let count = link.ring.slots();
            if let Ok(chunk) = link.ring.read_chunk(count) {
                let (front, back) = chunk.as_slices();
                self.batch.extend_from_slice(front);
                self.batch.extend_from_slice(back);
                chunk.commit_all();
            }
        }
        if !self.batch.is_empty() {
            if has_signal(&self.batch) {
                self.ear.record_signal();
            }
            (self.last, self.rest) = (now, REST);
        } else if now - self.last > GAP && self.rest > 0.0 {
            // Without frames, the features fade to silence, as after a song.
            let missing = now - self.last;
            self.batch.resize((missing * f64::from(self.analyzer.sample_rate())) as usize, [0.0; 2]);
            self.rest -= missing;
            self.last = now;
        }
        self.analyse(now);
    }

    fn analyse(&mut self, now: f64) {
        let was_resting = std::mem::replace(&mut self.resting, self.ear.flat_for() > REST);
        if was_resting && !self.resting {
            self.analyzer.restart(self.position);
        }
        let Self { batch, analyzer, moments, stream, last_time, first_number, last_number, .. } = self;
        self.position += batch.len() as u64;
        if self.resting {
            return;
        }
        let (end, rate) = (self.position, f64::from(analyzer.sample_rate()));
        analyzer.push(batch, &mut |moment| {
            let position = (moment.time * rate).round() as u64;
            let age = end.saturating_sub(position) as f64 / rate;
            // Batches arrive at irregular times, but time must not step back.
            let time = (now - age).max(*last_time + 1e-6);
            *last_time = time;
            *last_number = *first_number + moment.number;
            let heard = TimedFeatures { time, number: *last_number, ..moment.clone() };
            // If the ring is full, no reader reads it, and the moment is not needed.
            let _ = moments.push(Heard { stream: *stream, position, heard });
        });
    }
}

pub(super) fn has_signal(frames: &[StereoFrame]) -> bool {
    (0..2).any(|side| {
        let samples = || frames.iter().map(|frame| frame[side]).filter(|sample| sample.is_finite());
        let (least, most) =
            samples().fold((f32::MAX, f32::MIN), |(a, b), sample| (a.min(sample), b.max(sample)));
        most - least > FLAT
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::InputCallback;
    use mariana_music::Gain;
    use rtrb::{Consumer, RingBuffer};

    fn listener() -> (Listener, Consumer<Heard>) {
        let (moments, heard) = RingBuffer::new(1024);
        (Listener::new(Arc::new(Ear::new()), moments, GainSwitch::new(Gain::Off)), heard)
    }

    fn all(heard: &mut Consumer<Heard>) -> Vec<Heard> {
        std::iter::from_fn(|| heard.pop().ok()).collect()
    }

    fn tone(frames: usize) -> Vec<f32> {
        (0..frames).map(|n| (n as f32 * 0.1).sin()).collect()
    }

    #[test]
    fn every_hop_becomes_a_moment_with_its_position_and_time() {
        let (mut listener, mut heard) = listener();
        let (mut tap, link) = InputCallback::new(48_000, std::thread::current());
        listener.attach(Some(link));
        for size in [700, 30, 1300, 9_000] {
            tap.receive(&tone(size), 1);
            listener.listen();
        }
        let moments = all(&mut heard);
        let positions: Vec<u64> = moments.iter().map(|moment| moment.position).collect();
        let wanted: Vec<u64> = (0..positions.len() as u64).map(|n| 512 * n).collect();
        assert_eq!(positions, wanted);
        assert!(positions.len() as u64 >= 11_030 / 512);
        assert!(moments.is_sorted_by(|a, b| a.heard.time < b.heard.time && a.heard.number < b.heard.number));
        assert!(moments.last().is_some_and(|last| last.heard.features.volume[0] > 0.1 && last.stream == 1));
        let (mut tap, link) = InputCallback::new(96_000, std::thread::current());
        listener.attach(Some(link));
        tap.receive(&tone(5_000), 1);
        listener.listen();
        let moments = all(&mut heard);
        assert_eq!((moments[0].stream, moments[0].position, moments[1].position), (2, 0, 1024));
    }

    #[test]
    fn features_fade_to_silence_without_frames_and_then_rest() {
        let (mut listener, mut heard) = listener();
        let (mut tap, link) = InputCallback::new(8_000, std::thread::current());
        listener.attach(Some(link));
        tap.receive(&tone(4_000), 1);
        listener.listen();
        assert!(all(&mut heard).last().is_some_and(|last| last.heard.features.volume[0] > 0.1));
        listener.attach(None);
        let mut made = 0;
        for _ in 0..2 * REST as usize {
            listener.last -= 0.6;
            listener.listen();
            let moments = all(&mut heard);
            made += moments.len();
            if let Some(last) = moments.last() {
                assert!(last.heard.features.volume[0] < 0.5);
            }
        }
        assert_eq!(listener.batch.len(), 0, "it never rests");
        assert!(made > 10 && listener.rest <= 0.0);
    }

    #[test]
    fn long_silence_is_not_analysed_and_later_positions_are_right() {
        let (mut listener, mut heard) = listener();
        let (mut tap, link) = InputCallback::new(8_000, std::thread::current());
        listener.attach(Some(link));
        tap.receive(&tone(1_000), 1);
        listener.listen();
        // Simulate a signal that ended long ago.
        listener.ear =
            Arc::new(Ear { epoch: Instant::now() - Duration::from_secs_f64(REST + 7.0), ..Ear::new() });
        assert!(!all(&mut heard).is_empty());
        tap.receive(&[0.0; 1_000], 1);
        listener.listen();
        assert!(all(&mut heard).is_empty(), "silence was analysed");
        tap.receive(&tone(1_000), 1);
        listener.listen();
        let moments = all(&mut heard);
        let hop = listener.analyzer.hop() as u64;
        assert_eq!(moments.first().map(|moment| moment.position), Some(2_000_u64.next_multiple_of(hop)));
        assert!(moments.last().is_some_and(|last| last.heard.features.volume[0] > 0.1));
    }

    #[test]
    fn an_offset_is_no_signal() {
        assert!(!has_signal(&[[0.5, -0.5]; 100]));
        assert!(!has_signal(&[]));
        assert!(!has_signal(&[[f32::NAN; 2], [0.0; 2]]));
        assert!(has_signal(&[[0.0, 0.0], [0.0, 0.001]]));
        let (mut listener, _heard) = listener();
        let (mut tap, link) = InputCallback::new(8_000, std::thread::current());
        listener.attach(Some(link));
        std::thread::sleep(Duration::from_millis(30));
        tap.receive(&[0.3_f32; 500], 1);
        listener.listen();
        assert!(listener.ear.flat_for() >= 0.03, "{}", listener.ear.flat_for());
        tap.receive(&tone(500), 1);
        listener.listen();
        assert!(listener.ear.flat_for() < 0.03, "{}", listener.ear.flat_for());
    }
}
