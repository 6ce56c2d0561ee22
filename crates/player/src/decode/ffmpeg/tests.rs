//! Tests of programs that are missing, hang or are abandoned.

use std::process::Command;
use std::time::Instant;

use super::*;

fn refusal() -> Problem {
    Problem::UnsupportedFormat("a Windows Media file".into())
}

fn made(folder: &Path, name: &str, seconds: &str) -> PathBuf {
    let path = folder.join(name);
    let run = Command::new("ffmpeg")
        .args(["-v", "error", "-nostdin", "-f", "lavfi", "-i", &format!("sine=d={seconds}")])
        .arg(&path)
        .output()
        .expect("ffmpeg is needed to make the test media: install it");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    path
}

fn is_running(process: u32) -> bool {
    // A process that has ended but was not waited for is a zombie.
    let state = std::fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    !matches!(state.rsplit(") ").next(), None | Some("")) && !state.contains(") Z")
}

fn error(opened: Result<FfmpegDecoder, Problem>) -> String {
    opened.err().expect("an error").to_string()
}

#[test]
fn without_ffmpeg_the_message_suggests_it() {
    let nowhere = Programs { ffprobe: "/nowhere/ffprobe".into(), ..Programs::default() };
    let reported = error(FfmpegDecoder::open(Path::new("a.wma"), "a.wma", &refusal(), &nowhere));
    assert!(
        reported.contains("is a Windows Media file")
            && reported.contains("ffmpeg is not installed; install it"),
        "{reported}"
    );
    let folder = tempfile::tempdir().unwrap();
    let path = made(folder.path(), "a.wma", "1");
    let half = Programs { ffmpeg: "/nowhere/ffmpeg".into(), ..Programs::default() };
    let reported = error(FfmpegDecoder::open(&path, "a.wma", &refusal(), &half));
    assert!(reported.contains("ffmpeg is not installed; install it"), "{reported}");
}

#[test]
#[cfg(unix)]
fn a_program_that_hangs_is_given_up_and_ended() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe.wma");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    // ffmpeg waits for a writer of the pipe, but there is no writer.
    let patience = Duration::from_millis(300);
    let start = Instant::now();
    let reported = error(FfmpegDecoder::open(
        &pipe,
        "pipe.wma",
        &refusal(),
        &Programs { patience, ..Programs::default() },
    ));
    assert!(reported.contains("returned no data"), "{reported}");
    assert!(start.elapsed() < Duration::from_secs(20), "the wait was not limited");
}

#[test]
#[cfg(target_os = "linux")]
fn a_dropped_decoder_leaves_no_program_behind() {
    let folder = tempfile::tempdir().unwrap();
    let path = made(folder.path(), "long.au", "300");
    let mut decoder = FfmpegDecoder::open(&path, "long.au", &refusal(), &Programs::default()).unwrap();
    let first = decoder.process.id();
    assert!(is_running(first));
    decoder.seek(200.0).unwrap();
    let second = decoder.process.id();
    assert!(!is_running(first) && is_running(second));
    drop(decoder);
    assert!(!is_running(second));
}

#[test]
fn a_name_is_never_an_option_an_address_or_a_list() {
    let folder = tempfile::tempdir().unwrap();
    let sound = made(folder.path(), "a.wma", "1");
    for name in ["-i.wma", "http:x.wma", "concat:a|b.wma", "%03d.wma", "a b\n'.wma"] {
        let path = folder.path().join(name);
        std::fs::copy(&sound, &path).unwrap();
        let opened = FfmpegDecoder::open(&path, name, &refusal(), &Programs::default());
        assert!(opened.is_ok(), "{name}: {:?}", opened.err());
    }
    // A list of other files is no audio, even if ffmpeg knows its format.
    let list = folder.path().join("list.wma");
    std::fs::write(&list, "ffconcat version 1.0\nfile a.wma\n").unwrap();
    let reported = error(FfmpegDecoder::open(&list, "list.wma", &refusal(), &Programs::default()));
    assert!(
        reported.contains("is damaged") && !reported.contains(folder.path().to_str().unwrap()),
        "{reported}"
    );
}
