//! A private D-Bus session bus, on which a test calls the methods of a player.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::process::{Process, output_of, session_environment, wait_until};

/// A session bus. Dropping it ends the bus.
pub struct SessionBus {
    _daemon: Process,
    folder: PathBuf,
}

impl SessionBus {
    /// Starts the bus at the address that programs of the session in `folder` use.
    pub fn start(folder: &Path) -> Self {
        let mut command = Command::new("dbus-daemon");
        command
            .args(["--session", "--nofork", "--nopidfile"])
            .arg(format!("--address=unix:path={}", folder.join("bus").display()))
            .envs(session_environment(folder))
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        let bus = Self { _daemon: Process::start_group(&mut command, "dbus"), folder: folder.to_owned() };
        wait_until("the bus", || bus.names().is_ok());
        bus
    }

    /// Returns the names on the bus.
    pub fn names(&self) -> Result<String, String> {
        self.send("org.freedesktop.DBus", "/org/freedesktop/DBus", &["org.freedesktop.DBus.ListNames"])
    }

    /// Returns the bus names of the running players.
    pub fn players(&self) -> Vec<String> {
        let names = self.names().unwrap_or_else(|error| panic!("{error}"));
        let players =
            names.split_whitespace().filter(|name| name.starts_with("org.mpris.MediaPlayer2.mariana."));
        players.map(str::to_owned).collect()
    }

    /// Calls a method of the player, such as `Player.Next`, and returns the reply as text.
    pub fn call(&self, method: &str, arguments: &[&str]) -> String {
        let method = format!("org.mpris.MediaPlayer2.{method}");
        self.send_to_player(&[&[&*method], arguments].concat()).unwrap_or_else(|error| panic!("{error}"))
    }

    /// Returns a property of the player, such as `Player.Metadata`, as text.
    pub fn property(&self, name: &str) -> String {
        self.properties("Get", name, &[]).unwrap_or_else(|error| panic!("{error}"))
    }

    /// Sets a property of the player to a value such as `boolean:true`.
    pub fn set_property(&self, name: &str, value: &str) {
        self.properties("Set", name, &[&format!("variant:{value}")])
            .unwrap_or_else(|error| panic!("{error}"));
    }

    fn properties(&self, what: &str, name: &str, more: &[&str]) -> Result<String, String> {
        let (interface, property) = name.rsplit_once('.').unwrap_or(("", name));
        let dot = if interface.is_empty() { "" } else { "." };
        let interface = format!("string:org.mpris.MediaPlayer2{dot}{interface}");
        let method = format!("org.freedesktop.DBus.Properties.{what}");
        let property = format!("string:{property}");
        let arguments = [&[&*method, &*interface, &*property], more].concat();
        self.send_to_player(&arguments)
    }

    fn send_to_player(&self, arguments: &[&str]) -> Result<String, String> {
        let player = self.players().into_iter().next().expect("a player is on the bus");
        self.send(&player, "/org/mpris/MediaPlayer2", arguments)
    }

    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    pub(crate) fn address(&self) -> String {
        format!("unix:path={}", self.folder.join("bus").display())
    }

    /// Calls a method of `object` in the program `to`, and returns the reply as text.
    pub(crate) fn send(&self, to: &str, object: &str, arguments: &[&str]) -> Result<String, String> {
        send(&self.folder, &self.address(), to, object, arguments)
    }
}

/// Calls a method of `object` in the program `to`, on the bus at `address`, from the session in `folder`.
pub(crate) fn send(
    folder: &Path,
    address: &str,
    to: &str,
    object: &str,
    arguments: &[&str],
) -> Result<String, String> {
    let mut command = Command::new("dbus-send");
    command
        .args(["--session", "--print-reply=literal", "--reply-timeout=5000"])
        .arg(format!("--dest={to}"))
        .arg(object)
        .args(arguments)
        .envs(session_environment(folder))
        .env("DBUS_SESSION_BUS_ADDRESS", address);
    output_of(&mut command, "dbus").map(|reply| String::from_utf8_lossy(&reply).into_owned())
}
