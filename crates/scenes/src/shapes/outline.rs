//! Outlines of letters and drawings, and the fraction of each pixel that they cover.
//!
//! A pixel's coverage is exact for straight edges: the signed area to the right of each edge is added up along each row.
//! Curves become straight edges first ([`FLATNESS`]). All steps are counted, which limits the time for an outline.

use kurbo::{Affine, BezPath, CubicBez, ParamCurve, PathEl, Point, QuadBez};

/// Largest distance of a curve from its straight edges, in pixels.
const FLATNESS: f64 = 0.05;

/// How often a curve is halved at most: a curve of a million times the picture's width is then shorter than a pixel.
const HALVINGS_MAX: usize = 32;

/// An outline needs more steps than allowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TooMuchWork;

/// Steps that are left: pixels that are computed, and pixels through which edges go.
#[derive(Debug, Clone, Copy)]
pub(super) struct Steps(pub usize);

impl Steps {
    pub(super) fn spend(&mut self, steps: usize) -> Result<(), TooMuchWork> {
        self.0 = self.0.checked_sub(steps).ok_or(TooMuchWork)?;
        Ok(())
    }
}

/// Which regions of an outline are inside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Filling {
    /// Regions around which the outline turns.
    Turning,
    /// Regions around which the outline turns an odd number of times.
    Odd,
}

/// The covered fraction of each pixel, 0..1, row after row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Coverage {
    pub width: usize,
    pub height: usize,
    pub values: Vec<f32>,
}

impl Coverage {
    pub(super) fn none(width: usize, height: usize) -> Self {
        Self { width, height, values: vec![0.0; width * height] }
    }

    /// Covers the inside of a path in pixels. Returns the coverage of the path alone.
    ///
    /// # Errors
    /// Fails if no steps are left.
    pub(super) fn of(
        path: &BezPath,
        filling: Filling,
        width: usize,
        height: usize,
        steps: &mut Steps,
    ) -> Result<Self, TooMuchWork> {
        steps.spend(width * height)?;
        let mut edges = Edges::new(width, height, steps);
        let (mut at, mut start) = (Point::ORIGIN, Point::ORIGIN);
        for element in path {
            let to = match element {
                PathEl::MoveTo(_) | PathEl::ClosePath => start,
                PathEl::LineTo(to) | PathEl::QuadTo(_, to) | PathEl::CurveTo(_, _, to) => to,
            };
            match element {
                PathEl::QuadTo(control, _) => edges.add_curve(QuadBez::new(at, control, to).raise(), 0)?,
                PathEl::CurveTo(first, second, _) => {
                    edges.add_curve(CubicBez::new(at, first, second, to), 0)?;
                }
                _ => edges.add(at, to)?,
            }
            at = to;
            if let PathEl::MoveTo(to) = element {
                (at, start) = (to, to);
            }
        }
        edges.add(at, start)?;
        Ok(edges.coverage(filling))
    }

    /// Mixes `shade` into the pixels under the inside of a path.
    pub(super) fn paint(&mut self, part: &CoveredPart, shade: f32) {
        let own = &part.coverage;
        for (row, line) in own.values.chunks_exact(own.width).enumerate() {
            let first = (part.top + row) * self.width + part.left;
            let under = self.values.get_mut(first..first + own.width).unwrap_or_default();
            for (value, own) in under.iter_mut().zip(line) {
                *value += (shade - *value) * own;
            }
        }
    }
}

/// The coverage of the smallest rectangle of pixels around a path.
#[derive(Debug)]
pub(super) struct CoveredPart {
    pub left: usize,
    pub top: usize,
    pub coverage: Coverage,
}

impl CoveredPart {
    /// Returns the part of a picture of this size that a path covers; `None` if it covers nothing.
    ///
    /// # Errors
    /// Fails if no steps are left.
    pub(super) fn of(
        path: &BezPath,
        filling: Filling,
        size: (usize, usize),
        steps: &mut Steps,
    ) -> Result<Option<Self>, TooMuchWork> {
        let bounds = path.control_box();
        let side = |low: f64, high: f64, count: usize| {
            let (first, end) = (low.floor().max(0.0), high.ceil().min(count as f64));
            (bounds.is_finite() && first < end).then_some((first as usize, end as usize))
        };
        let (columns, rows) = (side(bounds.x0, bounds.x1, size.0), side(bounds.y0, bounds.y1, size.1));
        let (Some((left, right)), Some((top, bottom))) = (columns, rows) else { return Ok(None) };
        let moved = Affine::translate((-(left as f64), -(top as f64))) * path;
        let coverage = Coverage::of(&moved, filling, right - left, bottom - top, steps)?;
        Ok(Some(Self { left, top, coverage }))
    }
}

/// For each pixel, by how much the winding number's integral changes from the previous pixel. Rows have two more
/// pixels, for edges to the right of the picture.
struct Edges<'s> {
    width: usize,
    height: usize,
    changes: Vec<f32>,
    steps: &'s mut Steps,
}

impl<'s> Edges<'s> {
    fn new(width: usize, height: usize, steps: &'s mut Steps) -> Self {
        Self { width, height, changes: vec![0.0; (width + 2) * height], steps }
    }

    /// Adds the straight edges of a curve. A piece that is beyond one side of the picture is one edge: only its ends
    /// matter to the pixels.
    fn add_curve(&mut self, curve: CubicBez, halvings: usize) -> Result<(), TooMuchWork> {
        self.steps.spend(1)?;
        let CubicBez { p0, p1, p2, p3 } = curve;
        let beyond = |low: f64, high: f64, size: usize| high <= 0.0 || low >= size as f64;
        let least = |a: f64, b: f64, c: f64, d: f64| (a.min(b).min(c.min(d)), a.max(b).max(c.max(d)));
        let (left, right) = least(p0.x, p1.x, p2.x, p3.x);
        let (top, bottom) = least(p0.y, p1.y, p2.y, p3.y);
        // A curve differs from its chord by at most an eighth of its largest second derivative.
        let bend = (p0.to_vec2() - 2.0 * p1.to_vec2() + p2.to_vec2()).hypot();
        let bend = bend.max((p1.to_vec2() - 2.0 * p2.to_vec2() + p3.to_vec2()).hypot());
        let is_edge = beyond(left, right, self.width)
            || beyond(top, bottom, self.height)
            || 0.75 * bend <= FLATNESS
            || halvings >= HALVINGS_MAX;
        if is_edge {
            return self.add(p0, p3);
        }
        let (first, second) = curve.subdivide();
        self.add_curve(first, halvings + 1)?;
        self.add_curve(second, halvings + 1)
    }

    fn add(&mut self, from: Point, to: Point) -> Result<(), TooMuchWork> {
        let (upper, lower, sign) = if from.y <= to.y { (from, to, 1.0) } else { (to, from, -1.0) };
        let ((x0, y0), (x1, y1)) = ((upper.x, upper.y), (lower.x, lower.y));
        let (top, bottom) = (y0.max(0.0), y1.min(self.height as f64));
        if !(from.is_finite() && to.is_finite()) || top >= bottom {
            return Ok(());
        }
        let column = |x: f64| x.clamp(0.0, self.width as f64);
        self.steps.spend((bottom - top + (column(x1) - column(x0)).abs()) as usize + 1)?;
        let slope = (x1 - x0) / (y1 - y0);
        let x_at = |y: f64| (x0 + (y - y0) * slope).clamp(x0.min(x1), x0.max(x1));
        for row in top as usize..(bottom.ceil() as usize).min(self.height) {
            let (upper, lower) = (top.max(row as f64), bottom.min((row + 1) as f64));
            self.add_in_row(row, x_at(upper), x_at(lower), sign * (lower - upper));
        }
        Ok(())
    }

    /// Adds an edge within a row, which falls by `fall` pixels between its ends.
    fn add_in_row(&mut self, row: usize, x0: f64, x1: f64, fall: f64) {
        let right = self.width as f64;
        let (left_end, right_end) = (x0.min(x1), x0.max(x1));
        let per_x = if right_end > left_end { fall / (right_end - left_end) } else { 0.0 };
        // The parts beyond the picture count at its sides.
        let before = (left_end.min(0.0) - right_end.min(0.0)).abs();
        let after = (right_end.max(right) - left_end.max(right)).abs();
        if before > 0.0 {
            self.put(row, 0.0, before * per_x);
        }
        if after > 0.0 {
            self.put(row, right, after * per_x);
        }
        let (first, last) = (left_end.clamp(0.0, right), right_end.clamp(0.0, right));
        if last <= first {
            if before == 0.0 && after == 0.0 {
                self.put(row, first, fall);
            }
            return;
        }
        let mut at = first;
        while at < last {
            let next = (at.floor() + 1.0).min(last);
            self.put(row, 0.5 * (at + next), (next - at) * per_x);
            at = next;
        }
    }

    /// Adds a piece of an edge whose middle is at `x`.
    fn put(&mut self, row: usize, x: f64, fall: f64) {
        let column = (x as usize).min(self.width);
        let part = x - column as f64;
        let at = row * (self.width + 2) + column;
        if let Some([first, second]) = self.changes.get_mut(at..at + 2) {
            *first += (fall * (1.0 - part)) as f32;
            *second += (fall * part) as f32;
        }
    }

    fn coverage(self, filling: Filling) -> Coverage {
        let mut values = Vec::with_capacity(self.width * self.height);
        for row in self.changes.chunks_exact(self.width + 2) {
            let mut turns = 0.0_f32;
            values.extend(row.iter().take(self.width).map(|change| {
                turns += change;
                match filling {
                    Filling::Turning => turns.abs().min(1.0),
                    Filling::Odd => 1.0 - (1.0 - turns.abs() % 2.0).abs(),
                }
            }));
        }
        Coverage { width: self.width, height: self.height, values }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(text: &str) -> BezPath {
        BezPath::from_svg(text).unwrap()
    }

    fn covered(path: &BezPath, filling: Filling, size: (usize, usize)) -> Coverage {
        Coverage::of(path, filling, size.0, size.1, &mut Steps(1_000)).unwrap()
    }

    fn area(text: &str, filling: Filling) -> f32 {
        covered(&path(text), filling, (10, 8)).values.iter().sum()
    }

    #[test]
    fn areas_are_exact() {
        for (text, turning, odd) in [
            ("M1 1 H9 V7 H1 Z", 48.0, 48.0),
            ("M1.25 1.5 V3 H4.5 V1.5", 4.875, 4.875),
            ("M0 0 L10 8 L0 8", 40.0, 40.0),
            ("M5 0.5 L9.5 4 L5 7.5 L0.5 4 Z", 31.5, 31.5),
            ("M-5 -5 H20 V20 H-5 Z", 80.0, 80.0),
            ("M-5 2 L5 2 L5 4 L-5 4 Z M8 2 H30 V4 H8 Z", 14.0, 14.0),
            // Two squares that overlap: one direction, and opposite directions.
            ("M1 1 H5 V5 H1 Z M3 3 H7 V7 H3 Z", 28.0, 24.0),
            ("M1 1 H5 V5 H1 Z M2 2 V4 H4 V2 Z", 12.0, 12.0),
            ("M1 1 H5", 0.0, 0.0),
        ] {
            assert!((area(text, Filling::Turning) - turning).abs() < 1e-3, "{text}");
            assert!((area(text, Filling::Odd) - odd).abs() < 1e-3, "{text}");
        }
        let disc = area("M2 4 A3 3 0 0 1 8 4 A3 3 0 0 1 2 4 Z", Filling::Turning);
        assert!((disc - 28.274).abs() < 0.5, "{disc}");
    }

    #[test]
    fn a_pixel_holds_the_fraction_that_is_covered() {
        let half = covered(&path("M0 0 L2 0 L0 2 Z"), Filling::Turning, (2, 2));
        assert_eq!(half.values, [1.0, 0.5, 0.5, 0.0]);
        let mut picture = Coverage::none(4, 3);
        let part = CoveredPart::of(&path("M2 1 L4 1 L2 3 Z"), Filling::Turning, (4, 3), &mut Steps(99));
        let part = part.unwrap().unwrap();
        assert_eq!((part.left, part.top, &part.coverage), (2, 1, &half));
        picture.paint(&part, 1.0);
        picture.paint(&part, 1.0);
        assert_eq!(picture.values[4..], [0.0, 0.0, 1.0, 0.75, 0.0, 0.0, 0.75, 0.0]);
        picture.paint(&part, 0.0);
        assert_eq!(picture.values[4..], [0.0, 0.0, 0.0, 0.375, 0.0, 0.0, 0.375, 0.0]);
        let mut wild = path("M1 1 H9 V7 Z");
        wild.line_to((f64::NAN, 1e300));
        assert!(covered(&wild, Filling::Odd, (9, 9)).values.iter().all(|value| value.is_finite()));
    }
}
