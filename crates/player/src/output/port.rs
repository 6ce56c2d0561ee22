//! The output's port for the supervisor opens devices for an [`OutputCallback`], or starts the silent clock.

use std::io;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use cpal::traits::DeviceTrait;
use cpal::{BufferSize, FromSample, SizedSample, StreamConfig};

use super::output_callback::{Controls, OutputCallback, OutputCallbackLink};
use crate::clock::SpanHistory;
use crate::device::{
    BUILD_LIMIT, Candidate, OnFailure, OpenResult, Opened, Port, Running, Target, buffer_frames, converts,
    error_callback, find, with_sample_type,
};
use crate::device_list::FoundDevice;
use crate::devices::{for_playback, hush_sound_library};
use crate::error::{DeviceError, Direction};
use crate::supervisor::SharedStatus;
use mariana_work::{Latest, looping};

/// Number of frames per callback to request at 44.1 and 48 kHz: 21 ms.
const BUFFER_FRAMES: u32 = 1024;

/// The supervisor of the output. Its note is the history of audible frames; `None` before the first output is open.
pub(crate) type Supervisor = crate::supervisor::Supervisor<OutputPort>;

/// Its note is the history of the current output.
pub(crate) type OutputWatch = SharedStatus<Option<Arc<SpanHistory>>>;

pub(crate) struct OutputPort {
    pub(crate) controls: Arc<Controls>,
    /// The silent clock's frames per second.
    pub(crate) silent_rate: u32,
    /// Takes each new output, before the previous output is closed.
    pub(crate) deliver: Box<dyn FnMut(OutputCallbackLink) + Send>,
}

impl Port for OutputPort {
    type Link = OutputCallbackLink;
    type Note = Option<Arc<SpanHistory>>;

    const DIRECTION: Direction = Direction::Output;

    fn opener(&self) -> impl FnOnce(Target, OnFailure) -> OpenResult<OutputCallbackLink> + Send + 'static {
        let controls = self.controls.clone();
        move |target, on_failure| open(&target, &controls, &on_failure)
    }

    fn describe(link: &OutputCallbackLink) -> Self::Note {
        Some(link.history.clone())
    }

    fn stand_in(&self) -> io::Result<Option<(Latest<()>, OutputCallbackLink)>> {
        let rate = self.silent_rate;
        let (output_callback, link) = OutputCallback::new(rate, 0, self.controls.clone());
        Ok(Some((start_silent_clock(output_callback, rate)?, link)))
    }

    fn ready(&mut self, link: Option<OutputCallbackLink>) {
        link.map(&mut self.deliver);
    }
}

/// May block as long as the sound system does. Requests a buffer size, because PulseAudio's default is 2 s.
fn open(target: &Target, controls: &Arc<Controls>, on_failure: &OnFailure) -> OpenResult<OutputCallbackLink> {
    hush_sound_library();
    let direction = Direction::Output;
    let FoundDevice { device, entry } = find(direction, target)?;
    let candidate = Candidate { direction, target, name: format!("'{}'", entry.name) };
    let refused = |error| candidate.refused(&error);
    let (device, connection) = for_playback(device).map_err(refused)?;
    let supported = device.default_output_config().map_err(refused)?;
    let rate = candidate.usable_rate(supported.sample_rate(), converts(&device))?;
    let frames = buffer_frames(BUFFER_FRAMES, rate, *supported.buffer_size());
    let format = supported.sample_format();
    let attempt = |buffer_size| -> Result<_, DeviceError> {
        let config = StreamConfig { buffer_size, sample_rate: rate, ..supported.config() };
        let (output_callback, link) = OutputCallback::new(rate, frames as usize, controls.clone());
        let glitches = controls.clone();
        let on_error = error_callback(on_failure.clone(), move || {
            glitches.underruns.fetch_add(1, Ordering::Relaxed);
        });
        let built = with_sample_type!(format, build(&device, config, output_callback, on_error));
        let stream = candidate.play(built, format)?;
        let buffer = match buffer_size {
            BufferSize::Fixed(frames) => format!("{frames} frames"),
            BufferSize::Default => "its own buffer".into(),
        };
        Ok((stream, link, buffer))
    };
    let (stream, link, buffer) =
        attempt(BufferSize::Fixed(frames)).or_else(|_| attempt(BufferSize::Default))?;
    let channels = supported.channels();
    let host = device.id().map_or("unknown host", |id| id.host().name());
    let name = &candidate.name;
    let description = format!("{host}: {name}, {rate} Hz, {channels} channels, {format}, {buffer}");
    let history = link.history.clone();
    history.set_device(&entry.id);
    let calls = Box::new(move || history.calls());
    let at_server = connection.at_server();
    let running = Running { _stream: stream, _connection: Some(connection) };
    Ok((running, Opened { link, entry, description, calls, connection: at_server }))
}

/// Boxed, so that cpal's code for streams is compiled once and not for each type of samples.
type Callback = Box<dyn FnMut(&mut cpal::Data, &cpal::OutputCallbackInfo) + Send>;

fn build<T: SizedSample + FromSample<f32>>(
    device: &cpal::Device,
    config: StreamConfig,
    mut output_callback: OutputCallback,
    on_error: Box<dyn FnMut(cpal::Error) + Send>,
) -> Result<cpal::Stream, cpal::Error> {
    let channels = usize::from(config.channels);
    let callback: Callback = Box::new(move |data, info| {
        let Some(data) = data.as_slice_mut::<T>() else { return };
        let stamps = info.timestamp();
        let latency =
            stamps.playback.checked_duration_since(stamps.callback).filter(|latency| !latency.is_zero());
        output_callback.fill(data, channels, Instant::now(), latency);
    });
    device.build_output_stream_raw(config, T::FORMAT, callback, on_error, Some(BUILD_LIMIT))
}

// The silent clock takes frames in real time like a device and discards them. If no device is usable, or if a device
// is lost, a thread calls the same `OutputCallback`, so that the song continues. Frames are stamped with their due
// time, so that the song's pace does not depend on the thread's scheduling.

const PERIOD: Duration = Duration::from_millis(10);

/// After a gap longer than this (the process was suspended) the clock restarts, because the ring may lack frames.
const GAP_MAX: Duration = Duration::from_millis(250);

const END_LIMIT: Duration = Duration::from_millis(500);

fn start_silent_clock(mut output_callback: OutputCallback, rate: u32) -> io::Result<Latest<()>> {
    let clock = looping("silent clock", (), move |shared| {
        let mut buffer = Vec::new();
        let mut start = Instant::now();
        let mut taken = 0_u64;
        while !shared.is_over() {
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
            output_callback.fill(&mut buffer, 2, due_at, Some(Duration::ZERO));
            taken = due;
            let next = PERIOD * ((passed.as_nanos() / PERIOD.as_nanos()) as u32 + 1);
            std::thread::sleep(next.saturating_sub(start.elapsed()));
        }
    })?;
    Ok(clock.finished_at_drop(END_LIMIT))
}
