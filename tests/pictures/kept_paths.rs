//! Stills by paths of light that are interrupted, and continued by the same request.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::cell::RefCell;
use std::path::PathBuf;
use std::rc::Rc;
use std::time::Duration;

use mariana::config::SdfChoice;
use mariana::demo_track::DEMO_TRACK;
use mariana::export::output::Output;
use mariana::export::painter::SceneChoice;
use mariana::export::paths::{PathChoice, PathWatch};
use mariana::export::shutter::Shutter;
use mariana::export::still::{StillRequest, write_still};
use mariana::frame::held_inputs::Setting;
use mariana::scenes::SceneSource;
use tempfile::TempDir;

/// A shiny ball that moves above a floor, before a wall that glows with the sound.
const SCENE: &str = "material paint { color = vec3(0.7, 0.3, 0.2)  roughness = 0.3 }\n\
     material lit { color = 0  emission = vec3(0.4, 0.6, 1) * (1 + volume.x) }\n\
     object ball { shape = sphere(p - vec3(sin(3 * t), 0, 0), 0.8)  material = paint }\n\
     object floor { shape = p.y + 0.8  material = paint }\n\
     object wall { shape = 3 - p.z  material = lit }\n\
     camera { position = vec3(0, 0.5, -3)  target = vec3(0) }\n";

/// The paths are saved only when a still is interrupted.
const NEVER: Duration = Duration::MAX;

/// A folder for a still, its paths and its scene.
struct Place(TempDir);

impl Place {
    fn new() -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        std::fs::write(place.path("a.scene"), SCENE).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The file of the paths of an exposure.
    fn piece(&self, number: u32) -> PathBuf {
        self.path(&format!("still.png.pieces/{number:08}.paths"))
    }

    /// Two exposures of a moment, whose pixels need different numbers of paths.
    fn request(&self) -> StillRequest {
        let scene = SceneSource::File(self.path("a.scene"));
        let paths = Some(PathChoice { samples: 96, noise: 0.05, is_filtered: true });
        StillRequest {
            song: DEMO_TRACK,
            at: 1.0,
            size: (40, 24),
            gain: Default::default(),
            output: Output::Path(self.path("still.png")),
            scene: SceneChoice { paths, sdf: SdfChoice::Interpreted, ..SceneChoice::from(scene) },
            show: None,
            blend: None,
            set: Vec::new(),
            ray: None,
            shutter: Shutter { degrees: 180.0, exposures: 2 },
        }
    }

    /// Draws a still, which ends early when `look` returns false. `look` receives the number of each look at the paths.
    fn draw(
        &self,
        request: &StillRequest,
        save_every: Duration,
        look: impl Fn(usize) -> bool + 'static,
    ) -> Drawn {
        let paths = Rc::new(RefCell::new(Vec::new()));
        let seen = paths.clone();
        let reach = Box::new(move |so_far| {
            seen.borrow_mut().push(so_far);
            look(seen.borrow().len())
        });
        write_still(request, PathWatch { reach, save_every }).unwrap();
        Drawn { still: std::fs::read(self.path("still.png")).unwrap(), paths: paths.take() }
    }

    fn whole(&self, request: &StillRequest) -> Drawn {
        self.draw(request, NEVER, |_| true)
    }

    /// Fails unless a still is drawn as if there were no paths of earlier runs, and leaves none.
    #[track_caller]
    fn assert_starts_anew(&self, request: &StillRequest, wanted: &Drawn, what: &str) {
        assert!(*wanted == self.whole(request), "{what}: the still does not start anew");
        assert!(!self.path("still.png.pieces").exists(), "{what}: paths of a finished still");
    }
}

/// A still, and the number of paths at each look.
#[derive(PartialEq)]
struct Drawn {
    still: Vec<u8>,
    paths: Vec<f64>,
}

#[test]
fn a_still_that_was_interrupted_twice_has_the_bytes_of_another_one() {
    let place = Place::new();
    let request = place.request();
    let whole = place.whole(&request);
    let looks = whole.paths.len();
    assert!(!place.path("still.png.pieces").exists() && looks > 12, "{looks}");

    let begun = place.draw(&request, NEVER, |look| look < 3);
    assert!(begun.still != whole.still && place.piece(0).exists() && !place.piece(1).exists());
    let again = place.draw(&request, NEVER, |look| look < 2);
    assert_eq!(again.paths[..2], whole.paths[3..5]);
    let continued = place.whole(&request);
    assert_eq!(continued.paths, whole.paths[5..]);
    assert!(continued.still == whole.still, "the still differs");
    assert!(!place.path("still.png.pieces").exists());

    // The second exposure is interrupted; the first one is kept as it ended.
    place.draw(&request, Duration::ZERO, move |look| look < looks - 1);
    assert!(place.piece(0).exists() && place.piece(1).exists());
    let continued = place.whole(&request);
    assert!(continued.paths.len() <= 3, "{:?}", continued.paths);
    assert!(continued.still == whole.still, "the still with a finished exposure differs");
}

#[test]
fn a_still_continues_from_the_files_that_a_killed_process_leaves() {
    let place = Place::new();
    let request = place.request();
    let whole = place.whole(&request);
    // At the fifth look, the paths of the fourth one are in the file.
    let (pieces, copy) = (place.piece(0), place.path("copy"));
    let kept = copy.clone();
    place.draw(&request, Duration::ZERO, move |look| {
        if look == 5 {
            std::fs::copy(&pieces, &kept).unwrap();
        }
        true
    });
    std::fs::create_dir(place.path("still.png.pieces")).unwrap();
    std::fs::rename(copy, place.piece(0)).unwrap();
    let continued = place.whole(&request);
    assert_eq!(continued.paths, whole.paths[4..]);
    assert!(continued.still == whole.still, "the still differs");
}

#[test]
fn a_still_continues_with_more_paths_and_less_noise() {
    let place = Place::new();
    let with = |samples, noise| {
        let mut request = place.request();
        request.shutter = Shutter::MOMENT;
        request.scene.paths = Some(PathChoice { samples, noise, is_filtered: true });
        request
    };
    let more = with(64, 0.0);
    let whole = place.whole(&more);
    // Some pixels are finished, and the others are within a path.
    place.draw(&with(12, 0.0), NEVER, |look| look < 3);
    let continued = place.whole(&more);
    assert!(continued.paths.len() < whole.paths.len());
    assert!(continued.still == whole.still, "the still with more paths differs");

    place.draw(&with(64, 0.3), NEVER, |look| look < 4);
    let (continued, precise) = (place.whole(&with(64, 0.01)), place.whole(&with(64, 0.01)));
    let last = |drawn: &Drawn| *drawn.paths.last().unwrap();
    assert!(continued.paths.len() < precise.paths.len());
    assert!((0.98..1.1).contains(&(last(&continued) / last(&precise))), "{:?}", continued.paths);

    // Fewer paths would leave pixels with too many.
    for (samples, noise) in [(63, 0.0), (64, 0.3)] {
        let wanted = place.whole(&with(samples, noise));
        place.draw(&more, NEVER, |look| look < 3);
        place.assert_starts_anew(&with(samples, noise), &wanted, &format!("{samples}, {noise}"));
    }
}

#[test]
fn paths_of_another_image_are_not_used() {
    let place = Place::new();
    let request = place.request();
    let begin = || place.draw(&request, NEVER, |look| look < 4);
    type Change = fn(&mut StillRequest);
    let changes: [(&str, Change); 6] = [
        ("size", |request| request.size = (24, 40)),
        ("moment", |request| request.at = 1.01),
        ("setting", |request| {
            request.set = vec![Setting { name: "volume.x".into(), value: 0.9 }];
        }),
        ("mode", |request| request.scene.sdf = SdfChoice::Compiled),
        ("exposures", |request| request.shutter.exposures = 3),
        ("shutter", |request| request.shutter.degrees = 90.0),
    ];
    for (what, change) in changes {
        let mut other = place.request();
        change(&mut other);
        let wanted = place.whole(&other);
        begin();
        place.assert_starts_anew(&other, &wanted, what);
    }
    begin();
    std::fs::write(place.path("a.scene"), SCENE.replace("0.3, 0.2", "0.3, 0.3")).unwrap();
    let kept = std::fs::read(place.piece(0)).unwrap();
    std::fs::remove_file(place.piece(0)).unwrap();
    let wanted = place.whole(&request);
    std::fs::create_dir_all(place.path("still.png.pieces")).unwrap();
    std::fs::write(place.piece(0), &kept).unwrap();
    place.assert_starts_anew(&request, &wanted, "scene");
}

#[test]
fn damaged_paths_are_not_used() {
    let place = Place::new();
    let request = place.request();
    let wanted = place.whole(&request);
    place.draw(&request, NEVER, |look| look < 4);
    let good = std::fs::read(place.piece(0)).unwrap();
    let text = String::from_utf8_lossy(&good);
    let mut flipped = good.clone();
    flipped[good.len() / 2] ^= 1;
    let mut lengths = vec![0, 5, 100, good.len() / 2, good.len() - 9, good.len() - 1];
    lengths.push(text.find('\n').unwrap());
    let mut damaged: Vec<_> = lengths.into_iter().map(|length| good[..length].to_vec()).collect();
    damaged.push(flipped);
    damaged.push([&good[..], b"more"].concat());
    damaged.push(vec![0xa7; 200_000]);
    damaged.push(b"mariana paths {}\n".to_vec());
    for bytes in damaged {
        std::fs::create_dir_all(place.path("still.png.pieces")).unwrap();
        std::fs::write(place.piece(0), &bytes).unwrap();
        place.assert_starts_anew(&request, &wanted, &format!("{} bytes", bytes.len()));
    }
    // The unchanged file is used, so that the test can fail.
    std::fs::create_dir_all(place.path("still.png.pieces")).unwrap();
    std::fs::write(place.piece(0), &good).unwrap();
    assert!(place.whole(&request).paths.len() < wanted.paths.len());
}

#[test]
fn files_of_the_user_in_the_place_of_paths_stay() {
    let place = Place::new();
    let request = place.request();
    let pieces = place.path("still.png.pieces");
    std::fs::write(&pieces, "a file").unwrap();
    let begun = place.draw(&request, Duration::ZERO, |look| look < 4);
    assert_eq!(std::fs::read(&pieces).unwrap(), b"a file");
    assert!(image::load_from_memory(&begun.still).is_ok());

    std::fs::remove_file(&pieces).unwrap();
    std::fs::create_dir(&pieces).unwrap();
    std::fs::write(pieces.join("notes.txt"), "mine").unwrap();
    place.draw(&request, Duration::ZERO, |_| true);
    let names: Vec<_> = std::fs::read_dir(&pieces).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(names, ["notes.txt"]);
}
