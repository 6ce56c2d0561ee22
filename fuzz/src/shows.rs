//! Show files, from the text to the frame at a moment.

use std::path::PathBuf;
use std::sync::LazyLock;

use mariana::frame::held_inputs::HeldInputs;
use mariana::frame::orbit_controls::OrbitControls;
use mariana::frame::{Frame, FrameOptions};
use mariana::scenes::{ReadyScene, SceneSource, camera_number};
use mariana::show::{Clip, Moment, PreparedShow, Timeline};
use mariana_music::{Section, SongBeat, SongStructure, Sound, Stretch};

use super::bytes::Bytes;

/// A scene with parameters and two cameras.
const SCENE: &str = "ball.scene";
const SCENE_TEXT: &str = "param size = 1 in 0.2 .. 2\nparam grain = 0.5 in 0 .. 1\n\
    object ball { shape = sphere(p, size) }\ncamera { position = vec3(0, 2, -6)  target = vec3(0) }\n\
    camera near { position = vec3(1, 1, -3)  target = vec3(0) }\n";

/// A folder with this scene, a scene without parameters, and a scene with a mistake.
static SCENES: LazyLock<(tempfile::TempDir, ReadyScene)> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [(SCENE, SCENE_TEXT), ("bare.scene", "length(p) - 1"), ("bad.scene", "lngth(p)")] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let ready = SceneSource::File(folder.path().join(SCENE)).ready().unwrap();
    (folder, ready)
});

/// Returns a song without structure, or a song with beats, sections, a build and a drop.
fn song(number: usize) -> SongStructure {
    if number == 0 {
        return SongStructure { seconds: 7.0, ..SongStructure::default() };
    }
    let beat = |index: usize| SongBeat {
        time: 0.5 + 0.5 * index as f64,
        of_bar: (index % 4) as u8 + 1,
        tempo: 120.0,
    };
    let section =
        |letter: &str, start, end, energy| Section { start, end, letter: letter.to_owned(), energy };
    SongStructure {
        seconds: 64.5,
        tempo: Some(120.0),
        beats: (0..128).map(beat).collect(),
        sections: vec![
            section("A", 0.0, 16.5, 0.2),
            section("B", 16.5, 32.5, 0.5),
            section("B", 32.5, 48.5, 0.9),
            section("A", 48.5, 64.5, 0.3),
        ],
        builds: vec![Stretch { start: 24.5, end: 32.5 }],
        drops: vec![32.5],
        ..SongStructure::default()
    }
}

/// Parses a show. A valid show must have a clip to draw at every moment. The first byte selects the song.
pub(crate) fn shows(data: &[u8]) {
    let mut bytes = Bytes(data);
    let song = song(bytes.below(2));
    let text = String::from_utf8_lossy(bytes.0);
    let (folder, _) = &*SCENES;
    let prepared_show = match PreparedShow::of_text("fuzz.show", &text, folder.path(), &song) {
        Ok((prepared_show, reported)) => {
            assert!(reported.is_none_or(|reported| reported.contains("fuzz.show:")));
            prepared_show
        }
        Err(error) => return assert!(error.to_string().len() > 20, "{error}"),
    };
    let cues = prepared_show.cues().len();
    match prepared_show.timeline() {
        Some(timeline) => check(&prepared_show, timeline),
        None => assert!(cues > 0, "there is no timeline and no cue"),
    }
    let pressed: Vec<f64> = (0..cues).map(|number| 5.0 * number as f64).collect();
    let with_cues = prepared_show.with_cues(&song, &pressed);
    check(&with_cues, with_cues.timeline().unwrap());
    // The printed show must be valid.
    let again = PreparedShow::of_text("again.show", &prepared_show.text(&[]), folder.path(), &song);
    assert!(again.is_ok(), "{:?}", again.err());
}

const CLIPS_MAX: usize = 50;

fn check(prepared_show: &PreparedShow, timeline: &Timeline) {
    let starts = timeline.clips().iter().take(CLIPS_MAX).map(|clip| clip.start);
    let around = starts.flat_map(|start| [start - 0.01, start, start + 0.01, start + 1.7]);
    for time in around.chain([f64::NEG_INFINITY, 0.0, 64.5, 1e12, f64::NAN]) {
        let Moment { index, clip, leaving } = timeline.at(time);
        assert_eq!(timeline.clips().get(index), Some(clip));
        if time.is_nan() {
            continue;
        }
        draw(prepared_show, clip, time);
        if let Some((from, fraction)) = leaving {
            assert!(fraction > 0.0 && fraction < 1.0, "{fraction}");
            draw(prepared_show, from, time);
            let blend = clip.transition.kind.blend().map(|kind| prepared_show.blend(from, clip, kind));
            assert!(blend.is_none_or(|blend| blend.is_some()));
        }
        let picture = timeline.picture_at(time);
        assert!((0.0..=1.0).contains(&picture.brightness), "{picture:?}");
        assert!(timeline.held_at(time).iter().all(|held| held.fraction > 0.0 && held.fraction <= 1.0));
    }
}

/// Computes everything about a frame that needs no driver.
fn draw(prepared_show: &PreparedShow, clip: &Clip, time: f64) {
    let (folder, ready) = &*SCENES;
    let source = prepared_show.source(&clip.scene).unwrap();
    let turns = clip.turns_at(time);
    assert!(turns.iter().all(|turn| turn.is_finite()), "{turns:?}");
    if *source != SceneSource::File(PathBuf::from(folder.path()).join(SCENE)) {
        return;
    }
    let world = &ready.world;
    let params = clip.numbers_at(&world.scene, time, |param| param.default);
    assert!(params.iter().all(|value| value.is_finite()), "{params:?}");
    let camera = camera_number(world, clip.camera.as_deref());
    assert_eq!(camera.is_some(), clip.camera.is_some());
    let held = HeldInputs::default();
    let frame_options = FrameOptions { params: &params, held: &held, camera };
    let time = if time.is_finite() { time } else { 0.0 };
    let frame = Frame::staged(world, time, Sound::default(), (32, 18), &frame_options);
    let frame = frame.by_hand(world, OrbitControls::of_turns(turns));
    assert!(frame.camera.position.is_finite(), "{turns:?}: {:?}", frame.camera);
}
