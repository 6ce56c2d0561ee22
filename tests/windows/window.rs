//! The window as a user meets it: the program on a desktop of the test's own, its keys pressed, its picture looked at,
//! its sound recorded.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::support::compare::{TIGHT, difference};
use crate::support::desktop::{App, Desktop, PROGRAM, SCREEN, command_in};
use image::RgbaImage;
use mariana::shell::identity::APP_ID;
use mariana_music::StereoFrame;
use mariana_testing::process::{output_of, private_folder, wait_until};
use mariana_testing::sound_server::{Recorder, SINK_RATE, SoundServer};
use mariana_testing::wave::write_wav;
use x11rb::protocol::xproto::{AtomEnum, ConnectionExt};
use x11rb::rust_connection::RustConnection;

/// Longest time from the wish to quit to the end.
const QUIT_LIMIT: Duration = Duration::from_secs(60);
/// The window of most tests: small, because it is drawn without a graphics card.
const SMALL: &str = "320x180";

/// A song that is silent until `loud_from` seconds: noise on the left, then, and a tone on the right.
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
    song(folder, "quiet.wav", seconds, f64::INFINITY)
}

/// Pauses and goes to the song's start, the one moment that is known exactly.
fn pause_at_start(app: &mut App) -> RgbaImage {
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
    app.press(&["Left"]);
    app.wait_for_moment(0.0)
}

/// Share of the pixels of a part of the picture that have the colour of wood, lit or not.
fn wood_share(picture: &RgbaImage, columns: std::ops::Range<u32>) -> f64 {
    let (mut wood, mut all) = (0_u32, 0_u32);
    for (x, _, pixel) in picture.enumerate_pixels() {
        if columns.contains(&x) {
            let [r, g, b, _] = pixel.0.map(f64::from);
            wood += u32::from(r > 1.15 * g && g > 1.15 * b);
            all += 1;
        }
    }
    f64::from(wood) / f64::from(all)
}

fn assert_shows_the_speakers(picture: &RgbaImage) {
    let middle = picture.width() / 2;
    let [left, right] = [0..middle, middle..picture.width()].map(|columns| wood_share(picture, columns));
    assert!(left > 0.03 && right > 0.03, "wood fills {left} of the left half and {right} of the right one");
    let brightness = picture.pixels().map(|pixel| f64::from(pixel.0[1])).sum::<f64>()
        / f64::from(picture.width() * picture.height());
    assert!((40.0..200.0).contains(&brightness), "mean green is {brightness}");
}

/// Fails unless the picture moves.
fn assert_moves(app: &App) {
    let before = app.picture();
    wait_until("another picture", || difference(&before, &app.picture(), TIGHT.visible).share > 0.0);
}

/// Level of both channels, as root of the mean square.
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
fn a_song_is_seen_and_heard_and_obeys_the_keys() {
    let desktop = Desktop::start();
    let _server = SoundServer::start(desktop.folder());
    let recorder = Recorder::start(desktop.folder());
    let song = song(desktop.folder(), "lantern.wav", 60.0, 10.0);
    let mut app = desktop.open(&song, &["-v", "--size", SMALL]);
    app.wait_until_told("first picture after");
    app.wait_for_title("the song and the scene alone", |title| {
        title.starts_with("lantern.wav - Mariana (speakers, ") && title.matches(", ").count() == 1
    });
    assert_eq!(app.size(), (320, 180));
    assert_moves(&app);
    let playing = app.load(Duration::from_millis(500));

    // Paused: the start of the song, and it stands still and costs nothing, once the whole song was read.
    let start = pause_at_start(&mut app);
    assert_shows_the_speakers(&start);
    app.wait_until_told("is known after");
    wait_until("rest while it is paused", || app.load(Duration::from_secs(1)) < 0.1);
    assert!(app.picture() == start, "paused it moves");
    assert!(is_silent(level(&recorder.next(0.2))), "paused it sounds");

    // Seeking, while it stands: the picture is that of the moment, with the bars of its sound.
    app.press(&["Right", "Right", "Right"]);
    let loud = app.wait_for_moment(15.0);
    assert!(difference(&start, &loud, TIGHT.visible).share > 0.05, "sound does not show");
    assert_shows_the_speakers(&loud);

    // Playing.
    app.press(&["space"]);
    app.wait_for_title("nothing of a pause", |title| !title.contains("paused"));
    assert_moves(&app);
    wait_for_level(&recorder, "sound", is_loud);
    // Out of sight the song goes on and no picture is drawn.
    app.xdotool(&["windowminimize", app.window()]);
    wait_until("rest", || app.load(Duration::from_millis(300)) < 0.5 * playing);
    wait_for_level(&recorder, "sound", is_loud);
    app.xdotool(&["windowactivate", "--sync", app.window()]);
    assert_moves(&app);
    app.press(&["Left", "Left", "Left", "Left"]);
    wait_for_level(&recorder, "the silent start", is_silent);
    app.press(&["Right", "Right", "Right"]);
    wait_for_level(&recorder, "the loud part", is_loud);

    // Volume: quieter to the ear, and in the title.
    let full = level(&recorder.next(0.5));
    app.press(&["Down"; 10]);
    app.wait_for_title("volume 50 %", |title| title.contains("volume 50 %"));
    wait_for_level(&recorder, "half the volume", |level| (0.05..0.75).contains(&(level / full)));
    app.press(&["Up"; 12]);
    app.wait_for_title("nothing of the volume", |title| !title.contains("volume"));
    wait_for_level(&recorder, "the full volume", |level| (level / full - 1.0).abs() < 0.1);
    app.press(&["m"]);
    app.wait_for_title("muted", |title| title.contains("muted"));
    wait_for_level(&recorder, "silence", is_silent);
    assert_moves(&app);
    app.press(&["M"]);
    app.wait_for_title("nothing of mute", |title| !title.contains("muted"));
    wait_for_level(&recorder, "sound again", is_loud);

    // With Ctrl a letter is another key; a letter alone ends the show.
    app.press(&["ctrl+q"]);
    assert_moves(&app);
    app.press(&["q"]);
    let (status, told) = app.wait_for_end(QUIT_LIMIT);
    assert!(status.success(), "{status}: {told}");
    assert!(!told.contains("mariana: "), "it complains: {told}");
}

#[test]
fn a_desktop_knows_whose_window_it_is() {
    let desktop = Desktop::start();
    let app = desktop.open(&silent_song(desktop.folder(), 60.0), &["--silent", "--size", SMALL]);
    let (connection, _) = RustConnection::connect(Some(desktop.display())).unwrap();
    let property = |name: &str| {
        let atom = connection.intern_atom(false, name.as_bytes()).unwrap().reply().unwrap().atom;
        let window = app.window().parse().unwrap();
        connection.get_property(false, window, atom, AtomEnum::ANY, 0, 1 << 16).unwrap().reply().unwrap()
    };
    let class = String::from_utf8(property("WM_CLASS").value).unwrap();
    assert_eq!(class, format!("mariana\0{APP_ID}\0"));
    // Width, height, then ARGB: the wood above the woofer is opaque.
    let icon: Vec<u32> = property("_NET_WM_ICON").value32().unwrap().collect();
    assert_eq!((&icon[..2], icon.len()), (&[128, 128][..], 2 + 128 * 128));
    assert_eq!(icon[2 + 10 * 128 + 64], 0xFFB3_561F);
}

#[test]
fn full_screen_comes_and_goes() {
    let desktop = Desktop::start();
    let song = silent_song(desktop.folder(), 60.0);
    let mut app = desktop.open(&song, &["--silent", "--size", SMALL]);
    pause_at_start(&mut app);
    app.press(&["f"]);
    app.wait_for_size(SCREEN);
    assert_shows_the_speakers(&app.wait_for_moment(0.0));
    app.press(&["Escape"]);
    app.wait_for_size((320, 180));
    // Esc is no way out of the program.
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
    // The window manager's way to close a window.
    output_of(desktop.command("wmctrl").args(["-i", "-c", app.window()]), "wmctrl").unwrap();
    let (status, told) = app.wait_for_end(QUIT_LIMIT);
    assert!(status.success(), "{status}: {told}");
    assert_eq!(told, "");
}

/// The least box of the pixels in which two pictures differ: left, top, right and bottom; none if they are the same.
fn changed_box(a: &RgbaImage, b: &RgbaImage) -> Option<[u32; 4]> {
    let changed = a.enumerate_pixels().filter(|(x, y, pixel)| b.get_pixel(*x, *y) != *pixel);
    changed.fold(None, |found, (x, y, _)| {
        let [left, top, right, bottom] = found.unwrap_or([x, y, x, y]);
        Some([left.min(x), top.min(y), right.max(x), bottom.max(y)])
    })
}

#[test]
fn the_keys_show_over_the_picture_and_leave_no_trace() {
    let desktop = Desktop::start();
    let song = silent_song(desktop.folder(), 60.0);
    // There are too many keys for a smaller window.
    let mut app = desktop.open(&song, &["--silent", "--size", "640x360"]);
    let before = pause_at_start(&mut app);
    app.press(&["h"]);
    wait_until("the keys over the picture", || changed_box(&before, &app.picture()).is_some());
    let keys = app.picture();
    let panel = changed_box(&before, &keys).unwrap();
    let [left, top, right, bottom] = panel;
    assert!(left > 2 && right < 637 && right - left > 200, "the panel is {panel:?}");
    assert!(top > 2 && bottom < 357 && bottom - top > 100, "the panel is {panel:?}");
    let mean = |picture: &RgbaImage| {
        let inside = picture
            .enumerate_pixels()
            .filter(|(x, y, _)| (left..=right).contains(x) && (top..=bottom).contains(y));
        inside.map(|(_, _, pixel)| f64::from(pixel.0[0])).sum::<f64>()
            / f64::from((right - left + 1) * (bottom - top + 1))
    };
    assert!(mean(&keys) < 0.7 * mean(&before), "the panel is not dark: {} in {}", mean(&keys), mean(&before));
    // It stands still, and costs nothing while it does.
    let load = app.load(Duration::from_secs(1));
    assert!(load < 0.1, "with the keys shown it takes {load} of a processor");
    assert!(app.picture() == keys, "the keys move");
    // A double click on it is no wish for full screen.
    let double_click = ["click", "--repeat", "2", "--delay", "60", "1"];
    app.xdotool(&["mousemove", "--window", app.window(), "320", "180"]);
    app.xdotool(&double_click);
    // Other pictures are drawn under it.
    app.press(&["Right"]);
    wait_until("another picture", || changed_box(&keys, &app.picture()).is_some());
    app.press(&["Left"]);
    wait_until("the first picture and the keys", || app.picture() == keys);
    assert_eq!(app.size(), (640, 360));
    // Gone at once, and no picture after it is another one than before.
    app.press(&["F1"]);
    wait_until("the first picture", || app.picture() == before);
    app.press(&["Right", "Left"]);
    app.wait_for_moment(0.0);
    wait_until("the first picture, drawn again", || app.picture() == before);
    app.xdotool(&double_click);
    app.wait_for_size(SCREEN);
    app.press(&["q"]);
    let (status, told) = app.wait_for_end(QUIT_LIMIT);
    assert!(status.success(), "{status}: {told}");
    assert_eq!(told, "");
}

#[test]
fn every_size_shows_both_speakers_in_proportion() {
    let desktop = Desktop::start();
    let song = silent_song(desktop.folder(), 60.0);
    let mut app = desktop.open(&song, &["--silent", "--size", SMALL]);
    pause_at_start(&mut app);
    for (width, height) in [(160, 400), (700, 90), (97, 61), (1, 1), (200, 1), (1, 200), (320, 180)] {
        app.xdotool(&["windowsize", app.window(), &width.to_string(), &height.to_string()]);
        app.wait_for_size((width, height));
        let picture = app.wait_for_moment(0.0);
        if width.min(height) > 50 {
            assert_shows_the_speakers(&picture);
        }
    }
    // Larger than the screen, and many sizes in a row, as by dragging a corner.
    app.xdotool(&["windowsize", app.window(), "1700", "900"]);
    app.wait_for_size((1700, 900));
    for step in 0..20 {
        let (width, height) = (400 - 15 * step, 80 + 15 * step);
        app.xdotool(&["windowsize", app.window(), &width.to_string(), &height.to_string()]);
    }
    app.wait_for_size((115, 365));
    app.wait_for_moment(0.0);
    // Closing without asking.
    app.xdotool(&["windowclose", app.window()]);
    let (status, told) = app.wait_for_end(QUIT_LIMIT);
    assert!(status.success(), "{status}: {told}");
    assert_eq!(told, "");
}

#[test]
fn a_song_loops_or_ends_as_asked_and_without_a_sound_server_keeps_real_time() {
    let desktop = Desktop::start();
    let seconds = 2.0;
    let song = song(desktop.folder(), "short.wav", seconds, 0.0);
    // No sound server runs: the program says so, and the song takes its time all the same.
    let mut app = desktop.open(&song, &["--once", "-v", "--size", SMALL]);
    app.wait_until_told("first picture after");
    let begin = Instant::now();
    app.wait_for_title("no sound device", |title| title.contains("no sound device"));
    let (status, told) = app.wait_for_end(Duration::from_secs(60));
    let took = begin.elapsed().as_secs_f64();
    assert!(status.success(), "{status}: {told}");
    assert!(took > 0.9 * seconds && took < seconds + 1.5, "{seconds} s of song took {took} s");
    assert_eq!(told.matches("the song plays without sound: ").count(), 1, "{told}");

    let app = desktop.open(&song, &["--size", SMALL]);
    std::thread::sleep(Duration::from_secs_f64(2.2 * seconds));
    assert_moves(&app);
    assert!(!app.title().contains("paused"), "{}", app.title());
    let told = app.told();
    assert_eq!(told.lines().count(), 1, "{told}");
    app.press(&["q"]);
    assert!(app.wait_for_end(QUIT_LIMIT).0.success());
}

#[test]
fn a_sound_server_that_dies_does_not_take_the_picture_along() {
    let desktop = Desktop::start();
    let server = SoundServer::start(desktop.folder());
    let recorder = Recorder::start(desktop.folder());
    let song = song(desktop.folder(), "long.wav", 60.0, 0.0);
    let mut app = desktop.open(&song, &["--size", SMALL]);
    wait_for_level(&recorder, "sound", is_loud);
    assert_eq!(app.told(), "");
    server.kill();
    app.wait_until_told("the song plays without sound: ");
    app.wait_for_title("no sound device", |title| title.contains("no sound device"));
    std::thread::sleep(Duration::from_secs(2));
    assert_moves(&app);
    let told = app.told();
    assert_eq!(told.lines().count(), 1, "one message, not: {told}");
    app.press(&["q"]);
    let (status, told) = app.wait_for_end(QUIT_LIMIT);
    assert!(status.success(), "{status}: {told}");
}

#[test]
fn what_the_system_gives_or_lacks_is_said() {
    let desktop = Desktop::start();
    let info = output_of(desktop.command(PROGRAM).arg("--gl-info"), "mariana").unwrap();
    let info = String::from_utf8_lossy(&info);
    for part in ["renderer ", "version "] {
        assert!(info.contains(part), "no {part} in {info}");
    }
    // Nowhere to print to.
    let full = || std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let mut command = desktop.command(PROGRAM);
    let run = command.arg("--gl-info").stdout(full()).stderr(std::process::Stdio::piped()).spawn().unwrap();
    let run = run.wait_with_output().unwrap();
    let told = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.code() == Some(1) && told.contains("cannot be printed"), "{}: {told}", run.status);
    let song = silent_song(desktop.folder(), 60.0);
    // The keys are shown in the window, and nothing is printed.
    let app = desktop.open_printing_to(full().into(), &song, &["--silent", "--size", SMALL]);
    app.press(&["h"]);
    assert_moves(&app);
    app.press(&["q"]);
    let (status, told) = app.wait_for_end(QUIT_LIMIT);
    assert!(status.success() && !told.contains("printed"), "{status}: {told}");
    // Without a display: what there is without a window; and no window.
    let elsewhere = private_folder();
    let info = output_of(command_in(PROGRAM, elsewhere.path(), None).arg("--gl-info"), "mariana").unwrap();
    assert!(String::from_utf8_lossy(&info).contains("renderer "));
    let error = output_of(&mut command_in(PROGRAM, elsewhere.path(), None), "mariana").unwrap_err();
    assert!(error.contains("graphical session") && error.contains("mariana still"), "{error}");
    let error = output_of(&mut command_in(PROGRAM, elsewhere.path(), Some(":987")), "mariana").unwrap_err();
    assert!(error.contains("graphical session"), "{error}");
    // An OpenGL that is too old.
    let mut command = desktop.command(PROGRAM);
    let error = output_of(command.env("MESA_GL_VERSION_OVERRIDE", "3.1"), "mariana").unwrap_err();
    assert!(error.contains("OpenGL") && error.contains("3.3") && !error.contains("panicked"), "{error}");
}
