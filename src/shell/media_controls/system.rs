//! The media controls of Windows and macOS. Compiled for both systems, but not yet tried on them.

use std::cell::RefCell;
use std::time::Duration;

use raw_window_handle::RawWindowHandle;
use souvlaki::{
    MediaControlEvent, MediaControls, MediaMetadata, MediaPlayback, MediaPosition, PlatformConfig,
    SeekDirection,
};

use super::{OpenFiles, ReadPosition, Seen, SharedSeen};
use crate::commands::{Command, SEEK_SECONDS, Switch};
use crate::shell::identity::APP_ID;

/// The system's controls; `None` if the system has none.
pub(super) struct Changes(RefCell<Option<MediaControls>>);

impl Changes {
    /// Shows the differences between `new` and `old`, and the position if `jumped` is true.
    pub(super) fn send(&self, old: &Seen, new: &Seen, jumped: bool) {
        let mut controls = self.0.borrow_mut();
        let Some(controls) = controls.as_mut() else { return };
        let mut told = Ok(());
        if old.track != new.track
            && let Some(track) = &new.track
        {
            told = told.and(controls.set_metadata(MediaMetadata {
                title: Some(track.title.as_ref().unwrap_or(&track.name)),
                artist: track.artist.as_deref(),
                duration: track.duration.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok()),
                ..MediaMetadata::default()
            }));
        }
        if jumped || old.track != new.track || (old.paused, old.ended) != (new.paused, new.ended) {
            told = told.and(controls.set_playback(playback(new)));
        }
        if let Err(error) = told {
            tracing::info!("the system's media controls do not follow: {error}");
        }
    }
}

/// Opens the system's controls, which call `send` on a thread of the system. Windows needs the `window`.
pub(super) fn serve(
    _: SharedSeen,
    _: ReadPosition,
    window: Option<RawWindowHandle>,
    send: impl Fn(Command) + Send + Sync + 'static,
    _: Option<OpenFiles>,
) -> Changes {
    let hwnd = match window {
        Some(RawWindowHandle::Win32(window)) => Some(window.hwnd.get() as *mut std::ffi::c_void),
        _ => None,
    };
    if cfg!(windows) && hwnd.is_none() {
        return Changes(RefCell::new(None));
    }
    let config = PlatformConfig { display_name: "Mariana", dbus_name: APP_ID, hwnd };
    let opened = MediaControls::new(config).and_then(|mut controls| {
        controls.attach(move |event| {
            if let Some(command) = command(&event) {
                send(command);
            }
        })?;
        Ok(controls)
    });
    let opened = opened.inspect_err(|error| tracing::info!("no media controls: {error}"));
    Changes(RefCell::new(opened.ok()))
}

/// Each start opens a window of its own.
pub(crate) fn hand_over(_: &[std::path::PathBuf]) -> bool {
    false
}

fn playback(seen: &Seen) -> MediaPlayback {
    let progress = Duration::try_from_secs_f64(seen.position.0).ok().map(MediaPosition);
    match seen {
        Seen { ended: true, .. } => MediaPlayback::Stopped,
        Seen { paused: true, .. } => MediaPlayback::Paused { progress },
        _ => MediaPlayback::Playing { progress },
    }
}

fn command(event: &MediaControlEvent) -> Option<Command> {
    let signed = |direction: &SeekDirection, seconds: f64| match direction {
        SeekDirection::Forward => seconds,
        SeekDirection::Backward => -seconds,
    };
    Some(match event {
        MediaControlEvent::Play => Command::Pause(Switch::Off),
        MediaControlEvent::Pause | MediaControlEvent::Stop => Command::Pause(Switch::On),
        MediaControlEvent::Toggle => Command::Pause(Switch::Toggle),
        MediaControlEvent::Next => Command::NextTrack,
        MediaControlEvent::Previous => Command::PreviousTrack,
        MediaControlEvent::Seek(direction) => Command::SeekBy(signed(direction, SEEK_SECONDS)),
        MediaControlEvent::SeekBy(direction, by) => Command::SeekBy(signed(direction, by.as_secs_f64())),
        MediaControlEvent::SetPosition(position) => Command::SeekTo(position.0.as_secs_f64()),
        // The session clamps the volume, and takes NaN as silence.
        MediaControlEvent::SetVolume(volume) => Command::Volume(*volume as f32),
        MediaControlEvent::SetShuffle(on) => Command::Shuffle((*on).into()),
        MediaControlEvent::Raise => Command::Raise,
        MediaControlEvent::Quit => Command::Quit,
        _ => return None,
    })
}
