//! The window on a private desktop. Tests press keys, compare frames and record the sound.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::support::compare::{TIGHT, difference};
use crate::support::desktop::{App, Desktop, PROGRAM, SCREEN};
use crate::support::wood::assert_shows_the_speakers;
use image::RgbaImage;
use mariana::shell::identity::APP_ID;
use mariana_music::StereoFrame;
use mariana_testing::process::{output_of, wait_until};
use mariana_testing::sound_server::{Recorder, SINK_RATE, SoundServer};
use mariana_testing::wave::write_wav;
use x11rb::protocol::xproto::{AtomEnum, ConnectionExt};
use x11rb::rust_connection::RustConnection;

/// The window size of most tests. It is small, because there is no graphics card.
const SMALL: &str = "320x180";

/// Writes a song that is silent until `loud_from` seconds. Then it contains noise on the left and a tone on the right.
fn song(folder: &Path, name: &str, seconds: f64, loud_from: f64) -> PathBuf {
    let path = folder.join(name);
    let rate = f64::from(SINK_RATE);
    let mut state = 1_u32;
    let samples = (0..(seconds * rate) as usize).flat_map(|n| {
        let t = n as f64 / rate;
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let noise = (state >> 8) as f32 / (1 << 23) as f32 - 1.0;
        let tone = (std::f64::consts::TAU * 220.0 * t).sin() as f32;
        if t < loud_from { [0.0, 0.0] } else { [0.5 * noise, 0.3 * tone] }
    });
    write_wav(&path, SINK_RATE, 2, samples);
    path
}

fn silent_song(folder: &Path, seconds: f64) -> PathBuf {
    let path = folder.join("quiet.wav");
    let samples = (2.0 * 8_000.0 * seconds) as usize;
    write_wav(&path, 8_000, 2, std::iter::repeat_n(0.0, samples));
    path
}

/// Pauses and seeks to the song's start, the only time that the test knows exactly.
fn pause_at_start(app: &mut App) -> RgbaImage {
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
    app.press(&["Left"]);
    app.wait_for_moment(0.0)
}

fn assert_moves(app: &App) {
    let before = app.picture();
    wait_until("another picture", || difference(&before, &app.picture(), TIGHT.visible).fraction > 0.0);
}

fn level(frames: &[StereoFrame]) -> f64 {
    let sum: f64 = frames.iter().flatten().map(|sample| f64::from(*sample).powi(2)).sum();
    (sum / (2 * frames.len()) as f64).sqrt()
}

fn wait_for_level(recorder: &Recorder, what: &str, wanted: impl Fn(f64) -> bool) {
    wait_until(what, || wanted(level(&recorder.next(0.1))));
}

fn is_silent(level: f64) -> bool {
    level < 1e-4
}

fn is_loud(level: f64) -> bool {
    level > 0.1
}

#[test]
fn a_song_is_shown_and_played_and_keys_control_it() {
    let desktop = Desktop::start();
    let _server = SoundServer::start(desktop.folder());
    let recorder = Recorder::start(desktop.folder());
    let song = song(desktop.folder(), "lantern.wav", 60.0, 10.0);
    let mut app = desktop.open(&song, &["-v", "--size", SMALL, "--scene", "speakers"]);
    app.wait_until_reported("first picture after");
    app.wait_for_title("a title of the song and the scene only", |title| {
        title.starts_with("lantern.wav - Mariana (speakers, ") && title.matches(", ").count() == 1
    });
    assert_eq!(app.size(), (320, 180));
    assert_moves(&app);
    let playing = app.load(Duration::from_millis(500));

    // While the song is paused at its start, the frame must not change. After the whole song has been analysed, the
    // program must not need processor time.
    let start = pause_at_start(&mut app);
    assert_shows_the_speakers(&start);
    app.wait_until_reported("is known after");
    wait_until("an idle program while paused", || app.load(Duration::from_secs(1)) < 0.1);
    assert!(app.picture() == start, "the frame changes while paused");
    assert!(is_silent(level(&recorder.next(0.2))), "sound is played while paused");

    // A seek during a pause shows the frame of the new time, with its sound bars.
    app.press(&["Right", "Right", "Right"]);
    let loud = app.wait_for_moment(15.0);
    assert!(difference(&start, &loud, TIGHT.visible).fraction > 0.05, "the sound does not change the frame");
    assert_shows_the_speakers(&loud);

    app.press(&["space"]);
    app.wait_for_title("a title without a pause", |title| !title.contains("paused"));
    assert_moves(&app);
    wait_for_level(&recorder, "sound", is_loud);
    // While the window is minimized, the song plays, but the program draws no frames.
    app.xdotool(&["windowminimize", app.window()]);
    wait_until("rest", || app.load(Duration::from_millis(300)) < 0.5 * playing);
    wait_for_level(&recorder, "sound", is_loud);
    app.xdotool(&["windowactivate", "--sync", app.window()]);
    assert_moves(&app);
    app.press(&["Left", "Left", "Left", "Left"]);
    wait_for_level(&recorder, "the silent start", is_silent);
    app.press(&["Right", "Right", "Right"]);
    wait_for_level(&recorder, "the loud part", is_loud);

    let full = level(&recorder.next(0.5));
    app.press(&["Down"; 10]);
    app.wait_for_title("volume 50 %", |title| title.contains("volume 50 %"));
    wait_for_level(&recorder, "half the volume", |level| (0.05..0.75).contains(&(level / full)));
    app.press(&["Up"; 12]);
    app.wait_for_title("a title without the volume", |title| !title.contains("volume"));
    wait_for_level(&recorder, "the full volume", |level| (level / full - 1.0).abs() < 0.1);
    app.press(&["m"]);
    app.wait_for_title("muted", |title| title.contains("muted"));
    wait_for_level(&recorder, "silence", is_silent);
    assert_moves(&app);
    app.press(&["M"]);
    app.wait_for_title("a title without mute", |title| !title.contains("muted"));
    wait_for_level(&recorder, "sound again", is_loud);

    // Ctrl+Q is not Q, so it does not end the program.
    app.press(&["ctrl+q"]);
    assert_moves(&app);
    app.press(&["q"]);
    let (status, reported) = app.wait_for_end();
    assert!(status.success(), "{status}: {reported}");
    assert!(!reported.contains("mariana: "), "it complains: {reported}");
}

fn assert_is_known(desktop: &Desktop, app: &App<'_>) {
    let (connection, _) = RustConnection::connect(Some(desktop.display())).unwrap();
    let property = |name: &str| {
        let atom = connection.intern_atom(false, name.as_bytes()).unwrap().reply().unwrap().atom;
        let window = app.window().parse().unwrap();
        connection.get_property(false, window, atom, AtomEnum::ANY, 0, 1 << 16).unwrap().reply().unwrap()
    };
    let class = String::from_utf8(property("WM_CLASS").value).unwrap();
    assert_eq!(class, format!("mariana\0{APP_ID}\0"));
    // The property contains the width, the height and ARGB pixels. The wood above the woofer is opaque.
    let icon: Vec<u32> = property("_NET_WM_ICON").value32().unwrap().collect();
    assert_eq!((&icon[..2], icon.len()), (&[128, 128][..], 2 + 128 * 128));
    assert_eq!(icon[2 + 10 * 128 + 64], 0xFFB3_561F);
}

#[test]
fn full_screen_is_entered_and_left_in_different_ways() {
    let desktop = Desktop::start();
    let song = silent_song(desktop.folder(), 60.0);
    let mut app = desktop.open(&song, &["--silent", "--size", SMALL]);
    assert_is_known(&desktop, &app);
    pause_at_start(&mut app);
    app.press(&["f"]);
    app.wait_for_size(SCREEN);
    assert_shows_the_speakers(&app.wait_for_moment(0.0));
    app.press(&["Escape"]);
    app.wait_for_size((320, 180));
    // Outside of full screen, Esc does not end the program.
    app.press(&["Escape"]);
    app.wait_for_moment(0.0);
    app.press(&["F11"]);
    app.wait_for_size(SCREEN);
    app.press(&["F11"]);
    app.wait_for_size((320, 180));
    for size in [SCREEN, (320, 180)] {
        app.xdotool(&["mousemove", "--window", app.window(), "100", "100"]);
        app.xdotool(&["click", "--repeat", "2", "--delay", "60", "1"]);
        app.wait_for_size(size);
    }
    app.wait_for_title("paused alone", |title| {
        title.starts_with("quiet.wav - Mariana (speakers, ") && title.ends_with("compiled, paused)")
    });
    // wmctrl closes the window as a window manager does.
    output_of(desktop.command("wmctrl").args(["-i", "-c", app.window()]), "wmctrl").unwrap();
    let (status, reported) = app.wait_for_end();
    assert!(status.success(), "{status}: {reported}");
    assert_eq!(reported, "");
}

#[test]
fn a_window_takes_any_size_prints_nothing_and_closes_at_once() {
    let desktop = Desktop::start();
    let info = output_of(desktop.command(PROGRAM).arg("--gl-info"), "mariana").unwrap();
    let info = String::from_utf8_lossy(&info);
    for part in ["renderer ", "version "] {
        assert!(info.contains(part), "no {part} in {info}");
    }
    // This OpenGL version is too old for Mariana, so it uses OpenGL ES, or refuses a version that is too old as well.
    let with_es = |version| {
        let mut command = desktop.command(PROGRAM);
        command.arg("--gl-info").env("MESA_GL_VERSION_OVERRIDE", "3.1");
        output_of(command.env("MESA_GLES_VERSION_OVERRIDE", version), "mariana")
    };
    let info = String::from_utf8(with_es("3.0").unwrap()).unwrap();
    assert!(info.contains("OpenGL ES 3.0"), "{info}");
    let error = with_es("2.0").unwrap_err();
    assert!(error.contains("OpenGL") && error.contains("3.3") && !error.contains("panicked"), "{error}");
    // Standard output cannot be written. The window still shows the keys, and standard error stays empty.
    let song = silent_song(desktop.folder(), 60.0);
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let mut app = desktop.open_printing_to(full.into(), &song, &["--silent", "--size", SMALL]);
    app.press(&["h"]);
    assert_moves(&app);
    app.press(&["h"]);
    pause_at_start(&mut app);
    let resize = |app: &App<'_>, (width, height): (u32, u32)| {
        app.xdotool(&["windowsize", app.window(), &width.to_string(), &height.to_string()]);
    };
    // Test a tiny and a huge size, and then many sizes in a row, as dragging a corner causes them.
    for size in [(1, 1), (1_700, 900)] {
        resize(&app, size);
        app.wait_for_size(size);
    }
    for step in 0..20 {
        resize(&app, (400 - 15 * step, 80 + 15 * step));
    }
    app.wait_for_size((115, 365));
    assert_shows_the_speakers(&app.wait_for_moment(0.0));
    app.xdotool(&["windowclose", app.window()]);
    let (status, reported) = app.wait_for_end();
    assert!(status.success(), "{status}: {reported}");
    assert_eq!(reported, "");
}

#[test]
fn letters_typed_right_after_e_were_lost_or_ended_the_program() {
    let desktop = Desktop::start();
    let song = silent_song(desktop.folder(), 60.0);
    let scene = desktop.folder().join("own.scene");
    let text = "\nobject ball { shape = length(p) - 1 }\n";
    std::fs::write(&scene, text).unwrap();
    let options = ["--silent", "--size", "640x360", "--scene", scene.to_str().unwrap()];
    let mut app = desktop.open(&song, &options);
    app.wait_for_title("the scene", |title| title.contains("own"));
    // The keys arrive together, before the show has taken the first one. Q quits outside of the editor.
    app.xdotool(&["key", "--delay", "0", "e", "numbersign", "q", "u", "i", "e", "t", "ctrl+s"]);
    let written = format!("#quiet{text}");
    wait_until("the saved text", || std::fs::read_to_string(&scene).is_ok_and(|saved| saved == written));
    app.press(&["Escape", "Escape", "q"]);
    let (status, reported) = app.wait_for_end();
    assert!(status.success(), "{status}: {reported}");
}
