//! Tests of loudness shapes of tracks with known loudness.

use super::*;
use crate::playlist::Cut;
use crate::song::Song;
use crate::track::Content;
use mariana_testing::wave::write_wav;

fn measured(source: &mut dyn FrameSource) -> Option<LoudnessShape> {
    LoudnessShape::measure(source, &|| true, &|_| ()).expect("nothing stops it")
}

/// Measures a part of a file whose four seconds have different levels.
fn steps(cut: Option<Cut>) -> LoudnessShape {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("steps.wav");
    let levels = [0.0, 0.1, 1.0, 0.1_f32.sqrt()];
    write_wav(
        &path,
        48_000,
        1,
        (0..4 * 48_000).map(|n| if n % 2 == 0 { levels[n / 48_000] } else { -levels[n / 48_000] }),
    );
    let content = Content { song: Song::File(path), cut };
    measured(&mut *content.open().unwrap()).expect("a shape")
}

#[test]
fn ten_decibels_more_are_twice_as_loud() {
    let shape = steps(None);
    assert_eq!(shape.levels.len(), PARTS);
    for (part, wanted) in [(75, 0.0), (225, 0.25), (375, 1.0), (525, 0.5)] {
        assert!((shape.levels[part] - wanted).abs() < 0.01, "part {part} is {}", shape.levels[part]);
    }
}

#[test]
fn a_part_of_a_file_has_the_shape_of_that_part() {
    let [first, second] = [(0, Some(150)), (150, None)].map(|(start, end)| steps(Some(Cut { start, end })));
    assert!((first.levels[PARTS - 9] - 1.0).abs() < 0.01);
    assert!((second.levels[9] - 1.0).abs() < 0.01 && (second.levels[PARTS - 9] - 0.5).abs() < 0.01);
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
    let limit = limits::SHAPE_SECONDS_MAX;
    for duration in [None, Some(limit + 1.0), Some(f64::NAN), Some(0.0)] {
        assert_eq!(measured(&mut Endless { duration }), None);
    }
}

#[test]
fn a_track_that_claims_an_end_is_measured_to_this_end_unless_another_is_requested() {
    let shape = measured(&mut Endless { duration: Some(1.0) }).expect("a shape");
    assert_eq!(shape.levels.len(), shape.parts);
    let blocks = std::cell::Cell::new(0);
    let go_on = || blocks.replace(blocks.get() + 1) < 9;
    let mut long = Endless { duration: Some(limits::SHAPE_SECONDS_MAX) };
    assert_eq!(LoudnessShape::measure(&mut long, &go_on, &|_| panic!("no part is measured")), None);
}

#[test]
fn the_beginning_of_a_shape_is_published() {
    let lengths = std::cell::RefCell::new(Vec::new());
    let publish = |shape: LoudnessShape| lengths.borrow_mut().push(shape.levels.len());
    LoudnessShape::measure(&mut Endless { duration: Some(60.0) }, &|| true, &publish);
    let lengths = lengths.into_inner();
    assert!(
        lengths.len() > 9 && lengths.is_sorted() && lengths.iter().all(|one| *one < PARTS),
        "{lengths:?}"
    );
}
