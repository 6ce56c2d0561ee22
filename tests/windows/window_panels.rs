//! What a window says by itself, and everything that the pointer or a list of the window is for: walks with the pointer
//! alone and with the keys alone.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::support::desktop::{App, Desktop, SCREEN};
use crate::walls::quit;
use image::RgbaImage;
use mariana_testing::process::wait_until;
use mariana_testing::sound_server::SINK_RATE;
use mariana_testing::wave::write_wav;

/// A window in which every panel has its room.
const SIZE: &str = "640x360";
/// A scene that never moves and costs little: what changes in the picture is what stands over it.
const STILL: &str = "material paint { color = 0  roughness = 1  emission = vec3(0.5, 0.1, 0.1) }\n\
                     object wall { shape = 5 - p.z  material = paint }\n\
                     light none { direction = vec3(0, -1, 0)  color = 0 }\n\
                     camera { position = vec3(0)  target = vec3(0, 0, 5) }\n\
                     sky { color = 0  ambient = 0 }\n";

struct Place {
    desktop: Desktop,
    song: PathBuf,
    scene: PathBuf,
}

impl Place {
    fn new() -> Self {
        let desktop = Desktop::start();
        let song = silent_song(desktop.folder(), "one.wav");
        let scene = desktop.folder().join("still.scene");
        std::fs::write(&scene, STILL).unwrap();
        Self { desktop, song, scene }
    }

    /// The window with everything that it says by itself, when its first words have gone.
    fn open(&self, song: &Path, options: &[&str]) -> App<'_> {
        let scene = self.scene.to_str().unwrap();
        let ahead = ["--prepare-ahead", "off", "--silent", "--size", SIZE];
        let all = [&ahead[..], if options.contains(&"--scene") { &[] } else { &["--scene", scene] }, options];
        let mut app = self.desktop.open_with_words(song, &all.concat());
        app.wait_for_title("a scene", |title| title.contains(" - Mariana ("));
        app
    }

    /// The program with nothing but these options, so that it goes on where the last show ended.
    fn again(&self, variables: &[(&str, &str)], options: &[&str]) -> App<'_> {
        let mut command = self.desktop.command(crate::support::desktop::PROGRAM);
        command.envs(variables.iter().copied()).args(["--silent", "--prepare-ahead", "off"]).args(options);
        command.stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped());
        self.desktop.show(command, Path::new(""))
    }
}

fn silent_song(folder: &Path, name: &str) -> PathBuf {
    let path = folder.join(name);
    let rate = f64::from(SINK_RATE);
    write_wav(&path, SINK_RATE, 2, (0..(60.0 * rate) as usize).flat_map(|_| [0.0, 0.0]));
    path
}

/// The least box of the pixels that are not the wall's: left, top, right and bottom.
fn panel(picture: &RgbaImage) -> Option<[u32; 4]> {
    let wall = *picture.get_pixel(picture.width() - 1, 0);
    let apart = |pixel: &image::Rgba<u8>| (0..3).any(|c| pixel.0[c].abs_diff(wall.0[c]) > 24);
    let found = picture.enumerate_pixels().filter(|(_, _, pixel)| apart(pixel));
    found.fold(None, |all, (x, y, _)| {
        let [left, top, right, bottom] = all.unwrap_or([x, y, x, y]);
        Some([left.min(x), top.min(y), right.max(x), bottom.max(y)])
    })
}

fn wait_for_panel(app: &App, what: &str, wanted: impl Fn([u32; 4]) -> bool) -> [u32; 4] {
    let mut found = None;
    wait_until(what, || {
        found = panel(&app.picture()).filter(|panel| wanted(*panel));
        found.is_some()
    });
    found.unwrap()
}

fn wait_for_nothing(app: &App, what: &str) {
    wait_until(what, || panel(&app.picture()).is_none());
}

fn point(app: &App, x: u32, y: u32) {
    app.xdotool(&["mousemove", "--window", app.window(), &x.to_string(), &y.to_string()]);
}

fn click(app: &App, x: u32, y: u32) {
    point(app, x, y);
    std::thread::sleep(Duration::from_millis(300));
    app.xdotool(&["click", "1"]);
}

#[test]
fn first_words_and_the_bar_come_and_go_and_a_clean_window_has_neither() {
    let place = Place::new();
    let app = place.open(&place.song, &[]);
    let [left, top, right, _] = wait_for_panel(&app, "the first words", |panel| panel[1] > 150);
    assert!(left < 30 && top > 200 && right < 500, "the first words are at {left}, {top} to {right}");
    wait_for_nothing(&app, "the end of the first words");
    // The pointer brings the bar, and takes it along when it rests.
    point(&app, 200, 100);
    point(&app, 240, 120);
    let [left, top, right, _] = wait_for_panel(&app, "the bar", |panel| panel[2] - panel[0] > 500);
    assert!(left < 30 && right > 610 && top > 200, "the bar is at {left}, {top} to {right}");
    wait_for_nothing(&app, "the end of the bar");
    // An answer, and it goes.
    app.press(&["Up"]);
    let [_, top, _, bottom] = wait_for_panel(&app, "the volume", |panel| panel[3] < 150);
    assert!(top < 40 && bottom < 100, "the answer is from {top} to {bottom}");
    wait_for_nothing(&app, "the end of the answer");
    quit(app);
    let app = place.open(&place.song, &["--clean"]);
    point(&app, 200, 100);
    point(&app, 240, 120);
    app.press(&["Up", "Left"]);
    std::thread::sleep(Duration::from_millis(1_200));
    assert_eq!(panel(&app.picture()), None, "a clean window says something");
    app.press(&["h"]);
    wait_for_panel(&app, "the keys, which were asked for", |_| true);
    quit(app);
}

#[test]
fn with_the_pointer_alone_one_pauses_seeks_changes_scene_and_fills_the_screen() {
    let place = Place::new();
    silent_song(place.desktop.folder(), "two.wav");
    let mut app = place.open(place.desktop.folder(), &[]);
    app.wait_for_title("the first track", |title| title.contains("1/2"));
    point(&app, 200, 100);
    point(&app, 240, 120);
    let [left, top, right, bottom] = wait_for_panel(&app, "the bar", |panel| panel[2] - panel[0] > 500);
    // Buttons are 30 wide with 2 between them, in a row at the bottom.
    let y = bottom - 11 - 15;
    let button = |place: u32| left + 14 + 15 + 32 * place;
    let from_right = |place: u32| right - 14 - 15 - 32 * place;
    click(&app, button(1), y);
    app.wait_for_title("paused", |title| title.contains("paused"));
    click(&app, button(2), y);
    app.wait_for_title("the second track", |title| title.contains("2/2"));
    // Near the end of the rail: the track ends, and the first one follows.
    click(&app, button(1), y);
    app.wait_for_title("playing", |title| !title.contains("paused"));
    click(&app, right - 16, top + 11 + 19 + 3 + 13);
    app.wait_for_title("the first track again", |title| title.contains("1/2"));
    // The list of tracks: a click on the second one plays it.
    click(&app, from_right(8), y);
    std::thread::sleep(Duration::from_millis(500));
    click(&app, right - 200, 14 + 11 + 36 + 24 + 12);
    app.wait_for_title("the second track from the list", |title| title.contains("2/2"));
    // The list of scenes: the second tile.
    click(&app, from_right(5), y);
    std::thread::sleep(Duration::from_millis(500));
    click(&app, 14 + 14 + 170 + 100, 14 + 11 + 24 + 40);
    app.wait_for_title("another scene", |title| !title.contains("(2/2, still"));
    click(&app, from_right(0), y);
    app.wait_for_size(SCREEN);
    quit_by_escape(app);
}

/// Closes the list that is open, leaves full screen and quits.
fn quit_by_escape(mut app: App) {
    app.press(&["Escape", "Escape"]);
    app.wait_for_size((640, 360));
    quit(app);
}

#[test]
fn with_the_keys_alone_one_finds_a_scene_and_plays_a_folder() {
    let place = Place::new();
    let album = place.desktop.folder().join("album");
    std::fs::create_dir(&album).unwrap();
    for name in ["alpha.wav", "beta.wav"] {
        silent_song(&album, name);
    }
    // Where nothing is remembered the list of files begins in the user's folder.
    let mut app = place.open(&place.song, &[]);
    app.press(&["b"]);
    std::thread::sleep(Duration::from_millis(500));
    // Letters are searched for: Q is one of them.
    app.press(&["q", "u", "a", "d", "r", "Return"]);
    app.wait_for_title("the scene that was found", |title| title.contains("quadric"));
    // Files that are opened are heard, whatever was listened to.
    app.press(&["d"]);
    app.wait_for_title("an input", |title| title.contains("no sound") || title.contains("live"));
    app.press(&["o"]);
    std::thread::sleep(Duration::from_millis(500));
    app.press(&["a", "l", "b"]);
    std::thread::sleep(Duration::from_millis(500));
    app.press(&["Return"]);
    std::thread::sleep(Duration::from_millis(500));
    app.press(&["ctrl+Return"]);
    app.wait_for_title("the folder", |title| title.starts_with("alpha.wav") && title.contains("1/2"));
    // A list that is open takes no other keys with it when it closes.
    app.press(&["u", "Escape", "Next"]);
    app.wait_for_title("the next track", |title| title.starts_with("beta.wav"));
    quit(app);
}

#[test]
fn a_show_that_ended_before_its_first_picture_forgot_its_scene() {
    let place = Place::new();
    // The driver is slow once, so that nothing is on the stage yet when the show ends.
    let song = place.song.to_str().unwrap();
    let options = [song, "--size", SIZE, "--scene", "first_steps", "--sdf", "compiled"];
    let app = place.again(&[("MARIANA_FAULT", "slow-compiler@0")], &options);
    assert!(!app.title().contains("first_steps"), "{}", app.title());
    quit(app);
    let mut app = place.again(&[], &[]);
    app.wait_for_title("the scene that was asked for", |title| title.contains("first_steps"));
    quit(app);
}

#[test]
fn a_show_goes_on_where_the_last_one_ended() {
    let place = Place::new();
    silent_song(place.desktop.folder(), "two.wav");
    let folder = place.desktop.folder();
    let mut app = place.open(folder, &["--scene", "first_steps"]);
    app.press(&["Next", "Down", "Down", "l"]);
    app.wait_for_title("the second track", |title| title.contains("2/2") && title.contains("volume 90 %"));
    quit(app);
    let mut app = place.again(&[], &[]);
    app.wait_for_title("what was left", |title| {
        title.starts_with("two.wav - Mariana (2/2, first_steps") && title.contains("volume 90 %")
    });
    assert_eq!(app.size(), (640, 360));
    quit(app);
    // Nothing of it, and nothing is left: the next but one goes on with the same again.
    let mut app = place.again(&[], &["--new", "--size", "320x180"]);
    app.wait_for_title("the demo track", |title| title.contains("speakers") && !title.contains("volume"));
    app.press(&["Down"]);
    app.wait_for_title("another volume", |title| title.contains("volume 95 %"));
    quit(app);
    // What has gone costs a sentence, never the start.
    std::fs::remove_file(folder.join("one.wav")).unwrap();
    std::fs::remove_file(folder.join("two.wav")).unwrap();
    let mut app = place.again(&[], &[]);
    app.wait_for_title("the demo track", |title| title.contains("first_steps") && title.contains("90 %"));
    app.wait_until_told("the tracks of the last show cannot be played any more");
    quit(app);
}
