//! Tests of reading videos: frames in any order, loops, and files that are no good videos.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

use std::path::{Path, PathBuf};
use std::process::Command;

use mariana_player::video::{VideoFrame, VideoReader};

use crate::decoding::ffmpeg;

const SIZE: (u32, u32) = (64, 48);

fn made(folder: &Path, name: &str, seconds: &str, args: &[&str]) -> PathBuf {
    let path = folder.join(name);
    let source = format!("testsrc=s={}x{}:r=25:d={seconds}", SIZE.0, SIZE.1);
    ffmpeg(&[&["-f", "lavfi", "-i", &source, "-pix_fmt", "yuv420p"], args].concat(), &path);
    path
}

fn open(path: &Path) -> VideoReader {
    VideoReader::open(path, "clip").unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn frame(reader: &mut VideoReader, number: u64) -> VideoFrame {
    reader.frame(number).unwrap_or_else(|error| panic!("frame {number}: {error}")).clone()
}

fn refusal(path: &Path) -> String {
    let error = match VideoReader::open(path, "clip") {
        Err(error) => error,
        Ok(mut reader) => reader.frame(3).map(|_| ()).expect_err("a frame"),
    };
    error.to_string()
}

/// All frames of a file, decoded by ffmpeg alone.
fn all(path: &Path) -> Vec<Vec<u8>> {
    let run = Command::new("ffmpeg")
        .args(["-v", "error", "-nostdin", "-i"])
        .arg(path)
        .args(["-pix_fmt", "rgba", "-f", "rawvideo", "-"])
        .output()
        .expect("ffmpeg is needed to decode the test media: install it");
    run.stdout.chunks(4 * (SIZE.0 * SIZE.1) as usize).map(<[u8]>::to_vec).collect()
}

#[test]
fn every_frame_is_the_same_in_any_order() {
    let folder = tempfile::tempdir().unwrap();
    let cases: [(&str, &[&str]); 6] = [
        ("a.mp4", &["-g", "20", "-bf", "2"]),
        ("a.webm", &["-c:v", "libvpx", "-g", "20"]),
        ("a.ts", &["-c:v", "mpeg2video", "-bf", "2"]),
        ("a.avi", &["-c:v", "mjpeg"]),
        ("a.mkv", &["-c:v", "ffv1"]),
        ("a.mov", &["-c:v", "mpeg4"]),
    ];
    for (name, args) in cases {
        let path = made(folder.path(), name, "3", args);
        let known = all(&path);
        assert_eq!(known.len(), 75, "{name}");
        let mut reader = open(&path);
        assert_eq!((reader.info().rate, reader.info().frames), ((25, 1), 75), "{name}");
        for number in [0, 1, 2, 70, 33, 34, 32, 74, 12, 0, 60, 75, 149, 7 * 75 + 21] {
            let found = frame(&mut reader, number);
            assert_eq!(found.size, SIZE, "{name}");
            assert!(found.rgba == known[number as usize % 75], "{name}: frame {number} differs");
        }
    }
}

#[test]
fn a_variable_rate_is_read_on_a_grid_that_no_seek_changes() {
    let folder = tempfile::tempdir().unwrap();
    let select = "select='not(mod(n,7))+not(mod(n,5))'";
    let path = made(folder.path(), "a.mkv", "4", &["-vf", select, "-vsync", "vfr", "-c:v", "ffv1"]);
    let whole = made(folder.path(), "all.mkv", "4", &["-c:v", "ffv1"]);
    let known = all(&whole);
    let (mut ordered, mut sought) = (open(&path), open(&path));
    let (rate, frames) = (ordered.info().rate(), ordered.info().frames);
    let ordered: Vec<VideoFrame> = (0..frames).map(|number| frame(&mut ordered, number)).collect();
    for step in (0..frames).step_by(4) {
        let number = step * 37 % frames;
        assert!(
            frame(&mut sought, number) == ordered[number as usize],
            "frame {number} after a seek differs"
        );
    }
    // A frame stays until the next one begins.
    for (number, found) in ordered.iter().enumerate() {
        let of_source = (number as f64 * 25.0 / rate).round() as usize;
        let kept = (0..=of_source.min(99)).rev().find(|n| n % 7 == 0 || n % 5 == 0).unwrap();
        assert!(found.rgba == known[kept], "step {number} does not show frame {kept}");
    }
}

#[test]
fn large_and_stretched_frames_are_scaled_to_the_limit() {
    let folder = tempfile::tempdir().unwrap();
    let size = |name: &str, args: &[&str]| {
        let path = made(folder.path(), name, "0.2", args);
        frame(&mut open(&path), 2).size
    };
    assert_eq!(size("large.avi", &["-vf", "scale=3840:2160,setsar=1", "-c:v", "mjpeg"]), (1_920, 1_080));
    assert_eq!(size("tall.avi", &["-vf", "scale=1000:4000,setsar=1", "-c:v", "mjpeg"]), (270, 1_080));
    assert_eq!(size("wide.mkv", &["-vf", "setsar=2", "-c:v", "ffv1"]), (128, 48));
}

#[test]
fn an_animation_and_a_file_without_a_length_are_repeated() {
    let folder = tempfile::tempdir().unwrap();
    let gif = made(folder.path(), "a.gif", "1", &["-pix_fmt", "rgb8", "-r", "10"]);
    let mut reader = open(&gif);
    let frames = reader.info().frames;
    assert!((10..=11).contains(&frames), "{frames}");
    let (first, third) = (frame(&mut reader, 0), frame(&mut reader, 3));
    assert!(first != third && frame(&mut reader, frames + 3) == third);
    assert!(frame(&mut reader, 2 * frames) == first);
    // A live stream has no length in its header.
    let live = made(folder.path(), "live.webm", "2", &["-c:v", "libvpx", "-live", "1"]);
    let mut reader = open(&live);
    assert_eq!(reader.info().frames, 50);
    let first = frame(&mut reader, 0);
    assert!(frame(&mut reader, 50) == first && frame(&mut reader, 26) != first);
}

#[test]
fn a_video_that_ends_before_its_claimed_end_keeps_its_last_frame() {
    let folder = tempfile::tempdir().unwrap();
    let path = made(folder.path(), "a.mkv", "8", &["-c:v", "ffv1", "-g", "10"]);
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() * 2 / 5]).unwrap();
    let mut ordered = open(&path);
    assert_eq!(ordered.info().frames, 200);
    let ordered: Vec<VideoFrame> = (0..200).map(|number| frame(&mut ordered, number)).collect();
    assert!(ordered[199] == ordered[100] && ordered[60] != ordered[199]);
    for number in [199, 120, 30, 150, 199 + 200, 231] {
        let mut fresh = open(&path);
        assert!(frame(&mut fresh, number) == ordered[number as usize % 200], "frame {number}");
    }
}

#[test]
fn files_without_pictures_are_refused_with_advice() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    ffmpeg(&["-f", "lavfi", "-i", "sine=d=1"], &path("sound.mp4"));
    let gives_none = |words: &str| {
        words.starts_with("clip has no moving picture (") || words.starts_with("clip gives no picture (")
    };
    assert!(refusal(&path("sound.mp4")).starts_with("clip has no moving picture ("));
    std::fs::write(path("text.mp4"), "no video").unwrap();
    std::fs::write(path("empty.mp4"), "").unwrap();
    std::fs::write(path("list.mp4"), "#EXTM3U\n#EXTINF:1,\nsound.mp4\n").unwrap();
    for name in ["text.mp4", "empty.mp4", "list.mp4"] {
        let words = refusal(&path(name));
        assert!(gives_none(&words) && !words.contains('/') && !words.contains('\n'), "{name}: {words}");
    }
    assert!(refusal(&path("none.mp4")).starts_with("the video clip cannot be read ("));
    assert!(refusal(folder.path()).starts_with("the video clip cannot be read ("));
    let huge =
        made(folder.path(), "huge.mkv", "0.1", &["-s", "16384x16", "-c:v", "png", "-pix_fmt", "rgb24"]);
    assert!(refusal(&huge).starts_with("clip has 16384 x 16 pixels, more than "));
    let whole = made(folder.path(), "whole.mkv", "1", &["-c:v", "ffv1"]);
    let bytes = std::fs::read(&whole).unwrap();
    let header = bytes.windows(4).position(|id| id == [0x1f, 0x43, 0xb6, 0x75]).unwrap();
    std::fs::write(path("no frames.mkv"), &bytes[..header]).unwrap();
    let words = refusal(&path("no frames.mkv"));
    assert!(gives_none(&words), "{words}");
    // A file that vanishes fails at the next seek and comes back with the file.
    let mut reader = open(&whole);
    frame(&mut reader, 20);
    std::fs::rename(&whole, path("away.mkv")).unwrap();
    assert!(reader.frame(0).is_err());
    std::fs::rename(path("away.mkv"), &whole).unwrap();
    assert_eq!(frame(&mut reader, 0).size, SIZE);
}
