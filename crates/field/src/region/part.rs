//! Builds a part of a tree: the blocks of the root that one thread processes, their bricks, and their texels. Each pass
//! processes 64 cells.

use std::collections::HashMap;
use std::hash::BuildHasherDefault;

use super::encode::{Encoder, Texel};
use super::gradient::Gradients;
use super::lanes::{CELLS, Lanes, bounds_of, cells_of, mask};
use super::program::{Arg, BOUND, ESTIMATE, OBJECT, Program, Structure};
use super::prune::{ChoiceTrace, Scratch, decide, of_distance};
use super::read::clauses;
use super::reuse::{Hashed, Memory, is_of_place, key_of, spread};
use super::tree::{Brick, RegionStats, Scale, Trunk, bound_cells, place_in};
use super::{BRICK_SIDE, DIVIDED, OBJECT_UNKNOWN, ROOT_SIDE};
use crate::graph::{Interval, Op};
use crate::rays::REGION_LEVELS;

/// Cells whose program has at most this many clauses are not divided.
const UNDIVIDED_MAX: usize = 16;
/// The cells of a brick are divided again if their program has more clauses than this. Shipped scenes have few such
/// cells; in a union of a thousand things, a cell of a brick may contain ten things. Tried for fractals, whose intervals
/// are too wide to exclude cells: bounds from the estimates at the centres of cells. This saves 3 to 13 % of the
/// evaluations, but the tree has four times as many texels.
const UNDIVIDED_AGAIN_MAX: usize = 96;
/// Maximum number of cells of bricks that are divided again, for a tree that takes 0.1 to 0.2 s.
const AGAIN_MAX: usize = 3072;
/// A cell of a brick whose program is longer than this fraction of the brick's is divided again only within
/// [`LONG_STEPS_MAX`]. In fractals, whose programs get no shorter, it took 160 of 190 ms and saved 1 % of the clauses.
const SHORTENED: f32 = 0.7;
/// Maximum number of steps of all such programs of a tree. Forest and spiral stay below it: there the cells show where
/// no surface is, which saves 5 and 15 % of the clauses.
const LONG_STEPS_MAX: usize = 1 << 16;
/// If a brick has more programs than this, decisions that save little are dropped. In lattice a brick had 25 programs,
/// mostly because cells differed in the sign of an ABS's operand or in the larger operand of a MAX. The limit costs
/// lattice and city 3 % more clauses; dropping such decisions in all bricks would cost speakers 13 %.
const GROUPS_MANY: usize = 16;
/// A pass over a program with more steps than this takes longer than 0.1 ms. Between shorter passes, a clock would take a
/// part of the time.
const LONG_PASS: usize = 1000;
/// Rays look up the object only within this distance of surfaces.
const OBJECT_REACH: f32 = 0.25;

/// The bits of a cell's second word that hold an address.
pub(super) const ADDRESS: u32 = (1 << 24) - 1;

type Cells = [Texel; CELLS];

#[derive(Debug, Default)]
struct Level {
    rows: Vec<Lanes>,
    decisions: ChoiceTrace,
    groups: Vec<u64>,
    /// Groups of cells that share their decisions.
    together: Vec<u64>,
    short: Program,
    structure: Structure,
}

#[derive(Debug, Default)]
struct Written {
    /// Bricks and tapes. Their addresses are counted from the end of the trunk's texels.
    texels: Vec<Texel>,
    bricks: Vec<usize>,
    /// For each brick that a later tree may copy, its key and its position.
    keys: Vec<(u64, usize)>,
    heads: Vec<usize>,
}

/// The cells of bricks that may still be divided.
#[derive(Debug)]
struct Again {
    cells: usize,
    /// Number of steps of programs that their cells did not shorten.
    long_steps: usize,
}

impl Again {
    /// Counts the division of a cell. `own` is the cell's program, `parent` the brick's.
    fn affords(&mut self, own: &Program, parent: &Program) -> bool {
        let steps = own.steps.len();
        let is_shortened = steps as f32 <= SHORTENED * parent.steps.len() as f32;
        if self.cells == 0 || !is_shortened && self.long_steps < steps {
            return false;
        }
        self.cells -= 1;
        self.long_steps -= if is_shortened { 0 } else { steps };
        true
    }
}

/// A part of a tree: some blocks of the root. Each part may have its own thread.
#[derive(Debug)]
pub struct Part<'a> {
    trunk: &'a Trunk<'a>,
    scale: Scale,
    /// Cells of the present block that are inside of the next smaller root, where they are not looked up.
    hidden: u64,
    number: usize,
    parts: usize,
    room: usize,
    written: Written,
    blocks: Vec<(usize, Cells)>,
    encoder: Encoder,
    scratch: Scratch,
    /// Second words of cells, by the hashes of their programs.
    known: HashMap<u64, u32, BuildHasherDefault<Hashed>>,
    levels: [Level; 1 + REGION_LEVELS as usize],
    again: Again,
    gradients: Option<Gradients>,
    stats: RegionStats,
}

impl<'a> Part<'a> {
    pub(super) fn new(trunk: &'a Trunk<'a>, number: usize, parts: usize) -> Self {
        Self {
            trunk,
            scale: Scale::default(),
            hidden: 0,
            number,
            parts,
            room: trunk.options.texels_max.saturating_sub(trunk.texels.len()) / parts,
            written: Written::default(),
            blocks: Vec::new(),
            encoder: trunk.encoder(),
            scratch: Scratch::default(),
            known: HashMap::default(),
            levels: Default::default(),
            again: Again { cells: AGAIN_MAX / parts, long_steps: LONG_STEPS_MAX / parts },
            gradients: trunk.variant.non_lipschitz.then(|| Gradients::new(trunk.steepest)),
            stats: RegionStats::default(),
        }
    }

    /// Builds the cells of this part.
    pub fn build(&mut self) {
        self.build_while(&|| true);
    }

    /// Builds the cells while `is_wanted` returns true: it is asked before each block of the root and before each pass
    /// over a program of more than [`LONG_PASS`] steps. Discard a cancelled part.
    pub fn build_while(&mut self, is_wanted: &dyn Fn() -> bool) {
        let Some(mut level) = self.levels.first_mut().map(std::mem::take) else { return };
        let trunk = self.trunk;
        for (number, root) in trunk.roots.iter().enumerate() {
            self.scale = root.scale;
            let bounds = bounds_of(&trunk.program, BOUND, &root.rows);
            for &group in &root.groups {
                // Distribute neighbouring blocks over the parts, because neighbours take about the same time.
                let own = |cell: &usize| place_in(*cell).iter().sum::<usize>() % self.parts == self.number;
                let own: Vec<usize> = cells_of(group).filter(own).collect();
                if own.is_empty() {
                    continue;
                }
                let (scratch, short) = (&mut self.scratch, &mut level.short);
                root.decisions.shortened(&trunk.program, &root.rows, group, trunk.frame, scratch, short);
                level.structure.analyse(&level.short);
                for cell in own {
                    if !is_wanted() {
                        return;
                    }
                    self.hidden = if number > 0 { inner_cells(cell) } else { 0 };
                    let inner = root.block.child(place_in(cell));
                    let lowest = bounds.lo[cell];
                    let cells = match number > 0 && lowest > self.scale.around {
                        // A ray crosses large cells in few steps, so exact bounds would save little.
                        true => std::array::from_fn(|_| self.cell(lowest, trunk.whole.second(), [0; 2])),
                        false => self.cells(&level, inner, 1, is_wanted),
                    };
                    self.blocks.push((CELLS * number + cell, cells));
                }
            }
        }
    }

    pub(super) fn texel_count(&self) -> usize {
        self.written.texels.len()
    }

    /// Returns the root's blocks and the texels, for a tree that begins with `before` texels of other parts. Adds the
    /// bricks and tapes that a later tree may copy to `memory`.
    pub(super) fn finish(
        mut self,
        before: usize,
        memory: &mut Memory,
    ) -> (Vec<(usize, Cells)>, Vec<Texel>, RegionStats) {
        let (start, shift) = (self.trunk.texels.len() as u32, before as u32);
        memory.programs.extend(self.known.iter().map(|(program, second)| (spread(second + shift), *program)));
        memory.seconds.extend(self.known.iter().map(|(program, second)| (*program, second + shift)));
        memory.bricks.extend(self.written.keys.iter().map(|(key, at)| (*key, start + shift + *at as u32)));
        if shift > 0 {
            let moved = |address: u32| if address & ADDRESS >= start { address + shift } else { address };
            for (_, cells) in &mut self.blocks {
                for cell in cells {
                    cell[1] = moved(cell[1]);
                }
            }
            for brick in &self.written.bricks {
                for cell in self.written.texels.iter_mut().skip(*brick).take(CELLS) {
                    cell[1] = moved(cell[1]);
                }
            }
            for head in &self.written.heads {
                let head = &mut self.written.texels[*head];
                head[0] = moved(head[0]);
            }
        }
        (self.blocks, self.written.texels, self.stats)
    }

    /// Returns the cells of a block, whose program is the shortened one of `parent`.
    fn cells(&mut self, parent: &Level, block: Brick, depth: usize, is_wanted: &dyn Fn() -> bool) -> Cells {
        let mut cells = [[0; 4]; CELLS];
        let (trunk, program, structure) = (self.trunk, &parent.short, &parent.structure);
        let Some(mut level) = self.levels.get_mut(depth).map(std::mem::take) else { return cells };
        self.stats.passes += 1;
        bound_cells(program, block, self.scale.overlap, &mut level.rows, trunk.frame);
        let bounds = bounds_of(program, BOUND, &level.rows);
        // A cell whose bound is NaN may contain a surface. A cell that is solid throughout contains no surface.
        let outside = mask(|cell| bounds.lo[cell] > self.scale.margin);
        let surface = !outside & !mask(|cell| -bounds.hi[cell] > self.scale.margin);
        // Few rays evaluate the distance in cells far from surfaces, so these cells use the whole tape.
        let (near, own) = match depth {
            1 => (
                !mask(|cell| bounds.lo[cell] > OBJECT_REACH) & !self.hidden,
                !mask(|cell| bounds.lo[cell] > self.scale.around) & !self.hidden,
            ),
            _ => (u64::MAX, u64::MAX),
        };
        for cell in cells_of(!own) {
            cells[cell] = self.cell(bounds.lo[cell], trunk.whole.second(), [0; 2]);
        }
        // Only penumbras and occlusion read tapes away from surfaces, so neighbouring cells share a tape there.
        let away = own & !surface;
        let neighbours = if depth == 1 { &EIGHTHS[..] } else { &[u64::MAX] };
        let fractions = neighbours.iter().flat_map(|eighth| [away & near & eighth, away & !near & eighth]);
        level.together.clear();
        level.together.extend(fractions.filter(|cells| *cells != 0));
        let roots = of_distance(own, near);
        for coarse in [false, true] {
            level.decisions.coarse = coarse;
            decide(&mut level.decisions, program, structure, &level.rows, &roots, &level.together);
            level.decisions.groups(&level.rows, &[near, own & !near], &mut level.groups);
            if depth == 1 || level.groups.len() <= GROUPS_MANY {
                break;
            }
        }
        // Tried: using the parent's tape if the cell's tape is more than 0.8 times as long. Lattice then has 39 % fewer
        // tapes but runs 8 % more clauses, and the build is hardly faster, because the shorter program must be written
        // before its length is known.
        for index in 0..level.groups.len() {
            let group = level.groups[index];
            let (scratch, short) = (&mut self.scratch, &mut level.short);
            level.decisions.shortened(program, &level.rows, group, trunk.frame, scratch, short);
            if group & near == 0 {
                level.short.roots[OBJECT] = Arg::Number(f32::NAN);
            }
            let slopes = self.slopes(&level, depth, group & surface);
            let mut divided = self.divisible(&level.short, &block, depth, group & surface);
            let mut program_hash = None;
            if divided != 0 {
                level.structure.analyse(&level.short);
                program_hash = is_of_place(&level.short).then(|| level.short.hash());
            }
            for cell in cells_of(divided) {
                let is_affordable = depth == 1 || self.again.affords(&level.short, program);
                let inner = block.child(place_in(cell));
                match is_affordable.then(|| self.brick(&level, program_hash, inner, depth, is_wanted)) {
                    Some(Some(address)) => cells[cell] = [DIVIDED, address, 0, 0],
                    _ => divided &= !(1 << cell),
                }
            }
            let whole = group & !divided;
            if whole != 0 {
                let second = self.tape(&level.short, whole.count_ones() as usize);
                for cell in cells_of(whole) {
                    cells[cell] = self.cell(bounds.lo[cell], second, slopes[cell]);
                }
            }
        }
        self.levels[depth] = level;
        cells
    }

    fn brick(
        &mut self,
        level: &Level,
        program: Option<u64>,
        inner: Brick,
        depth: usize,
        is_wanted: &dyn Fn() -> bool,
    ) -> Option<u32> {
        let address = self.address(CELLS)?;
        let brick = self.written.texels.len();
        self.written.bricks.push(brick);
        self.written.texels.resize(brick + CELLS, [0; 4]);
        let key = program.map(|program| key_of(program, &inner));
        self.written.keys.extend(key.map(|key| (key, brick)));
        let children = match key.and_then(|key| self.brick_of_before(key)) {
            Some(children) => children,
            None if level.short.steps.len() > LONG_PASS && !is_wanted() => [[0; 4]; CELLS],
            None => self.cells(level, inner, depth + 1, is_wanted),
        };
        self.written.texels[brick..brick + CELLS].copy_from_slice(&children);
        Some(address)
    }

    fn divisible(&self, program: &Program, block: &Brick, depth: usize, cells: u64) -> u64 {
        // One step reads a text or picture, which may have many edges in a cell. Dividing such cells twice would save
        // half of the remaining clauses, but the tree of a word would take 16 instead of 3 ms.
        let has_shape = || program.steps.iter().any(|step| step.op == Op::Shape);
        let is_long = match depth {
            1 => self.gradients.is_some() || program.steps.len() > UNDIVIDED_MAX || has_shape(),
            2 => {
                self.gradients.is_none() && program.steps.len() > UNDIVIDED_AGAIN_MAX && self.again.cells > 0
            }
            _ => false,
        };
        if !is_long {
            return 0;
        }
        let options = self.trunk.options;
        let Some(eye) = options.eye.or(self.trunk.unbounded.then_some(options.center)) else { return cells };
        cells_of(cells)
            .filter(|cell| self.is_close(block, *cell, eye))
            .fold(0, |close, cell| close | 1 << cell)
    }

    fn address(&self, texels: usize) -> Option<u32> {
        let at = self.trunk.texels.len() + self.written.texels.len();
        let fits =
            self.written.texels.len() + texels <= self.room && at + texels < ADDRESS as usize / self.parts;
        fits.then_some(at as u32)
    }

    /// True if a cell of a block looks large from a position near the eye. Other cells are not divided: few rays reach
    /// them, and their gradients take too long to compute.
    fn is_close(&self, block: &Brick, cell: usize, eye: [f32; 3]) -> bool {
        let place = place_in(cell);
        let away = (0..3).map(|axis| {
            let low = block.low[axis] + place[axis] as f32 * block.cell[axis];
            (low - eye[axis]).max(eye[axis] - low - block.cell[axis]).max(0.0)
        });
        let away_squared: f32 = away.map(|along| along * along).sum();
        let side = block.cell.into_iter().fold(0.0, f32::max);
        let fraction = self.scale.fine_fraction;
        side * side > fraction * fraction * away_squared
    }

    /// Returns the packed gradients for a group of the level's cells; 0 for cells without a surface, or if rays do not
    /// need gradients. In bricks, eight cells share a gradient, because a gradient costs as much as thousands of
    /// clauses.
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
            let found = gradients.words(&level.short, sides, self.trunk.frame);
            for cell in cells_of(sharing) {
                words[cell] = found;
            }
        }
        words
    }

    fn cell(&mut self, lowest: f32, second: u32, [z, w]: [u32; 2]) -> Texel {
        let bound = lowest - self.scale.margin;
        // A NaN becomes 0, because it is not a bound.
        let bound = if bound > 0.0 { bound.min(1e9) } else { 0.0 };
        self.stats.cells += 1;
        [bound.to_bits(), second, z, w]
    }

    /// Returns the second word of `cells` cells: a tape and the object's number. Equal programs share a tape.
    fn tape(&mut self, program: &Program, cells: usize) -> u32 {
        let hash = program.hash();
        if let Some(second) = self.known.get(&hash) {
            return *second;
        }
        let before = self.trunk.before.and_then(|before| before.second_of(hash));
        if let Some(second) = before.and_then(|second| self.tape_of_before(second)) {
            return second;
        }
        let Some(second) = self.new_tape(program) else {
            self.stats.overflowed += cells;
            return self.trunk.whole.second();
        };
        self.known.insert(hash, second);
        second
    }

    fn new_tape(&mut self, program: &Program) -> Option<u32> {
        let (object, object_tape) = match program.roots[OBJECT] {
            Arg::Number(number) if (0.0..OBJECT_UNKNOWN as f32).contains(&number) => {
                (number as u32, self.trunk.whole.object)
            }
            Arg::Value(_) => (OBJECT_UNKNOWN, self.stored(program, &[OBJECT, OBJECT], None)?),
            Arg::Number(_) => (OBJECT_UNKNOWN, self.trunk.whole.object),
        };
        let tape = self.stored(program, &[BOUND, ESTIMATE], Some(object_tape))?;
        self.stats.tapes += 1;
        self.stats.clauses += self.encoder.clauses;
        Some(tape | object << 24)
    }

    /// Copies a brick's cells and tapes from the previous frame's tree; `None` if that tree does not have the brick, or
    /// if there is no room.
    fn brick_of_before(&mut self, key: u64) -> Option<Cells> {
        let before = self.trunk.before?;
        let mut cells = [[0; 4]; CELLS];
        let mut last = None;
        for (cell, old) in cells.iter_mut().zip(before.brick(key)?) {
            let [bound, second, z, w] = *old;
            // The children of a divided cell are looked up on their own.
            if bound == DIVIDED {
                return None;
            }
            let second = match last {
                Some((of, moved)) if of == second => moved,
                _ => {
                    let moved = self.tape_of_before(second)?;
                    last = Some((second, moved));
                    moved
                }
            };
            *cell = [bound, second, z, w];
        }
        self.stats.cells += CELLS;
        self.stats.copied += 1;
        Some(cells)
    }

    /// Copies a tape from the previous frame's tree, given a cell's second word there. Returns the new second word.
    fn tape_of_before(&mut self, second: u32) -> Option<u32> {
        let tape = self.trunk.before?.tape(second)?;
        if let Some(known) = self.known.get(&tape.program) {
            return Some(*known);
        }
        let object_tape = match tape.object_tape {
            None => self.trunk.whole.object,
            Some(texels) => {
                let at = self.address(texels.len())?;
                self.written.texels.extend_from_slice(texels);
                at
            }
        };
        let at = self.address(1 + tape.texels.len())?;
        self.written.heads.push(self.written.texels.len());
        self.written.texels.push([object_tape, 0, 0, 0]);
        self.written.texels.extend_from_slice(tape.texels);
        self.stats.tapes += 1;
        self.stats.clauses += clauses(tape.texels);
        let second = (at + 1) | tape.object << 24;
        self.known.insert(tape.program, second);
        Some(second)
    }

    /// Writes a texel with the address of the object's tape, then a new tape. Returns the address of the new tape.
    fn stored(&mut self, program: &Program, roots: &[usize], object_tape: Option<u32>) -> Option<u32> {
        let before = usize::from(object_tape.is_some());
        let count = self.encoder.encode(program, roots)?.len();
        let at = self.address(before + count)?;
        if let Some(object) = object_tape {
            self.written.heads.push(self.written.texels.len());
            self.written.texels.push([object, 0, 0, 0]);
        }
        self.written.texels.extend_from_slice(&self.encoder.texels);
        Some(at + before as u32)
    }
}

/// The cells of a root's block that are inside of the next smaller root.
fn inner_cells(block: usize) -> u64 {
    let (first, last) = (ROOT_SIDE / 2 - BRICK_SIDE / 2, ROOT_SIDE / 2 + BRICK_SIDE / 2);
    let at = |cell: usize, axis: usize| BRICK_SIDE * place_in(block)[axis] + place_in(cell)[axis];
    mask(|cell| (0..3).all(|axis| (first..last).contains(&at(cell, axis))))
}

const fn eighth_of(cell: usize) -> u64 {
    let first = cell & 0b10_10_10;
    0b11_0011 << first | 0b11_0011 << (first + 16)
}

const EIGHTHS: [u64; 8] = {
    let mut eighths = [0; 8];
    let mut number = 0;
    while number < 8 {
        eighths[number] = eighth_of((number & 1) << 1 | (number & 2) << 2 | (number & 4) << 3);
        number += 1;
    }
    eighths
};
