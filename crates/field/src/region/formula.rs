//! Expressions of which each frame makes programs, with the frame's numbers folded in, and tapes that all frames share
//! except for their numbers.

use std::collections::BTreeSet;

use super::encode::{Encoder, REGISTERS_MAX, Texel};
use super::program::{Arg, MARK_SIGN, Program, mark, marked};
use super::short_lives::ShortLives;
use crate::graph::{
    Compounds, FrameInputs, Graph, InputsUsed, Node, NodeId, Op, Properties, SILENT, ShapeAtlas, TableData,
    Uses,
};
use crate::world::Hoisted;

/// The inputs that determine a tree or a shortened program. Equal keys give equal results.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionKey {
    numbers: Vec<u32>,
    tables: Vec<TableData>,
    shapes: Option<ShapeAtlas>,
}

impl RegionKey {
    /// Returns the values in a frame of the inputs that are used.
    pub(crate) fn of(used: &InputsUsed, frame: &FrameInputs) -> Self {
        let mut numbers: Vec<u32> = used.inputs.iter().map(|input| frame.value(*input).to_bits()).collect();
        let (mut tables, mut shapes) = (Vec::new(), None);
        for op in &used.tables {
            match op {
                Op::Shape | Op::ShapeNumber => shapes = Some(frame.shapes.clone()),
                Op::Part => numbers.extend(frame.parts.iter().map(|number| number.to_bits())),
                Op::Spectrum => tables.push(frame.spectrum.clone()),
                Op::Waveform => tables.push(frame.waveform.clone()),
                Op::History => tables.push(frame.history.clone()),
                op => {
                    let levels = op.level_list().map_or(&[][..], |list| frame.levels.of(list));
                    numbers.extend(levels.iter().map(|level| level.to_bits()));
                }
            }
        }
        Self { numbers, tables, shapes }
    }
}

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
    used: InputsUsed,
}

/// The resources that an interpreter needs to run the tapes of all frames.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Needs {
    pub(crate) operators: BTreeSet<Op>,
    /// `None` if there are too few registers.
    pub(crate) registers: Option<usize>,
    pub(crate) steps: usize,
}

impl Needs {
    pub(crate) const NONE: Self = Self { operators: BTreeSet::new(), registers: Some(0), steps: 0 };

    pub(crate) fn add(&mut self, other: &Self) {
        self.operators.extend(&other.operators);
        self.registers = self.registers.zip(other.registers).map(|(own, other)| own.max(other));
        self.steps += other.steps;
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
            used: graph.inputs_used(roots),
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.nodes.len()
    }

    pub(crate) fn key(&self, frame: &FrameInputs) -> RegionKey {
        RegionKey::of(&self.used, frame)
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
        // Marks allow no simplification, so this program has the operators and registers of the programs of all frames.
        let program = self.folded(None);
        let mut encoder = Encoder::new(Compounds::NONE, REGISTERS_MAX);
        let runs = self.tapes.iter().all(|outputs| encoder.encode(&program, outputs).is_some());
        Needs {
            operators: program.steps.iter().map(|step| step.op).collect(),
            registers: runs.then_some(encoder.registers),
            steps: program.steps.len(),
        }
    }

    /// Encodes the first tape for all frames. The tape is empty if it needs too many registers.
    pub fn tape(&self, encoder: &mut Encoder) -> FrameTape {
        let texels = encoder.encode(&self.folded(None), &self.tapes[0]).unwrap_or(&[[0; 4]]).to_vec();
        let mut graph = Graph::new();
        let mut moved = vec![NodeId::default(); self.positions];
        for (position, node) in &self.nodes {
            moved[*position] = graph.raw(node.with_operands(|id| moved[id.index()]));
        }
        // Each clause comes before its immediate.
        let words = texels.as_flattened().iter().enumerate().skip(1).step_by(2);
        let (places, roots): (Vec<usize>, Vec<NodeId>) = words
            .filter_map(|(place, word)| Some((place, *moved.get(marked(f32::from_bits(*word))?)?)))
            .unzip();
        let numbers = Hoisted::of(&graph, &roots);
        FrameTape { texels, outputs: encoder.outputs.clone(), places, numbers }
    }

    /// Returns the program with a frame's numbers folded in. Without a frame, every number that depends on the frame is
    /// a mark.
    pub(super) fn folded(&self, frame: Option<&FrameInputs>) -> Program {
        let mut program = Program {
            inputs: self.of_point + 4 * self.textures,
            in_registers: self.of_point,
            steps: Vec::with_capacity(self.nodes.len()),
            roots: Vec::new(),
        };
        let inputs = frame.unwrap_or(&SILENT);
        let mut places = vec![Arg::Number(0.0); self.positions];
        for (position, node) in &self.nodes {
            let place = |of: NodeId| places[of.index()];
            let depends_on_frame = |op: Op| {
                let is_number = |of: NodeId| matches!(place(of), Arg::Number(_));
                let is_mark =
                    |of: NodeId| matches!(place(of), Arg::Number(number) if marked(number).is_some());
                let reads_frame = op.properties().has(Properties::READS_FRAME);
                node.operands().all(is_number) && (reads_frame || node.operands().any(is_mark))
            };
            places[*position] = match *node {
                Node::Unary(op, _) | Node::Binary(op, ..) if frame.is_none() && depends_on_frame(op) => {
                    Arg::Number(mark(*position))
                }
                Node::Constant(number) => Arg::Number(number),
                Node::Input(input) => match input.of_point() {
                    Some(place) if place < self.of_point => Arg::Value(place as u32),
                    // A distance does not depend on a normal.
                    Some(_) => Arg::Number(0.0),
                    None => Arg::Number(frame.map_or(mark(*position), |frame| frame.value(input))),
                },
                Node::Texture { texture, channel, .. } if usize::from(texture) < self.textures => {
                    Arg::Value(self.of_point as u32 + 4 * u32::from(texture) + u32::from(channel))
                }
                Node::Texture { .. } => Arg::Number(0.0),
                Node::Unary(op, a) => program.push(op, place(a), Arg::Number(0.0), inputs),
                Node::Binary(op, a, b) => program.push(op, place(a), place(b), inputs),
            };
        }
        program.roots = self.roots.iter().map(|root| places[*root]).collect();
        program
    }
}

/// A tape that is the same in all frames, except for its numbers.
#[derive(Debug, Clone)]
pub struct FrameTape {
    texels: Vec<Texel>,
    /// The registers of the outputs.
    pub outputs: Vec<u8>,
    /// The words that are marks.
    places: Vec<usize>,
    /// The numbers of these marks.
    numbers: Hoisted,
}

impl FrameTape {
    /// Number of texels.
    #[expect(clippy::len_without_is_empty, reason = "a tape has an end")]
    pub fn len(&self) -> usize {
        self.texels.len()
    }

    /// Appends the tape with the numbers of a frame.
    pub fn append(&self, frame: &FrameInputs, texels: &mut Vec<Texel>) {
        let start = texels.len();
        texels.extend_from_slice(&self.texels);
        let words = texels.split_at_mut(start).1.as_flattened_mut();
        for (place, number) in self.places.iter().zip(self.numbers.at([0.0; 3], frame)) {
            words[*place] = number.to_bits() ^ (words[*place] & MARK_SIGN);
        }
    }
}

/// Returns the compounds that save more than they cost in the first tapes of the formulas.
pub(crate) fn compounds_that_pay<'a>(formulas: impl IntoIterator<Item = &'a Formula>) -> Compounds {
    let programs: Vec<_> =
        formulas.into_iter().map(|formula| (formula.folded(None), &formula.tapes[0])).collect();
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
