//! Strobing scenes with and without the flash limiter. The tests count flashes in the images by WCAG's definition.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::compare::pixel_difference;
use crate::support::program::Workplace;
use crate::support::test_renderer::TestRenderer;
use image::RgbaImage;
use mariana::flash::COLUMNS;
use mariana::gpu::renderer::Counting;
use mariana::gpu::scene_program::Mode;
use mariana::gpu::shader_source::ShaderLibrary;
use mariana::scenes::SceneSource;
use mariana_flash_twin::{Analyser, Flashes, Grid};
use mariana_music::Features;

/// The size is small, because the tests run without a graphics card. It is not a multiple of the limiter's cells.
const SIZE: (u32, u32) = (100, 75);
const FPS: f64 = 60.0;

fn wall(emission: &str) -> String {
    format!(
        "material paint {{ color = 0  roughness = 1  emission = {emission} }}\n\
         object wall {{ shape = 5 - p.z  material = paint }}\n\
         light none {{ direction = vec3(0, -1, 0)  color = 0 }}\n\
         camera {{ position = vec3(0)  target = vec3(0, 0, 5) }}\n\
         sky {{ color = 0  ambient = 0 }}\n"
    )
}

const BLINKS: &str = "step(0.5, fract(t))";

struct Strobe {
    _place: Workplace,
    test_renderer: TestRenderer,
    size: (u32, u32),
}

impl Strobe {
    fn of(emission: &str) -> Self {
        let place = Workplace::new();
        place.write("strobe.scene", wall(emission));
        let scene = SceneSource::File(place.path("strobe.scene"));
        let mut test_renderer = TestRenderer::of(&scene, Mode::Compiled, Counting::Off);
        test_renderer.renderer.add_flash_limiter(&ShaderLibrary::embedded()).unwrap();
        Self { _place: place, test_renderer, size: SIZE }
    }

    /// Shows the scene for some seconds, with the features `sound(time)`. The scene's time runs `speed` times as fast.
    /// Passes each frame to `see` twice: as drawn, and as shown after the limiter.
    fn show(
        &mut self,
        seconds: f64,
        speed: f64,
        sound: impl Fn(f64) -> Features,
        mut see: impl FnMut(f64, RgbaImage, RgbaImage),
    ) {
        for frame in 0..(seconds * FPS) as usize {
            let time = frame as f64 / FPS;
            // The small offset avoids the exact time of a change.
            let drawn = self.test_renderer.picture((time + 1e-4) * speed, sound(time), self.size);
            self.test_renderer.renderer.limit_flashes(1.0 / FPS).unwrap();
            let shown =
                RgbaImage::from_raw(self.size.0, self.size.1, self.test_renderer.renderer.read()).unwrap();
            see(time, drawn, shown);
        }
    }

    /// Counts the flashes in two and a half seconds without and with the limiter. Also returns the number of frames
    /// that the limiter changed.
    fn count(&mut self, speed: f64, sound: impl Fn(f64) -> Features) -> (Flashes, Flashes, usize) {
        let (mut without, mut with, mut changed) = (Analyser::default(), Analyser::default(), 0);
        let size = self.size;
        self.show(2.5, speed, sound, |time, drawn, shown| {
            without.add(time, &Grid::of_picture(&drawn, size));
            with.add(time, &Grid::of_picture(&shown, size));
            changed += usize::from(drawn != shown);
        });
        (without.worst(), with.worst(), changed)
    }
}

fn silence(_: f64) -> Features {
    Features::SILENCE
}

#[test]
fn strobes_of_the_whole_picture_keep_three_flashes_a_second() {
    let mut strobe = Strobe::of(&format!("6 * {BLINKS}"));
    for hz in [4.0, 7.3, 15.0, 30.0] {
        let (without, with, changed) = strobe.count(hz, silence);
        assert!(without.general > 3, "{hz} Hz is not a strobe: {without:?}");
        assert!(with.general <= 3 && changed > 0, "{hz} Hz: {with:?}");
    }
}

#[test]
fn red_strobes_keep_three_flashes_a_second_of_either_kind() {
    let mut strobe = Strobe::of(&format!("vec3(1.5, 0, 0) * {BLINKS}"));
    for hz in [5.0, 12.0] {
        let (without, with, _) = strobe.count(hz, silence);
        assert!(without.red > 3, "{hz} Hz is not a red strobe: {without:?}");
        assert!(with.red <= 3 && with.general <= 3, "{hz} Hz: {with:?}");
    }
}

#[test]
fn a_beat_that_strobes_is_limited_and_a_usual_one_is_not() {
    // In these frames, bright and dark parts side by side flash together.
    let mut strobe = Strobe::of(
        "(0.05 + 4 * beat) * (0.3 + 0.7 * step(0.5, fract(0.8 * p.x + 0.1))) * (0.6 + 0.4 * sin(2 * p.y))",
    );
    let beats = |hz: f64| {
        move |time: f64| Features {
            beat: (1.0 - 3.0 * (time * hz).fract()).max(0.0) as f32,
            ..Features::SILENCE
        }
    };
    for hz in [5.0, 8.0] {
        let (without, with, _) = strobe.count(1.0, beats(hz));
        assert!(without.general > 3, "{hz} Hz: {without:?}");
        assert!(with.general <= 3, "{hz} Hz: {with:?}");
    }
    // Start a new scene, because the limiter's old state would still dim the first frames.
    let (mut strobe, mut changed) = (Strobe::of("0.05 + 4 * beat"), 0);
    strobe.show(3.0, 1.0, beats(174.0 / 60.0), |_, drawn, shown| changed += usize::from(drawn != shown));
    assert_eq!(changed, 0, "a beat of 174 per minute is limited");
}

#[test]
fn a_small_lamp_and_three_flashes_a_second_are_not_limited() {
    let mut lamp = Strobe::of(&format!("6 * {BLINKS} * step(length(p.xy - vec2(0.5, 0.3)), 0.25)"));
    let (_, _, changed) = lamp.count(12.0, silence);
    assert_eq!(changed, 0, "the lamp is limited");
    let mut whole = Strobe::of(&format!("6 * {BLINKS}"));
    let (without, with, changed) = whole.count(3.0, silence);
    assert_eq!((without.general, with.general, changed), (3, 3, 0));
}

#[test]
fn steady_parts_stay_steady_near_flashes_and_unchanged_far_away() {
    let mut strobe = Strobe::of(&format!("if p.x < 0 then 6 * {BLINKS} else 0.5 + 0.3 * sin(9 * p.y)"));
    let (mut limited, mut with) = (0, Analyser::default());
    let mut last: Option<(RgbaImage, RgbaImage)> = None;
    // Columns from `near` on are right of the cells that contain both parts. Columns beyond `far` are too far from the
    // flashes to change.
    let (near, far) = (SIZE.0 / 2 + 2, SIZE.0 / 2 + 9 * SIZE.0 / COLUMNS as u32);
    strobe.show(2.0, 10.0, silence, |time, drawn, shown| {
        with.add(time, &Grid::of_picture(&shown, SIZE));
        limited += usize::from(drawn != shown);
        for (x, y, pixel) in shown.enumerate_pixels().filter(|(x, ..)| *x > far) {
            assert_eq!(pixel, drawn.get_pixel(x, y), "at {x}, {y}, {time} s");
        }
        // Once the limiter dims flashes, the steady part changes no more than it does without the limiter.
        let Some((drawn_last, last)) = last.replace((drawn.clone(), shown.clone())).filter(|_| time > 1.3)
        else {
            return;
        };
        for (x, y, pixel) in shown.enumerate_pixels().filter(|(x, ..)| *x > near) {
            let of_scene = pixel_difference(drawn.get_pixel(x, y), drawn_last.get_pixel(x, y));
            let apart = pixel_difference(pixel, last.get_pixel(x, y));
            assert!(apart <= of_scene + 3, "{apart} at {x}, {y}, {time} s");
        }
    });
    assert!(limited > 30 && with.worst().general <= 3, "{limited}, {:?}", with.worst());
}

#[test]
fn frames_of_any_shape_are_limited() {
    let mut strobe = Strobe::of(&format!("6 * {BLINKS}"));
    for size in [(1, 1), (16_384, 1), (1, 700), (47, 35)] {
        strobe.size = size;
        let (without, with, _) = strobe.count(10.0, silence);
        assert!(without.general > 3 && with.general <= 3, "{size:?}: {without:?}, {with:?}");
    }
}

fn flashes_in(place: &Workplace, folder: &str, fps: f64) -> Flashes {
    let mut names: Vec<_> =
        std::fs::read_dir(place.path(folder)).unwrap().map(|entry| entry.unwrap().path()).collect();
    names.sort();
    assert_eq!(names.len(), 60, "{folder}");
    let mut analyser = Analyser::default();
    for (frame, name) in names.iter().enumerate() {
        let picture = image::open(name).unwrap().to_rgba8();
        analyser.add(frame as f64 / fps, &Grid::of_picture(&picture, picture.dimensions()));
    }
    analyser.worst()
}

#[test]
fn videos_are_limited_unless_it_is_turned_off() {
    let place = Workplace::new();
    place.write("strobe.scene", wall("6 * step(0.5, fract(6 * t + 0.01))"));
    let arguments = ["video", "--scene", "strobe.scene", "--duration", "2", "--fps", "30", "--size", "64x36"];
    place.run(&[&arguments[..], &["-o", "on/"]].concat()).done();
    place.run(&[&arguments[..], &["--flash-limiter", "off", "-o", "off/"]].concat()).done();
    let (on, off) = (flashes_in(&place, "on", 30.0), flashes_in(&place, "off", 30.0));
    assert!(on.general <= 3 && off.general > 3, "{on:?} with the limiter, {off:?} without");
}
