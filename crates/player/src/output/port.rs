//! The output's port for the supervisor opens devices for an [`OutputCallback`], or starts the silent clock.

use std::io;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use cpal::traits::{DeviceTrait, StreamTrait};
use cpal::{BufferSize, ErrorKind, FromSample, SizedSample, StreamConfig};

use super::null_output::NullOutput;
use super::output_callback::{Controls, Counters, OutputCallback, OutputCallbackLink};
use crate::clock::SpanHistory;
use crate::device::{
    BUILD_LIMIT, OnFailure, OpenResult, Opened, Port, Running, Target, buffer_frames, converts,
    error_callback, find, refusal, usable_rate, with_sample_type,
};
use crate::device_list::{FoundDevice, ListedDevice};
use crate::error::{DeviceError, Direction};
use crate::hosts::{for_playback, hush_sound_library};
use crate::supervisor::{NoteReader, StreamStatus, Supervisor as Watching};

/// Number of frames per callback to request at 44.1 and 48 kHz: 21 ms.
const BUFFER_FRAMES: u32 = 1024;

/// The kind of output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OutputChoice {
    /// A device if one can be opened, otherwise the silent clock.
    #[default]
    Auto,
    /// The silent clock.
    Silent,
}

/// The settings of a [`Supervisor`].
pub struct OutputRequest {
    /// The kind of output.
    pub choice: OutputChoice,
    /// The device.
    pub target: Target,
    /// The silent clock's frames per second.
    pub silent_rate: u32,
}

/// The current output.
#[derive(Clone, Default)]
pub struct OutputStatus {
    /// A description of the output.
    pub description: String,
    /// The device; `None` on the silent clock.
    pub device: Option<ListedDevice>,
    /// The reason for the silence; `None` if there is sound.
    pub silent: Option<String>,
    /// The reason why the chosen device could not be opened, while the previous device continues.
    pub refused: Option<String>,
    /// The history of audible frames; `None` before the first output is open.
    pub history: Option<Arc<SpanHistory>>,
    /// The number of times that a device was opened.
    pub openings: u64,
}

/// Opens and monitors the output. Dropping the supervisor closes the output.
pub struct Supervisor(Watching<OutputPort>);

impl Supervisor {
    /// Starts the supervisor. Each new output is passed to `deliver`. The previous output is then closed.
    ///
    /// # Errors
    /// Fails if a thread cannot be started.
    pub fn start(
        request: OutputRequest,
        controls: Arc<Controls>,
        counters: Arc<Counters>,
        deliver: impl FnMut(OutputCallbackLink) + Send + 'static,
    ) -> io::Result<Self> {
        let target = (request.choice == OutputChoice::Auto).then_some(request.target);
        let port = OutputPort {
            controls,
            counters,
            silent_rate: request.silent_rate,
            deliver: Box::new(deliver),
            waiting: None,
        };
        Watching::start(port, target).map(Self)
    }

    /// Switches to another device. The current device continues until the new device is open.
    pub fn choose(&self, target: Target) {
        self.0.choose(target);
    }

    /// The current output.
    pub fn status(&self) -> OutputStatus {
        let StreamStatus { description, device, silent, refused, note: history, openings } = self.0.status();
        OutputStatus { description, device, silent, refused, history, openings }
    }

    pub(crate) fn watch(&self) -> OutputWatch {
        OutputWatch(self.0.notes())
    }
}

#[derive(Clone)]
pub(crate) struct OutputWatch(NoteReader<Option<Arc<SpanHistory>>>);

impl OutputWatch {
    pub(crate) fn history(&self) -> Option<Arc<SpanHistory>> {
        self.0.describe()
    }
}

struct OutputPort {
    controls: Arc<Controls>,
    counters: Arc<Counters>,
    silent_rate: u32,
    deliver: Box<dyn FnMut(OutputCallbackLink) + Send>,
    /// The silent clock's link, kept here until the clock's status is published.
    waiting: Option<OutputCallbackLink>,
}

impl Port for OutputPort {
    type Link = OutputCallbackLink;
    type Note = Option<Arc<SpanHistory>>;
    type StandIn = NullOutput;

    const DIRECTION: Direction = Direction::Output;
    const STAND_IN: &'static str = "silent clock";

    fn opener(&self) -> impl FnOnce(Target, OnFailure) -> OpenResult<OutputCallbackLink> + Send + 'static {
        let (controls, counters) = (self.controls.clone(), self.counters.clone());
        move |target, on_failure| open(&target, &controls, &counters, &on_failure)
    }

    fn describe(link: &OutputCallbackLink) -> Self::Note {
        Some(link.history.clone())
    }

    fn ready(&mut self, link: OutputCallbackLink) {
        (self.deliver)(link);
    }

    fn stand_in(&mut self) -> io::Result<(Option<NullOutput>, Self::Note)> {
        let rate = self.silent_rate;
        let (output_callback, link) =
            OutputCallback::new(rate, 0, self.controls.clone(), self.counters.clone());
        let clock = NullOutput::start(output_callback, rate)?;
        link.history.set_silent();
        let note = Self::describe(&link);
        self.waiting = Some(link);
        Ok((Some(clock), note))
    }

    fn stood_in(&mut self) {
        if let Some(link) = self.waiting.take() {
            (self.deliver)(link);
        }
    }
}

/// May block as long as the sound system does. Requests a buffer size, because PulseAudio's default is 2 s.
fn open(
    target: &Target,
    controls: &Arc<Controls>,
    counters: &Arc<Counters>,
    on_failure: &OnFailure,
) -> OpenResult<OutputCallbackLink> {
    hush_sound_library();
    let direction = Direction::Output;
    let FoundDevice { device, entry } = find(direction, target)?;
    let name = format!("'{}'", entry.name);
    let refused = |error: cpal::Error| (refusal(direction, &name, target, &error), error.kind());
    let (device, connection) = for_playback(device).map_err(refused)?;
    let supported = device.default_output_config().map_err(refused)?;
    let reported_rate = supported.sample_rate();
    let rate = usable_rate(reported_rate, converts(&device)).ok_or_else(|| {
        let error = DeviceError::Rate { direction, device: name.clone(), rate: reported_rate };
        (error, ErrorKind::UnsupportedConfig)
    })?;
    let frames = buffer_frames(BUFFER_FRAMES, rate, *supported.buffer_size());
    let format = supported.sample_format();
    let mut last_error = None;
    for buffer_size in [BufferSize::Fixed(frames), BufferSize::Default] {
        let config = StreamConfig { buffer_size, sample_rate: rate, ..supported.config() };
        let (output_callback, link) =
            OutputCallback::new(rate, frames as usize, controls.clone(), counters.clone());
        let glitches = counters.clone();
        let on_error = error_callback(on_failure.clone(), move || {
            glitches.underruns.fetch_add(1, Ordering::Relaxed);
        });
        let Some(built) = with_sample_type!(format, build(&device, config, output_callback, on_error)) else {
            let error = DeviceError::Format { direction, device: name, format: format.to_string() };
            return Err((error, ErrorKind::UnsupportedConfig));
        };
        match built.and_then(|stream| stream.play().map(|()| stream)) {
            Ok(stream) => {
                let buffer = match buffer_size {
                    BufferSize::Fixed(frames) => format!("{frames} frames"),
                    BufferSize::Default => "its own buffer".into(),
                };
                let channels = config.channels;
                let host = device.id().map_or("unknown host", |id| id.host().name());
                let description =
                    format!("{host}: {name}, {rate} Hz, {channels} channels, {format}, {buffer}");
                let history = link.history.clone();
                history.set_device(&entry.id);
                let calls = Box::new(move || history.calls());
                let at_server = connection.at_server();
                let running = Running { _stream: stream, _connection: Some(connection) };
                return Ok((running, Opened { link, entry, description, calls, connection: at_server }));
            }
            Err(error) => last_error = Some(error),
        }
    }
    let none = (DeviceError::NoDevice(direction), ErrorKind::DeviceNotAvailable);
    Err(last_error.map_or(none, refused))
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
        output_callback.serve(data, channels, latency);
    });
    device.build_output_stream_raw(config, T::FORMAT, callback, on_error, Some(BUILD_LIMIT))
}
