//! Keeps the screen from locking and from going dark.
//!
//! A desktop is asked over D-Bus, an X server by its screen saver extension, and a Wayland compositor by the protocol
//! idle-inhibit ([`surface`]), because each answers only some of them. All of them end with the process.

#[cfg(all(unix, not(target_os = "macos")))]
pub(crate) mod surface;
#[cfg(windows)]
mod windows;
#[cfg(windows)]
use windows as system;

use mariana_work::{Latest, latest};

/// Asks the desktop on a separate thread, because the desktop may answer late or never.
pub(crate) struct StayAwake {
    /// The last request that is not carried out.
    requests: Latest<Option<bool>>,
    is_on: bool,
}

impl StayAwake {
    pub(crate) fn start() -> Self {
        let mut asked = None;
        let requests = latest("stay awake", None, Option::take, move |on: bool, _| {
            drop(std::mem::replace(&mut asked, on.then(system::Asked::begin)));
            tracing::info!("{}", if on { "the screen stays on" } else { "the screen may go dark" });
        });
        let requests = requests
            .inspect_err(|error| tracing::warn!("the screen may lock: no thread can be started ({error})"));
        Self { requests: requests.unwrap_or_default(), is_on: false }
    }

    /// Returns true if the request has changed.
    pub(crate) fn set(&mut self, on: bool) -> bool {
        if std::mem::replace(&mut self.is_on, on) == on {
            return false;
        }
        self.requests.change(|request| *request = Some(on));
        true
    }
}

#[cfg(all(unix, not(target_os = "macos")))]
mod system {
    use mpris_server::zbus;
    use x11rb::connection::Connection as _;
    use x11rb::protocol::screensaver::suspend;
    use x11rb::rust_connection::RustConnection;

    /// The request ends with its connections.
    pub(super) struct Asked(#[expect(dead_code, reason = "open until the end")] Open);

    type Open = (Option<zbus::blocking::Connection>, Option<RustConnection>);

    impl Asked {
        pub(super) fn begin() -> Self {
            let desktop = inhibit_over_dbus()
                .map_err(|error| tracing::debug!("no desktop keeps the screen on: {error}"));
            let server = connect_to_x_server()
                .map_err(|error| tracing::debug!("no X server keeps the screen on: {error}"));
            Self((desktop.ok(), server.ok()))
        }
    }

    /// The interface of KDE, GNOME, Xfce, Cinnamon and MATE (Idle Inhibition Service of freedesktop.org).
    fn inhibit_over_dbus() -> zbus::Result<zbus::blocking::Connection> {
        const NAME: &str = "org.freedesktop.ScreenSaver";
        let bus = zbus::blocking::Connection::session()?;
        let words = ("Mariana", "the image moves with the music");
        bus.call_method(Some(NAME), "/org/freedesktop/ScreenSaver", Some(NAME), "Inhibit", &words)?;
        Ok(bus)
    }

    fn connect_to_x_server() -> Result<RustConnection, Box<dyn std::error::Error>> {
        let (server, _) = x11rb::connect(None)?;
        suspend(&server, 1)?.check()?;
        server.flush()?;
        Ok(server)
    }
}

#[cfg(target_os = "macos")]
mod system {
    use std::process::{Command, Stdio};

    use crate::child::{ChildLimits, ChildProcess};

    /// `caffeinate`, which also ends with this process.
    pub(super) struct Asked(#[expect(dead_code, reason = "runs until the end")] Option<ChildProcess>);

    impl Asked {
        pub(super) fn begin() -> Self {
            let mut command = Command::new("/usr/bin/caffeinate");
            command.args(["-d", "-w", &std::process::id().to_string()]);
            command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
            Self(ChildProcess::start(&mut command, ChildLimits::default()).ok())
        }
    }
}
