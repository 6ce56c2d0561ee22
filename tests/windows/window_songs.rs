//! What the window knows of whole songs.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::Path;

use crate::support::desktop::{Desktop, PROGRAM, command_in};
use mariana_testing::process::{output_of, wait_until};
use mariana_testing::wave::write_wav;

const SIZE: &str = "64x36";

/// A wall that shines in numbers of the song.
const SCENE: &str = "material paint { color = 0 roughness = 1 emission = vec3(2 * progress, energy, bar) }\n\
                     object wall { shape = 5 - p.z material = paint }\n\
                     light none { direction = vec3(0, -1, 0) color = 0 }\n\
                     camera { position = vec3(0) target = vec3(0, 0, 5) }\n\
                     sky { color = 0 ambient = 0 }\n";

/// Clicks, the second half of them loud.
fn write_song(path: &Path, seconds: usize, per_second: usize) {
    let samples = (0..seconds * 48_000).flat_map(|frame| {
        let since = frame % (48_000 / per_second);
        let loudness = if frame < seconds * 24_000 { 0.1 } else { 0.6 };
        let sample = if since < 400 { loudness * (0.4 * since as f32).sin() } else { 0.0 };
        [sample; 2]
    });
    write_wav(path, 48_000, 2, samples);
}

#[test]
fn a_window_knows_of_a_song_what_a_still_does_and_the_next_song_before_it_plays() {
    let desktop = Desktop::start();
    let music = desktop.folder().join("music");
    fs::create_dir(&music).unwrap();
    write_song(&music.join("1.wav"), 40, 2);
    write_song(&music.join("2.wav"), 20, 3);
    let scene = desktop.folder().join("own.scene");
    fs::write(&scene, SCENE).unwrap();
    let still = desktop.folder().join("still.png");
    let mut command = command_in(PROGRAM, desktop.folder(), None);
    command.arg("still").arg(music.join("1.wav")).arg(&scene).arg("-o").arg(&still);
    output_of(command.args(["--at", "10", "--size", SIZE]), "mariana").unwrap();
    let wanted = image::open(&still).unwrap().to_rgba8().get_pixel(32, 18).0;
    assert!(wanted[0] > 50 && wanted[1] > 50, "{wanted:?} tells nothing of the song");
    // What the still found out is not there any more.
    let mut kept = Vec::new();
    wait_until("what is known of the song", || {
        kept = files_that_end_in(desktop.folder(), "song");
        !kept.is_empty()
    });
    kept.iter().for_each(|file| fs::remove_file(file).unwrap());

    let show = ["--silent", "-v", "--size", SIZE, "--scene", scene.to_str().unwrap()];
    let mut app = desktop.open(&music, &show);
    app.wait_until_told("1.wav is known");
    app.wait_until_told("2.wav is known");
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.starts_with("1.wav") && title.contains("paused"));
    // The start, and 10 s from there.
    app.press(&["Left"; 8]);
    app.press(&["Right", "Right"]);
    wait_until("the numbers of the moment", || {
        let seen = app.picture().get_pixel(32, 18).0;
        seen.iter().zip(wanted).all(|(seen, wanted)| seen.abs_diff(wanted) <= 1)
    });
    app.press(&["q"]);
    let (status, told) = app.wait_for_end(std::time::Duration::from_secs(60));
    assert!(status.success() && !told.contains("panicked"), "{status}: {told}");
    assert_eq!(files_that_end_in(desktop.folder(), "song").len(), 2);
}

/// The files below a folder with this ending.
fn files_that_end_in(folder: &Path, ending: &str) -> Vec<std::path::PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    entries
        .flat_map(|path| if path.is_dir() { files_that_end_in(&path, ending) } else { vec![path] })
        .filter(|path| path.extension().is_some_and(|found| found == ending))
        .collect()
}
