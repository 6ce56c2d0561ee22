//! The layout of the control window, which is used while the output fills a second screen. A column at the right shows
//! the frame at a small size, and the rest is for panels.

use mariana_render::placement::Area;

/// Width of the column at the right, as a fraction of the window's width.
pub(crate) const COLUMN: f64 = 1.0 / 3.0;
/// Maximum height of the small frame, as a fraction of the window's height.
const HEIGHT_MAX: f64 = 0.45;
/// Distance from the window's edges, as a fraction of its shorter side.
const MARGIN: f64 = 0.02;

/// Background colour around the small frame: red, green and blue as screen values, 0..1.
pub const AROUND: [f32; 3] = [0.075, 0.08, 0.092];

/// The area of the small frame in a window of `window` pixels. It has the aspect ratio of a screen of `screen` pixels.
pub fn small_in(window: (u32, u32), screen: (u32, u32)) -> Area {
    let [width, height] = [screen.0, screen.1].map(|side| f64::from(side.max(1)));
    let [across, down] = [window.0, window.1].map(|side| f64::from(side.max(1)));
    let margin = MARGIN * across.min(down);
    let scale = ((COLUMN * across - margin) / width).min(HEIGHT_MAX * down / height);
    // Round to whole pixels, so that the edges are sharp.
    let pixels = |length: f64| length.round().max(1.0);
    let (right, top) = (across - pixels(margin), pixels(margin));
    [
        (right - pixels(scale * width)) / across,
        top / down,
        right / across,
        (top + pixels(scale * height)) / down,
    ]
}

/// True if a position in pixels is inside an area of a window of `window` pixels.
pub fn is_within([left, top, right, bottom]: Area, window: (u32, u32), place: [f64; 2]) -> bool {
    let (x, y) = (place[0] / f64::from(window.0.max(1)), place[1] / f64::from(window.1.max(1)));
    (left..right).contains(&x) && (top..bottom).contains(&y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_small_frame_keeps_its_shape_on_whole_pixels_and_leaves_room() {
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
    fn a_tiny_window_still_gets_a_valid_area() {
        let [left, top, right, bottom] = small_in((1, 1), (1920, 1080));
        assert!(left < right && top < bottom);
        assert!(small_in((0, 0), (0, 0)).iter().all(|fraction| fraction.is_finite()));
    }

    #[test]
    fn a_position_is_on_the_small_frame_or_outside_it() {
        let area = small_in((1000, 500), (1000, 500));
        assert!(is_within(area, (1000, 500), [900.0, 50.0]));
        for place in [[300.0, 50.0], [900.0, 400.0], [995.0, 50.0], [900.0, 2.0]] {
            assert!(!is_within(area, (1000, 500), place), "{place:?}");
        }
    }
}
