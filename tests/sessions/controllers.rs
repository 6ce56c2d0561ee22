//! External controllers: OSC over a real socket, and MIDI over simulated ports.

#![cfg(target_os = "linux")]

use crate::support::apart::apart;
use std::fs;
use std::net::UdpSocket;
use std::os::unix::net::UnixDatagram;
use std::path::PathBuf;
use std::time::Duration;

use crate::support::osc::{Sender, message, padded};
use crate::support::session::{self, App};

const SIZE: &str = "160x90";

/// A wall whose parameters are its red and its green channel.
pub(crate) const WALL: &str = "param red = 0 in 0 .. 2\nparam green = 1 in 0 .. 1\n\
    material paint { color = 0  roughness = 1  emission = vec3(red, green, 0) }\n\
    object wall { shape = 5 - p.z  material = paint }\n\
    light none { direction = vec3(0, -1, 0)  color = 0 }\n\
    camera { position = vec3(0)  target = vec3(0, 0, 5) }\nsky { color = 0  ambient = 0 }\n";

pub(crate) fn write_wall(place: &session::Place) -> PathBuf {
    place.save("wool.scene", &WALL.replace("vec3(red, green, 0)", "vec3(0, 0, 1)"));
    place.save("wall.scene", WALL)
}

struct Place {
    inner: session::Place,
    scene: PathBuf,
}

impl Place {
    fn new() -> Self {
        let inner = session::Place::with_song();
        let scene = write_wall(&inner);
        Self { inner, scene }
    }

    fn open(&self, options: &[&str]) -> App {
        let size: &[&str] = if options.contains(&"--size") { &[] } else { &["--size", SIZE] };
        let scene = ["--scene", self.scene.to_str().unwrap()];
        self.inner.open(&self.inner.song(), &[&scene[..], size, options].concat())
    }

    fn open_with_osc(&self) -> (App, Sender) {
        let osc = Sender::new();
        let app = self.open(&["--osc", &osc.port.to_string()]);
        app.wait_until_reported("receiving OSC");
        (app, osc)
    }

    fn port(&self, name: &str) -> PathBuf {
        self.inner.path(&format!("midi/{name}.port"))
    }

    fn plug(&self, name: &str) {
        fs::write(self.port(name), "").unwrap();
    }

    fn pull(&self, name: &str) {
        fs::remove_file(self.port(name)).unwrap();
    }

    /// Turns a knob down and, by `up`, up again until the wall is yellow.
    fn turn_until_yellow(&self, app: &App, up: &[u8]) {
        app.wait_until("yellow", |_| {
            self.play("desk", &turned(0));
            app.run_for(Duration::from_millis(30));
            self.play("desk", up);
            app.run_for(Duration::from_millis(100));
            colour(app) == [true, true, false]
        });
    }

    /// Sends bytes from a device. The bytes are lost if the session does not listen to the device.
    fn play(&self, name: &str, bytes: &[u8]) {
        let socket = UnixDatagram::unbound().unwrap();
        let _ = socket.send_to(bytes, self.port(name).with_extension("socket"));
    }

    fn knobs(&self) -> PathBuf {
        self.inner.path("config/knobs.toml")
    }

    /// Turns the knob until the session has learned it for the first parameter.
    fn learn_first(&self, app: &App, name: &str, knob: &[u8]) {
        let before = fs::read_to_string(self.knobs()).unwrap_or_default();
        begin_to_learn(app);
        app.wait_until("the learned knob in the file", |_| {
            self.play(name, knob);
            fs::read_to_string(self.knobs()).is_ok_and(|text| text != before)
        });
        app.press(&["j"]);
    }
}

pub(crate) fn ask(app: &App, osc: &Sender, address: &str, wanted: impl Fn(&[u8]) -> bool) -> Vec<u8> {
    let mut answer = None;
    app.wait_until(&format!("the expected answer to {address}"), |_| {
        osc.send(address, &[]);
        answer = std::iter::from_fn(|| osc.receive()).find(|bytes| wanted(bytes));
        answer.is_some()
    });
    answer.unwrap()
}

/// Presses the keys that start learning. Each key changes the frame, which is constant otherwise.
fn begin_to_learn(app: &App) {
    for key in ["j", "Down", "Return"] {
        let before = app.picture();
        app.press(&[key]);
        app.wait_for(key, |picture| *picture != before);
    }
}

/// Returns the first number of a message; `None` if the message has another address or other type tags.
fn number_in(bytes: &[u8], address: &str, tags: &str) -> Option<f32> {
    let rest = bytes.strip_prefix(&padded(address)[..])?.strip_prefix(&padded(tags)[..])?;
    rest.first_chunk::<4>().map(|bytes| f32::from_be_bytes(*bytes))
}

fn colour(app: &App) -> [bool; 3] {
    let [red, green, blue, _] = app.picture().get_pixel(20, 80).0;
    [red, green, blue].map(|channel| channel > 120)
}

pub(crate) fn wait_for_colour(app: &App, what: &str, wanted: [bool; 3]) {
    app.wait_until(what, |app| colour(app) == wanted);
}

#[test]
fn messages_change_parameters_and_the_last_controller_wins() {
    apart!();
    let place = Place::new();
    let osc = Sender::new();
    let app = place.open(&["--osc", &osc.port.to_string(), "--size", "320x180"]);
    app.wait_until_reported(&format!("receiving OSC on 127.0.0.1:{}", osc.port));
    wait_for_colour(&app, "green", [false, true, false]);
    osc.send("/param/red", &[2.0]);
    wait_for_colour(&app, "yellow", [true, true, false]);
    osc.send("/share/green", &[0.0]);
    wait_for_colour(&app, "red", [true, false, false]);
    let of_red = |bytes: &[u8]| number_in(bytes, "/param/red", ",ffffs");
    let answer = ask(&app, &osc, "/param/red", |bytes| of_red(bytes) == Some(2.0));
    assert!(answer.ends_with(&padded("OSC")), "{answer:?}");
    // Drag the first parameter's slider beyond its right end. Try rows of pixels until one contains the slider's rail.
    osc.send("/param/red", &[0.5]);
    app.press(&["Tab"]);
    let mut rows = (26..46).step_by(4).cycle();
    app.wait_until("the value of the dragged slider", |app| {
        let row = rows.next().unwrap();
        app.drag((230, row), (318, row));
        let answer = ask(app, &osc, "/param/red", |bytes| of_red(bytes).is_some());
        of_red(&answer) == Some(2.0) && answer.ends_with(&padded("slider"))
    });
    app.press(&["Tab"]);
    // The message takes the parameter back from the slider.
    osc.send("/param/red", &[0.0]);
    ask(&app, &osc, "/param/red", |bytes| of_red(bytes) == Some(0.0) && bytes.ends_with(&padded("OSC")));
    wait_for_colour(&app, "black", [false, false, false]);
    app.quit_by_key();
}

#[test]
fn messages_change_scenes_and_parameters_are_kept() {
    apart!();
    let place = Place::new();
    let (app, osc) = place.open_with_osc();
    wait_for_colour(&app, "green", [false, true, false]);
    // A text is a number too.
    osc.send_bytes(&[padded("/param/red"), padded(",s"), padded(" 2 ")].concat());
    wait_for_colour(&app, "yellow", [true, true, false]);
    osc.send("/scene/wool", &[]);
    app.wait_for_title("the requested scene", |title| title.contains("(wool"));
    wait_for_colour(&app, "blue", [false, false, true]);
    osc.send("/previous", &[1.0]);
    osc.send("/previous", &[0.0]);
    app.wait_for_title("the previous scene", |title| title.contains("(wall"));
    wait_for_colour(&app, "yellow again", [true, true, false]);
    osc.send("/pause", &[1.0]);
    osc.send("/pause", &[1.0]);
    app.wait_for_title("a pause", |title| title.contains("paused"));
    ask(&app, &osc, "/query/pause", |bytes| bytes.starts_with(b"/pause\0\0,i\0\0\0\0\0\x01"));
    osc.send("/tempo", &[98.0]);
    osc.send("/volume", &[0.5]);
    app.wait_for_title("the volume", |title| title.contains("volume 50 %"));
    app.quit_by_key();
}

#[test]
fn invalid_messages_are_ignored() {
    apart!();
    let place = Place::new();
    let (app, osc) = place.open_with_osc();
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
    osc.send_bytes(&[padded("/param/red"), padded(",s"), padded("abc")].concat());
    osc.send_bytes(&[padded("/param/red"), padded(",s"), padded("inf")].concat());
    osc.send("/param/nothing", &[1.0]);
    osc.send("/scene/nothing", &[]);
    osc.send("/nothing", &[]);
    let answer = ask(&app, &osc, "/param/red", |bytes| number_in(bytes, "/param/red", ",ffffs").is_some());
    assert_eq!(number_in(&answer, "/param/red", ",ffffs"), Some(0.0));
    wait_for_colour(&app, "green", [false, true, false]);
    osc.send("/param/red", &[2.0]);
    wait_for_colour(&app, "yellow", [true, true, false]);
    app.quit_by_key();
}

#[test]
fn a_port_in_use_is_reported_and_opened_later() {
    apart!();
    let place = Place::new();
    let taken = UdpSocket::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let app = place.open(&["--osc", &port]);
    app.wait_until_reported("OSC input is off: another program uses 127.0.0.1:");
    wait_for_colour(&app, "green", [false, true, false]);
    drop(taken);
    app.wait_until_reported(&format!("receiving OSC on 127.0.0.1:{port}"));
    app.quit_by_key();
}

#[test]
fn sound_features_are_sent() {
    apart!();
    let place = Place::new();
    let lights = UdpSocket::bind("127.0.0.1:0").unwrap();
    lights.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
    let port = lights.local_addr().unwrap().port();
    let app = place.open(&["--osc-send", &format!("127.0.0.1:{port}"), "--osc-rate", "60"]);
    // The values of a moment are more than one packet.
    let mut missing = ["/sound/band", "/sound/bass", "/sound/beat", "/sound/energy"].map(padded).to_vec();
    for _ in 0..4 {
        let mut buffer = [0; 2_048];
        let (length, _) = app.meanwhile(|| lights.recv_from(&mut buffer)).unwrap();
        let packet = &buffer[..length];
        assert!(packet.starts_with(b"#bundle\0"), "{packet:?}");
        missing.retain(|address| !packet.windows(address.len()).any(|part| part == address));
    }
    assert!(missing.is_empty(), "{missing:?} are not sent");
    app.quit_by_key();
}

/// Returns the message that sets controller 1 on channel 1 to `value`.
fn turned(value: u8) -> [u8; 3] {
    [0xb0, 1, value]
}

#[test]
fn a_learned_knob_controls_its_parameter_and_is_remembered() {
    apart!();
    let place = Place::new();
    place.plug("desk");
    let app = place.open(&[]);
    app.wait_until_reported("receiving MIDI from desk (fake port)");
    wait_for_colour(&app, "green", [false, true, false]);
    place.learn_first(&app, "desk", &turned(127));
    let text = fs::read_to_string(place.knobs()).unwrap();
    for line in [
        "device = \"desk (fake port)\"",
        "turned = \"cc 1 on channel 1\"",
        "param = \"red\"",
        "scene = \"wall\"",
    ] {
        assert!(text.contains(line), "{line} is missing in\n{text}");
    }
    // The knob's position differs from the parameter's value. The knob has no effect until it passes the value.
    place.play("desk", &turned(90));
    wait_for_colour(&app, "green as before", [false, true, false]);
    place.play("desk", &turned(0));
    app.wait_until("the knob to pick the parameter up", |_| {
        place.play("desk", &turned(127));
        colour(&app) == [true, true, false]
    });
    app.quit_by_key();
    let app = place.open(&[]);
    app.wait_until_reported("receiving MIDI from desk (fake port)");
    wait_for_colour(&app, "green", [false, true, false]);
    place.turn_until_yellow(&app, &turned(127));
    app.quit_by_key();
}

/// Turns the knob by `steps` in offset binary, one step a message.
fn turn_endlessly(place: &Place, steps: i32) {
    (0..steps.abs()).for_each(|_| place.play("desk", &turned(if steps < 0 { 63 } else { 65 })));
}

#[test]
fn an_endless_knob_is_recognized_and_turns_its_parameter_from_any_value() {
    apart!();
    let place = Place::new();
    place.plug("desk");
    let (app, osc) = place.open_with_osc();
    app.wait_until_reported("receiving MIDI from desk (fake port)");
    wait_for_colour(&app, "green", [false, true, false]);
    place.learn_first(&app, "desk", &turned(65));
    // The last of these steps completes the pattern.
    turn_endlessly(&place, 3);
    turn_endlessly(&place, -3);
    app.wait_until_reported("cc 1 on channel 1 of desk (fake port) is an endless knob");
    app.wait_until("the encoding in the file", |_| {
        fs::read_to_string(place.knobs()).is_ok_and(|text| text.contains("encoding = \"offset\""))
    });
    let red = |value: f32| {
        move |bytes: &[u8]| {
            number_in(bytes, "/param/red", ",ffffs").is_some_and(|red| (red - value).abs() < 1e-4)
        }
    };
    osc.send("/param/red", &[0.0]);
    ask(&app, &osc, "/param/red", red(0.0));
    turn_endlessly(&place, 64);
    ask(&app, &osc, "/param/red", red(1.0));
    // Another controller moves the parameter. Fast turns send several steps at once.
    osc.send("/param/red", &[0.5]);
    ask(&app, &osc, "/param/red", red(0.5));
    place.play("desk", &turned(64 + 32));
    ask(&app, &osc, "/param/red", red(1.0));
    turn_endlessly(&place, -64);
    ask(&app, &osc, "/param/red", red(0.0));
    wait_for_colour(&app, "green", [false, true, false]);
    app.quit_by_key();
    // The next run knows the encoding.
    let (app, osc) = place.open_with_osc();
    app.wait_until_reported("receiving MIDI from desk (fake port)");
    wait_for_colour(&app, "green", [false, true, false]);
    turn_endlessly(&place, 127);
    ask(&app, &osc, "/param/red", red(127.0 / 64.0));
    wait_for_colour(&app, "yellow", [true, true, false]);
    app.quit_by_key();
}

#[test]
fn an_endless_knob_turns_the_volume() {
    apart!();
    let place = Place::new();
    place.plug("desk");
    fs::create_dir_all(place.knobs().parent().unwrap()).unwrap();
    let knob =
        "[[knob]]\ndevice = \"desk (fake port)\"\nturned = \"increment on channel 1\"\naction = \"volume\"\n";
    fs::write(place.knobs(), knob).unwrap();
    let (app, osc) = place.open_with_osc();
    app.wait_until_reported("receiving MIDI from desk (fake port)");
    wait_for_colour(&app, "green", [false, true, false]);
    osc.send("/volume", &[0.5]);
    app.wait_for_title("the volume", |title| title.contains("volume 50 %"));
    // Data decrements. Without a first message, the knob could be one that sends its position.
    (0..33).for_each(|_| place.play("desk", &[0xb0, 97, 127]));
    app.wait_for_title("a lower volume", |title| title.contains("volume 25 %"));
    app.quit_by_key();
}

#[test]
fn learning_continues_after_a_device_was_disconnected() {
    apart!();
    let place = Place::new();
    place.plug("desk");
    let app = place.open(&[]);
    app.wait_until_reported("receiving MIDI from desk (fake port)");
    // The session knows the parameters once it shows the frame.
    wait_for_colour(&app, "green", [false, true, false]);
    begin_to_learn(&app);
    place.pull("desk");
    app.wait_until_reported("desk (fake port) was disconnected; learning continues");
    place.plug("desk");
    // A pad has only two values, so the session accepts its first value at once.
    app.wait_until("the learned pad in the file", |_| {
        place.play("desk", &[0x99, 36, 127]);
        place.knobs().exists()
    });
    app.press(&["Escape"]);
    app.wait_until("yellow", |_| {
        place.play("desk", &[0x99, 36, 127]);
        colour(&app) == [true, true, false]
    });
    place.play("desk", &[0x89, 36, 0]);
    wait_for_colour(&app, "green", [false, true, false]);
    app.quit_by_key();
}

#[test]
fn floods_of_invalid_midi_are_ignored() {
    apart!();
    let place = Place::new();
    place.plug("desk");
    let app = place.open(&[]);
    app.wait_until_reported("receiving MIDI from desk (fake port)");
    wait_for_colour(&app, "green", [false, true, false]);
    place.learn_first(&app, "desk", &turned(0));
    let exclusive: Vec<u8> = std::iter::once(0xf0).chain((0..60_000_u32).map(|n| (n % 128) as u8)).collect();
    for _ in 0..50 {
        place.play("desk", &exclusive);
        place.play("desk", &[0xff; 500]);
        place.play("desk", &[0xb0, 1]);
    }
    // These bytes are two messages with running status, interrupted by a clock message.
    place.turn_until_yellow(&app, &[0xb0, 1, 126, 1, 0xf8, 127]);
    app.quit_by_key();
}

#[test]
fn a_damaged_knobs_file_is_reported_and_kept_aside() {
    apart!();
    let place = Place::new();
    place.plug("desk");
    fs::create_dir_all(place.knobs().parent().unwrap()).unwrap();
    fs::write(place.knobs(), "[[knob]]\ndevice = 7\n").unwrap();
    let app = place.open(&[]);
    app.wait_until_reported("knobs.toml cannot be understood");
    app.wait_until_reported("receiving MIDI from desk (fake port)");
    wait_for_colour(&app, "green", [false, true, false]);
    place.learn_first(&app, "desk", &turned(5));
    let kept = fs::read_to_string(place.knobs().with_extension("toml.broken")).unwrap();
    assert_eq!(kept, "[[knob]]\ndevice = 7\n");
    app.quit_by_key();
}

#[test]
fn the_clock_of_a_device_sets_the_tempo_until_it_ends() {
    apart!();
    let place = Place::new();
    place.plug("drums");
    let (app, osc) = place.open_with_osc();
    app.wait_until_reported("receiving MIDI from drums (fake port)");
    let tempo = |bytes: &[u8]| number_in(bytes, "/tempo", ",f");
    ask(&app, &osc, "/query/tempo", |bytes| tempo(bytes) == Some(0.0));
    place.play("drums", &[0xfa]);
    let mut seen = 0.0;
    app.wait_until("a tempo from the clock", |app| {
        place.play("drums", &[0xf8]);
        app.run_for(Duration::from_millis(20));
        osc.send("/query/tempo", &[]);
        if let Some(bytes) = osc.receive() {
            seen = tempo(&bytes).unwrap_or_default();
        }
        seen > 0.0
    });
    assert!((5.0..400.0).contains(&seen), "{seen}");
    ask(&app, &osc, "/query/tempo", |bytes| tempo(bytes) == Some(0.0));
    app.quit_by_key();
}

#[test]
fn a_controller_overrides_the_show_until_its_next_movement() {
    apart!();
    let place = Place::new();
    let osc = Sender::new();
    let show = place.inner.path("own.show");
    // The show begins while the song already plays, so the test seeks to the times at which the show moves parameters.
    fs::write(&show, "at start wall.scene\n set red = 2\n set red = 1 after 30 s\n").unwrap();
    let port = osc.port.to_string();
    let app = place.open(&["--osc", &port, "--show", show.to_str().unwrap()]);
    app.wait_until_reported("receiving OSC");
    let of_red = |bytes: &[u8]| number_in(bytes, "/param/red", ",ffffs");
    let held = |value: f32, hand: &'static str| {
        move |bytes: &[u8]| of_red(bytes) == Some(value) && bytes.ends_with(&padded(hand))
    };
    ask(&app, &osc, "/param/red", held(2.0, "show"));
    wait_for_colour(&app, "yellow", [true, true, false]);
    osc.send("/pause", &[1.0]);
    app.wait_for_title("a pause", |title| title.contains("paused"));
    osc.send("/param/red", &[0.0]);
    ask(&app, &osc, "/param/red", held(0.0, "OSC"));
    wait_for_colour(&app, "green", [false, true, false]);
    // The show's next movement sets the parameter again. At earlier times of the song, the controller's value stays.
    osc.send("/position", &[0.9]);
    ask(&app, &osc, "/param/red", held(1.0, "show"));
    osc.send("/position", &[0.1]);
    ask(&app, &osc, "/param/red", held(0.0, "OSC"));
    app.quit_by_key();
}
