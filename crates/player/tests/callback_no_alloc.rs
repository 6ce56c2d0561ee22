//! Tests that the audio callbacks neither allocate nor free memory.

#![allow(clippy::expect_used)]

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use mariana_player::input::InputCallback;
use mariana_player::output::{Controls, OutputCallback, Segment};

// In debug builds this allocator ends the process at the first allocation or release inside `assert_no_alloc`.
#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

/// Pseudo-random numbers (xorshift; G. Marsaglia, 2003).
struct Random(u64);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % limit as u64) as usize
    }
}

#[test]
fn many_events_allocate_nothing_in_the_callback() {
    let controls = Arc::new(Controls::new(1.0, false));
    let (mut output_callback, mut link) = OutputCallback::new(48_000, 1024, controls.clone());
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let (mut ring, mut end, first) = Segment::new(1, 19_200);
    assert!(link.offer(first).is_ok());
    let mut next_ring = None;
    let mut segments = 1_u64;
    let mut frames = 0;
    let mut samples = vec![0.0_f32; 4096 * 6];
    let mut integers = vec![0_i16; 4096 * 6];
    let mut loudest = 0.0_f32;
    while frames < 4_000_000 {
        match random.below(40) {
            0 => controls.set_paused(!controls.paused()),
            1 => controls.set_muted(!controls.muted()),
            2 => controls.set_volume(random.below(1000) as f32 / 1000.0),
            3 | 4 => {
                segments += 1;
                let (producer, last, segment) = Segment::new(segments, 1 + random.below(19_200));
                if link.offer(segment).is_ok() {
                    next_ring = Some((producer, last));
                }
            }
            5 => end.store(0, Ordering::Release),
            6..12 => link.clean_up(),
            12 => (ring, end) = next_ring.take().unwrap_or((ring, end)),
            _ => {
                let room = ring.slots().min(random.below(6000));
                let block: Vec<_> = (0..room).map(|n| [(n as f32 * 0.1).sin(), 0.5]).collect();
                ring.push_entire_slice(&block).expect("there is room");
            }
        }
        let size = random.below(4097);
        let channels = 1 + random.below(6);
        // The buffers include some with an incomplete last frame.
        let length = size * channels + if channels > 1 { random.below(2) } else { 0 };
        let length = length.min(samples.len());
        let latency = [None, Some(Duration::from_millis(20)), Some(Duration::MAX)][random.below(3)];
        let now = Instant::now();
        assert_no_alloc(|| match size % 3 {
            0 => output_callback.fill(&mut integers[..length], channels, now, latency),
            1 => output_callback.fill(&mut samples[..length], channels, now, latency),
            _ => output_callback.fill(&mut samples[..length], channels, Instant::now(), latency),
        });
        loudest = samples[..length].iter().fold(loudest, |loudest, sample| loudest.max(sample.abs()));
        frames += length / channels;
    }
    assert!(segments > 50 && controls.underruns.load(Ordering::Relaxed) > 50, "too little happened");
    assert!(loudest > 0.5 && loudest <= 1.0, "{loudest}");
}

const CALLS: usize = 1_000_000;

#[test]
fn a_million_buffers_of_any_size_allocate_nothing_in_the_inputs_callback() {
    let (mut tap, mut link) = InputCallback::new(48_000, std::thread::current());
    let mut random = Random(0x2545_f491_4f6c_dd1d);
    let samples: Vec<f32> = (0..4096).map(|n| (n as f32 * 0.01).sin()).collect();
    let integers: Vec<i16> = (0..4096).map(|n| (n * 7) as i16).collect();
    let bytes: Vec<u8> = (0..4096).map(|n| n as u8).collect();
    let (mut sent, mut read) = (0, 0);
    for _ in 0..CALLS {
        let channels = 1 + random.below(8);
        // Buffers are mostly small, so that a million of them take little time. Some buffers do not fit into the ring
        // or end with an incomplete frame.
        let length = if random.below(50) == 0 { random.below(4097) } else { random.below(65) };
        assert_no_alloc(|| match length % 3 {
            0 => tap.receive(&integers[..length], channels),
            1 => tap.receive(&samples[..length], channels),
            _ => tap.receive(&bytes[..length], channels),
        });
        sent += (length / channels) as u64;
        if random.below(300) == 0 {
            let chunk = link.ring.read_chunk(link.ring.slots()).expect("a chunk of available frames");
            read += chunk.len() as u64;
            chunk.commit_all();
        }
    }
    read += link.ring.slots() as u64;
    let lost = link.counters.lost.load(Ordering::Relaxed);
    assert_eq!(link.counters.calls.load(Ordering::Relaxed), CALLS as u64);
    assert_eq!(read + lost, sent);
}
