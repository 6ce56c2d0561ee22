//! Tests of loudness shapes of tracks with known loudness.

use std::time::{Duration, Instant};

use super::*;
use crate::player::tests::silent;
use crate::player::{Player, PlayerOptions};
use crate::playlist::Playlist;
use crate::track::{Repeat, Track};
use mariana_testing::wave::write_wav;

fn whole(player: &mut Player) -> Arc<LoudnessShape> {
    let start = Instant::now();
    loop {
        player.status();
        match player.shape() {
            Some(shape) if shape.levels.len() == shape.parts => return shape,
            _ => assert!(start.elapsed() < Duration::from_secs(20), "no shape"),
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn write_steps(path: &std::path::Path) {
    let levels = [0.0, 0.1, 1.0, 0.1_f32.sqrt()];
    write_wav(
        path,
        48_000,
        1,
        (0..4 * 48_000).map(|n| if n % 2 == 0 { levels[n / 48_000] } else { -levels[n / 48_000] }),
    );
}

fn played(path: &std::path::Path) -> Player {
    let opened = Playlist::open(&[path.to_owned()], Repeat::All, false).unwrap();
    let options = PlayerOptions { paused: true, ..silent(true) };
    Player::start(opened.first, Box::new(opened.list), options).unwrap()
}

#[test]
fn ten_decibels_more_are_twice_as_loud() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("steps.wav");
    write_steps(&path);
    let mut player = played(&path);
    player.status();
    assert!(player.shapes.0.get().is_none(), "the thread starts without a request");
    let shape = whole(&mut player);
    assert_eq!(shape.levels.len(), PARTS);
    for (part, wanted) in [(75, 0.0), (225, 0.25), (375, 1.0), (525, 0.5)] {
        assert!((shape.levels[part] - wanted).abs() < 0.01, "part {part} is {}", shape.levels[part]);
    }
    assert!(Arc::ptr_eq(&shape, &player.shape().unwrap()), "the shape is measured again");
}

#[test]
fn a_part_of_a_file_has_the_shape_of_that_part() {
    let folder = tempfile::tempdir().unwrap();
    write_steps(&folder.path().join("steps.wav"));
    let sheet = "FILE steps.wav WAVE\nTRACK 01 AUDIO\nINDEX 01 00:00:00\nTRACK 02 AUDIO\nINDEX 01 00:02:00\n";
    let path = folder.path().join("steps.cue");
    std::fs::write(&path, sheet).unwrap();
    let mut player = played(&path);
    assert!((whole(&mut player).levels[PARTS - 9] - 1.0).abs() < 0.01);
    player.play_entry(1);
    let start = Instant::now();
    while player.status().track.entry != 1 {
        assert!(start.elapsed() < Duration::from_secs(10));
        std::thread::sleep(Duration::from_millis(2));
    }
    let shape = whole(&mut player);
    assert!((shape.levels[9] - 1.0).abs() < 0.01 && (shape.levels[PARTS - 9] - 0.5).abs() < 0.01);
}

struct Endless {
    duration: Option<f64>,
}

impl FrameSource for Endless {
    fn sample_rate(&self) -> u32 {
        8000
    }

    fn duration(&self) -> Option<f64> {
        self.duration
    }

    fn next_block(&mut self, out: &mut Vec<[f32; 2]>) -> Result<usize, crate::source::SourceError> {
        out.extend([[1.0; 2]; 100]);
        Ok(100)
    }

    fn seek(&mut self, seconds: f64) -> Result<f64, crate::source::SourceError> {
        Ok(seconds)
    }
}

#[test]
fn unmeasurable_tracks_have_no_shape() {
    let shared = Latest::<State>::default();
    let limit = limits::SHAPE_SECONDS_MAX;
    for (id, duration) in [None, Some(limit + 1.0), Some(f64::NAN), Some(0.0)].into_iter().enumerate() {
        assert_eq!(measure(id as u64, &mut Endless { duration }, &shared), None);
        assert_eq!(shared.lock().of(id as u64), None);
    }
}

#[test]
fn a_track_that_claims_an_end_is_measured_to_this_end_unless_another_is_requested() {
    let shared = Latest::<State>::default();
    measure(1, &mut Endless { duration: Some(1.0) }, &shared).expect("a shape");
    let shape = shared.lock().of(1).expect("a shape");
    assert_eq!(shape.levels.len(), shape.parts);
    shared.lock().wanted = Some(Track::silence(0, 1).info);
    assert_eq!(measure(2, &mut Endless { duration: Some(limits::SHAPE_SECONDS_MAX) }, &shared), None);
    assert_eq!(shared.lock().of(2), None);
}
