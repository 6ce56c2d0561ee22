//! The tree: cells of 64 at once, from the root to bricks, and what is written for each.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use super::encode::{Encoder, Texel};
use super::gradient::Gradients;
use super::lanes::{CELLS, Lanes, bound, mask};
use super::program::{Arg, BOUND, ESTIMATE, INPUTS, OBJECT, Program, Structure};
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
    /// Lower and upper corner of what holds all surfaces of the frame, planes apart, where that is known.
    pub bounds: Option<([f32; 3], [f32; 3])>,
    /// First texel of the whole tape.
    pub whole_tape: u32,
    /// What it consists of.
    pub stats: RegionStats,
}

/// Programs up to this length are not divided further.
const UNDIVIDED_MAX: usize = 12;
/// How often the bounds of a frame are made smaller at most: a pass each.
const TIGHTENINGS_MAX: usize = 3;
/// Of a scene without bounds that needs gradients, cells are divided whose side is more than this share of the way from
/// the middle.
const FINE_SHARE: f32 = 0.3;
/// Half the side of the tree of a scene without bounds.
const UNBOUNDED_REACH: f32 = 32.0;
/// So far from surfaces penumbras and occlusion still ask for distances: a little more than the highest probe.
const AROUND: f32 = 1.2;
/// Farther from surfaces than this no ray asks for the object.
const OBJECT_REACH: f32 = 0.25;
/// Bounds are less by this share of the box's distance from the origin and its size. Processors of graphics round
/// otherwise: two dozen roundings of numbers of that size come to 3e-6 of it.
const ROUNDING: f32 = 1e-5;
/// Cells overlap by this share: rays look for their cell a hundred-thousandth of a root cell further on.
const OVERLAP: f32 = 4e-6;
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
    /// Cells that share their decisions.
    together: Vec<u64>,
    short: Program,
    /// Of `short`.
    structure: Structure,
}

struct Builder<'a> {
    frame: &'a FrameInputs,
    options: &'a RegionOptions,
    texels: Vec<Texel>,
    encoder: Encoder,
    /// Second words of cells by the hash of their programs.
    known: HashMap<u64, u32, BuildHasherDefault<Hashed>>,
    levels: [Level; 3],
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
    let bounds = bounds.map(|bounds| if has_rest { tightened(&program, bounds, frame) } else { bounds });
    let (low, size) = extent(bounds, options.center);
    let farthest = (0..3).map(|axis| low[axis].abs().max((low[axis] + size[axis]).abs())).fold(0.0, f32::max);
    // Where the distance is none, rays cannot do without cells.
    let cells = (options.cells || steep) && has_rest && options.texels_max >= 4 * ROOT_SIDE.pow(3);
    let mut builder = Builder {
        frame,
        options,
        texels: vec![[0; 4]; if cells { ROOT_SIDE.pow(3) } else { 0 }],
        encoder: Encoder::default(),
        known: HashMap::default(),
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
        let mut structure = Structure::default();
        structure.look_at(&program);
        let cell = size.map(|side| side / BRICK_SIDE as f32);
        builder.divide_block(&program, &structure, Block { low, cell });
    }
    builder.stats.bytes = builder.texels.len() * size_of::<Texel>();
    Regions {
        low,
        size: if cells { size } else { [0.0; 3] },
        bounds,
        whole_tape: builder.whole_tape,
        texels: builder.texels,
        stats: builder.stats,
    }
}

/// Bounds of all surfaces of a frame within those of all frames.
fn tightened(program: &Program, bounds: ([f32; 3], [f32; 3]), frame: &FrameInputs) -> ([f32; 3], [f32; 3]) {
    let (mut low, mut high) = bounds;
    let mut rows = Vec::new();
    for _ in 0..TIGHTENINGS_MAX {
        let block =
            Block { low, cell: std::array::from_fn(|axis| (high[axis] - low[axis]) / BRICK_SIDE as f32) };
        let farthest = low.iter().chain(&high).fold(0.0f32, |most, side| most.max(side.abs()));
        bound_cells(program, block, farthest * OVERLAP, &mut rows, frame);
        let held = |cell: usize| match program.roots[BOUND] {
            // What may be a NaN may be a surface.
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
        high = std::array::from_fn(|axis| low[axis] + last[axis] as f32 * block.cell[axis]);
        low = std::array::from_fn(|axis| low[axis] + first[axis] as f32 * block.cell[axis]);
    }
    (low, high)
}

/// False for what may be a NaN, too.
fn surely_above(value: f32, limit: f32) -> bool {
    value > limit
}

/// The box of the tree: its lower corner and its extent.
fn extent(bounds: Option<([f32; 3], [f32; 3])>, center: [f32; 3]) -> ([f32; 3], [f32; 3]) {
    let (low, high) = bounds.unwrap_or((
        center.map(|middle| middle - UNBOUNDED_REACH),
        center.map(|middle| middle + UNBOUNDED_REACH),
    ));
    let sides: [f32; 3] = std::array::from_fn(|axis| high[axis] - low[axis] + 2.0 * AROUND);
    let longest = sides.into_iter().fold(0.0, f32::max);
    // A cube: cells that are as long in all directions bound best.
    let size = [longest; 3];
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
        self.stats.passes += 1;
        bound_cells(program, block, self.overlap, &mut level.rows, self.frame);
        level.decisions.decide(program, structure, &level.rows, u64::MAX, u64::MAX, &[]);
        level.decisions.groups(&level.rows, &[u64::MAX], &mut level.groups);
        for index in 0..level.groups.len() {
            let group = level.groups[index];
            level.decisions.shortened(program, &level.rows, group, true, self.frame, &mut level.short);
            level.structure.look_at(&level.short);
            for cell in cells_of(group) {
                let place = place_in(cell);
                let inner = block.child(place);
                let root = (0..CELLS).map(|child| {
                    let at: [usize; 3] =
                        std::array::from_fn(|axis| BRICK_SIDE * place[axis] + place_in(child)[axis]);
                    at[0] + ROOT_SIDE * (at[1] + ROOT_SIDE * at[2])
                });
                let root: Vec<usize> = root.collect();
                self.write_cells(&level.short, &level.structure, inner, 1, &|child| {
                    root.get(child).copied().unwrap_or(0)
                });
            }
        }
        self.levels[0] = level;
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
        self.stats.passes += 1;
        bound_cells(program, block, self.overlap, &mut level.rows, self.frame);
        let bounds = match program.roots[BOUND] {
            Arg::Value(value) => level.rows[value as usize],
            Arg::Number(number) => Lanes::splat(Interval::point(number)),
        };
        let (mut surface, mut near, mut reached) = (0u64, 0u64, 0u64);
        for cell in 0..CELLS {
            let Interval { lo, hi } = bounds.at(cell);
            let far = lo > OBJECT_REACH;
            near |= u64::from(!far) << cell;
            reached |= u64::from(!surely_above(lo, AROUND)) << cell;
            // What may be a NaN may be a surface; what is solid all through is none.
            surface |= u64::from(!surely_above(lo, self.margin) && !surely_above(-hi, self.margin)) << cell;
        }
        // Few rays ask for a distance far from the surfaces: in bricks the tape of all 64 does, in the root the whole one.
        let own = if depth == 1 { reached } else { near };
        if own != u64::MAX {
            let second = if depth == 1 {
                self.whole_tape | OBJECT_UNKNOWN << 24
            } else {
                self.write_tape(program, CELLS)
            };
            for cell in cells_of(!own) {
                self.write_cell(texel_of(cell), bounds.lo[cell], second, [0; 2]);
            }
        }
        // Away from surfaces only penumbras and occlusion ask: neighbours share a tape there.
        let away = own & !surface;
        let neighbours = if depth == 1 { &EIGHTHS[..] } else { &[u64::MAX] };
        level.together.clear();
        level.together.extend(
            neighbours
                .iter()
                .flat_map(|cells| [away & near & cells, away & !near & cells])
                .filter(|cells| *cells != 0),
        );
        level.decisions.decide(program, structure, &level.rows, own, near, &level.together);
        level.decisions.groups(&level.rows, &[near, own & !near], &mut level.groups);
        for index in 0..level.groups.len() {
            let group = level.groups[index];
            let with_object = group & near != 0;
            level.decisions.shortened(program, &level.rows, group, with_object, self.frame, &mut level.short);
            let worth_it = match &self.gradients {
                None => depth == 1 && level.short.steps.len() > UNDIVIDED_MAX,
                Some(_) => depth == 1,
            };
            let mut divided = if worth_it { group & surface } else { 0 };
            if self.gradients.is_some() {
                divided &= mask(|cell| self.is_close(&block, cell));
            }
            let whole = group & !divided;
            let slopes = self.slopes(&level, depth, group & surface);
            if whole != 0 {
                let second = self.write_tape(&level.short, whole.count_ones() as usize);
                for cell in cells_of(whole) {
                    self.write_cell(texel_of(cell), bounds.lo[cell], second, slopes[cell]);
                }
            }
            if divided != 0 {
                level.structure.look_at(&level.short);
                for cell in cells_of(divided) {
                    if self.texels.len() + CELLS > self.options.texels_max {
                        let second = self.write_tape(&level.short, 1);
                        self.write_cell(texel_of(cell), bounds.lo[cell], second, slopes[cell]);
                        continue;
                    }
                    let brick = self.texels.len();
                    self.texels.resize(brick + CELLS, [0; 4]);
                    self.texels[texel_of(cell)] = [DIVIDED, brick as u32, 0, 0];
                    let inner = block.child(place_in(cell));
                    self.write_cells(&level.short, &level.structure, inner, depth + 1, &|child| {
                        brick + child
                    });
                }
            }
        }
        if let Some(kept) = self.levels.get_mut(depth) {
            *kept = level;
        }
    }

    /// Whether a cell of a block looks large from the middle of a tree without bounds. Gradients take too long to have
    /// them for small cells everywhere.
    fn is_close(&self, block: &Block, cell: usize) -> bool {
        let place = place_in(cell);
        let away = (0..3).map(|axis| {
            let low = block.low[axis] + place[axis] as f32 * block.cell[axis];
            let center = self.options.center[axis];
            (low - center).max(center - low - block.cell[axis]).max(0.0)
        });
        let side = block.cell.into_iter().fold(0.0, f32::max);
        !self.unbounded || side > FINE_SHARE * away.fold(0.0, f32::hypot)
    }

    /// The words of the gradient for a group of the level's cells, 0 where no surface may be or nobody asks. In bricks
    /// eight neighbours share one: finding it costs as much as thousands of clauses.
    fn slopes(&mut self, level: &Level, depth: usize, cells: u64) -> [[u32; 2]; CELLS] {
        let mut words = [[0; 2]; CELLS];
        let Some(gradients) = &mut self.gradients else { return words };
        let mut left = cells;
        while left != 0 {
            let first = left.trailing_zeros() as usize;
            let sharing = if depth == 1 { 1 << first } else { left & eighth_of(first) };
            left &= !sharing;
            let sides = std::array::from_fn(|axis| {
                let ends = cells_of(sharing).map(|cell| level.rows[axis].at(cell));
                ends.fold(level.rows[axis].at(first), Interval::hull)
            });
            let found = gradients.words(&level.short, sides, self.frame);
            for cell in cells_of(sharing) {
                words[cell] = found;
            }
        }
        words
    }

    fn write_cell(&mut self, texel: usize, lowest: f32, second: u32, [z, w]: [u32; 2]) {
        let bound = lowest - self.margin;
        // No number is no bound.
        let bound = if bound > 0.0 { bound.min(1e9) } else { 0.0 };
        self.texels[texel] = [bound.to_bits(), second, z, w];
        self.stats.cells += 1;
    }

    /// A tape and the object's number as the second word of a cell. Equal programs share one.
    fn write_tape(&mut self, program: &Program, cells: usize) -> u32 {
        let hash = program.hash();
        if let Some(second) = self.known.get(&hash) {
            return *second;
        }
        let Some(second) = self.write_new_tape(program) else {
            self.stats.overflowed += cells;
            return self.whole_tape | OBJECT_UNKNOWN << 24;
        };
        self.known.insert(hash, second);
        second
    }

    /// None if there is no room.
    fn write_new_tape(&mut self, program: &Program) -> Option<u32> {
        let (object, object_tape) = match program.roots[OBJECT] {
            Arg::Number(number) if (0.0..OBJECT_UNKNOWN as f32).contains(&number) => {
                (number as u32, self.whole_object)
            }
            Arg::Value(_) => {
                let texels = self.encoder.encode(program, [OBJECT, OBJECT]).ok()?;
                (OBJECT_UNKNOWN, store(&mut self.texels, None, texels, self.options.texels_max)?)
            }
            Arg::Number(_) => (OBJECT_UNKNOWN, self.whole_object),
        };
        let texels = self.encoder.encode(program, [BOUND, ESTIMATE]).ok()?;
        let tape = store(&mut self.texels, Some(object_tape), texels, self.options.texels_max)?;
        self.stats.tapes += 1;
        self.stats.clauses += self.encoder.clauses;
        Some(tape | object << 24)
    }
}

/// Bounds of all values of a program in the cells of a block, each larger by `overlap` on all sides.
fn bound_cells(program: &Program, block: Block, overlap: f32, rows: &mut Vec<Lanes>, frame: &FrameInputs) {
    rows.resize(rows.len().max(INPUTS), Lanes::splat(Interval::point(0.0)));
    for (axis, row) in rows.iter_mut().take(3).enumerate() {
        for cell in 0..CELLS {
            let along = place_in(cell)[axis] as f32;
            row.lo[cell] = block.low[axis] + along * block.cell[axis] - overlap;
            row.hi[cell] = block.low[axis] + (along + 1.0) * block.cell[axis] + overlap;
        }
    }
    if let Some(row) = rows.get_mut(3) {
        *row = Lanes::splat(Interval { lo: 0.0, hi: PENUMBRA_MAX });
    }
    bound(program, rows, frame);
}

/// Appends a tape, after the texel that names the tape of its object; none where there is no room.
fn store(
    texels: &mut Vec<Texel>,
    object_tape: Option<u32>,
    tape: &[Texel],
    texels_max: usize,
) -> Option<u32> {
    let at = texels.len() + usize::from(object_tape.is_some());
    if at + tape.len() > texels_max || at + tape.len() >= 1 << 24 {
        return None;
    }
    texels.extend(object_tape.map(|object| [object, 0, 0, 0]));
    texels.extend_from_slice(tape);
    Some(at as u32)
}

/// Keys that are hashes already.
#[derive(Debug, Default)]
struct Hashed(u64);

impl Hasher for Hashed {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        self.0 = bytes.iter().fold(self.0, |hash, byte| hash << 8 | u64::from(*byte));
    }

    fn write_u64(&mut self, hash: u64) {
        self.0 = hash;
    }
}

/// The place of one of 64 cells in their block.
const fn place_in(cell: usize) -> [usize; 3] {
    [cell % BRICK_SIDE, cell / BRICK_SIDE % BRICK_SIDE, cell / (BRICK_SIDE * BRICK_SIDE)]
}

/// The cells of the same 2x2x2 as one of 64.
const fn eighth_of(cell: usize) -> u64 {
    let first = cell & 0b10_10_10;
    0b11_0011 << first | 0b11_0011 << (first + 16)
}

/// The eight 2x2x2 of 64 cells.
const EIGHTHS: [u64; 8] = [
    eighth_of(0),
    eighth_of(2),
    eighth_of(8),
    eighth_of(10),
    eighth_of(32),
    eighth_of(34),
    eighth_of(40),
    eighth_of(42),
];

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
