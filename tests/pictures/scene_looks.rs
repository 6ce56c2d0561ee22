//! The look of a shipped scene: it has a golden image, reacts to music, and is neither too dark nor clipped.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::Path;
use std::process::Command;

use crate::support::compare::{LOOSE, check_golden, compare, difference};
use crate::support::test_renderer::{TestRenderer, loud_sound, silence};
use image::RgbaImage;
use mariana::thumbnails::{self, jpeg_of};

const SIZE: (u32, u32) = (192, 108);
/// In seconds.
const TIME: f64 = 62.0;
/// The smallest visible difference, in steps of 0..255.
const VISIBLE: u8 = 12;
/// Minimum fraction of the pixels that music must change.
const MOVED_MIN: f64 = 0.15;
/// Maximum fractions of black and of white pixels.
const BLACK_MAX: f64 = 0.30;
const WHITE_MAX: f64 = 0.02;

fn fraction(picture: &RgbaImage, range: std::ops::RangeInclusive<u8>) -> f64 {
    let within =
        picture.pixels().filter(|pixel| pixel.0[..3].iter().all(|value| range.contains(value))).count();
    within as f64 / picture.pixels().len() as f64
}

fn drawn_thumbnail(name: &str, folder: &Path) -> RgbaImage {
    let file = folder.join(format!("{name}.png"));
    let size = format!("{}x{}", thumbnails::SIZE.0, thumbnails::SIZE.1);
    let mut command = Command::new(env!("CARGO_BIN_EXE_mariana"));
    command.args(["still", "--at", &thumbnails::MOMENT.to_string(), "--size", &size, "--scene", name, "-o"]);
    let status = command.arg(&file).status().unwrap();
    assert!(status.success(), "{name}: {status}");
    image::open(file).unwrap().into_rgba8()
}

fn check_thumbnail(name: &str, drawn: &RgbaImage) -> Result<(), String> {
    let read = |jpeg: &[u8]| {
        let image = image::load_from_memory_with_format(jpeg, image::ImageFormat::Jpeg);
        image.map(image::DynamicImage::into_rgba8).map_err(|error| error.to_string())
    };
    let advice = format!("run cargo xtask thumbnails {name}");
    let shipped = thumbnails::shipped(name).ok_or_else(|| format!("{name} has no thumbnail: {advice}"))?;
    // Both images were JPEG-encoded, so a difference shows that the rendering has changed.
    compare(&format!("thumbnail-{name}"), &read(&jpeg_of(drawn))?, &read(shipped)?, LOOSE)
        .map_err(|reason| format!("the thumbnail of {name} is out of date: {advice}; {reason}"))
}

/// Fails unless the scene looks like its golden image and its thumbnail, shows the music, and is neither too dark nor
/// clipped.
pub(super) fn check_look(name: &str, renderer: &mut TestRenderer) {
    let [loud, silent] = [loud_sound(), silence().into()].map(|sound| renderer.picture(TIME, sound, SIZE));
    check_golden(&format!("scene-{name}"), &loud).unwrap();
    let moved = difference(&loud, &silent, VISIBLE).fraction;
    assert!(moved >= MOVED_MIN, "{name}: music changes {:.1} % of the pixels", 100.0 * moved);
    for (sound, picture) in [("music", &loud), ("silence", &silent)] {
        let (black, white) = (fraction(picture, 0..=1), fraction(picture, 254..=255));
        assert!(black <= BLACK_MAX && white <= WHITE_MAX, "{name} in {sound}: {black} black, {white} white");
    }
    let folder = tempfile::tempdir().unwrap();
    check_thumbnail(name, &drawn_thumbnail(name, folder.path())).unwrap();
}
