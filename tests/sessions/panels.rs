//! The overlay and the pointer: default messages, control by the pointer alone or by keys alone, and continuing the
//! last session.

use crate::support::apart::apart;
#[cfg(target_os = "linux")]
use crate::support::apart::{apart_at_home, home};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::time::Duration;

use crate::support::session::{self, App};
use image::RgbaImage;
use mariana::clock;
use mariana::commands::{Command, Panel, bindings};
use mariana::input::{Input, Key, KeyPress, Modifiers};
use mariana::scenes::SceneSource;

/// The window has room for every panel.
const SIZE: &str = "640x360";
/// A simple scene without motion, so that only the overlay changes the frame.
const STILL: &str = "material paint { color = 0  roughness = 1  emission = vec3(0.5, 0.1, 0.1) }\n\
                     object wall { shape = 5 - p.z  material = paint }\n\
                     light none { direction = vec3(0, -1, 0)  color = 0 }\n\
                     camera { position = vec3(0)  target = vec3(0, 0, 5) }\n\
                     sky { color = 0  ambient = 0 }\n";

struct Place {
    inner: session::Place,
    scene: String,
}

impl Place {
    fn new(songs: &[&str]) -> Self {
        let inner = session::Place::new();
        std::fs::create_dir(inner.path("music")).unwrap();
        for song in songs {
            inner.quiet_song(&format!("music/{song}"), 60);
        }
        let scene = inner.save("still.scene", STILL).to_str().unwrap().to_owned();
        Self { inner, scene }
    }

    fn open(&self, options: &[&str]) -> App {
        let music = self.inner.path("music");
        let own = [music.to_str().unwrap(), "--prepare-ahead", "off", "--silent", "--size", SIZE];
        let scene: &[&str] = if options.contains(&"--scene") { &[] } else { &["--scene", &self.scene] };
        let app = self.inner.begin(&[&own[..], scene, options].concat());
        app.wait_for_title("a scene", |title| title.contains(" - Mariana ("));
        app
    }

    /// Opens a session with only these options, so that it continues the last session.
    fn again(&self, options: &[&str]) -> App {
        self.inner.begin(&[&["--silent", "--prepare-ahead", "off"], options].concat())
    }
}

fn is_covered(picture: &RgbaImage, x: u32, y: u32) -> bool {
    let wall = picture.get_pixel(picture.width() - 1, 0);
    let pixel = picture.get_pixel(x, y);
    (0..3).any(|channel| pixel.0[channel].abs_diff(wall.0[channel]) > 24)
}

/// The bounding box of the pixels that differ from the wall: left, top, right and bottom.
fn panel(picture: &RgbaImage) -> Option<[u32; 4]> {
    let found = picture.enumerate_pixels().filter(|(x, y, _)| is_covered(picture, *x, *y));
    found.fold(None, |all, (x, y, _)| {
        let [left, top, right, bottom] = all.unwrap_or([x, y, x, y]);
        Some([left.min(x), top.min(y), right.max(x), bottom.max(y)])
    })
}

/// Advances simulated time until `wanted` accepts the bounds of the overlay.
fn pass_until(app: &App, what: &str, wanted: impl Fn(Option<[u32; 4]>) -> bool) -> Option<[u32; 4]> {
    let is_wanted = |picture: &RgbaImage| {
        clock::advance(Duration::from_millis(40));
        wanted(panel(picture))
    };
    panel(&app.wait_for(what, is_wanted))
}

fn wait_for_panel(app: &App, what: &str, wanted: impl Fn([u32; 4]) -> bool) -> [u32; 4] {
    pass_until(app, what, |found| found.is_some_and(&wanted)).unwrap()
}

fn wait_for_nothing(app: &App, what: &str) {
    pass_until(app, what, |found| found.is_none());
}

#[test]
fn the_welcome_message_and_the_bar_appear_and_disappear() {
    apart!();
    let place = Place::new(&["one.wav"]);
    let app = place.open(&[]);
    let [left, top, right, _] = wait_for_panel(&app, "the welcome message", |panel| panel[1] > 150);
    assert!(left < 30 && top > 200 && right < 500, "the welcome message is at {left}, {top} to {right}");
    wait_for_nothing(&app, "the end of the welcome message");
    // The bar appears when the pointer moves. It disappears when the pointer rests.
    app.point_at(200, 100);
    app.point_at(240, 120);
    let [left, top, right, _] = wait_for_panel(&app, "the bar", |panel| panel[2] - panel[0] > 500);
    assert!(left < 30 && right > 610 && top > 200, "the bar is at {left}, {top} to {right}");
    wait_for_nothing(&app, "the end of the bar");
    app.press(&["Up"]);
    let [_, top, _, bottom] = wait_for_panel(&app, "the volume", |panel| panel[3] < 150);
    assert!(top < 40 && bottom < 100, "the notice is from {top} to {bottom}");
    wait_for_nothing(&app, "the end of the notice");
    app.quit();
}

#[test]
fn a_clean_window_shows_only_requested_panels() {
    apart!();
    let place = Place::new(&["one.wav"]);
    let app = place.open(&["--clean"]);
    app.point_at(200, 100);
    app.point_at(240, 120);
    app.press(&["Up", "Left"]);
    for _ in 0..30 {
        clock::advance(Duration::from_millis(40));
        app.step();
    }
    assert_eq!(panel(&app.picture()), None, "a clean window shows an overlay");
    app.press(&["h"]);
    wait_for_panel(&app, "the requested list of keys", |_| true);
    app.quit();
}

/// Waits for the bar in real time, because reading the list of songs takes real time.
fn wait_for_bar(app: &App) -> [u32; 4] {
    let bar = |picture: &RgbaImage| panel(picture).filter(|panel| panel[2] - panel[0] > 500);
    bar(&app.wait_for("the bar", |picture| bar(picture).is_some())).unwrap()
}

#[test]
fn the_pointer_alone_pauses_seeks_changes_scenes_and_fills_the_screen() {
    apart!();
    let place = Place::new(&["one.wav", "two.wav"]);
    let app = place.open(&[]);
    app.wait_for_title("the first track", |title| title.contains("1/2"));
    app.point_at(200, 100);
    app.point_at(240, 120);
    let [left, top, right, bottom] = wait_for_bar(&app);
    // Buttons are 30 pixels wide and 2 pixels apart, in a row at the bottom.
    let y = bottom - 11 - 15;
    let button = |place: u32| left + 14 + 15 + 32 * place;
    let from_right = |place: u32| right - 14 - 15 - 32 * place;
    app.click_at(button(1), y);
    app.wait_for_title("paused", |title| title.contains("paused"));
    app.click_at(button(2), y);
    app.wait_for_title("the second track", |title| title.contains("2/2"));
    // A click on the end of the rail seeks to the end of the track, so the first track follows.
    app.click_at(button(1), y);
    app.wait_for_title("playing", |title| !title.contains("paused"));
    app.click_at(right - 16, top + 11 + 19 + 3 + 13);
    app.wait_for_title("the first track again", |title| title.contains("1/2"));
    let click_in_list = |x: u32, y: u32| {
        app.wait_for("the list", |picture| is_covered(picture, x, y));
        app.click_at(x, y);
    };
    app.click_at(from_right(7), y);
    click_in_list(right - 200, 14 + 11 + 36 + 24 + 12);
    app.wait_for_title("the second track from the list", |title| title.contains("2/2"));
    app.click_at(from_right(5), y);
    click_in_list(14 + 14 + 170 + 100, 14 + 11 + 24 + 40);
    app.wait_for_title("another scene", |title| !title.contains("(2/2, still"));
    app.click_at(from_right(0), y);
    app.wait_until("full screen", |app| app.state().fullscreen);
    quit_by_escape(app);
}

/// Esc closes the open list, leaves full screen, and quits.
fn quit_by_escape(app: App) {
    app.press(&["Escape", "Escape"]);
    app.wait_until("the end of full screen", |app| !app.state().fullscreen);
    app.quit_by_key();
}

#[test]
fn a_session_continues_where_the_last_one_ended() {
    apart!();
    let place = Place::new(&["one.wav", "two.wav"]);
    let app = place.open(&["--scene", "first_steps"]);
    app.press(&["Next", "Down", "Down", "l"]);
    app.wait_for_title("the second track", |title| title.contains("2/2") && title.contains("volume 90 %"));
    app.quit();
    let app = place.again(&[]);
    app.wait_for_title("the state of the last session", |title| {
        title.starts_with("two.wav - Mariana (2/2, first_steps") && title.contains("volume 90 %")
    });
    assert_eq!(app.picture().dimensions(), (640, 360));
    app.quit();
    // A session with --new neither uses nor changes the saved state. The next session continues from that state.
    let app = place.again(&["--new", "--size", "320x180"]);
    app.wait_for_title("the demo track", |title| title.contains("speakers") && !title.contains("volume"));
    app.press(&["Down"]);
    app.wait_for_title("another volume", |title| title.contains("volume 95 %"));
    app.quit();
    // If the saved tracks are missing, the session reports that and starts.
    std::fs::remove_dir_all(place.inner.path("music")).unwrap();
    let app = place.again(&[]);
    app.wait_for_title("the demo track", |title| title.contains("first_steps") && title.contains("90 %"));
    app.wait_until_reported("the tracks of the last show can no longer be played");
    app.quit();
}

#[test]
fn a_scene_that_ended_the_program_ended_every_start_after_it() {
    apart!();
    let place = Place::new(&["one.wav"]);
    let own = place.inner.save("own.scene", STILL);
    let named = ["--scene", own.to_str().unwrap()];
    let is_own = |title: &str| title.contains("own");
    let app = place.open(&named);
    app.wait_for_title("the scene", is_own);
    app.quit();
    // As after a run that was killed while it loaded the scene.
    let mut hasher = DefaultHasher::new();
    format!("{:?}", SceneSource::File(own.clone())).hash(&mut hasher);
    let mark = place.inner.path(&format!("cache/loading/{:016x}", hasher.finish()));
    let kill = || std::fs::write(&mark, "").unwrap();
    kill();
    let app = place.again(&[]);
    app.wait_for_title("another scene", |title| title.contains("speakers"));
    app.wait_until_reported("Mariana ended while it loaded this scene the last time");
    app.quit();
    kill();
    let app = place.again(&named);
    app.wait_for_title("the scene that the user asks for", is_own);
    app.quit();
}

#[cfg(target_os = "linux")]
#[test]
fn the_keys_alone_find_a_scene_and_play_a_folder() {
    apart_at_home!();
    let place = Place::new(&["one.wav"]);
    let album = home().join("album");
    std::fs::create_dir(&album).unwrap();
    for name in ["alpha.wav", "beta.wav"] {
        std::fs::copy(place.inner.path("music/one.wav"), album.join(name)).unwrap();
    }
    std::fs::copy(place.inner.path("music/one.wav"), home().join("beside.wav")).unwrap();
    // No folder was opened before, so the file list begins in the user's home folder.
    let app = place.open(&[]);
    app.press(&["b"]);
    app.wait_for("the list of scenes", |picture| is_covered(picture, 320, 180));
    // Typed letters search the list, so Q does not quit here.
    app.press(&["q", "u", "a", "d", "r", "Return"]);
    app.wait_for_title("the scene that was found", |title| title.contains("quadric"));
    // Opening a file also ends live input.
    app.press(&["d"]);
    app.wait_for_title("an input", |title| title.contains("no sound") || title.contains("live"));
    app.press(&["o"]);
    app.wait_until_reported(&format!("{} is listed", home().display()));
    app.press(&["a", "l", "b", "Return", "ctrl+Return"]);
    app.wait_for_title("the folder", |title| title.starts_with("alpha.wav") && title.contains("1/2"));
    // After a list is closed, keys control the show again.
    app.press(&["u", "Escape", "Next"]);
    app.wait_for_title("the next track", |title| title.starts_with("beta.wav"));
    app.quit_by_key();
}

#[test]
fn a_session_that_ends_before_its_first_frame_keeps_its_scene() {
    // The fault delays the compiler once, so the session ends before it shows a scene.
    apart!("MARIANA_FAULT" = "slow-compiler@0");
    let place = Place::new(&["one.wav"]);
    let song = place.inner.path("music/one.wav");
    let options = [song.to_str().unwrap(), "--size", SIZE, "--scene", "first_steps", "--sdf", "compiled"];
    let app = place.again(&options);
    assert!(!app.title().contains("first_steps"), "{}", app.title());
    app.quit();
    let app = place.again(&[]);
    app.wait_for_title("the requested scene", |title| title.contains("first_steps"));
    app.quit();
}

#[test]
fn keys_that_open_a_panel_did_not_close_it() {
    apart!();
    let place = Place::new(&["one.wav"]);
    let app = place.open(&[]);
    let press = |key: &Key<&str>, held: Modifiers| {
        let key = match key {
            Key::Character(text) => Key::Character((*text).to_owned()),
            Key::Named(named) => Key::Named(*named),
            Key::Other => Key::Other,
        };
        let text = if let Key::Character(text) = &key { Some(text.clone()) } else { None };
        app.send(Input::Modifiers(held));
        app.send(Input::Key(KeyPress { key, latin: None, text, repeat: false }));
        app.send(Input::Modifiers(Modifiers::empty()));
    };
    let closed = app.panels();
    let mut met = 0;
    for binding in bindings() {
        let first = binding.keys.first().map(|(key, _)| key);
        let keys = binding.keys.iter().map(|(key, command)| (key, Modifiers::empty(), command));
        let shifted = first.zip(binding.shifted.as_ref());
        let shifted = shifted.map(|(key, command)| (key, Modifiers::SHIFT, command));
        for (key, held, command) in keys.chain(shifted) {
            match command {
                // All letters are text in the editor, so Esc closes it.
                Command::TogglePanel(Panel::Editor) => continue,
                Command::TogglePanel(_) | Command::ToggleHelp => {}
                Command::ToggleSliders | Command::ToggleSceneLine => {}
                _ => continue,
            }
            press(key, held);
            assert_ne!(app.panels(), closed, "{} opens nothing", binding.written);
            press(key, held);
            assert_eq!(app.panels(), closed, "{} does not close what it opens", binding.written);
            met += 1;
        }
    }
    assert!(met > 10, "only {met} keys");
    // Once something is typed, the letter belongs to the search. A space begins a search for a word with this letter.
    for typed in ["q", " "] {
        app.press(&["b"]);
        app.type_text(typed);
        app.press(&["b"]);
        assert_eq!(app.panels().open, Some(Panel::Scenes));
        app.press(&["Escape", "Escape"]);
        assert_eq!(app.panels(), closed);
    }
    app.quit();
}

#[test]
fn esc_left_the_sliders_open_behind_other_panels() {
    apart!();
    let place = Place::new(&["one.wav"]);
    let scene = place.inner.save("knob.scene", &format!("param girth = 1 in 0 .. 2\n{STILL}"));
    let app = place.open(&["--scene", scene.to_str().unwrap()]);
    app.press(&["Tab", "g", "h"]);
    let state = || (app.panels().help, app.panels().open, app.panels().sliders);
    assert_eq!(state(), (true, Some(Panel::Settings), true));
    for rest in [(false, Some(Panel::Settings), true), (false, None, true), (false, None, false)] {
        app.press(&["Escape"]);
        assert_eq!(state(), rest);
    }
    app.quit();
}

#[test]
fn messages_and_panels_stood_over_a_blackout() {
    apart!();
    let place = Place::new(&["one.wav"]);
    let app = place.open(&["--blackout-fade", "0"]);
    let is_black = |picture: &RgbaImage| picture.pixels().all(|pixel| pixel.0[..3] == [0; 3]);
    app.press(&["g", "x"]);
    app.wait_for("black", is_black);
    // Answers, errors and the bar stay away too.
    app.press(&["Up"]);
    app.move_pointer(300.0, 200.0);
    std::fs::write(&place.scene, "object o { shape = nonsense }").unwrap();
    app.wait_until_reported("has mistakes");
    app.take_steps(5);
    assert!(is_black(&app.picture()), "the blackout does not hide everything");
    // A panel that the user opens now is shown.
    app.press(&["h"]);
    app.wait_for("the keys", |picture| !is_black(picture));
    app.press(&["h"]);
    app.wait_for("black again", is_black);
    app.press(&["x"]);
    app.wait_for("the picture with the mistake", |picture| !is_black(picture));
    app.quit();
}
