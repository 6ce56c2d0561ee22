//! Finds a box around a scene's surfaces by interval arithmetic on its formula (Moore 1966).
//!
//! Cubes of halving sizes are divided into 64 cells each, from 1e7 inwards, until a cell outside of the next cube may
//! contain a surface. From then on, the outermost cell at each face of the box is divided again and again. A cell is
//! dropped if it contains no surface at any sound, time and parameters. The formula is shortened for the parts of each
//! divided cell, so that a union of many things is searched almost as fast as the few things in a cell. The search
//! runs once per text. It takes 10 to 40 ms, or as long as 60 evaluations of the whole formula in 64 cells. An infinite
//! scene has no bounds and is traced up to a distance of 1000.
//!
//! A blend of exponentials is constant where all of the exponentials underflow in 32 bits: e^-11d underflows at d =
//! 7.9. Without bounds, rays step by that constant and end in false hits. A model beside an infinite rod still has this
//! problem, because it has no bounds. An exponential could be dropped without a change if rounding removes it from the
//! sum. But in a blend by e^-11d, its part must then be 17 / 11 = 1.6 farther away than another part, more than half
//! the size of fidget's bear.

use std::rc::Rc;

use super::outermost::{Part, Parts, end};
use crate::graph::{FrameInputs, Graph, GraphError, Interval, NodeId};
use crate::region::every_frame::{BoxProgram, EveryFrame};

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

    /// The largest extent.
    pub(super) fn size(&self) -> f32 {
        (0..3).map(|axis| self.high[axis] - self.low[axis]).fold(0.0, f32::max)
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

/// Surfaces farther than about this from the origin leave a scene without bounds.
const REACH: f32 = 1024.0;
/// Half the side of the searched cube as a multiple of [`REACH`]: about 1e7.
const FARTHEST: f32 = 8192.0;
/// Half the side of the smallest cube that is searched as a shell.
const SHELL_MIN: f32 = 1.0 / 64.0;
/// Maximum number of divisions of a part of a shell beyond [`REACH`]. A part that is still undecided may contain a
/// surface.
const SHELL_CUTS: usize = 2;
/// Offset of the cube's centre from the origin, so that the first cuts do not pass through objects at the origin.
const ASIDE: f32 = 0.017 * REACH;
/// Maximum number of steps for the search, each of which takes about 50 ns for 64 cells.
const STEPS_MAX: usize = 3 << 18;
/// A long program may take as many steps as this many runs of the whole program.
const WHOLE_RUNS_MAX: usize = 40;
/// Dividing a cell takes about as long as this number of steps, in addition to the steps of its program.
const STEPS_BESIDE: usize = 128;
/// Cells at a face of the box are divided until they are no thicker than this fraction of the box.
const PRECISION: f32 = 1.0 / 400.0;
/// Largest width of such a cell, as a multiple of its greatest thickness.
const WIDTHS: f32 = 4.0;
/// If a program has more steps than this, each part of its cell gets a program of its own, because running a shared
/// program would take longer than shortening it again.
const OWN_MIN: usize = 256;
/// With longer programs, cells are divided without cutting slices off them.
const TRIMMED_MAX: usize = 512;
/// Number of slices of a cell across each axis. Points are tested in the remaining lanes.
const SLICES: usize = 16;
/// Enlargement of the box on each side, as a fraction of its size, because shaders round differently from the CPU.
const MARGIN: f32 = 1.0 / 1000.0;

type Cell = Bounds;

/// The inner 2x2x2 of the 4x4x4 cells of a cube.
const INNER: u64 = 0x0000_0660_0660_0000;

struct Search<'a> {
    distance: EveryFrame<'a>,
    /// Number of steps that may still be run.
    left: usize,
}

/// Returns a box around the surfaces of a distance in all frames of `any`; `None` if the surfaces are unbounded or may
/// be in every cell. The outermost cell at a face is divided until it is thin enough.
///
/// # Errors
/// Fails if the graph has too many nodes.
pub(super) fn find(graph: &Graph, distance: NodeId, any: &FrameInputs) -> Result<Option<Bounds>, GraphError> {
    let (distance, whole) = EveryFrame::new(graph, distance, any)?;
    let steps = STEPS_MAX.max(WHOLE_RUNS_MAX * whole.len());
    let mut search = Search { distance, left: steps };
    let Some(parts) = search.outer_parts(&whole) else { return Ok(None) };
    search.left = steps;
    Ok(search.box_around(parts))
}

impl Search<'_> {
    /// Divides the outermost of the given cells until the faces of the box around them are known.
    fn box_around(mut self, parts: Vec<Part>) -> Option<Bounds> {
        let mut parts = Parts::of(parts);
        // How far out a point of a surface or a solid is known at each face.
        let mut reached = [f32::NEG_INFINITY; 6];
        let (mut faces_done, mut face) = (0, 0);
        while faces_done < 6 && self.left > 0 {
            let axis = face % 3;
            let around = parts.hull()?;
            let wanted = PRECISION * (around.high[axis] - around.low[axis]);
            let mut part = parts.take_outermost(face)?;
            let (before, size) = (end(&part.cell, face), part.cell.size());
            let thickness = part.cell.high[axis] - part.cell.low[axis];
            let is_small = thickness <= wanted && size <= WIDTHS * wanted;
            if is_small || before - reached[face] <= wanted {
                parts.put(part);
                faces_done += 1;
                face = (face + 1) % 6;
                continue;
            }
            faces_done = 0;
            if !part.is_trimmed && part.program.len() <= TRIMMED_MAX {
                let Some((cell, out)) = self.trimmed(&part, face, 0.5 * wanted) else { continue };
                (part.cell, part.is_trimmed) = (cell, true);
                reached[face] = reached[face].max(out);
            }
            if end(&part.cell, face) < before {
                parts.put(part);
            } else {
                self.divided(&part).into_iter().for_each(|part| parts.put(part));
            }
            face = (face + 1) % 6;
        }
        let found = parts.hull()?;
        let margin = found.size() * MARGIN;
        Some(found.hull(&found, margin))
    }

    fn spend(&mut self, steps: usize) {
        self.left = self.left.saturating_sub(steps);
    }

    /// Returns the cells that may contain a surface or be solid, as a mask.
    fn open(&mut self, program: &BoxProgram, cells: &[Cell]) -> u64 {
        self.spend(STEPS_BESIDE + program.len());
        let sides = |cell: &Cell| [0, 1, 2].map(|axis| Interval::new(cell.low[axis], cell.high[axis]));
        self.distance.open(program, &cells.iter().map(sides).collect::<Vec<_>>())
    }

    /// Returns the cells of a mask, which have just been bounded, with programs for them.
    fn parts_of(&mut self, program: &Rc<BoxProgram>, cells: &[Cell], open: u64) -> Vec<Part> {
        let part = |cell: &Cell, program| Part { cell: *cell, program, is_trimmed: false };
        let is_open = |(place, _): &(usize, &Cell)| open >> place & 1 == 1;
        let cells = cells.iter().enumerate().filter(is_open).map(|(_, cell)| cell);
        if program.len() <= OWN_MIN {
            let program = self.distance.shortened(program, open);
            return cells.map(|cell| part(cell, program.clone())).collect();
        }
        let programs = self.distance.shortened_each(program, open);
        cells.zip(programs).map(|(cell, program)| part(cell, program)).collect()
    }

    /// Returns the 64ths of a cell that may contain a surface or be solid.
    fn divided(&mut self, part: &Part) -> Vec<Part> {
        let cells = sixty_fourths(&part.cell);
        let open = self.open(&part.program, &cells);
        self.parts_of(&part.program, &cells, open)
    }

    /// Cuts slices without surfaces off all faces of a cell; `None` if nothing is left. Also returns how far out a
    /// point of a surface or a solid is known, after a look at some points at a depth below a face.
    fn trimmed(&mut self, part: &Part, face: usize, depth: f32) -> Option<(Cell, f32)> {
        let mut trimmed = part.cell;
        let below = points_below(&part.cell, face, depth);
        let tested: Vec<Cell> = (0..3).flat_map(|axis| slices(&part.cell, axis)).chain(below).collect();
        let open = self.open(&part.program, &tested);
        for (axis, slices) in tested.chunks_exact(SLICES).take(3).enumerate() {
            let is_open = |slice: &usize| open >> (SLICES * axis + slice) & 1 == 1;
            trimmed.low[axis] = slices[(0..SLICES).find(is_open)?].low[axis];
            trimmed.high[axis] = slices[(0..SLICES).rfind(is_open)?].high[axis];
        }
        let is_reached = open >> (3 * SLICES) != 0;
        Some((trimmed, if is_reached { end(&part.cell, face) - depth } else { f32::NEG_INFINITY }))
    }

    /// Searches shells around cubes of halving sizes. Returns the cells that may contain a surface: those of the first
    /// shell that is not empty, and the cube in this shell. `None` if surfaces may be beyond [`REACH`].
    ///
    /// A cell of a shell is as long as its distance from the middle, so intervals of rotated coordinates do not contain
    /// 0 there. In a cell that is wide compared with its distance, they do, and interval arithmetic cannot decide which
    /// of two large terms is larger (x⁴ - 5x² over 1e3..1e7 may be below 0).
    fn outer_parts(&mut self, whole: &Rc<BoxProgram>) -> Option<Vec<Part>> {
        let mut program = whole.clone();
        let mut half = FARTHEST * REACH;
        loop {
            let cells = sixty_fourths(&Cell::around([ASIDE; 3], half));
            let open = self.open(&program, &cells);
            let of_shell = open & !INNER;
            if half > REACH {
                let shell = self.parts_of(&program, &cells, of_shell);
                if !shell.iter().all(|part| self.is_free(part, SHELL_CUTS)) {
                    return None;
                }
                // Bound the inner cells again, because other cells have been bounded since.
                if of_shell != 0 {
                    self.open(&program, &cells);
                }
            } else if of_shell != 0 || half < SHELL_MIN {
                return Some(self.parts_of(&program, &cells, open));
            }
            if open & INNER == 0 {
                return None;
            }
            program = self.distance.shortened(&program, open & INNER);
            half *= 0.5;
        }
    }

    /// True if a cell contains no surface. To find out, the cell is divided up to `cuts` times.
    fn is_free(&mut self, part: &Part, cuts: usize) -> bool {
        cuts > 0 && self.left > 0 && self.divided(part).iter().all(|part| self.is_free(part, cuts - 1))
    }
}

/// Divides a cell into 64 equal cells that are about as long as wide.
fn sixty_fourths(cell: &Cell) -> [Cell; 64] {
    let mut counts = [1; 3];
    let side = |axis: usize, count: usize| (cell.high[axis] - cell.low[axis]) / count as f32;
    for _ in 0..6 {
        let longest = (1..3).fold(0, |longest, axis| {
            if side(axis, counts[axis]) > side(longest, counts[longest]) { axis } else { longest }
        });
        counts[longest] *= 2;
    }
    std::array::from_fn(|part| {
        let place = [part % counts[0], part / counts[0] % counts[1], part / (counts[0] * counts[1])];
        let mut child = *cell;
        for axis in 0..3 {
            (child.low[axis], child.high[axis]) = slice(cell, axis, place[axis], counts[axis]);
        }
        child
    })
}

/// Cuts a cell into [`SLICES`] slices across an axis.
fn slices(cell: &Cell, axis: usize) -> impl Iterator<Item = Cell> {
    (0..SLICES).map(move |place| {
        let mut part = *cell;
        (part.low[axis], part.high[axis]) = slice(cell, axis, place, SLICES);
        part
    })
}

/// Returns 16 points at a depth below a face of a cell.
fn points_below(cell: &Cell, face: usize, depth: f32) -> impl Iterator<Item = Cell> {
    let (axis, out) = (face % 3, end(cell, face) - depth);
    (0..16).map(move |place| {
        let along = |axis: usize, place: usize| {
            cell.low[axis] + (cell.high[axis] - cell.low[axis]) * ((place as f32 + 0.5) / 4.0)
        };
        let mut point = [if face < 3 { -out } else { out }; 3];
        point[(axis + 1) % 3] = along((axis + 1) % 3, place % 4);
        point[(axis + 2) % 3] = along((axis + 2) % 3, place / 4);
        Cell { low: point, high: point }
    })
}

/// Returns the extent of one of `count` equal slices. Neighbours have exactly the same face in common.
fn slice(cell: &Cell, axis: usize, place: usize, count: usize) -> (f32, f32) {
    let (low, high) = (cell.low[axis], cell.high[axis]);
    let face = |place: usize| match place == count {
        true => high,
        false => low + (high - low) * (place as f32 / count as f32),
    };
    (face(place), face(place + 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lang::{compile, no_includes};
    use crate::world::testing::{SPEAKERS, world_of};

    fn bounds(text: &str) -> Option<Bounds> {
        let scene = compile("test", text, &mut no_includes).scene.unwrap();
        let any = FrameInputs::any(scene.params.iter().map(|param| (param.min, param.max)));
        find(&scene.graph, scene.distance, &any).unwrap()
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
        // In a cell where floor(x) is a number, the band is still unknown.
        let row = "union(for i in 0..8: sphere(p - vec3(2 * i, 0, 0), 1 + band(floor(x))))";
        assert_near(bounds(row), [-2.0; 3], [16.0, 2.0, 2.0], 0.02);
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

    /// Regression: the search ran the whole formula for each cube, so the box was as large as the first cubes.
    #[test]
    fn a_union_of_a_thousand_things_is_boxed_closely() {
        // The things are smaller than 0.56, so their union reaches from 6.0 to 6.56 at each face.
        assert_near(bounds(include_str!("../../benches/things.scene")), [-6.0; 3], [6.0; 3], 0.07);
    }

    #[test]
    fn rotations_do_not_enlarge_the_box() {
        // A box of half side 0.3 reaches 0.3 to 0.52 along each axis.
        let place = "3 * vec3(sin(i), cos(3 * i), sin(2 * i))";
        let thing = format!("box(rotate(p - {place}, vec3(1, sin(5 * i), 2), i), vec3(0.3))");
        assert_near(bounds(&format!("union(for i in 0..100: {thing})")), [-3.0; 3], [3.0; 3], 0.1);
    }
}
