//! Where a finished picture lies on a screen: which part of it shows, mirrored or not, in which four corners.
//!
//! It is told to the last copy, into a window: neither the picture nor what is exported knows of it. What shows fills the
//! corners, so a picture that loses a part is drawn larger beforehand ([`Placement::picture_size`]), never stretched.

use serde::{Deserialize, Serialize};

/// A projective map of places: rows of a matrix that a place `(x, y, 1)` is multiplied by.
pub type Map = [[f64; 3]; 3];

/// Most that two opposite edges lose together, in percent: something must be left.
pub const CROP_MAX: f64 = 90.0;
/// How far outside the screen a corner may lie, as a share of the screen.
pub const CORNER_OUTSIDE_MAX: f64 = 1.0;
/// Least area of the quadrilateral on each side of its diagonals, as a share of the screen: less is a line.
const AREA_MIN: f64 = 1e-3;

/// Which way a picture is mirrored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Flip {
    /// Not at all.
    #[default]
    Off,
    /// Left and right change places, as for a screen that is lit from behind.
    Horizontal,
    /// Top and bottom change places.
    Vertical,
    /// Both, as for a projector that hangs from the ceiling.
    Both,
}

impl Flip {
    fn turns(self) -> (bool, bool) {
        (matches!(self, Self::Horizontal | Self::Both), matches!(self, Self::Vertical | Self::Both))
    }
}

/// What the edges of a picture lose, in percent of its width and height: left, top, right, bottom.
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
            Err("opposite edges lose from 0 to 90 percent together")
        }
    }
}

impl From<Crop> for [f64; 4] {
    fn from(crop: Crop) -> Self {
        crop.0
    }
}

impl Crop {
    /// Left, top, right and bottom edge of what is left, as shares of the picture.
    fn rest(self) -> [f64; 4] {
        let [left, top, right, bottom] = self.0.map(|percent| percent / 100.0);
        [left, top, 1.0 - right, 1.0 - bottom]
    }
}

/// Where the corners of what shows lie on the screen, as shares of its width and height to the right and down: upper
/// left, upper right, lower right, lower left.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "[[f64; 2]; 4]", into = "[[f64; 2]; 4]")]
pub struct Corners([[f64; 2]; 4]);

/// The corners of the screen.
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
            return Err("a corner lies at most one screen beside the screen");
        }
        let turn = |i: usize| {
            let [a, b, c] = [i, i + 1, i + 2].map(|i| corners[i % 4]);
            (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
        };
        // Clockwise at each corner: otherwise the picture would lie on its back, or be folded.
        if (0..4).all(|i| turn(i) > AREA_MIN) {
            Ok(Self(corners))
        } else {
            Err("the corners go round clockwise from the upper left, and none of them is bent inwards")
        }
    }
}

impl From<Corners> for [[f64; 2]; 4] {
    fn from(corners: Corners) -> Self {
        corners.0
    }
}

impl Corners {
    /// The same with one corner elsewhere; none if that could not be drawn.
    pub fn with(self, corner: usize, place: [f64; 2]) -> Option<Self> {
        let mut corners = self.0;
        *corners.get_mut(corner)? = place;
        Self::try_from(corners).ok()
    }
}

/// See the module.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Placement {
    /// What the edges lose.
    pub crop: Crop,
    /// Which way it is mirrored.
    pub flip: Flip,
    /// Where the corners lie.
    pub corners: Corners,
}

impl Placement {
    /// Whether the whole picture lies on the whole screen as it is.
    pub fn is_plain(&self) -> bool {
        *self == Self::default()
    }

    /// The size of the picture of which a screen of `screen` pixels shows what is left, pixel for pixel.
    pub fn picture_size(&self, screen: (u32, u32)) -> (u32, u32) {
        let [left, top, right, bottom] = self.crop.rest();
        let side = |side: u32, fraction: f64| (f64::from(side) / fraction).round().clamp(1.0, 1e6) as u32;
        (side(screen.0, right - left), side(screen.1, bottom - top))
    }

    /// The size of what is left of a picture of `size` pixels.
    pub fn rest_of(&self, size: (u32, u32)) -> (u32, u32) {
        let [left, top, right, bottom] = self.crop.rest();
        let side = |side: u32, fraction: f64| (f64::from(side) * fraction).round().max(1.0) as u32;
        (side(size.0, right - left), side(size.1, bottom - top))
    }

    /// Leads from a place on the screen to the place in the picture that shows there, both as shares to the right and
    /// down. Where the third number is not positive, or the place is outside the part that shows, nothing does.
    pub fn map(&self) -> Map {
        let [left, top, right, bottom] = self.crop.rest();
        let (turns_x, turns_y) = self.flip.turns();
        let (x, width) = if turns_x { (right, left - right) } else { (left, right - left) };
        let (y, height) = if turns_y { (bottom, top - bottom) } else { (top, bottom - top) };
        let part = [[width, 0.0, x], [0.0, height, y], [0.0, 0.0, 1.0]];
        product(&part, &inverse(&square_to(self.corners.0)))
    }

    /// Left, top, right and bottom edge of the part of the picture that shows.
    pub fn part(&self) -> [f64; 4] {
        self.crop.rest()
    }
}

/// A rectangle as shares of a window: left, top, right, bottom.
pub type Area = [f64; 4];
/// All of it.
pub const WHOLE: Area = [0.0, 0.0, 1.0, 1.0];

/// The greatest area in the middle of a window of `window` pixels that has the shape of `shape` pixels. The whole window
/// if their shapes differ by less than a pixel.
pub fn fitted(shape: (u32, u32), window: (u32, u32)) -> Area {
    let [width, height] = [shape.0, shape.1].map(|side| f64::from(side.max(1)));
    let [across, down] = [window.0, window.1].map(|side| f64::from(side.max(1)));
    let scale = (across / width).min(down / height);
    // On whole pixels, so that its edges are sharp.
    let margin = |room: f64, side: f64| ((room - side * scale) / 2.0).round() / room;
    let (x, y) = (margin(across, width), margin(down, height));
    [x, y, 1.0 - x, 1.0 - y]
}

/// Leads from a place in a window to the place in an area of it, both as shares; an area whose bottom is above its top is
/// upside down.
pub fn within(area: Area, map: &Map) -> Map {
    let [left, top, right, bottom] = area;
    let extent = |from: f64, to: f64| if to == from { 1e-9 } else { to - from };
    let (width, height) = (extent(left, right), extent(top, bottom));
    product(map, &[[1.0 / width, 0.0, -left / width], [0.0, 1.0 / height, -top / height], [0.0, 0.0, 1.0]])
}

/// The place that a map leads to; none where it leads nowhere.
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

/// The way back, whose third number is positive where the map itself leads.
pub fn inverse(m: &Map) -> Map {
    let [[a, b, c], [d, e, f], [g, h, i]] = *m;
    let adjugate = [
        [e * i - f * h, c * h - b * i, b * f - c * e],
        [f * g - d * i, a * i - c * g, c * d - a * f],
        [d * h - e * g, b * g - a * h, a * e - b * d],
    ];
    let determinant = a * adjugate[0][0] + b * adjugate[1][0] + c * adjugate[2][0];
    adjugate.map(|row| row.map(|value| value / determinant))
}

/// Leads where `a` leads from where `b` leads.
pub fn product(a: &Map, b: &Map) -> Map {
    a.map(|row| std::array::from_fn(|j| (0..3).map(|k| row[k] * b[k][j]).sum()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn assert_led(placement: &Placement, screen: [f64; 2], picture: [f64; 2]) {
        let found = led(&placement.map(), screen).unwrap();
        let apart = (found[0] - picture[0]).hypot(found[1] - picture[1]);
        assert!(apart < 1e-9, "{screen:?} leads to {found:?}, not to {picture:?}");
    }

    #[test]
    fn a_plain_placement_leads_everywhere_to_itself() {
        let plain = Placement::default();
        assert!(plain.is_plain());
        assert_led(&plain, [0.25, 0.75], [0.25, 0.75]);
        assert_eq!(plain.picture_size((1280, 720)), (1280, 720));
    }

    #[test]
    fn what_is_left_fills_the_screen_unstretched_and_mirrored() {
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
    fn corners_lead_to_corners_straight_lines_stay_straight_and_the_middle_moves() {
        let places = [[0.1, 0.2], [0.95, 0.0], [0.8, 0.9], [0.0, 1.0]];
        let corners = Corners::try_from(places).unwrap();
        let placement = Placement { corners, ..Placement::default() };
        for (place, corner) in places.into_iter().zip(OF_SCREEN) {
            assert_led(&placement, place, corner);
        }
        // Where the diagonals cross is the picture's middle.
        let [a, b, c, d] = places;
        let cross = |u: [f64; 2], v: [f64; 2]| u[0] * v[1] - u[1] * v[0];
        let (ac, bd, ab) =
            ([c[0] - a[0], c[1] - a[1]], [d[0] - b[0], d[1] - b[1]], [b[0] - a[0], b[1] - a[1]]);
        let fraction = cross(ab, bd) / cross(ac, bd);
        assert_led(&placement, [a[0] + fraction * ac[0], a[1] + fraction * ac[1]], [0.5, 0.5]);
        assert!(led(&placement.map(), [0.05, 0.05]).is_none_or(|[x, y]| x < 0.0 || y < 0.0));
    }

    #[test]
    fn corners_that_fold_the_picture_and_edges_that_leave_nothing_are_refused() {
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
        assert_eq!(Crop::try_from([45.0, 0.0, CROP_MAX - 45.0, 0.0]).unwrap().part_width(), 0.1);
        let far = 1.0 + CORNER_OUTSIDE_MAX;
        assert!(Corners::default().with(2, [far, far]).is_some());
        assert_eq!(Corners::default().with(2, [far + 0.01, far]), None);
        assert_eq!(Corners::default().with(4, [0.5, 0.5]), None);
    }

    #[test]
    fn a_shape_fits_into_a_window_with_bars_on_whole_pixels() {
        assert_eq!(fitted((1920, 1080), (640, 360)), [0.0, 0.0, 1.0, 1.0]);
        assert_eq!(fitted((1920, 1080), (400, 600)), [0.0, 188.0 / 600.0, 1.0, 1.0 - 188.0 / 600.0]);
        assert_eq!(fitted((100, 200), (300, 200)), [100.0 / 300.0, 0.0, 1.0 - 100.0 / 300.0, 1.0]);
        let map = within([0.25, 0.0, 0.75, 1.0], &Placement::default().map());
        assert_eq!(led(&map, [0.5, 0.5]), Some([0.5, 0.5]));
        assert_eq!(led(&map, [0.25, 1.0]), Some([0.0, 1.0]));
    }

    impl Crop {
        fn part_width(self) -> f64 {
            let [left, _, right, _] = self.rest();
            ((right - left) * 1e9).round() / 1e9
        }
    }
}
