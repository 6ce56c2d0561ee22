//! The sound systems of this machine, and the connections to a sound server. A connection to PulseAudio is a socket and
//! a thread. The connection lasts as long as the server, which accepts only 64 connections. So connections are kept and
//! reused: one connection for queries and inputs, and one for each playing stream, because PulseAudio keeps all streams
//! of a connection on one device.

use std::sync::{Arc, Mutex, PoisonError};

use cpal::traits::{DeviceTrait, HostTrait};

use super::server_connection::{self, ServerConnection};

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
    let kept = lock().clone();
    let alive = kept.as_ref().is_some_and(|host| answers(host));
    if let Some(host) = kept.as_ref().filter(|_| alive) {
        return Ok(host.clone());
    }
    let mut slot = lock();
    let renewed = match (&*slot, &kept) {
        (Some(now), Some(before)) => !Arc::ptr_eq(now, before),
        (now, _) => now.is_some(),
    };
    if let Some(host) = slot.as_ref().filter(|_| renewed) {
        // Another thread has inserted the host first.
        return Ok(host.clone());
    }
    *slot = None;
    let host = Arc::new(connected(id)?);
    *slot = Some(host.clone());
    Ok(host)
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
            IDLE.lock().unwrap_or_else(PoisonError::into_inner).push(connected);
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
    let idle = || IDLE.lock().unwrap_or_else(PoisonError::into_inner).pop();
    let alive = std::iter::from_fn(idle).find(|(host, _)| answers(host));
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

fn lock() -> std::sync::MutexGuard<'static, Option<Arc<cpal::Host>>> {
    SERVER.lock().unwrap_or_else(PoisonError::into_inner)
}

pub(crate) fn monitor_id(output_id: &str) -> String {
    format!("{output_id}{MONITOR_SUFFIX}")
}

/// The id of the output that the input records, if the input is a monitor.
pub(crate) fn monitored_output(input_id: &str) -> Option<&str> {
    input_id.strip_suffix(MONITOR_SUFFIX)
}
