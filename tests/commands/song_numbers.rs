//! Values of the whole song in scenes: they are equal in stills, videos and text output, and neutral if unknown.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::program::Workplace;
use serde_json::Value;

pub(crate) const LOOK: [&str; 4] = ["--size", "32x18", "--tone-map", "none"];

/// Writes a scene whose pictures have this colour, an expression in linear light, everywhere.
pub(crate) fn write_wall(place: &Workplace, name: &str, colour: &str) {
    let text = format!(
        "material paint {{ color = 0  roughness = 1  emission = {colour} }}\n\
         object wall {{ shape = 5 - p.z  material = paint }}\nsky {{ color = 0  ambient = 0 }}\n\
         light none {{ direction = vec3(0, -1, 0)  color = 0 }}\n\
         camera {{ position = vec3(0)  target = vec3(0, 0, 5) }}\n"
    );
    place.write(name, text);
}

/// The colour in the middle of an image.
pub(crate) fn colour(place: &Workplace, name: &str) -> [u8; 3] {
    let picture = image::load_from_memory(&place.read(name)).unwrap().to_rgb8();
    picture.get_pixel(16, 9).0
}

fn srgb(light: f64) -> f64 {
    let encoded = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    255.0 * encoded
}

#[test]
fn stills_videos_and_text_have_the_same_song_values() {
    let place = Workplace::new();
    // The argument of `chroma` depends on the point, so the shader must compute the value at each point.
    write_wall(&place, "song.scene", "vec3(progress, build, chroma(7.5 + 0.02 * p.x))");
    let run = |arguments: &[&str]| place.run(&[arguments, &LOOK[..]].concat()).done();
    run(&["still", "song.scene", "--at", "20.5", "-o", "first.png"]);
    let kept = colour(&place, "first.png");
    // The analysis is cached now. The result must not change.
    run(&["still", "song.scene", "--at", "20.5", "-o", "again.png"]);
    assert_eq!(place.read("first.png"), place.read("again.png"));
    let video = ["--start", "20.4", "--duration", "0.2", "--fps", "10", "-o", "out/"];
    run(&[&["video", "song.scene"], &video[..]].concat());
    assert_eq!(colour(&place, "out/frame-00001.png"), kept);
    assert_ne!(colour(&place, "out/frame-00000.png"), kept, "the values do not change with time");
    let moment = ["--start", "20.5", "--duration", "0.01", "--json"];
    let text = place.run(&[&["analyze", "--song"], &moment[..]].concat()).done();
    let reported: Value = serde_json::from_str(text.lines().next().unwrap()).unwrap();
    let numbers =
        [&reported["progress"], &reported["build"], &reported["chroma"][7]].map(|it| it.as_f64().unwrap());
    assert!(
        numbers.iter().all(|number| (0.05..=1.0).contains(number)),
        "the values are not those of a \
        build: {numbers:?}"
    );
    for (shown, number) in kept.iter().zip(numbers) {
        assert!((f64::from(*shown) - srgb(number)).abs() <= 1.0, "{kept:?} shows {numbers:?}");
    }
    let without = place.run(&[&["analyze"], &moment[..]].concat()).done();
    assert!(!without.contains("progress") && text.contains("beat_in_bar"), "{without}");
}

#[test]
fn scenes_read_the_line_and_word_that_is_sung() {
    let place = Workplace::new();
    write_wall(&place, "song.scene", "vec3(line / 4, word / 4, line_phase)");
    place.write_tone("song.wav", 440.0, 5.0, [0.1; 2]);
    place.write("song.lrc", b"[00:00.50]one\n[00:01.00]one <00:02.00>two\n[00:03.00]");
    let still = |at: &str| {
        let still = ["still", "song.wav", "song.scene", "--at", at, "-o", "a.png"];
        place.run(&[&still[..], &LOOK[..]].concat()).done();
        colour(&place, "a.png")
    };
    for (at, values) in
        [("0.2", [0.0; 3]), ("1.5", [0.5, 0.25, 0.25]), ("2.5", [0.5, 0.5, 0.75]), ("3.5", [0.0; 3])]
    {
        let shown = still(at);
        for (shown, value) in shown.into_iter().zip(values) {
            assert!((f64::from(shown) - srgb(value)).abs() <= 1.0, "at {at}: {shown:?} shows {values:?}");
        }
    }
    place.write("other.lrc", b"[00:01.00]a\n[00:01.10]b\n[00:01.20]c");
    let video = ["--lyrics=other.lrc", "--start", "1.5", "--duration", "0.1", "--fps", "10", "-o", "other/"];
    place.run(&[&["video", "song.wav", "song.scene"], &video[..], &LOOK[..]].concat()).done();
    let [red, ..] = colour(&place, "other/frame-00000.png");
    assert!((f64::from(red) - srgb(0.75)).abs() <= 1.0, "the file of --lyrics is the source: {red}");
}

#[test]
fn a_song_without_structure_has_neutral_values() {
    let place = Workplace::new();
    write_wall(&place, "song.scene", "vec3(section + beat_in_bar + energy, 0.5, chroma(0) + key + drop)");
    place.write_tone("silence.wav", 440.0, 3.0, [0.0; 2]);
    let still = |song: &str, set: &[&str]| {
        let still = ["still", song, "song.scene", "--at", "1", "-o", "a.png"];
        place.run(&[&still[..], &LOOK[..], set].concat()).done();
        colour(&place, "a.png")
    };
    let [red, green, blue] = still("silence.wav", &[]);
    assert!(red == 0 && green > 150 && blue == 0);
    let [red, _, blue] = still("silence.wav", &["--set", "section=1", "--set", "chroma(0)=1"]);
    assert!(red > 250 && blue > 250);
    // A truncated file can still be played.
    place.write_tone("tone.wav", 440.0, 6.0, [0.5; 2]);
    let bytes = place.read("tone.wav");
    place.write("tone.wav", &bytes[..bytes.len() / 2]);
    assert!(still("tone.wav", &[])[0] > 0, "it sounds");
}
