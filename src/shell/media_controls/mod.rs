//! Media keys and the desktop's controls for players: what they ask of the show, and what they show of it.
//!
//! On Linux this is MPRIS (the Media Player Remote Interfacing Specification 2.2) on the session's D-Bus. Without a
//! bus, and on other systems, nothing is served; media keys then work while the window has the keyboard.
//!
//! **Media keys ask the show.** `shell::media_controls` serves MPRIS on a thread of its own and hands over what was
//! asked; it answers from a copy of what the window last reported. Without a bus, with a dead one or on another
//! system nothing is served and nothing is reported.

#[cfg(target_os = "linux")]
mod mpris;

use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use crate::commands::Command;
use crate::session::desktop::DesktopControls;
use mariana_player::track::{Repeat, TrackInfo};
use mariana_player::{PlayerStatus, Position};

/// A position is a jump if it differs by more than this from where playback would have come by itself, in seconds.
const JUMP: f64 = 0.5;

/// What the desktop may see.
#[derive(Debug, Clone, PartialEq)]
struct Seen {
    track: Option<Arc<TrackInfo>>,
    paused: bool,
    ended: bool,
    volume: f32,
    repeat: Repeat,
    shuffled: bool,
    fullscreen: bool,
    /// Seconds since the track's start, at a moment. Only for telling jumps: the bus asks the player for the position.
    position: (f64, Instant),
}

/// Reads the audible position, in seconds.
type ReadPosition = Arc<dyn Fn() -> f64 + Send + Sync>;

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

    /// The position, in seconds, at which playback would be at `now` without a jump.
    fn position_at(&self, now: Instant) -> f64 {
        let (position, at) = self.position;
        let moving = !self.paused && !self.ended;
        position + if moving { now.saturating_duration_since(at).as_secs_f64() } else { 0.0 }
    }
}

/// [`Seen`] shared with the thread that serves the desktop.
#[derive(Clone)]
struct SharedSeen(Arc<Mutex<Seen>>);

impl SharedSeen {
    fn lock(&self) -> MutexGuard<'_, Seen> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The desktop's controls of this program. See the module.
pub(crate) struct MediaControls {
    seen: SharedSeen,
    commands: Receiver<Command>,
    #[cfg(target_os = "linux")]
    changes: mpris::Changes,
}

impl MediaControls {
    /// Serves the desktop on another thread, which calls `wake` for each command. Without a `position` it reports 0.
    pub(crate) fn start(position: Option<Position>, wake: impl Fn() + Send + Sync + 'static) -> Self {
        let position: ReadPosition = Arc::new(move || position.as_ref().map_or(0.0, Position::seconds));
        let seen = SharedSeen(Arc::new(Mutex::new(Seen::new())));
        let (sender, commands) = channel();
        let send = move |command| {
            // After the show's end nobody carries it out.
            if sender.send(command).is_ok() {
                wake();
            }
        };
        #[cfg(target_os = "linux")]
        let changes = mpris::serve(seen.clone(), position, send);
        #[cfg(not(target_os = "linux"))]
        drop((position, send));
        Self {
            seen,
            commands,
            #[cfg(target_os = "linux")]
            changes,
        }
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
        let old = std::mem::replace(&mut *self.seen.lock(), new.clone());
        #[cfg(target_os = "linux")]
        {
            let jumped = (old.position_at(now) - status.position).abs() > JUMP;
            self.changes.tell(&old, &new, jumped);
        }
        #[cfg(not(target_os = "linux"))]
        let _ = (old, JUMP);
    }
}
