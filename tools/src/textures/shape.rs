//! Flat shapes with an exact signed distance: closed polygons made from splines.
//!
//! Lengths are in units of the image (1024 units wide), x to the right, y down.

pub type Point = [f32; 2];

/// Points per span of a spline.
const STEPS: usize = 10;

pub struct Shape {
    points: Vec<Point>,
    low: Point,
    high: Point,
}

impl Shape {
    /// A closed polygon through `points`.
    pub fn polygon(points: Vec<Point>) -> Self {
        let fold = |start: f32, axis: usize, pick: fn(f32, f32) -> f32| {
            points.iter().map(|p| p[axis]).fold(start, pick)
        };
        let low = [fold(f32::MAX, 0, f32::min), fold(f32::MAX, 1, f32::min)];
        let high = [fold(f32::MIN, 0, f32::max), fold(f32::MIN, 1, f32::max)];
        Self { points, low, high }
    }

    /// A smooth closed curve through `knots`.
    pub fn smooth(knots: &[Point]) -> Self {
        let n = knots.len();
        let spans = (0..n)
            .flat_map(|i| span([knots[(i + n - 1) % n], knots[i], knots[(i + 1) % n], knots[(i + 2) % n]]));
        Self::polygon(spans.collect())
    }

    /// A closed outline of smooth open curves that meet at corners.
    pub fn joined(curves: &[&[Point]]) -> Self {
        Self::polygon(curves.iter().flat_map(|knots| open_curve(knots)).collect())
    }

    /// An ellipse with the half axes `radii`, rotated by `angle` radians.
    pub fn ellipse(center: Point, radii: Point, angle: f32) -> Self {
        let (sin, cos) = angle.sin_cos();
        let points = (0..48).map(|i| {
            let (s, c) = (i as f32 / 48.0 * std::f32::consts::TAU).sin_cos();
            let (x, y) = (radii[0] * c, radii[1] * s);
            [center[0] + x * cos - y * sin, center[1] + x * sin + y * cos]
        });
        Self::polygon(points.collect())
    }

    /// A brush stroke along a smooth curve. `widths` has the full width at each knot.
    pub fn stroke(knots: &[Point], widths: &[f32]) -> Self {
        let line = open_curve(knots);
        let width_at = |i: usize| {
            let at = i as f32 / STEPS as f32;
            let k = (at as usize).min(widths.len() - 2);
            widths[k] + (widths[k + 1] - widths[k]) * (at - k as f32)
        };
        let side = |sign: f32| {
            let line = &line;
            (0..line.len()).map(move |i| {
                let (a, b) = (line[i.saturating_sub(1)], line[(i + 1).min(line.len() - 1)]);
                let (tx, ty) = (b[0] - a[0], b[1] - a[1]);
                let half = sign * 0.5 * width_at(i) / tx.hypot(ty).max(1e-6);
                [line[i][0] - ty * half, line[i][1] + tx * half]
            })
        };
        Self::polygon(side(1.0).chain(side(-1.0).rev()).collect())
    }

    pub fn bounds(&self) -> (Point, Point) {
        (self.low, self.high)
    }

    /// Returns the distance to the outline, negative inside (by the even-odd rule).
    pub fn distance(&self, p: Point) -> f32 {
        let mut nearest = f32::MAX;
        let mut inside = false;
        let mut a = self.points[self.points.len() - 1];
        for &b in &self.points {
            let (ex, ey) = (b[0] - a[0], b[1] - a[1]);
            let (wx, wy) = (p[0] - a[0], p[1] - a[1]);
            let t = ((wx * ex + wy * ey) / (ex * ex + ey * ey).max(1e-12)).clamp(0.0, 1.0);
            let (dx, dy) = (wx - t * ex, wy - t * ey);
            nearest = nearest.min(dx * dx + dy * dy);
            if (a[1] > p[1]) != (b[1] > p[1]) && wx < wy * ex / ey {
                inside = !inside;
            }
            a = b;
        }
        if inside { -nearest.sqrt() } else { nearest.sqrt() }
    }
}

/// Returns points of the open Catmull-Rom curve through `knots`, including both ends.
fn open_curve(knots: &[Point]) -> Vec<Point> {
    let last = knots.len() - 1;
    let mut points: Vec<Point> = (0..last)
        .flat_map(|i| span([knots[i.saturating_sub(1)], knots[i], knots[i + 1], knots[(i + 2).min(last)]]))
        .collect();
    points.push(knots[last]);
    points
}

/// Returns points of a Catmull-Rom span, from the second knot up to but not including the third.
fn span(k: [Point; 4]) -> impl Iterator<Item = Point> {
    (0..STEPS).map(move |i| {
        let t = i as f32 / STEPS as f32;
        let blend = |axis: usize| {
            let [a, b, c, d] = k.map(|p| p[axis]);
            b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)))
        };
        [blend(0), blend(1)]
    })
}
