//! Texts of show files, from the text to the frame of a moment.

use std::path::PathBuf;
use std::sync::LazyLock;

use mariana::frame::held_inputs::HeldInputs;
use mariana::frame::orbit_controls::OrbitControls;
use mariana::frame::{Frame, Staging};
use mariana::scenes::{ReadyScene, SceneSource, camera_number};
use mariana::show::{Moment, Plan, Programme, Stay};
use mariana_music::{Section, SongBeat, SongStructure, Sound, Stretch};

use super::bytes::Bytes;

/// The name and the text of a scene with parameters and two cameras.
const SCENE: &str = "ball.scene";
const SCENE_TEXT: &str = "param size = 1 in 0.2 .. 2\nparam grain = 0.5 in 0 .. 1\n\
    object ball { shape = sphere(p, size) }\ncamera { position = vec3(0, 2, -6)  target = vec3(0) }\n\
    camera near { position = vec3(1, 1, -3)  target = vec3(0) }\n";

/// A folder with this scene, one without names and one with a mistake.
static SCENES: LazyLock<(tempfile::TempDir, ReadyScene)> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [(SCENE, SCENE_TEXT), ("bare.scene", "length(p) - 1"), ("bad.scene", "lngth(p)")] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let ready = SceneSource::File(folder.path().join(SCENE)).ready().unwrap();
    (folder, ready)
});

/// Songs: one without any structure, and one with beats, sections, a build and a drop.
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

/// A show or its mistakes; from a show a plan that has something to draw at every moment. The first byte chooses a song.
pub(crate) fn shows(data: &[u8]) {
    let mut bytes = Bytes(data);
    let song = song(bytes.below(2));
    let text = String::from_utf8_lossy(bytes.0);
    let (folder, _) = &*SCENES;
    let programme = match Programme::of_text("fuzz.show", &text, folder.path(), &song) {
        Ok((programme, told)) => {
            assert!(told.is_none_or(|told| told.contains("fuzz.show:")));
            programme
        }
        Err(error) => return assert!(error.to_string().len() > 20, "{error}"),
    };
    let cues = programme.cues().len();
    match programme.plan() {
        Some(plan) => check(&programme, plan),
        None => assert!(cues > 0, "an empty plan without cues"),
    }
    let pressed: Vec<f64> = (0..cues).map(|number| 5.0 * number as f64).collect();
    let with_cues = programme.with_cues(&song, &pressed);
    check(&with_cues, with_cues.plan().unwrap());
    // The printed show can be read again.
    let again = Programme::of_text("again.show", &programme.text(&[]), folder.path(), &song);
    assert!(again.is_ok(), "{:?}", again.err());
}

/// Most stays of which each is looked at.
const STAYS_MAX: usize = 50;

fn check(programme: &Programme, plan: &Plan) {
    let starts = plan.stays().iter().take(STAYS_MAX).map(|stay| stay.start);
    let around = starts.flat_map(|start| [start - 0.01, start, start + 0.01, start + 1.7]);
    for time in around.chain([f64::NEG_INFINITY, 0.0, 64.5, 1e12, f64::NAN]) {
        let Moment { index, stay, leaving } = plan.at(time);
        assert_eq!(plan.stays().get(index), Some(stay));
        if time.is_nan() {
            continue;
        }
        draw(programme, stay, time);
        if let Some((from, share)) = leaving {
            assert!(share > 0.0 && share < 1.0, "{share}");
            draw(programme, from, time);
            let blend = stay.entrance.kind.blend().map(|kind| programme.blend(from, stay, kind));
            assert!(blend.is_none_or(|blend| blend.is_some()));
        }
        let picture = plan.picture_at(time);
        assert!((0.0..=1.0).contains(&picture.brightness), "{picture:?}");
        assert!(plan.held_at(time).iter().all(|held| held.share > 0.0 && held.share <= 1.0));
    }
}

/// Computes a picture as far as no driver is needed.
fn draw(programme: &Programme, stay: &Stay, time: f64) {
    let (folder, ready) = &*SCENES;
    let source = programme.source(&stay.scene).unwrap();
    let turns = stay.turns_at(time);
    assert!(turns.iter().all(|turn| turn.is_finite()), "{turns:?}");
    if *source != SceneSource::File(PathBuf::from(folder.path()).join(SCENE)) {
        return;
    }
    let world = &ready.world;
    let params = stay.numbers_at(&world.scene, time, |param| param.default);
    assert!(params.iter().all(|value| value.is_finite()), "{params:?}");
    let camera = camera_number(world, stay.camera.as_deref());
    assert_eq!(camera.is_some(), stay.camera.is_some());
    let held = HeldInputs::default();
    let staging = Staging { params: &params, held: &held, camera };
    let time = if time.is_finite() { time } else { 0.0 };
    let frame = Frame::staged(world, time, Sound::default(), (32, 18), &staging);
    let frame = frame.by_hand(world, OrbitControls::of_turns(turns));
    assert!(frame.camera.position.is_finite(), "{turns:?}: {:?}", frame.camera);
}
