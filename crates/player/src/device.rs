//! Code for both output and input devices: how they are found and opened, and how cpal's errors are handled.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use cpal::traits::{DeviceTrait, HostTrait, StreamTrait};
use cpal::{ErrorKind, SupportedBufferSize};
use mariana_music::limits as music_limits;
use mariana_work::Latest;

use super::device_list::{FoundDevice, ListedDevice};
use super::devices::{PlaybackConnection, host, hosts_by_preference, is_server, is_watched, monitor_id};
use super::error::{DeviceError, Direction};
use super::server_connection::ServerConnection;

const BUFFER_RATE: u32 = 48_000;

/// The longest time for creating a stream, if the host can limit it.
pub(crate) const BUILD_LIMIT: Duration = Duration::from_secs(2);

/// The choice of a device.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Target {
    /// The system's default for the direction. If the default changes, the new default is used.
    Default,
    /// The input that records the default output. If the default output changes, the input changes too.
    Monitor,
    /// The device whose id or name equals or contains this text.
    Named(String),
    /// The device with this id while it is connected, otherwise the system's default. Follows changes of both.
    Preferred(String),
    /// The input that records the named output.
    MonitorOf(String),
}

/// A direction of sound, output or input, as the [`Supervisor`](super::supervisor::Supervisor) handles it.
pub(crate) trait Port: Sized + Send + 'static {
    /// The caller's end of a stream's callback.
    type Link: Send + 'static;
    /// Port-specific data about the open stream.
    type Note: Clone + Default + Send + 'static;

    const DIRECTION: Direction;

    /// Returns a function that opens and starts a device on another thread. The function may block.
    fn opener(&self) -> impl FnOnce(Target, OnFailure) -> OpenResult<Self::Link> + Send + 'static;
    fn describe(link: &Self::Link) -> Self::Note;
    /// Starts the substitute for a device, if there is one. Dropping it stops it.
    fn stand_in(&self) -> io::Result<Option<(Latest<()>, Self::Link)>>;
    /// Handles a newly opened device or its substitute, whose status is published already; `None` if neither is there.
    fn ready(&mut self, link: Option<Self::Link>);
}

pub(crate) struct Opened<L> {
    pub(crate) link: L,
    pub(crate) entry: ListedDevice,
    pub(crate) description: String,
    /// Returns the number of callback calls, which shows that the device is alive.
    pub(crate) calls: Box<dyn Fn() -> u64 + Send>,
    /// The connection that only this device uses. The supervisor closes the connection if the device does not close.
    pub(crate) connection: Option<ServerConnection>,
}

/// A stream. It must be dropped on the thread that created it.
pub(crate) struct Running {
    // The fields are dropped in this order: the connection is free once the stream is dropped.
    pub(crate) _stream: cpal::Stream,
    pub(crate) _connection: Option<PlaybackConnection>,
}

pub(crate) type OpenResult<L> = Result<(Running, Opened<L>), DeviceError>;

/// Takes the reason of a failure.
pub(crate) type OnFailure = Arc<dyn Fn(String) + Send + Sync>;

/// Returns the callback for errors of a running stream. It reports the first error that ends the stream.
pub(crate) fn error_callback(
    on_failure: OnFailure,
    xruns: impl Fn() + Send + 'static,
) -> Box<dyn FnMut(cpal::Error) + Send> {
    // A dead server may report the failure a million times.
    let reported = AtomicBool::new(false);
    Box::new(move |error| match error.kind() {
        ErrorKind::Xrun => xruns(),
        // The stream continues.
        ErrorKind::DeviceChanged | ErrorKind::RealtimeDenied => {}
        _ if reported.swap(true, Ordering::Relaxed) => {}
        _ => on_failure(sentence(&error)),
    })
}

/// The system's message, without a final full stop.
pub(crate) fn sentence(error: &cpal::Error) -> String {
    error.to_string().trim_end_matches('.').to_owned()
}

/// A device that is being opened.
pub(crate) struct Candidate<'a> {
    pub(crate) direction: Direction,
    pub(crate) target: &'a Target,
    /// The device's name in quotes.
    pub(crate) name: String,
}

impl Candidate<'_> {
    pub(crate) fn refused(&self, error: &cpal::Error) -> DeviceError {
        let (direction, device) = (self.direction, self.name.clone());
        match error.kind() {
            ErrorKind::DeviceBusy => DeviceError::Busy(direction, device),
            ErrorKind::PermissionDenied => DeviceError::Denied(direction, device),
            ErrorKind::UnsupportedConfig => DeviceError::Format(direction, device, "unusual".into()),
            // The default device may be only a name, without a device.
            ErrorKind::DeviceNotAvailable | ErrorKind::HostUnavailable
                if matches!(self.target, Target::Default | Target::Preferred(_)) =>
            {
                DeviceError::NoDevice(direction)
            }
            _ => DeviceError::Open(direction, device, sentence(error)),
        }
    }

    /// Returns the rate to request: the reported rate within the limits, or the nearest limit if a server converts.
    pub(crate) fn usable_rate(&self, rate: u32, converted: bool) -> Result<u32, DeviceError> {
        usable_rate(rate, converted).ok_or_else(|| DeviceError::Rate(self.direction, self.name.clone(), rate))
    }

    /// Starts a stream; `None` is a stream with samples that are not supported.
    pub(crate) fn play(
        &self,
        built: Option<Result<cpal::Stream, cpal::Error>>,
        format: cpal::SampleFormat,
    ) -> Result<cpal::Stream, DeviceError> {
        let stream = built
            .ok_or_else(|| DeviceError::Format(self.direction, self.name.clone(), format.to_string()))?;
        stream.and_then(|stream| stream.play().map(|()| stream)).map_err(|error| self.refused(&error))
    }
}

pub(crate) fn find(direction: Direction, target: &Target) -> Result<FoundDevice, DeviceError> {
    let hosts = || hosts_by_preference().into_iter().filter_map(|id| Some((id, host(id).ok()?)));
    let listed = |device| FoundDevice::of(direction, device);
    let default = || {
        let found = hosts().find_map(|(_, host)| match direction {
            Direction::Output => host.default_output_device(),
            Direction::Input => host.default_input_device(),
        });
        let found = found.ok_or(DeviceError::NoDevice(direction))?;
        Ok(FoundDevice { entry: ListedDevice::of(&found), device: found })
    };
    match target {
        Target::Default => default(),
        Target::Preferred(wanted) => {
            // Query only hosts with a watched device list, because querying each device is slow on other hosts.
            let devices = hosts().find(|(id, _)| is_watched(*id)).and_then(|(_, host)| host.devices().ok());
            let mut there = devices.into_iter().flatten().filter_map(listed);
            there.find(|found| found.entry.id == *wanted).map_or_else(default, Ok)
        }
        Target::Monitor => monitor().ok_or(DeviceError::NoLoopback),
        Target::Named(name) | Target::MonitorOf(name) => {
            let monitors_only = matches!(target, Target::MonitorOf(_));
            let devices = hosts().filter_map(|(_, host)| host.devices().ok()).flatten();
            let fitting =
                devices.filter_map(listed).filter(|found| !monitors_only || found.entry.is_monitor());
            best_match(fitting.collect(), name, |found| &found.entry)
                .ok_or_else(|| DeviceError::UnknownDevice(direction, name.clone()))
        }
    }
}

/// Returns the device whose id or name equals `wanted`, or else contains `wanted`. Monitors are chosen last.
fn best_match<T>(devices: Vec<T>, wanted: &str, entry_of: impl Fn(&T) -> &ListedDevice) -> Option<T> {
    let wanted = wanted.to_lowercase();
    let rank = |device: &T| {
        let entry = entry_of(device);
        let texts = [entry.id.to_lowercase(), entry.name.to_lowercase()];
        match (texts.contains(&wanted), texts.iter().any(|text| text.contains(&wanted))) {
            (true, _) => Some(0),
            (false, true) => Some(1 + u8::from(entry.is_monitor())),
            (false, false) => None,
        }
    };
    let ranked = devices.into_iter().filter_map(|device| Some((rank(&device)?, device)));
    ranked.min_by_key(|(rank, _)| *rank).map(|(_, device)| device)
}

/// Returns the monitor of the default output.
fn monitor() -> Option<FoundDevice> {
    let watched = hosts_by_preference().into_iter().find(|id| is_watched(*id))?;
    let host = host(watched).ok()?;
    let wanted = monitor_id(&host.default_output_device()?.id().ok()?.to_string());
    let mut inputs = host.devices().ok()?.filter_map(|device| FoundDevice::of(Direction::Input, device));
    inputs.find(|found| found.entry.id == wanted)
}

/// True if the device belongs to the sound server, which converts formats and rates.
pub(crate) fn converts(device: &cpal::Device) -> bool {
    device.id().is_ok_and(|id| is_server(id.host()))
}

fn usable_rate(rate: u32, converted: bool) -> Option<u32> {
    let (min, max) = (music_limits::SAMPLE_RATE_MIN, music_limits::SAMPLE_RATE_MAX);
    if converted { Some(rate.clamp(min, max)) } else { Some(rate).filter(|rate| (min..=max).contains(rate)) }
}

/// Scales `frames` by the power of two nearest to `rate` / `BUFFER_RATE`, clamped to the buffer sizes in `supported`.
pub(crate) fn buffer_frames(frames: u32, rate: u32, supported: SupportedBufferSize) -> u32 {
    let scale = (f64::from(rate.max(1)) / f64::from(BUFFER_RATE)).log2().round().clamp(-3.0, 4.0);
    let frames = (f64::from(frames) * scale.exp2()) as u32;
    match supported {
        SupportedBufferSize::Range { min, max } => frames.min(max).max(min).max(1),
        SupportedBufferSize::Unknown => frames,
    }
}

/// Calls a generic function with the sample type of a format. Other formats give `None`.
macro_rules! with_sample_type {
    ($format:expr, $function:ident($($argument:expr),*)) => {{
        use cpal::{I24, SampleFormat};
        match $format {
            SampleFormat::F32 => Some($function::<f32>($($argument),*)),
            SampleFormat::I16 => Some($function::<i16>($($argument),*)),
            SampleFormat::I32 => Some($function::<i32>($($argument),*)),
            SampleFormat::I24 => Some($function::<I24>($($argument),*)),
            SampleFormat::U8 => Some($function::<u8>($($argument),*)),
            _ => None,
        }
    }};
}
pub(crate) use with_sample_type;

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicU64;

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
            assert_eq!(buffer_frames(1024, rate, supported), frames, "{rate} Hz, {supported:?}");
        }
    }

    #[test]
    fn a_failure_is_reported_once_and_a_glitch_is_counted() {
        let failures = Arc::new(std::sync::Mutex::new(Vec::new()));
        let list = failures.clone();
        let xruns = Arc::new(AtomicU64::new(0));
        let counted = xruns.clone();
        let on_failure: OnFailure = Arc::new(move |reason| list.lock().expect("no panic").push(reason));
        let mut report = error_callback(on_failure, move || {
            counted.fetch_add(1, Ordering::Relaxed);
        });
        for kind in [ErrorKind::Xrun, ErrorKind::DeviceChanged, ErrorKind::RealtimeDenied, ErrorKind::Xrun] {
            report(cpal::Error::new(kind));
        }
        assert!(failures.lock().expect("no panic").is_empty());
        (0..1000).for_each(|_| report(cpal::Error::with_message(ErrorKind::StreamInvalidated, "gone.")));
        assert_eq!(*failures.lock().expect("no panic"), ["gone"]);
        assert_eq!(xruns.load(Ordering::Relaxed), 2);
    }

    #[test]
    fn every_kind_of_error_has_advice() {
        use ErrorKind::*;
        let kinds = [
            DeviceBusy,
            DeviceChanged,
            DeviceNotAvailable,
            HostUnavailable,
            InvalidInput,
            PermissionDenied,
            RealtimeDenied,
            ResourceExhausted,
            StreamInvalidated,
            UnsupportedConfig,
            UnsupportedOperation,
            Xrun,
            BackendError,
            Other,
        ];
        for kind in kinds {
            for direction in [Direction::Output, Direction::Input] {
                let device =
                    Candidate { direction, target: &Target::Named("box".into()), name: "'Box'".into() };
                let text = device.refused(&cpal::Error::new(kind)).to_string();
                assert!(text.contains("'Box'") && text.contains(&direction.to_string()), "{kind:?}: {text}");
                assert!(text.contains("choose") || text.contains("allow"), "{kind:?} without advice: {text}");
            }
        }
    }

    #[test]
    fn a_name_selects_its_best_match() {
        let entry = |id: &str, name: &str| ListedDevice { id: id.into(), name: name.into() };
        let devices = || {
            vec![
                entry("p:usb.monitor", "Monitor of USB"),
                entry("p:usb_mic", "USB Mic"),
                entry("p:usb", "Headset"),
            ]
        };
        let found = |wanted| best_match(devices(), wanted, |entry| entry).map(|entry| entry.id);
        assert_eq!(found("headset").as_deref(), Some("p:usb"));
        assert_eq!(found("P:USB").as_deref(), Some("p:usb"));
        assert_eq!(found("usb").as_deref(), Some("p:usb_mic"));
        assert_eq!(found("monitor").as_deref(), Some("p:usb.monitor"));
        assert_eq!(found("nothing"), None);
    }

    #[test]
    fn unusual_rates_are_converted_by_a_server_and_rejected_elsewhere() {
        assert_eq!((usable_rate(48_000, true), usable_rate(48_000, false)), (Some(48_000), Some(48_000)));
        assert_eq!(
            (usable_rate(1, true), usable_rate(1, false)),
            (Some(music_limits::SAMPLE_RATE_MIN), None)
        );
    }
}
