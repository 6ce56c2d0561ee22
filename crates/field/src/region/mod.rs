//! Regions: a tree over space, built for each frame. Each cell holds a lower bound of the distance to the surfaces and
//! a tape that computes the distance and is shortened for the cell.
//!
//! Keeter, "Massively parallel rendering of complex closed-form implicit surfaces" (2020) shortens tapes by interval
//! arithmetic for tiles of the screen. Here the cells divide the world, so that shadow, occlusion and reflection rays
//! can use the tapes as well.
//!
//! ```text
//! World → RegionPlan; with a frame's inputs: numbers folded in → 64 cells at once: bounds → decisions → groups of
//!         equal decisions → shorter programs → cells again, or tapes
//! ```
//!
//! # Texels
//! The shaders read [`Regions::texels`], RGBA32UI:
//!
//! | texel | holds |
//! |---|---|
//! | 4096 of a root | 16x16x16 cells, `x + 16 * (y + 16 * z)`; the first root begins at 0 |
//! | 64 of a brick | the children of a divided cell, `x + 4 * (y + 4 * z)` |
//! | a tape | a texel with the address of the object's tape; then the clauses (`encode`) |
//!
//! A cell is `[bound, tape | object << 24, slopes, slopes]`:
//!
//! - The bound is a lower bound of the distance everywhere in the cell, as a float's bits. It is 0 if the cell may
//!   contain a surface. The bound [`DIVIDED`] marks a divided cell; its second word is the first texel of its brick.
//! - The second word holds the first texel of the cell's tape and the number of the nearest object, or
//!   [`OBJECT_UNKNOWN`].
//! - The slopes are bounds of the gradient ([`gradient`]) if the value is not a distance ([`World::non_lipschitz`])
//!   and the cell may contain a surface, else 0.
//!
//! # Construction
//! A frame's numbers are folded into the distance's program. Interval arithmetic then bounds the program's values in 64
//! cells at once, and masks of 64 bits record the decisions about each value (`prune.rs`). Cells with equal masks share
//! a program, which is written once; programs with equal steps share a tape.
//!
//! The root has 16 cells along each axis. A cell with a surface and more than 16 clauses has 64 children; a child with
//! more than 96 clauses also has 64 children, up to two limits (`part.rs`). Only penumbras and occlusion read tapes away
//! from surfaces, so each 2x2x2 cells there share their decisions. Several threads can build blocks of the root: this module
//! makes the [`Part`]s, `gpu::scene_resources` runs the threads.
//!
//! # Rounding
//! On the CPU a shortened tape equals the whole tape bit for bit in its cell. Shaders round differently: bounds are
//! reduced by 1e-5 of the scene's size, and cells overlap by 4e-6 of that size (`tree.rs`). Rays look up their cell a
//! hundred-thousandth of a root cell ahead, so that no ray gets stuck at a face.

mod blend;
mod encode;
pub(crate) mod every_frame;
pub mod gradient;
mod lanes;
mod medium;
mod part;
mod program;
mod prune;
mod read;
mod reuse;
pub(crate) mod surface;
mod tree;

pub use medium::{MEDIUM_SIDE, MediumGrid, MediumPlan};
pub use part::Part;
#[cfg(test)]
pub(crate) use read::run_texels;
pub use read::{Cell, ListedClause};
pub use surface::Surfaces;
pub use tree::{RegionOptions, RegionStats, Regions};

use std::collections::BTreeSet;

use crate::bounds::Bounds;
use crate::graph::{
    Compounds, FrameInputs, Graph, Input, Node, NodeId, Op, Properties, ShapeAtlas, TableData, Uses,
};
use crate::tape::interpreter::rounded_registers;
use crate::world::World;
use encode::{Encoder, REGISTERS_MAX};
use program::{Arg, BOUND, ESTIMATE, OBJECT, Program};
use reuse::ShortLives;

/// Cells of the root along each axis.
pub const ROOT_SIDE: usize = crate::rays::ROOT_SIDE as usize;
/// Extent of a root, as a multiple of the extent of the next smaller root, which is its inner 4x4x4 cells.
pub const ROOT_GROWTH: usize = 4;
const _: () = assert!(ROOT_SIDE == 16 && ROOT_GROWTH == 4, "`shaders/regions.glsl` has these numbers");
/// Cells of a brick along each axis.
pub const BRICK_SIDE: usize = 4;
/// The whole tapes need this number of texels in addition to those of their clauses.
const WHOLE_BESIDE: usize = 8;
/// The bound of a divided cell.
pub const DIVIDED: u32 = u32::MAX;
/// The object of a cell where several objects may be the nearest.
pub const OBJECT_UNKNOWN: u32 = 255;

/// The features that an interpreter needs to run the regions' tapes.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct RegionVariant {
    /// The operators that occur.
    pub operators: BTreeSet<Op>,
    /// The compounds that may occur.
    pub compounds: Compounds,
    /// Number of registers, up to 256, rounded by [`rounded_registers`]. GPUs round this number up to a power of two.
    pub registers: usize,
    /// True if rays need the cells' bounds of the gradient.
    pub non_lipschitz: bool,
}

impl RegionVariant {
    /// Returns a variant with all operators, and with the registers of the largest shipped scene. With 32 registers
    /// instead of 16, Vega's compiler (ACO) uses no more registers of the GPU. `non_lipschitz` adds support for values
    /// that are not distances.
    pub fn universal(non_lipschitz: bool) -> Self {
        Self {
            operators: Op::ALL.iter().copied().collect(),
            compounds: Compounds::ALL,
            registers: 32,
            non_lipschitz,
        }
    }
}

/// The inputs that determine a tree or a shortened program. Equal keys give equal results.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionKey {
    numbers: Vec<u32>,
    tables: Vec<TableData>,
    shapes: Option<ShapeAtlas>,
}

/// The inputs of the frame that expressions read.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Reads {
    inputs: Vec<Input>,
    tables: BTreeSet<Op>,
}

impl Reads {
    pub(crate) fn of(graph: &Graph, roots: &[NodeId]) -> Self {
        let used = graph.inputs_used(roots);
        let inputs = used.inputs.into_iter().filter(|input| input.of_point().is_none()).collect();
        Self { inputs, tables: used.tables }
    }

    pub(crate) fn key(&self, inputs: &FrameInputs) -> RegionKey {
        let mut numbers: Vec<u32> = self.inputs.iter().map(|input| inputs.value(*input).to_bits()).collect();
        let (mut tables, mut shapes) = (Vec::new(), None);
        for op in &self.tables {
            match op {
                Op::Shape | Op::ShapeNumber => shapes = Some(inputs.shapes.clone()),
                Op::Part => numbers.extend(inputs.parts.iter().map(|number| number.to_bits())),
                Op::Spectrum => tables.push(inputs.spectrum.clone()),
                Op::Waveform => tables.push(inputs.waveform.clone()),
                Op::History => tables.push(inputs.history.clone()),
                op => {
                    let levels = op.level_list().map_or(&[][..], |list| inputs.levels.of(list));
                    numbers.extend(levels.iter().map(|level| level.to_bits()));
                }
            }
        }
        RegionKey { numbers, tables, shapes }
    }
}

enum Numbers<'a> {
    /// Numbers count as unknown, so that no decision depends on them.
    Unknown,
    /// All numbers are replaced by one that allows no simplification, as in most frames.
    Typical,
    Of(&'a FrameInputs),
}

/// A number to which no simplification applies.
const TYPICAL: f32 = 0.618_034;

/// The parts of a world's regions that all frames share.
#[derive(Debug, Clone)]
pub struct RegionPlan {
    nodes: Vec<(usize, Node)>,
    roots: [usize; 3],
    graph_nodes: usize,
    reads: Reads,
    /// The features that an interpreter needs to run all trees of this plan.
    pub variant: RegionVariant,
    bounds: Option<Bounds>,
    has_rest: bool,
    steepest: Option<f32>,
    /// True if there are enough registers for the whole tape. Otherwise there are no tapes and no cells.
    pub runs: bool,
    /// An upper bound of the texels of the whole tapes. Drivers with smaller buffers cannot use regions.
    pub whole_texels: usize,
}

impl RegionPlan {
    /// Creates the plan of a world.
    pub fn new(world: &World) -> Self {
        let [bound, estimate] = world.roots.distance;
        let roots = [bound, estimate, world.roots.object];
        let steepest = world.non_lipschitz.then_some(world.slopes.steepest);
        Self::of(&world.graph, roots, world.bounds, world.has_rest, steepest)
    }

    /// `steepest` is [`Slopes::steepest`](crate::world::Slopes::steepest) if the bound is not a distance.
    fn of(
        graph: &Graph,
        mut roots: [NodeId; 3],
        bounds: Option<Bounds>,
        has_rest: bool,
        steepest: Option<f32>,
    ) -> Self {
        let graph = graph.fused(&mut roots);
        let mut plan = Self {
            nodes: graph.order(&roots).iter().map(|id| (id.index(), graph.node(*id))).collect(),
            roots: roots.map(|root| root.index()),
            graph_nodes: graph.len(),
            reads: Reads::of(&graph, &roots),
            variant: RegionVariant::default(),
            bounds,
            has_rest,
            steepest,
            runs: true,
            whole_texels: 0,
        };
        // With unknown numbers nothing is folded, so this program has all operators and registers of every frame's
        // program.
        let whole = |plan: &Self| {
            let program = plan.folded(&Numbers::Unknown, &FrameInputs::default());
            let registers = registers_of(&program);
            (program, registers)
        };
        let (mut program, mut registers) = whole(&plan);
        if registers.is_none() {
            plan.shorten_lives();
            (program, registers) = whole(&plan);
        }
        let typical = plan.folded(&Numbers::Typical, &FrameInputs::default());
        let compounds = Compounds::that_pay(|compounds| {
            let mut uses = Uses::default();
            let mut encoder = Encoder::new(compounds, REGISTERS_MAX);
            if encoder.encode(&typical, &[BOUND, ESTIMATE]).is_ok() {
                encoder.count(&mut uses);
            }
            uses
        });
        plan.runs = registers.is_some();
        plan.whole_texels = program.steps.len() + WHOLE_BESIDE;
        let operators = program.steps.iter().map(|step| step.op).collect();
        let registers = rounded_registers(registers.unwrap_or(REGISTERS_MAX));
        plan.variant = RegionVariant { operators, compounds, registers, non_lipschitz: steepest.is_some() };
        plan
    }

    fn shorten_lives(&mut self) {
        let lives = ShortLives::of(&self.nodes, self.graph_nodes);
        self.roots = self.roots.map(|root| lives.position(root));
        (self.nodes, self.graph_nodes) = (lives.nodes, lives.positions);
    }

    /// Returns the inputs that determine a frame's tree.
    pub fn key(&self, inputs: &FrameInputs) -> RegionKey {
        self.reads.key(inputs)
    }

    /// Builds the tree of a frame.
    pub fn build(&self, inputs: &FrameInputs, options: &RegionOptions) -> Regions {
        self.build_in_parts(None, inputs, options, 1, |parts| parts.iter_mut().for_each(Part::build))
    }

    /// Returns the program with the given numbers folded in. If the frame is unknown, its tables are unknown values.
    fn folded(&self, numbers: &Numbers, frame: &FrameInputs) -> Program {
        let mut program = Program { steps: Vec::with_capacity(self.nodes.len()), ..Program::default() };
        let of_point = |node: Node| match node {
            Node::Input(input) => match input.of_point() {
                Some(place) if place < program::INPUTS => Arg::Value(place as u32),
                // A distance does not depend on a normal.
                _ => Arg::Number(0.0),
            },
            // Shapes do not read textures.
            _ => Arg::Number(0.0),
        };
        let places = fold(&mut program, &self.nodes, self.graph_nodes, numbers, frame, of_point);
        program.roots = self.roots.iter().map(|root| places[*root]).collect();
        program
    }
}

/// Returns the registers that a program needs; `None` if it needs too many.
fn registers_of(program: &Program) -> Option<usize> {
    let mut encoder = Encoder::new(Compounds::NONE, REGISTERS_MAX);
    let roots = [[BOUND, ESTIMATE], [OBJECT, OBJECT]];
    roots.iter().all(|roots| encoder.encode(program, roots).is_ok()).then_some(encoder.registers)
}

/// Appends nodes, operands first, with the numbers folded in. Returns the value of each of the `graph_nodes` nodes.
/// `of_point` maps inputs of the point and texture samples to values.
fn fold(
    program: &mut Program,
    nodes: &[(usize, Node)],
    graph_nodes: usize,
    numbers: &Numbers,
    frame: &FrameInputs,
    of_point: impl Fn(Node) -> Arg,
) -> Vec<Arg> {
    let unknown = Arg::Value(program::PENUMBRA);
    let reads_frame =
        |op: Op| !matches!(numbers, Numbers::Of(_)) && op.properties().has(Properties::READS_FRAME);
    let mut places = vec![Arg::Number(0.0); graph_nodes];
    let mut of_frame = vec![false; graph_nodes];
    for (index, node) in nodes {
        of_frame[*index] = match *node {
            Node::Constant(_) => true,
            Node::Input(input) => input.of_point().is_none(),
            Node::Texture { .. } => false,
            Node::Unary(_, a) => of_frame[a.index()],
            Node::Binary(_, a, b) => of_frame[a.index()] && of_frame[b.index()],
        };
        let folds = |of: NodeId| matches!(places[of.index()], Arg::Number(_));
        // Replace numbers by an unknown value: the operator's result is unknown even if its operands are numbers. Keep
        // other operands, because they take registers.
        let operand =
            |op: Op, of: NodeId| if reads_frame(op) && folds(of) { unknown } else { places[of.index()] };
        let is_constant = match *node {
            Node::Unary(op, a) => folds(a) && !reads_frame(op),
            Node::Binary(op, a, b) => folds(a) && folds(b) && !reads_frame(op),
            Node::Constant(_) => true,
            Node::Input(_) | Node::Texture { .. } => false,
        };
        // A frame's number that is not known yet needs no step. Thousands of such numbers would stay in registers after
        // their last use.
        if matches!(numbers, Numbers::Unknown) && of_frame[*index] && !is_constant {
            places[*index] = unknown;
            continue;
        }
        places[*index] = match *node {
            Node::Constant(number) => Arg::Number(number),
            Node::Input(input) if input.of_point().is_none() => Arg::Number(match numbers {
                Numbers::Of(frame) => frame.value(input),
                _ => TYPICAL,
            }),
            Node::Input(_) | Node::Texture { .. } => of_point(*node),
            Node::Unary(op, a) => program.push(op, operand(op, a), Arg::Number(0.0), frame),
            Node::Binary(op, a, b) => program.push(op, operand(op, a), operand(op, b), frame),
        };
    }
    places
}

#[cfg(test)]
mod reuse_tests;
#[cfg(test)]
mod tests;
