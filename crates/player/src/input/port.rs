//! The input's port for the supervisor: opens devices for an [`InputCallback`].

use std::io;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::Sender;
use std::thread::Thread;

use cpal::traits::DeviceTrait;
use cpal::{BufferSize, FromSample, SampleFormat, SizedSample, StreamConfig};

use super::input_callback::{InputCallback, InputCallbackLink, InputCounters};
use crate::device::{
    BUILD_LIMIT, Candidate, OnFailure, OpenResult, Opened, Port, Running, Target, buffer_frames, converts,
    error_callback, find, with_sample_type,
};
use crate::device_list::FoundDevice;
use crate::devices::hush_sound_library;
use crate::error::{DeviceError, Direction};
use mariana_work::Latest;

/// Number of frames per callback to request at 44.1 and 48 kHz: 11 ms, a hop of the analysis. Smaller buffers would not
/// reduce the delay, because features are computed once per hop, and each buffer costs the PulseAudio client about 0.1
/// ms.
const BUFFER_FRAMES: u32 = 512;

const MIXED_CHANNELS_MAX: u16 = 8;

pub(super) struct InputPort {
    /// Sends the link of each opened input, or `None` if no input is open.
    pub(super) links: Sender<Option<InputCallbackLink>>,
    pub(super) listener: Thread,
}

impl Port for InputPort {
    type Link = InputCallbackLink;
    type Note = Option<Arc<InputCounters>>;

    const DIRECTION: Direction = Direction::Input;

    fn opener(&self) -> impl FnOnce(Target, OnFailure) -> OpenResult<InputCallbackLink> + Send + 'static {
        let listener = self.listener.clone();
        move |target, on_failure| open(&target, &listener, &on_failure)
    }

    fn describe(link: &InputCallbackLink) -> Self::Note {
        Some(link.counters.clone())
    }

    fn stand_in(&self) -> io::Result<Option<(Latest<()>, InputCallbackLink)>> {
        Ok(None)
    }

    fn ready(&mut self, link: Option<InputCallbackLink>) {
        // A failed send means that the listening thread has ended.
        let _ = self.links.send(link);
        self.listener.unpark();
    }
}

/// Opens and starts an input. Blocks until the first samples arrive, or as long as the sound system does.
pub(super) fn open(
    target: &Target,
    listener: &Thread,
    on_failure: &OnFailure,
) -> OpenResult<InputCallbackLink> {
    hush_sound_library();
    let direction = Direction::Input;
    let FoundDevice { device, entry } = find(direction, target)?;
    let candidate = Candidate { direction, target, name: format!("'{}'", entry.name) };
    let refused = |error| candidate.refused(&error);
    let converted = converts(&device);
    let supported = if device.supports_input() {
        device.default_input_config().map_err(refused)?
    } else {
        device.default_output_config().map_err(refused)?
    };
    let rate = candidate.usable_rate(supported.sample_rate(), converted)?;
    let frames = buffer_frames(BUFFER_FRAMES, rate, *supported.buffer_size());
    // A server mixes down channels with known positions. Devices with more than 8 channels usually have no positions.
    let is_known = supported.channels() <= MIXED_CHANNELS_MAX;
    let channels = if converted && is_known { 2 } else { supported.channels() };
    // A recorded output has the positions of its speakers.
    let is_mixed_here = !converted && is_known && !device.supports_input();
    let format = if converted { SampleFormat::F32 } else { supported.sample_format() };
    let attempt = |buffer_size| -> Result<_, DeviceError> {
        let config = StreamConfig { channels, sample_rate: rate, buffer_size };
        let (tap, link) = InputCallback::new(rate, listener.clone());
        let tap = if is_mixed_here { tap.mixing(channels) } else { tap };
        let glitches = link.counters.clone();
        let on_error = error_callback(on_failure.clone(), move || {
            glitches.lost.fetch_add(1, Ordering::Relaxed);
        });
        let built = with_sample_type!(format, build(&device, config, tap, on_error));
        Ok((candidate.play(built, format)?, link))
    };
    let (stream, link) = attempt(BufferSize::Fixed(frames)).or_else(|_| attempt(BufferSize::Default))?;
    let host = device.id().map_or("unknown host", |id| id.host().name());
    let name = &candidate.name;
    let description = format!("{host}: {name}, {rate} Hz, {channels} channels, {format}");
    let counters = link.counters.clone();
    let calls = Box::new(move || counters.calls.load(Ordering::Relaxed));
    let running = Running { _stream: stream, _connection: None };
    Ok((running, Opened { link, entry, description, calls, connection: None }))
}

/// Boxed, so that cpal's code for streams is compiled once and not for each type of samples.
type Callback = Box<dyn FnMut(&cpal::Data, &cpal::InputCallbackInfo) + Send>;

fn build<T: SizedSample>(
    device: &cpal::Device,
    config: StreamConfig,
    mut tap: InputCallback,
    on_error: Box<dyn FnMut(cpal::Error) + Send>,
) -> Result<cpal::Stream, cpal::Error>
where
    f32: FromSample<T>,
{
    let channels = usize::from(config.channels);
    let callback: Callback = Box::new(move |data, _| {
        if let Some(data) = data.as_slice::<T>() {
            tap.receive(data, channels);
        }
    });
    device.build_input_stream_raw(config, T::FORMAT, callback, on_error, Some(BUILD_LIMIT))
}
