//! Tests the output of the subcommands and the files that they write. `cli_bad_input` tests refusals.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use crate::support::program::{FORMATS, Outcome, Workplace};
use crate::support::shader_folder::changed_shaders;
use image::GenericImageView;
use mariana_music::{BAND_COUNT, band_edge};
use mariana_testing::process::{Process, output_of, wait_until};
use serde_json::Value;

#[test]
fn a_still_has_its_size_and_is_reproducible() {
    let place = Workplace::new();
    let still = |at: &str, output: &str| {
        place.run(&["still", "--at", at, "--size", "96x54", "-o", output]).done();
        place.read(output)
    };
    let first = still("12.5", "first.png");
    assert_eq!(image::load_from_memory(&first).unwrap().dimensions(), (96, 54));
    assert!(first == still("12.5", "again.png"), "two runs differ");
    assert!(first != still("40", "first.png"), "two times of the song gave the same image");
    assert_eq!(place.names(), ["again.png", "first.png"]);
}

#[test]
fn stills_have_any_shape_within_the_limits() {
    let place = Workplace::new();
    for (width, height) in [(1, 1), (16_384, 1), (1, 16_384), (63, 35)] {
        place.run(&["still", "--at", "20", "--size", &format!("{width}x{height}"), "-o", "frame.png"]).done();
        assert_eq!(image::load_from_memory(&place.read("frame.png")).unwrap().dimensions(), (width, height));
    }
}

#[test]
fn a_still_shows_the_song() {
    let place = Workplace::new();
    place.write_tone("quiet.wav", 200.0, 1.0, [0.0, 0.0]);
    place.write_tone("loud.wav", 200.0, 1.0, [0.8, 0.8]);
    let still = |song: &str| {
        place.run(&["still", song, "--at", "0.5", "--size", "96x54", "-o", "frame.png"]).done();
        place.read("frame.png")
    };
    assert!(still("quiet.wav") != still("loud.wav"), "silence and a loud tone gave the same image");
}

fn analyze(place: &Workplace, arguments: &[&str]) -> Vec<Value> {
    let text = place.run(&[&["analyze", "--json"], arguments].concat()).done();
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}")))
        .collect()
}

fn numbers(value: &Value) -> Vec<f64> {
    let array = value.as_array().unwrap_or_else(|| panic!("{value} is not an array"));
    array.iter().map(|number| number.as_f64().unwrap_or_else(|| panic!("{number} is not a number"))).collect()
}

fn band_of(hz: f64) -> usize {
    (0..BAND_COUNT).find(|&band| (band_edge(band)..band_edge(band + 1)).contains(&hz)).unwrap()
}

fn tallest_band(line: &Value) -> usize {
    let bands = numbers(&line["bands"]);
    (0..bands.len()).max_by(|&a, &b| bands[a].total_cmp(&bands[b])).unwrap()
}

#[test]
fn analysis_reports_time_volume_and_bands_of_every_frame() {
    let place = Workplace::new();
    let peak = 0.6;
    place.write_tone("left.wav", 1000.0, 2.0, [peak, 0.0]);

    assert_eq!(analyze(&place, &["left.wav"]).len(), 120, "the default is 60 lines per second");

    let lines = analyze(&place, &["left.wav", "--fps", "25", "--start", "0.6", "--duration", "0.8"]);
    assert_eq!(lines.len(), 20);
    // Equation 1 of the thesis, for a sine.
    let mean_magnitude = peak * std::f64::consts::FRAC_2_PI;
    for (index, line) in lines.iter().enumerate() {
        let time = line["t"].as_f64().unwrap();
        assert!((time - (0.6 + index as f64 / 25.0)).abs() < 1e-9, "line {index} is at {time} s");
        let volume = numbers(&line["volume"]);
        assert_eq!(volume.len(), 2);
        assert!((volume[0] - mean_magnitude).abs() < 0.02 * mean_magnitude, "left: {volume:?}");
        assert!(volume[1].abs() < 1e-6, "right: {volume:?}");
        let bands = numbers(&line["bands"]);
        assert_eq!(bands.len(), 32);
        assert!(bands.iter().all(|band| (0.0..=1.0).contains(band)), "{bands:?}");
        assert_eq!(tallest_band(line), band_of(1000.0), "{bands:?}");
    }
}

#[test]
fn every_format_has_the_right_pitch_and_length() {
    let place = Workplace::new();
    place.write_tone("tone.wav", 1000.0, 1.5, [0.5, 0.25]);
    for format in FORMATS {
        place.ffmpeg(&[&["-i", "tone.wav"], format.arguments].concat(), format.file);
        let lines = analyze(&place, &[format.file, "--fps", "20"]);
        // Some containers round the duration up to whole packets.
        assert!((30..=32).contains(&lines.len()), "{}: {} lines", format.file, lines.len());
        assert_eq!(tallest_band(&lines[15]), band_of(1000.0), "{}", format.file);
        let volume = numbers(&lines[15]["volume"]);
        assert!((volume[0] / volume[1] - 2.0).abs() < 0.1, "{}: {volume:?}", format.file);
    }
}

#[test]
fn analysis_as_text_has_a_line_for_each_frame() {
    let text = Workplace::new().run(&["analyze", "--fps", "10", "--start", "30", "--duration", "2"]).done();
    assert_eq!(text.lines().count(), 20);
    assert!(text.lines().all(|line| line.contains("left") && line.contains("right")), "{text}");
    assert!(text.starts_with("   30.000 s"), "{text}");
}

#[test]
fn a_closed_output_pipe_is_no_error() {
    let place = Workplace::new();
    for arguments in [
        &["analyze", "--json"][..],
        &["devices"],
        &["bench", "--sdf", "compiled", "--frames", "1", "--size", "16x9"],
        &["video", "--duration", "0.1", "--fps", "10", "--size", "16x9", "-o", "stills/"],
        &["--gl-info"],
        &["--help"],
    ] {
        let mut command = place.command(arguments);
        let mut process = Process::start(command.stdout(Stdio::piped()).stderr(Stdio::piped()), "mariana");
        let mut first = String::new();
        let mut reader = BufReader::new(process.stdout());
        if arguments[0] == "analyze" {
            reader.read_line(&mut first).unwrap();
            assert!(first.starts_with('{'), "{first}");
        }
        drop(reader);
        wait_until("its end", || process.ended().is_some());
        let stderr = std::io::read_to_string(process.child().stderr.take().unwrap()).unwrap();
        assert!(process.ended().unwrap().success() && stderr.is_empty(), "{arguments:?}: {stderr}");
    }
}

#[test]
fn bench_reports_times_and_evaluations() {
    let place = Workplace::new();
    let arguments = ["bench", "--sdf", "compiled", "--frames", "3", "--size", "64x36"];
    let report: Value =
        serde_json::from_str(&place.run(&[&arguments[..], &["--json"]].concat()).done()).unwrap();
    assert_eq!(report["frames"], 3);
    assert_eq!(report["scene"], "speakers.scene");
    assert_eq!(numbers(&report["size"]), [64.0, 36.0]);
    let clauses = |name: &str| report["clauses"][name].as_u64().unwrap();
    assert!(clauses("distance") > 50 && clauses("total") > clauses("distance") + clauses("materials"));
    let modes = report["modes"].as_array().unwrap();
    assert_eq!(modes.len(), 2, "one row with regions and one without: {report}");
    let row = &modes[0];
    assert_eq!((&row["mode"], &row["regions"]), (&"compiled".into(), &true.into()));
    assert_eq!((&modes[1]["mode"], &modes[1]["regions"]), (&"compiled".into(), &false.into()));
    for name in ["build_ms", "next_build_ms"] {
        assert!(row[name].as_f64().unwrap() > 0.0, "{name}: {report}");
    }
    assert!(
        row["tree"]["cells"].as_u64().unwrap() > 4_000 && row["tree"]["tapes"].as_u64().unwrap() > 10,
        "{report}"
    );
    assert_eq!(modes[1]["tree"]["cells"], 0, "{report}");
    for name in [
        "shader_ms",
        "first_draw_ms",
        "wall_p50_ms",
        "wall_p99_ms",
        "cpu_p50_ms",
        "evaluations_per_pixel_total",
    ] {
        assert!(row[name].as_f64().unwrap() > 0.0, "{name} in {report}");
    }
    assert!(row["wall_p99_ms"].as_f64() >= row["wall_p50_ms"].as_f64(), "{report}");
    assert_eq!(row["gpu_p50_ms"].is_null(), report["gl"]["software"] == true, "{report}");
    let evaluations = &row["evaluations_per_pixel"];
    let kinds = ["primary", "normal", "shadow", "occlusion", "reflection"];
    let per_kind: Vec<f64> = kinds.iter().map(|kind| evaluations[kind].as_f64().unwrap()).collect();
    assert!(per_kind.iter().all(|&count| count > 0.0), "{report}");
    assert_eq!(evaluations["clauses"], 0.0, "compiled scenes have no clauses to run: {report}");
    let total = row["evaluations_per_pixel_total"].as_f64().unwrap();
    assert!((per_kind.iter().sum::<f64>() - total).abs() < 1e-9 * total, "{report}");

    let text = place.run(&arguments).done();
    for part in kinds.iter().chain(&["p50", "p99", "CPU", "GPU", "64x36", "compiled", "speakers"]) {
        assert!(text.contains(part), "'{part}' in {text}");
    }
}

fn assert_measured(value: &Value, name: &str) {
    match value {
        Value::Object(fields) => fields.iter().for_each(|(name, value)| assert_measured(value, name)),
        Value::Array(values) => values.iter().for_each(|value| assert_measured(value, name)),
        Value::Number(number) => {
            assert!(number.as_f64().is_some_and(|number| number >= 0.0), "{name}: {number}")
        }
        // `null` also represents numbers that are not finite.
        Value::Null => assert!(["error", "gpu_p50_ms", "edges"].contains(&name), "{name} is missing"),
        Value::Bool(_) | Value::String(_) => {}
    }
}

#[test]
fn bench_measures_all_scenes_and_continues_after_a_failure() {
    let place = Workplace::new();
    let arguments =
        ["bench", "--all", "--only", "first_st", "--only", "quadric", "--frames", "1", "--size", "32x18"];
    let run = |more: &[&str]| {
        let outcome = place.run(&[&arguments[..], more].concat());
        assert_eq!(outcome.code, 0, "{outcome:?}");
        assert_eq!(outcome.stderr, "mariana: first_steps, 1 of 2\nmariana: quadric, 2 of 2\n");
        outcome.stdout
    };
    let report: Value = serde_json::from_str(&run(&["--json"])).unwrap();
    let scenes = report["scenes"].as_array().unwrap();
    let names: Vec<&Value> = scenes.iter().map(|scene| &scene["scene"]).collect();
    assert_eq!(names, ["first_steps", "quadric"]);
    assert_eq!(report["gl"], scenes[0]["report"]["gl"]);
    for scene in scenes {
        let rows: Vec<(&str, bool)> = scene["report"]["modes"]
            .as_array()
            .unwrap()
            .iter()
            .map(|row| (row["mode"].as_str().unwrap(), row["regions"].as_bool().unwrap()))
            .collect();
        let [interpreted, compiled] = ["interpreted", "compiled"];
        assert_eq!(rows, [(interpreted, true), (interpreted, false), (compiled, true), (compiled, false)]);
    }
    assert_measured(&report, "the report");

    let (folder, _) = changed_shaders(&[]);
    let scene = folder.path().join("scene.frag");
    let text = std::fs::read_to_string(&scene).unwrap();
    std::fs::write(&scene, format!("{text}\nfloat oops = ;\n")).unwrap();
    let shaders = ["--shaders", folder.path().to_str().unwrap()];
    let text = run(&shaders);
    for name in ["first_steps", "quadric"] {
        assert!(text.lines().any(|line| line.starts_with(name) && line.contains("scene.frag")), "{text}");
    }
}

#[test]
fn bench_measures_both_modes_of_any_formula() {
    let place = Workplace::new();
    let arguments =
        ["bench", "--scene", "min(y, length(p - vec3(0, 1, 0)) - 1)", "--frames", "1", "--size", "64x36"];
    let report: Value =
        serde_json::from_str(&place.run(&[&arguments[..], &["--json"]].concat()).done()).unwrap();
    assert_eq!(report["scene"], "formula");
    let modes = report["modes"].as_array().unwrap();
    let names: Vec<&str> = modes.iter().map(|row| row["mode"].as_str().unwrap()).collect();
    assert_eq!(names, ["interpreted", "interpreted", "compiled", "compiled"]);
    let [interpreted, compiled] = [1, 3].map(|row| modes[row]["evaluations_per_pixel"].clone());
    let count = |row: &Value, name: &str| row[name].as_f64().unwrap();
    assert!(count(&interpreted, "clauses") > count(&interpreted, "primary"), "{report}");
    for kind in ["primary", "normal", "shadow", "occlusion"] {
        let (a, b) = (count(&interpreted, kind), count(&compiled, kind));
        assert!(b > 0.0 && (a - b).abs() <= 0.02 * b, "{kind}: {report}");
    }
    let text = place.run(&arguments).done();
    for part in ["interpreted", "compiled", "formula", "clauses of distances per pixel"] {
        assert!(text.contains(part), "'{part}' in {text}");
    }
}

#[test]
fn devices_are_listed_where_there_is_no_sound_server() {
    let place = Workplace::new();
    assert!(!place.run(&["devices"]).done().trim().is_empty(), "the output is empty");
    let report: Value = serde_json::from_str(&place.run(&["devices", "--json"]).done()).unwrap();
    for host in report["hosts"].as_array().unwrap() {
        assert!(
            host["name"].is_string() && host["inputs"].is_array() && host["outputs"].is_array(),
            "{report}"
        );
    }
}

#[test]
fn help_is_complete_and_its_examples_use_existing_flags() {
    let place = Workplace::new();
    let subcommands =
        ["still", "video", "analyze", "bench", "check", "format", "lsp", "eval", "scenes", "devices"];
    let main_help = place.run(&["--help"]).done();
    let help_of =
        |name: &str| if name.is_empty() { main_help.clone() } else { place.run(&[name, "--help"]).done() };
    for name in subcommands {
        assert!(main_help.lines().any(|line| line.trim_start().starts_with(name)), "{name} in {main_help}");
    }
    for flag in [
        "--once",
        "--latency",
        "--quality",
        "--flash-limiter",
        "--scene",
        "--sdf",
        "--shaders",
        "--gl-info",
        "--device",
        "--version",
    ] {
        assert!(main_help.contains(flag), "{flag} in {main_help}");
    }
    for page in [&[""][..], &subcommands].concat() {
        let help = help_of(page);
        let (_, examples) = help.split_once("Examples:").unwrap_or_else(|| panic!("no examples: {help}"));
        let examples: Vec<&str> =
            examples.lines().filter_map(|line| line.trim_start().strip_prefix("mariana")).collect();
        assert!(examples.len() >= 2 || page == "lsp", "{help}");
        for example in examples {
            let words: Vec<&str> = example.split_whitespace().collect();
            let subcommand = words.first().filter(|word| subcommands.contains(word)).copied().unwrap_or("");
            let help = help_of(subcommand);
            let options = help.split("Examples:").next().unwrap();
            for flag in words.iter().filter(|word| word.starts_with('-')) {
                assert!(options.contains(flag), "mariana{example}: there is no {flag}");
            }
        }
    }
}

#[test]
fn the_version_is_the_crate_version() {
    assert_eq!(
        Workplace::new().run(&["--version"]).done(),
        format!("mariana {}\n", env!("CARGO_PKG_VERSION"))
    );
}

#[test]
fn gl_info_needs_no_display() {
    let text = Workplace::new().run(&["--gl-info"]).done();
    for part in ["renderer", "version", "shading language"] {
        assert!(text.contains(part), "'{part}' in {text}");
    }
}

#[test]
fn a_variable_chooses_opengl_es() {
    let place = Workplace::new();
    let with = |value| {
        let mut command = place.command(&["--gl-info"]);
        Outcome::of(command.env("MARIANA_GL", value))
    };
    let text = with("es").done();
    assert!(text.contains("interface            OpenGL ES\n"), "{text}");
    with("vulkan").refused(&["MARIANA_GL", "'vulkan'"]);
}

#[test]
fn a_video_has_its_size_rate_length_and_the_song() {
    let place = Workplace::new();
    // ffmpeg must not read this name as a protocol.
    place.write_tone("take:one.wav", 440.0, 3.0, [0.5, 0.5]);
    let arguments = ["--start", "1", "--duration", "1", "--fps", "10", "--size", "64x36", "-o", "song.mp4"];
    let text = place.run(&[&["video", "take:one.wav"], &arguments[..]].concat()).done();
    assert!(text.contains("10 frames") && text.contains("song.mp4"), "{text}");
    assert_eq!(place.names(), ["song.mp4", "take:one.wav"]);

    let mut probe = Command::new("ffprobe");
    probe.args(["-v", "error", "-of", "json", "-show_streams", "-count_frames"]).arg(place.path("song.mp4"));
    let output = output_of(&mut probe, "ffmpeg").unwrap_or_else(|error| panic!("{error}"));
    let report: Value = serde_json::from_slice(&output).unwrap();
    let streams = report["streams"].as_array().unwrap();
    let stream = |kind: &str| {
        streams
            .iter()
            .find(|stream| stream["codec_type"] == kind)
            .unwrap_or_else(|| panic!("no {kind}: {report}"))
    };
    let seconds = |kind: &str| stream(kind)["duration"].as_str().unwrap().parse::<f64>().unwrap();
    let video = stream("video");
    assert_eq!((&video["width"], &video["height"]), (&64.into(), &36.into()), "{video}");
    assert_eq!((&video["r_frame_rate"], &video["nb_read_frames"]), (&"10/1".into(), &"10".into()), "{video}");
    assert!((seconds("video") - 1.0).abs() < 0.05, "{video}");
    assert!((seconds("audio") - 1.0).abs() < 0.1, "{}", stream("audio"));
}

#[test]
fn a_stills_format_follows_its_extension() {
    let place = Workplace::new();
    place.write_tone("one.wav", 440.0, 2.0, [0.5, 0.5]);
    let look = ["--size", "32x18", "--at", "0:01.5"];
    for output in ["a.png", "a.jpg", "b.JPEG", "plain"] {
        place.run(&[&["still", "one.wav", "-o", output], &look[..]].concat()).done();
    }
    let read = |name: &str| std::fs::read(place.path(name)).unwrap();
    let drawn =
        image::load_from_memory_with_format(&read("a.png"), image::ImageFormat::Png).unwrap().to_rgb8();
    assert_eq!(read("plain"), read("a.png"));
    for name in ["a.jpg", "b.JPEG"] {
        let seen =
            image::load_from_memory_with_format(&read(name), image::ImageFormat::Jpeg).unwrap().to_rgb8();
        let worst =
            drawn.iter().zip(seen.iter()).map(|(drawn, seen)| u32::from(drawn.abs_diff(*seen))).sum::<u32>();
        assert!(worst < 6 * drawn.len() as u32, "{name}: {worst}");
    }
    let refused = place.run(&[&["still", "one.wav", "-o", "a.gif"], &look[..]].concat());
    assert!(refused.stderr.contains(".png or .jpg") && !place.path("a.gif").exists(), "{}", refused.stderr);
}

#[test]
fn a_video_declares_its_colour_space() {
    let place = Workplace::new();
    place.write_tone("one.wav", 440.0, 1.0, [0.5, 0.5]);
    place.write(
        "flat.scene",
        "material paint { color = 0  roughness = 1  emission = vec3(0.8, 0.05, 0.045) }\n\
         object wall { shape = 5 - p.z  material = paint }\nsky { color = 0  ambient = 0 }\n\
         light none { direction = vec3(0, -1, 0)  color = 0 }\n\
         camera { position = vec3(0)  target = vec3(0, 0, 5) }\n",
    );
    let look = ["--scene", "flat.scene", "--tone-map", "none", "--size", "32x18"];
    place.run(&[&["still", "one.wav", "-o", "flat.png"], &look[..]].concat()).done();
    let length = ["--duration", "0.3", "--fps", "10", "-o", "flat.mkv"];
    place.run(&[&["video", "one.wav"], &length[..], &look].concat()).done();

    let mut probe = Command::new("ffprobe");
    probe
        .args(["-v", "error", "-of", "json", "-show_streams", "-select_streams", "v"])
        .arg(place.path("flat.mkv"));
    let report: Value = serde_json::from_slice(&output_of(&mut probe, "ffmpeg").unwrap()).unwrap();
    for (what, value) in [
        ("color_space", "bt709"),
        ("color_primaries", "bt709"),
        ("color_transfer", "bt709"),
        ("color_range", "tv"),
    ] {
        assert_eq!(report["streams"][0][what], value, "{what}");
    }
    // Decode the frame with the declared colour space.
    place.ffmpeg(&["-i", "flat.mkv", "-frames:v", "1"], "seen.png");
    let [drawn, seen] = ["flat.png", "seen.png"]
        .map(|name| *image::open(place.path(name)).unwrap().to_rgb8().get_pixel(16, 9));
    for (drawn, seen) in drawn.0.into_iter().zip(seen.0) {
        assert!(drawn.abs_diff(seen) <= 3, "{drawn:?} is decoded as {seen:?}");
    }
}

#[test]
fn a_video_into_a_folder_is_numbered_stills() {
    let place = Workplace::new();
    let arguments = ["--start", "20", "--duration", "0.3", "--fps", "10", "--size", "64x36"];
    place.run(&[&["video", "-o", "new/stills/"], &arguments[..]].concat()).done();
    place.run(&["still", "--at", "20", "--size", "64x36", "-o", "still.png"]).done();
    let frames: Vec<Vec<u8>> =
        (0..3).map(|index| place.read(&format!("new/stills/frame-{index:05}.png"))).collect();
    assert_eq!(std::fs::read_dir(place.path("new/stills")).unwrap().count(), 3);
    assert!(frames[0] == place.read("still.png"), "the first frame differs from the still of its time");
    assert!(frames[0] != frames[2], "nothing moves");
}
