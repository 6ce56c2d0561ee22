//! Programs of materials and light, shortened for the places where they run.
//!
//! A program's own grid of 8x8x8 cells says which tape runs at a point or, for the sky, in a direction. The outermost
//! cells reach as far as anything is drawn, so every point has a cell. As in the tree of distances, intervals of a
//! frame's values decide what a cell does not need, and cells that need the same share a tape: first in 4x4x4 blocks,
//! then, by the shorter programs of these, in the cells. In its cell a shortened tape gives the same bits as the whole
//! one.

use std::collections::HashMap;

use super::encode::{Encoder, Texel};
use super::lanes::{CELLS, Lanes, bound};
use super::program::{Arg, Program, Structure};
use super::prune::{ChoiceTrace, Scratch};
use super::tree::{cells_of, place_in};
use super::{Numbers, fold};
use crate::graph::{Compounds, FrameInputs, Graph, GraphError, Input, Interval, Node, NodeId};

/// Cells of a grid along each axis.
pub(crate) const SIDE: usize = 8;
/// Values that exist before the first step: the point and the normal.
const OF_POINT: usize = Input::OF_POINT.len();
/// Nothing is drawn farther away than this.
const FARTHEST: f32 = 1e7;
/// Cells overlap by this share of their distance from the origin and their size, because shaders round differently.
const OVERLAP: f32 = 1e-5;
/// Components of normals and directions are at most this large, however they are rounded.
const NORMAL_MAX: f32 = 1.001;
/// What a texture gives lies between these numbers.
const SAMPLED: Interval = Interval { lo: 0.0, hi: 1.0 };
/// Programs up to this length are the same everywhere.
const WHOLE_MAX: usize = 24;
/// Blocks whose program has at most this share of the whole one's steps are not divided.
const UNDIVIDED_SHARE: f32 = 0.125;

/// What a program's grid divides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Over {
    /// Space.
    Points,
    /// The directions in which the sky is seen; the point is the origin.
    Directions,
}

/// A grid: the cell of a point, or of a direction, is the part of `(point - low) * scale` before the point, but at
/// least 0 and at most [`SIDE`] - 1 along each axis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Grid {
    pub(crate) low: [f32; 3],
    /// Cells per unit of length; 0 for a grid of one cell.
    pub(crate) scale: [f32; 3],
}

impl Grid {
    /// The grid whose cells would be as large as each other if the outermost did not reach farther than the box.
    pub(crate) fn of_box(low: [f32; 3], high: [f32; 3]) -> Self {
        let size = |axis: usize| (high[axis] - low[axis]).max(1e-3);
        Self { low, scale: std::array::from_fn(|axis| SIDE as f32 / size(axis)) }
    }

    /// The number of a point's cell.
    pub(crate) fn cell_of(&self, point: [f32; 3]) -> usize {
        (0..3).rev().fold(0, |cell, axis| {
            let place = (point[axis] - self.low[axis]) * self.scale[axis];
            cell * SIDE + place.clamp(0.0, (SIDE - 1) as f32) as usize
        })
    }

    /// What the cells `first..end` along an axis span, and a little more.
    fn span(&self, axis: usize, first: usize, end: usize, farthest: f32) -> Interval {
        let face = |number: usize| self.low[axis] + number as f32 / self.scale[axis];
        let around = OVERLAP * face(0).abs().max(face(SIDE).abs()).max(face(SIDE) - face(0));
        Interval {
            lo: if first == 0 { -farthest } else { face(first) - around },
            hi: if end == SIDE { farthest } else { face(end) + around },
        }
    }
}

/// A program that can be shortened.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SurfacePlan {
    nodes: Vec<(usize, Node)>,
    graph_nodes: usize,
    roots: Vec<usize>,
    textures: usize,
    over: Over,
}

/// A shortened tape.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ShortTape {
    /// The registers of the results.
    pub(crate) outputs: Vec<u8>,
    /// The clauses, with END.
    pub(crate) texels: Vec<Texel>,
    /// Whether it reads any texture.
    pub(crate) samples: bool,
}

/// The tapes of a program in a frame.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct ShortTapes {
    pub(crate) grid: Grid,
    /// The tape of each cell; `None` where the whole one runs. Empty if that is so everywhere.
    pub(crate) cells: Vec<Option<usize>>,
    pub(crate) tapes: Vec<ShortTape>,
}

impl SurfacePlan {
    /// The plan of a graph's roots, where textures have no coordinates: they are sampled before.
    ///
    /// # Errors
    /// Those of [`Graph::check`].
    pub(crate) fn new(graph: &Graph, roots: &[NodeId], textures: usize, over: Over) -> Result<Self, GraphError> {
        let order = graph.order(roots)?;
        Ok(Self {
            nodes: order.nodes.iter().map(|id| (id.index(), graph.node(*id))).collect(),
            graph_nodes: graph.len(),
            roots: roots.iter().map(|root| root.index()).collect(),
            textures,
            over,
        })
    }

    /// The program with a frame's numbers.
    fn folded(&self, frame: &FrameInputs) -> Program {
        let mut program = Program {
            inputs: OF_POINT + 4 * self.textures,
            in_registers: OF_POINT,
            steps: Vec::with_capacity(self.nodes.len()),
            roots: Vec::new(),
        };
        let of_point = |node: Node| match node {
            Node::Input(input) => input.of_point().map_or(Arg::Number(0.0), |place| Arg::Value(place as u32)),
            Node::Texture { texture, channel, .. } => {
                Arg::Value(OF_POINT as u32 + 4 * u32::from(texture) + u32::from(channel))
            }
            _ => Arg::Number(0.0),
        };
        let nodes = (&self.nodes[..], self.graph_nodes);
        let places = fold(&mut program, nodes, (&Numbers::Of(frame), frame), of_point);
        program.roots = self.roots.iter().map(|root| places[*root]).collect();
        program
    }
}

/// Shortens the programs of a frame, one after the other.
#[derive(Debug)]
pub(crate) struct Shortener<'a> {
    frame: &'a FrameInputs,
    /// The grid over space.
    grid: Grid,
    /// Most registers of a tape.
    registers: usize,
    /// Texels there is room for.
    pub(crate) room: usize,
    encoder: Encoder,
    rows: Vec<Lanes>,
    decisions: ChoiceTrace,
    scratch: Scratch,
    structure: Structure,
    of_block: Program,
    of_cell: Program,
    /// Passes, each of which bounded a program's values in 64 cells.
    pub(crate) passes: usize,
}

impl<'a> Shortener<'a> {
    /// For an interpreter with these compounds and so many registers.
    pub(crate) fn new(
        frame: &'a FrameInputs,
        grid: Grid,
        (compounds, registers): (Compounds, usize),
        room: usize,
    ) -> Self {
        Self {
            frame,
            grid,
            registers,
            room,
            encoder: Encoder::new(compounds, registers),
            rows: Vec::new(),
            decisions: ChoiceTrace::default(),
            scratch: Scratch::default(),
            structure: Structure::default(),
            of_block: Program::default(),
            of_cell: Program::default(),
            passes: 0,
        }
    }

    /// The tapes of a program whose whole tape has `whole` texels.
    pub(crate) fn shorten(&mut self, plan: &SurfacePlan, whole: usize) -> ShortTapes {
        let program = plan.folded(self.frame);
        let grid = match plan.over {
            Over::Points => self.grid,
            Over::Directions => Grid::of_box([-1.0; 3], [1.0; 3]),
        };
        let mut short = ShortTapes { grid, ..ShortTapes::default() };
        if program.steps.len() <= WHOLE_MAX {
            return short;
        }
        let mut known = HashMap::new();
        short.cells.resize(SIDE.pow(3), None);
        let blocks: [[usize; 3]; CELLS] = std::array::from_fn(|block| place_in(block).map(|along| 2 * along));
        let mut groups = Vec::new();
        self.decide(&program, plan, grid, (&blocks, 2), &mut groups);
        let decisions = std::mem::take(&mut self.decisions);
        let rows = std::mem::take(&mut self.rows);
        let mut inner = Vec::new();
        for group in groups {
            let mut of_block = std::mem::take(&mut self.of_block);
            decisions.shortened(&program, &rows, (group, true), self.frame, &mut self.scratch, &mut of_block);
            let blocks: Vec<[usize; 3]> = cells_of(group).map(|block| blocks[block]).collect();
            if of_block.steps.len() as f32 <= UNDIVIDED_SHARE * program.steps.len() as f32 {
                let tape = self.tape(&of_block, whole, &mut known, &mut short.tapes);
                let cells = blocks.iter().flat_map(|block| children(*block));
                cells.for_each(|cell| short.cells[number_of(cell)] = tape);
            } else {
                for eight in blocks.chunks(8) {
                    let cells: Vec<[usize; 3]> = eight.iter().flat_map(|block| children(*block)).collect();
                    // Where there are fewer than eight blocks, the last cell is repeated.
                    let at = |lane: usize| cells.get(lane).or(cells.last()).copied().unwrap_or_default();
                    let lanes: [[usize; 3]; CELLS] = std::array::from_fn(at);
                    self.decide(&of_block, plan, grid, (&lanes, 1), &mut inner);
                    for group in &inner {
                        let mut of_cell = std::mem::take(&mut self.of_cell);
                        let (cells, frame) = ((*group, true), self.frame);
                        let scratch = &mut self.scratch;
                        self.decisions.shortened(&of_block, &self.rows, cells, frame, scratch, &mut of_cell);
                        let tape = self.tape(&of_cell, whole, &mut known, &mut short.tapes);
                        cells_of(*group).for_each(|lane| short.cells[number_of(lanes[lane])] = tape);
                        self.of_cell = of_cell;
                    }
                }
            }
            self.of_block = of_block;
        }
        (self.decisions, self.rows) = (decisions, rows);
        short
    }

    /// Bounds a program's values in 64 places that are `width` cells wide, decides what they need, and groups those that
    /// need the same.
    fn decide(
        &mut self,
        program: &Program,
        plan: &SurfacePlan,
        grid: Grid,
        (places, width): (&[[usize; 3]; CELLS], usize),
        groups: &mut Vec<u64>,
    ) {
        self.passes += 1;
        let nothing = Lanes::splat(Interval::point(0.0));
        self.rows.resize(self.rows.len().max(program.inputs), nothing);
        let (divided, other) = match plan.over {
            Over::Points => ((0, FARTHEST), (3, Interval { lo: -NORMAL_MAX, hi: NORMAL_MAX })),
            Over::Directions => ((3, NORMAL_MAX), (0, Interval::point(0.0))),
        };
        for axis in 0..3 {
            let row = &mut self.rows[divided.0 + axis];
            for (lane, place) in places.iter().enumerate() {
                let span = grid.span(axis, place[axis], place[axis] + width, divided.1);
                (row.lo[lane], row.hi[lane]) = (span.lo, span.hi);
            }
            self.rows[other.0 + axis] = Lanes::splat(other.1);
        }
        for row in &mut self.rows[OF_POINT..program.inputs] {
            *row = Lanes::splat(SAMPLED);
        }
        bound(program, &mut self.rows, self.frame);
        self.structure.look_at(program);
        self.decisions.decide_all(program, &self.structure, &self.rows);
        self.decisions.groups(&self.rows, &[u64::MAX], groups);
    }

    /// The number of a program's tape; `None` if the whole one is hardly longer or there is no room.
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
        self.encoder.registers = 0;
        let texels = self.encoder.encode(program, &outputs).map(<[Texel]>::to_vec);
        let fits = texels.ok().filter(|texels| {
            self.encoder.registers <= self.registers && texels.len() < whole && texels.len() <= self.room
        });
        let tape = fits.map(|texels| {
            self.room -= texels.len();
            tapes.push(ShortTape { outputs: self.encoder.outputs.clone(), texels, samples: self.encoder.samples() });
            tapes.len() - 1
        });
        known.insert(hash, tape);
        tape
    }
}

/// The number of a cell.
fn number_of([x, y, z]: [usize; 3]) -> usize {
    x + SIDE * (y + SIDE * z)
}

/// The eight cells of a block.
fn children(block: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..8).map(move |child| std::array::from_fn(|axis| block[axis] + (child >> axis & 1)))
}
