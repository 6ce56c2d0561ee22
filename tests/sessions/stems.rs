//! The parts of a song in a session.

#![cfg(target_os = "linux")]

use std::fs;
use std::path::Path;

use crate::support::apart::apart;
use crate::support::desktop::{PROGRAM, command_in};
use crate::support::session::Place;
use mariana_testing::process::output_of;
use mariana_testing::wave::write_wav;

const SIZE: &str = "64x36";
/// Samples a second.
const RATE: usize = 8_000;

const SCENE: &str = "material paint { color = 0 roughness = 1\n\
                     emission = vec3(2 * drums.volume.x, vocals.band(13.5 + 0.1 * p.x), 0.2 * volume.x) }\n\
                     object wall { shape = 5 - p.z material = paint }\n\
                     light none { direction = vec3(0, -1, 0) color = 0 }\n\
                     camera { position = vec3(0) target = vec3(0, 0, 5) }\n\
                     sky { color = 0 ambient = 0 }\n";

/// Writes silence and then a tone.
fn write_tone(path: &Path, silent: usize, seconds: usize) {
    let samples = (0..seconds * RATE).flat_map(|frame| {
        let sample = if frame < silent * RATE { 0.0 } else { 0.5 * (0.3456 * frame as f32).sin() };
        [sample; 2]
    });
    write_wav(path, RATE as u32, 2, samples);
}

#[test]
fn a_session_shows_the_parts_that_a_still_shows_and_reports_broken_stems() {
    apart!();
    let place = Place::new();
    let song = place.path("song.wav");
    let stems = song.with_extension("stems");
    fs::create_dir(&stems).unwrap();
    write_tone(&song, 0, 20);
    write_tone(&stems.join("drums.wav"), 8, 20);
    write_tone(&stems.join("vocals.wav"), 0, 20);
    fs::write(stems.join("other.wav"), "this is no sound").unwrap();
    let scene = place.save("own.scene", SCENE);
    let still = place.path("still.png");
    // The still has a separate cache folder, so that the session reads the stems.
    let mut command = command_in(PROGRAM, place.folder(), None);
    command.arg("still").arg(&song).arg(&scene).arg("-o").arg(&still);
    output_of(command.args(["--at", "10", "--size", SIZE]), "mariana").unwrap();
    let wanted = image::open(&still).unwrap().to_rgba8().get_pixel(32, 18).0;
    assert!(wanted[0] > 100 && wanted[1] > 100, "{wanted:?} does not depend on the parts");

    let app = place.open(&song, &["--size", SIZE, "--scene", scene.to_str().unwrap()]);
    app.pause_at_start();
    app.press(&["Right"]);
    // The tone map spreads colours, so the red of silent drums is not 0.
    app.wait_for("the silence of the drums", |picture| {
        let seen = picture.get_pixel(32, 18).0;
        seen[0] + 30 < wanted[0] && seen[1] > 100
    });
    app.press(&["Right"]);
    app.wait_for("the parts at this time", |picture| {
        let seen = picture.get_pixel(32, 18).0;
        seen.iter().zip(wanted).all(|(seen, wanted)| seen.abs_diff(wanted) <= 1)
    });
    // The parts of the song's beginning are shown before the stems are read to their end.
    app.wait_until_reported("the part other stays silent: other.wav");
    let reported = app.quit_by_key();
    assert!(!reported.contains("panicked"), "{reported}");
    assert_eq!(reported.matches("the part other stays silent: other.wav").count(), 1, "{reported}");
}
