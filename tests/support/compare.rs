//! Comparison of images, with one measure and two tolerances.

use std::path::{Path, PathBuf};

use image::{Rgba, RgbaImage};

/// The maximum difference of two images. Colours are measured in steps of 0..255. Alpha is ignored.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tolerance {
    /// Maximum mean difference over all colour channels, in steps.
    pub mean_max: f64,
    /// A pixel differs visibly if a channel differs by more than this number of steps.
    pub visible: u8,
    /// Maximum fraction of pixels that differ visibly, 0..1.
    pub fraction_max: f64,
}

/// For images from one machine that should be equal although they are computed in different ways.
pub(crate) const TIGHT: Tolerance = Tolerance { mean_max: 0.5, visible: 8, fraction_max: 0.001 };

/// For images from different drivers. Rounding moves edges and penumbras, and texture filters differ.
pub(crate) const LOOSE: Tolerance = Tolerance { mean_max: 1.0, visible: 16, fraction_max: 0.005 };

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Difference {
    /// Mean over all colour channels, in steps of 0..255.
    pub mean: f64,
    /// Fraction of the pixels that differ visibly, 0..1.
    pub fraction: f64,
    /// The largest difference of a channel, in steps.
    pub largest: u8,
}

/// Returns the largest difference of a channel in steps of 0..255, without alpha.
pub(crate) fn pixel_difference(a: &Rgba<u8>, b: &Rgba<u8>) -> u8 {
    (0..3).map(|channel| a.0[channel].abs_diff(b.0[channel])).max().unwrap_or(0)
}

pub(crate) fn difference(a: &RgbaImage, b: &RgbaImage, visible: u8) -> Difference {
    assert_eq!(a.dimensions(), b.dimensions(), "the images have different sizes");
    let (mut sum, mut seen, mut largest) = (0_u64, 0_u64, 0);
    for (a, b) in a.pixels().zip(b.pixels()) {
        sum += (0..3).map(|channel| u64::from(a.0[channel].abs_diff(b.0[channel]))).sum::<u64>();
        let pixel = pixel_difference(a, b);
        seen += u64::from(pixel > visible);
        largest = largest.max(pixel);
    }
    let pixels = f64::from(a.width()) * f64::from(a.height());
    Difference { mean: sum as f64 / (3.0 * pixels), fraction: seen as f64 / pixels, largest }
}

pub(crate) fn assert_alike(name: &str, actual: &RgbaImage, expected: &RgbaImage, tolerance: Tolerance) {
    if let Err(reason) = compare(name, actual, expected, tolerance) {
        panic!("{reason}");
    }
}

/// Compares `actual` with `tests/golden/NAME.png` within [`LOOSE`]. With MARIANA_BLESS=1 in the environment, replaces
/// the golden file by `actual`.
pub(crate) fn check_golden(name: &str, actual: &RgbaImage) -> Result<(), String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(format!("{name}.png"));
    if std::env::var_os("MARIANA_BLESS").is_some_and(|value| value == "1") {
        return write(&path, actual);
    }
    let advice = "if the change is intended, run MARIANA_BLESS=1 cargo test --workspace --test pictures";
    let golden =
        image::open(&path).map_err(|error| format!("{}: {error}; {advice}", path.display()))?.to_rgba8();
    if golden.dimensions() != actual.dimensions() {
        return Err(format!("{name} has another size than the golden image; {advice}"));
    }
    compare(name, actual, &golden, LOOSE).map_err(|reason| format!("{reason}; {advice}"))
}

/// If the images differ too much, saves them for inspection.
pub(crate) fn compare(
    name: &str,
    actual: &RgbaImage,
    expected: &RgbaImage,
    tolerance: Tolerance,
) -> Result<(), String> {
    let found = difference(actual, expected, tolerance.visible);
    if found.mean <= tolerance.mean_max && found.fraction <= tolerance.fraction_max {
        return Ok(());
    }
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let seen = [
        (folder.join(format!("{name}.actual.png")), actual.clone()),
        (folder.join(format!("{name}.expected.png")), expected.clone()),
        (folder.join(format!("{name}.difference.png")), difference_picture(actual, expected)),
    ];
    let mut reason = format!(
        "{name} differs from the expected image by {found:?}, the limit is \
        {tolerance:?}; look at"
    );
    for (path, picture) in &seen {
        write(path, picture)?;
        reason.push_str(&format!("\n  {}", path.display()));
    }
    Err(reason)
}

/// The differences are multiplied by eight, so that they are visible.
fn difference_picture(a: &RgbaImage, b: &RgbaImage) -> RgbaImage {
    RgbaImage::from_fn(a.width(), a.height(), |x, y| {
        let (a, b) = (a.get_pixel(x, y).0, b.get_pixel(x, y).0);
        let channel = |i: usize| a[i].abs_diff(b[i]).saturating_mul(8);
        Rgba([channel(0), channel(1), channel(2), 255])
    })
}

fn write(path: &Path, picture: &RgbaImage) -> Result<(), String> {
    let written = path.parent().map_or(Ok(()), std::fs::create_dir_all).map_err(|error| error.to_string());
    written
        .and_then(|()| picture.save(path).map_err(|error| error.to_string()))
        .map_err(|error| format!("cannot write {}: {error}", path.display()))
}
