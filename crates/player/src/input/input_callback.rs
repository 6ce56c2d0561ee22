//! The audio callback of an input copies frames into a ring and counts them. The callback never locks, allocates,
//! frees, logs or panics. It wakes the listening thread without a lock.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::Thread;

use cpal::{FromSample, Sample};
use rtrb::{Consumer, Producer, RingBuffer};

use crate::decode::Downmix;
use mariana_music::StereoFrame;

const CHUNK: usize = 256;

/// Length of the ring, in seconds. If the listening thread is late by more than this, frames are lost.
const RING: f64 = 0.5;

/// The callback's counters.
#[derive(Default)]
pub struct InputCounters {
    /// Calls of the callback.
    pub calls: AtomicU64,
    /// Number of frames that did not fit into the ring, plus glitches that the device reported.
    pub lost: AtomicU64,
}

/// The listening thread's end of an [`InputCallback`].
pub struct InputCallbackLink {
    /// The device's frames per second.
    pub rate: u32,
    /// The callback's counters.
    pub counters: Arc<InputCounters>,
    /// The received frames.
    pub ring: Consumer<StereoFrame>,
}

/// The callback of one input device.
pub struct InputCallback {
    counters: Arc<InputCounters>,
    ring: Producer<StereoFrame>,
    listener: Thread,
    chunk: [StereoFrame; CHUNK],
    /// The mix of channels with known positions.
    downmix: Option<Downmix>,
}

impl InputCallback {
    /// Creates the callback for a device with `rate` frames per second, and its link. Each buffer wakes `listener`.
    pub fn new(rate: u32, listener: Thread) -> (Self, InputCallbackLink) {
        let (producer, ring) = RingBuffer::new(((RING * f64::from(rate)) as usize).max(CHUNK));
        let counters = Arc::new(InputCounters::default());
        let link = InputCallbackLink { rate: rate.max(1), counters: counters.clone(), ring };
        (Self { counters, ring: producer, listener, chunk: [[0.0; 2]; CHUNK], downmix: None }, link)
    }

    /// Mixes all of `channels` channels, which are in the order of WAVE files.
    #[must_use]
    pub(super) fn mixing(self, channels: u16) -> Self {
        Self { downmix: Some(Downmix::of_speakers(channels)), ..self }
    }

    /// Receives a device's buffer: `data` with `channels` interleaved channels. A single channel goes to both sides. Of
    /// more than two channels without known positions, the first two are used. An incomplete frame at the end is
    /// ignored. Frames that do not fit into the ring are lost and counted.
    pub fn receive<T: Sample>(&mut self, data: &[T], channels: usize)
    where
        f32: FromSample<T>,
    {
        let channels = channels.max(1);
        for block in data.chunks(CHUNK * channels) {
            let mut count = 0;
            for (frame, samples) in self.chunk.iter_mut().zip(block.chunks_exact(channels)) {
                *frame = match (samples, &self.downmix) {
                    (_, Some(downmix)) => downmix.mix_frame(samples.iter().map(|s| f32::from_sample(*s))),
                    ([mono], None) => [f32::from_sample(*mono); 2],
                    ([left, right, ..], None) => [f32::from_sample(*left), f32::from_sample(*right)],
                    ([], None) => [0.0; 2],
                };
                count += 1;
            }
            let (_, lost) = self.ring.push_partial_slice(&self.chunk[..count]);
            self.counters.lost.fetch_add(lost.len() as u64, Ordering::Relaxed);
        }
        self.counters.calls.fetch_add(1, Ordering::Relaxed);
        self.listener.unpark();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn tap(rate: u32) -> (InputCallback, InputCallbackLink) {
        InputCallback::new(rate, std::thread::current())
    }

    fn heard(link: &mut InputCallbackLink) -> Vec<StereoFrame> {
        std::iter::from_fn(|| link.ring.pop().ok()).collect()
    }

    #[test]
    fn every_layout_of_channels_becomes_left_and_right() {
        let (mut tap, mut link) = tap(48_000);
        tap.receive(&[0.25_f32, -0.5], 1);
        assert_eq!(heard(&mut link), [[0.25; 2], [-0.5; 2]]);
        tap.receive(&[0.1_f32, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7], 3);
        assert_eq!(heard(&mut link), [[0.1, 0.2], [0.4, 0.5]]);
        tap.receive(&[i16::MIN, 16_384], 2);
        assert_eq!(heard(&mut link), [[-1.0, 0.5]]);
        tap.receive(&[0_u8, 128], 2);
        assert_eq!(heard(&mut link), [[-1.0, 0.0]]);
        // No device has zero channels.
        tap.receive(&[0.5_f32], 0);
        assert_eq!(heard(&mut link), [[0.5; 2]]);
        assert_eq!(link.counters.calls.load(Ordering::Relaxed), 5);
    }

    #[test]
    fn a_bass_that_is_only_in_the_lfe_channel_is_heard() {
        let (tap, mut link) = tap(48_000);
        tap.mixing(8).receive(&[0.0_f32, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0], 8);
        let [[left, right]] = heard(&mut link)[..] else { panic!("one frame was sent") };
        assert!(left > 0.05 && left == right, "{left} {right}");
    }

    proptest! {
        #[test]
        fn lost_frames_are_counted(sizes in prop::collection::vec((0_usize..3000, any::<bool>()), 1..40)) {
            let (mut tap, mut link) = tap(8_000);
            let (mut sent, mut got) = (0_u32, Vec::new());
            for (size, read) in sizes {
                let data: Vec<f32> = (0..size).map(|n| (sent + n as u32) as f32).collect();
                sent += size as u32;
                tap.receive(&data, 1);
                if read {
                    got.extend(heard(&mut link).into_iter().map(|frame| frame[0] as u32));
                }
            }
            got.extend(heard(&mut link).into_iter().map(|frame| frame[0] as u32));
            prop_assert!(got.is_sorted_by(|a, b| a < b));
            let lost = link.counters.lost.load(Ordering::Relaxed);
            prop_assert_eq!(got.len() as u64 + lost, u64::from(sent));
        }
    }
}
