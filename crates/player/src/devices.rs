//! The list of sound hosts and devices, for `mariana devices`.

use std::fmt;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use cpal::SupportedBufferSize;
use cpal::traits::{DeviceTrait, HostTrait};
use serde::Serialize;

use super::server_connection::{self, ServerConnection};
use mariana_work::{lock, once};

const HOST_LIMIT: Duration = Duration::from_secs(3);

/// All hosts of this system.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DeviceReport {
    /// The hosts in order of preference.
    pub hosts: Vec<HostReport>,
}

/// A sound system and its devices.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct HostReport {
    /// The sound system's name.
    pub name: String,
    /// The reason why the devices are unknown; `None` if the devices are known.
    pub problem: Option<String>,
    /// The devices for playback.
    pub outputs: Vec<DeviceEntry>,
    /// The devices for recording.
    pub inputs: Vec<DeviceEntry>,
}

/// One direction of a device.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DeviceEntry {
    /// The display name.
    pub name: String,
    /// The unique id for `--device`.
    pub id: String,
    /// True for the host's default in this direction.
    pub default: bool,
    /// For a monitor, the id of the output that it records.
    pub monitor_of: Option<String>,
    /// The format that the system reports as the usual one.
    pub usual: FormatReport,
}

/// A format of a device.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FormatReport {
    /// The sample format, such as `f32` or `i16`.
    pub format: String,
    /// The number of channels.
    pub channels: u16,
    /// The rate in hertz.
    pub sample_rate: u32,
    /// The smallest and largest buffer in frames, if the device reports them.
    pub buffer_frames: Option<(u32, u32)>,
}

/// Queries all hosts at once, each within 3 s. Without devices or servers the lists are empty. Standard error is
/// silenced during the queries, because the system's sound libraries print every failure to it.
pub fn list_devices() -> DeviceReport {
    #[cfg(target_os = "linux")]
    let _quiet = super::quiet_stderr::QuietStderr::new();
    // If a host does not answer, its thread keeps waiting. A late answer is ignored.
    let ask = |host: cpal::HostId| (host.name(), once("device list", || {}, move || report_host(host)));
    let asked: Vec<_> = hosts_by_preference().into_iter().map(ask).collect();
    let hosts = asked
        .into_iter()
        .map(|(name, answer)| {
            let problem =
                |text: String| HostReport { name: name.into(), problem: Some(text), ..HostReport::default() };
            match answer.map(|mut answer| answer.within(HOST_LIMIT)) {
                Err(error) => problem(error.to_string()),
                Ok(None) => problem(format!("no answer within {} s", HOST_LIMIT.as_secs())),
                Ok(Some(Err(_))) => problem("it failed when it was queried".into()),
                Ok(Some(Ok(report))) => report,
            }
        })
        .collect();
    DeviceReport { hosts }
}

fn report_host(id: cpal::HostId) -> HostReport {
    hush_sound_library();
    let mut report = HostReport { name: id.name().into(), ..HostReport::default() };
    let devices = host(id).and_then(|host| {
        let defaults = [host.default_output_device(), host.default_input_device()];
        Ok((defaults.map(|device| device.and_then(|device| device.id().ok())), host.devices()?))
    });
    match devices {
        Ok(([output, input], devices)) => {
            for device in devices {
                if let Ok(usual) = device.default_output_config() {
                    report.outputs.push(entry(&device, output.as_ref(), &usual));
                }
                if let Ok(usual) = device.default_input_config() {
                    report.inputs.push(entry(&device, input.as_ref(), &usual));
                }
            }
        }
        Err(error) => report.problem = Some(error.to_string()),
    }
    report
}

fn entry(
    device: &cpal::Device,
    default: Option<&cpal::DeviceId>,
    usual: &cpal::SupportedStreamConfig,
) -> DeviceEntry {
    let id = device.id().ok();
    let is_default = id.is_some() && id.as_ref() == default;
    let id = id.map(|id| id.to_string());
    let name = device.description().map_or_else(|_| "unnamed".into(), |about| about.name().to_owned());
    let usual = FormatReport {
        format: usual.sample_format().to_string(),
        channels: usual.channels(),
        sample_rate: usual.sample_rate(),
        buffer_frames: match *usual.buffer_size() {
            SupportedBufferSize::Range { min, max } => Some((min, max)),
            SupportedBufferSize::Unknown => None,
        },
    };
    DeviceEntry {
        name,
        default: is_default,
        monitor_of: id.as_deref().and_then(monitored_output).map(str::to_owned),
        id: id.unwrap_or_default(),
        usual,
    }
}

impl fmt::Display for DeviceReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.hosts.is_empty() {
            return writeln!(f, "no sound system");
        }
        for host in &self.hosts {
            writeln!(f, "{}", host.name)?;
            if let Some(problem) = &host.problem {
                writeln!(f, "  {problem}")?;
                continue;
            }
            for (title, devices) in [("outputs", &host.outputs), ("inputs", &host.inputs)] {
                writeln!(f, "  {title}{}", if devices.is_empty() { ": none" } else { "" })?;
                for device in devices {
                    write!(f, "{device}")?;
                }
            }
        }
        Ok(())
    }
}

impl fmt::Display for DeviceEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mark = if self.default { "*" } else { " " };
        writeln!(f, "  {mark} {}{}", self.name, if self.default { " (default)" } else { "" })?;
        writeln!(f, "      id        {}", self.id)?;
        if let Some(output) = &self.monitor_of {
            writeln!(f, "      monitor   records what {output} plays")?;
        }
        writeln!(f, "      format    {}", self.usual)
    }
}

impl fmt::Display for FormatReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} Hz, {} channels, {}", self.sample_rate, self.channels, self.format)?;
        match self.buffer_frames {
            Some((min, max)) => write!(f, ", buffer {min}..{max} frames"),
            None => Ok(()),
        }
    }
}

// The sound systems of this machine, and the connections to a sound server. A connection to PulseAudio is a socket and
// a thread. The connection lasts as long as the server, which accepts only 64 connections. So connections are kept and
// reused: one connection for queries and inputs, and one for each playing stream, because PulseAudio keeps all streams
// of a connection on one device.

/// True where an input stream on an output records that output (WASAPI, and macOS 14.6 and later). Servers instead list
/// monitors of their outputs among the inputs.
pub(crate) const OUTPUTS_CAN_BE_RECORDED: bool = cfg!(any(windows, target_os = "macos"));

/// A monitor's id is the output's id with this suffix (PulseAudio, PipeWire).
const MONITOR_SUFFIX: &str = ".monitor";

static SERVER: Mutex<Option<Arc<cpal::Host>>> = Mutex::new(None);

type Connected = (Arc<cpal::Host>, Option<ServerConnection>);

/// Connections without a playing stream.
static IDLE: Mutex<Vec<Connected>> = Mutex::new(Vec::new());

/// Returns the hosts. The sound server is first, because it reports failures best and several programs can share it.
pub(crate) fn hosts_by_preference() -> Vec<cpal::HostId> {
    let mut hosts = cpal::available_hosts();
    hosts.sort_by_key(|host| !is_server(*host));
    hosts
}

/// True if the host is a sound server, which converts rates and channels, lists monitors, and may restart.
pub(crate) fn is_server(host: cpal::HostId) -> bool {
    host.name().eq_ignore_ascii_case("pulseaudio")
}

/// True if the device list covers this host during the show. Listing ALSA's devices is slow and prints messages.
pub(crate) fn is_watched(host: cpal::HostId) -> bool {
    is_server(host) || cfg!(not(target_os = "linux"))
}

/// Stops libasound from printing errors on this thread. No error is lost: the calls of libasound return them too.
pub(crate) fn hush_sound_library() {
    #[cfg(target_os = "linux")]
    if let Err(error) = alsa::Output::local_error_handler() {
        tracing::debug!("libasound's messages cannot be silenced: {error}");
    }
}

/// Returns host `id`, reconnected if its server no longer answers. May block as long as the sound system does.
pub(crate) fn host(id: cpal::HostId) -> Result<Arc<cpal::Host>, cpal::Error> {
    if !is_server(id) {
        return Ok(Arc::new(connected(id)?));
    }
    // The lock is not held during the query, so that a hanging server blocks only the caller.
    let kept = lock(&SERVER).clone();
    if let Some(host) = kept.as_ref().filter(|host| answers(host)) {
        return Ok(host.clone());
    }
    let mut slot = lock(&SERVER);
    let is_new = |now: &&Arc<_>| kept.as_ref().is_none_or(|before| !Arc::ptr_eq(now, before));
    if let Some(host) = slot.as_ref().filter(is_new) {
        // Another thread has inserted the host first.
        return Ok(host.clone());
    }
    *slot = None;
    Ok(slot.insert(Arc::new(connected(id)?)).clone())
}

fn connected(id: cpal::HostId) -> Result<cpal::Host, cpal::Error> {
    #[cfg(target_os = "linux")]
    if is_server(id) {
        super::pulse_cookie::provide();
    }
    cpal::host_from_id(id)
}

/// A connection for one stream. Other streams cannot use it while this value exists.
pub(crate) struct PlaybackConnection(Option<Connected>);

impl PlaybackConnection {
    pub(crate) fn at_server(&self) -> Option<ServerConnection> {
        self.0.as_ref()?.1
    }
}

impl Drop for PlaybackConnection {
    fn drop(&mut self) {
        if let Some(connected) = self.0.take() {
            lock(&IDLE).push(connected);
        }
    }
}

/// Returns the same device on its own connection, and the connection. Keep the connection while a stream plays on the
/// device. On hosts other than sound servers, returns the device itself.
pub(crate) fn for_playback(device: cpal::Device) -> Result<(cpal::Device, PlaybackConnection), cpal::Error> {
    let id = device.id()?;
    if !is_server(id.host()) {
        return Ok((device, PlaybackConnection(None)));
    }
    let alive = std::iter::from_fn(|| lock(&IDLE).pop()).find(|(host, _)| answers(host));
    let (host, at_server) = match alive {
        Some(connected) => connected,
        None => {
            let (host, at_server) = server_connection::opened_by(|| connected(id.host()))?;
            (Arc::new(host), at_server)
        }
    };
    let connection = PlaybackConnection(Some((host.clone(), at_server)));
    let same = host.device_by_id(&id).filter(|device| device.supports_output());
    let gone = || cpal::Error::with_message(cpal::ErrorKind::DeviceNotAvailable, "it was just disconnected");
    Ok((same.ok_or_else(gone)?, connection))
}

fn answers(host: &cpal::Host) -> bool {
    host.default_output_device().is_some() || host.devices().is_ok()
}

pub(crate) fn monitor_id(output_id: &str) -> String {
    format!("{output_id}{MONITOR_SUFFIX}")
}

/// The id of the output that the input records, if the input is a monitor.
pub(crate) fn monitored_output(input_id: &str) -> Option<&str> {
    input_id.strip_suffix(MONITOR_SUFFIX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_is_printed() {
        let usual = FormatReport {
            format: "f32".into(),
            channels: 2,
            sample_rate: 48_000,
            buffer_frames: Some((8, 512)),
        };
        let output = DeviceEntry {
            name: "Loud Box".into(),
            id: "alsa:hw0".into(),
            default: true,
            monitor_of: None,
            usual: usual.clone(),
        };
        let monitor = DeviceEntry {
            name: "Monitor of Loud Box".into(),
            id: "alsa:hw0.monitor".into(),
            default: false,
            monitor_of: Some("alsa:hw0".into()),
            usual,
        };
        let hosts = vec![
            HostReport { name: "ALSA".into(), problem: None, outputs: vec![output], inputs: vec![monitor] },
            HostReport {
                name: "Other".into(),
                problem: Some("asleep".into()),
                outputs: Vec::new(),
                inputs: Vec::new(),
            },
        ];
        let report = DeviceReport { hosts };
        let text = report.to_string();
        for part in [
            "ALSA\n  outputs\n  * Loud Box (default)\n",
            "id        alsa:hw0\n",
            "format    48000 Hz, 2 channels, f32, buffer 8..512 frames\n",
            "  inputs\n    Monitor of Loud Box\n      id        alsa:hw0.monitor\n      monitor   records what alsa:hw0 plays\n",
            "Other\n  asleep\n",
        ] {
            assert!(text.contains(part), "no {part:?} in\n{text}");
        }
        let json = serde_json::to_value(&report).expect("plain data");
        assert_eq!(json["hosts"][0]["outputs"][0]["usual"]["buffer_frames"], serde_json::json!([8, 512]));
        assert_eq!(DeviceReport { hosts: Vec::new() }.to_string(), "no sound system\n");
    }

    #[test]
    fn listing_ends_in_time_on_any_machine() {
        let start = std::time::Instant::now();
        let report = list_devices();
        assert!(start.elapsed() < 2 * HOST_LIMIT);
        assert_eq!(report.hosts.len(), cpal::available_hosts().len());
    }
}
