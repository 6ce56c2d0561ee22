//! The silent clock takes frames in real time like a device and discards them. If no device is usable, or if a device
//! is lost, a thread calls the same `OutputCallback`, so that the song continues. Frames are stamped with their due
//! time, so that the song's pace does not depend on the thread's scheduling.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::output_callback::OutputCallback;
use crate::worker::Worker;

const PERIOD: Duration = Duration::from_millis(10);

/// After a gap longer than this (the process was suspended) the clock restarts, because the ring may lack frames.
const GAP_MAX: Duration = Duration::from_millis(250);

pub(crate) struct NullOutput {
    stop: Arc<AtomicBool>,
    worker: Worker,
}

impl NullOutput {
    pub(crate) fn start(mut output_callback: OutputCallback, rate: u32) -> io::Result<Self> {
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = stop.clone();
        let worker = Worker::spawn("silent clock", move || {
            let mut buffer = Vec::new();
            let mut start = Instant::now();
            let mut taken = 0_u64;
            while !stopped.load(Ordering::Relaxed) {
                let passed = start.elapsed();
                // Count from the start, so that the errors of each sleep do not add up.
                let due = (passed.as_nanos() * u128::from(rate) / 1_000_000_000) as u64;
                let frames = due.saturating_sub(taken);
                if frames > (GAP_MAX.as_secs_f64() * f64::from(rate)) as u64 {
                    (start, taken) = (Instant::now(), 0);
                    continue;
                }
                buffer.resize(2 * frames as usize, 0.0_f32);
                let due_at = start + Duration::from_secs_f64(taken as f64 / f64::from(rate.max(1)));
                output_callback.serve_at(&mut buffer, 2, due_at, Some(Duration::ZERO));
                taken = due;
                let next = PERIOD * ((passed.as_nanos() / PERIOD.as_nanos()) as u32 + 1);
                std::thread::sleep(next.saturating_sub(start.elapsed()));
            }
        })?;
        Ok(Self { stop, worker })
    }
}

impl Drop for NullOutput {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        self.worker.join_within(Duration::from_millis(500));
    }
}
