//! From one scene to another in the window: what is prepared ahead, and how the picture changes.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::fs;
use std::path::{Path, PathBuf};

use crate::support::desktop::App;
use crate::walls::{QuietDesktop, quit_content as quit, wait_for_channel};
use mariana_testing::process::wait_until;

const AHEAD: [&str; 2] = ["--prepare-ahead", "on"];

impl QuietDesktop {
    /// Saves a wall that shines in one of the colours red, green and blue, a little differently at each moment.
    fn save_wall(&self, name: &str, channel: usize) {
        let color = ["vec3(1, 0, 0)", "vec3(0, 1, 0)", "vec3(0, 0, 1)"][channel];
        let text = format!(
            "material paint {{ color = 0 roughness = 1 emission = {color} * (0.9 + 0.1 * sin(t)) }}\n\
             object wall {{ shape = 5 - p.z material = paint }}\n\
             light none {{ direction = vec3(0, -1, 0) color = 0 }}\n\
             camera {{ position = vec3(0) target = vec3(0, 0, 5) }}\n\
             sky {{ color = 0 ambient = 0 }}\n"
        );
        fs::write(self.desktop.folder().join(name), text).unwrap();
    }

    fn open_prepared(&self, name: &str, options: &[&str]) -> App<'_> {
        let scene = self.desktop.folder().join(name);
        let scene = ["--silent", "--size", "64x36", "-vv", "--scene", scene.to_str().unwrap()];
        let mut app = self.desktop.open(&self.song, &[&scene[..], options].concat());
        app.wait_for_title("the scene", |title| title.contains(" - Mariana (a, "));
        app
    }
}

fn count(text: &str, what: &str) -> usize {
    text.matches(what).count()
}

/// Pictures that were drawn between two lines of the log.
fn pictures_between(told: &str, from: &str, to: &str) -> usize {
    let (_, after) = told.split_once(from).unwrap();
    let (between, _) = after.split_once(to).unwrap();
    count(between, "a picture in ")
}

#[test]
fn a_change_to_a_prepared_scene_waits_for_nothing_and_the_way_back_neither() {
    let place = QuietDesktop::new();
    place.save_wall("a.scene", 0);
    place.save_wall("b.scene", 1);
    let mut app = place.open_prepared("a.scene", &AHEAD);
    app.wait_until_told("b is ready ahead");
    app.press(&["n"]);
    wait_for_channel(&app, 1);
    app.press(&["p"]);
    wait_for_channel(&app, 0);
    wait_until("the way back", || count(&app.told(), "a is shown, compiled") == 2);
    let told = quit(app);
    // Each was compiled once, and the first picture after a change is the new scene's.
    for name in ["a", "b"] {
        assert_eq!(count(&told, &format!(" {name} is requested, compiled")), 1, "{told}");
    }
    assert_eq!(pictures_between(&told, " b is shown, compiled", "a fade begins"), 0, "{told}");
    assert!(!told.contains("is coming"), "{told}");
}

#[test]
fn a_scene_that_was_prepared_without_code_for_cells_gets_it_when_it_comes_on() {
    let place = QuietDesktop::new();
    place.save_wall("a.scene", 0);
    place.save_wall("b.scene", 1);
    let mut app =
        place.open_prepared("a.scene", &[&AHEAD[..], &["--sdf", "compiled", "--regions", "off"]].concat());
    app.wait_until_told("b is ready ahead");
    app.press(&["r"]);
    app.wait_until_told("a is requested, compiled, with cells");
    app.press(&["n"]);
    app.wait_until_told("b is requested, compiled, with cells");
    quit(app);
}

/// Files below a folder.
fn files_in(folder: &Path) -> usize {
    let Ok(entries) = fs::read_dir(folder) else { return 0 };
    let in_entry = |path: PathBuf| if path.is_dir() { files_in(&path) } else { 1 };
    entries.map(|entry| in_entry(entry.unwrap().path())).sum()
}

/// Waits for this many more pictures.
fn wait_for_pictures(app: &App, more: usize) {
    let before = count(&app.told(), "a picture in ");
    wait_until("pictures", || count(&app.told(), "a picture in ") >= before + more);
}

/// Mesa's software renderers keep a file of each program and of each form of it that they compile.
#[test]
fn a_driver_compiled_prepared_scenes_once_more_when_they_were_shown() {
    let place = QuietDesktop::new();
    // What is prepared beside b has programs that are there.
    for (name, channel) in [("a.scene", 0), ("b.scene", 1), ("c.scene", 0)] {
        place.save_wall(name, channel);
        // It reads the sound's tables, too.
        let path = place.desktop.folder().join(name);
        let text = fs::read_to_string(&path).unwrap();
        fs::write(path, text.replace("* sin(t)", "* sin(t) + 0.1 * spectrum(fract(p.x))")).unwrap();
    }
    let cache = place.desktop.folder().join("driver");
    let variables = [("MESA_SHADER_CACHE_DIR", cache.to_str().unwrap())];
    let scene = place.desktop.folder().join("a.scene");
    let scene = ["--scene", scene.to_str().unwrap()];
    // In one size, which is no power of two.
    let size = ["--silent", "--size", "90x54", "--quality", "best", "-vv", "--sdf", "compiled"];
    let app = place.desktop.open_with(&variables, &place.song, &[&scene[..], &size[..], &AHEAD[..]].concat());
    wait_until("both neighbours", || count(&app.told(), " is ready ahead") == 2);
    // They are written by a thread of the driver.
    let mut files = 0;
    wait_until("the driver's files", || {
        wait_for_pictures(&app, 20);
        let before = std::mem::replace(&mut files, files_in(&cache));
        files > 0 && files == before
    });
    for (key, channel, fades) in [("n", 1, 1), ("p", 0, 2), ("n", 1, 3)] {
        app.press(&[key]);
        wait_for_channel(&app, channel);
        wait_until("the fade's end", || count(&app.told(), "a fade ends") == fades);
        wait_for_pictures(&app, 20);
        assert_eq!(files_in(&cache), files, "the driver compiled something after {key}");
    }
    quit(app);
}

#[test]
fn a_neighbour_that_is_saved_is_prepared_anew_and_one_that_comes_between_is_found() {
    let place = QuietDesktop::new();
    place.save_wall("a.scene", 0);
    place.save_wall("c.scene", 1);
    let mut app = place.open_prepared("a.scene", &AHEAD);
    app.wait_until_told("c is ready ahead");
    place.save_wall("c.scene", 2);
    wait_until("the saved scene, prepared", || count(&app.told(), "c is ready ahead") == 2);
    app.press(&["n"]);
    wait_for_channel(&app, 2);
    app.press(&["p"]);
    wait_for_channel(&app, 0);
    place.save_wall("b.scene", 1);
    app.press(&["n"]);
    wait_for_channel(&app, 1);
    quit(app);
}

#[test]
fn scenes_fade_and_a_fade_of_nothing_is_a_cut() {
    let place = QuietDesktop::new();
    place.save_wall("a.scene", 0);
    place.save_wall("b.scene", 1);
    for (options, fades) in [(&[][..], 1), (&["--fade", "0"], 0), (&["--view", "steps"], 0)] {
        let mut app = place.open_prepared("a.scene", options);
        wait_until("a picture", || app.told().contains("a picture in "));
        app.press(&["n"]);
        app.wait_until_told("b is shown");
        // Some pictures later.
        let pictures = count(&app.told(), "a picture in ");
        wait_until("pictures", || count(&app.told(), "a picture in ") > pictures + 3);
        let told = quit(app);
        assert_eq!(count(&told, "a fade begins"), fades, "{options:?}: {told}");
    }
}

#[test]
fn a_window_whose_scene_is_not_there_yet_says_so() {
    let place = QuietDesktop::new();
    place.save_wall("a.scene", 0);
    let scene = place.desktop.folder().join("a.scene");
    let options =
        ["--silent", "--size", "320x180", "-v", "--sdf", "compiled", "--scene", scene.to_str().unwrap()];
    let app = place.desktop.open_with(&[("MARIANA_FAULT", "slow-compiler@0")], &place.song, &options);
    wait_until("words over black", || {
        let picture = app.picture();
        let [light, dark] = [|sum| sum > 300, |sum| sum < 30].map(|is: fn(u32) -> bool| {
            picture
                .pixels()
                .filter(|pixel| is(pixel.0[..3].iter().map(|&byte| u32::from(byte)).sum()))
                .count()
        });
        assert!(!app.told().contains("first picture"), "there were no words before the picture");
        light > 50 && dark > picture.pixels().count() / 2
    });
    wait_for_channel(&app, 0);
    quit(app);
}

#[test]
fn a_saved_scene_does_not_fade() {
    let place = QuietDesktop::new();
    place.save_wall("a.scene", 0);
    let app = place.open_prepared("a.scene", &[]);
    wait_for_channel(&app, 0);
    place.save_wall("a.scene", 1);
    wait_for_channel(&app, 1);
    assert!(!quit(app).contains("a fade begins"));
}
