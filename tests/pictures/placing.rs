//! The placement of finished images on screens and in other programs: brightness, crop, mirroring and corners. The
//! default placement does not change the image.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::test_renderer::{TestRenderer, silence};
use image::RgbaImage;
use mariana::gpu::picture_reader::PictureReader;
use mariana::gpu::renderer::Counting;
use mariana::gpu::scene_program::Mode;
use mariana::gpu::shader_source::ShaderLibrary;
use mariana::placement::{Corners, Crop, Flip, Placement, WHOLE, fitted, within};
use mariana::scenes::SceneSource;
use mariana::srgb::linear;

const SIZE: (u32, u32) = (64, 36);

struct Hall(TestRenderer);

impl Hall {
    fn new() -> Self {
        Self::of(SceneSource::Shipped("first_steps".into()))
    }

    fn of(scene: SceneSource) -> Self {
        let mut test_renderer = TestRenderer::of(&scene, Mode::Compiled, Counting::Off);
        test_renderer.renderer.prepare_for_window(&ShaderLibrary::embedded()).unwrap();
        test_renderer.renderer.add_flash_limiter(&ShaderLibrary::embedded()).unwrap();
        test_renderer.picture(0.0, silence(), SIZE);
        Self(test_renderer)
    }

    fn sent(&mut self, placement: &Placement, size: (u32, u32)) -> RgbaImage {
        let mut reader = PictureReader::new(self.0.context.gl(), size).unwrap();
        let map = within(fitted(placement.rest_of(SIZE), size), &placement.map());
        assert!(self.0.renderer.send_placed(&mut reader, &map, placement.part()).unwrap());
        assert!(reader.is_waiting());
        self.0.context.gl().finish();
        let bytes = reader.drain().expect("the image has arrived");
        assert!(!reader.is_waiting() && reader.drain().is_none());
        RgbaImage::from_raw(size.0, size.1, bytes).unwrap()
    }

    fn finished(&self) -> RgbaImage {
        RgbaImage::from_raw(SIZE.0, SIZE.1, self.0.renderer.read()).unwrap()
    }

    /// Dims the frame by `gain` and limits flashes, a sixtieth of a second after the previous frame.
    fn dim(&mut self, gain: f32) {
        self.0.renderer.dim(gain).unwrap();
        self.0.renderer.limit_flashes(1.0 / 60.0).unwrap();
    }
}

fn light(picture: &RgbaImage) -> f32 {
    let values = picture.pixels().flat_map(|pixel| [pixel.0[0], pixel.0[1], pixel.0[2]]);
    let light: f32 = values.map(|value| linear(f32::from(value) / 255.0)).sum();
    light / (3 * picture.width() * picture.height()) as f32
}

#[test]
fn an_image_without_changes_keeps_its_bytes() {
    let mut hall = Hall::new();
    let before = hall.finished();
    assert!(hall.sent(&Placement::default(), SIZE) == before, "the sent image differs");
    hall.dim(0.5);
    assert!(hall.finished() != before);
    hall.dim(1.0);
    assert!(hall.finished() == before, "the image differs after the dimming");
    assert!(hall.sent(&Placement::default(), SIZE) == before);
}

#[test]
fn dimming_is_even_and_ends_in_black() {
    let mut hall = Hall::new();
    let full = light(&hall.finished());
    assert!(full > 0.05, "{full} is too dark for this test");
    for gain in [0.75, 0.5, 0.25, 0.1] {
        hall.dim(gain);
        let fraction = light(&hall.sent(&Placement::default(), SIZE)) / full;
        assert!((fraction - gain).abs() < 0.02, "{fraction} of the light is left, not {gain}");
    }
    hall.dim(0.0);
    assert!(hall.finished().pixels().all(|pixel| pixel.0[..3] == [0; 3]));
}

#[test]
fn flashing_blackouts_are_limited() {
    let wall = "material paint { color = 0  roughness = 1  emission = 0.8 }\n\
                object wall { shape = 5 - p.z  material = paint }\n\
                light none { direction = vec3(0, -1, 0)  color = 0 }\n\
                camera { position = vec3(0)  target = vec3(0, 0, 5) }\n\
                sky { color = 0  ambient = 0 }\npicture { tone_map = none  bloom = 0 }\n";
    let mut hall = Hall::of(SceneSource::Formula(wall.into()));
    let (mut brightest, mut darkest): (f32, f32) = (0.0, 1.0);
    for frame in 0..180 {
        hall.dim(if frame / 4 % 2 == 0 { 1.0 } else { 0.0 });
        if frame >= 120 {
            let shown = light(&hall.sent(&Placement::default(), SIZE));
            (brightest, darkest) = (brightest.max(shown), darkest.min(shown));
        }
    }
    hall.0.renderer.remove_flash_limiter();
    hall.dim(1.0);
    let full = light(&hall.finished());
    assert!(brightest - darkest < 0.5 * full, "from {darkest} to {brightest}, of {full}");
}

#[test]
fn mirroring_crop_and_corners_are_exact() {
    let mut hall = Hall::new();
    let plain = hall.finished();
    let flipped = |flip| Placement { flip, ..Placement::default() };
    assert!(hall.sent(&flipped(Flip::Horizontal), SIZE) == image::imageops::flip_horizontal(&plain));
    assert!(hall.sent(&flipped(Flip::Vertical), SIZE) == image::imageops::flip_vertical(&plain));
    assert!(hall.sent(&flipped(Flip::Both), SIZE) == image::imageops::rotate180(&plain));
    // Each pixel of the window shows one pixel of the crop, which is a quarter of the image.
    let crop = Crop::try_from([50.0, 0.0, 0.0, 50.0]).unwrap();
    let part = hall.sent(&Placement { crop, ..Placement::default() }, (SIZE.0 / 2, SIZE.1 / 2));
    assert!(part == image::imageops::crop_imm(&plain, SIZE.0 / 2, 0, SIZE.0 / 2, SIZE.1 / 2).to_image());
    let corners = Corners::try_from([[0.0, 0.0], [0.5, 0.0], [0.5, 1.0], [0.0, 1.0]]).unwrap();
    let wide = (2 * SIZE.0, SIZE.1);
    let map = Placement { corners, ..Placement::default() };
    let mut reader = PictureReader::new(hall.0.context.gl(), wide).unwrap();
    assert!(hall.0.renderer.send_placed(&mut reader, &within(WHOLE, &map.map()), map.part()).unwrap());
    hall.0.context.gl().finish();
    let sent = RgbaImage::from_raw(wide.0, wide.1, reader.drain().unwrap()).unwrap();
    assert!(image::imageops::crop_imm(&sent, 0, 0, SIZE.0, SIZE.1).to_image() == plain);
    assert!(sent.enumerate_pixels().all(|(x, _, pixel)| x < SIZE.0 || pixel.0 == [0, 0, 0, 255]));
}

#[test]
fn a_smaller_window_shows_the_mean_of_the_pixels() {
    let mut hall = Hall::new();
    let plain = hall.finished();
    let small = hall.sent(&Placement::default(), (SIZE.0 / 4, SIZE.1 / 4));
    for (x, y, pixel) in small.enumerate_pixels() {
        for channel in 0..3 {
            let of = |i: u32| u32::from(plain.get_pixel(4 * x + i % 4, 4 * y + i / 4).0[channel]);
            let mean = (0..16).map(of).sum::<u32>() as f32 / 16.0;
            let found = f32::from(pixel.0[channel]);
            assert!((found - mean).abs() <= 1.0, "{found} is not {mean} at {x}, {y}");
        }
    }
}

#[test]
fn readers_hold_at_most_three_images() {
    let mut hall = Hall::new();
    let mut reader = PictureReader::new(hall.0.context.gl(), SIZE).unwrap();
    let plain = Placement::default();
    let begun =
        (0..9).filter(|_| hall.0.renderer.send_placed(&mut reader, &plain.map(), plain.part()).unwrap());
    assert_eq!(begun.count(), 3);
    hall.0.context.gl().finish();
    assert!(reader.drain().is_some() && !reader.is_waiting());
    assert!(hall.0.renderer.send_placed(&mut reader, &plain.map(), plain.part()).unwrap());
}
