//! How the shipped scenes look: each has a golden picture, shows that music plays, and is neither black nor burnt.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::compare::{check_golden, difference};
use crate::support::studio::{Studio, loud_sound, silence};
use image::RgbaImage;
use mariana::gpu::renderer::Counting;
use mariana::gpu::scene_program::Mode;
use mariana::scenes::{SceneSource, shipped_names};

const SIZE: (u32, u32) = (192, 108);
/// The moment that is drawn.
const TIME: f64 = 62.0;
/// Steps of 0..255 that are seen.
const VISIBLE: u8 = 12;
/// The least share of the pixels that music changes.
const MOVED_MIN: f64 = 0.15;
/// The largest shares of pixels that are black, or white.
const BLACK_MAX: f64 = 0.30;
const WHITE_MAX: f64 = 0.02;

/// The share of pixels whose colours are all within the range.
fn share(picture: &RgbaImage, range: std::ops::RangeInclusive<u8>) -> f64 {
    let within =
        picture.pixels().filter(|pixel| pixel.0[..3].iter().all(|value| range.contains(value))).count();
    within as f64 / picture.pixels().len() as f64
}

#[test]
fn every_scene_looks_as_it_did_and_shows_the_music() {
    let mut failures = Vec::new();
    for name in shipped_names() {
        let scene = SceneSource::Shipped(name.clone());
        let mut studio = Studio::of(&scene, Mode::Compiled, Counting::Off);
        let loud = studio.picture(TIME, loud_sound(), SIZE);
        let silent = studio.picture(TIME, silence(), SIZE);
        failures.extend(check_golden(&format!("scene-{name}"), &loud).err());
        let moved = difference(&loud, &silent, VISIBLE).share;
        if moved < MOVED_MIN {
            failures.push(format!("{name}: music changes {:.1} % of the pixels", 100.0 * moved));
        }
        for (sound, picture) in [("music", &loud), ("silence", &silent)] {
            let (black, white) = (share(picture, 0..=1), share(picture, 254..=255));
            if black > BLACK_MAX || white > WHITE_MAX {
                let (black, white) = (100.0 * black, 100.0 * white);
                failures.push(format!("{name} in {sound}: {black:.1} % are black, {white:.1} % white"));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
