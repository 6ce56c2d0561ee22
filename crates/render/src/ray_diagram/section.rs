//! A plane section through the scene, as a panel of a diagram.

use glam::{DVec3, Vec2, vec2};

use super::contour::contour;
use super::{FRAME, GROUND, Group, Ink, LEVEL, Mark, SURFACE, TEXT};

/// Number of samples along the longer side of a contour's grid.
const SAMPLES: usize = 72;
/// Number of lines of equal distance in half the height of a section.
const LEVELS: usize = 4;

/// A section under construction. Coordinates are in the scene's units: u along the first axis, v along the second.
pub(super) struct Section {
    place: [Vec2; 2],
    /// Size of the letters in pixels.
    unit: f32,
    origin: DVec3,
    axes: [DVec3; 2],
    /// Pixels per unit, and the pixel of the origin.
    scale: f32,
    zero: Vec2,
    marks: Vec<Mark>,
}

impl Section {
    /// Creates a section in the rectangle `place`, along `u` and the part of `towards` that is perpendicular to it. The
    /// second axis points to the same side as `up`.
    pub(super) fn new(
        place: [Vec2; 2],
        unit: f32,
        origin: DVec3,
        u: DVec3,
        towards: DVec3,
        up: DVec3,
    ) -> Self {
        let u = u.normalize_or(DVec3::Z);
        let v = (towards - u * towards.dot(u)).normalize_or(u.any_orthonormal_vector());
        let v = if v.dot(up) < 0.0 { -v } else { v };
        let marks = vec![Mark::Ground { low: place[0], high: place[1], ink: GROUND }];
        let mut section = Self { place, unit, origin, axes: [u, v], scale: 1.0, zero: place[0], marks };
        section.show([0.0, 1.0], 0.5);
        section
    }

    fn extent(&self) -> Vec2 {
        self.place[1] - self.place[0]
    }

    /// Shows this range of u over the whole width, with v = 0 at the fraction `middle` of the height.
    pub(super) fn show(&mut self, [low, high]: [f32; 2], middle: f32) {
        self.scale = self.extent().x / (high - low).max(1e-6);
        self.zero = self.place[0] + vec2(-low * self.scale, middle * self.extent().y);
    }

    /// Shows this range of v over the whole height, with u = 0 in the middle.
    pub(super) fn show_height(&mut self, [low, high]: [f32; 2]) {
        self.scale = self.extent().y / (high - low).max(1e-6);
        self.zero = vec2(self.place[0].x + 0.5 * self.extent().x, self.place[1].y + low * self.scale);
    }

    fn pixel(&self, [u, v]: [f32; 2]) -> Vec2 {
        self.zero + vec2(u, -v) * self.scale
    }

    /// Returns the components of a direction along the axes.
    pub(super) fn direction(&self, direction: [f32; 3]) -> [f32; 2] {
        let direction = DVec3::from_array(direction.map(f64::from));
        self.axes.map(|axis| direction.dot(axis) as f32)
    }

    /// Draws the surface and lines of equal distance.
    pub(super) fn contour(&mut self, distance: impl Fn([f32; 3]) -> f32) {
        let extent = self.extent();
        let step = extent.x.max(extent.y) / SAMPLES as f32;
        let (columns, rows) = ((extent.x / step).ceil() as usize + 1, (extent.y / step).ceil() as usize + 1);
        let mut values = Vec::with_capacity(columns * rows);
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
            let pixel = self.place[0] + step * vec2(column as f32, row as f32);
            let at = (pixel - self.zero) / self.scale;
            let point = self.origin + self.axes[0] * f64::from(at.x) - self.axes[1] * f64::from(at.y);
            values.push(distance(point.as_vec3().to_array()));
        }
        let between = 0.5 * extent.y / self.scale / LEVELS as f32;
        for level in (1..=2 * LEVELS).rev().chain([0]) {
            let (width, ink) =
                if level == 0 { (0.16 * self.unit, SURFACE) } else { (0.06 * self.unit, LEVEL) };
            for [from, to] in contour(&values, columns, level as f32 * between) {
                let pixel = |place: Vec2| self.place[0] + step * place;
                self.marks.push(Mark::Line { from: pixel(from), to: pixel(to), width, ink });
            }
        }
    }

    /// Draws a line whose width is in sizes of a letter.
    pub(super) fn line(&mut self, from: [f32; 2], to: [f32; 2], width: f32, ink: Ink) {
        let (from, to) = (self.pixel(from), self.pixel(to));
        self.marks.push(Mark::Line { from, to, width: width * self.unit, ink });
    }

    /// Draws a circle whose line has a width in sizes of a letter.
    pub(super) fn circle(&mut self, center: [f32; 2], radius: f32, width: f32, ink: Ink) {
        let (center, radius) = (self.pixel(center), radius * self.scale);
        self.marks.push(Mark::Circle { center, radius, width: width * self.unit, ink });
    }

    /// Draws a dot whose radius is in sizes of a letter.
    pub(super) fn disc(&mut self, center: [f32; 2], radius: f32, ink: Ink) {
        let center = self.pixel(center);
        self.marks.push(Mark::Disc { center, radius: radius * self.unit, ink });
    }

    /// Writes a line at the top.
    pub(super) fn title(&mut self, words: &str) {
        self.text(self.place[0] + 0.45 * self.unit, words);
    }

    /// Writes a line at the bottom.
    pub(super) fn write_line(&mut self, words: &str) {
        self.text(vec2(self.place[0].x + 0.45 * self.unit, self.place[1].y - 1.75 * self.unit), words);
    }

    fn text(&mut self, at: Vec2, words: &str) {
        let words = words.to_owned();
        self.marks.push(Mark::Text { at, size: self.unit, words, ink: TEXT });
    }

    /// Returns the marks with a frame around them. Texts are above all other marks.
    pub(super) fn finish(mut self) -> Group {
        let [low, high] = self.place;
        let corners = [low, vec2(high.x, low.y), high, vec2(low.x, high.y)];
        for (index, from) in corners.into_iter().enumerate() {
            let to = corners[(index + 1) % 4];
            self.marks.push(Mark::Line { from, to, width: 1.0, ink: FRAME });
        }
        self.marks.sort_by_key(|mark| matches!(mark, Mark::Text { .. }));
        Group { clip: self.place, marks: self.marks }
    }
}
