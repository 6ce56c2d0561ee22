//! Feedback: trails, and the last frame in formulas.

use mariana::config::SdfChoice;
use mariana::export::SceneChoice;
use mariana::export::show_painter::ShowPainter;
use mariana::frame::projection::{Projection, ProjectionKind, Stereo};
use mariana::scenes::SceneSource;
use mariana_music::Features;

const SIZE: (u32, u32) = (48, 27);

/// A bright ball that moves over a dim sky.
const BALL: &str = "let q = (pixel - resolution / 2) / resolution.y\n\
     let ball = vec3(4, 2, 1) * smoothstep(0.12, 0.05, length(q - 0.3 * vec2(cos(9 * t), sin(7 * t))))\n";

fn trails() -> String {
    let warp = "warp = (pixel / resolution - 0.5) * (0.97 + 0.01 * sin(t)) + 0.5";
    format!("{BALL}sky {{ color = ball + vec3(0.01) }}\npicture {{ decay = 0.8  blur = 0.004  {warp} }}")
}

fn formula() -> String {
    let last = "previous((pixel / resolution - 0.5) * 0.97 + 0.5)";
    format!("{BALL}sky {{ color = max(ball, vec3(0.7, 0.8, 0.9) * {last}) }}\npicture {{ memory = 0.5 }}")
}

fn painter(folder: &tempfile::TempDir, text: &str, sdf: SdfChoice) -> ShowPainter {
    let path = folder.path().join("own.scene");
    std::fs::write(&path, text).unwrap_or_else(|error| panic!("{error}"));
    let choice = SceneChoice { sdf, ..SceneChoice::from(SceneSource::File(path)) };
    let ready = choice.source.ready().unwrap_or_else(|error| panic!("{error}\n{text}"));
    ShowPainter::of_scene(&choice, ready, &[]).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn drawn(painter: &mut ShowPainter, time: f64) -> Vec<u8> {
    let heard = vec![(time, Features::SILENCE.into())];
    painter.draw(time, heard, Vec::new(), SIZE).unwrap_or_else(|error| panic!("at {time} s: {error}"));
    painter.read()
}

fn still(text: &str, sdf: SdfChoice, time: f64) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap_or_else(|error| panic!("{error}"));
    drawn(&mut painter(&folder, text, sdf), time)
}

/// The number of pixels whose colours differ by more than `step` of 255.
fn differing(one: &[u8], other: &[u8], step: u8) -> usize {
    let pairs = one.chunks(4).zip(other.chunks(4));
    pairs.filter(|(one, other)| one.iter().zip(*other).any(|(a, b)| a.abs_diff(*b) > step)).count()
}

#[test]
fn a_moment_has_one_image_at_30_60_and_144_frames_a_second() {
    let folder = tempfile::tempdir().unwrap();
    for text in [trails(), formula()] {
        let moments = [1.0 / 6.0, 0.5, 5.0 / 6.0, 7.0 / 6.0, 1.5];
        let mut fresh = painter(&folder, &text, SdfChoice::Compiled);
        // From the last moment back to the first, so that no moment continues the one before it.
        let wanted: Vec<Vec<u8>> = moments.iter().rev().map(|time| drawn(&mut fresh, *time)).collect();
        for rate in [30_u32, 60, 144] {
            let mut played = painter(&folder, &text, SdfChoice::Compiled);
            for frame in 0..=3 * rate / 2 {
                let time = f64::from(frame) / f64::from(rate);
                let picture = drawn(&mut played, time);
                let at = moments.iter().rev().position(|moment| (moment - time).abs() < 1e-9);
                if let Some(wanted) = at.and_then(|at| wanted.get(at)) {
                    assert!(picture == *wanted, "{rate} frames a second, at {time} s:\n{text}");
                }
            }
        }
        let alone = still(
            &text.replace("decay = 0.8", "decay = 0").replace("max(ball", "max(1 * ball"),
            SdfChoice::Compiled,
            0.0,
        );
        assert!(
            wanted.iter().all(|picture| differing(picture, &alone, 8) > 50),
            "there are no trails:\n{text}"
        );
    }
}

#[test]
fn both_modes_feed_back_alike() {
    for text in [trails(), formula()] {
        let [compiled, interpreted] =
            [SdfChoice::Compiled, SdfChoice::Interpreted].map(|sdf| still(&text, sdf, 0.9));
        assert_eq!(differing(&compiled, &interpreted, 4), 0, "{text}");
    }
}

#[test]
fn light_that_grows_is_limited_and_no_number_breaks_an_image() {
    let growing = "sky { color = vec3(0.1, 0, 0) + 1.5 * previous(pixel / resolution) }\npicture { memory = 1  grain = 0 }";
    let picture = still(growing, SdfChoice::Compiled, 1.9);
    let first = &picture[..4];
    assert!(
        first[0] > 200
            && picture.chunks(4).all(|pixel| pixel.iter().zip(first).all(|(a, b)| a.abs_diff(*b) < 3))
    );
    let plain = still(&format!("{BALL}sky {{ color = ball }}"), SdfChoice::Compiled, 0.5);
    let nothing = "exp(999 * t) - exp(998 * t)";
    for picture in [
        format!("decay = {nothing}"),
        "decay = -5".to_owned(),
        format!("decay = 0.9  warp = vec2({nothing})"),
        "decay = 0.9  warp = vec2(exp(999 * t), 0)".to_owned(),
    ] {
        let text = format!("{BALL}sky {{ color = ball }}\npicture {{ {picture} }}");
        assert_eq!(differing(&still(&text, SdfChoice::Compiled, 0.5), &plain, 1), 0, "{picture}");
    }
    let blurred =
        format!("{BALL}sky {{ color = ball }}\npicture {{ decay = 9  blur = 1 / t - 1 / t + 1e30 }}");
    assert!(differing(&still(&blurred, SdfChoice::Compiled, 0.5), &plain, 8) > 20);
}

#[test]
fn a_surface_shows_the_last_frame() {
    let scene = "material screen { color = 0  roughness = 1  emission = 0.9 * previous(pixel_place(p)) + vec3(0, 0.2, 0) }\n\
                 fn pixel_place(p) = vec2(0.5 + p.x / 8, 0.5 + p.y / 4.5)\n\
                 object wall { shape = box(p - vec3(0, 0, 5), vec3(2, 1, 0.1))  material = screen }\n\
                 sky { color = 0  ambient = 0 }\nlight none { direction = vec3(0, -1, 0)  color = 0 }\n\
                 camera { position = vec3(0)  target = vec3(0, 0, 5) }\npicture { memory = 0.2 }";
    let [first, later] = [0.0, 0.5].map(|time| still(scene, SdfChoice::Compiled, time));
    let middle = 4 * (13 * SIZE.0 as usize + 24);
    assert!(
        later[middle + 1] > first[middle + 1] + 40,
        "{:?} and {:?}",
        &first[middle..][..4],
        &later[middle..][..4]
    );
    let interpreted = still(scene, SdfChoice::Interpreted, 0.5);
    assert!(differing(&interpreted, &later, 6) < 10);
}

/// Draws a scene of pixels at 0.8 s, without effects that depend on other pixels.
fn projected(text: &str, projection: Projection, sdf: SdfChoice, (width, height): (u32, u32)) -> Vec<u8> {
    let text = text
        .replace("picture {", "picture { memory = 0.4  tone_map = none  bloom = 0  grain = 0  vignette = 0 ");
    let choice = SceneChoice { projection, sdf, ..SceneChoice::from(SceneSource::Formula(text)) };
    let ready = choice.source.ready().unwrap_or_else(|error| panic!("{error}"));
    let mut painter = ShowPainter::of_scene(&choice, ready, &[]).unwrap_or_else(|error| panic!("{error}"));
    painter
        .draw(0.8, vec![(0.8, Features::SILENCE.into())], Vec::new(), (width, height))
        .unwrap_or_else(|error| panic!("{projection:?}: {error}"));
    painter.read()
}

#[test]
fn the_last_frame_of_an_eye_is_not_that_of_both_eyes() {
    let steps = "sky { let q = pixel / resolution\n\
                 color = if q.x < 0.2 then vec3(0.6, q) else 0.7 * previous(q - vec2(0.2, 0.1)) }\npicture { }";
    let away = "warp = (pixel / resolution - 0.5) * 0.9 + vec2(0.55, 0.45)";
    let spot = "sky { color = vec3(smoothstep(0.3, 0.1, length(pixel / resolution - vec2(0.6, 0.3)))) }\n";
    let trails = format!("{spot}picture {{ decay = 0.9  blur = 0.02  {away} }}");
    let (width, height) = (24, 14);
    for (text, kind, sdf) in [
        (steps, ProjectionKind::Flat, SdfChoice::Compiled),
        (steps, ProjectionKind::Sphere, SdfChoice::Interpreted),
        (&trails, ProjectionKind::Sphere, SdfChoice::Compiled),
    ] {
        let of = |stereo| Projection { kind, stereo, ..Projection::default() };
        let alone = projected(text, of(Stereo::None), sdf, (width, height));
        for (stereo, columns, rows) in [(Stereo::SideBySide, 2, 1), (Stereo::OverUnder, 1, 2)] {
            let both = projected(text, of(stereo), sdf, (columns * width, rows * height));
            let line = 4 * width as usize;
            let parts = (0..(rows * height) as usize).flat_map(|row| {
                let line_of_both = both[row * columns as usize * line..].chunks(line);
                let own = &alone[row % height as usize * line..][..line];
                line_of_both.take(columns as usize).map(move |part| (part, own))
            });
            // Pixels next to the other eye have more samples.
            let wrong: usize = parts.map(|(part, own)| differing(part, own, 6)).sum();
            assert_eq!(wrong, 0, "{kind:?} {stereo:?}:\n{text}");
        }
    }
}

#[test]
fn trails_do_not_fill_the_square_around_a_dome() {
    let text = "sky { color = vec3(1, 0.5, 0.2) }\n\
                picture { decay = 0.95  warp = (pixel / resolution - 0.5) * 0.8 + 0.5 }";
    for (stereo, eyes) in [(Stereo::None, 1), (Stereo::OverUnder, 2)] {
        let dome = Projection { kind: ProjectionKind::Dome, stereo, ..Projection::default() };
        let picture = projected(text, dome, SdfChoice::Compiled, (24, 24 * eyes));
        for (at, pixel) in picture.chunks(4).enumerate() {
            let [x, y] = [at % 24, at / 24 % 24].map(|at| at as f32 + 0.5 - 12.0);
            let radius = x.hypot(y);
            assert!(radius < 13.0 || pixel[..3] == [0; 3], "{x}, {y}: {pixel:?}");
            assert!(radius > 11.0 || pixel[0] > 200, "{x}, {y}: {pixel:?}");
        }
    }
}
