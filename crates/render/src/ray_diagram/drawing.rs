//! Draws a diagram over an image on the CPU.

use glam::{Vec2, vec2};

use super::{Group, Ink, Mark, RayDiagram};
use crate::view::letters::Letters;

impl RayDiagram {
    /// Draws the diagram over an image of RGBA bytes, top row first, that has the diagram's size.
    pub fn draw_over(&self, rgba: &mut [u8]) {
        let mut letters = Letters::new();
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
