//! Show files, from the text to the frame at a moment.

use std::path::PathBuf;
use std::sync::LazyLock;

use mariana::frame::held_inputs::HeldInputs;
use mariana::scenes::{ReadyScene, SceneSource};
use mariana::show::{Layer, Moment, PreparedShow, Timeline, source_of};
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
    let find = |name: &str| source_of(name, folder.path());
    let prepared_show = match PreparedShow::of_text("fuzz.show", &text, &song, find) {
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
    let again = PreparedShow::of_text("again.show", &prepared_show.text(&[]), &song, find);
    assert!(again.is_ok(), "{:?}", again.err());
}

const CLIPS_MAX: usize = 50;

fn check(prepared_show: &PreparedShow, timeline: &Timeline) {
    let starts = timeline.clips().iter().take(CLIPS_MAX).map(|clip| clip.start);
    let around = starts.flat_map(|start| [start - 0.01, start, start + 0.01, start + 1.7]);
    for time in around.chain([f64::NEG_INFINITY, 0.0, 64.5, 1e12, f64::NAN]) {
        let Moment { index, clip, .. } = timeline.at(time);
        assert_eq!(timeline.clips().get(index), Some(clip));
        if time.is_nan() {
            continue;
        }
        for can_blend in [false, true] {
            let recipe = prepared_show.recipe(time, time, |_| can_blend).unwrap();
            assert!((0.0..=1.0).contains(&recipe.brightness), "{recipe:?}");
            assert!(recipe.layers.first().is_some_and(|layer| layer.below.is_none()), "{recipe:?}");
            recipe.layers.iter().for_each(draw);
        }
    }
}

/// Computes everything about a scene's frame that needs no driver.
fn draw(layer: &Layer<'_>) {
    assert!(layer.below.is_none_or(|weight| weight > 0.0 && weight <= 1.0), "{layer:?}");
    let (folder, ready) = &*SCENES;
    if layer.source != SceneSource::File(PathBuf::from(folder.path()).join(SCENE)) {
        return;
    }
    let time = if layer.time.is_finite() { layer.time } else { 0.0 };
    let frame = layer.frame(&ready.world, time, Sound::default(), (32, 18), &HeldInputs::default());
    assert!(frame.inputs.params.iter().all(|value| value.is_finite()), "{layer:?}");
    assert!(frame.camera.position.is_finite(), "{layer:?}: {:?}", frame.camera);
}
