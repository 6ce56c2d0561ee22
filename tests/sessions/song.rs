//! Playing a song: frames of all sizes, the list of keys above them, and sound on a private server.

#![cfg(target_os = "linux")]

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::support::apart::{apart, apart_at_home, home};
use crate::support::compare::{TIGHT, difference};
use crate::support::desktop::{PROGRAM, Size, command_in, load_of};
use crate::support::session::{App, Place, reported_problems};
use crate::support::wood::assert_shows_the_speakers;
use image::RgbaImage;
use mariana_testing::process::{WAIT_LIMIT, output_of};
use mariana_testing::sound_server::{Recorder, SoundServer};
use mariana_testing::wave::write_wav;
use std::time::Duration;

/// The window size of most tests. It is small, because there is no graphics card.
const SMALL: &str = "320x180";
/// A session counts as idle after this number of steps (of up to 20 ms) without a new frame.
const REST: usize = 60;

fn tone(folder: &Path, seconds: f64) -> PathBuf {
    let path = folder.join("tone.wav");
    let rate = 8_000.0;
    let samples = (0..(seconds * rate) as usize).flat_map(|n| {
        let sample = 0.3 * (std::f64::consts::TAU * 220.0 * n as f64 / rate).sin() as f32;
        [sample, sample]
    });
    write_wav(&path, 8_000, 2, samples);
    path
}

/// Waits until the session's image equals the image of `mariana still` for the song's start at this size.
fn wait_for_start(app: &App, place: &Place, song: &Path, size: Size) -> RgbaImage {
    let path = place.path("still.png");
    let mut command = command_in(PROGRAM, place.folder(), None);
    command.arg("still").arg(song).arg("-o").arg(&path);
    command.args(["--at", "0", "--size", &format!("{}x{}", size.0, size.1)]);
    app.meanwhile(|| output_of(&mut command, "mariana")).unwrap_or_else(|error| panic!("{error}"));
    let wanted = image::open(&path).unwrap().to_rgba8();
    app.wait_for(&format!("the still of {size:?}"), |picture| {
        // The frame may differ for a while during a resize or a redraw.
        picture.dimensions() == size && {
            let found = difference(picture, &wanted, TIGHT.visible);
            found.mean <= TIGHT.mean_max && found.fraction <= TIGHT.fraction_max
        }
    })
}

fn paused_at_start(place: &Place, size: Size) -> (App, RgbaImage, PathBuf) {
    let song = place.quiet_song("quiet.wav", 60);
    let app = place.open(&song, &["--size", &format!("{}x{}", size.0, size.1)]);
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
    app.press(&["Left"]);
    let start = wait_for_start(&app, place, &song, size);
    (app, start, song)
}

/// The bounding box of the pixels that differ: left, top, right and bottom. `None` if the images are equal.
fn changed_box(a: &RgbaImage, b: &RgbaImage) -> Option<[u32; 4]> {
    let changed = a.enumerate_pixels().filter(|(x, y, pixel)| b.get_pixel(*x, *y) != *pixel);
    changed.fold(None, |found, (x, y, _)| {
        let [left, top, right, bottom] = found.unwrap_or([x, y, x, y]);
        Some([left.min(x), top.min(y), right.max(x), bottom.max(y)])
    })
}

#[test]
fn the_list_of_keys_is_shown_and_leaves_no_trace() {
    apart!();
    let place = Place::new();
    // In smaller windows, the list of keys would not fit.
    let (app, before, _) = paused_at_start(&place, (640, 360));
    app.press(&["h"]);
    app.wait_for("the list of keys", |picture| changed_box(&before, picture).is_some());
    let keys = app.wait_until_still();
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
    // The list must neither move nor need processor time.
    let shown = app.shown();
    app.take_steps(REST);
    assert_eq!(app.shown(), shown, "the list of keys is drawn again");
    assert!(app.picture() == keys, "the list of keys moves");
    // Other threads, such as the analysis of the song, may still be busy for a while.
    app.wait_until("rest", |app| load_of(std::process::id(), || app.run_for(Duration::from_secs(1))) < 0.1);
    // A double click on the list must not switch to full screen. The heading has no row to carry out.
    app.double_click_at(320, 36);
    // The session draws new frames behind the list.
    app.press(&["Right"]);
    app.wait_for("another picture", |picture| changed_box(&keys, picture).is_some());
    app.press(&["Left"]);
    app.wait_for("the first frame with the list of keys", |picture| *picture == keys);
    assert!(!app.state().fullscreen);
    // The list disappears at once, and the frame is the same as before.
    app.press(&["F1"]);
    app.wait_for("the first frame", |picture| *picture == before);
    app.press(&["Right"]);
    app.wait_for("another picture", |picture| *picture != before);
    app.press(&["Left"]);
    app.wait_for("the first frame, drawn again", |picture| *picture == before);
    app.double_click_at(320, 180);
    assert!(app.state().fullscreen);
    assert_eq!(reported_problems(&app.quit_by_key()), [""; 0]);
}

#[test]
fn every_window_size_shows_both_speakers() {
    apart!();
    let place = Place::new();
    let (app, _, song) = paused_at_start(&place, (320, 180));
    let sizes = [(160, 400), (700, 90), (97, 61), (1, 1), (200, 1), (1, 200), (320, 180), (1_100, 580)];
    for size in sizes {
        app.resize(size);
        let picture = wait_for_start(&app, &place, &song, size);
        if size.0.min(size.1) > 50 {
            assert_shows_the_speakers(&picture);
        }
    }
    for step in 0..20 {
        app.resize((400 - 15 * step, 80 + 15 * step));
    }
    wait_for_start(&app, &place, &song, (115, 365));
    assert_eq!(reported_problems(&app.quit_by_key()), [""; 0]);
}

#[test]
fn a_song_without_a_sound_server_keeps_real_time_and_loops_or_ends() {
    apart_at_home!();
    let place = Place::new();
    let seconds = 2.0;
    let song = tone(place.folder(), seconds);
    // Without a sound server, the program reports that. It still plays the song in real time.
    let app = place.hear(Some(&song), &["--once", "--size", SMALL]);
    app.wait_until_reported("first picture after");
    let begin = Instant::now();
    let mut titles = String::new();
    while app.step() {
        titles.push_str(&app.title());
        assert!(begin.elapsed() < WAIT_LIMIT, "the session does not end: {}", app.reported());
    }
    let took = begin.elapsed().as_secs_f64();
    assert!(titles.contains("no sound device"), "{titles}");
    // A busy machine may notice the end late, but not by several times the duration.
    assert!(took > 0.9 * seconds && took < 4.0 * seconds, "{seconds} s of song took {took} s");
    let reported_problems = app.reported_problems().join("\n");
    assert_eq!(reported_problems.matches("the song plays without sound: ").count(), 1, "{reported_problems}");
    drop(app);

    let app = place.hear(Some(&song), &["--size", SMALL]);
    let position = |app: &App| app.state().position.unwrap_or(0.0);
    for time in ["first", "second"] {
        app.wait_until(&format!("the {time} end"), |app| position(app) > 0.7);
        app.wait_until("another start", |app| position(app) < 0.3);
    }
    let before = app.picture();
    app.wait_for("another picture", |picture| difference(&before, picture, TIGHT.visible).fraction > 0.0);
    assert!(!app.title().contains("paused"), "{}", app.title());
    assert_eq!(app.reported_problems().len(), 1, "{}", app.reported());
    app.quit_by_key();
}

#[test]
fn frames_continue_when_the_sound_server_dies() {
    apart_at_home!();
    let server = SoundServer::start(&home());
    let recorder = Recorder::start(&home());
    let place = Place::new();
    let song = tone(place.folder(), 60.0);
    let app = place.hear(Some(&song), &["--size", SMALL]);
    app.wait_until("sound", |app| {
        app.meanwhile(|| recorder.next(0.1)).iter().flatten().any(|sample| *sample > 0.1)
    });
    assert_eq!(app.reported_problems(), [""; 0]);
    server.kill();
    app.wait_until_reported("the song plays without sound: ");
    app.wait_for_title("no sound device", |title| title.contains("no sound device"));
    let seconds = |app: &App| 60.0 * app.state().position.unwrap_or(0.0);
    let since = seconds(&app);
    app.wait_until("two seconds of the song", |app| seconds(app) > since + 2.0);
    let before = app.picture();
    app.wait_for("another picture", |picture| difference(&before, picture, TIGHT.visible).fraction > 0.0);
    assert_eq!(app.reported_problems().len(), 1, "expected one message: {}", app.reported());
    app.quit_by_key();
}
