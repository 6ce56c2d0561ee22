//! Opens an output device and connects it to a [`Feeder`].
//!
//! Everything here may block for as long as the sound system likes: it runs on a thread that the supervisor can leave
//! behind. The buffer's size is always asked for, as the default of PulseAudio is two seconds.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use cpal::traits::{DeviceTrait, HostTrait, StreamTrait};
use cpal::{
    BufferSize, ErrorKind, FromSample, I24, SampleFormat, SizedSample, StreamConfig, SupportedBufferSize, U24,
};

use super::feeder::{Controls, Counters, Feeder, FeederLink};
use crate::audio::error::OutputError;

/// Frames per callback that are asked for at 44.1 and 48 kHz: 21 ms.
const BUFFER_FRAMES: u32 = 1024;

/// The rate for which [`BUFFER_FRAMES`] is meant, in hertz.
const BUFFER_RATE: u32 = 48_000;

/// How long a stream's creation may take, where the host can limit it.
const BUILD_LIMIT: Duration = Duration::from_secs(2);

/// A playing stream and what belongs to it.
pub(crate) struct Opened {
    /// Keeps the stream alive.
    pub(crate) stream: cpal::Stream,
    pub(crate) link: FeederLink,
    pub(crate) description: String,
}

/// The hosts of this system, the sound server first: it reports failures best, and it shares the device.
pub fn hosts_by_preference() -> Vec<cpal::HostId> {
    let mut hosts = cpal::available_hosts();
    hosts.sort_by_key(|host| !host.name().eq_ignore_ascii_case("pulseaudio"));
    hosts
}

/// Keeps libasound from printing on stderr what it also returns as an error, for this thread.
pub fn hush_sound_library() {
    #[cfg(target_os = "linux")]
    if let Err(error) = alsa::Output::local_error_handler() {
        tracing::debug!("libasound goes on printing: {error}");
    }
}

/// Opens and starts the output called `wanted`, or the default one. `on_failure` is called at most once, when the
/// stream fails later.
pub(crate) fn open(
    wanted: Option<&str>,
    controls: &Arc<Controls>,
    counters: &Arc<Counters>,
    on_failure: &Arc<dyn Fn(String) + Send + Sync>,
) -> Result<Opened, OutputError> {
    hush_sound_library();
    let device = match wanted {
        Some(name) => find_device(name).ok_or_else(|| OutputError::UnknownDevice(name.into()))?,
        None => default_device().ok_or(OutputError::NoDevice)?,
    };
    let name = format!(
        "'{}'",
        device.description().map_or_else(|_| "default".into(), |about| about.name().to_owned())
    );
    let refused = |error: cpal::Error| match error.kind() {
        ErrorKind::DeviceBusy => OutputError::Busy { device: name.clone() },
        // A default device may be a name with nothing behind it.
        ErrorKind::DeviceNotAvailable | ErrorKind::HostUnavailable if wanted.is_none() => {
            OutputError::NoDevice
        }
        _ => OutputError::Open { device: name.clone(), reason: sentence(&error) },
    };
    let supported = device.default_output_config().map_err(refused)?;
    let frames = buffer_frames(supported.sample_rate(), *supported.buffer_size());
    let format = supported.sample_format();
    let mut last_error = None;
    for buffer_size in [BufferSize::Fixed(frames), BufferSize::Default] {
        let config = StreamConfig { buffer_size, ..supported.config() };
        let (feeder, link) =
            Feeder::new(config.sample_rate, frames as usize, controls.clone(), counters.clone());
        let on_error = error_callback(on_failure.clone(), counters.clone());
        let built = match format {
            SampleFormat::F32 => build::<f32>(&device, config, feeder, on_error),
            SampleFormat::I16 => build::<i16>(&device, config, feeder, on_error),
            SampleFormat::I32 => build::<i32>(&device, config, feeder, on_error),
            SampleFormat::I24 => build::<I24>(&device, config, feeder, on_error),
            SampleFormat::U8 => build::<u8>(&device, config, feeder, on_error),
            SampleFormat::I8 => build::<i8>(&device, config, feeder, on_error),
            SampleFormat::U16 => build::<u16>(&device, config, feeder, on_error),
            SampleFormat::U24 => build::<U24>(&device, config, feeder, on_error),
            SampleFormat::U32 => build::<u32>(&device, config, feeder, on_error),
            SampleFormat::I64 => build::<i64>(&device, config, feeder, on_error),
            SampleFormat::U64 => build::<u64>(&device, config, feeder, on_error),
            SampleFormat::F64 => build::<f64>(&device, config, feeder, on_error),
            other => return Err(OutputError::Format { device: name, format: other.to_string() }),
        };
        match built.and_then(|stream| stream.play().map(|()| stream)) {
            Ok(stream) => {
                let buffer = match buffer_size {
                    BufferSize::Fixed(frames) => format!("{frames} frames"),
                    BufferSize::Default => "its own buffer".into(),
                };
                let StreamConfig { channels, sample_rate, .. } = config;
                let host = device.id().map_or("unknown host", |id| id.host().name());
                let description =
                    format!("{host}: {name}, {sample_rate} Hz, {channels} channels, {format}, {buffer}");
                return Ok(Opened { stream, link, description });
            }
            Err(error) => last_error = Some(error),
        }
    }
    Err(last_error.map_or(OutputError::NoDevice, refused))
}

fn default_device() -> Option<cpal::Device> {
    hosts_by_preference().into_iter().find_map(|host| cpal::host_from_id(host).ok()?.default_output_device())
}

/// The device with the id `wanted` (as `mariana devices` prints it), or else whose id or name contains it.
fn find_device(wanted: &str) -> Option<cpal::Device> {
    let hosts: Vec<_> =
        hosts_by_preference().into_iter().filter_map(|host| cpal::host_from_id(host).ok()).collect();
    let outputs: Vec<_> = hosts.iter().filter_map(|host| host.output_devices().ok()).flatten().collect();
    let lower = wanted.to_lowercase();
    let texts = |device: &cpal::Device| {
        let id = device.id().map(|id| id.to_string()).unwrap_or_default();
        let name = device.description().map(|about| about.name().to_owned()).unwrap_or_default();
        [id.to_lowercase(), name.to_lowercase()]
    };
    let position = outputs.iter().position(|device| texts(device).contains(&lower)).or_else(|| {
        outputs.iter().position(|device| texts(device).iter().any(|text| text.contains(&lower)))
    })?;
    outputs.into_iter().nth(position)
}

fn buffer_frames(rate: u32, supported: SupportedBufferSize) -> u32 {
    let scale = (f64::from(rate.max(1)) / f64::from(BUFFER_RATE)).log2().round().clamp(-3.0, 4.0);
    let frames = (f64::from(BUFFER_FRAMES) * scale.exp2()) as u32;
    match supported {
        SupportedBufferSize::Range { min, max } => frames.min(max).max(min).max(1),
        SupportedBufferSize::Unknown => frames,
    }
}

fn error_callback(
    on_failure: Arc<dyn Fn(String) + Send + Sync>,
    counters: Arc<Counters>,
) -> impl FnMut(cpal::Error) + Send + 'static {
    // A dead server may report its death a million times.
    let reported = AtomicBool::new(false);
    move |error| match error.kind() {
        ErrorKind::Xrun => {
            counters.underruns.fetch_add(1, Ordering::Relaxed);
        }
        // The stream goes on.
        ErrorKind::DeviceChanged | ErrorKind::RealtimeDenied => {}
        _ if reported.swap(true, Ordering::Relaxed) => {}
        _ => on_failure(sentence(&error)),
    }
}

/// What the system says, to be put into a sentence.
fn sentence(error: &cpal::Error) -> String {
    error.to_string().trim_end_matches('.').to_owned()
}

fn build<T: SizedSample + FromSample<f32>>(
    device: &cpal::Device,
    config: StreamConfig,
    mut feeder: Feeder,
    on_error: impl FnMut(cpal::Error) + Send + 'static,
) -> Result<cpal::Stream, cpal::Error> {
    let channels = usize::from(config.channels);
    let callback = move |data: &mut [T], info: &cpal::OutputCallbackInfo| {
        let stamps = info.timestamp();
        let latency =
            stamps.playback.checked_duration_since(stamps.callback).filter(|latency| !latency.is_zero());
        feeder.serve(data, channels, latency);
    };
    device.build_output_stream(config, callback, on_error, Some(BUILD_LIMIT))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_buffer_fits_the_rate_and_the_device() {
        let range = |min, max| SupportedBufferSize::Range { min, max };
        for (rate, supported, frames) in [
            (48_000, SupportedBufferSize::Unknown, 1024),
            (44_100, range(1, 100_000), 1024),
            (96_000, range(1, 100_000), 2048),
            (48_000, range(1, 512), 512),
            (48_000, range(4096, 8192), 4096),
            (48_000, range(0, 0), 1),
            (0, SupportedBufferSize::Unknown, 128),
        ] {
            assert_eq!(buffer_frames(rate, supported), frames, "{rate} Hz, {supported:?}");
        }
    }

    #[test]
    fn a_failure_is_reported_once_and_a_glitch_is_counted() {
        let failures = Arc::new(std::sync::Mutex::new(Vec::new()));
        let list = failures.clone();
        let counters = Arc::new(Counters::default());
        let mut report =
            error_callback(Arc::new(move |text| list.lock().expect("no panic").push(text)), counters.clone());
        for kind in [ErrorKind::Xrun, ErrorKind::DeviceChanged, ErrorKind::Xrun] {
            report(cpal::Error::new(kind));
        }
        assert!(failures.lock().expect("no panic").is_empty());
        (0..1000).for_each(|_| report(cpal::Error::with_message(ErrorKind::StreamInvalidated, "gone")));
        assert_eq!(*failures.lock().expect("no panic"), ["gone"]);
        assert_eq!(counters.underruns.load(Ordering::Relaxed), 2);
    }
}
