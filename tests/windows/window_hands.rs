//! Hands from outside on a window: OSC through a real socket.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::fs;
use std::net::UdpSocket;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::support::desktop::{App, Desktop};
use mariana_testing::process::{WAIT_LIMIT, wait_until};
use mariana_testing::wave::write_wav;

const QUIT_LIMIT: Duration = Duration::from_secs(60);
const SIZE: &str = "160x90";

/// A wall whose red and green are parameters.
const WALL: &str = "param red = 0 in 0 .. 2\nparam green = 1 in 0 .. 1\n\
    material paint { color = 0  roughness = 1  emission = vec3(red, green, 0) }\n\
    object wall { shape = 5 - p.z  material = paint }\n\
    light none { direction = vec3(0, -1, 0)  color = 0 }\n\
    camera { position = vec3(0)  target = vec3(0, 0, 5) }\nsky { color = 0  ambient = 0 }\n";

struct Place {
    desktop: Desktop,
    song: PathBuf,
}

impl Place {
    fn new() -> Self {
        let desktop = Desktop::start();
        let song = desktop.folder().join("quiet.wav");
        write_wav(&song, 8_000, 2, std::iter::repeat_n(0.0, 2 * 8_000 * 60));
        fs::write(desktop.folder().join("wall.scene"), WALL).unwrap();
        fs::write(desktop.folder().join("wool.scene"), WALL.replace("vec3(red, green, 0)", "vec3(0, 0, 1)"))
            .unwrap();
        Self { desktop, song }
    }

    fn open(&self, options: &[&str]) -> App<'_> {
        let scene = self.desktop.folder().join("wall.scene");
        let all = [&["--silent", "--size", SIZE, "--scene", scene.to_str().unwrap()], options].concat();
        self.desktop.open(&self.song, &all)
    }
}

/// A program that sends OSC, and hears the answers.
pub(crate) struct Sender {
    socket: UdpSocket,
    pub(crate) port: u16,
}

impl Sender {
    pub(crate) fn new() -> Self {
        // A port that was free a moment ago.
        let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        socket.set_read_timeout(Some(Duration::from_millis(100))).unwrap();
        Self { socket, port }
    }

    /// Sends a message with numbers.
    pub(crate) fn send(&self, address: &str, numbers: &[f32]) {
        self.send_bytes(&message(address, numbers));
    }

    fn send_bytes(&self, bytes: &[u8]) {
        // What nobody hears yet is refused now and then.
        let _ = self.socket.send_to(bytes, ("127.0.0.1", self.port));
    }

    /// Asks until the answer to `address` is as wanted; gives its bytes.
    fn ask(&self, address: &str, wanted: impl Fn(&[u8]) -> bool) -> Vec<u8> {
        let start = Instant::now();
        let mut buffer = [0; 2_048];
        loop {
            self.send(address, &[]);
            while let Ok((length, _)) = self.socket.recv_from(&mut buffer) {
                if wanted(&buffer[..length]) {
                    return buffer[..length].to_vec();
                }
            }
            assert!(start.elapsed() < WAIT_LIMIT, "{address} was not answered as wanted");
        }
    }
}

fn padded(text: &str) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    bytes.resize((text.len() / 4 + 1) * 4, 0);
    bytes
}

/// The bytes of a message by the book (OSC 1.0), not by the program's own library.
fn message(address: &str, numbers: &[f32]) -> Vec<u8> {
    let mut bytes = padded(address);
    bytes.extend(padded(&format!(",{}", "f".repeat(numbers.len()))));
    bytes.extend(numbers.iter().flat_map(|number| number.to_be_bytes()));
    bytes
}

/// The first number of a message with the tags `tags`.
fn number_in(bytes: &[u8], address: &str, tags: &str) -> Option<f32> {
    let rest = bytes.strip_prefix(&padded(address)[..])?.strip_prefix(&padded(tags)[..])?;
    rest.first_chunk::<4>().map(|bytes| f32::from_be_bytes(*bytes))
}

fn colour(app: &App) -> [bool; 3] {
    let [red, green, blue, _] = app.picture().get_pixel(20, 80).0;
    [red, green, blue].map(|channel| channel > 120)
}

fn wait_for_colour(app: &App, what: &str, wanted: [bool; 3]) {
    wait_until(what, || colour(app) == wanted);
}

fn quit(app: App) {
    app.press(&["q"]);
    let (status, told) = app.wait_for_end(QUIT_LIMIT);
    assert!(status.success(), "{status}: {told}");
    assert!(!told.contains("panicked"), "{told}");
}

#[test]
fn messages_turn_parameters_and_the_last_hand_wins() {
    let place = Place::new();
    let osc = Sender::new();
    let mut app = place.open(&["--osc", &osc.port.to_string()]);
    app.wait_until_told(&format!("OSC is heard on 127.0.0.1:{}", osc.port));
    wait_for_colour(&app, "green", [false, true, false]);
    osc.send("/param/red", &[2.0]);
    wait_for_colour(&app, "yellow", [true, true, false]);
    osc.send("/share/green", &[0.0]);
    wait_for_colour(&app, "red", [true, false, false]);
    let of_red = |bytes: &[u8]| number_in(bytes, "/param/red", ",ffffs");
    let answer = osc.ask("/param/red", |bytes| of_red(bytes) == Some(2.0));
    assert!(answer.ends_with(&padded("OSC")), "{answer:?}");
    // The slider takes it back: the first of the rows, to the left end and beyond.
    app.press(&["Tab"]);
    let mut rows = (18..34).step_by(2).cycle();
    wait_until("what the slider is moved to", || {
        let row = rows.next().unwrap().to_string();
        app.xdotool(&["mousemove", "--window", app.window(), "120", &row, "mousedown", "1"]);
        app.xdotool(&["mousemove", "--window", app.window(), "1", &row]);
        std::thread::sleep(Duration::from_millis(100));
        app.xdotool(&["mouseup", "1"]);
        let answer = osc.ask("/param/red", |bytes| of_red(bytes).is_some());
        of_red(&answer) == Some(0.0) && answer.ends_with(&padded("text"))
            || answer.ends_with(&padded("slider"))
    });
    app.press(&["Tab"]);
    // And the message takes it from the slider.
    osc.send("/param/red", &[2.0]);
    wait_for_colour(&app, "red again", [true, false, false]);
    quit(app);
}

#[test]
fn messages_go_to_scenes_and_what_was_turned_is_found_again() {
    let place = Place::new();
    let osc = Sender::new();
    let mut app = place.open(&["--osc", &osc.port.to_string()]);
    app.wait_until_told("OSC is heard");
    wait_for_colour(&app, "green", [false, true, false]);
    osc.send("/param/red", &[2.0]);
    wait_for_colour(&app, "yellow", [true, true, false]);
    osc.send("/scene/wool", &[]);
    app.wait_for_title("the scene that was asked for", |title| title.contains("(wool"));
    wait_for_colour(&app, "blue", [false, false, true]);
    osc.send("/previous", &[1.0]);
    osc.send("/previous", &[0.0]);
    app.wait_for_title("the scene before", |title| title.contains("(wall"));
    wait_for_colour(&app, "yellow again", [true, true, false]);
    osc.send("/pause", &[1.0]);
    osc.send("/pause", &[1.0]);
    app.wait_for_title("a pause", |title| title.contains("paused"));
    osc.ask("/query/pause", |bytes| bytes.starts_with(b"/pause\0\0,i\0\0\0\0\0\x01"));
    osc.send("/tempo", &[98.0]);
    osc.send("/volume", &[0.5]);
    app.wait_for_title("the volume", |title| title.contains("volume 50 %"));
    quit(app);
}

#[test]
fn rubbish_is_ignored_and_the_show_goes_on() {
    let place = Place::new();
    let osc = Sender::new();
    let mut app = place.open(&["--osc", &osc.port.to_string()]);
    app.wait_until_told("OSC is heard");
    let nested = (0..2_000).rev().fold(message("/param/red", &[2.0]), |inner, _| {
        if inner.len() > 60_000 {
            return inner;
        }
        let size = u32::try_from(inner.len()).unwrap().to_be_bytes();
        [&b"#bundle\0\0\0\0\0\0\0\0\x01"[..], &size, &inner].concat()
    });
    osc.send_bytes(&nested);
    osc.send_bytes(&[&padded("/param/red")[..], b",", &b"[".repeat(20_000), &b"]".repeat(20_003)].concat());
    osc.send_bytes(&[0xff; 1_000]);
    osc.send_bytes(b"");
    osc.send("/param/red", &[f32::NAN]);
    osc.send("/param/red", &[f32::INFINITY]);
    osc.send("/param/nothing", &[1.0]);
    osc.send("/scene/nothing", &[]);
    osc.send("/nothing", &[]);
    let answer = osc.ask("/param/red", |bytes| number_in(bytes, "/param/red", ",ffffs").is_some());
    assert_eq!(number_in(&answer, "/param/red", ",ffffs"), Some(0.0));
    wait_for_colour(&app, "green", [false, true, false]);
    osc.send("/param/red", &[2.0]);
    wait_for_colour(&app, "yellow", [true, true, false]);
    quit(app);
}

#[test]
fn a_port_that_is_taken_costs_a_sentence_and_no_show() {
    let place = Place::new();
    let taken = UdpSocket::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let mut app = place.open(&["--osc", &port]);
    app.wait_until_told("OSC is not heard: another program has 127.0.0.1:");
    wait_for_colour(&app, "green", [false, true, false]);
    quit(app);
}

#[test]
fn what_is_heard_is_sent() {
    let place = Place::new();
    let lights = UdpSocket::bind("127.0.0.1:0").unwrap();
    lights.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
    let port = lights.local_addr().unwrap().port();
    let app = place.open(&["--osc-send", &format!("127.0.0.1:{port}"), "--osc-rate", "60"]);
    let mut buffer = [0; 2_048];
    let (length, _) = lights.recv_from(&mut buffer).unwrap();
    let packet = &buffer[..length];
    assert!(packet.starts_with(b"#bundle\0"), "{packet:?}");
    for address in ["/sound/bands", "/sound/bass", "/sound/beat", "/sound/energy"] {
        let address = padded(address);
        assert!(packet.windows(address.len()).any(|part| part == address), "{address:?} is not sent");
    }
    quit(app);
}
