//! Input that the program refuses. Checks the message and the exit code, and that no refusal panics or damages files.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::ffi::OsStr;
use std::fs::{File, Permissions};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::os::unix::net::UnixListener;
use std::process::Command;

use crate::support::program::{FORMATS, Outcome, Workplace};
use crate::support::shader_folder::changed_shaders;
use mariana_testing::process::output_of;
use mariana_testing::wave::write_wav;
use serde_json::Value;

const SIZE: [&str; 2] = ["--size", "16x9"];

/// Pseudo-random numbers, the same in every run (SplitMix64).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }
}

#[test]
fn files_without_audio_are_refused_by_name() {
    let place = Workplace::new();
    std::fs::create_dir(place.path("empty-folder")).unwrap();
    std::fs::create_dir(place.path("music")).unwrap();
    place.write_tone("music/song.wav", 440.0, 0.1, [0.5, 0.5]);
    place.write("empty.flac", "");
    place.write("text.mp3", "Dear diary, today there was no music.\n".repeat(50));
    let mut numbers = Numbers(1);
    place.write("noise.bin", (0..50_000).map(|_| numbers.next() as u8).collect::<Vec<u8>>());
    place.write("noise.ogg", (0..50_000).map(|_| numbers.next() as u8).collect::<Vec<u8>>());
    for (song, what) in [
        ("missing.flac", "not exist"),
        ("empty-folder", "folder"),
        ("music", "folder"),
        ("empty.flac", "empty"),
        ("text.mp3", "not an audio file"),
        ("noise.bin", "not an audio file"),
        ("noise.ogg", ""),
    ] {
        place.run(&["analyze", song]).refused(&[song, what]);
        place.run(&[&["still", song, "-o", "frame.png"], &SIZE[..]].concat()).refused(&[song, what]);
        // Without a command, a folder of songs is a playlist, so it is not refused.
        if song != "music" {
            place.run(&[song]).refused(&[song, if song == "empty-folder" { "no tracks" } else { what }]);
        }
    }
    for arguments in [&["bench", "missing.flac"][..], &["video", "missing.flac", "-o", "song.mp4"]] {
        place.run(arguments).refused(&["missing.flac"]);
    }
    let kept = ["empty-folder", "empty.flac", "music", "noise.bin", "noise.ogg", "text.mp3"];
    assert_eq!(place.names(), kept, "a refused job left a file");
}

#[test]
fn streams_beyond_the_limits_are_refused_with_their_values() {
    let place = Workplace::new();
    let silence = || std::iter::repeat_n(0.0, 6400);
    write_wav(&place.path("standing.wav"), 0, 2, silence());
    write_wav(&place.path("choir.wav"), 48_000, 64, silence());
    write_wav(&place.path("nothing.wav"), 48_000, 2, std::iter::empty());
    place.run(&["analyze", "standing.wav"]).refused(&["standing.wav"]);
    place.run(&["analyze", "choir.wav"]).refused(&["choir.wav", "64", "32"]);
    place.run(&["analyze", "nothing.wav"]).refused(&["nothing.wav"]);
}

/// `analyze` may succeed on damaged bytes, or refuse them with a one-sentence message.
fn survive(place: &Workplace, name: &str, what: &str, bytes: &[u8]) {
    let name = format!("{what}-{name}");
    place.write(&name, bytes);
    let outcome = Outcome::of(&mut place.command(&["analyze", "--json", "--fps", "10", &name]));
    if outcome.code == 0 {
        let lines: Vec<Value> =
            outcome.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        assert!(lines.iter().all(|line| line["volume"][0].is_f64()), "{outcome:?}");
    } else {
        assert_eq!((outcome.code, outcome.stderr.lines().count()), (1, 1), "{outcome:?}");
        assert!(outcome.stderr.contains(&name), "{outcome:?}");
        outcome.assert_advises();
    }
    std::fs::remove_file(place.path(&name)).unwrap();
}

#[test]
fn damaged_files_of_every_format_are_handled() {
    let place = Workplace::new();
    place.write_tone("tone.wav", 1000.0, 1.0, [0.5, 0.25]);
    let mut numbers = Numbers(2);
    for format in FORMATS {
        place.ffmpeg(&[&["-i", "tone.wav"], format.arguments].concat(), format.file);
        let whole = place.read(format.file);
        for percent in [3, 50, 95] {
            let end = whole.len() * percent / 100;
            survive(&place, format.file, &format!("first-{percent}-percent"), &whole[..end]);
        }
        // Damage in the header reaches different code from damage in the audio data.
        for (index, (span, flips)) in
            [(64, 1), (64, 8), (400, 4), (whole.len(), 10), (whole.len(), 300)].into_iter().enumerate()
        {
            let mut bytes = whole.clone();
            for _ in 0..flips {
                let at = numbers.below(span.min(bytes.len()));
                bytes[at] ^= 1 << numbers.below(8);
            }
            survive(&place, format.file, &format!("flips-{index}"), &bytes);
        }
        survive(&place, format.file, "tail", &whole[whole.len() / 2..]);
    }
}

#[test]
fn without_opengl_the_message_says_what_to_install() {
    let place = Workplace::new();
    for arguments in [
        &["still", "-o", "frame.png"][..],
        &["video", "-o", "song.mp4"],
        &["video", "-o", "stills/"],
        &["bench"],
        &["--gl-info"],
    ] {
        let mut command = place.command(arguments);
        command.env("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent.json");
        Outcome::of(&mut command).refused(&["OpenGL", "install a driver"]);
    }
    assert_eq!(place.names(), [""; 0], "a refused job left a file");
}

#[test]
fn an_old_opengl_has_its_own_message() {
    let place = Workplace::new();
    for arguments in [&["still", "-o", "frame.png"][..], &["--gl-info"]] {
        let mut command = place.command(arguments);
        command.env("MESA_GL_VERSION_OVERRIDE", "2.1").env("MESA_GLES_VERSION_OVERRIDE", "2.0");
        Outcome::of(&mut command).refused(&["OpenGL", "3.3", "update the graphics driver"]);
    }
}

#[test]
fn without_a_display_the_window_is_refused_and_stills_are_offered() {
    let place = Workplace::new();
    for arguments in [&[][..], &["--silent"], &["--once", "--fullscreen"]] {
        place.run(arguments).refused(&["window", "graphical session", "mariana still"]);
    }
    for (name, display) in [("DISPLAY", ":4444"), ("WAYLAND_DISPLAY", "wayland-4444")] {
        let mut command = place.command(&[]);
        Outcome::of(command.env(name, display)).refused(&["window", "graphical session", "mariana still"]);
    }
}

#[test]
fn outputs_that_cannot_be_written_are_refused_by_name() {
    let place = Workplace::new();
    place.write_tone("song.wav", 440.0, 0.5, [0.5, 0.5]);
    std::fs::create_dir(place.path("folder.png")).unwrap();
    // Renaming a file over a socket or a device would destroy it.
    let _socket = UnixListener::bind(place.path("socket")).unwrap();
    let (names, song) = (place.names(), place.read("song.wav"));
    for output in
        ["none/frame.png", "folder.png", "song.wav/frame.png", "/proc/frame.png", "socket", "song.wav"]
    {
        place.run(&[&["still", "song.wav", "-o", output], &SIZE[..]].concat()).refused(&[output, "-o"]);
    }
    for output in
        ["none/song.mp4", "song.wav/stills/", "/proc/stills/", "socket", "song.wav", "song.nonsense", "song"]
    {
        let options = ["--duration", "0.2", "--fps", "10"];
        place
            .run(&[&["video", "song.wav", "-o", output], &options[..], &SIZE].concat())
            .refused(&[output, "-o"]);
    }
    assert_eq!((place.names(), place.read("song.wav")), (names, song), "a refused job changed the folder");
}

#[test]
fn unprintable_results_are_reported() {
    let place = Workplace::new();
    for arguments in [&["analyze", "--json"][..], &["devices"], &["--gl-info"]] {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let outcome = Outcome::printing_elsewhere(&mut place.command(arguments), full);
        outcome.refused(&["cannot be printed"]);
    }
}

#[test]
fn invalid_arguments_are_refused_with_the_valid_range() {
    let place = Workplace::new();
    for (size, what) in [
        ("0x0", "1 to 16384"),
        ("16385x1", "1 to 16384"),
        ("16384x16384", "at most"),
        ("-1x5", "whole number"),
        ("axb", "whole number"),
        ("99999999999x1", "whole number"),
        ("1280", "1280x720"),
        ("", "1280x720"),
    ] {
        for job in [&["still", "-o", "frame.png"][..], &["video", "-o", "song.mp4"], &["bench"], &[]] {
            let outcome = place.run(&[job, &["--size", size]].concat());
            outcome.refused_arguments("--size", &[size, what]);
        }
    }
    for time in ["-1", "nan", "inf", "1e300", "86401", "noon", ""] {
        for (job, option) in [
            (&["still", "-o", "frame.png"][..], "--at"),
            (&["bench"], "--at"),
            (&["analyze"], "--start"),
            (&["analyze"], "--duration"),
            (&["video", "-o", "song.mp4"], "--start"),
            (&["video", "-o", "song.mp4"], "--duration"),
        ] {
            let outcome = place.run(&[job, &[option, time]].concat());
            outcome.refused_arguments(option, &[time]);
        }
    }
    for fps in ["0", "-1", "nan", "inf", "1e9", "0.0001", "many"] {
        for (job, option) in
            [(&["analyze"][..], "--fps"), (&["video", "-o", "song.mp4"], "--fps"), (&[], "--fps-cap")]
        {
            place.run(&[job, &[option, fps]].concat()).refused_arguments(option, &[fps]);
        }
    }
    for (arguments, option) in [
        (&["bench", "--frames", "0"][..], "--frames"),
        (&["bench", "--frames", "-3"], "--frames"),
        (&["video", "-o", "song.mp4", "--duration", "0"], "--duration"),
        (&["--volume", "101"], "--volume"),
        (&["--volume", "-1"], "--volume"),
        (&["--latency", "nan"], "--latency"),
        (&["still", "-o", ""], "--output"),
        (&["still"], "required"),
        (&["analyze", "--bogus"], "--bogus"),
        (&["analyze", "one.wav", "two.wav"], "two.wav"),
    ] {
        place.run(arguments).refused_arguments(option, &[]);
    }
    for arguments in
        [&["--mic", "--system"][..], &["song.wav", "--mic"], &["--system", "--silent"], &["--mic", "--once"]]
    {
        place.run(arguments).refused_arguments("--", &["cannot be used with"]);
    }
    assert_eq!(place.names(), [""; 0], "a refused job left a file");
}

#[test]
fn a_negative_count_was_taken_for_another_flag() {
    let place = Workplace::new();
    let still = ["still", "-o", "frame.png"];
    for (arguments, option) in [
        (&["--light", "path", "--samples", "-1"][..], "--samples"),
        (&["--shutter", "180", "--shutter-frames", "-1"], "--shutter-frames"),
    ] {
        place.run(&[&still[..], arguments].concat()).refused_arguments(option, &["-1", "from"]);
    }
}

#[test]
fn flags_without_an_effect_were_ignored_in_silence() {
    let place = Workplace::new();
    for job in [&["still", "-o", "frame.png"][..], &["video", "-o", "song.mp4"], &[]] {
        for projection in [&[][..], &["--projection", "360"]] {
            place
                .run(&[job, &["--dome-tilt", "10"], projection].concat())
                .refused(&["--dome-tilt", "--projection dome"]);
        }
    }
    place
        .run(&["still", "-o", "frame.png", "--light", "path", "--ray", "1,1"])
        .refused(&["--light path", "leave out --ray"]);
    assert_eq!(place.names(), [""; 0], "a refused job left a file");
}

#[test]
fn a_scene_that_is_a_pipe_is_refused() {
    let place = Workplace::new();
    output_of(Command::new("mkfifo").arg(place.path("pipe.scene")), "coreutils").unwrap();
    place.run(&["check", "pipe.scene"]).refused(&["pipe.scene", "it is not a file"]);
}

#[test]
fn a_scene_name_may_be_invalid_utf8() {
    let place = Workplace::new();
    let name = OsStr::from_bytes(b"caf\xe9.scene");
    std::fs::write(place.path("").join(name), "length(p) - 1").unwrap();
    let mut command = place.command(&["still", "--size", "16x9", "-o", "still.png", "--scene"]);
    Outcome::of(command.arg(name)).done();
    let mut command = place.command(&["still", "--size", "16x9", "-o", "still.png", "--scene"]);
    Outcome::of(command.arg(OsStr::from_bytes(b"gone\xe9.scene"))).refused(&["cannot be read"]);
}

#[test]
fn an_invalid_scale_factor_is_refused() {
    let place = Workplace::new();
    for factor in ["nonsense", "-5", "0", "NaN", "1e9"] {
        let mut command = place.command(&["--silent"]);
        Outcome::of(command.env("WINIT_X11_SCALE_FACTOR", factor))
            .refused(&["WINIT_X11_SCALE_FACTOR", factor]);
    }
}

#[test]
fn the_system_error_of_a_song_is_reported_once() {
    let place = Workplace::new();
    symlink("loop.wav", place.path("loop.wav")).unwrap();
    let reported = place.run(&["analyze", "loop.wav"]).refused(&["loop.wav could not be read"]);
    assert_eq!(reported.matches("os error").count(), 1, "{reported}");
}

#[test]
fn a_time_after_the_end_is_refused_with_the_length() {
    let place = Workplace::new();
    place.write_tone("song.wav", 440.0, 1.25, [0.5, 0.5]);
    for time in ["1.25", "1.3", "60", "86400"] {
        for (job, option) in [
            (&["still", "song.wav", "-o", "frame.png"][..], "--at"),
            (&["bench", "song.wav"], "--at"),
            (&["analyze", "song.wav"], "--start"),
            (&["video", "song.wav", "-o", "song.mp4"], "--start"),
        ] {
            place.run(&[job, &[option, time]].concat()).refused(&["song.wav", "1.25 s", time]);
        }
    }
    place.run(&["still", "--at", "5000", "-o", "frame.png"]).refused(&["5000"]);
    assert_eq!(place.names(), ["song.wav"], "a refused job left a file");
}

#[test]
fn a_shader_folder_without_a_file_is_refused_with_its_name() {
    let place = Workplace::new();
    std::fs::create_dir(place.path("empty")).unwrap();
    for folder in ["empty", "none"] {
        for job in [&["still", "-o", "frame.png"][..], &["bench"], &["video", "-o", "stills/"]] {
            place.run(&[job, &["--shaders", folder]].concat()).refused(&[folder, "--shaders"]);
        }
    }
    let (folder, _) = changed_shaders(&[]);
    let shaders = folder.path().to_str().unwrap();
    std::fs::remove_file(folder.path().join("sphere_tracing.glsl")).unwrap();
    place.run(&["still", "-o", "frame.png", "--shaders", shaders]).refused(&[shaders, "sphere_tracing.glsl"]);
}

#[test]
fn a_shader_error_is_reported_with_file_and_line() {
    let place = Workplace::new();
    for file in ["scene.frag", "light.glsl"] {
        let (folder, _) = changed_shaders(&[]);
        let shaders = folder.path().to_str().unwrap();
        let text = std::fs::read_to_string(folder.path().join(file)).unwrap();
        std::fs::write(folder.path().join(file), format!("{text}\nfloat oops = ;\n")).unwrap();
        let line = (text.lines().count() + 2).to_string();
        let run = |job: &[&str]| place.run(&[job, &["--shaders", shaders]].concat());
        run(&["still", "-o", "frame.png"]).refused_with_details(&[file, &line]);
        run(&["bench"]).refused_with_details(&[file, &line]);
    }
    assert_eq!(place.names(), [""; 0], "a refused job left a file");
}

#[test]
fn without_ffmpeg_a_video_is_refused_and_stills_are_offered() {
    let place = Workplace::new();
    let mut command = place.command(&["video", "--duration", "0.1", "-o", "song.mp4"]);
    command.args(SIZE).env("PATH", "");
    Outcome::of(&mut command).refused(&["install", "ffmpeg", "stills"]);
    assert_eq!(place.names(), [""; 0], "a refused job left a file");
}

#[test]
fn existing_outputs_survive_every_failure() {
    let place = Workplace::new();
    place.write("good.png", "a good picture");
    place.write("good.mp4", "a good video");
    place.write("text.mp3", "no music");
    std::fs::create_dir(place.path("tools")).unwrap();
    let script = "#!/bin/sh\nfor last; do :; done\necho half > \"${last#file:}\"\ncat > /dev/null\n\
                  echo \"$SAYS\" >&2\nexit $ENDS\n";
    place.write("tools/ffmpeg", script);
    std::fs::set_permissions(place.path("tools/ffmpeg"), Permissions::from_mode(0o755)).unwrap();
    let names = place.names();

    let (shaders, _) = changed_shaders(&[("scene.frag", "nonsense")]);
    let shaders = shaders.path().to_str().unwrap();
    for fault in [&["text.mp3"][..], &["--at", "5000"], &["--shaders", shaders]] {
        place.run(&[&["still", "-o", "good.png"], fault, &SIZE].concat()).refused_with_details(&[]);
    }
    let video = ["video", "-o", "good.mp4", "--duration", "1", SIZE[0], SIZE[1]];
    for fault in [&["text.mp3"][..], &["--start", "5000"], &["--shaders", shaders]] {
        place.run(&[&video[..], fault].concat()).refused_with_details(&[]);
    }
    // On a full disk, ffmpeg reports the error and still exits with 0.
    for (says, ends) in [("disk on fire", "1"), ("av_write_trailer: No space left on device\n", "0")] {
        let mut command = place.command(&video);
        command.env("PATH", format!("{}:/bin:/usr/bin", place.path("tools").display()));
        command.env("SAYS", says).env("ENDS", ends);
        Outcome::of(&mut command).refused(&["good.mp4", says.trim()]);
    }
    let mut command = place.command(&["still", "-o", "good.png"]);
    Outcome::of(command.env("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent.json")).refused(&[]);

    assert_eq!(place.names(), names);
    assert_eq!(place.read("good.png"), b"a good picture");
    assert_eq!(place.read("good.mp4"), b"a good video");
}

/// ffmpeg's messages about a damaged song once filled a pipe that nothing read, so the video never ended.
#[test]
fn a_video_of_a_damaged_song_ends() {
    let place = Workplace::new();
    place.ffmpeg(&["-f", "lavfi", "-i", "sine=300:duration=150", "-b:a", "128k"], "good.mp3");
    let mut bytes = place.read("good.mp3");
    for (index, byte) in bytes.iter_mut().enumerate().skip(4096) {
        if index % 97 == 0 {
            *byte ^= 0x5a;
        }
    }
    place.write("bad.mp3", bytes);
    let outcome = place.run(&["video", "bad.mp3", "--fps", "1", "--size", "16x16", "-o", "bad.mkv"]);
    assert!(outcome.code == 0 || outcome.code == 1, "{outcome:?}");
}
