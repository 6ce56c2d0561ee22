//! The tree: cells of 64 at once, from the root to bricks, and what is written for each.

use std::collections::HashMap;

use super::encode::{Encoder, Texel};
use super::gradient::Gradients;
use super::lanes::{CELLS, Lanes, bound};
use super::program::{Arg, BOUND, ESTIMATE, OBJECT, Program, Structure};
use super::prune::Decisions;
use super::{BRICK_SIDE, DIVIDED, OBJECT_UNKNOWN, ROOT_SIDE};
use crate::graph::{FrameInputs, Interval};

/// How a tree is built.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RegionOptions {
    /// Whether there are cells at all, or one tape, the whole one, for everywhere.
    pub cells: bool,
    /// Most texels: what the driver reports for a texture buffer.
    pub texels_max: usize,
    /// Middle of the tree of a scene without bounds.
    pub center: [f32; 3],
}

impl Default for RegionOptions {
    fn default() -> Self {
        Self { cells: true, texels_max: 1 << 16, center: [0.0; 3] }
    }
}

/// What a tree consists of.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
pub struct RegionStats {
    /// Cells, those that are divided not counted.
    pub cells: usize,
    /// Cells of 64 that were bounded at once.
    pub passes: usize,
    /// Distinct tapes.
    pub tapes: usize,
    /// Clauses of the whole tape.
    pub whole_clauses: usize,
    /// Clauses of all distinct tapes.
    pub clauses: usize,
    /// Bytes for the shaders.
    pub bytes: usize,
    /// Cells that have the whole tape because there was no room for their own.
    pub overflowed: usize,
}

/// The tree of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Regions {
    /// What the shaders read.
    pub texels: Vec<[u32; 4]>,
    /// Lower corner of the tree's box.
    pub low: [f32; 3],
    /// Extent of the box; 0 where there are no cells.
    pub size: [f32; 3],
    /// First texel of the whole tape.
    pub whole_tape: u32,
    /// What it consists of.
    pub stats: RegionStats,
}

/// Programs up to this length are not divided further.
const UNDIVIDED_MAX: usize = 8;
/// Of a scene that needs gradients, cells near the middle are divided once more: down to this share of the way there.
const FINE_SHARE: f32 = 0.2;
/// Half the side of the tree of a scene without bounds.
const UNBOUNDED_REACH: f32 = 32.0;
/// So far around the bounds of a scene, shadow and occlusion rays still ask for distances.
const AROUND: f32 = 1.2;
/// No side of the tree is shorter than this share of the longest.
const SIDE_MIN: f32 = 0.25;
/// Farther from surfaces than this no ray asks for the object.
const OBJECT_REACH: f32 = 0.25;
/// Bounds are less by this share of the box's distance from the origin and its size. Processors of graphics round
/// otherwise: two dozen roundings of numbers of that size come to 3e-6 of it.
const ROUNDING: f32 = 1e-5;
/// Cells overlap by this share, since the shader rounds where it looks a point up.
const OVERLAP: f32 = 1e-6;
/// Largest penumbra: distance from a light over its sharpness.
const PENUMBRA_MAX: f32 = 1e9;

/// A box of cells.
#[derive(Debug, Clone, Copy)]
struct Block {
    low: [f32; 3],
    /// Of one of its 4x4x4 cells.
    cell: [f32; 3],
}

/// What a level of the tree works with.
#[derive(Debug, Default)]
struct Level {
    rows: Vec<Lanes>,
    decisions: Decisions,
    groups: Vec<u64>,
    short: Program,
}

struct Builder<'a> {
    frame: &'a FrameInputs,
    options: &'a RegionOptions,
    texels: Vec<Texel>,
    encoder: Encoder,
    known: HashMap<u64, u32>,
    levels: [Level; 4],
    /// Of scenes whose distance is none.
    gradients: Option<Gradients>,
    /// Whether the tree lies around the eye.
    unbounded: bool,
    margin: f32,
    overlap: f32,
    whole_tape: u32,
    whole_object: u32,
    stats: RegionStats,
}

/// Builds the tree of a program into which the frame's numbers were folded.
pub(super) fn build(
    program: Program,
    bounds: Option<([f32; 3], [f32; 3])>,
    has_rest: bool,
    steep: bool,
    frame: &FrameInputs,
    options: &RegionOptions,
) -> Regions {
    let (low, size) = extent(bounds, options.center);
    let farthest = (0..3).map(|axis| low[axis].abs().max((low[axis] + size[axis]).abs())).fold(0.0, f32::max);
    // Where the distance is none, rays cannot do without cells.
    let cells = (options.cells || steep) && has_rest && options.texels_max >= 4 * ROOT_SIDE.pow(3);
    let mut builder = Builder {
        frame,
        options,
        texels: vec![[0; 4]; if cells { ROOT_SIDE.pow(3) } else { 0 }],
        encoder: Encoder::default(),
        known: HashMap::new(),
        levels: Default::default(),
        gradients: steep.then(Gradients::default),
        unbounded: bounds.is_none(),
        margin: farthest * ROUNDING,
        overlap: farthest * OVERLAP,
        whole_tape: 0,
        whole_object: 0,
        stats: RegionStats::default(),
    };
    builder.write_whole(&program);
    if cells {
        let structure = Structure::of(&program);
        let cell = size.map(|side| side / BRICK_SIDE as f32);
        builder.divide_block(&program, &structure, Block { low, cell });
    }
    builder.stats.bytes = builder.texels.len() * size_of::<Texel>();
    Regions {
        low,
        size: if cells { size } else { [0.0; 3] },
        whole_tape: builder.whole_tape,
        texels: builder.texels,
        stats: builder.stats,
    }
}

/// The box of the tree: its lower corner and its extent.
fn extent(bounds: Option<([f32; 3], [f32; 3])>, center: [f32; 3]) -> ([f32; 3], [f32; 3]) {
    let (low, high) = bounds.unwrap_or((
        center.map(|middle| middle - UNBOUNDED_REACH),
        center.map(|middle| middle + UNBOUNDED_REACH),
    ));
    let sides: [f32; 3] = std::array::from_fn(|axis| high[axis] - low[axis] + 2.0 * AROUND);
    let longest = sides.into_iter().fold(0.0, f32::max);
    let size = sides.map(|side| side.max(SIDE_MIN * longest));
    let low = std::array::from_fn(|axis| 0.5 * (low[axis] + high[axis]) - 0.5 * size[axis]);
    (low, size)
}

impl Builder<'_> {
    /// The whole tape and the whole object's.
    fn write_whole(&mut self, program: &Program) {
        // A program with too many values at once has no tape here; the plan has told.
        if let Ok(texels) = self.encoder.encode(program, [OBJECT, OBJECT]) {
            self.whole_object = self.texels.len() as u32;
            self.texels.extend_from_slice(texels);
        }
        if let Ok(texels) = self.encoder.encode(program, [BOUND, ESTIMATE]) {
            self.texels.push([self.whole_object, 0, 0, 0]);
            self.whole_tape = self.texels.len() as u32;
            self.texels.extend_from_slice(texels);
            self.stats.whole_clauses = self.encoder.clauses;
        }
    }

    /// The 64 blocks of the root.
    fn divide_block(&mut self, program: &Program, structure: &Structure, block: Block) {
        let mut level = std::mem::take(&mut self.levels[0]);
        self.bound_cells(program, block, &mut level.rows);
        level.decisions.decide(program, structure, &level.rows, u64::MAX, u64::MAX);
        level.decisions.groups(program, &level.rows, &[u64::MAX], &mut level.groups);
        for index in 0..level.groups.len() {
            let group = level.groups[index];
            level.decisions.shortened(program, &level.rows, group, true, self.frame, &mut level.short);
            let structure = Structure::of(&level.short);
            for cell in cells_of(group) {
                let place = place_in(cell);
                let inner = block.child(place);
                let root = (0..CELLS).map(|child| {
                    let at: [usize; 3] =
                        std::array::from_fn(|axis| BRICK_SIDE * place[axis] + place_in(child)[axis]);
                    at[0] + ROOT_SIDE * (at[1] + ROOT_SIDE * at[2])
                });
                let root: Vec<usize> = root.collect();
                self.write_cells(&level.short, &structure, inner, 1, &|child| {
                    root.get(child).copied().unwrap_or(0)
                });
            }
        }
        self.levels[0] = level;
    }

    /// Bounds of all values of a program in the cells of a block.
    fn bound_cells(&mut self, program: &Program, block: Block, rows: &mut Vec<Lanes>) {
        self.stats.passes += 1;
        let zero = Lanes::splat(Interval::point(0.0));
        if rows.len() < 4 {
            rows.resize(4, zero);
        }
        for (axis, row) in rows.iter_mut().take(3).enumerate() {
            for cell in 0..CELLS {
                let along = place_in(cell)[axis] as f32;
                row.lo[cell] = block.low[axis] + along * block.cell[axis] - self.overlap;
                row.hi[cell] = block.low[axis] + (along + 1.0) * block.cell[axis] + self.overlap;
            }
        }
        if let Some(row) = rows.get_mut(3) {
            *row = Lanes::splat(Interval { lo: 0.0, hi: PENUMBRA_MAX });
        }
        bound(program, rows, self.frame);
    }

    /// Writes the 64 cells of a block to the texels that `texel_of` names, and divides those of the root that may hold
    /// a surface.
    fn write_cells(
        &mut self,
        program: &Program,
        structure: &Structure,
        block: Block,
        depth: usize,
        texel_of: &dyn Fn(usize) -> usize,
    ) {
        let Some(mut level) = self.levels.get_mut(depth).map(std::mem::take) else { return };
        self.bound_cells(program, block, &mut level.rows);
        let bounds = match program.roots[BOUND] {
            Arg::Value(value) => level.rows[value as usize],
            Arg::Number(number) => Lanes::splat(Interval::point(number)),
        };
        let (mut surface, mut near) = (0u64, 0u64);
        for cell in 0..CELLS {
            let Interval { lo, hi } = bounds.at(cell);
            let far = lo > OBJECT_REACH;
            near |= u64::from(!far) << cell;
            // What may be a NaN may be a surface; what is solid all through is none.
            surface |= u64::from(!(lo > self.margin) && !(hi < -self.margin)) << cell;
        }
        level.decisions.decide(program, structure, &level.rows, u64::MAX, near);
        level.decisions.groups(program, &level.rows, &[near, !near], &mut level.groups);
        for index in 0..level.groups.len() {
            let group = level.groups[index];
            let with_object = group & near != 0;
            level.decisions.shortened(program, &level.rows, group, with_object, self.frame, &mut level.short);
            let worth_it = match &self.gradients {
                None => depth == 1 && level.short.steps.len() > UNDIVIDED_MAX,
                Some(_) => depth == 1 || (depth == 2 && self.is_fine(&block)),
            };
            let divided = if worth_it { group & surface } else { 0 };
            let whole = group & !divided;
            if whole != 0 {
                let second = self.write_tape(&level.short, whole.count_ones() as usize);
                for cell in cells_of(whole) {
                    let slopes = self.slopes(&level, cell, surface);
                    self.write_cell(texel_of(cell), bounds.lo[cell], second, slopes);
                }
            }
            if divided != 0 {
                let structure = Structure::of(&level.short);
                for cell in cells_of(divided) {
                    if self.texels.len() + CELLS > self.options.texels_max {
                        let second = self.write_tape(&level.short, 1);
                        let slopes = self.slopes(&level, cell, surface);
                        self.write_cell(texel_of(cell), bounds.lo[cell], second, slopes);
                        continue;
                    }
                    let brick = self.texels.len();
                    self.texels.resize(brick + CELLS, [0; 4]);
                    self.texels[texel_of(cell)] = [DIVIDED, brick as u32, 0, 0];
                    let inner = block.child(place_in(cell));
                    self.write_cells(&level.short, &structure, inner, depth + 1, &|child| brick + child);
                }
            }
        }
        if let Some(kept) = self.levels.get_mut(depth) {
            *kept = level;
        }
    }

    /// Whether cells of a block that is divided once more are still larger than what is seen of them from the middle.
    fn is_fine(&self, block: &Block) -> bool {
        let away = (0..3).map(|axis| {
            let (low, high) = (block.low[axis], block.low[axis] + BRICK_SIDE as f32 * block.cell[axis]);
            (low - self.options.center[axis]).max(self.options.center[axis] - high).max(0.0)
        });
        let side = block.cell.into_iter().fold(0.0, f32::max);
        self.unbounded && side > FINE_SHARE * away.fold(0.0, f32::hypot)
    }

    /// The words of the gradient in one of the level's cells; 0 where no surface may be or nobody asks.
    fn slopes(&mut self, level: &Level, cell: usize, surface: u64) -> [u32; 2] {
        let frame = self.frame;
        match &mut self.gradients {
            Some(gradients) if surface >> cell & 1 == 1 => {
                let sides = std::array::from_fn(|axis| level.rows[axis].at(cell));
                gradients.words(&level.short, sides, frame)
            }
            _ => [0; 2],
        }
    }

    fn write_cell(&mut self, texel: usize, lowest: f32, second: u32, [z, w]: [u32; 2]) {
        let bound = lowest - self.margin;
        // No number is no bound.
        let bound = if bound > 0.0 { bound.min(1e9) } else { 0.0 };
        self.texels[texel] = [bound.to_bits(), second, z, w];
        self.stats.cells += 1;
    }

    /// A tape and the object's number as the second word of a cell.
    fn write_tape(&mut self, program: &Program, cells: usize) -> u32 {
        let (object, object_tape) = match program.roots[OBJECT] {
            Arg::Number(number) if (0.0..OBJECT_UNKNOWN as f32).contains(&number) => {
                (number as u32, self.whole_object)
            }
            Arg::Value(_) => {
                let tape = match self.encoder.encode(program, [OBJECT, OBJECT]) {
                    Ok(texels) => {
                        store(&mut self.texels, &mut self.known, None, texels, self.options.texels_max)
                    }
                    Err(_) => None,
                };
                (OBJECT_UNKNOWN, tape.map_or(self.whole_object, |(tape, _)| tape))
            }
            _ => (OBJECT_UNKNOWN, self.whole_object),
        };
        let tape = match self.encoder.encode(program, [BOUND, ESTIMATE]) {
            Ok(texels) => {
                store(&mut self.texels, &mut self.known, Some(object_tape), texels, self.options.texels_max)
            }
            Err(_) => None,
        };
        match tape {
            Some((tape, new)) => {
                if new {
                    self.stats.tapes += 1;
                    self.stats.clauses += self.encoder.clauses;
                }
                tape | object << 24
            }
            None => {
                self.stats.overflowed += cells;
                self.whole_tape | OBJECT_UNKNOWN << 24
            }
        }
    }
}

/// Where a tape stands, and whether it is new there; none where there is no room.
fn store(
    texels: &mut Vec<Texel>,
    known: &mut HashMap<u64, u32>,
    head: Option<u32>,
    tape: &[Texel],
    texels_max: usize,
) -> Option<(u32, bool)> {
    let head = head.map(|object| [object, 0, 0, 0]);
    let hash = head.iter().chain(tape).flatten().fold(tape.len() as u64, |hash, word| {
        (hash ^ u64::from(*word)).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29)
    });
    if let Some(&at) = known.get(&hash) {
        let start = at as usize;
        let same = texels.get(start..start + tape.len()) == Some(tape)
            && head.is_none_or(|head| start > 0 && texels.get(start - 1) == Some(&head));
        if same {
            return Some((at, false));
        }
    }
    let at = texels.len() + usize::from(head.is_some());
    if at + tape.len() > texels_max || at + tape.len() >= 1 << 24 {
        return None;
    }
    texels.extend(head);
    texels.extend_from_slice(tape);
    known.insert(hash, at as u32);
    Some((at as u32, true))
}

/// The place of one of 64 cells in their block.
const fn place_in(cell: usize) -> [usize; 3] {
    [cell % BRICK_SIDE, cell / BRICK_SIDE % BRICK_SIDE, cell / (BRICK_SIDE * BRICK_SIDE)]
}

/// The cells of a mask.
fn cells_of(mut mask: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let cell = (mask != 0).then(|| mask.trailing_zeros() as usize)?;
        mask &= mask - 1;
        Some(cell)
    })
}

impl Block {
    /// The block that one of the cells is.
    fn child(&self, place: [usize; 3]) -> Self {
        Self {
            low: std::array::from_fn(|axis| self.low[axis] + place[axis] as f32 * self.cell[axis]),
            cell: self.cell.map(|side| side / BRICK_SIDE as f32),
        }
    }
}
