//! Videos rendered in parts, projections with their metadata, and motion blur, on the command line.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::support::program::Workplace;
use mariana_testing::process::{WAIT_LIMIT, output_of};
use serde_json::Value;

const PARTS: [&str; 8] = ["--fps", "10", "--size", "32x18", "--duration", "1", "--flash-limiter", "off"];

/// A ball that moves with time and sound.
fn write_mover(place: &Workplace) {
    place.write_tone("one.wav", 440.0, 2.0, [0.5, 0.5]);
    place.write(
        "mover.scene",
        "material paint { color = 0  roughness = 1  emission = vec3(0.3 + volume.x, 0.6, t) }\n\
         object ball { shape = sphere(p - vec3(2 * t - 1, 0, 0), 1)  material = paint }\n\
         light none { direction = vec3(0, -1, 0)  color = 0 }\n\
         camera { position = vec3(0, 0, -4)  target = vec3(0) }\n",
    );
}

fn probe(place: &Workplace, name: &str) -> Value {
    let mut probe = Command::new("ffprobe");
    probe.args(["-v", "error", "-of", "json", "-show_streams", "-count_frames"]);
    let output = output_of(probe.arg(place.path(name)), "ffmpeg").unwrap_or_else(|error| panic!("{error}"));
    serde_json::from_slice(&output).unwrap()
}

/// The hashes of a video's decoded frames, with their times.
fn frames_of(place: &Workplace, name: &str) -> String {
    let mut decode = Command::new("ffmpeg");
    decode.args(["-v", "error", "-i"]).arg(place.path(name));
    decode.args(["-map", "0:v:0", "-f", "framemd5", "-"]);
    String::from_utf8(output_of(&mut decode, "ffmpeg").unwrap()).unwrap()
}

#[test]
fn two_processes_of_gnu_parallel_render_the_frames_of_one() {
    let place = Workplace::new();
    write_mover(&place);
    let video = |output: &str, flags: &[&str]| {
        let arguments =
            [&["video", "one.wav", "mover.scene", "-q", "-o", output], &PARTS[..], flags].concat();
        place.command(&arguments)
    };
    let in_parallel = |output: &str, flags: &[&str]| {
        let video = video(output, flags);
        let mut parallel = Command::new("parallel");
        parallel.args(["--will-cite", "-j", "2"]).arg(video.get_program()).args(video.get_args());
        parallel.args(["--part", "{}/2", ":::", "1", "2"]);
        parallel.envs(video.get_envs().filter_map(|(name, value)| Some((name, value?))));
        parallel.current_dir(video.get_current_dir().unwrap());
        output_of(&mut parallel, "parallel").unwrap_or_else(|error| panic!("{error}"));
    };
    // Lossless videos. The frames of 8 bits fit the format with 10 bits.
    in_parallel("part-{}.mkv", &["--alpha"]);
    output_of(&mut video("whole.mkv", &["--alpha"]), "mariana").unwrap();
    place.run(&["video", "one.wav", "-o", "joined.mkv", "--join", "part-2.mkv", "part-1.mkv"]).done();
    let (whole, joined) = (frames_of(&place, "whole.mkv"), frames_of(&place, "joined.mkv"));
    assert_eq!(whole.lines().filter(|line| line.starts_with("0,")).count(), 10, "{whole}");
    assert_eq!(whole, joined);
    assert!(!place.names().iter().any(|name| name.contains("pieces")), "{:?}", place.names());

    // Numbered images need no joining.
    in_parallel("parts/", &[]);
    output_of(&mut video("whole/", &[]), "mariana").unwrap();
    for frame in 0..10 {
        let name = format!("frame-{frame:05}.png");
        assert_eq!(place.read(&format!("whole/{name}")), place.read(&format!("parts/{name}")), "{name}");
    }

    // The usual format: encoded frames differ slightly, but not their number and times, nor the sound.
    in_parallel("part-{}.mp4", &[]);
    output_of(&mut video("whole.mp4", &[]), "mariana").unwrap();
    place.run(&["video", "one.wav", "-o", "joined.mp4", "--join", "part-1.mp4", "part-2.mp4"]).done();
    let times = |name: &str| {
        let column = |line: &str| line.split(',').nth(2).map(str::to_owned);
        frames_of(&place, name).lines().filter(|line| line.starts_with("0,")).map(column).collect::<Vec<_>>()
    };
    assert_eq!(times("whole.mp4"), times("joined.mp4"));
    let sound = |name: &str| {
        let report = probe(&place, name);
        let streams = report["streams"].as_array().unwrap();
        let sounds = streams.iter().filter(|stream| stream["codec_type"] == "audio");
        sounds.map(|stream| stream["duration"].clone()).collect::<Vec<_>>()
    };
    assert_eq!(sound("whole.mp4"), sound("joined.mp4"));
    assert_eq!(sound("joined.mp4").len(), 1);
}

#[test]
fn parts_that_do_not_belong_together_are_refused() {
    let place = Workplace::new();
    write_mover(&place);
    let video = |output: &str, flags: &[&str]| {
        place.run(&[&["video", "one.wav", "mover.scene", "-o", output], &PARTS[..], flags].concat())
    };
    video("a1.mp4", &["--part", "1/2"]).done();
    video("a2.mp4", &["--part", "2/2"]).done();
    video("b2.mp4", &["--part", "2/2", "--set", "volume.x=0"]).done();
    let paths = |samples| ["--light", "path", "--samples", samples];
    video("p1.mp4", &[&["--part", "1/2"][..], &paths("1")].concat()).done();
    video("p2.mp4", &[&["--part", "2/2"][..], &paths("2")].concat()).done();
    let faster =
        ["--part", "2/2", "--fps", "20", "--duration", "1", "--flash-limiter", "off", "--size", "32x18"];
    place.run(&[&["video", "one.wav", "mover.scene", "-o", "c2.mp4"], &faster[..]].concat()).done();
    place.write_tone("other.wav", 220.0, 2.0, [0.5, 0.5]);
    let join = |song: &str, output: &str, parts: &[&str]| {
        place.run(&[&["video", song, "-o", output, "--join"], parts].concat())
    };
    join("one.wav", "j.mp4", &["a1.mp4"]).refused(&["part 2 of 2 is missing", "--part 2/2"]);
    join("one.wav", "j.mp4", &["a1.mp4", "a1.mp4", "a2.mp4"]).refused(&["two files are part 1"]);
    join("one.wav", "j.mp4", &["a1.mp4", "b2.mp4"]).refused(&["b2.mp4", "other settings", "a1.mp4"]);
    join("one.wav", "j.mp4", &["a1.mp4", "p2.mp4"]).refused(&["p2.mp4", "other settings", "a1.mp4"]);
    join("one.wav", "j.mp4", &["p1.mp4", "p2.mp4"]).refused(&["p2.mp4", "other settings", "p1.mp4"]);
    join("one.wav", "j.mp4", &["a1.mp4", "c2.mp4"]).refused(&["c2.mp4", "another frame rate"]);
    join("one.wav", "j.mp4", &["a1.mp4", "one.wav"]).refused(&["one.wav is no finished part"]);
    join("one.wav", "j.mp4", &["a1.mp4", "none.mp4"]).refused(&["none.mp4 cannot be read", "check the name"]);
    join("other.wav", "j.mp4", &["a1.mp4", "a2.mp4"]).refused(&["another song"]);
    join("one.wav", "j.gif", &["a1.mp4", "a2.mp4"]).refused(&["j.gif", ".mp4"]);
    join("one.wav", "a2.mp4", &["a1.mp4", "a2.mp4"]).refused(&["a2.mp4 is one of the parts", "-o"]);
    assert!(!place.names().iter().any(|name| name.starts_with("j.")), "{:?}", place.names());
    join("one.wav", "j.mp4", &["a2.mp4", "a1.mp4"]).done();

    video("p.gif", &["--part", "1/2"]).refused(&["cannot be rendered in parts", "folder"]);
    video("p.mp4", &["--part", "1/20"]).refused(&["only 10 frames", "fewer parts"]);
    place
        .run(&["video", "one.wav", "mover.scene", "-o", "p.mp4", "--part", "1/2"])
        .refused(&["flash limiter", "--flash-limiter off"]);
    video("p.mp4", &["--part", "3/2"]).refused_arguments("--part", &["1 to 2"]);
    video("p.mp4", &["--part", "x"]).refused_arguments("--part", &["3/8"]);
}

#[test]
fn an_interrupted_part_continues_after_its_last_piece() {
    let place = Workplace::new();
    write_mover(&place);
    let arguments = [
        "video",
        "one.wav",
        "mover.scene",
        "-o",
        "p.mp4",
        "--part",
        "1/1",
        "--fps",
        "400",
        "--size",
        "16x10",
        "--duration",
        "1.6",
        "--flash-limiter",
        "off",
        "--controlled",
    ];
    let start = || {
        let mut command = place.command(&arguments);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap()
    };
    let mut interrupted = start();
    let piece = place.path("p.mp4.pieces/00000000.mp4");
    let begun = Instant::now();
    while !piece.exists() && begun.elapsed() < WAIT_LIMIT {
        std::thread::sleep(Duration::from_millis(1));
    }
    interrupted.kill().unwrap();
    interrupted.wait().unwrap();
    assert!(piece.exists() && !place.path("p.mp4").exists());
    let mut again = start();
    let input = again.stdin.take();
    let output = again.wait_with_output().unwrap();
    drop(input);
    let reports = String::from_utf8(output.stdout).unwrap();
    let first: Value = serde_json::from_str(reports.lines().next().unwrap()).unwrap();
    assert!(first["drawn"]["done"].as_u64().unwrap() > 300, "{first}");
    assert_eq!(probe(&place, "p.mp4")["streams"][0]["nb_read_frames"], "640");
    // A finished part is not rendered again.
    let mut finished = start();
    let input = finished.stdin.take();
    let reports = String::from_utf8(finished.wait_with_output().unwrap().stdout).unwrap();
    drop(input);
    assert!(!reports.contains("drawn") && reports.contains("p.mp4"), "{reports}");
}

/// A frame by paths may take minutes.
#[test]
fn an_interrupted_part_by_paths_loses_at_most_thirty_frames() {
    let place = Workplace::new();
    write_mover(&place);
    let part = ["video", "one.wav", "mover.scene", "-o", "p.mp4", "--part", "1/1", "--flash-limiter", "off"];
    let look = ["--fps", "400", "--size", "16x10", "--duration", "1.6", "--light", "path", "--samples", "1"];
    let mut command = place.command(&[&part[..], &look].concat());
    let mut interrupted = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let piece = "p.mp4.pieces/00000000.mp4";
    let begun = Instant::now();
    while !place.path(piece).exists() && begun.elapsed() < WAIT_LIMIT {
        std::thread::sleep(Duration::from_millis(1));
    }
    interrupted.kill().unwrap();
    interrupted.wait().unwrap();
    assert_eq!(probe(&place, piece)["streams"][0]["nb_read_frames"], "30");
}

#[test]
fn players_are_told_the_projection() {
    let place = Workplace::new();
    write_mover(&place);
    let video = |output: &str, flags: &[&str]| {
        let look = ["--fps", "10", "--duration", "0.2", "-o", output];
        place.run(&[&["video", "one.wav", "mover.scene"], &look[..], flags].concat()).done();
        let report = probe(&place, output);
        assert_eq!(report["streams"].as_array().unwrap().len(), 2, "{output}");
        report["streams"][0]["side_data_list"].to_string()
    };
    for output in ["s.mp4", "s.mov", "s.mkv", "s.webm"] {
        let marks = video(output, &["--projection", "360", "--stereo", "over-under", "--size", "32x32"]);
        assert!(
            marks.contains("\"equirectangular\"") && marks.contains("top and bottom"),
            "{output}: {marks}"
        );
    }
    let marks = video("v.mp4", &["--projection", "vr180", "--stereo", "side-by-side", "--size", "32x16"]);
    assert!(marks.contains("tiled equirectangular") && marks.contains("side by side"), "{marks}");
    let marks = video("d.mp4", &["--projection", "dome", "--size", "32x32"]);
    assert!(!marks.contains("projection"), "{marks}");

    for (file, start) in [("s.png", &b"\x89PNG"[..]), ("s.jpg", b"\xff\xd8"), ("s.webp", b"RIFF")] {
        let look = ["--projection", "360", "--size", "32x16", "-o", file];
        place.run(&[&["still", "mover.scene"], &look[..]].concat()).done();
        let bytes = place.read(file);
        let text = String::from_utf8_lossy(&bytes);
        assert!(bytes.starts_with(start) && text.contains("GPano:FullPanoWidthPixels=\"32\""), "{file}");
        let picture = image::load_from_memory(&bytes).unwrap();
        assert_eq!((picture.width(), picture.height()), (32, 16), "{file}");
        place.ffmpeg(&["-i", file, "-frames:v", "1"], "decoded.png");
    }
    place
        .run(&["still", "mover.scene", "--projection", "dome", "--ray", "3,3", "-o", "r.png"])
        .refused_arguments("--projection", &["--ray"]);
    place
        .run(&["still", "mover.scene", "--projection", "globe", "-o", "r.png"])
        .refused_arguments("--projection", &["globe"]);
}

#[test]
fn motion_blur_is_the_mean_of_the_light_and_leaves_still_scenes_as_they_are() {
    let place = Workplace::new();
    place.write(
        "switch.scene",
        "material paint { color = 0  roughness = 1  emission = max(sign(t - 1), 0) }\n\
         object wall { shape = 5 - p.z  material = paint }\nsky { color = 0  ambient = 0 }\n\
         light none { direction = vec3(0, -1, 0)  color = 0 }\n\
         camera { position = vec3(0)  target = vec3(0, 0, 5) }\n\
         picture { tone_map = none  bloom = 0  grain = 0 }\n",
    );
    let still = |scene: &str, output: &str, flags: &[&str]| {
        let look = ["--at", "1", "--size", "32x18", "-o", output];
        place.run(&[&["still", "--scene", scene], &look[..], flags].concat()).done();
        place.read(output)
    };
    let blurred = still("switch.scene", "blurred.png", &["--shutter", "180"]);
    let picture = image::load_from_memory(&blurred).unwrap().to_rgb8();
    let [red, ..] = picture.get_pixel(16, 9).0;
    assert!((187..=189).contains(&red), "{red} is not half of the light");
    for scene in ["length(p) - 1", "orb"] {
        let plain = still(scene, "plain.png", &[]);
        let blurred = still(scene, "blurred.png", &["--shutter", "360", "--shutter-frames", "3"]);
        assert_eq!(plain == blurred, scene != "orb", "{scene}");
    }
    place
        .run(&["still", "switch.scene", "--shutter", "400", "-o", "r.png"])
        .refused_arguments("--shutter", &["0 to 360"]);
    place
        .run(&["still", "switch.scene", "--shutter", "180", "--view", "steps", "-o", "r.png"])
        .refused_arguments("--shutter", &["--view"]);
}
