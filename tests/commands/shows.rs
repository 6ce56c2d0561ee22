//! Shows: writing them, rendering them, and mistakes in them.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::program::Workplace;
use mariana::srgb::linear;

const LOOK: [&str; 2] = ["--size", "48x27"];

/// Writes a scene with a ball above a floor, a parameter for the ball's size, and a second, nearer camera.
fn write_ball(place: &Workplace, name: &str, colour: &str, energy: &str) {
    let text = format!(
        "about {{ energy = {energy} }}\nparam size = 1 in 0.2 .. 2\n\
         material paint {{ color = {colour}  emission = 0.3 * {colour} }}\n\
         object ball {{ shape = sphere(p - vec3(0, 1, 0), size)  material = paint }}\n\
         object floor {{ shape = p.y }}\n\
         camera {{ position = vec3(0, 2, -6)  target = vec3(0, 1, 0) }}\n\
         camera near {{ position = vec3(1, 1.5, -3)  target = vec3(0, 1, 0) }}\n"
    );
    place.write(name, text);
}

fn place_with_balls() -> Workplace {
    let place = Workplace::new();
    write_ball(&place, "red.scene", "vec3(0.9, 0.05, 0.05)", "0 .. 0.5");
    write_ball(&place, "green.scene", "vec3(0.05, 0.8, 0.1)", "0.3 .. 0.8");
    write_ball(&place, "blue.scene", "vec3(0.05, 0.1, 0.9)", "0.7 .. 1");
    place
}

fn still(place: &Workplace, arguments: &[&str]) -> Vec<u8> {
    place.run(&[&["still"], arguments, &LOOK[..], &["-o", "still.png"]].concat()).done();
    place.read("still.png")
}

#[test]
fn a_video_of_a_show_equals_its_stills() {
    let place = place_with_balls();
    place.write(
        "my.show",
        "at start red.scene\nat 2 s green.scene camera near melt over 2 s\n  set size = 0.5 -> 1.5 over 4 s\n\
         at 6 s blue.scene fade over 2 s\nat 9 s red.scene portal over 2 s\nat 11.5 s red.scene camera near cut\n",
    );
    let video = ["video", "--show", "my.show", "--duration", "13", "--fps", "2", "--flash-limiter", "off"];
    place.run(&[&video[..], &LOOK[..], &["-o", "out/"]].concat()).done();
    let frame = |time: f64| place.read(&format!("out/frame-{:05}.png", (2.0 * time) as usize));
    let at = |time: f64| still(&place, &["--show", "my.show", "--at", &time.to_string()]);
    // These times are in a melt, a fade, a portal and a cut, and between them.
    for time in [0.0, 2.0, 3.0, 3.5, 5.0, 6.5, 9.5, 10.5, 12.0] {
        assert!(frame(time) == at(time), "the moment {time}");
    }
    // A transition begins with the frame of the old scene and ends with the frame of the new one.
    let alone = |scene: &str, time: &str, set: &[&str]| {
        still(&place, &[&["--scene", scene, "--at", time], set].concat())
    };
    assert!(frame(2.0) == alone("red.scene", "2", &[]));
    assert!(frame(8.0) == alone("blue.scene", "8", &[]));
    assert!(frame(9.0) == alone("blue.scene", "9", &[]));
    // In between, the frame equals neither scene's frame, and a parameter moves.
    assert!(frame(3.0) != alone("red.scene", "3", &[]) && frame(3.0) != alone("green.scene", "3", &[]));
    let (moved, at_rest) = (frame(5.5), frame(6.0));
    assert!(moved != at_rest && frame(11.5) != alone("red.scene", "11.5", &[]), "another camera is used");
}

#[test]
fn a_show_dims_and_freezes_frames_of_any_scene() {
    let place = place_with_balls();
    place.write(
        "dark.show",
        "at start red.scene\n  set size = 0.5 -> 1.5 over 8 s\n  set picture freeze = 1 after 1 s\n  set picture freeze = 1 -> 0 over 2 s after 4 s\n\
         at 3 s green.scene cut\nat 8 s blue.scene fade over 2 s\n\
         \x20 set picture brightness = 1 -> 0 over 2 s after 3 s\nat 14 s green.scene cut\n\
         \x20 set picture brightness = 1\n",
    );
    let video = |span: &[&str], to: &str| {
        let ways = ["video", "--show", "dark.show", "--fps", "2", "--flash-limiter", "off", "-o", to];
        place.run(&[&ways[..], span, &LOOK[..]].concat()).done();
    };
    video(&["--duration", "15"], "out/");
    let frame = |time: f64| place.read(&format!("out/frame-{:05}.png", (2.0 * time) as usize));
    let at = |time: f64| still(&place, &["--show", "dark.show", "--at", &time.to_string()]);
    for time in [0.5, 1.0, 2.5, 3.5, 4.5, 5.5, 6.0, 9.0, 11.5, 12.0, 13.5, 14.0] {
        assert!(frame(time) == at(time), "the moment {time}");
    }
    let alone = |scene: &str, time: &str| still(&place, &["--scene", scene, "--at", time]);
    // The frozen frame stays when another scene starts. Then it fades to the current scene.
    let held = frame(1.0);
    assert!(frame(0.5) != held && [1.0, 2.5, 3.5].iter().all(|time| frame(*time) == held));
    assert!(frame(5.0) != held && frame(5.0) != alone("green.scene", "5"));
    assert!(frame(6.5) == alone("green.scene", "6.5"));
    video(&["--start", "2.5", "--duration", "1"], "late/");
    assert!(place.read("late/frame-00000.png") == held, "a video may begin during a freeze");
    // Halfway, half of the light remains. Later the frame stays black until the show sets the brightness again.
    let light = |picture: Vec<u8>| {
        let picture = image::load_from_memory(&picture).unwrap().to_rgb8();
        let sum =
            |pixel: &image::Rgb<u8>| pixel.0.iter().map(|byte| linear(f32::from(*byte) / 255.0)).sum::<f32>();
        picture.pixels().map(sum).sum::<f32>()
    };
    let fraction = light(frame(12.0)) / light(alone("blue.scene", "12"));
    assert!((fraction - 0.5).abs() < 0.02, "{fraction} of the light is left");
    assert_eq!(light(frame(13.5)), 0.0);
    assert!(frame(14.0) == alone("green.scene", "14"));
}

#[test]
fn the_directors_show_can_be_written_and_rendered_again() {
    let place = place_with_balls();
    let scenes = ["--scene", "red.scene", "--scene", "green.scene", "--scene", "blue.scene"];
    // The scene changes at both drops of the demo track and at its last section.
    place.run(&[&["show", "-o", "demo.show"], &scenes[..]].concat()).done();
    let text = String::from_utf8(place.read("demo.show")).unwrap();
    assert!(text.starts_with("# A show for") && text.matches("\nat ").count() > 3, "{text}");
    let again = place.run(&[&["show"], &scenes[..]].concat()).done();
    assert_eq!(again, text, "the same song has the same show");
    let video = |show: &[&str], to: &str| {
        let span = ["--start", "22", "--duration", "8", "--fps", "1", "-o", to];
        place.run(&[&["video"], show, &span, &LOOK[..]].concat()).done();
        (0..8).map(|number| place.read(&format!("{to}frame-{number:05}.png"))).collect::<Vec<_>>()
    };
    let directed = video(&[&["--show", "auto"], &scenes[..]].concat(), "auto/");
    assert!(directed == video(&["--show", "demo.show"], "file/"));
    assert!(directed.iter().any(|frame| *frame != directed[0]));
}

#[test]
fn a_show_without_a_matching_cue_is_refused() {
    let place = place_with_balls();
    place.write_tone("one.wav", 440.0, 2.0, [0.5, 0.5]);
    place.write("foreign.show", "at section Q 2 red.scene\nat drop 7 green.scene\n");
    let reported =
        ["no entry of the show fits this song", "`at start`", "foreign.show:1:1", "foreign.show:2:1"];
    let show = ["one.wav", "--show", "foreign.show"];
    for (job, output) in [("still", "a.png"), ("video", "a.mp4"), ("video", "out/")] {
        place.run(&[&[job], &show[..], &["-o", output]].concat()).refused_with_details(&reported);
        assert!(!place.path(output).exists(), "{output}");
    }
    // All cues of this show wait for keys, so the show cannot be rendered.
    place.write("cues.show", "at cue red.scene\nat cue green.scene\n");
    let outcome = place.run(&["video", "one.wav", "--show", "cues.show", "-o", "a.mp4"]);
    assert!(outcome.code == 1 && outcome.stderr.contains("only a window has"), "{outcome:?}");
    assert!(!place.path("a.mp4").exists());
    // The folder's only scene is broken, so the director cannot choose any.
    place.write("bad.scene", "lngth(p)");
    let outcome = place.run(&["video", "one.wav", "--show", "auto", "--scene", "bad.scene", "-o", "a.mp4"]);
    assert!(outcome.code == 1 && outcome.stderr.contains("no scene to show"), "{outcome:?}");
    assert!(!place.path("a.mp4").exists());
}

#[test]
fn all_mistakes_of_a_show_are_reported_with_their_lines() {
    let place = place_with_balls();
    place.write("bad.scene", "lngth(p)");
    place.write(
        "bad.show",
        "at start gren.scene\nat 1 s red.scene camera far\n  set siz = 3\nat 2 s red.scene mlet\n  set its_own = 1\n  -> 2 over 1 s\n\
         at 3 s bad.scene\n",
    );
    let reported = place.run(&["still", "--show", "bad.show", "-o", "a.png"]).refused_with_details(&[
        "bad.show:1:10",
        "gren.scene",
        "bad.show:2:25",
        "the scene's cameras are near",
        "bad.show:3:7",
        "the scene's parameters are size",
        "bad.show:4:18",
        "did you mean `melt`?",
        "bad.show:7:8",
        "bad.scene:1:1",
    ]);
    assert_eq!(reported.matches("error: ").count(), 6, "{reported}");
}

#[test]
fn mistakes_of_a_show_are_reported_with_their_positions() {
    let place = place_with_balls();
    let refused = |text: &str, parts: &[&str]| {
        place.write("bad.show", text);
        place.run(&["still", "--show", "bad.show", "-o", "a.png"]).refused_with_details(parts);
        assert!(!place.path("a.png").exists());
    };
    refused("at start red.scene\nat 3 s gren.scene\n", &["gren.scene"]);
    refused("at start red.scene mlet over 2 bars\n", &["bad.show:1:20", "did you mean `melt`?"]);
    refused("at start red.scene\n set siz = 3\n", &["`siz`", "the scene's parameters are size"]);
    refused(
        "at start red.scene\n set picture brightness = 7\n",
        &["bad.show:2:", "7 is not between 0 and 1"],
    );
    refused("at start red.scene camera far\n", &["`far`", "the scene's cameras are near"]);
    place.run(&["video", "--show", "none.show", "-o", "a.mp4"]).refused(&["none.show"]);
    // A cue that the song does not have is reported. The other cues are rendered.
    place.write("some.show", "at start red.scene\nat section Q green.scene\nat 0 s blue.scene cut\n");
    let outcome = place.run(&["still", "--show", "some.show", "-o", "a.png"]);
    assert!(outcome.code == 0 && outcome.stderr.contains("the song has no section Q"), "{outcome:?}");
    let sentence = "mariana: warning: parts of the show do not fit the song\nwarning: the song";
    assert!(outcome.stderr.starts_with(sentence), "it looked like a log with an error: {outcome:?}");
    place.write_tone("silence.wav", 440.0, 3.0, [0.0; 2]);
    place.run(&["show", "silence.wav", "--scene", "red.scene", "-o", "silence.show"]).done();
    let text = String::from_utf8(place.read("silence.show")).unwrap();
    assert!(text.contains("silence") && text.contains("at start"), "{text}");
}
