//! Placement of a finished image on a screen: cropped, mirrored and mapped to four corners.
//!
//! Only the final copy into a window applies the placement. The image and exports do not change. The visible part fills
//! the four corners without enlarging pixels: a cropped image is drawn larger ([`Placement::picture_size`]).

use glam::DMat3;
use serde::{Deserialize, Serialize};

/// A projective map: a 3×3 matrix, stored by rows. It is multiplied by `(x, y, 1)`.
pub type Map = [[f64; 3]; 3];

/// Maximum crop of two opposite edges together, in percent.
pub const CROP_MAX: f64 = 90.0;
/// Largest distance of a corner outside the screen, as a fraction of the screen.
pub const CORNER_OUTSIDE_MAX: f64 = 1.0;
/// Minimum area of the parallelogram that two adjacent edges span, as a fraction of the screen.
const AREA_MIN: f64 = 1e-3;

/// Mirroring of the image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Flip {
    /// No mirroring.
    #[default]
    Off,
    /// Swaps left and right, for rear projection.
    Horizontal,
    /// Swaps top and bottom.
    Vertical,
    /// Swaps left and right, and top and bottom, for a projector mounted on the ceiling.
    Both,
}

impl Flip {
    fn turns(self) -> (bool, bool) {
        (matches!(self, Self::Horizontal | Self::Both), matches!(self, Self::Vertical | Self::Both))
    }
}

/// The parts that are cut off an image's edges, in percent of the image's size: left, top, right, bottom.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(try_from = "[f64; 4]", into = "[f64; 4]")]
pub struct Crop([f64; 4]);

impl TryFrom<[f64; 4]> for Crop {
    type Error = &'static str;

    fn try_from(percent: [f64; 4]) -> Result<Self, Self::Error> {
        let [left, top, right, bottom] = percent;
        let is_fraction = percent.iter().all(|side| (0.0..=CROP_MAX).contains(side));
        if is_fraction && left + right <= CROP_MAX && top + bottom <= CROP_MAX {
            Ok(Self(percent))
        } else {
            Err("opposite edges can be cropped by 0 to 90 percent together")
        }
    }
}

impl From<Crop> for [f64; 4] {
    fn from(crop: Crop) -> Self {
        crop.0
    }
}

/// The screen positions of the visible part's corners, as fractions of the screen to the right and down: upper left,
/// upper right, lower right, lower left.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "[[f64; 2]; 4]", into = "[[f64; 2]; 4]")]
pub struct Corners([[f64; 2]; 4]);

const OF_SCREEN: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

impl Default for Corners {
    fn default() -> Self {
        Self(OF_SCREEN)
    }
}

impl TryFrom<[[f64; 2]; 4]> for Corners {
    type Error = &'static str;

    fn try_from(corners: [[f64; 2]; 4]) -> Result<Self, Self::Error> {
        let near = -CORNER_OUTSIDE_MAX..=1.0 + CORNER_OUTSIDE_MAX;
        if !corners.as_flattened().iter().all(|fraction| near.contains(fraction)) {
            return Err("a corner can be at most one screen size outside the screen");
        }
        let turn = |i: usize| {
            let [a, b, c] = [i, i + 1, i + 2].map(|i| corners[i % 4]);
            (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
        };
        // Require clockwise turns at all corners: otherwise the image would be mirrored or folded.
        if (0..4).all(|i| turn(i) > AREA_MIN) {
            Ok(Self(corners))
        } else {
            Err("the corners must be in clockwise order from the upper left and form a convex shape")
        }
    }
}

impl From<Corners> for [[f64; 2]; 4] {
    fn from(corners: Corners) -> Self {
        corners.0
    }
}

impl Corners {
    /// Moves one corner. Returns `None` if the result could not be drawn.
    pub fn with(self, corner: usize, place: [f64; 2]) -> Option<Self> {
        let mut corners = self.0;
        *corners.get_mut(corner)? = place;
        Self::try_from(corners).ok()
    }
}

/// The crop, mirroring and corners of an image on a screen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Placement {
    /// Parts cut off the edges.
    pub crop: Crop,
    /// Mirroring.
    pub flip: Flip,
    /// Corners on the screen.
    pub corners: Corners,
}

impl Placement {
    /// True if the whole image covers the whole screen unchanged.
    pub fn is_plain(&self) -> bool {
        *self == Self::default()
    }

    /// The size of the image whose visible part covers a screen of `screen` pixels, pixel for pixel.
    pub fn picture_size(&self, screen: (u32, u32)) -> (u32, u32) {
        let [left, top, right, bottom] = self.part();
        let side = |side: u32, fraction: f64| (f64::from(side) / fraction).round().clamp(1.0, 1e6) as u32;
        (side(screen.0, right - left), side(screen.1, bottom - top))
    }

    /// The size of the visible part of an image of `size` pixels.
    pub fn rest_of(&self, size: (u32, u32)) -> (u32, u32) {
        let [left, top, right, bottom] = self.part();
        let side = |side: u32, fraction: f64| (f64::from(side) * fraction).round().max(1.0) as u32;
        (side(size.0, right - left), side(size.1, bottom - top))
    }

    /// Returns the map from positions on the screen to positions in the image, both as fractions to the right and down.
    /// The screen is black where the third number is not positive or the position is outside the visible part.
    pub fn map(&self) -> Map {
        let [left, top, right, bottom] = self.part();
        let (turns_x, turns_y) = self.flip.turns();
        let (x, width) = if turns_x { (right, left - right) } else { (left, right - left) };
        let (y, height) = if turns_y { (bottom, top - bottom) } else { (top, bottom - top) };
        let part = [[width, 0.0, x], [0.0, height, y], [0.0, 0.0, 1.0]];
        product(&part, &inverse(&square_to(self.corners.0)))
    }

    /// The left, top, right and bottom edge of the visible part, as fractions of the image.
    pub fn part(&self) -> [f64; 4] {
        let [left, top, right, bottom] = self.crop.0.map(|percent| percent / 100.0);
        [left, top, 1.0 - right, 1.0 - bottom]
    }
}

/// A rectangle as fractions of a window: left, top, right, bottom.
pub type Area = [f64; 4];
/// The whole window.
pub const WHOLE: Area = [0.0, 0.0, 1.0, 1.0];

/// Returns the largest area with the aspect ratio of `shape`, centred in a window. Returns the whole window if the bars
/// beside the area would be thinner than half a pixel.
pub fn fitted(shape: (u32, u32), window: (u32, u32)) -> Area {
    let [width, height] = [shape.0, shape.1].map(|side| f64::from(side.max(1)));
    let [across, down] = [window.0, window.1].map(|side| f64::from(side.max(1)));
    let scale = (across / width).min(down / height);
    // Round to whole pixels, so that the area's edges are sharp.
    let margin = |room: f64, side: f64| ((room - side * scale) / 2.0).round() / room;
    let (x, y) = (margin(across, width), margin(down, height));
    [x, y, 1.0 - x, 1.0 - y]
}

/// Moves a map into `area` of the window: the map then spans `area` as it spanned the whole window before. If the
/// bottom of `area` is above its top, the image is upside down.
pub fn within(area: Area, map: &Map) -> Map {
    let [left, top, right, bottom] = area;
    let extent = |from: f64, to: f64| if to == from { 1e-9 } else { to - from };
    let (width, height) = (extent(left, right), extent(top, bottom));
    product(map, &[[1.0 / width, 0.0, -left / width], [0.0, 1.0 / height, -top / height], [0.0, 0.0, 1.0]])
}

/// Applies a map to a position. `None` if the third number of the result is not positive.
pub fn led(map: &Map, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
    let [u, v, w] = map.map(|[a, b, c]| a * x + b * y + c);
    (w > 0.0).then(|| [u / w, v / w])
}

/// The projective map of the unit square to a quadrilateral (Heckbert 1989).
fn square_to([[x0, y0], [x1, y1], [x2, y2], [x3, y3]]: [[f64; 2]; 4]) -> Map {
    let (dx1, dx2, sx) = (x1 - x2, x3 - x2, x0 - x1 + x2 - x3);
    let (dy1, dy2, sy) = (y1 - y2, y3 - y2, y0 - y1 + y2 - y3);
    let whole = dx1 * dy2 - dx2 * dy1;
    let g = (sx * dy2 - dx2 * sy) / whole;
    let h = (dx1 * sy - sx * dy1) / whole;
    [[x1 - x0 + g * x1, x3 - x0 + h * x3, x0], [y1 - y0 + g * y1, y3 - y0 + h * y3, y0], [g, h, 1.0]]
}

/// The inverse map. Its third number is positive wherever the map itself is defined.
pub fn inverse(map: &Map) -> Map {
    // glam takes the rows for columns: it inverts the transpose, whose inverse it returns transposed.
    DMat3::from_cols_array_2d(map).inverse().to_cols_array_2d()
}

/// The map that applies `b`, then `a`.
pub fn product(a: &Map, b: &Map) -> Map {
    // glam takes the rows for columns, so the factors change places.
    (DMat3::from_cols_array_2d(b) * DMat3::from_cols_array_2d(a)).to_cols_array_2d()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn assert_led(placement: &Placement, screen: [f64; 2], picture: [f64; 2]) {
        let found = led(&placement.map(), screen).unwrap();
        let apart = (found[0] - picture[0]).hypot(found[1] - picture[1]);
        assert!(apart < 1e-9, "{screen:?} maps to {found:?} instead of {picture:?}");
    }

    #[test]
    fn the_default_placement_is_the_identity() {
        let plain = Placement::default();
        assert!(plain.is_plain());
        assert_led(&plain, [0.25, 0.75], [0.25, 0.75]);
        assert_eq!(plain.picture_size((1280, 720)), (1280, 720));
    }

    #[test]
    fn the_visible_part_fills_the_screen_unstretched_and_mirrored() {
        let crop = Crop::try_from([10.0, 0.0, 40.0, 20.0]).unwrap();
        let placement = Placement { crop, flip: Flip::Horizontal, ..Placement::default() };
        assert_led(&placement, [0.0, 0.0], [0.6, 0.0]);
        assert_led(&placement, [1.0, 1.0], [0.1, 0.8]);
        assert_eq!(placement.picture_size((500, 400)), (1000, 500));
        let both = Placement { flip: Flip::Both, ..Placement::default() };
        assert_led(&both, [0.2, 0.1], [0.8, 0.9]);
        assert_led(&Placement { flip: Flip::Vertical, ..Placement::default() }, [0.2, 0.1], [0.2, 0.9]);
    }

    #[test]
    fn corners_map_to_corners_and_straight_lines_stay_straight() {
        let places = [[0.1, 0.2], [0.95, 0.0], [0.8, 0.9], [0.0, 1.0]];
        let corners = Corners::try_from(places).unwrap();
        let placement = Placement { corners, ..Placement::default() };
        for (place, corner) in places.into_iter().zip(OF_SCREEN) {
            assert_led(&placement, place, corner);
        }
        let [a, b, c, d] = places;
        let cross = |u: [f64; 2], v: [f64; 2]| u[0] * v[1] - u[1] * v[0];
        let (ac, bd, ab) =
            ([c[0] - a[0], c[1] - a[1]], [d[0] - b[0], d[1] - b[1]], [b[0] - a[0], b[1] - a[1]]);
        let fraction = cross(ab, bd) / cross(ac, bd);
        assert_led(&placement, [a[0] + fraction * ac[0], a[1] + fraction * ac[1]], [0.5, 0.5]);
        assert!(led(&placement.map(), [0.05, 0.05]).is_none_or(|[x, y]| x < 0.0 || y < 0.0));
    }

    #[test]
    fn folded_corners_and_complete_crops_are_refused() {
        for corners in [
            [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]],
            [[1.0, 0.0], [0.0, 0.0], [0.0, 1.0], [1.0, 1.0]],
            [[0.0, 0.0], [1.0, 0.0], [0.2, 0.2], [0.0, 1.0]],
            [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [0.0, 1.0]],
            [[0.0, 0.0], [2.5, 0.0], [1.0, 1.0], [0.0, 1.0]],
            [[f64::NAN, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        ] {
            assert!(Corners::try_from(corners).is_err(), "{corners:?}");
        }
        for crop in [[-1.0, 0.0, 0.0, 0.0], [50.0, 0.0, 41.0, 0.0], [0.0, 91.0, 0.0, 0.0], [f64::NAN; 4]] {
            assert!(Crop::try_from(crop).is_err(), "{crop:?}");
        }
        let crop = Crop::try_from([45.0, 0.0, CROP_MAX - 45.0, 0.0]).unwrap();
        let [left, _, right, _] = Placement { crop, ..Placement::default() }.part();
        assert!((right - left - 0.1).abs() < 1e-9);
        let far = 1.0 + CORNER_OUTSIDE_MAX;
        assert!(Corners::default().with(2, [far, far]).is_some());
        assert_eq!(Corners::default().with(2, [far + 0.01, far]), None);
        assert_eq!(Corners::default().with(4, [0.5, 0.5]), None);
    }

    #[test]
    fn letterbox_bars_end_on_whole_pixels() {
        assert_eq!(fitted((1920, 1080), (640, 360)), [0.0, 0.0, 1.0, 1.0]);
        assert_eq!(fitted((1920, 1080), (400, 600)), [0.0, 188.0 / 600.0, 1.0, 1.0 - 188.0 / 600.0]);
        assert_eq!(fitted((100, 200), (300, 200)), [100.0 / 300.0, 0.0, 1.0 - 100.0 / 300.0, 1.0]);
        let map = within([0.25, 0.0, 0.75, 1.0], &Placement::default().map());
        assert_eq!(led(&map, [0.5, 0.5]), Some([0.5, 0.5]));
        assert_eq!(led(&map, [0.25, 1.0]), Some([0.0, 1.0]));
    }
}
