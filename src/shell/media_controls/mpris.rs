//! The MPRIS player on the session's D-Bus.

use std::ffi::OsString;
use std::os::unix::ffi::{OsStrExt as _, OsStringExt as _};
use std::path::PathBuf;
use std::time::Duration;

use async_channel::{Receiver, Sender};
use mpris_server::zbus::zvariant::ObjectPath;
use mpris_server::zbus::{self, fdo};
use mpris_server::{
    LoopStatus, Metadata, PlaybackStatus, PlayerInterface, Property, RootInterface, Server, Signal, Time,
    TrackId,
};

use raw_window_handle::RawWindowHandle;

use super::{OpenFiles, ReadPosition, Seen, SharedSeen};
use crate::commands::{Command, Switch};
use crate::shell::identity::APP_ID;
use mariana_player::track::{Repeat, TrackInfo};
use mariana_work::{lock, once};

/// The program's name on the bus. The process id is appended, because several instances may run.
const NAME: &str = "mariana";
/// Maximum number of changes that wait for a slow bus. Further changes are lost.
const CHANGES_MAX: usize = 64;
const RATE: f64 = 1.0;
/// The object that opens files, and its interface.
const OPENER: (&str, &str) = ("/org/mariana/Mariana", "org.mariana.Mariana1");
/// Maximum wait for a running instance to take files.
const HAND_OVER_LIMIT: Duration = Duration::from_secs(2);

enum Change {
    Properties(Vec<Property>),
    Seeked(Time),
}

pub(super) struct Changes(Sender<Change>);

impl Changes {
    /// Sends the differences between `new` and `old`, and the position if `jumped` is true.
    pub(super) fn send(&self, old: &Seen, new: &Seen, jumped: bool) {
        let mut properties = Vec::new();
        let mut add = |changed: bool, property: Property| {
            if changed {
                properties.push(property);
            }
        };
        add(old.track != new.track, Property::Metadata(metadata(new)));
        add(playback(old) != playback(new), Property::PlaybackStatus(playback(new)));
        add(old.volume != new.volume, Property::Volume(f64::from(new.volume)));
        add(old.repeat != new.repeat, Property::LoopStatus(loop_status(new.repeat)));
        add(old.shuffled != new.shuffled, Property::Shuffle(new.shuffled));
        add(old.fullscreen != new.fullscreen, Property::Fullscreen(new.fullscreen));
        // Sending fails without a bus, which is no error.
        if !properties.is_empty() {
            let _ = self.0.try_send(Change::Properties(properties));
        }
        if jumped && old.track == new.track {
            let _ = self.0.try_send(Change::Seeked(time(new.position.0)));
        }
    }
}

/// Serves the bus on another thread while the [`Changes`] exist.
pub(super) fn serve(
    seen: SharedSeen,
    position: ReadPosition,
    _: Option<RawWindowHandle>,
    send: impl Fn(Command) + Send + Sync + 'static,
    open: Option<OpenFiles>,
) -> Changes {
    let (changes, inbox) = async_channel::bounded(CHANGES_MAX);
    let player = Offered { seen, position, send: std::sync::Arc::new(send) };
    let started = std::thread::Builder::new().name("media controls".into()).spawn(move || {
        // A missing bus is no error.
        if let Err(error) = zbus::block_on(run(player, open, &inbox)) {
            tracing::info!("no media controls: {error}");
        }
    });
    if let Err(error) = started {
        tracing::info!("no media controls: {error}");
    }
    Changes(changes)
}

async fn run(player: Offered, open: Option<OpenFiles>, inbox: &Receiver<Change>) -> zbus::Result<()> {
    let server = Server::new(&format!("{NAME}.instance{}", std::process::id()), player).await?;
    let bus = zbus::Connection::session().await?;
    if let Some(open) = open {
        bus.object_server().at(OPENER.0, Opener(open)).await?;
        // Instances queue for the name: when the first ends, the next opens files.
        bus.request_name_with_flags(APP_ID, Default::default()).await?;
    }
    tracing::info!("media controls as {}", server.bus_name());
    while let Ok(change) = inbox.recv().await {
        match change {
            Change::Properties(properties) => server.properties_changed(properties).await?,
            Change::Seeked(position) => server.emit(Signal::Seeked { position }).await?,
        }
    }
    Ok(())
}

/// Opens files for later instances of the program.
struct Opener(OpenFiles);

#[zbus::interface(name = "org.mariana.Mariana1", crate = "mpris_server::zbus")]
impl Opener {
    fn open(&self, files: Vec<Vec<u8>>) {
        (self.0)(files.into_iter().map(|file| OsString::from_vec(file).into()).collect());
    }
}

/// Lets a running instance open `files`, or only show its window if the list is empty. Returns false without such an instance.
pub(crate) fn hand_over(files: &[PathBuf]) -> bool {
    let files: Vec<Vec<u8>> = files.iter().map(|file| file.as_os_str().as_bytes().to_vec()).collect();
    let (path, interface) = OPENER;
    let ask = move || -> zbus::Result<()> {
        let bus = zbus::blocking::Connection::session()?;
        bus.call_method(Some(APP_ID), path, Some(interface), "Open", &(files,)).map(drop)
    };
    // A bus or an instance that hangs must not prevent the start.
    let taken = once("hand over", || {}, move || ask().is_ok());
    taken.is_ok_and(|mut taken| taken.within(HAND_OVER_LIMIT) == Some(Ok(true)))
}

#[derive(Clone)]
struct Offered {
    seen: SharedSeen,
    position: ReadPosition,
    send: std::sync::Arc<dyn Fn(Command) + Send + Sync>,
}

fn time(seconds: f64) -> Time {
    // The conversion saturates.
    Time::from_micros((seconds * 1e6) as i64)
}

fn seconds(time: Time) -> f64 {
    time.as_micros() as f64 / 1e6
}

fn playback(seen: &Seen) -> PlaybackStatus {
    match seen {
        Seen { ended: true, .. } => PlaybackStatus::Stopped,
        Seen { paused: true, .. } => PlaybackStatus::Paused,
        _ => PlaybackStatus::Playing,
    }
}

fn loop_status(repeat: Repeat) -> LoopStatus {
    match repeat {
        Repeat::All => LoopStatus::Playlist,
        Repeat::One => LoopStatus::Track,
        Repeat::Off => LoopStatus::None,
    }
}

/// Returns the id of a track on the bus: a path of letters and digits.
fn track_id(track: &TrackInfo) -> Option<TrackId> {
    let path = ObjectPath::try_from(format!("/org/mariana/track/{}", track.entry)).ok()?;
    Some(TrackId::from(path.into_owned()))
}

fn metadata(seen: &Seen) -> Metadata {
    let mut metadata = Metadata::new();
    let Some(track) = &seen.track else { return metadata };
    metadata.set_trackid(track_id(track));
    metadata.set_title(Some(track.title.clone().unwrap_or_else(|| track.name.clone())));
    metadata.set_artist(track.artist.clone().map(|artist| [artist]));
    metadata.set_length(track.duration.map(time));
    metadata
}

impl Offered {
    fn send(&self, command: Command) -> fdo::Result<()> {
        (self.send)(command);
        Ok(())
    }
}

/// Defines methods that send a command.
macro_rules! acts {
    ($($name:ident => $command:expr;)*) => {
        $(async fn $name(&self) -> fdo::Result<()> { self.send($command) })*
    };
}

/// Defines methods that return the value of a property.
macro_rules! properties {
    ($this:ident, $($name:ident: $kind:ty = $value:expr;)*) => {
        $(async fn $name(&$this) -> fdo::Result<$kind> { Ok($value) })*
    };
}

impl RootInterface for Offered {
    acts! {
        raise => Command::Raise;
        quit => Command::Quit;
    }

    properties! { self,
        can_quit: bool = true;
        fullscreen: bool = lock(&self.seen).fullscreen;
        can_set_fullscreen: bool = true;
        can_raise: bool = true;
        has_track_list: bool = false;
        identity: String = "Mariana".into();
        desktop_entry: String = APP_ID.into();
        supported_uri_schemes: Vec<String> = Vec::new();
        supported_mime_types: Vec<String> = Vec::new();
    }

    async fn set_fullscreen(&self, fullscreen: bool) -> zbus::Result<()> {
        Ok(self.send(Command::Fullscreen(fullscreen.into()))?)
    }
}

impl PlayerInterface for Offered {
    acts! {
        next => Command::NextTrack;
        previous => Command::PreviousTrack;
        pause => Command::Pause(Switch::On);
        play_pause => Command::Pause(Switch::Toggle);
        stop => Command::Pause(Switch::On);
        play => Command::Pause(Switch::Off);
    }

    properties! { self,
        playback_status: PlaybackStatus = playback(&lock(&self.seen));
        loop_status: LoopStatus = loop_status(lock(&self.seen).repeat);
        rate: f64 = RATE;
        shuffle: bool = lock(&self.seen).shuffled;
        metadata: Metadata = metadata(&lock(&self.seen));
        volume: f64 = f64::from(lock(&self.seen).volume);
        position: Time = time((self.position)());
        minimum_rate: f64 = RATE;
        maximum_rate: f64 = RATE;
        can_go_next: bool = true;
        can_go_previous: bool = true;
        can_play: bool = true;
        can_pause: bool = true;
        can_seek: bool = true;
        can_control: bool = true;
    }

    async fn seek(&self, offset: Time) -> fdo::Result<()> {
        self.send(Command::SeekBy(seconds(offset)))
    }

    async fn set_position(&self, track: TrackId, position: Time) -> fdo::Result<()> {
        let (current, length) = {
            let seen = lock(&self.seen);
            (seen.track.as_deref().and_then(track_id), seen.track.as_ref().and_then(|track| track.duration))
        };
        // As the specification requires, ignore a position in another track or beyond the end.
        let within = seconds(position) >= 0.0 && length.is_none_or(|length| seconds(position) <= length);
        if within && current == Some(track) { self.send(Command::SeekTo(seconds(position))) } else { Ok(()) }
    }

    async fn open_uri(&self, _: String) -> fdo::Result<()> {
        Err(fdo::Error::NotSupported("drop files onto the window instead".into()))
    }

    async fn set_loop_status(&self, status: LoopStatus) -> zbus::Result<()> {
        Ok(self.send(Command::Repeat(match status {
            LoopStatus::Playlist => Repeat::All,
            LoopStatus::Track => Repeat::One,
            LoopStatus::None => Repeat::Off,
        }))?)
    }

    async fn set_rate(&self, rate: f64) -> zbus::Result<()> {
        // 0 means pause; other rates are out of range.
        if rate == 0.0 { Ok(self.send(Command::Pause(Switch::On))?) } else { Ok(()) }
    }

    async fn set_shuffle(&self, shuffled: bool) -> zbus::Result<()> {
        Ok(self.send(Command::Shuffle(shuffled.into()))?)
    }

    async fn set_volume(&self, volume: f64) -> zbus::Result<()> {
        // The session clamps the volume, and takes NaN as silence.
        Ok(self.send(Command::Volume(volume as f32))?)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, Mutex};
    use std::time::Instant;

    use super::*;

    #[test]
    fn the_reported_position_was_a_guess_that_stepped_back_after_a_device_fault() {
        // The last reported state. An extrapolated position would continue from here at full speed.
        let seen = Seen { paused: false, position: (7.0, Instant::now()), ..Seen::new() };
        let offered =
            Offered { seen: Arc::new(Mutex::new(seen)), position: Arc::new(|| 2.5), send: Arc::new(|_| ()) };
        assert_eq!(zbus::block_on(offered.position()).unwrap(), Time::from_millis(2_500));
    }
}
