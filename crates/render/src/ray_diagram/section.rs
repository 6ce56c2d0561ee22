//! A plane section through the scene, as a panel of a diagram.

use glam::{DVec3, Vec2, vec2};

use super::{FRAME, GROUND, Group, Ink, LEVEL, Mark, RayDiagram, SURFACE, TEXT, vector};
use crate::view::letters::Letters;

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
        let direction = vector(direction);
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

// Lines of equal value in a grid of samples (marching squares, Lorensen and Cline 1987 in two dimensions).

/// Returns the line segments on which the values equal `level`. The samples are at whole coordinates, row by row. Cells
/// with a value that is not finite have no line.
pub(super) fn contour(values: &[f32], columns: usize, level: f32) -> Vec<[Vec2; 2]> {
    let mut lines = Vec::new();
    for (row, two) in values.chunks_exact(columns.max(1)).collect::<Vec<_>>().windows(2).enumerate() {
        let [upper, lower] = two else { continue };
        for (column, (upper, lower)) in upper.windows(2).zip(lower.windows(2)).enumerate() {
            let ([a, b], [d, c]) = (upper, lower) else { continue };
            let corners = [a, b, c, d].map(|value| value - level);
            if corners.iter().all(|value| value.is_finite()) {
                let low = vec2(column as f32, row as f32);
                let crossings = crossings(corners);
                lines.extend(crossings.chunks_exact(2).map(|pair| [low + pair[0], low + pair[1]]));
            }
        }
    }
    lines
}

/// Returns the points at which the border of a cell crosses 0, clockwise.
fn crossings(corners: [f32; 4]) -> Vec<Vec2> {
    let places = [vec2(0.0, 0.0), vec2(1.0, 0.0), vec2(1.0, 1.0), vec2(0.0, 1.0)];
    let mut found = Vec::new();
    for side in 0..4 {
        let (from, to) = (corners[side], corners[(side + 1) % 4]);
        if (from > 0.0) != (to > 0.0) {
            found.push(places[side].lerp(places[(side + 1) % 4], from / (from - to)));
        }
    }
    found
}

// Draws a diagram over an image on the CPU.

impl RayDiagram {
    /// Draws the diagram over an image of RGBA bytes, top row first, that has the diagram's size.
    pub fn draw_over(&self, rgba: &mut [u8]) {
        let mut letters = Letters::default();
        let width = self.size.x as usize;
        for group in &self.groups {
            let mut canvas = Canvas { rgba, width, size: self.size, group };
            for mark in &group.marks {
                canvas.draw(mark, &mut letters);
            }
        }
    }
}

struct Canvas<'a> {
    rgba: &'a mut [u8],
    width: usize,
    size: Vec2,
    group: &'a Group,
}

impl Canvas<'_> {
    fn draw(&mut self, mark: &Mark, letters: &mut Letters) {
        match mark {
            Mark::Line { from, to, width, ink } => {
                let (reach, way) = (0.5 * width, *to - *from);
                let square = way.length_squared().max(1e-9);
                self.fill(from.min(*to) - reach, from.max(*to) + reach, *ink, |at| {
                    let along = ((at - *from).dot(way) / square).clamp(0.0, 1.0);
                    reach - at.distance(*from + along * way)
                });
            }
            Mark::Circle { center, radius, width, ink } => {
                let reach = 0.5 * width;
                let around = Vec2::splat(radius + reach);
                self.fill(*center - around, *center + around, *ink, |at| {
                    reach - (at.distance(*center) - radius).abs()
                });
            }
            Mark::Disc { center, radius, ink } => {
                let around = Vec2::splat(*radius);
                self.fill(*center - around, *center + around, *ink, |at| radius - at.distance(*center));
            }
            Mark::Ground { low, high, ink } => self.fill(*low, *high, *ink, |_| 1.0),
            Mark::Text { at, size, words, ink } => {
                let line = letters.line(words, *size);
                let corner = at.round();
                for (index, cover) in line.cover.iter().enumerate().filter(|(_, cover)| **cover > 0) {
                    let place = vec2((index % line.size.0) as f32, (index / line.size.0) as f32);
                    self.put(corner + place, *ink, f32::from(*cover) / 255.0);
                }
            }
        }
    }

    /// Fills the pixels in a rectangle. `inside` returns how far a point is inside the shape, in pixels.
    fn fill(&mut self, low: Vec2, high: Vec2, ink: Ink, inside: impl Fn(Vec2) -> f32) {
        if !(low.is_finite() && high.is_finite()) {
            return;
        }
        let [clip_low, clip_high] = self.group.clip;
        let low = (low - 1.0).max(clip_low).max(Vec2::ZERO).floor();
        let high = (high + 1.0).min(clip_high).min(self.size).ceil();
        for y in low.y as usize..(high.y.max(low.y) as usize) {
            for x in low.x as usize..(high.x.max(low.x) as usize) {
                let at = vec2(x as f32, y as f32);
                let cover = (inside(at + 0.5) + 0.5).clamp(0.0, 1.0);
                if cover > 0.0 {
                    self.put(at, ink, cover);
                }
            }
        }
    }

    fn put(&mut self, at: Vec2, [red, green, blue, opacity]: Ink, cover: f32) {
        let [low, high] = self.group.clip;
        let is_inside = at.cmpge(low.max(Vec2::ZERO)).all() && at.cmplt(high.min(self.size)).all();
        let place = 4 * (at.y as usize * self.width + at.x as usize);
        let Some(pixel) = self.rgba.get_mut(place..place + 4).filter(|_| is_inside) else { return };
        let fraction = cover * f32::from(opacity) / 255.0;
        for (to, from) in pixel.iter_mut().zip([red, green, blue, 255]) {
            *to = (f32::from(*to) + (f32::from(from) - f32::from(*to)) * fraction).round() as u8;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_contour_of_a_disc_is_a_circle() {
        let side = 21;
        let values: Vec<f32> = (0..side * side)
            .map(|index| vec2((index % side) as f32, (index / side) as f32).distance(Vec2::splat(10.0)) - 6.0)
            .collect();
        for level in [0.0, 2.0] {
            let lines = contour(&values, side, level);
            assert!(lines.len() > 20);
            for end in lines.iter().flatten() {
                assert!((end.distance(Vec2::splat(10.0)) - 6.0 - level).abs() < 0.1, "{end}");
            }
        }
        assert!(contour(&[1.0, f32::NAN, -1.0, -1.0], 2, 0.0).is_empty());
        assert!(contour(&[], 0, 0.0).is_empty());
    }
}
