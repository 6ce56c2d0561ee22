//! Private Wayland compositors, and the program on them. sway supports the layer shell, and weston does not.

use std::fs::Permissions;
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};

use image::RgbaImage;
use tempfile::TempDir;
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ClientMessageEvent, ConnectionExt as _, EventMask};

use super::desktop::{PROGRAM, Place, Text, collect, command_in, lock, start_x_server, wait_for_all};
use mariana_testing::process::{Process, output_of, private_folder, wait_until};

/// The user id of "nobody". Programs that refuse to run as root use it.
const NOBODY: u32 = 65_534;

/// Lines at the start of each sway configuration.
const PLAIN: &str = "xwayland disable\ndefault_border none\n";

/// X11 atoms for finding a window by its title and for asking it to close.
const X11_NAMES: [&str; 4] = ["_NET_WM_NAME", "UTF8_STRING", "WM_PROTOCOLS", "WM_DELETE_WINDOW"];

/// A compositor and its session folder. Dropping it ends the compositor and deletes the folder.
pub(crate) struct Compositor {
    // Field order matters: the compositor ends before the X server that shows its outputs.
    process: Process,
    x_server: Option<(Process, String)>,
    folder: TempDir,
    socket: &'static str,
    _place: Place,
}

impl Compositor {
    /// Sway with headless outputs. `outputs` contains lines of its configuration. The first output is HEADLESS-1.
    pub(crate) fn sway(outputs: &str) -> Self {
        Self::start_sway(outputs, None)
    }

    /// Sway with outputs that can be disconnected, because they are windows of an X server. The first output is X11-1.
    pub(crate) fn sway_in_windows(outputs: &str) -> Self {
        let (server, display) = start_x_server();
        let (connection, _) = x11rb::connect(Some(&display)).unwrap();
        for name in X11_NAMES {
            // Sway finds only atoms that exist already. Usually a window manager has created them.
            connection.intern_atom(false, name.as_bytes()).unwrap().reply().unwrap();
        }
        Self::start_sway(outputs, Some((server, display)))
    }

    fn start_sway(outputs: &str, x_server: Option<(Process, String)>) -> Self {
        let place = Place::wait_for();
        let folder = private_folder();
        let configuration = folder.path().join("sway.conf");
        std::fs::write(&configuration, format!("{PLAIN}{outputs}")).unwrap();
        let is_administrator = std::fs::metadata(folder.path()).unwrap().uid() == 0;
        let display = x_server.as_ref().map(|(_, display)| display.as_str());
        let mut command = if is_administrator {
            // Sway refuses to run as root. Root may still use its socket.
            std::os::unix::fs::chown(folder.path(), Some(NOBODY), Some(NOBODY)).unwrap();
            std::fs::set_permissions(&configuration, Permissions::from_mode(0o644)).unwrap();
            let number = NOBODY.to_string();
            let mut command = command_in("setpriv", folder.path(), display);
            command.args(["--reuid", &number, "--regid", &number, "--clear-groups", "sway"]);
            command
        } else {
            command_in("sway", folder.path(), display)
        };
        command.arg("-c").arg(&configuration);
        command.env("SWAYSOCK", folder.path().join("orders")).env("WLR_RENDERER", "pixman");
        command.env("WLR_BACKENDS", if x_server.is_some() { "x11" } else { "headless" });
        command.env("WLR_LIBINPUT_NO_DEVICES", "1").stdout(Stdio::null()).stderr(Stdio::null());
        let process = Process::start(&mut command, "sway");
        let mut compositor = Self { process, x_server, folder, socket: "wayland-1", _place: place };
        compositor.wait_for_sockets(&["wayland-1", "orders"]);
        compositor
    }

    /// Weston with one headless output of 640 by 360 pixels. Weston has no layer shell.
    pub(crate) fn weston() -> Self {
        let place = Place::wait_for();
        let folder = private_folder();
        let process = Process::start(
            command_in("weston", folder.path(), None)
                .args(["--backend=headless-backend.so", "--socket=test", "--width=640", "--height=360"])
                .stdout(Stdio::null())
                .stderr(Stdio::null()),
            "weston",
        );
        let mut compositor = Self { process, x_server: None, folder, socket: "test", _place: place };
        compositor.wait_for_sockets(&["test"]);
        compositor
    }

    fn wait_for_sockets(&mut self, names: &[&str]) {
        wait_until("the compositor's socket", || {
            assert!(self.process.ended().is_none(), "the compositor has ended");
            names.iter().all(|name| self.folder().join(name).exists())
        });
    }

    pub(crate) fn folder(&self) -> &Path {
        self.folder.path()
    }

    pub(crate) fn command(&self, name: &str) -> Command {
        let mut command = command_in(name, self.folder(), None);
        command.env("WAYLAND_DISPLAY", self.socket).env("SWAYSOCK", self.folder().join("orders"));
        command
    }

    pub(crate) fn order(&self, words: &str) {
        let words = words.split_whitespace();
        output_of(self.command("swaymsg").args(words), "sway").unwrap_or_else(|error| panic!("{error}"));
    }

    /// A screenshot of an output; `None` if the output does not exist.
    pub(crate) fn screen(&self, output: &str) -> Option<RgbaImage> {
        let path = self.folder().join("screen.png");
        output_of(self.command("grim").args(["-o", output]).arg(&path), "grim").ok()?;
        Some(image::open(&path).unwrap().to_rgba8())
    }

    pub(crate) fn wait_for_screen(
        &self,
        output: &str,
        what: &str,
        wanted: impl Fn(&RgbaImage) -> bool,
    ) -> RgbaImage {
        let mut found = None;
        wait_until(&format!("{what} on {output}"), || {
            found = self.screen(output).filter(|screen| wanted(screen));
            found.is_some()
        });
        found.unwrap()
    }

    /// Disconnects an output of [`Self::sway_in_windows`] by closing its window.
    pub(crate) fn pull(&self, output: &str) {
        let (_, display) = self.x_server.as_ref().expect("the outputs are windows");
        let (server, number) = x11rb::connect(Some(display)).unwrap();
        let root = server.setup().roots[number].root;
        let [name, text, protocols, closes] =
            X11_NAMES.map(|name| server.intern_atom(false, name.as_bytes()).unwrap().reply().unwrap().atom);
        let title = |window: u32| {
            let reported = server.get_property(false, window, name, text, 0, 64).unwrap().reply().unwrap();
            String::from_utf8_lossy(&reported.value).into_owned()
        };
        let mut window = None;
        wait_until(&format!("the window of {output}"), || {
            let windows = server.query_tree(root).unwrap().reply().unwrap().children;
            window = windows.into_iter().find(|window| title(*window).ends_with(output));
            window.is_some()
        });
        let window = window.unwrap();
        let closes = ClientMessageEvent::new(32, window, protocols, [closes, 0, 0, 0, 0]);
        server.send_event(false, window, EventMask::NO_EVENT, closes).unwrap().check().unwrap();
        wait_until("the end of an output", || self.screen(output).is_none());
    }

    pub(crate) fn kill(&mut self) {
        self.process.kill();
    }

    /// Stops the compositor's process, so that it does not respond.
    pub(crate) fn stop(&self) {
        signal(&self.process, "-STOP");
    }

    pub(crate) fn go_on(&self) {
        signal(&self.process, "-CONT");
    }

    pub(crate) fn open(&self, variables: &[(&str, &str)], options: &[&str]) -> Show {
        let mut command = self.command(PROGRAM);
        command.envs(variables.iter().copied()).args(["--silent", "-v", "--new", "--prepare-ahead", "off"]);
        command.args(options).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut process = Process::start(&mut command, "mariana");
        let reported = collect(process.child().stderr.take().unwrap());
        Show { process, reported }
    }
}

/// The program on Wayland. Dropping it ends the program.
pub(crate) struct Show {
    process: Process,
    reported: Text,
}

impl Show {
    pub(crate) fn reported(&self) -> String {
        lock(&self.reported).clone()
    }

    pub(crate) fn wait_until_reported(&mut self, what: &str) {
        wait_until(what, || {
            assert!(self.runs(), "the program ended while the test waited for '{what}': {}", self.reported());
            self.reported().contains(what)
        });
    }

    pub(crate) fn runs(&mut self) -> bool {
        self.process.ended().is_none()
    }

    /// Asks the program to end (SIGTERM).
    pub(crate) fn ask_to_end(&self) {
        signal(&self.process, "-TERM");
    }

    /// Asks the program to end and waits for the end. Returns the program's standard error.
    pub(crate) fn end(self) -> String {
        self.ask_to_end();
        let (_, reported) = self.wait_for_end();
        assert!(!reported.contains("panicked"), "{reported}");
        reported
    }

    pub(crate) fn wait_for_end(mut self) -> (ExitStatus, String) {
        wait_until("its end", || !self.runs());
        (self.process.ended().unwrap(), wait_for_all(&self.reported))
    }
}

fn signal(process: &Process, signal: &str) {
    output_of(Command::new("kill").args([signal, &process.id().to_string()]), "procps").unwrap();
}
