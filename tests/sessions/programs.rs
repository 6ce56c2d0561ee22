//! Shader programs: the universal interpreter, which is compiled before any edit, the program cache, and failing
//! drivers. Mesa's option `force_gl_renderer` lets its software renderer pass for a GPU.

#![cfg(target_os = "linux")]

use crate::support::apart::{apart, run_again};
use std::ffi::OsStr;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::PathBuf;

use crate::support::session::{self, App};
use crate::walls::wait_for_channel;
use mariana_testing::process::{WAIT_LIMIT, wait_until};

/// The line break tells this line of the log apart from the longer line for the non-Lipschitz variant.
const READY: &str = "the universal interpreter is ready\n";
const READY_NON_LIPSCHITZ: &str = "the universal interpreter is ready, for formulas";

struct Place {
    inner: session::Place,
    scene: PathBuf,
}

impl Place {
    fn new() -> Self {
        let place = Self::of(session::Place::with_song());
        place.save(0, "p.z - 5");
        place
    }

    fn of(inner: session::Place) -> Self {
        let scene = inner.path("own.scene");
        Self { inner, scene }
    }

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

    /// The session compiles on a separate thread.
    fn open(&self, options: &[&str]) -> App {
        let own = ["--size", "64x36", "--scene", self.scene.to_str().unwrap()];
        let app = self.inner.open_with_compiler(&self.inner.song(), &[&own[..], options].concat());
        app.wait_for_title("the scene", |title| title.contains("(own, "));
        app
    }

    fn kept(&self) -> PathBuf {
        self.inner.path("cache/programs")
    }

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
fn edits_use_the_interpreter_and_the_next_start_loads_it_from_the_cache() {
    apart!("EGL_PLATFORM" = "surfaceless", "force_gl_renderer" = "GPU", "MESA_DEBUG" = "silent");
    let place = Place::new();
    let options = ["--sdf", "interpreted"];
    let app = place.open(&options);
    wait_for_channel(&app, 0);
    app.wait_until_reported(READY);
    app.wait_until_reported(READY_NON_LIPSCHITZ);
    let before = app.reported();
    // The first wall uses operators that the first scene does not use. The second wall is non-Lipschitz.
    for (channel, wall) in [(1, "p.z - 5 - 0.1 * sin(3 * p.x) * cos(t)"), (2, "p.z * p.z * p.z - 99")] {
        place.save(channel, wall);
        wait_for_channel(&app, channel);
    }
    let reported = app.quit_content();
    let after = reported.strip_prefix(&before).unwrap();
    assert!(!after.contains("is requested"), "an edit waited for a compiler: {after}");
    // The third program is the first scene's interpreter. It was compiled before the universal interpreter.
    assert_eq!((place.files("program").len(), place.files("attempt").len()), (3, 0));

    place.save(0, "p.z - 5");
    let app = place.open(&options);
    wait_for_channel(&app, 0);
    app.wait_until_reported(READY_NON_LIPSCHITZ);
    let reported = app.quit_content();
    assert_eq!(
        (count(&reported, "loaded a stored program"), count(&reported, "compiled a program")),
        (3, 0),
        "{reported}"
    );

    let files = place.files("program");
    let whole = files.iter().map(|path| fs::read(path).unwrap()).collect::<Vec<_>>();
    fs::write(&files[0], &whole[0][..whole[0].len() / 2]).unwrap();
    let app = place.open(&options);
    wait_for_channel(&app, 0);
    app.wait_until_reported("was damaged and has been removed");
    app.wait_until_reported(READY_NON_LIPSCHITZ);
    app.wait_until("the program in the cache again", |_| place.files("program").len() == 3);
    assert!(files[0].metadata().unwrap().len() > whole[0].len() as u64 / 2);
}

#[test]
fn without_a_cache_folder_programs_are_not_stored() {
    apart!("EGL_PLATFORM" = "surfaceless");
    let place = Place::new();
    let folder = place.inner.path("cache");
    fs::write(&folder, "in the way").unwrap();
    let app = place.open(&[]);
    wait_for_channel(&app, 0);
    app.wait_until_reported("no programs are kept in ");
    assert_eq!(count(&app.quit_content(), "no programs are kept in "), 1);
    fs::remove_file(&folder).unwrap();
    let app = place.open(&["--program-cache", "off"]);
    wait_for_channel(&app, 0);
    app.quit_content();
    // The parent folder exists, because the song's structure is also cached in it.
    assert!(!place.kept().exists());
}

#[test]
fn a_rejected_interpreter_is_not_retried_and_a_smaller_one_draws() {
    apart!(
        "EGL_PLATFORM" = "surfaceless",
        "force_gl_renderer" = "GPU",
        "MESA_DEBUG" = "silent",
        "MARIANA_FAULT" = "no-interpreter@0"
    );
    let place = Place::new();
    let sentence = "this driver cannot compile the universal interpreter: each scene gets an interpreter";
    // The fault occurs once, in this first session.
    let app = place.open(&[]);
    app.wait_until_reported(sentence);
    app.wait_until_reported("an interpreter is ready");
    app.press(&["c"]);
    app.wait_for_title("interpreted", |title| title.contains("interpreted"));
    wait_for_channel(&app, 0);
    app.quit_content();
    let [mark] = &place.files("given-up")[..] else { panic!("{:?}", place.files("given-up")) };

    let app = place.open(&[]);
    app.wait_until_reported(&format!("to try it again, delete {}", mark.display()));
    wait_for_channel(&app, 0);
    let reported = app.quit_content();
    assert!(reported.contains(sentence) && !reported.contains(READY), "{reported}");

    fs::remove_file(mark).unwrap();
    let app = place.open(&[]);
    app.wait_until_reported(READY);
    app.quit_content();
}

/// Environment variables of a process that is going to crash: its folder, and its options separated by spaces.
const DYING: [&str; 2] = ["MARIANA_TEST_FOLDER", "MARIANA_TEST_OPTIONS"];

/// Runs a session in another process. Compiling an interpreter aborts that process.
fn die(place: &Place, options: &[&str]) {
    let options = options.join(" ");
    let [folder, given] = DYING;
    let status = run_again(&[
        ("MARIANA_FAULT", OsStr::new("deadly-interpreter@0")),
        (folder, place.inner.folder().as_os_str()),
        (given, OsStr::new(&options)),
    ]);
    assert_eq!(status.signal(), Some(6), "{status}");
}

/// In the process that [`die`] starts, runs the session and never returns. In other processes, returns at once.
fn die_if_asked() {
    let [Some(folder), Some(options)] = DYING.map(std::env::var_os) else { return };
    let place = Place::of(session::Place::at(folder.as_ref()));
    let options = options.into_string().unwrap();
    place.open(&options.split_whitespace().collect::<Vec<_>>()).run_for(WAIT_LIMIT);
    panic!("the process did not crash");
}

#[test]
fn a_program_that_crashed_the_driver_is_not_compiled_again() {
    apart!("EGL_PLATFORM" = "surfaceless", "force_gl_renderer" = "GPU", "MESA_DEBUG" = "silent");
    die_if_asked();
    let place = Place::new();
    die(&place, &[]);
    assert!(!place.files("attempt").is_empty());
    let app = place.open(&[]);
    app.wait_until_reported("Mariana crashed while the driver compiled it before");
    wait_for_channel(&app, 0);
    app.wait_until_reported("an interpreter is ready");
    app.quit_content();
    // The test's process lives on, so a compilation that the session has begun ends later.
    wait_until("the last compilation ends", || place.files("attempt").is_empty());
    assert_eq!(place.files("given-up").len(), 1);
    // A later session tries the universal interpreter once more and crashes again. Then the scene's own interpreter
    // crashes. The next session compiles the scene instead of interpreting it.
    die(&place, &[]);
    place.save(1, "p.z - 5");
    for kept in place.files("program") {
        fs::remove_file(kept).unwrap();
    }
    let options = ["--sdf", "interpreted"];
    die(&place, &options);
    let app = place.open(&options);
    app.wait_until_reported("Mariana crashed twice while the driver compiled it");
    wait_for_channel(&app, 1);
    assert!(app.title().contains("compiled"), "{}", app.title());
    app.quit_content();
}

#[test]
fn a_slow_compiler_is_reported_once() {
    apart!("EGL_PLATFORM" = "surfaceless", "MARIANA_FAULT" = "slow-compiler@0");
    let place = Place::new();
    let app = place.open(&["--sdf", "compiled"]);
    wait_for_channel(&app, 0);
    let reported = app.quit_content();
    let [words, rest] = ["the driver is still compiling", " own: the window stays empty until then"];
    let reported: Vec<&str> =
        reported.lines().filter(|line| line.contains(" WARN ") && line.contains(words)).collect();
    assert!(matches!(reported[..], [only] if only.ends_with(&format!("{words}{rest}"))), "{reported:?}");
}

#[test]
fn a_scene_keeps_moving_during_a_slow_compilation() {
    apart!("EGL_PLATFORM" = "surfaceless", "MARIANA_FAULT" = "slow-interpreter@0");
    let place = Place::new();
    let app = place.open(&["--sdf", "compiled"]);
    wait_for_channel(&app, 0);
    app.press(&["c"]);
    app.wait_until_reported(
        "the driver is still compiling an interpreter: the current scene stays until then",
    );
    app.wait_for_title("interpreted", |title| title.contains("interpreted"));
    wait_for_channel(&app, 0);
    app.quit_content();
}
