//! Shortens the programs of materials and light for parts of space.
//!
//! Each program has its own grid of 8x8x8 cells. The grid maps a point, or for the sky a direction, to a tape. The
//! outermost cells extend to the largest coordinates at which anything is drawn. As in the tree of distances, interval
//! arithmetic on a frame's values decides which steps a cell does not need. Cells with the same steps share a tape.
//! The eight cells of a block also share a tape, unless they need far fewer steps than the block. In its cell a
//! shortened tape gives the same bits as the whole tape. Cells without visible surfaces ([`Surfaces`]) keep the whole
//! tape and take no time. `world::shortening` selects the programs.

use std::collections::HashMap;

use super::encode::{Encoder, Texel};
use super::lanes::{CELLS, Lanes, bound, cells_of, mask};
use super::program::{Program, Structure};
use super::prune::{ChoiceTrace, Scratch, decide};
use super::tree::place_in;
use super::{DIVIDED, Formula, ROOT_SIDE, Regions};
use crate::graph::{FrameInputs, Input, Interval};

/// Number of cells of a grid along each axis.
pub(crate) const SIDE: usize = 8;
/// Number of values of the point: position and normal.
pub(crate) const OF_POINT: usize = Input::OF_POINT.len();
/// Largest coordinate at which anything is drawn.
const FARTHEST: f32 = 1e7;
/// Overlap of cells, as a fraction of their size and their distance from the origin. Shaders round differently, so they
/// may find the neighbouring cell.
const OVERLAP: f32 = 1e-5;
/// Largest component of normals and directions, after rounding.
const NORMAL_MAX: f32 = 1.001;
/// The largest coordinate of a pixel.
const PIXEL_MAX: f32 = 1e6;
const SAMPLED: Interval = Interval { lo: 0.0, hi: 1.0 };
/// Number of texels that a full grid has in addition to those of a grid with a single cell.
const GRID_TEXELS: usize = SIDE * SIDE * SIDE / 4 - 1;
/// Programs with at most this many nodes or steps are not shortened.
const WHOLE_MAX: usize = 24;
/// Maximum number of nodes in all programs that are shortened in a frame: about 20 to 40 ms. Programs beyond this limit
/// stay whole.
const NODES_MAX: usize = 4096;
/// A cell has its own tape if that tape has at most this fraction of the block's clauses. Tried: an own tape for every
/// cell that saves any clause. Other scenes then run up to 10 % fewer clauses, but in wave_tank the first programs fill
/// all 32,000 texels.
const OWN_FRACTION: f32 = 0.75;
/// A shortened tape has at most this fraction of the whole tape's texels.
const SHORTER_FRACTION: f32 = 0.9;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Over {
    Points,
    /// Directions towards the sky. The programs get the picture's pixel as x and y of their point, and 0 as z.
    Directions,
}

/// A grid. A point's cell is `floor((point - low) * scale)`, clamped to 0..[`SIDE`] along each axis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Grid {
    pub(crate) low: [f32; 3],
    /// Cells per unit of length; 0 for a grid of one cell.
    pub(crate) scale: [f32; 3],
}

impl Grid {
    /// Returns the grid that divides a box into equal cells; its outermost cells extend beyond the box.
    pub(crate) fn of_box(low: [f32; 3], high: [f32; 3]) -> Self {
        let size = |axis: usize| (high[axis] - low[axis]).max(1e-3);
        Self { low, scale: std::array::from_fn(|axis| SIDE as f32 / size(axis)) }
    }

    /// Returns the number of a point's cell, computed in the same way as in the shaders.
    #[cfg(test)]
    pub(crate) fn cell_of(&self, point: [f32; 3]) -> usize {
        (0..3).rev().fold(0, |cell, axis| {
            let place = (point[axis] - self.low[axis]) * self.scale[axis];
            cell * SIDE + place.clamp(0.0, (SIDE - 1) as f32) as usize
        })
    }

    fn may_hold_a_direction(&self, cell: [usize; 3]) -> bool {
        let (mut nearest, mut farthest) = (0.0, 0.0);
        for (axis, place) in cell.into_iter().enumerate() {
            let side = self.span(axis, place, place + 1, NORMAL_MAX);
            let (low, high) = (side.lo.abs().min(side.hi.abs()), side.lo.abs().max(side.hi.abs()));
            nearest += low * low;
            farthest += high * high;
        }
        nearest <= NORMAL_MAX && farthest >= 2.0 - NORMAL_MAX
    }

    /// Returns the extent of the cells `first..end` along an axis, slightly enlarged.
    fn span(&self, axis: usize, first: usize, end: usize, farthest: f32) -> Interval {
        let face = |number: usize| self.low[axis] + number as f32 / self.scale[axis];
        let around = OVERLAP * face(0).abs().max(face(SIDE).abs()).max(face(SIDE) - face(0));
        Interval {
            lo: if first == 0 { -farthest } else { face(first) - around },
            hi: if end == SIDE { farthest } else { face(end) + around },
        }
    }
}

/// The surfaces of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surfaces<'a> {
    /// The tree of the distances. A tree without cells excludes no surface.
    pub regions: &'a Regions,
    /// The planes: `[a, b, c, d]` of `a*x + b*y + c*z + d`.
    pub planes: &'a [[f32; 4]],
    /// Programs may run up to this distance from surfaces.
    pub around: f32,
}

impl Surfaces<'_> {
    fn may_meet(&self, sides: [Interval; 3]) -> bool {
        let sides = sides.map(|side| Interval { lo: side.lo - self.around, hi: side.hi + self.around });
        let meets = |[a, b, c, d]: &[f32; 4]| {
            let (mut low, mut high) = (*d, *d);
            for (factor, side) in [a, b, c].into_iter().zip(sides) {
                low += (factor * side.lo).min(factor * side.hi);
                high += (factor * side.lo).max(factor * side.hi);
            }
            !(low > 0.0 || high < 0.0)
        };
        self.planes.iter().any(meets) || self.regions.may_hold_a_surface(sides)
    }
}

impl Regions {
    /// True if a box may contain a surface, according to the root's cells.
    fn may_hold_a_surface(&self, sides: [Interval; 3]) -> bool {
        let last = ROOT_SIDE as f32 - 1.0;
        let place = |axis: usize, at: f32| (at - self.low[axis]) / self.size[axis] * ROOT_SIDE as f32;
        let [low, high] = [0, 1].map(|end| {
            let end = |side: Interval| if end == 0 { side.lo } else { side.hi };
            std::array::from_fn::<f32, 3, _>(|axis| place(axis, end(sides[axis])))
        });
        let outside = (0..3).any(|axis| low[axis] < 0.0 || high[axis] > last + 1.0);
        if self.size[0] <= 0.0 || outside && self.bounds.is_none() {
            return true;
        }
        if (0..3).any(|axis| high[axis] < 0.0 || low[axis] > last + 1.0) {
            return false;
        }
        let along = |axis: usize| low[axis].clamp(0.0, last) as usize..=high[axis].clamp(0.0, last) as usize;
        let holds = |cell: usize| {
            self.texels.get(cell).is_none_or(|[bound, ..]| *bound == DIVIDED || f32::from_bits(*bound) <= 0.0)
        };
        along(2).any(|z| along(1).any(|y| along(0).any(|x| holds(x + ROOT_SIDE * (y + ROOT_SIDE * z)))))
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SurfacePlan {
    pub(crate) formula: Formula,
    pub(crate) over: Over,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ShortTape {
    pub(crate) outputs: Vec<u8>,
    pub(crate) texels: Vec<Texel>,
    pub(crate) samples: bool,
}

#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct ShortTapes {
    pub(crate) grid: Grid,
    /// The tape of each cell; `None` for the whole tape. Empty if all cells use the whole tape.
    pub(crate) cells: Vec<Option<usize>>,
    pub(crate) tapes: Vec<ShortTape>,
    /// The mean fraction of the whole tape's texels that is saved; `None` if there was no time or room to shorten.
    pub(crate) saved: Option<f32>,
}

impl SurfacePlan {
    pub(crate) fn may_become_shorter(&self) -> bool {
        (WHOLE_MAX + 1..=NODES_MAX).contains(&self.formula.len())
    }
}

#[derive(Debug)]
pub(crate) struct Shortener<'a> {
    frame: &'a FrameInputs,
    grid: Grid,
    /// For each cell of the grid, true if programs may run in it.
    asked: Vec<bool>,
    /// Remaining room in texels.
    room: usize,
    /// Remaining time, as a number of nodes.
    nodes: usize,
    encoder: Encoder,
    rows: Vec<Lanes>,
    decisions: ChoiceTrace,
    scratch: Scratch,
    structure: Structure,
}

impl<'a> Shortener<'a> {
    pub(crate) fn new(
        frame: &'a FrameInputs,
        grid: Grid,
        surfaces: Option<Surfaces>,
        encoder: Encoder,
        room: usize,
    ) -> Self {
        let may_meet = |cell: usize| {
            let place = place_of(cell, SIDE);
            let sides = std::array::from_fn(|axis| grid.span(axis, place[axis], place[axis] + 1, FARTHEST));
            surfaces.is_none_or(|surfaces| surfaces.may_meet(sides))
        };
        Self {
            frame,
            grid,
            asked: (0..SIDE.pow(3)).map(may_meet).collect(),
            room,
            nodes: NODES_MAX,
            encoder,
            rows: Vec::new(),
            decisions: ChoiceTrace::default(),
            scratch: Scratch::default(),
            structure: Structure::default(),
        }
    }

    /// Shortens a program whose whole tape has `whole` texels, including its header.
    pub(crate) fn shorten(&mut self, plan: &SurfacePlan, whole: usize) -> ShortTapes {
        let grid = match plan.over {
            Over::Points => self.grid,
            Over::Directions => Grid::of_box([-1.0; 3], [1.0; 3]),
        };
        let mut short = ShortTapes { grid, ..ShortTapes::default() };
        let Some(nodes) = self.nodes.checked_sub(plan.formula.len()) else { return short };
        let Some(room) = self.room.checked_sub(GRID_TEXELS) else { return short };
        let program = plan.formula.folded(Some(self.frame));
        if program.steps.len() <= WHOLE_MAX {
            short.saved = Some(0.0);
            return short;
        }
        (self.nodes, self.room) = (nodes, room);
        self.structure.analyse(&program);
        let is_asked = |cell: &[usize; 3]| match plan.over {
            Over::Points => self.asked[number_of(*cell)],
            Over::Directions => grid.may_hold_a_direction(*cell),
        };
        let cells: Vec<[usize; 3]> = blocks().flatten().filter(is_asked).collect();
        let mut known = HashMap::new();
        short.cells.resize(SIDE.pow(3), None);
        for cells in cells.chunks(CELLS) {
            // If fewer cells are left, repeat the last cell.
            let at = |lane: usize| cells.get(lane).or(cells.last()).copied().unwrap_or_default();
            let lanes: [[usize; 3]; CELLS] = std::array::from_fn(at);
            self.bound(&program, plan, grid, &lanes);
            let tapes = self.tapes(&program, &lanes, whole, &mut known, &mut short.tapes);
            for (cell, tape) in lanes.iter().zip(tapes) {
                short.cells[number_of(*cell)] = tape;
            }
        }
        let length = |cell: &[usize; 3]| {
            let tape = short.cells[number_of(*cell)].and_then(|tape| short.tapes.get(tape));
            tape.map_or(whole, |tape| tape.texels.len() + beside(&program))
        };
        let (texels, most) = (cells.iter().map(length).sum(), whole * cells.len());
        short.saved = Some(most.saturating_sub(texels) as f32 / most.max(1) as f32);
        short
    }

    fn bound(&mut self, program: &Program, plan: &SurfacePlan, grid: Grid, cells: &[[usize; 3]; CELLS]) {
        let nothing = Lanes::splat(Interval::point(0.0));
        self.rows.resize(self.rows.len().max(program.inputs), nothing);
        let (divided, other) = match plan.over {
            Over::Points => ((0, FARTHEST), (3, Interval { lo: -NORMAL_MAX, hi: NORMAL_MAX })),
            Over::Directions => ((3, NORMAL_MAX), (0, Interval { lo: 0.0, hi: PIXEL_MAX })),
        };
        for axis in 0..3 {
            let row = &mut self.rows[divided.0 + axis];
            for (lane, cell) in cells.iter().enumerate() {
                let span = grid.span(axis, cell[axis], cell[axis] + 1, divided.1);
                (row.lo[lane], row.hi[lane]) = (span.lo, span.hi);
            }
            self.rows[other.0 + axis] = Lanes::splat(other.1);
        }
        for row in &mut self.rows[OF_POINT..program.inputs] {
            *row = Lanes::splat(SAMPLED);
        }
        bound(program, &mut self.rows, self.frame);
    }

    /// Returns the tapes of 64 cells, given bounds of the program's values in each cell. A cell has its own tape if
    /// that tape is much shorter than the block's tape, because tapes that hardly differ would cost more than they
    /// save.
    fn tapes(
        &mut self,
        program: &Program,
        cells: &[[usize; 3]; CELLS],
        whole: usize,
        known: &mut HashMap<u64, Option<usize>>,
        tapes: &mut Vec<ShortTape>,
    ) -> [Option<usize>; CELLS] {
        let block = |lane: usize| cells[lane].map(|along| along / 2);
        let mut together = Vec::new();
        let mut left = u64::MAX;
        while left != 0 {
            let first = left.trailing_zeros() as usize;
            together.push(mask(|lane| block(lane) == block(first)));
            left &= !together.last().copied().unwrap_or(left);
        }
        let mut groups = Vec::new();
        let roots: Vec<(usize, u64)> = (0..program.roots.len()).map(|root| (root, u64::MAX)).collect();
        decide(&mut self.decisions, program, &self.structure, &self.rows, &roots, &together);
        self.decisions.groups(&self.rows, &[u64::MAX], &mut groups);
        let shared: Vec<(u64, Program)> =
            groups.iter().map(|group| (*group, self.shortened(program, *group))).collect();
        decide(&mut self.decisions, program, &self.structure, &self.rows, &roots, &[]);
        self.decisions.groups(&self.rows, &[u64::MAX], &mut groups);
        let mut found = [None; CELLS];
        for group in groups {
            let own = self.shortened(program, group);
            for (with, shared) in &shared {
                let lanes = group & with;
                if lanes != 0 {
                    let pays = own.steps.len() as f32 <= OWN_FRACTION * shared.steps.len() as f32;
                    let tape = self.tape(if pays { &own } else { shared }, whole, known, tapes);
                    cells_of(lanes).for_each(|lane| found[lane] = tape);
                }
            }
        }
        found
    }

    fn shortened(&mut self, program: &Program, group: u64) -> Program {
        let mut short = Program::default();
        let (frame, scratch) = (self.frame, &mut self.scratch);
        self.decisions.shortened(program, &self.rows, group, frame, scratch, &mut short);
        short
    }

    /// Returns the number of a program's tape, or `None` if the tape saves too little or there is no room.
    fn tape(
        &mut self,
        program: &Program,
        whole: usize,
        known: &mut HashMap<u64, Option<usize>>,
        tapes: &mut Vec<ShortTape>,
    ) -> Option<usize> {
        let hash = program.hash();
        if let Some(tape) = known.get(&hash) {
            return *tape;
        }
        let outputs: Vec<usize> = (0..program.roots.len()).collect();
        let beside = beside(program);
        let texels = self.encoder.encode(program, &outputs).map(<[Texel]>::to_vec);
        let fits = texels.filter(|texels| {
            let texels = texels.len() + beside;
            texels as f32 <= SHORTER_FRACTION * whole as f32 && texels <= self.room
        });
        let tape = fits.map(|texels| {
            self.room -= texels.len() + beside;
            tapes.push(ShortTape {
                outputs: self.encoder.outputs.clone(),
                texels,
                samples: self.encoder.samples(),
            });
            tapes.len() - 1
        });
        known.insert(hash, tape);
        tape
    }
}

/// Number of texels in addition to a tape's clauses: the header, and one texel for each texture.
fn beside(program: &Program) -> usize {
    1 + (program.inputs - program.in_registers) / 4
}

/// Returns the x, y and z of a cell in a grid with `side` cells along each axis.
pub(super) fn place_of(cell: usize, side: usize) -> [usize; 3] {
    [cell % side, cell / side % side, cell / (side * side)]
}

fn number_of([x, y, z]: [usize; 3]) -> usize {
    x + SIDE * (y + SIDE * z)
}

fn blocks() -> impl Iterator<Item = [[usize; 3]; 8]> {
    let child = |block: [usize; 3]| {
        move |child: usize| std::array::from_fn(|axis| 2 * block[axis] + (child >> axis & 1))
    };
    (0..CELLS).map(move |block| std::array::from_fn(child(place_in(block))))
}
