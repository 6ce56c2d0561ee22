//! Builds a tree: the common start of its parts (`part.rs`), and the assembly of the finished parts.
//!
//! **Bounds of a frame.** The world's box contains the surfaces of all sounds and times; the surfaces of one frame are
//! often in a smaller box. Up to three passes over 64 cells therefore shrink the box before the tree is built. Rays,
//! shadows and occlusion are limited to the smaller box.
//!
//! **Roots.** A scene without bounds has several nested roots, because rays beyond a single root would evaluate the whole
//! tape.

use super::encode::{Encoder, Texel};
use super::lanes::{CELLS, Lanes, bound};
use super::part::Part;
use super::program::{Arg, BOUND, ESTIMATE, INPUTS, OBJECT, Program, Structure};
use super::prune::{ChoiceTrace, decide, of_distance};
use super::reuse::{Before, Memory};
use super::{BRICK_SIDE, OBJECT_UNKNOWN, ROOT_GROWTH, ROOT_SIDE, RegionPlan, RegionVariant};
use crate::bounds::Bounds;
use crate::graph::{FrameInputs, Interval};
use crate::rays::WITHOUT_GLASS;

/// Options for building a tree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RegionOptions {
    /// True for a tree with cells. Without cells, the whole tape is used everywhere.
    pub cells: bool,
    /// Maximum number of texels that the driver supports in a list.
    pub texels_max: usize,
    /// Centre of the tree if the scene has no bounds.
    pub center: [f32; 3],
    /// In a scene with bounds, the approximate position of the eye if it is within the bounds. Cells that look small
    /// from this position are not divided. A scene without bounds uses `center` instead.
    pub eye: Option<[f32; 3]>,
}

impl Default for RegionOptions {
    fn default() -> Self {
        Self { cells: true, texels_max: 1 << 16, center: [0.0; 3], eye: None }
    }
}

/// Sizes of a tree.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
pub struct RegionStats {
    /// Number of cells, not counting divided ones.
    pub cells: usize,
    /// Number of passes. Each pass bounds 64 cells at once.
    pub passes: usize,
    /// Number of groups of 64 cells that were copied from the previous frame's tree.
    pub copied: usize,
    /// Number of distinct tapes.
    pub tapes: usize,
    /// Number of clauses in the whole tape.
    pub whole_clauses: usize,
    /// Number of clauses in all distinct tapes.
    pub clauses: usize,
    /// Size of the shaders' data in bytes.
    pub bytes: usize,
    /// Number of cells that use the whole tape because there was no room for a shorter tape.
    pub overflowed: usize,
}

/// The tree of a frame. The default has no cells and no tapes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Regions {
    /// The texels that the shaders read.
    pub texels: Vec<[u32; 4]>,
    /// Lower corner of the first root's box.
    pub low: [f32; 3],
    /// Extent of the box; 0 if there are no cells.
    pub size: [f32; 3],
    /// Number of nested roots with the same centre, each four times as wide as the next smaller one; 0 without cells.
    pub roots: usize,
    /// A box that contains all surfaces of the frame except planes, if known.
    pub bounds: Option<Bounds>,
    /// First texel of the whole tape.
    pub whole_tape: u32,
    /// The sizes of the tree.
    pub stats: RegionStats,
    pub(super) memory: Memory,
}

const TIGHTENINGS_MAX: usize = 3;
/// Half the side of the first root of a scene without bounds.
const UNBOUNDED_REACH: f32 = 32.0;
/// In the first root, cells are divided if their side exceeds this fraction of their distance from the eye. With 0.2,
/// building the tree takes a third less time in lattice and a quarter less in tunnel, but rays run 9 % more clauses in
/// lattice and 4 % more in city.
const FINE_FRACTION: f32 = 0.16;
/// Replaces [`FINE_FRACTION`] if rays need gradients.
const NON_LIPSCHITZ_FINE_FRACTION: f32 = 0.3;
/// Replaces [`FINE_FRACTION`] in other roots.
const OUTER_FINE_FRACTION: f32 = 0.5;
/// Number of roots of a scene without bounds. The last one contains all rays, which end at [`FAR`](crate::rays::FAR).
const ROOTS_MAX: usize = 4;
/// Penumbras and occlusion need distances within this range of surfaces. It slightly exceeds the highest probe.
pub(super) const AROUND: f32 = 1.2;
/// Bounds are reduced by this fraction of the box's size and its distance from the origin, because GPUs round
/// differently. Two dozen roundings of numbers of that size add up to a fraction of 3e-6.
const ROUNDING: f32 = 1e-5;
/// Cells overlap by this fraction of the box's size and its distance from the origin, because rays look up their cell a
/// hundred-thousandth of a root cell ahead.
const OVERLAP: f32 = 4e-6;
/// Largest penumbra.
pub(super) const PENUMBRA_MAX: f32 = WITHOUT_GLASS;

#[derive(Debug, Clone, Copy)]
pub(super) struct Brick {
    pub(super) low: [f32; 3],
    /// Extent of one of the 4x4x4 cells.
    pub(super) cell: [f32; 3],
}

#[derive(Debug)]
pub(super) struct Trunk<'a> {
    pub(super) frame: &'a FrameInputs,
    pub(super) options: &'a RegionOptions,
    pub(super) program: Program,
    pub(super) roots: Vec<Root>,
    /// The roots, still without cells, and the whole tapes.
    pub(super) texels: Vec<Texel>,
    pub(super) variant: &'a RegionVariant,
    pub(super) steepest: f32,
    pub(super) before: Option<Before<'a>>,
    pub(super) unbounded: bool,
    pub(super) whole: Whole,
    stats: RegionStats,
}

#[derive(Debug)]
pub(super) struct Root {
    /// The root as a single block: each of its 64 cells is a block of the root.
    pub(super) block: Brick,
    pub(super) rows: Vec<Lanes>,
    pub(super) decisions: ChoiceTrace,
    pub(super) groups: Vec<u64>,
    pub(super) scale: Scale,
}

/// Lengths that belong to a root.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Scale {
    /// Subtracted from lower bounds of the distance.
    pub(super) margin: f32,
    /// Cells are enlarged by this on all sides.
    pub(super) overlap: f32,
    /// Cells up to this distance from surfaces have shortened tapes.
    pub(super) around: f32,
    /// Cells are divided if their side exceeds this fraction of their distance from the eye.
    pub(super) fine_fraction: f32,
}

#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Whole {
    pub(super) tape: u32,
    pub(super) object: u32,
}

impl RegionPlan {
    /// Builds the tree of a frame in several parts. Equal parts are copied from `last`, a tree of the same plan for another
    /// frame. `run` must call [`Part::build`] on each part, on any thread. The tree is the same for any number of parts,
    /// except that different parts do not share equal tapes.
    pub fn build_in_parts(
        &self,
        last: Option<&Regions>,
        frame: &FrameInputs,
        options: &RegionOptions,
        parts: usize,
        run: impl FnOnce(&mut [Part]),
    ) -> Regions {
        let program = self.formula.folded(Some(frame));
        let variant = &self.variant;
        let has_rest = self.has_rest && (self.runs || variant.non_lipschitz);
        let bounds =
            self.bounds.map(|bounds| if has_rest { tightened(&program, bounds, frame) } else { bounds });
        let (low, size) = extent(bounds, options.center);
        // If the value is not a distance, rays need cells, even if the options ask for none.
        let cells = (options.cells || variant.non_lipschitz)
            && has_rest
            && options.texels_max >= 4 * ROOT_SIDE.pow(3);
        // A formula that is not a distance has one root: its gradients cost much in large cells, and its rays end with the
        // tree.
        let reaches_far = bounds.is_none() && !variant.non_lipschitz;
        let roots = if reaches_far && options.texels_max >= 16 * ROOT_SIDE.pow(3) { ROOTS_MAX } else { 1 };
        let roots = if cells { roots } else { 0 };
        let mut trunk = Trunk {
            frame,
            options,
            program,
            roots: (0..roots).map(|number| Root::new(number, low, size, variant.non_lipschitz)).collect(),
            texels: vec![[0; 4]; roots * ROOT_SIDE.pow(3)],
            variant,
            steepest: self.steepest.unwrap_or(f32::INFINITY),
            before: last.filter(|_| cells).and_then(|last| Before::of(last, low, size, &frame.shapes)),
            unbounded: bounds.is_none(),
            whole: Whole::default(),
            stats: RegionStats::default(),
        };
        trunk.write_whole();
        let mut memory =
            Memory { whole_object: trunk.whole.object, shapes: frame.shapes.clone(), ..Memory::default() };
        let (mut stats, mut texels) = (trunk.stats, Vec::new());
        if cells {
            trunk.divide();
            let count = parts.max(1);
            let mut parts: Vec<Part> = (0..count).map(|number| Part::new(&trunk, number, count)).collect();
            run(&mut parts);
            texels.reserve_exact(trunk.texels.len() + parts.iter().map(Part::texel_count).sum::<usize>());
            texels.extend_from_slice(&trunk.texels);
            for part in parts {
                let (blocks, its, of_part) = part.finish(texels.len() - trunk.texels.len(), &mut memory);
                texels.extend(its);
                stats.add(&of_part);
                for (block, cells) in blocks {
                    let (root, place) = (block / CELLS * ROOT_SIDE.pow(3), place_in(block % CELLS));
                    for (child, cell) in cells.into_iter().enumerate() {
                        let at: [usize; 3] =
                            std::array::from_fn(|axis| BRICK_SIDE * place[axis] + place_in(child)[axis]);
                        texels[root + at[0] + ROOT_SIDE * (at[1] + ROOT_SIDE * at[2])] = cell;
                    }
                }
            }
        } else {
            texels = trunk.texels;
        }
        stats.bytes = texels.len() * size_of::<Texel>();
        Regions {
            low,
            size: if cells { size } else { [0.0; 3] },
            roots,
            bounds,
            whole_tape: trunk.whole.tape,
            texels,
            stats,
            memory,
        }
    }
}

impl RegionStats {
    fn add(&mut self, part: &Self) {
        self.cells += part.cells;
        self.passes += part.passes;
        self.copied += part.copied;
        self.tapes += part.tapes;
        self.clauses += part.clauses;
        self.overflowed += part.overflowed;
    }
}

impl Whole {
    /// The second word of a cell with the whole tape.
    pub(super) fn second(self) -> u32 {
        self.tape | OBJECT_UNKNOWN << 24
    }
}

impl Root {
    /// Creates the root with this number around the first root's box.
    fn new(number: usize, low: [f32; 3], size: [f32; 3], non_lipschitz: bool) -> Self {
        let times = ROOT_GROWTH.pow(number as u32) as f32;
        let low: [f32; 3] = std::array::from_fn(|axis| low[axis] - 0.5 * (times - 1.0) * size[axis]);
        let size = size.map(|side| times * side);
        let faces = (0..3).map(|axis| low[axis].abs().max((low[axis] + size[axis]).abs()));
        let farthest = faces.fold(0.0, f32::max);
        Self {
            block: Brick { low, cell: size.map(|side| side / BRICK_SIDE as f32) },
            rows: Vec::new(),
            decisions: ChoiceTrace::default(),
            groups: Vec::new(),
            scale: Scale {
                margin: farthest * ROUNDING,
                overlap: farthest * OVERLAP,
                around: times * AROUND,
                fine_fraction: match number {
                    0 if non_lipschitz => NON_LIPSCHITZ_FINE_FRACTION,
                    0 => FINE_FRACTION,
                    _ => OUTER_FINE_FRACTION,
                },
            },
        }
    }
}

impl Trunk<'_> {
    pub(super) fn encoder(&self) -> Encoder {
        Encoder::new(self.variant.compounds, self.variant.registers)
    }

    fn write_whole(&mut self) {
        let mut encoder = self.encoder();
        // A program that needs too many registers has no tape here. The plan has already reported this.
        if let Some(texels) = encoder.encode(&self.program, &[OBJECT, OBJECT]) {
            self.whole.object = self.texels.len() as u32;
            self.texels.extend_from_slice(texels);
        }
        if let Some(texels) = encoder.encode(&self.program, &[BOUND, ESTIMATE]) {
            self.texels.push([self.whole.object, 0, 0, 0]);
            self.whole.tape = self.texels.len() as u32;
            self.texels.extend_from_slice(texels);
            self.stats.whole_clauses = encoder.clauses;
        }
    }

    fn divide(&mut self) {
        let mut structure = Structure::default();
        structure.analyse(&self.program);
        for Root { block, rows, decisions, groups, scale } in &mut self.roots {
            self.stats.passes += 1;
            bound_cells(&self.program, *block, scale.overlap, rows, self.frame);
            decide(decisions, &self.program, &structure, rows, &of_distance(u64::MAX, u64::MAX), &[]);
            decisions.groups(rows, &[u64::MAX], groups);
        }
    }
}

fn tightened(program: &Program, mut bounds: Bounds, frame: &FrameInputs) -> Bounds {
    let mut rows = Vec::new();
    for _ in 0..TIGHTENINGS_MAX {
        let Bounds { low, high } = bounds;
        let block = Brick { low, cell: [0, 1, 2].map(|axis| bounds.side(axis) / BRICK_SIDE as f32) };
        let farthest = low.iter().chain(&high).fold(0.0f32, |most, side| most.max(side.abs()));
        bound_cells(program, block, farthest * OVERLAP, &mut rows, frame);
        let held = |cell: usize| match program.roots[BOUND] {
            // A cell whose bound is NaN may contain a surface.
            Arg::Value(value) => !surely_above(rows[value as usize].lo[cell], farthest * ROUNDING),
            Arg::Number(number) => !surely_above(number, 0.0),
        };
        let (mut first, mut last) = ([BRICK_SIDE; 3], [0; 3]);
        for cell in (0..CELLS).filter(|cell| held(*cell)) {
            let place = place_in(cell);
            first = std::array::from_fn(|axis| first[axis].min(place[axis]));
            last = std::array::from_fn(|axis| last[axis].max(place[axis] + 1));
        }
        if first == [0; 3] && last == [BRICK_SIDE; 3] || first == [BRICK_SIDE; 3] {
            break;
        }
        let corner =
            |place: [usize; 3]| [0, 1, 2].map(|axis| low[axis] + place[axis] as f32 * block.cell[axis]);
        bounds = Bounds { low: corner(first), high: corner(last) };
    }
    bounds
}

/// False for NaN.
fn surely_above(value: f32, limit: f32) -> bool {
    value > limit
}

fn extent(bounds: Option<Bounds>, center: [f32; 3]) -> ([f32; 3], [f32; 3]) {
    let bounds = bounds.unwrap_or(Bounds::around(center, UNBOUNDED_REACH));
    // A cube, because cells with equal sides give the best bounds.
    let side = bounds.size() + 2.0 * AROUND;
    (bounds.middle().map(|middle| middle - 0.5 * side), [side; 3])
}

pub(super) fn bound_cells(
    program: &Program,
    block: Brick,
    overlap: f32,
    rows: &mut Vec<Lanes>,
    frame: &FrameInputs,
) {
    rows.resize(rows.len().max(INPUTS), Lanes::splat(Interval::point(0.0)));
    for (axis, row) in rows.iter_mut().take(3).enumerate() {
        for cell in 0..CELLS {
            let along = place_in(cell)[axis] as f32;
            row.lo[cell] = block.low[axis] + along * block.cell[axis] - overlap;
            row.hi[cell] = block.low[axis] + (along + 1.0) * block.cell[axis] + overlap;
        }
    }
    rows[3] = Lanes::splat(Interval { lo: 0.0, hi: PENUMBRA_MAX });
    bound(program, rows, frame);
}

pub(super) const fn place_in(cell: usize) -> [usize; 3] {
    [cell % BRICK_SIDE, cell / BRICK_SIDE % BRICK_SIDE, cell / (BRICK_SIDE * BRICK_SIDE)]
}

impl Brick {
    pub(super) fn child(&self, place: [usize; 3]) -> Self {
        Self {
            low: std::array::from_fn(|axis| self.low[axis] + place[axis] as f32 * self.cell[axis]),
            cell: self.cell.map(|side| side / BRICK_SIDE as f32),
        }
    }
}
