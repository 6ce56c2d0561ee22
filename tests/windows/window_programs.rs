//! The programs that draw the window: the interpreter for nearly every scene that is there before anyone edits, what is
//! kept from run to run, and drivers that fail. Mesa's option `force_gl_renderer` makes its software renderer pass for a
//! GPU.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use crate::support::desktop::{App, Desktop, PROGRAM};
use crate::walls::{quiet_song, quit_content as quit, wait_for_channel};
use mariana_testing::process::wait_until;

/// What makes Mesa's software renderer pass for a GPU, silently.
const GPU: [(&str, &str); 2] = [("force_gl_renderer", "GPU"), ("MESA_DEBUG", "silent")];
/// What the log says once the interpreter for nearly every scene is there; the other kind's line goes on.
const READY: &str = "the universal interpreter is ready\n";
const READY_STEEP: &str = "the universal interpreter is ready, for formulas";

/// A desktop with a song and a scene.
struct Place {
    desktop: Desktop,
    song: PathBuf,
    scene: PathBuf,
}

impl Place {
    fn new() -> Self {
        let desktop = Desktop::start();
        let (song, scene) = (quiet_song(desktop.folder()), desktop.folder().join("own.scene"));
        let place = Self { desktop, song, scene };
        place.save(0, "p.z - 5");
        place
    }

    /// Saves a wall that shines in one of the colours red, green and blue.
    fn save(&self, channel: usize, wall: &str) {
        let color = ["vec3(1, 0, 0)", "vec3(0, 1, 0)", "vec3(0, 0, 1)"][channel];
        let text = format!(
            "material paint {{ color = 0 roughness = 1 emission = {color} }}\n\
             object wall {{ shape = -({wall}) material = paint }}\n\
             light none {{ direction = vec3(0, -1, 0) color = 0 }}\n\
             camera {{ position = vec3(0) target = vec3(0, 0, 5) }}\n\
             sky {{ color = 0 ambient = 0 }}\n"
        );
        fs::write(&self.scene, text).unwrap();
    }

    fn arguments<'a>(&'a self, options: &[&'a str]) -> Vec<&'a str> {
        let scene = self.scene.to_str().unwrap();
        [&["--silent", "--size", "64x36", "-v", "--scene", scene], options].concat()
    }

    /// The window with these variables, when its scene shows.
    fn open(&self, variables: &[(&str, &str)], options: &[&str]) -> App<'_> {
        let mut app = self.desktop.open_with(variables, &self.song, &self.arguments(options));
        app.wait_for_title("the scene", |title| title.contains("(own, "));
        app
    }

    /// The folder of kept programs.
    fn kept(&self) -> PathBuf {
        self.desktop.folder().join(".cache/mariana/programs")
    }

    /// Its files of a kind.
    fn files(&self, kind: &str) -> Vec<PathBuf> {
        let Ok(entries) = fs::read_dir(self.kept()) else { return Vec::new() };
        let paths = entries.map(|entry| entry.unwrap().path());
        paths.filter(|path| path.extension().is_some_and(|end| end == kind)).collect()
    }
}

fn count(text: &str, what: &str) -> usize {
    text.matches(what).count()
}

#[test]
fn edits_find_the_interpreter_and_the_next_start_finds_it_kept_unless_it_is_damaged() {
    let place = Place::new();
    let options = ["--sdf", "interpreted"];
    let mut app = place.open(&GPU, &options);
    wait_for_channel(&app, 0);
    app.wait_until_told(READY);
    app.wait_until_told(READY_STEEP);
    let before = app.told();
    // Operators that the first scene had not, then a formula that is no distance.
    for (channel, wall) in [(1, "p.z - 5 - 0.1 * sin(3 * p.x) * cos(t)"), (2, "p.z * p.z * p.z - 99")] {
        place.save(channel, wall);
        wait_for_channel(&app, channel);
    }
    let told = quit(app);
    let after = told.strip_prefix(&before).unwrap();
    assert!(!after.contains("is requested"), "an edit waited for a compiler: {after}");
    // The first scene's own, which was there sooner, too.
    assert_eq!((place.files("program").len(), place.files("attempt").len()), (3, 0));

    place.save(0, "p.z - 5");
    let mut app = place.open(&GPU, &options);
    wait_for_channel(&app, 0);
    app.wait_until_told(READY_STEEP);
    let told = quit(app);
    assert_eq!((count(&told, "a kept program is there"), count(&told, "is compiled")), (3, 0), "{told}");

    // One that is cut off.
    let files = place.files("program");
    let whole = files.iter().map(|path| fs::read(path).unwrap()).collect::<Vec<_>>();
    fs::write(&files[0], &whole[0][..whole[0].len() / 2]).unwrap();
    let app = &mut place.open(&GPU, &options);
    wait_for_channel(app, 0);
    app.wait_until_told("is damaged and removed");
    app.wait_until_told(READY_STEEP);
    wait_until("the program, kept again", || place.files("program").len() == 3);
    assert!(files[0].metadata().unwrap().len() > whole[0].len() as u64 / 2);
}

#[test]
fn without_a_folder_or_without_being_allowed_nothing_is_kept_and_the_show_goes_on() {
    let place = Place::new();
    let folder = place.desktop.folder().join(".cache/mariana");
    fs::create_dir_all(folder.parent().unwrap()).unwrap();
    fs::write(&folder, "in the way").unwrap();
    let mut app = place.open(&[], &[]);
    wait_for_channel(&app, 0);
    app.wait_until_told("no programs are kept in ");
    assert_eq!(count(&quit(app), "no programs are kept in "), 1);
    fs::remove_file(&folder).unwrap();
    let app = place.open(&[], &["--program-cache", "off"]);
    wait_for_channel(&app, 0);
    quit(app);
    // Others keep things there, too: the song's structure, once it has been found.
    assert!(!place.kept().exists());
}

#[test]
fn an_interpreter_that_the_driver_refuses_is_not_tried_again_and_a_smaller_one_draws() {
    let place = Place::new();
    let sentence = "this driver has no interpreter for all scenes: each scene gets its own";
    let refused = [&GPU[..], &[("MARIANA_FAULT", "no-interpreter@0")]].concat();
    let mut app = place.open(&refused, &[]);
    app.wait_until_told(sentence);
    app.wait_until_told("an interpreter is ready");
    app.press(&["c"]);
    app.wait_for_title("interpreted", |title| title.contains("interpreted"));
    wait_for_channel(&app, 0);
    quit(app);
    let [mark] = &place.files("given-up")[..] else { panic!("{:?}", place.files("given-up")) };

    let mut app = place.open(&GPU, &[]);
    app.wait_until_told(&format!("delete {} to have it tried", mark.display()));
    wait_for_channel(&app, 0);
    let told = quit(app);
    assert!(told.contains(sentence) && !told.contains(READY), "{told}");

    fs::remove_file(mark).unwrap();
    let mut app = place.open(&GPU, &[]);
    app.wait_until_told(READY);
    quit(app);
}

/// Runs the program until a driver that compiles an interpreter takes it along.
fn die(place: &Place, options: &[&str]) {
    let mut command: Command = place.desktop.command(PROGRAM);
    command
        .envs(GPU)
        .env("MARIANA_FAULT", "deadly-interpreter@0")
        .arg(&place.song)
        .args(place.arguments(options));
    let status = command.stdout(Stdio::null()).stderr(Stdio::null()).status().unwrap();
    assert_eq!(status.signal(), Some(6), "{status}");
}

#[test]
fn a_driver_that_takes_the_process_along_is_not_asked_for_that_again() {
    let place = Place::new();
    die(&place, &[]);
    assert!(!place.files("attempt").is_empty());
    let mut app = place.open(&GPU, &[]);
    app.wait_until_told("Mariana ended while the driver compiled it before");
    wait_for_channel(&app, 0);
    app.wait_until_told("an interpreter is ready");
    quit(app);
    assert_eq!((place.files("attempt").len(), place.files("given-up").len()), (0, 1));
    // A later start tries it once more, and dies again. Then it is the scene's own that kills it: it is compiled.
    die(&place, &[]);
    place.save(1, "p.z - 5");
    for kept in place.files("program") {
        fs::remove_file(kept).unwrap();
    }
    let options = ["--sdf", "interpreted"];
    die(&place, &options);
    let mut app = place.open(&GPU, &options);
    app.wait_until_told("Mariana ended twice while the driver compiled it");
    wait_for_channel(&app, 1);
    assert!(app.title().contains("compiled"), "{}", app.title());
    quit(app);
}

#[test]
fn a_driver_that_compiles_for_long_is_told_once_and_the_show_goes_on() {
    let place = Place::new();
    let app = place.open(&[("MARIANA_FAULT", "slow-compiler@0")], &["--sdf", "compiled"]);
    wait_for_channel(&app, 0);
    let told = quit(app);
    let [words, rest] = ["the driver is still compiling", " own: nothing can be shown before"];
    assert_eq!((count(&told, words), count(&told, &format!("{words}{rest}"))), (1, 1), "{told}");
}

#[test]
fn a_scene_goes_on_while_another_program_takes_long() {
    let place = Place::new();
    let mut app = place.open(&[("MARIANA_FAULT", "slow-interpreter@0")], &["--sdf", "compiled"]);
    wait_for_channel(&app, 0);
    app.press(&["c"]);
    app.wait_until_told("the driver is still compiling an interpreter: the show goes on without it");
    app.wait_for_title("interpreted", |title| title.contains("interpreted"));
    wait_for_channel(&app, 0);
    quit(app);
}
