//! Detects the speakers in an image by the colour of their wood.

use image::RgbaImage;

/// Returns the fraction of the pixels in `columns` that have the colour of wood, lit or unlit.
fn wood_fraction(picture: &RgbaImage, columns: std::ops::Range<u32>) -> f64 {
    let (mut wood, mut all) = (0_u32, 0_u32);
    for (x, _, pixel) in picture.enumerate_pixels() {
        if columns.contains(&x) {
            let [r, g, b, _] = pixel.0.map(f64::from);
            wood += u32::from(r > 1.15 * g && g > 1.15 * b);
            all += 1;
        }
    }
    f64::from(wood) / f64::from(all)
}

pub(crate) fn assert_shows_the_speakers(picture: &RgbaImage) {
    let middle = picture.width() / 2;
    let [left, right] = [0..middle, middle..picture.width()].map(|columns| wood_fraction(picture, columns));
    assert!(left > 0.03 && right > 0.03, "wood fills {left} of the left half and {right} of the right one");
    let brightness = picture.pixels().map(|pixel| f64::from(pixel.0[1])).sum::<f64>()
        / f64::from(picture.width() * picture.height());
    assert!((40.0..200.0).contains(&brightness), "mean green is {brightness}");
}
