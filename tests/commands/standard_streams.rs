//! Standard input, misspelt arguments, and output for editors and terminals.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used)]

use std::fs::File;
use std::process::Command;

use crate::support::program::{FORMATS, Outcome, Workplace};
use mariana_testing::process::output_of;
use serde_json::Value;

fn fed(place: &Workplace, file: &str, arguments: &[&str]) -> Outcome {
    let mut command = place.command(arguments);
    Outcome::of(command.stdin(File::open(place.path(file)).unwrap()))
}

#[test]
fn songs_of_every_format_are_read_from_standard_input() {
    let place = Workplace::new();
    place.write_tone("tone.wav", 1000.0, 1.0, [0.5, 0.25]);
    for format in FORMATS {
        place.ffmpeg(&[&["-i", "tone.wav"], format.arguments].concat(), format.file);
        let named = place.run(&["analyze", format.file, "--fps", "10"]).done();
        assert_eq!(
            fed(&place, format.file, &["analyze", "-", "--fps", "10"]).done(),
            named,
            "{}",
            format.file
        );
    }
    let scene = ["--scene", "length(p) - 1", "--size", "16x16", "--fps", "5", "-o", "v.mp4"];
    fed(&place, "song.mp3", &[&["video", "-"], &scene[..]].concat()).done();
    place.write("empty", "");
    place.write("text", "no music, but words".repeat(100));
    fed(&place, "empty", &["analyze", "-"]).refused(&["standard input is empty"]);
    fed(&place, "text", &["still", "-", "-o", "a.png"]).refused(&["standard input is not an audio file"]);
    fed(&place, "text", &["-"]).refused(&["standard input is not an audio file"]);
    fed(&place, "song.mp3", &["-", "song.mp3"]).refused(&["cannot be combined"]);
}

#[test]
fn points_are_read_from_standard_input() {
    let place = Workplace::new();
    place.write("points.csv", "0,2,0\n3,0,4\n");
    assert_eq!(fed(&place, "points.csv", &["eval", "length(p)", "--points", "-"]).done(), "2\n5\n");
    place.write("points.csv", "0,2,0\n3\n");
    let reported = fed(&place, "points.csv", &["eval", "length(p)", "--points", "-"]);
    assert!(reported.code == 1 && reported.stderr.contains("standard input:2"), "{reported:?}");
}

#[test]
fn scenes_are_read_from_standard_input() {
    let place = Workplace::new();
    place.write("ball.scene", "fn ball(p) { length(p) - 1 }");
    place.write("text", "include \"ball.scene\"\nobject o { shape = ball(p) + tiem }\n");
    let reported = fed(&place, "text", &["check", "--json", "-"]);
    let mistake: Value = serde_json::from_str(reported.stdout.trim()).unwrap();
    assert_eq!(
        (reported.code, &mistake["file"], &mistake["line"]),
        (1, &"-".into(), &2.into()),
        "{reported:?}"
    );
    place.write("text", "include \"ball.scene\"\nobject o { shape = ball(p) + t }\n");
    assert_eq!(fed(&place, "text", &["check", "--json", "-"]).done(), "");
    assert!(fed(&place, "text", &["check", "-"]).done().contains("listens to t"));
    assert_eq!(fed(&place, "text", &["eval", "-", "--at", "3,0,0", "--set", "t=0"]).done(), "2\n");
    fed(&place, "text", &["still", "--scene", "-", "--size", "16x16", "-o", "a.png"]).done();
    std::fs::write(place.path("text"), [b'x', 0xff]).unwrap();
    fed(&place, "text", &["check", "-"]).refused(&["standard input is not text", "byte 1"]);
}

#[test]
fn a_misspelt_command_gets_a_suggestion() {
    let place = Workplace::new();
    place.run(&["stil", "song.ogg", "--at", "3"]).refused_arguments("'stil'", &["did you mean 'still'"]);
    place.run(&["vidoe"]).refused_arguments("'vidoe'", &["did you mean 'video'"]);
    // If a file with that name exists, the argument is a song.
    place.write("stil", "no music, but words".repeat(100));
    place.run(&["stil"]).refused(&["stil is not an audio file"]);
}

#[test]
fn missing_songs_are_refused() {
    let place = Workplace::new();
    place.write_tone("one.wav", 440.0, 0.5, [0.5, 0.5]);
    place.run(&["none.ogg"]).refused(&["none.ogg does not exist"]);
    place.run(&["none.ogg", "nil.ogg"]).refused(&["do not exist", "none.ogg, nil.ogg"]);
    place.run(&["one.wav", "none.ogg"]).refused(&["none.ogg does not exist"]);
}

#[test]
fn scenes_and_songs_can_be_combined_as_arguments() {
    let place = Workplace::new();
    place.write("my.scene", "length(p) - 1");
    place.write("mine.scene", "length(p) - 2");
    place.write_tone("one.wav", 440.0, 0.5, [0.5, 0.5]);
    let size = ["--size", "32x18", "-o"];
    let still = |arguments: &[&str], output: &str| {
        place.run(&[&["still"], arguments, &size[..], &[output]].concat()).done();
        place.read(output)
    };
    let by_flag = still(&["one.wav", "--scene", "my.scene"], "a.png");
    assert!(still(&["one.wav", "my.scene"], "b.png") == by_flag);
    assert!(still(&["my.scene", "one.wav"], "c.png") == by_flag);
    assert!(still(&["one.wav"], "d.png") != by_flag);
    // The player also accepts these arguments, but cannot open a window here.
    place.run(&["my.scene"]).refused(&["window"]);
    place.run(&["one.wav", "my.scene"]).refused(&["window"]);
    let refused = |arguments: &[&str], parts: &[&str]| {
        place.run(&[&["still", "-o", "e.png"], arguments].concat()).refused(parts);
    };
    refused(&["my.scene", "mine.scene"], &["two scenes", "my.scene", "mine.scene"]);
    refused(&["my.scene", "--scene", "orb"], &["two scenes", "my.scene", "orb"]);
    refused(&["one.wav", "two.wav"], &["two songs", "one.wav", "two.wav"]);
    refused(&["none.scene"], &["none.scene cannot be read"]);
}

#[test]
fn check_prints_every_mistake_as_json() {
    let place = Workplace::new();
    let mistakes = "object a {\n  shape = smoth_union(sphere(p, 1), p.y, 0.2) + foo\n}\n";
    std::fs::create_dir(place.path("sub")).unwrap();
    place.write("sub/part.scene", mistakes);
    place.write("sub/whole.scene", "include \"part.scene\"\n");
    place.write("good.scene", "length(p) - 1");
    let run = |scenes: &[&str]| {
        let outcome = place.run(&[&["check", "--json"], scenes].concat());
        let lines = outcome.stdout.lines().map(|line| serde_json::from_str(line).unwrap());
        (lines.collect::<Vec<Value>>(), outcome.code)
    };
    assert_eq!(run(&["good.scene", "speakers"]), (vec![], 0));
    let (objects, code) = run(&["good.scene", "sub/whole.scene", "none.scene"]);
    assert_eq!((objects.len(), code), (3, 1), "{objects:?}");
    let [first, second, third] = &objects[..] else { unreachable!() };
    assert_eq!(first["file"], "sub/part.scene");
    assert_eq!((&first["line"], &first["column"]), (&2.into(), &11.into()));
    assert_eq!(first["end"], serde_json::json!({ "line": 2, "column": 22 }));
    assert_eq!(first["severity"], "error");
    assert!(first["message"].as_str().unwrap().contains("smoth_union"), "{first}");
    assert!(first["hint"].as_str().unwrap().contains("smooth_union"), "{first}");
    assert_eq!((&second["column"], &second["end"]["column"]), (&49.into(), &52.into()));
    assert_eq!((&third["file"], &third["line"]), (&"none.scene".into(), &1.into()));
}

#[test]
fn the_shipped_scenes_are_listed_with_descriptions() {
    let place = Workplace::new();
    let list = place.run(&["scenes"]).done();
    for name in mariana::scenes::shipped_names() {
        let mut lines = list.lines().skip_while(|line| *line != name);
        assert_eq!(lines.next(), Some(name.as_str()), "{list}");
        assert!(lines.next().is_some_and(|line| line.starts_with("  ") && line.len() > 10), "{name}: {list}");
    }
    assert!(place.run(&["--help"]).done().contains("mariana scenes"));
}

#[test]
fn no_color_applies_to_mistakes_on_a_terminal() {
    let place = Workplace::new();
    place.write("bad.scene", "foo + 1");
    for (set, colored) in [(None, true), (Some("1"), false), (Some(""), true)] {
        for job in ["check bad.scene", "still --scene bad.scene -o a.png", "eval bad.scene --at 0,0,0"] {
            let command = place.command(&[]);
            let mut terminal = Command::new("script");
            let words = format!("'{}' {job}; true", command.get_program().to_string_lossy());
            terminal.args(["-qec", &words, "/dev/null"]).current_dir(command.get_current_dir().unwrap());
            terminal.env_remove("NO_COLOR").env("TERM", "xterm").envs(set.map(|value| ("NO_COLOR", value)));
            let shown = String::from_utf8(output_of(&mut terminal, "bsdutils").unwrap()).unwrap();
            assert!(shown.contains("foo"), "{shown}");
            assert_eq!(shown.contains("\u{1b}["), colored, "{job}, {set:?}: {shown:?}");
        }
    }
}

#[test]
fn ranges_are_described_in_words() {
    let place = Workplace::new();
    place.run(&["--volume", "101"]).refused_arguments("--volume", &["0 to 100 percent"]);
    place.run(&["--volume", "many"]).refused_arguments("--volume", &["not a whole number"]);
    place.run(&["bench", "--frames", "0"]).refused_arguments("--frames", &["1 to 10000 frames"]);
}

#[test]
fn a_songs_structure_is_printed_as_text_json_and_svg() {
    let place = Workplace::new();
    let text = place.run(&["analyze", "--structure"]).done();
    assert!(text.contains("112.5 beats per minute in 4/4"), "{text}");
    let whole: Value =
        serde_json::from_str(&place.run(&["analyze", "--structure", "--json"]).done()).unwrap();
    assert!(
        whole["beats"].as_array().unwrap().len() > 150 && whole["sections"][0]["letter"] == "A",
        "{text}"
    );
    place.run(&["analyze", "--structure", "--plot", "song.svg"]).done();
    let page = String::from_utf8(place.read("song.svg")).unwrap();
    assert!(page.starts_with("<svg") || page.starts_with("<?xml"), "{page:.80}");
    place.write_tone("tone.wav", 440.0, 0.5, [0.5, 0.5]);
    let loudness = |song: &str| {
        let text = place.run(&["analyze", "--structure", song]).done();
        assert!(text.contains("no steady beat"), "{text}");
        let line = text.lines().find(|line| line.starts_with("integrated loudness ")).unwrap();
        line.split(' ').nth(2).unwrap().parse::<f64>().unwrap()
    };
    // One channel of mono was measured twice.
    place.ffmpeg(&["-i", "tone.wav", "-ac", "1"], "mono.wav");
    let [stereo, mono] = ["tone.wav", "mono.wav"].map(loudness);
    assert!((stereo - mono - 3.0).abs() < 0.11, "{stereo} and {mono} LUFS");
}
