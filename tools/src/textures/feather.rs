//! A feather, and coats of overlapping feathers.

use super::canvas::{Canvas, Color, Grid, scale};
use super::noise::{gradient, mix, mix3, random, smoothstep};
use super::shape::{Point, Shape};

/// Position and look of a feather. Lengths are in units, angles in radians (0 points right, negative is up).
#[derive(Clone, Copy)]
pub struct Feather {
    pub root: Point,
    /// Direction from the root to the tip.
    pub angle: f32,
    pub length: f32,
    pub width: f32,
    /// Shape of the tip, from 0 (round) to 1 (pointed).
    pub point: f32,
    pub fringe: Color,
    /// Strength of the fringe, 0..1.
    pub fringe_strength: f32,
    /// Contrast of the fine wavy cross lines, 0..1.
    pub vermiculation: f32,
    /// Strength of the shaft line and of the barbs, 0..1.
    pub shaft: f32,
    /// Darkness of the shadow on the feathers below, 0..1.
    pub shadow: f32,
    /// Seed of the small irregularities.
    pub seed: u32,
}

impl Feather {
    /// Paints the feather. `color` returns the colour of the feather before fringe and lines are added.
    pub fn paint(&self, canvas: &mut Canvas, clip: Option<&Grid>, color: impl Fn(Point) -> Color) {
        let (sin, cos) = self.angle.sin_cos();
        let along = |[u, v]: [f32; 2]| {
            let (x, y) = (u * self.length, v * 0.5 * self.width);
            [self.root[0] + x * cos - y * sin, self.root[1] + x * sin + y * cos]
        };
        let tip = mix(0.62, 0.30, self.point);
        let half = [[0.0, 0.30], [0.22, 0.82], [0.52, 1.0], [0.78, mix(0.92, 0.78, self.point)], [0.93, tip]];
        let mut outline = vec![[0.0, -0.0], [1.0, 0.0]];
        outline.splice(1..1, half.iter().map(|&[u, v]| [u, -v]));
        outline.extend(half.iter().rev().copied());
        let shape = Shape::smooth(&outline.into_iter().map(along).collect::<Vec<_>>());

        let soft = 0.09 * self.width + 1.0;
        canvas.darken(&shape, clip, soft, self.shadow);
        canvas.fill(&shape, clip, 0.3, |p, d| {
            let (dx, dy) = (p[0] - self.root[0], p[1] - self.root[1]);
            let u = (dx * cos + dy * sin) / self.length;
            let v = (dy * cos - dx * sin) / (0.5 * self.width);
            let mut c = color(p);
            if self.vermiculation > 0.0 {
                let wobble = gradient(p[0] * 0.11, p[1] * 0.11, [1 << 16; 2], self.seed);
                let line = (u * self.length * 1.15 - 3.0 * v * v + 3.2 * wobble).sin();
                c = scale(c, 1.0 + 0.42 * self.vermiculation * line);
            }
            let barb = ((u * 1.3 - v.abs() * 0.55) * self.length * 1.25).sin();
            let shaft = smoothstep(1.3, 0.3, v.abs() * 0.5 * self.width) * smoothstep(1.0, 0.8, u);
            c = scale(c, 1.0 + self.shaft * (0.07 * barb - 0.45 * shaft));
            c = scale(c, mix(0.74, 1.08, smoothstep(0.1, 0.95, u)));
            let edge = smoothstep(-(0.12 * self.width + 1.2), -0.4, d) * smoothstep(0.25, 0.75, u);
            (mix3(c, self.fringe, self.fringe_strength * edge), 1.0)
        });
    }
}

/// Returns the points of a jittered grid over a box, sorted from right to left, each with a different seed.
///
/// `step` is the cell size; odd columns are shifted by half a step.
pub fn scatter(low: Point, high: Point, step: Point, seed: u32) -> Vec<(Point, u32)> {
    let columns = ((high[0] - low[0]) / step[0]) as i32;
    let rows = ((high[1] - low[1]) / step[1]) as i32;
    let mut points = Vec::new();
    for i in (0..=columns).rev() {
        for j in 0..=rows {
            let shift = if i % 2 == 0 { 0.0 } else { 0.5 };
            let x = low[0] + step[0] * (i as f32 + 0.35 * (random(i, j, seed) - 0.5));
            let y = low[1] + step[1] * (j as f32 + shift + 0.35 * (random(i, j, seed + 1) - 0.5));
            points.push(([x, y], seed + (i * 97 + j) as u32));
        }
    }
    points
}
