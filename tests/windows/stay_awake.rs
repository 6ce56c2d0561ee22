//! The screen neither locks nor goes dark while the image moves.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used)]

use std::sync::mpsc::{Sender, channel};
use std::time::Duration;

use mpris_server::zbus;
use mpris_server::zbus::blocking::{connection, fdo::DBusProxy};
use zbus::message::Header;

use crate::support::desktop::Desktop;
use crate::support::wayland::Compositor;
use mariana_testing::process::{Process, wait_until};
use mariana_testing::session_bus::SessionBus;
use mariana_testing::wave::write_wav;

/// The desktop's screen saver. It sends the names of the programs that inhibit it.
struct Saver(Sender<String>);

#[zbus::interface(name = "org.freedesktop.ScreenSaver", crate = "mpris_server::zbus")]
impl Saver {
    fn inhibit(&self, application: String, reason: String, #[zbus(header)] header: Header<'_>) -> u32 {
        assert!(application == "Mariana" && !reason.is_empty());
        self.0.send(header.sender().unwrap().to_string()).unwrap();
        1
    }
}

#[test]
fn the_screen_locked_while_music_played() {
    let desktop = Desktop::start();
    let _bus = SessionBus::start(desktop.folder());
    let song = desktop.folder().join("quiet.wav");
    write_wav(&song, 8_000, 2, std::iter::repeat_n(0.0, 2 * 8_000 * 200));
    let address = format!("unix:path={}", desktop.folder().join("bus").display());
    let (inhibits, inhibited) = channel();
    let saver = connection::Builder::address(&*address).unwrap().name("org.freedesktop.ScreenSaver").unwrap();
    let saver = saver.serve_at("/org/freedesktop/ScreenSaver", Saver(inhibits)).unwrap().build().unwrap();
    let names = DBusProxy::new(&saver).unwrap();
    let options = ["--silent", "--size", "160x90", "--scene", "length(p) - 1"];
    let mut app = desktop.open(&song, &options);
    let inhibitor = || inhibited.recv_timeout(Duration::from_secs(60)).unwrap();
    let first = inhibitor();
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
    let is_over = |name: &str| !names.name_has_owner(name.try_into().unwrap()).unwrap();
    wait_until("the end of the request", || is_over(&first));
    app.press(&["space"]);
    let second = inhibitor();
    drop(app);
    wait_until("the end of the program's request", || is_over(&second));
}

#[test]
fn a_wayland_compositor_was_idle_while_music_played() {
    let compositor = Compositor::sway("");
    let mut show = compositor.open(&[], &["--size", "160x90", "--scene", "length(p) - 1"]);
    show.wait_until_reported("the screen stays on");
    let idle = compositor.folder().join("idle");
    let mut watch = compositor.command("swayidle");
    watch.args(["timeout", "1", &format!("touch {}", idle.display())]);
    let _watch = Process::start_group(&mut watch, "swayidle");
    std::thread::sleep(Duration::from_secs(3));
    assert!(!idle.exists(), "the compositor is idle");
    show.end();
    wait_until("an idle compositor", || idle.exists());
}
