//! Where the picture lies in a window that is the desk of an output: small, in a column of its own, and beside it is room
//! for panels.

use mariana_render::placement::Area;

/// Share of the window's width that the column has at its right.
pub(crate) const COLUMN: f64 = 1.0 / 3.0;
/// Greatest share of the window's height that the picture has.
const HEIGHT_MAX: f64 = 0.45;
/// Distance from the window's edges, as a share of its shorter side.
const MARGIN: f64 = 0.02;

/// What is around the picture: calm, and no part of it. Red, green and blue as the screen has them, 0..1.
pub const AROUND: [f32; 3] = [0.075, 0.08, 0.092];

/// The part of a window of `window` pixels in which the picture of a screen of `screen` pixels lies, in its shape.
pub fn small_in(window: (u32, u32), screen: (u32, u32)) -> Area {
    let [width, height] = [screen.0, screen.1].map(|side| f64::from(side.max(1)));
    let [across, down] = [window.0, window.1].map(|side| f64::from(side.max(1)));
    let margin = MARGIN * across.min(down);
    let scale = ((COLUMN * across - margin) / width).min(HEIGHT_MAX * down / height);
    // On whole pixels, so that its edges are sharp.
    let pixels = |length: f64| length.round().max(1.0);
    let (right, top) = (across - pixels(margin), pixels(margin));
    [
        (right - pixels(scale * width)) / across,
        top / down,
        right / across,
        (top + pixels(scale * height)) / down,
    ]
}

/// Whether a place of a window of `window` pixels, in pixels, is in a part of it.
pub fn is_within([left, top, right, bottom]: Area, window: (u32, u32), place: [f64; 2]) -> bool {
    let (x, y) = (place[0] / f64::from(window.0.max(1)), place[1] / f64::from(window.1.max(1)));
    (left..right).contains(&x) && (top..bottom).contains(&y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_picture_has_its_shape_on_whole_pixels_and_leaves_room() {
        for (window, screen) in [
            ((1280, 720), (1920, 1080)),
            ((1280, 720), (600, 800)),
            ((640, 360), (3840, 1080)),
            ((700, 900), (1024, 768)),
        ] {
            let [left, top, right, bottom] = small_in(window, screen);
            let (across, down) = (f64::from(window.0), f64::from(window.1));
            let (width, height) = ((right - left) * across, (bottom - top) * down);
            let shape = f64::from(screen.0) / f64::from(screen.1);
            assert!((width - shape * height).abs() <= 1.0 + shape, "{width}x{height} for {screen:?}");
            for edge in [left * across, right * across, top * down, bottom * down] {
                assert!((edge - edge.round()).abs() < 1e-9, "{edge} is between two pixels");
            }
            assert!(left >= 1.0 - COLUMN && right < 1.0 && bottom < 0.5 && top > 0.0, "{window:?}");
        }
    }

    #[test]
    fn a_window_without_room_still_has_a_place_for_it() {
        let [left, top, right, bottom] = small_in((1, 1), (1920, 1080));
        assert!(left < right && top < bottom);
        assert!(small_in((0, 0), (0, 0)).iter().all(|fraction| fraction.is_finite()));
    }

    #[test]
    fn a_place_is_on_the_picture_or_beside_it() {
        let area = small_in((1000, 500), (1000, 500));
        assert!(is_within(area, (1000, 500), [900.0, 50.0]));
        for place in [[300.0, 50.0], [900.0, 400.0], [995.0, 50.0], [900.0, 2.0]] {
            assert!(!is_within(area, (1000, 500), place), "{place:?}");
        }
    }
}
