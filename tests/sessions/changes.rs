//! Changes between scenes: scenes that are prepared ahead, and fades.

use crate::support::apart::apart;
use std::fs;
use std::path::{Path, PathBuf};

use crate::support::session::{self, App};
use crate::walls::wait_for_channel;

const AHEAD: [&str; 2] = ["--prepare-ahead", "on"];

struct Place(session::Place);

impl Place {
    fn new() -> Self {
        Self(session::Place::with_song())
    }

    fn save_wall(&self, name: &str, channel: usize) {
        let color = ["vec3(1, 0, 0)", "vec3(0, 1, 0)", "vec3(0, 0, 1)"][channel];
        let text = format!(
            "material paint {{ color = 0 roughness = 1 emission = {color} * (0.9 + 0.1 * sin(t)) }}\n\
             object wall {{ shape = 5 - p.z material = paint }}\n\
             light none {{ direction = vec3(0, -1, 0) color = 0 }}\n\
             camera {{ position = vec3(0) target = vec3(0, 0, 5) }}\n\
             sky {{ color = 0 ambient = 0 }}\n"
        );
        self.0.save(name, &text);
    }

    fn open_with_compiler(&self, name: &str, options: &[&str]) -> App {
        let scene = self.0.path(name);
        let own = ["--scene", scene.to_str().unwrap(), "--sdf", "compiled"];
        self.0.open_with_compiler(&self.0.song(), &[&own[..], options].concat())
    }

    fn open(&self, name: &str, options: &[&str]) -> App {
        let scene = self.0.path(name);
        let own = ["--size", "64x36", "--scene", scene.to_str().unwrap()];
        let app = self.0.open(&self.0.song(), &[&own[..], options].concat());
        app.wait_for_title("the scene", |title| title.contains(" - Mariana (a, "));
        app
    }
}

fn count(text: &str, what: &str) -> usize {
    text.matches(what).count()
}

fn pictures_between(reported: &str, from: &str, to: &str) -> usize {
    let (_, after) = reported.split_once(from).unwrap();
    let (between, _) = after.split_once(to).unwrap();
    count(between, "a frame took ")
}

#[test]
fn changing_to_a_prepared_scene_and_back_never_waits() {
    apart!();
    let place = Place::new();
    place.save_wall("a.scene", 0);
    place.save_wall("b.scene", 1);
    let app = place.open("a.scene", &AHEAD);
    app.wait_until_reported("b is ready ahead");
    app.press(&["n"]);
    wait_for_channel(&app, 1);
    app.press(&["p"]);
    wait_for_channel(&app, 0);
    app.wait_until("the first scene again", |app| count(&app.reported(), "a is shown, compiled") == 2);
    let reported = app.quit_content();
    // The log shows that each scene was compiled once. The first frame after a change shows the new scene.
    for name in ["a", "b"] {
        assert_eq!(count(&reported, &format!(" {name} is requested, compiled")), 1, "{reported}");
    }
    assert_eq!(pictures_between(&reported, " b is shown, compiled", "a fade begins"), 0, "{reported}");
    assert!(!reported.contains("is coming"), "{reported}");
}

#[test]
fn a_scene_prepared_without_cell_lookups_gets_them_when_shown() {
    apart!();
    let place = Place::new();
    place.save_wall("a.scene", 0);
    place.save_wall("b.scene", 1);
    let app = place.open("a.scene", &[&AHEAD[..], &["--sdf", "compiled", "--regions", "off"]].concat());
    app.wait_until_reported("b is ready ahead");
    app.press(&["r"]);
    app.wait_until_reported("a is requested, compiled, with cells");
    app.press(&["n"]);
    app.wait_until_reported("b is requested, compiled, with cells");
    app.quit_content();
}

#[test]
fn saved_and_new_neighbour_scenes_are_prepared_again() {
    apart!();
    let place = Place::new();
    place.save_wall("a.scene", 0);
    place.save_wall("c.scene", 1);
    let app = place.open("a.scene", &AHEAD);
    app.wait_until_reported("c is ready ahead");
    place.save_wall("c.scene", 2);
    app.wait_until("the saved scene to be prepared", |app| count(&app.reported(), "c is ready ahead") == 2);
    app.press(&["n"]);
    wait_for_channel(&app, 2);
    app.press(&["p"]);
    wait_for_channel(&app, 0);
    place.save_wall("b.scene", 1);
    app.press(&["n"]);
    wait_for_channel(&app, 1);
    app.quit_content();
}

#[test]
fn scenes_fade_and_a_fade_of_zero_seconds_is_a_cut() {
    apart!();
    let place = Place::new();
    place.save_wall("a.scene", 0);
    place.save_wall("b.scene", 1);
    for (options, fades) in [(&[][..], 1), (&["--fade", "0"], 0), (&["--view", "steps"], 0)] {
        let app = place.open("a.scene", options);
        app.wait_until("a picture", |app| app.reported().contains("a frame took "));
        app.press(&["n"]);
        app.wait_until_reported("b is shown");
        let pictures = count(&app.reported(), "a frame took ");
        app.wait_until("pictures", |app| count(&app.reported(), "a frame took ") > pictures + 3);
        let reported = app.quit_content();
        assert_eq!(count(&reported, "a fade begins"), fades, "{options:?}: {reported}");
    }
}

#[test]
fn a_saved_scene_does_not_fade() {
    apart!();
    let place = Place::new();
    place.save_wall("a.scene", 0);
    let app = place.open("a.scene", &[]);
    wait_for_channel(&app, 0);
    place.save_wall("a.scene", 1);
    wait_for_channel(&app, 1);
    assert!(!app.quit_content().contains("a fade begins"));
}

fn files_in(folder: &Path) -> usize {
    let Ok(entries) = fs::read_dir(folder) else { return 0 };
    let in_entry = |path: PathBuf| if path.is_dir() { files_in(&path) } else { 1 };
    entries.map(|entry| in_entry(entry.unwrap().path())).sum()
}

fn wait_for_pictures(app: &App, more: usize) {
    let before = count(&app.reported(), "a frame took ");
    app.wait_until("pictures", |app| count(&app.reported(), "a frame took ") >= before + more);
}

/// The test counts the cache files of Mesa's software renderers: one for each shader and for each compiled variant.
#[test]
fn prepared_scenes_are_not_compiled_again_when_shown() {
    let cache = tempfile::tempdir().unwrap();
    apart!("EGL_PLATFORM" = "surfaceless", "MESA_SHADER_CACHE_DIR" = cache.path().to_str().unwrap());
    let cache = PathBuf::from(std::env::var_os("MESA_SHADER_CACHE_DIR").unwrap());
    let place = Place::new();
    // The neighbours of b need no new programs: a is compiled already, and c has the same text as a.
    for (name, channel) in [("a.scene", 0), ("b.scene", 1), ("c.scene", 0)] {
        place.save_wall(name, channel);
        let path = place.0.path(name);
        let text = fs::read_to_string(&path).unwrap();
        fs::write(path, text.replace("* sin(t)", "* sin(t) + 0.1 * spectrum(fract(p.x))")).unwrap();
    }
    // The size is not a power of two.
    let app = place
        .open_with_compiler("a.scene", &[&["--size", "90x54", "--quality", "best"], &AHEAD[..]].concat());
    app.wait_until("both neighbours", |app| count(&app.reported(), " is ready ahead") == 2);
    // The driver writes the files on a separate thread.
    let mut files = 0;
    app.wait_until("the driver's files", |app| {
        wait_for_pictures(app, 20);
        let before = std::mem::replace(&mut files, files_in(&cache));
        files > 0 && files == before
    });
    for (key, channel, fades) in [("n", 1, 1), ("p", 0, 2), ("n", 1, 3)] {
        app.press(&[key]);
        wait_for_channel(&app, channel);
        app.wait_until("the end of the fade", |app| count(&app.reported(), "a fade ends") == fades);
        wait_for_pictures(&app, 20);
        assert_eq!(files_in(&cache), files, "the driver compiled something after {key}");
    }
    app.quit_content();
}

#[test]
fn a_message_is_shown_until_the_first_scene_is_ready() {
    apart!("EGL_PLATFORM" = "surfaceless", "MARIANA_FAULT" = "slow-compiler@0");
    let place = Place::new();
    place.save_wall("a.scene", 0);
    let app = place.open_with_compiler("a.scene", &["--size", "320x180"]);
    app.wait_until("a message over a calm picture", |app| {
        let picture = app.picture();
        let [light, calm] = [|sum| sum > 300, |sum| (1..150).contains(&sum)].map(|is: fn(u32) -> bool| {
            picture
                .pixels()
                .filter(|pixel| is(pixel.0[..3].iter().map(|&byte| u32::from(byte)).sum()))
                .count()
        });
        assert!(!app.reported().contains("first picture"), "no message before the first frame");
        light > 50 && calm > picture.pixels().count() / 2
    });
    wait_for_channel(&app, 0);
    app.quit_content();
}
