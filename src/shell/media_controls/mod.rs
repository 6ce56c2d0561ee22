//! Media keys and the desktop's media controls: on Linux MPRIS (Media Player Remote Interfacing Specification 2.2) on
//! the session's D-Bus, on Windows and macOS the system's own. Commands reach the show from another thread; queries are
//! answered from a copy of the last state. A missing service is no error: media keys then work only while the window
//! has the keyboard.

#[cfg(all(unix, not(target_os = "macos")))]
mod mpris;
#[cfg(all(unix, not(target_os = "macos")))]
use mpris as service;
#[cfg(any(windows, target_os = "macos"))]
mod system;
#[cfg(any(windows, target_os = "macos"))]
use system as service;

pub(crate) use service::hand_over;

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex};
use std::time::Instant;

use raw_window_handle::RawWindowHandle;

use crate::commands::Command;
use crate::session::desktop::DesktopControls;
use mariana_player::track::{Repeat, TrackInfo};
use mariana_player::{PlayerStatus, Position};
use mariana_work::lock;

/// A position that differs from steady playback by more than this, in seconds, is a jump.
const JUMP: f64 = 0.5;

#[derive(Debug, Clone, PartialEq)]
struct Seen {
    track: Option<Arc<TrackInfo>>,
    paused: bool,
    ended: bool,
    volume: f32,
    repeat: Repeat,
    shuffled: bool,
    fullscreen: bool,
    /// Seconds since the track's start at a moment, to detect jumps only. Queries ask the player for the position.
    position: (f64, Instant),
}

/// Reads the audible position, in seconds.
type ReadPosition = Arc<dyn Fn() -> f64 + Send + Sync>;

/// Opens files like files that are dropped into the window, and raises the window.
type OpenFiles = Box<dyn Fn(Vec<PathBuf>) + Send + Sync>;

impl Seen {
    fn new() -> Self {
        Self {
            track: None,
            paused: true,
            ended: false,
            volume: 1.0,
            repeat: Repeat::All,
            shuffled: false,
            fullscreen: false,
            position: (0.0, Instant::now()),
        }
    }

    /// Returns the position in seconds that playback without a jump reaches at the time `now`.
    fn position_at(&self, now: Instant) -> f64 {
        let (position, at) = self.position;
        let moving = !self.paused && !self.ended;
        position + if moving { now.saturating_duration_since(at).as_secs_f64() } else { 0.0 }
    }
}

/// [`Seen`], shared with the thread that serves the desktop.
type SharedSeen = Arc<Mutex<Seen>>;

pub(crate) struct MediaControls {
    seen: SharedSeen,
    commands: Receiver<Command>,
    changes: service::Changes,
}

impl MediaControls {
    /// Starts the service, which calls `wake` for each command, and `open` for files that a later instance of the
    /// program hands over; without `open`, those start themselves. Windows needs the `window`. Without `position`,
    /// reports the position 0.
    pub(crate) fn start(
        position: Option<Position>,
        window: Option<RawWindowHandle>,
        wake: impl Fn() + Send + Sync + 'static,
        open: Option<impl Fn(PathBuf) + Send + Sync + 'static>,
    ) -> Self {
        let position: ReadPosition = Arc::new(move || position.as_ref().map_or(0.0, Position::seconds));
        let seen = Arc::new(Mutex::new(Seen::new()));
        let (sender, commands) = channel();
        let send = Arc::new(move |command| {
            // Commands after the show's end are dropped.
            if sender.send(command).is_ok() {
                wake();
            }
        });
        let raise = send.clone();
        let open = open.map(|open| -> OpenFiles {
            Box::new(move |files: Vec<PathBuf>| {
                files.into_iter().for_each(&open);
                raise(Command::Raise);
            })
        });
        let changes = service::serve(seen.clone(), position, window, move |command| send(command), open);
        Self { seen, commands, changes }
    }
}

impl DesktopControls for MediaControls {
    fn poll(&self) -> Option<Command> {
        self.commands.try_recv().ok()
    }

    fn show(&self, status: &PlayerStatus, started: bool, fullscreen: bool) {
        let now = Instant::now();
        let new = Seen {
            track: Some(status.track.clone()),
            paused: status.paused || !started,
            ended: status.ended,
            volume: status.volume,
            repeat: status.repeat,
            shuffled: status.shuffled,
            fullscreen,
            position: (status.position, now),
        };
        let old = std::mem::replace(&mut *lock(&self.seen), new.clone());
        let jumped = (old.position_at(now) - status.position).abs() > JUMP;
        self.changes.send(&old, &new, jumped);
    }
}
