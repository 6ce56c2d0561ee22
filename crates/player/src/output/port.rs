//! The output's side of the supervisor: opens devices for an [`OutputCallback`], and puts the silent clock in their
//! place.

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
use crate::device_list::ListedDevice;
use crate::error::{DeviceError, Direction};
use crate::hosts::{for_playback, hush_sound_library};
use crate::supervisor::{NoteReader, StreamStatus, Supervisor as Watching};

/// Frames per callback that are asked for at 44.1 and 48 kHz: 21 ms.
const BUFFER_FRAMES: u32 = 1024;

/// What to play on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OutputChoice {
    /// A device if there is one, otherwise the silent clock.
    #[default]
    Auto,
    /// The silent clock.
    Silent,
}

/// Settings of a [`Supervisor`].
pub struct OutputRequest {
    /// What to play on.
    pub choice: OutputChoice,
    /// Which device.
    pub target: Target,
    /// Frames per second of the silent clock.
    pub silent_rate: u32,
}

/// What is played on now.
#[derive(Clone, Default)]
pub struct OutputStatus {
    /// In words.
    pub description: String,
    /// The device, if there is one.
    pub device: Option<ListedDevice>,
    /// Why there is no sound, if there is none.
    pub silent: Option<String>,
    /// Why the choice is not open, while the previous device goes on.
    pub refused: Option<String>,
    /// The history of what is audible; none while nothing is open yet.
    pub history: Option<Arc<SpanHistory>>,
    /// How often a device was opened.
    pub openings: u64,
}

/// Watches over the output. Ends when dropped.
pub struct Supervisor(Watching<OutputPort>);

impl Supervisor {
    /// Starts the supervisor. Each output that becomes ready is handed to `deliver`, and the previous one is then
    /// given up.
    ///
    /// # Errors
    /// A thread cannot be started.
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

    /// Changes to another device; the present one goes on until the other is there.
    pub fn choose(&self, target: Target) {
        self.0.choose(target);
    }

    /// What is played on now.
    pub fn status(&self) -> OutputStatus {
        let StreamStatus { description, device, silent, refused, note: history, openings } = self.0.status();
        OutputStatus { description, device, silent, refused, history, openings }
    }

    /// Follows the present output from any thread.
    pub(crate) fn watch(&self) -> OutputWatch {
        OutputWatch(self.0.notes())
    }
}

/// The present output's history, for any thread.
#[derive(Clone)]
pub(crate) struct OutputWatch(NoteReader<Option<Arc<SpanHistory>>>);

impl OutputWatch {
    /// The history; `None` while no output is open yet.
    pub(crate) fn history(&self) -> Option<Arc<SpanHistory>> {
        self.0.note()
    }
}

struct OutputPort {
    controls: Arc<Controls>,
    counters: Arc<Counters>,
    silent_rate: u32,
    deliver: Box<dyn FnMut(OutputCallbackLink) + Send>,
    /// The silent clock's link until its status is published.
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

    fn note(link: &OutputCallbackLink) -> Self::Note {
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
        let note = Self::note(&link);
        self.waiting = Some(link);
        Ok((Some(clock), note))
    }

    fn stood_in(&mut self) {
        if let Some(link) = self.waiting.take() {
            (self.deliver)(link);
        }
    }
}

/// Opens and starts an output. Blocks as long as the sound system likes. A buffer size is always requested, because
/// PulseAudio's default is two seconds.
fn open(
    target: &Target,
    controls: &Arc<Controls>,
    counters: &Arc<Counters>,
    on_failure: &OnFailure,
) -> OpenResult<OutputCallbackLink> {
    hush_sound_library();
    let direction = Direction::Output;
    let device = find(direction, target)?;
    let entry = ListedDevice::of(&device);
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

fn build<T: SizedSample + FromSample<f32>>(
    device: &cpal::Device,
    config: StreamConfig,
    mut output_callback: OutputCallback,
    on_error: impl FnMut(cpal::Error) + Send + 'static,
) -> Result<cpal::Stream, cpal::Error> {
    let channels = usize::from(config.channels);
    let callback = move |data: &mut [T], info: &cpal::OutputCallbackInfo| {
        let stamps = info.timestamp();
        let latency =
            stamps.playback.checked_duration_since(stamps.callback).filter(|latency| !latency.is_zero());
        output_callback.serve(data, channels, latency);
    };
    device.build_output_stream(config, callback, on_error, Some(BUILD_LIMIT))
}
