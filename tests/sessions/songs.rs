//! The structure of whole songs in a session.

#![cfg(target_os = "linux")]

use std::fs;
use std::path::{Path, PathBuf};

use crate::support::apart::apart;
use crate::support::desktop::{PROGRAM, command_in};
use crate::support::session::Place;
use mariana_testing::process::output_of;
use mariana_testing::wave::write_wav;

const SIZE: &str = "64x36";
/// Samples a second.
const RATE: usize = 8_000;

const SCENE: &str = "material paint { color = 0 roughness = 1 emission = vec3(2 * progress, energy, bar) }\n\
                     object wall { shape = 5 - p.z material = paint }\n\
                     light none { direction = vec3(0, -1, 0) color = 0 }\n\
                     camera { position = vec3(0) target = vec3(0, 0, 5) }\n\
                     sky { color = 0 ambient = 0 }\n";

/// Writes a song that is louder in its second half.
fn write_song(path: &Path, seconds: usize, per_second: usize) {
    let samples = (0..seconds * RATE).flat_map(|frame| {
        let since = frame % (RATE / per_second);
        let loudness = if frame < seconds * RATE / 2 { 0.1 } else { 0.6 };
        let sample = if since < RATE / 120 { loudness * (0.4 * since as f32).sin() } else { 0.0 };
        [sample; 2]
    });
    write_wav(path, RATE as u32, 2, samples);
}

#[test]
fn a_session_knows_the_structure_of_this_song_and_of_the_next() {
    apart!();
    let place = Place::new();
    let music = place.path("music");
    fs::create_dir(&music).unwrap();
    write_song(&music.join("1.wav"), 40, 2);
    write_song(&music.join("2.wav"), 20, 3);
    let scene = place.save("own.scene", SCENE);
    let still = place.path("still.png");
    // The still has a separate cache folder, so that the session finds no cached structure.
    let mut command = command_in(PROGRAM, place.folder(), None);
    command.arg("still").arg(music.join("1.wav")).arg(&scene).arg("-o").arg(&still);
    output_of(command.args(["--at", "10", "--size", SIZE]), "mariana").unwrap();
    let wanted = image::open(&still).unwrap().to_rgba8().get_pixel(32, 18).0;
    assert!(wanted[0] > 50 && wanted[1] > 50, "{wanted:?} does not depend on the song");
    let kept = place.path("cache");
    assert_eq!(
        files_that_end_in(&kept, "song"),
        Vec::<PathBuf>::new(),
        "the session would load the cached \
        structure"
    );

    let app = place.open(&music, &["--size", SIZE, "--scene", scene.to_str().unwrap()]);
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.starts_with("1.wav") && title.contains("paused"));
    app.wait_until("the structures of both songs", |_| files_that_end_in(&kept, "song").len() == 2);
    app.press(&["Left"; 8]);
    app.press(&["Right", "Right"]);
    app.wait_for("the values at this time", |picture| {
        let seen = picture.get_pixel(32, 18).0;
        seen.iter().zip(wanted).all(|(seen, wanted)| seen.abs_diff(wanted) <= 1)
    });
    let reported = app.quit_by_key();
    assert!(!reported.contains("panicked"), "{reported}");
}

fn files_that_end_in(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    entries
        .flat_map(|path| if path.is_dir() { files_that_end_in(&path, ending) } else { vec![path] })
        .filter(|path| path.extension().is_some_and(|found| found == ending))
        .collect()
}
