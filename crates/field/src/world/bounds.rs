//! Finds a box around a scene's surfaces by interval arithmetic on its formula (Moore 1966).
//!
//! Cubes of shrinking sizes are divided into 64 cells each, from 1e7 inwards, until a cell outside of the next cube may
//! contain a surface. From then on, the outermost cells at each face of the box are cut and divided again and again, 16
//! cells at once. A cell or a slice of a cell is dropped if it contains no surface at any sound, time and parameters. A
//! long formula is shortened for the parts of each divided cell, so that a union of many things is searched almost as
//! fast as the few things in a cell. The search runs once or twice per text. It takes 0.5 to 8 ms, or as long as 45
//! evaluations of the whole formula in 64 cells. An infinite scene has no bounds and is traced up to a distance of 1000.
//!
//! Intervals cannot bound some shapes: the sides of an octahedron or a triangle are decided by comparisons of numbers that
//! depend on each other. If such a value is a distance and no estimate, the search runs again and also takes the distance
//! from the middle of each cell. This takes about twice the time.
//!
//! A blend of exponentials is constant where all of the exponentials underflow in 32 bits: e^-11d underflows at d =
//! 7.9. Without bounds, rays step by that constant and end in false hits. A model beside an infinite rod still has this
//! problem, because it has no bounds. An exponential could be dropped without a change if rounding removes it from the
//! sum. But in a blend by e^-11d, its part must then be 17 / 11 = 1.6 farther away than another part, more than half
//! the size of fidget's bear.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::rc::Rc;

use super::cells::{NESTED, PIECES, below, nested, pieces, sixty_fourths};
use super::distance_check::STEEPEST;
use crate::bounds::Bounds;
use crate::graph::{FrameInputs, Graph, NodeId};
use crate::region::every_frame::{BoxProgram, EveryFrame, cells_of, mask};
use crate::vectors::length;

/// Surfaces farther than about this from the origin leave a scene without bounds.
pub(super) const REACH: f32 = 1024.0;
/// Half the side of the searched cube as a multiple of [`REACH`]: about 1e7. A power of [`NESTED`].
const FARTHEST: f32 = 16384.0;
/// Half the side of the smallest cube that is searched as a shell.
const SHELL_MIN: f32 = 1.0 / 64.0;
/// Maximum number of divisions of a part of a shell beyond [`REACH`]. A part that is still undecided may contain a
/// surface.
const SHELL_CUTS: usize = 2;
/// Maximum number of steps for the search, each of which takes about 50 ns for 64 cells.
const STEPS_MAX: usize = 1 << 18;
/// A long program may take as many steps as this many runs of the whole program.
const WHOLE_RUNS_MAX: usize = 45;
/// Cutting cells takes about as long as this number of steps, in addition to the steps of their program.
const STEPS_BESIDE: usize = 64;
/// Cells at a face of the box are cut and divided until they are no thicker than this fraction of the box.
const PRECISION: f32 = 1.0 / 280.0;
/// The same for a first round, which finds the size of the box.
const COARSE: f32 = 1.0 / 10.0;
/// Largest width of such a cell, as a multiple of its greatest thickness.
const WIDTHS: f32 = 4.0;
/// A box that shrinks at most to this fraction hardly shrinks.
const HARDLY: f32 = 0.8;
/// If a program has more steps than this, its cell is divided, and the program is shortened for each part.
const OWN_MIN: usize = 256;
/// Cells whose programs have stayed long after this many divisions are no longer divided in order to shorten programs.
const VAIN_DIVISIONS: u8 = 2;
/// After this many parts whose programs stay long, the other parts keep the whole program too.
const VAIN_PARTS: usize = 3;
/// Number of cells that are cut at once.
const BATCH: usize = 16;
/// Number of outer cells with other programs that are passed over to fill a batch.
const PASSED_MAX: usize = 8;
/// Number of slices of a cut cell. In addition, a point in the cell is tested.
const SLICES: usize = 3;
/// Enlargement of the box on each side, as a fraction of its size, because shaders round differently from the CPU.
const MARGIN: f32 = 1.0 / 1000.0;

type Cell = Bounds;

/// The inner 2x2x2 of the 4x4x4 cells of a cube.
const INNER: u64 = 0x0000_0660_0660_0000;

struct Search<'a> {
    distance: EveryFrame<'a>,
    /// True if the value at a point is at most the distance to the surfaces.
    is_distance: bool,
    /// Number of steps that may still be run.
    left: usize,
}

/// Returns a box around the surfaces of a distance in all frames of `any`; `None` if the surfaces are unbounded or may
/// be in every cell. The outermost cell at a face is divided until it is thin enough. If the value `is_distance`, a cell
/// is also free of surfaces where its middle is far enough from them.
pub(super) fn find(graph: &Graph, distance: NodeId, any: &FrameInputs, is_distance: bool) -> Option<Bounds> {
    let (distance, whole) = EveryFrame::new(graph, distance, any);
    let steps = STEPS_MAX.max(WHOLE_RUNS_MAX * whole.len());
    let mut search = Search { distance, is_distance, left: steps };
    let around = search.outermost(&whole)?;
    search.left = steps;
    search.box_around(&whole, around)
}

impl Search<'_> {
    /// Divides the outermost cells in a box until the faces of the box around them are known.
    fn box_around(mut self, whole: &Rc<BoxProgram>, around: Bounds) -> Option<Bounds> {
        let mut parts = self.first_parts(whole, around)?;
        // How far out a point of a surface or a solid is known at each face.
        let mut reached = [f32::NEG_INFINITY; 6];
        for precision in [COARSE, PRECISION, PRECISION] {
            let before = hull(&parts)?.size();
            let mut is_known = precision == PRECISION;
            for (face, reached) in reached.iter_mut().enumerate() {
                let around = hull(&parts)?;
                let wanted = precision * (around.high[face % 3] - around.low[face % 3]);
                is_known &= self.find_face(&mut parts, face, wanted, reached);
            }
            if is_known && hull(&parts)?.size() > HARDLY * before {
                break;
            }
        }
        let found = hull(&parts)?;
        let margin = found.size() * MARGIN;
        Some(found.hull(&found, margin))
    }

    /// Divides a box into 64 cells, and shrinks the box to the cells that may contain a surface. Repeats this until the
    /// box hardly shrinks.
    fn first_parts(&mut self, whole: &Rc<BoxProgram>, mut around: Bounds) -> Option<Vec<Part>> {
        loop {
            let cells = sixty_fourths(&around);
            let open = self.open(whole, &cells);
            let found = hull_of(&cells, open)?;
            if found.extents() > HARDLY * around.extents() || self.left == 0 {
                return Some(self.parts_of(whole, &cells, open, 0));
            }
            around = found;
        }
    }

    /// Cuts and divides the outermost cells at a face until the face is known up to `wanted`. Returns false if that
    /// takes more than half of the steps that are left.
    fn find_face(&mut self, parts: &mut Vec<Part>, face: usize, wanted: f32, reached: &mut f32) -> bool {
        let least = self.left / 2;
        let fresh =
            std::mem::take(parts).into_iter().map(|part| Outer::new(Part { is_tight: false, ..part }, face));
        let mut outer: BinaryHeap<Outer> = fresh.collect();
        let (mut batch, mut passed) = (Vec::new(), Vec::new());
        let mut is_known = false;
        while self.left > least {
            let Some(first) = outer.pop() else { break };
            let thickness = first.part.cell.side(face % 3);
            let is_thin = first.part.is_tight || thickness <= wanted;
            if is_thin && first.width <= WIDTHS * wanted || first.end - *reached <= wanted {
                outer.push(first);
                is_known = true;
                break;
            }
            if first.part.program.len() > OWN_MIN && first.part.vain < VAIN_DIVISIONS {
                self.divided(&first.part).into_iter().for_each(|part| outer.push(Outer::new(part, face)));
                continue;
            }
            let program = first.part.program.clone();
            batch.push(first.part);
            while batch.len() < BATCH && passed.len() < PASSED_MAX {
                match outer.pop() {
                    Some(next) if next.end > *reached && Rc::ptr_eq(&next.part.program, &program) => {
                        batch.push(next.part);
                    }
                    Some(next) => passed.push(next),
                    None => break,
                }
            }
            passed.drain(..).for_each(|part| outer.push(part));
            while batch.len() * PIECES <= BATCH {
                batch = batch.iter().flat_map(|part| pieces(part, face)).collect();
            }
            self.cut(&program, &mut batch, face, wanted, reached, |part| outer.push(Outer::new(part, face)));
        }
        parts.extend(outer.into_iter().map(|outer| outer.part));
        is_known
    }

    /// Returns the cells that may contain a surface or be solid, as a mask.
    fn open(&mut self, program: &BoxProgram, cells: &[Cell; 64]) -> u64 {
        self.left = self.left.saturating_sub(STEPS_BESIDE + program.len());
        let far = if self.is_distance { self.far(program, cells) } else { 0 };
        self.distance.open(program, cells) & !far
    }

    /// Returns the cells whose middles are farther from all surfaces than from the cells' corners, as a mask.
    fn far(&mut self, program: &BoxProgram, cells: &[Cell; 64]) -> u64 {
        let middles = cells.map(|cell| Cell::around(cell.middle(), 0.0));
        self.distance.open(program, &middles);
        let is_far = |lane: usize| {
            let sides = [0, 1, 2].map(|axis| cells[lane].side(axis));
            self.distance.low(lane) > 0.5 * STEEPEST * length(sides)
        };
        mask(is_far)
    }

    /// Returns the cells of a mask, which have just been bounded, with programs for them. `vain` divisions have not
    /// shortened the given program.
    fn parts_of(&mut self, whole: &Rc<BoxProgram>, cells: &[Cell; 64], open: u64, vain: u8) -> Vec<Part> {
        let is_long = whole.len() > OWN_MIN;
        let shared = if is_long { whole.clone() } else { self.distance.shortened_together(whole, open) };
        if is_long {
            self.distance.decide(whole, open, &[]);
        }
        let mut vain_parts = 0;
        let part = |lane: usize| {
            let is_own = is_long && vain_parts < VAIN_PARTS;
            let program = if is_own { self.distance.shortened(whole, 1 << lane) } else { shared.clone() };
            let is_vain = Rc::ptr_eq(&program, whole);
            vain_parts = if is_vain { vain_parts + 1 } else { 0 };
            let (low, vain) = (self.distance.low(lane), if is_vain { vain + 1 } else { 0 });
            Part { cell: cells[lane], program, low, vain, is_tight: false }
        };
        cells_of(open).map(part).collect()
    }

    /// Returns the 64ths of a cell that may contain a surface or be solid.
    fn divided(&mut self, part: &Part) -> Vec<Part> {
        let cells = sixty_fourths(&part.cell);
        let open = self.open(&part.program, &cells);
        self.parts_of(&part.program, &cells, open, part.vain)
    }

    /// Cuts outer slices without surfaces off some cells with a common program, and divides the cells of which no slice
    /// can be cut off. Drops cells without surfaces and puts the others. Looks for points of surfaces or solids at half
    /// the wanted depth below the cells' faces.
    fn cut(
        &mut self,
        program: &BoxProgram,
        batch: &mut Vec<Part>,
        face: usize,
        wanted: f32,
        reached: &mut f32,
        mut put: impl FnMut(Part),
    ) {
        let axis = face % 3;
        let depths = |cell: &Cell| {
            let thickness = cell.side(axis);
            let first = (thickness / 16.0).max(0.5 * wanted).min(thickness);
            [0.0, first, first.max(thickness / 4.0), thickness]
        };
        let Some(first) = batch.first() else { return };
        let mut cells = [first.cell; 64];
        for (part, cells) in batch.iter().zip(cells.as_chunks_mut().0) {
            let depths = depths(&part.cell);
            let mut point = part.cell.middle();
            point[axis] = below(&part.cell, face, 0.5 * wanted);
            let slice = |number: usize| {
                let [upper, lower] =
                    [depths[number], depths[number + 1]].map(|depth| below(&part.cell, face, depth));
                let mut slice = part.cell;
                (slice.low[axis], slice.high[axis]) = (upper.min(lower), upper.max(lower));
                slice
            };
            *cells = [slice(0), slice(1), slice(2), Cell { low: point, high: point }];
        }
        let open = self.open(program, &cells);
        for (number, mut part) in batch.drain(..).enumerate() {
            let lane = (SLICES + 1) * number;
            if open >> (lane + SLICES) & 1 == 1 {
                *reached = reached.max(end(&part.cell, face) - 0.5 * wanted);
            }
            let Some(slice) = (0..SLICES).find(|slice| open >> (lane + slice) & 1 == 1) else { continue };
            let depths = depths(&part.cell);
            part.is_tight = depths[slice + 1] - depths[slice] <= wanted;
            part.low = self.distance.low(lane + slice);
            if slice == 0 {
                pieces(&part, face).into_iter().for_each(&mut put);
                continue;
            }
            *part.cell.face_mut(face) = below(&part.cell, face, depths[slice]);
            put(part);
        }
    }

    /// Searches shells around smaller and smaller cubes. Returns a box around the surfaces: the cells that may contain
    /// a surface, of the first shell that is not empty, and the cube in this shell. `None` if surfaces may be beyond
    /// [`REACH`].
    ///
    /// A cell of a shell is as wide as its distance from the middle, so intervals of rotated coordinates do not contain
    /// 0 there. In a cell that is wide compared with its distance, they do, and interval arithmetic cannot decide which
    /// of two large terms is larger (x⁴ - 5x² over 1e3..1e7 may be below 0).
    fn outermost(&mut self, whole: &Rc<BoxProgram>) -> Option<Bounds> {
        let mut half = FARTHEST * REACH;
        loop {
            let cells = nested(half);
            let open = self.open(whole, &cells);
            let of_shell = open & !INNER;
            if half > REACH {
                let program = self.distance.shortened_together(whole, of_shell);
                if !cells_of(of_shell).all(|lane| self.is_free(&cells[lane], &program, SHELL_CUTS)) {
                    return None;
                }
            } else if of_shell != 0 || half < SHELL_MIN {
                return hull_of(&cells, open);
            }
            if open & INNER == 0 {
                return None;
            }
            half /= NESTED;
        }
    }

    /// True if a cell contains no surface. To find out, the cell is divided up to `cuts` times.
    fn is_free(&mut self, cell: &Cell, program: &Rc<BoxProgram>, cuts: usize) -> bool {
        if cuts == 0 || self.left == 0 {
            return false;
        }
        let cells = sixty_fourths(cell);
        let open = self.open(program, &cells);
        let program = self.distance.shortened_together(program, open);
        cells_of(open).all(|lane| self.is_free(&cells[lane], &program, cuts - 1))
    }
}

fn hull(parts: &[Part]) -> Option<Bounds> {
    parts.iter().map(|part| part.cell).reduce(|hull, cell| hull.hull(&cell, 0.0))
}

fn hull_of(cells: &[Cell; 64], mask: u64) -> Option<Bounds> {
    cells_of(mask).map(|lane| cells[lane]).reduce(|hull, cell| hull.hull(&cell, 0.0))
}

// The open cells of the search for a scene's box (`bounds.rs`), ordered by how far out they are.

/// A cell that may contain a surface, with a program for this cell.
pub(super) struct Part {
    pub(super) cell: Bounds,
    pub(super) program: Rc<BoxProgram>,
    /// A lower bound of the distance.
    pub(super) low: f32,
    /// Number of the last divisions that have not shortened the program.
    pub(super) vain: u8,
    /// True if the cell's outer slice, which is thin enough, may contain a surface.
    pub(super) is_tight: bool,
}

/// Returns how far out a cell extends at a face. The faces are those at the low ends, then those at the high ends.
pub(super) fn end(cell: &Bounds, face: usize) -> f32 {
    if face < 3 { -cell.low[face] } else { cell.high[face % 3] }
}

/// A cell that is ordered by how far out it is at a face. Of equally far cells, the narrowest and then the one with the
/// least distance come first: if one of them contains a surface, the others need no division.
pub(super) struct Outer {
    pub(super) end: f32,
    /// The largest extent along the face.
    pub(super) width: f32,
    pub(super) part: Part,
}

impl Outer {
    pub(super) fn new(part: Part, face: usize) -> Self {
        let width = part.cell.side((face + 1) % 3).max(part.cell.side((face + 2) % 3));
        Self { end: end(&part.cell, face), width, part }
    }
}

impl PartialEq for Outer {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Outer {}

impl PartialOrd for Outer {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Outer {
    fn cmp(&self, other: &Self) -> Ordering {
        self.end
            .total_cmp(&other.end)
            .then_with(|| other.width.total_cmp(&self.width))
            .then_with(|| other.part.low.total_cmp(&self.part.low))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lang::{compile, no_includes};
    use crate::world::testing::{SPEAKERS, world_of};

    fn bounds(text: &str) -> Option<Bounds> {
        bounds_of(text, false)
    }

    fn bounds_of(text: &str, is_distance: bool) -> Option<Bounds> {
        let scene = compile("test", text, &mut no_includes).scene.unwrap();
        find(&scene.graph, scene.distance, &crate::world::any_frame(&scene), is_distance)
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
            assert_eq!([false, true].map(|is_distance| bounds_of(text, is_distance)), [None; 2], "{text}");
        }
        assert_eq!(bounds_of("min(octahedron(p, 1), length(p.xz - vec2(9, 0)) - 0.01)", true), None);
    }

    #[test]
    fn distances_bound_a_shape_that_intervals_do_not() {
        let text = "octahedron(p - vec3(0, 2, 0), 1)";
        assert_eq!(bounds(text), None);
        assert_near(bounds_of(text, true), [-1.0, 1.0, -1.0], [1.0, 3.0, 1.0], 0.04);
    }

    /// Regression: with fewer steps for the second search, the box was 46 wide.
    #[test]
    fn a_pyramid_is_boxed_closely() {
        assert_near(world_of("pyramid(p, 0.8)").bounds, [-0.5, 0.0, -0.5], [0.5, 0.8, 0.5], 0.1);
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
