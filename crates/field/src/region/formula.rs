//! Expressions of which each frame makes programs: the frame's numbers are folded in.

use std::collections::BTreeSet;

use super::encode::{Encoder, REGISTERS_MAX, Texel};
use super::program::{Arg, PENUMBRA, Program};
use super::short_lives::ShortLives;
use crate::graph::{
    Compounds, FrameInputs, Graph, Input, Node, NodeId, Op, Properties, ShapeAtlas, TableData, Uses,
};

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

pub(super) enum Numbers<'a> {
    /// Numbers count as unknown, so that no decision depends on them.
    Unknown,
    /// Every number is replaced by [`TYPICAL`]: like the numbers of most frames, it allows no simplification.
    Typical,
    Of(&'a FrameInputs),
}

/// A number to which no simplification applies.
const TYPICAL: f32 = 0.618_034;

/// Expressions that share nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Formula {
    /// The nodes with their positions, operands first.
    nodes: Vec<(usize, Node)>,
    positions: usize,
    roots: Vec<usize>,
    /// The roots that each tape of the formula computes.
    pub(super) tapes: Vec<Vec<usize>>,
    /// Number of values of the point in the first registers.
    of_point: usize,
    /// Number of sampled textures. Textures have no coordinates here: they are sampled beforehand.
    textures: usize,
    reads: Reads,
}

/// The resources that an interpreter needs to run the tapes of all frames.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Needs {
    pub(crate) operators: BTreeSet<Op>,
    /// `None` if there are too few registers.
    pub(crate) registers: Option<usize>,
    pub(crate) steps: usize,
    /// An upper bound of the texels of the tapes.
    pub(crate) texels: usize,
}

impl Needs {
    pub(crate) const NONE: Self =
        Self { operators: BTreeSet::new(), registers: Some(0), steps: 0, texels: 0 };

    pub(crate) fn add(&mut self, other: &Self) {
        self.operators.extend(&other.operators);
        self.registers = self.registers.zip(other.registers).map(|(own, other)| own.max(other));
        self.steps += other.steps;
        self.texels += other.texels;
    }
}

impl Formula {
    /// Returns the roots of a graph. The first `of_point` registers hold inputs of the point; then come the samples of
    /// the first `textures` textures.
    pub fn new(graph: &Graph, roots: &[NodeId], of_point: usize, textures: usize) -> Self {
        Self {
            nodes: graph.order(roots).iter().map(|id| (id.index(), graph.node(*id))).collect(),
            positions: graph.len(),
            roots: roots.iter().map(|root| root.index()).collect(),
            tapes: vec![(0..roots.len()).collect()],
            of_point,
            textures,
            reads: Reads::of(graph, roots),
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.nodes.len()
    }

    pub(crate) fn key(&self, frame: &FrameInputs) -> RegionKey {
        self.reads.key(frame)
    }

    /// Returns the needs of the tapes. If values take too many registers, cheap nodes are repeated from now on.
    pub(crate) fn needs(&mut self) -> Needs {
        let needs = self.own_needs();
        if needs.registers.is_some() {
            return needs;
        }
        let lives = ShortLives::of(&self.nodes, self.positions);
        self.roots.iter_mut().for_each(|root| *root = lives.position(*root));
        (self.nodes, self.positions) = (lives.nodes, lives.positions);
        self.own_needs()
    }

    fn own_needs(&self) -> Needs {
        // Unknown numbers cannot be folded in, so this program has the operators and registers of the programs of all
        // frames. Only roots that become numbers may take further registers.
        let program = self.folded(&Numbers::Unknown, &FrameInputs::default());
        let mut encoder = Encoder::new(Compounds::NONE, REGISTERS_MAX);
        let runs = self.tapes.iter().all(|outputs| encoder.encode(&program, outputs).is_some());
        let outputs = self.tapes.iter().map(Vec::len).max().unwrap_or(0);
        let samples = self.nodes.iter().filter(|(_, node)| matches!(node, Node::Texture { .. })).count();
        Needs {
            operators: program.steps.iter().map(|step| step.op).collect(),
            registers: runs.then_some(encoder.registers.max(outputs)),
            steps: program.steps.len(),
            // A texel for each step, each sample, each output that is a number, and the end.
            texels: program.steps.len() + samples + outputs + 1,
        }
    }

    /// Encodes the first tape in a frame. The tape is empty if it needs too many registers.
    pub fn encode<'e>(&self, frame: &FrameInputs, encoder: &'e mut Encoder) -> &'e [Texel] {
        encoder.encode(&self.folded(&Numbers::Of(frame), frame), &self.tapes[0]).unwrap_or(&[[0; 4]])
    }

    /// Returns the program with the given numbers folded in. If the frame is unknown, its tables are unknown values.
    pub(super) fn folded(&self, numbers: &Numbers, frame: &FrameInputs) -> Program {
        let mut program = Program {
            inputs: self.of_point + 4 * self.textures,
            in_registers: self.of_point,
            steps: Vec::with_capacity(self.nodes.len()),
            roots: Vec::new(),
        };
        let unknown = Arg::Value(PENUMBRA);
        let reads_frame =
            |op: Op| !matches!(numbers, Numbers::Of(_)) && op.properties().has(Properties::READS_FRAME);
        let mut places = vec![Arg::Number(0.0); self.positions];
        let mut of_frame = vec![false; self.positions];
        for (index, node) in &self.nodes {
            of_frame[*index] = match *node {
                Node::Input(input) => input.of_point().is_none(),
                Node::Texture { .. } => false,
                node => node.operands().all(|operand| of_frame[operand.index()]),
            };
            let folds = |of: NodeId| matches!(places[of.index()], Arg::Number(_));
            // Replace numbers by an unknown value: the operator's result is unknown even if its operands are numbers.
            // Keep other operands, because they take registers.
            let operand =
                |op: Op, of: NodeId| if reads_frame(op) && folds(of) { unknown } else { places[of.index()] };
            let is_constant = match *node {
                Node::Unary(op, _) | Node::Binary(op, ..) => node.operands().all(folds) && !reads_frame(op),
                Node::Constant(_) => true,
                Node::Input(_) | Node::Texture { .. } => false,
            };
            // A frame's number that is not known yet needs no step. Thousands of such numbers would stay in registers
            // after their last use.
            if matches!(numbers, Numbers::Unknown) && of_frame[*index] && !is_constant {
                places[*index] = unknown;
                continue;
            }
            places[*index] = match *node {
                Node::Constant(number) => Arg::Number(number),
                Node::Input(input) => match (input.of_point(), numbers) {
                    (Some(place), _) if place < self.of_point => Arg::Value(place as u32),
                    // A distance does not depend on a normal.
                    (Some(_), _) => Arg::Number(0.0),
                    (None, Numbers::Of(frame)) => Arg::Number(frame.value(input)),
                    (None, _) => Arg::Number(TYPICAL),
                },
                Node::Texture { texture, channel, .. } if usize::from(texture) < self.textures => {
                    Arg::Value(self.of_point as u32 + 4 * u32::from(texture) + u32::from(channel))
                }
                Node::Texture { .. } => Arg::Number(0.0),
                Node::Unary(op, a) => program.push(op, operand(op, a), Arg::Number(0.0), frame),
                Node::Binary(op, a, b) => program.push(op, operand(op, a), operand(op, b), frame),
            };
        }
        program.roots = self.roots.iter().map(|root| places[*root]).collect();
        program
    }
}

/// Returns the compounds that save more than they cost in the first tapes of the formulas.
pub(crate) fn compounds_that_pay<'a>(formulas: impl IntoIterator<Item = &'a Formula>) -> Compounds {
    let frame = FrameInputs::default();
    let typical = |formula: &'a Formula| (formula.folded(&Numbers::Typical, &frame), &formula.tapes[0]);
    let programs: Vec<_> = formulas.into_iter().map(typical).collect();
    Compounds::that_pay(|compounds| {
        let mut uses = Uses::default();
        for (program, outputs) in &programs {
            let mut encoder = Encoder::new(compounds, REGISTERS_MAX);
            if encoder.encode(program, outputs).is_some() {
                encoder.count(&mut uses);
            }
        }
        uses
    })
}
