//! A walk through the program with the keys alone, and the start where the last show ended, in a process whose driver is
//! slow.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::support::desktop::{App, Desktop};
use crate::walls::quit;
use mariana_testing::sound_server::SINK_RATE;
use mariana_testing::wave::write_wav;

/// A window in which every panel has its room.
const SIZE: &str = "640x360";
/// A scene that costs little.
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
