//! Finds a box around a scene's surfaces by interval arithmetic on its formula (Moore 1966).
//!
//! A cube that extends about 1024 from the origin is repeatedly divided into eight cubes, and slices are cut off it. A
//! cube or slice is dropped if it contains no surface at any sound, time and parameters. The search runs once per text
//! and may take about 10 ms. An infinite scene has no bounds and is traced up to a distance of 1000.
//!
//! A blend of exponentials is constant where all of the exponentials underflow in 32 bits: e^-11d underflows at d =
//! 7.9. Without bounds, rays step by that constant and end in false hits. A model beside an infinite rod still has this
//! problem, because it has no bounds. An exponential could be dropped without a change if rounding removes it from the
//! sum. But in a blend by e^-11d, its part must then be 17 / 11 = 1.6 farther away than another part, more than half
//! the size of fidget's bear.

use crate::graph::{FrameInputs, Interval};
use crate::tape::{IntervalEvaluator, Tape};

/// A box that contains all surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The lower corner.
    pub low: [f32; 3],
    /// The upper corner.
    pub high: [f32; 3],
}

impl Bounds {
    /// True if a point is in the box.
    pub fn hold(&self, place: [f32; 3]) -> bool {
        (0..3).all(|axis| self.low[axis] <= place[axis] && place[axis] <= self.high[axis])
    }

    /// Half of the largest extent.
    pub fn half(&self) -> f32 {
        (0..3).map(|axis| 0.5 * (self.high[axis] - self.low[axis])).fold(0.0, f32::max)
    }

    /// Returns the smallest box around both boxes, enlarged by `margin` on each side.
    pub fn hull(&self, other: &Self, margin: f32) -> Self {
        Self {
            low: [0, 1, 2].map(|axis| self.low[axis].min(other.low[axis]) - margin),
            high: [0, 1, 2].map(|axis| self.high[axis].max(other.high[axis]) + margin),
        }
    }

    /// Returns the cube that extends `reach` from a point along each axis.
    pub fn around(place: [f32; 3], reach: f32) -> Self {
        Self { low: place.map(|v| v - reach), high: place.map(|v| v + reach) }
    }
}

/// Half the side of the searched cube. A scene with surfaces outside of the cube has no bounds.
const REACH: f32 = 1024.0;
/// Largest searched coordinate as a multiple of [`REACH`]: about 1e7.
const FARTHEST: f32 = 8192.0;
/// Maximum number of divisions of a part of a shell around the cube. A part that is still undecided may contain a
/// surface.
const SHELL_CUTS: usize = 3;
/// Maximum number of clauses for the search of the shells: about 5 ms. Few formulas need more than a tenth of this.
const SHELL_CLAUSES_MAX: usize = 1 << 19;
/// Offset of the cube's centre from the origin, so that the first cuts do not pass through objects at the origin.
const ASIDE: f32 = 0.017 * REACH;
/// Maximum number of clauses for the search: about 10 ms.
const CLAUSES_MAX: usize = 1 << 20;
/// Cells at a face of the box are divided until they are no larger than this fraction of the box.
const PRECISION: f32 = 1.0 / 200.0;
/// Enlargement of the box on each side, as a fraction of its size, because shaders round differently from the CPU.
const MARGIN: f32 = 1.0 / 1000.0;

type Cell = Bounds;

/// Returns a box around the surfaces of a tape's first output in all frames of `any`; `None` if the surfaces are
/// unbounded or may be in every cell. A face of the box is final once a point just inside the face may be on a surface.
pub(super) fn find(tape: &Tape, any: &FrameInputs) -> Option<Bounds> {
    let mut evaluator = IntervalEvaluator::new(tape, any);
    let mut left = CLAUSES_MAX / tape.clauses().len().max(1);
    let start = Cell { low: [-REACH + ASIDE; 3], high: [REACH + ASIDE; 3] };
    let mut cells = vec![start];
    while left > 0 && cells.len() < 64 {
        let before = hull(&cells)?;
        cells = cells.iter().flat_map(|cell| divided(cell, &mut evaluator, &mut left)).collect();
        if hull(&cells).is_some_and(|hull| hull == before && cells.len() > 1) {
            break;
        }
    }
    let mut faces_done = 0;
    let mut face = 0;
    while left > 0 && faces_done < 6 {
        let box_now = hull(&cells)?;
        let (axis, upper) = (face % 3, face >= 3);
        face = (face + 1) % 6;
        let end = |cell: &Cell| if upper { cell.high[axis] } else { cell.low[axis] };
        let outermost = end(&box_now);
        let wanted = PRECISION * (box_now.high[axis] - box_now.low[axis]);
        let (touching, mut others): (Vec<Cell>, Vec<Cell>) =
            cells.into_iter().partition(|cell| (outermost - end(cell)).abs() <= wanted);
        let size = touching.iter().flat_map(|cell| [0, 1, 2].map(|axis| cell.high[axis] - cell.low[axis]));
        let size = size.fold(0.0, f32::max);
        let stays = touching.iter().any(|cell| {
            let mut point = [0, 1, 2].map(|axis| 0.5 * (cell.low[axis] + cell.high[axis]));
            point[axis] = if upper { outermost - wanted } else { outermost + wanted };
            may_hold_a_surface(&Cell { low: point, high: point }, &mut evaluator, &mut left)
        });
        if stays || size <= wanted {
            faces_done += 1;
            others.extend(touching);
        } else {
            faces_done = 0;
            for cell in touching {
                match shaved(&cell, axis, upper, wanted, &mut evaluator, &mut left) {
                    Some(rest) => others.push(rest),
                    None => others.extend(divided(&cell, &mut evaluator, &mut left)),
                }
            }
        }
        cells = others;
    }
    let found = hull(&cells)?;
    let unbounded =
        (0..3).any(|axis| found.low[axis] <= start.low[axis] || found.high[axis] >= start.high[axis]);
    if unbounded {
        return None;
    }
    if !is_free_outside(&start, &mut evaluator, tape.clauses().len()) {
        return None;
    }
    let margin = (0..3).map(|axis| found.high[axis] - found.low[axis]).fold(0.0, f32::max) * MARGIN;
    Some(Bounds { low: found.low.map(|v| v - margin), high: found.high.map(|v| v + margin) })
}

/// True if there are no surfaces between a cube and [`FARTHEST`]. The shells between cubes of doubling sizes are
/// searched separately: in a box that is wide compared with its distance, interval arithmetic cannot decide which of
/// two large terms is larger (x⁴ - 5x² over 1e3..1e7 may be below 0).
fn is_free_outside(cube: &Cell, evaluator: &mut IntervalEvaluator<'_>, clauses: usize) -> bool {
    let mut left = (SHELL_CLAUSES_MAX / clauses.max(1)).max(1);
    let mut inner = *cube;
    while inner.high[0] < FARTHEST * REACH {
        let outer = Cell { low: inner.low.map(|v| 2.0 * v), high: inner.high.map(|v| 2.0 * v) };
        let mut rest = outer;
        for face in 0..6 {
            let (axis, mut slab) = (face % 3, rest);
            if face >= 3 {
                slab.low[axis] = inner.high[axis];
                rest.high[axis] = inner.high[axis];
            } else {
                slab.high[axis] = inner.low[axis];
                rest.low[axis] = inner.low[axis];
            }
            if !is_free(&slab, SHELL_CUTS, evaluator, &mut left) {
                return false;
            }
        }
        inner = outer;
    }
    true
}

/// True if a cell contains no surface. To find out, the cell is divided up to `cuts` times, into eight parts each time.
fn is_free(cell: &Cell, cuts: usize, evaluator: &mut IntervalEvaluator<'_>, left: &mut usize) -> bool {
    if !may_hold_a_surface(cell, evaluator, left) {
        return true;
    }
    cuts > 0 && *left >= 8 && eighths(cell).all(|part| is_free(&part, cuts - 1, evaluator, left))
}

/// Returns the eighths of a cell that may contain a surface. Returns the whole cell if the budget is spent.
fn divided(cell: &Cell, evaluator: &mut IntervalEvaluator<'_>, left: &mut usize) -> Vec<Cell> {
    if *left < 8 {
        *left = 0;
        return vec![*cell];
    }
    eighths(cell).filter(|part| may_hold_a_surface(part, evaluator, left)).collect()
}

fn eighths(cell: &Cell) -> impl Iterator<Item = Cell> + '_ {
    (0..8).map(|corner| {
        let mut part = *cell;
        for axis in 0..3 {
            let middle = 0.5 * (cell.low[axis] + cell.high[axis]);
            if corner >> axis & 1 == 0 { part.high[axis] = middle } else { part.low[axis] = middle }
        }
        part
    })
}

/// Cuts the largest slice without surfaces off a face. `None` if even one of the thickness `wanted` has surfaces.
fn shaved(
    cell: &Cell,
    axis: usize,
    upper: bool,
    wanted: f32,
    evaluator: &mut IntervalEvaluator<'_>,
    left: &mut usize,
) -> Option<Cell> {
    let mut thickness = 0.5 * (cell.high[axis] - cell.low[axis]);
    while thickness >= 0.5 * wanted {
        let (mut slice, mut rest) = (*cell, *cell);
        if upper {
            rest.high[axis] -= thickness;
            slice.low[axis] = rest.high[axis];
        } else {
            rest.low[axis] += thickness;
            slice.high[axis] = rest.low[axis];
        }
        if !may_hold_a_surface(&slice, evaluator, left) {
            return Some(rest);
        }
        thickness *= 0.5;
    }
    None
}

/// True if a cell may contain a surface or be solid, or if the budget of clauses is spent.
fn may_hold_a_surface(cell: &Cell, evaluator: &mut IntervalEvaluator<'_>, left: &mut usize) -> bool {
    if *left == 0 {
        return true;
    }
    *left -= 1;
    let position = [0, 1, 2].map(|axis| Interval::new(cell.low[axis], cell.high[axis]));
    let value = evaluator.over(position, [Interval::point(0.0); 3]).first().copied();
    // A NaN may stand for a surface.
    !value.is_some_and(|value| value.lo > 0.0)
}

fn hull(cells: &[Cell]) -> Option<Bounds> {
    let (first, others) = cells.split_first()?;
    Some(others.iter().fold(*first, |hull, cell| Bounds {
        low: [0, 1, 2].map(|axis| hull.low[axis].min(cell.low[axis])),
        high: [0, 1, 2].map(|axis| hull.high[axis].max(cell.high[axis])),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lang::{compile, no_includes};
    use crate::tape::TapeOptions;
    use crate::world::testing::{SPEAKERS, world_of};

    fn bounds(text: &str) -> Option<Bounds> {
        let scene = compile("test", text, &mut no_includes).scene.unwrap();
        let tape = Tape::build(&scene.graph, &[scene.distance], &TapeOptions::default()).unwrap();
        let any = FrameInputs::any(scene.params.iter().map(|param| (param.min, param.max)));
        find(&tape, &any)
    }

    fn assert_near(found: Option<Bounds>, low: [f32; 3], high: [f32; 3], fraction: f32) {
        let found = found.expect("bounds");
        for axis in 0..3 {
            let slack = fraction * (high[axis] - low[axis]);
            assert!(found.low[axis] <= low[axis] && found.low[axis] >= low[axis] - slack, "{found:?}");
            assert!(found.high[axis] >= high[axis] && found.high[axis] <= high[axis] + slack, "{found:?}");
        }
    }

    #[test]
    fn a_ball_is_boxed_closely() {
        assert_near(bounds("length(p - vec3(5, -3, 20)) - 2"), [3.0, -5.0, 18.0], [7.0, -1.0, 22.0], 0.02);
    }

    #[test]
    fn every_sound_time_and_parameter_is_counted_in() {
        let text = "param r = 1 in 1 .. 3\nlength(p - vec3(4*sin(t), 0, 0)) - r - band(3) - volume.x";
        assert_near(bounds(text), [-9.0, -5.0, -5.0], [9.0, 5.0, 5.0], 0.02);
        assert_near(bounds("sphere(p, 1 + band(floor(x)))"), [-2.0; 3], [2.0; 3], 0.02);
    }

    #[test]
    fn infinite_shapes_have_no_bounds() {
        for text in
            ["y + 0.1*sin(x)", "sin(x)*cos(y)+sin(y)*cos(z)+sin(z)*cos(x)", "length(p.xz) - 1", "p.x - t"]
        {
            assert_eq!(bounds(text), None, "{text}");
        }
    }

    #[test]
    fn a_ball_outside_of_the_cube_is_noticed() {
        assert_eq!(bounds("min(length(p) - 1, length(p - vec3(0, 0, 1500)) - 1)"), None);
    }

    #[test]
    fn terms_that_cancel_in_large_boxes_do_not_hide_the_box() {
        let polynomial = "x^4-5*x^2 + y^4-5*y^2 + z^4-5*z^2 + 10";
        assert_near(bounds(polynomial), [-2.336; 3], [2.336; 3], 0.05);
        // Far away, rotated coordinates are 0 somewhere in any large box.
        let turned = "length(vec3(0.8*x + 0.6*y, 0.8*y - 0.6*x, z)) - 1";
        assert_near(bounds(turned), [-1.0; 3], [1.0; 3], 0.1);
        assert_eq!(bounds(&format!("min({polynomial}, length(p - vec3(0, 9000, 0)) - 1)")), None);
    }

    #[test]
    fn the_speakers_are_boxed() {
        assert_near(world_of(SPEAKERS).bounds, [-7.2, 0.0, 7.8], [7.2, 6.4, 12.2], 0.06);
    }
}
