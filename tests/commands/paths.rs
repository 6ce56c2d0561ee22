//! `--light path` for stills and videos.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::program::Workplace;

const LOOK: [&str; 7] = ["--at", "1", "--size", "32x18", "--scene", "sphere(p, 1)", "-o"];

#[test]
fn a_still_by_paths_has_the_same_bytes_in_each_run() {
    let place = Workplace::new();
    let still = |name: &str, flags: &[&str]| {
        place.run(&[&["still"][..], &LOOK, &[name], flags].concat()).done();
        place.read(name)
    };
    let paths = ["--light", "path", "--samples", "8"];
    let first = still("first.png", &paths);
    assert_eq!(first, still("again.png", &paths));
    assert_ne!(first, still("raster.png", &["--light", "raster"]));
    assert_ne!(first, still("noisy.png", &[&paths[..], &["--no-filter"]].concat()));
    let blurred = [&paths[..], &["--shutter", "180", "--shutter-frames", "2"]].concat();
    assert_eq!(still("blurred.png", &blurred), still("blurred again.png", &blurred));
}

#[test]
fn a_video_by_paths_has_the_frames_of_stills() {
    let place = Workplace::new();
    let paths = ["--light", "path", "--samples", "4", "--noise", "0"];
    let frames = ["--start", "1", "--duration", "0.1", "--fps", "20", "--flash-limiter", "off"];
    let video = ["video", "--size", "32x18", "--scene", "sphere(p, 1)", "-o", "frames/"];
    place.run(&[&video[..], &frames, &paths].concat()).done();
    place.run(&[&["still"][..], &LOOK, &["still.png"], &paths].concat()).done();
    let mut names: Vec<_> =
        std::fs::read_dir(place.path("frames")).unwrap().map(|entry| entry.unwrap().path()).collect();
    names.sort();
    assert_eq!(names.len(), 2);
    let [frame, still] =
        [&names[0], &place.path("still.png")].map(|path| image::open(path).unwrap().to_rgb8());
    assert_eq!(frame, still);
}

#[test]
fn bad_numbers_and_contradicting_flags_are_refused() {
    let place = Workplace::new();
    let of = |flags: &[&str]| place.run(&[&["still", "-o", "x.png"], flags].concat());
    of(&["--light", "path", "--samples", "0"]).refused_arguments("--samples", &["1 to 65535"]);
    of(&["--light", "path", "--samples", "many"]).refused_arguments("--samples", &["not a whole number"]);
    of(&["--light", "path", "--noise", "-1"]).refused_arguments("--noise", &["0 to 1"]);
    of(&["--light", "path", "--noise", "nan"]).refused_arguments("--noise", &["0 to 1"]);
    of(&["--light", "candle"]).refused_arguments("--light", &["candle"]);
    of(&["--samples", "9"]).refused(&["--samples", "--light path"]);
    of(&["--noise", "0.1"]).refused(&["--noise", "--light path"]);
    of(&["--no-filter"]).refused(&["--no-filter", "--light path"]);
    of(&["--light", "path", "--alpha"]).refused(&["--alpha"]);
    of(&["--light", "path", "--view", "steps"]).refused(&["--view"]);
}
