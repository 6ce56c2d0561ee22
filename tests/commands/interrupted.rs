//! Jobs that are interrupted by signals, a full disk or a crashing driver: the messages, and the files that remain.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::ffi::OsStr;
use std::fs::Permissions;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::support::program::{Outcome, Workplace};
use mariana_testing::process::{Process, output_of, wait_until};

const SCENE: [&str; 2] = ["--scene", "length(p) - 1"];

/// A video of the demo track that takes minutes. One frame does not fit into a pipe, so writing it can block.
const LONG_VIDEO: [&str; 9] =
    ["video", SCENE[0], SCENE[1], "--size", "256x144", "--fps", "1000", "-o", "song.mp4"];

fn workplace() -> Workplace {
    let place = Workplace::new();
    std::fs::create_dir(place.path("tmp")).unwrap();
    place.write("song.mp4", "a good video");
    place
}

/// Returns a command that uses the temporary folder of `place`. Signals have their default effect on the command,
/// even if the test ignores some.
fn command(place: &Workplace, arguments: &[&str]) -> Command {
    let program = place.command(arguments);
    let mut command = Command::new("env");
    command.arg("--default-signal=HUP,INT,TERM").arg(program.get_program()).args(program.get_args());
    for (name, value) in program.get_envs() {
        match value {
            Some(value) => command.env(name, value),
            None => command.env_remove(name),
        };
    }
    command.current_dir(program.get_current_dir().unwrap());
    command
        .env("TMPDIR", place.path("tmp"))
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

fn names_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect()
}

fn unfinished_in(folder: &Path) -> Vec<String> {
    names_in(folder).into_iter().filter(|name| name.starts_with(".mariana-")).collect()
}

fn children_of(process: &Process) -> Vec<u32> {
    let path = format!("/proc/{0}/task/{0}/children", process.id());
    let text = std::fs::read_to_string(path).unwrap_or_default();
    text.split_whitespace().map(|number| number.parse().unwrap()).collect()
}

fn lives(number: u32) -> bool {
    let stat = std::fs::read_to_string(format!("/proc/{number}/stat")).unwrap_or_default();
    stat.rsplit_once(") ").is_some_and(|(_, state)| !state.starts_with('Z'))
}

fn send(signal: &str, number: u32) {
    let mut kill = Command::new("kill");
    output_of(kill.args([&format!("-{signal}"), &number.to_string()]), "procps").unwrap();
}

/// Returns the program's process and the process id of ffmpeg.
fn start_video(place: &Workplace, command: &mut Command) -> (Process, u32) {
    let mut process = Process::start(command, "coreutils");
    let mut encoder = None;
    wait_until("the encoder", || {
        assert!(process.ended().is_none(), "the video ended by itself");
        encoder = children_of(&process).first().copied();
        encoder.is_some()
    });
    assert!(!unfinished_in(&place.path("")).is_empty(), "the video has no unfinished file");
    (process, encoder.unwrap())
}

#[track_caller]
fn assert_ends_cleanly(place: &Workplace, mut process: Process, signal: &str, code: i32) {
    let names = place.names();
    let kept: Vec<&String> = names.iter().filter(|name| !name.starts_with(".mariana-")).collect();
    send(signal, process.id());
    wait_until("its end", || process.ended().is_some());
    assert_eq!(process.ended().unwrap().code(), Some(code), "{signal}");
    let reported = std::io::read_to_string(process.child().stderr.take().unwrap()).unwrap();
    assert!(
        reported.starts_with("mariana: ") && reported.contains(signal) && reported.lines().count() == 1,
        "{reported}"
    );
    assert_eq!(place.names().iter().collect::<Vec<_>>(), kept, "{signal}");
    assert_eq!(names_in(&place.path("tmp")), [""; 0], "{signal}");
}

#[test]
fn an_interrupted_video_leaves_no_hidden_files() {
    let place = workplace();
    for (signal, code) in [("INT", 130), ("TERM", 143), ("HUP", 129)] {
        let (process, encoder) = start_video(&place, &mut command(&place, &LONG_VIDEO));
        assert_eq!(unfinished_in(&place.path("tmp")).len(), 1, "the demo track for ffmpeg");
        assert_ends_cleanly(&place, process, signal, code);
        assert!(!lives(encoder), "ffmpeg is still running");
        assert_eq!(place.read("song.mp4"), b"a good video");
    }
}

#[test]
fn a_second_run_of_a_part_was_told_to_find_space_and_an_interrupted_one_left_a_folder() {
    let place = workplace();
    let part = ["video", SCENE[0], SCENE[1], "--size", "640x360", "--fps", "1000", "-o", "part.mp4"];
    let part = [&part[..], &["--part", "1/1", "--flash-limiter", "off"]].concat();
    let mut process = Process::start(&mut command(&place, &part), "coreutils");
    let pieces = place.path("part.mp4.pieces");
    wait_until("the first piece", || pieces.exists() && !unfinished_in(&pieces).is_empty());
    place.run(&part).refused(&["another run renders part.mp4", "-o"]);
    assert!(pieces.exists());
    send("INT", process.id());
    wait_until("its end", || process.ended().is_some());
    let reported = std::io::read_to_string(process.child().stderr.take().unwrap()).unwrap();
    assert!(reported.contains("run the same command again"), "{reported}");
    assert!(!pieces.exists(), "{:?}", names_in(&pieces));
}

fn with_encoder<'c>(place: &Workplace, command: &'c mut Command, script: &str) -> &'c mut Command {
    std::fs::create_dir_all(place.path("tools")).unwrap();
    place.write("tools/ffmpeg", script);
    std::fs::set_permissions(place.path("tools/ffmpeg"), Permissions::from_mode(0o755)).unwrap();
    command.env("PATH", format!("{}:/bin:/usr/bin", place.path("tools").display()))
}

#[test]
fn a_video_with_a_blocked_encoder_is_interrupted_cleanly() {
    let place = workplace();
    let mut command = command(&place, &LONG_VIDEO);
    // The encoder ignores signals. It reads a single byte, so the program blocks while it writes the rest.
    let script =
        "#!/bin/sh\ntrap '' INT TERM HUP\ndd bs=1 count=1 of=\"${0%/*}/begun\" 2>&-\nexec sleep 1000\n";
    let (process, encoder) = start_video(&place, with_encoder(&place, &mut command, script));
    wait_until("the first frame", || {
        std::fs::read(place.path("tools/begun")).is_ok_and(|byte| byte.len() == 1)
    });
    assert_ends_cleanly(&place, process, "INT", 130);
    assert!(!lives(encoder), "the encoder is still running");
}

#[test]
fn an_interrupted_still_leaves_no_hidden_file() {
    let place = workplace();
    let arguments = ["still", "--size", "8192x8192", "-o", "still.png"];
    let process = Process::start(&mut command(&place, &arguments), "coreutils");
    wait_until("its file", || !unfinished_in(&place.path("")).is_empty());
    assert_ends_cleanly(&place, process, "TERM", 143);
}

#[test]
fn an_interrupted_still_by_paths_is_the_image_so_far() {
    let place = workplace();
    let arguments = [
        &["still", SCENE[0], SCENE[1], "--size", "64x64", "-o", "still.png"][..],
        &["--light", "path", "--samples", "65535", "--noise", "0"],
    ];
    let interrupted = |arguments: &[&str]| {
        let mut process = Process::start(&mut command(&place, arguments), "coreutils");
        wait_until("its file", || !unfinished_in(&place.path("")).is_empty());
        send("INT", process.id());
        wait_until("its end", || process.ended().is_some());
        assert_eq!(process.ended().unwrap().code(), Some(130));
        std::io::read_to_string(process.child().stderr.take().unwrap()).unwrap()
    };
    let arguments = arguments.concat();
    let reported = interrupted(&arguments);
    assert!(reported.starts_with("mariana: SIGINT: finishing"), "{reported}");
    assert!(reported.contains("still.png shows the paths so far: run the same command again"), "{reported}");
    let picture = image::open(place.path("still.png")).unwrap();
    assert_eq!((picture.width(), picture.height()), (64, 64));
    assert!(unfinished_in(&place.path("")).is_empty());

    // Another process finds the same scene, sound and settings.
    let reported = interrupted(&arguments);
    assert!(reported.contains("continuing the paths in still.png.pieces"), "{reported}");
    let reported = interrupted(&[&arguments[..], &["--set", "volume.x=0.5"]].concat());
    let words = "the paths in still.png.pieces are of an image of another scene or with other settings";
    assert!(reported.contains(words), "{reported}");
}

#[test]
fn files_of_a_killed_video_are_removed_later() {
    let place = workplace();
    let (mut killed, encoder) = start_video(&place, &mut command(&place, &LONG_VIDEO));
    killed.kill();
    wait_until("the end of the killed video's ffmpeg", || !lives(encoder));
    assert!(!unfinished_in(&place.path("")).is_empty() && !unfinished_in(&place.path("tmp")).is_empty());

    // The cleanup must not delete the files of a running job.
    let (living, _) = start_video(&place, &mut command(&place, &LONG_VIDEO));
    let written = unfinished_in(&place.path(""));
    assert_eq!(written.len(), 1, "{written:?}");
    assert_eq!(unfinished_in(&place.path("tmp")).len(), 1);
    place.write(".mariana-notes.txt", "the user's own");
    place.run(&["still", SCENE[0], SCENE[1], "--size", "16x9", "-o", "still.png"]).done();
    let unfinished = [&written[0], ".mariana-notes.txt"];
    assert_eq!(place.names().len(), ["song.mp4", "still.png", "tmp"].len() + unfinished.len());
    assert!(unfinished.iter().all(|name| place.path(name).exists()), "{:?}", place.names());
    std::fs::remove_file(place.path(".mariana-notes.txt")).unwrap();
    assert_ends_cleanly(&place, living, "TERM", 143);
}

#[test]
fn a_video_under_nohup_ignores_hangups() {
    let place = workplace();
    let mut ignoring = Command::new("env");
    let usual = command(&place, &LONG_VIDEO);
    ignoring.arg("--ignore-signal=HUP").args(usual.get_args().skip(1)).current_dir(place.path(""));
    ignoring.envs(usual.get_envs().filter_map(|(name, value)| Some((name, value?))));
    ignoring.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let (process, _) = start_video(&place, &mut ignoring);
    send("HUP", process.id());
    // Pending signals are handled in the order of their numbers, so HUP would come before TERM if it were not ignored.
    assert_ends_cleanly(&place, process, "TERM", 143);
}

/// Exit handlers free resources that compiling driver threads still use, so the program must not run them.
#[test]
fn exit_handlers_do_not_run_while_drivers_have_threads() {
    let place = Workplace::new();
    // This library's destructor ends the process with code 77, which shows that `exit` was called.
    place.write(
        "late.c",
        "#include <unistd.h>\n__attribute__((destructor)) static void late(void) { _exit(77); }\n",
    );
    let mut compiler = Command::new("cc");
    compiler.args(["-shared", "-fPIC", "-o"]).args([place.path("late.so"), place.path("late.c")]);
    output_of(&mut compiler, "gcc").unwrap();
    let run = |arguments: &[&str]| {
        let mut command = place.command(arguments);
        Outcome::of(command.env("LD_PRELOAD", place.path("late.so")))
    };
    assert_eq!(run(&["--version"]).code, 77, "the library has no effect without a driver");
    run(&["still", "--size", "16x9", "-o", "still.png"]).done();
    run(&["video", "--size", "16x9", "--fps", "10", "--duration", "0.2", "-o", "stills/"]).done();
    let lines = run(&["analyze", "--fps", "10", "--duration", "2"]).done();
    assert_eq!(lines.lines().count(), 20, "the printed lines were not flushed");
    run(&["bench", "--sdf", "compiled", "--frames", "1", "--size", "16x9"]).done();
    run(&["--gl-info"]).done();
    assert_eq!(run(&["eval", "length(p)", "--at", "0,2,0"]).done().trim(), "2");
    run(&["devices"]).done();
    run(&["analyze", "missing.wav"]).refused(&["missing.wav"]);
}

/// Runs the program with a limit on file sizes, so that a write fails in the middle, as on a full disk.
fn on_a_full_disk(place: &Workplace, arguments: &[&str]) -> Outcome {
    let program = place.command(arguments);
    let mut shell = Command::new("sh");
    // The unit of the limit is 512 or 1024 bytes.
    shell.args(["-c", "ulimit -f 1; exec \"$0\" \"$@\""]).arg(program.get_program()).args(program.get_args());
    shell.envs(program.get_envs().filter_map(|(name, value)| Some((name, value?))));
    shell.current_dir(place.path("")).stdin(Stdio::null()).env("MESA_SHADER_CACHE_DISABLE", "true");
    Outcome::of(&mut shell)
}

#[test]
fn a_still_on_a_full_disk_is_refused() {
    let place = Workplace::new();
    place.write("good.png", "a good picture");
    place.write_tone("song.wav", 440.0, 0.5, [0.5, 0.5]);
    on_a_full_disk(&place, &["still", "song.wav", "--size", "256x144", "-o", "good.png"])
        .refused(&["good.png", "-o"]);
    assert_eq!((place.names().len(), place.read("good.png")), (2, b"a good picture".to_vec()));
    on_a_full_disk(&place, &["still", "song.wav", "--size", "2x2", "-o", "good.png"]).done();
    assert!(place.read("good.png").starts_with(b"\x89PNG"));
}

#[test]
fn a_video_on_a_full_disk_is_refused() {
    let place = Workplace::new();
    place.write("good.mp4", "a good video");
    place.write_tone("song.wav", 440.0, 2.0, [0.5, 0.5]);
    let video = ["video", "--duration", "1.5", "--fps", "10", "--size", "64x36", "-o"];
    let of_the_song = [&video[..], &["good.mp4", "song.wav"]].concat();
    on_a_full_disk(&place, &of_the_song).refused(&["good.mp4", "enough space"]);
    // ffmpeg reads the demo track from a temporary file, and the limit stops the program from writing this file.
    let reported = on_a_full_disk(&place, &[&video[..], &["good.mp4"]].concat()).refused(&["TMPDIR"]);
    assert!(!reported.contains("good.mp4"), "{reported}");
    on_a_full_disk(&place, &[&video[..], &["stills/", "song.wav"]].concat()).refused(&["frame-00000.png"]);
    assert_eq!(names_in(&place.path("stills")), [""; 0]);
    assert_eq!(place.names(), ["good.mp4", "song.wav", "stills"]);
    assert_eq!(place.read("good.mp4"), b"a good video");
}

#[test]
fn formats_of_several_files_are_refused() {
    let place = Workplace::new();
    place.write_tone("song.wav", 440.0, 0.5, [0.5, 0.5]);
    for output in ["list.m3u8", "LIST.M3U8", "list.mpd"] {
        let video =
            ["video", "song.wav", "--fps", "10", "--duration", "0.2", "--size", "16x16", "-o", output];
        place.run(&video).refused(&[output, "several files", ".mp4"]);
    }
    assert_eq!(place.names(), ["song.wav"]);
}

#[test]
fn special_names_for_ffmpeg_are_plain_file_names() {
    let place = Workplace::new();
    let names = [
        &b"-y.mp4"[..],
        b"-i",
        b"concat:a|b.mp4",
        b"file:a.mp4",
        b"pipe:1.mp4",
        b"http:__x.mp4",
        b"a%03d.mp4",
        b"two\nlines.mp4",
        b"tee:[f=null]x.mp4",
        b"caf\xe9\xff.mp4",
        b"'; touch x'.mp4",
    ];
    for (index, name) in names.into_iter().enumerate() {
        let name = OsStr::from_bytes(name);
        // Use the name first for the video, then for the song.
        let folder = place.path(&format!("folder %d {index}"));
        std::fs::create_dir(&folder).unwrap();
        place.write_tone(&format!("folder %d {index}/song.wav"), 440.0, 0.5, [0.5, 0.5]);
        let as_song = folder.join("songs").join(name);
        std::fs::create_dir(folder.join("songs")).unwrap();
        std::fs::copy(folder.join("song.wav"), &as_song).unwrap();

        let make = |song: &OsStr, output: &OsStr, at: &Path| {
            let mut argument = OsStr::new("--output=").to_owned();
            argument.push(output);
            let mut command =
                place.command(&["video", "--fps", "10", "--duration", "0.2", "--size", "16x16"]);
            command.args(SCENE).arg(argument).arg("--").arg(song).current_dir(at);
            Outcome::of(&mut command)
        };
        if name.to_string_lossy().contains(".mp4") {
            make(OsStr::new("song.wav"), name, &folder).done();
            assert!(std::fs::metadata(folder.join(name)).is_ok_and(|video| video.len() > 500), "{name:?}");
            std::fs::remove_file(folder.join(name)).unwrap();
        } else {
            make(OsStr::new("song.wav"), name, &folder).refused(&["-i", "ends in .mp4"]);
        }
        make(name, OsStr::new("../video.mp4"), &folder.join("songs")).done();
        std::fs::remove_file(folder.join("video.mp4")).unwrap();
        assert_eq!(
            names_in(&folder.join("songs")).len(),
            1,
            "{name:?}: {:?}",
            names_in(&folder.join("songs"))
        );
        assert_eq!(names_in(&folder).len(), 2, "{name:?}: {:?}", names_in(&folder));
    }
}
