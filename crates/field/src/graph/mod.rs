//! The expression graph. Nodes are scalars, and equal nodes are stored once.
//!
//! A [`Graph`] is an arena in which operands precede the nodes that use them. Building a node that already exists
//! returns the existing one (hash-consing), so that a common subexpression is computed once. Builders also fold
//! constants and apply algebra that is exact in floating point (`build.rs`). They never fail: a graph that has
//! reached its limit returns arbitrary nodes and remembers the error. [`Graph::check`] and all functions that read
//! the graph then return this error. All traversals are iterative.

mod build;
mod compound;
mod evaluate;
mod frame_inputs;
mod fuse;
mod gradient_interval;
mod interval;
mod levels;
pub(crate) mod matrices;
mod motion;
mod node;
mod numbers;
mod op;
mod order;
mod part;
mod rules;
mod screen_input;
mod shape_atlas;
mod slope_rules;
mod sound_input;
mod table;
mod table_extremes;
mod unit_input;

pub use build::{NoTerm, PRODUCT_EXPONENT_MAX, Pending, Term};
pub(crate) use compound::{Arg, Operation, Uses};
pub use compound::{Compound, Compounds, FIRST_COMPOUND};
pub use evaluate::Point;
pub(crate) use frame_inputs::SILENT;
pub use frame_inputs::{FrameInputs, OwnRanges, TextureReader};
pub use gradient_interval::{GradientInterval, Pieces};
pub use interval::{Interval, LIBRARY_ERROR};
pub use levels::{LEVEL_COUNT, Level, LevelList, Levels, levels_glsl};
pub(crate) use motion::MotionState;
pub use motion::{Motion, MotionKind};
pub use node::{Input, Node, NodeId};
pub use numbers::{CELL_HASH_GLSL, CELL_MAX, SMALLEST, TANH_MAX, cell_hash};
pub use op::{DualKernel, FIRST_BINARY, Kernel, Op, Properties};
pub use order::InputsUsed;
pub use part::{PartInput, PartNumber, SongPart};
pub use screen_input::{Screen, ScreenInput};
pub use shape_atlas::{
    AtlasShape, FRAME_SHAPES_MAX, SHAPE_COLUMNS, SHAPE_NUMBERS, SHAPE_ROWS_MAX, SHAPE_STEP, ShapeAtlas,
    ShapeGrid,
};
pub use sound_input::{SoundInput, SoundInputs};
pub use table::TableData;
pub use unit_input::{UnitInput, Wave};

#[cfg(test)]
mod slope_tests;
#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;

use crate::limits::{LIMITS, Limits};

/// An error that makes a graph unusable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum GraphError {
    /// The graph needs more distinct nodes than the limit.
    #[error(
        "the expression needs more than {0} distinct operations; make the scene smaller or repeat fewer parts"
    )]
    TooManyNodes(usize),
}

/// An arena of distinct scalar nodes.
#[derive(Debug, Clone)]
pub struct Graph {
    nodes: Vec<Node>,
    /// A hash table (open addressing, at most half full, size a power of two; see [`Slots`]). A slot is 1 + a node's
    /// index; 0 if free.
    places: Vec<u32>,
    motions: Vec<Motion>,
    nodes_max: usize,
    full: bool,
}

impl Default for Graph {
    fn default() -> Self {
        Self::new()
    }
}

impl Graph {
    /// Returns an empty graph with the program's limits.
    pub fn new() -> Self {
        Self::with_limits(&LIMITS)
    }

    /// Returns an empty graph with the given limits.
    pub fn with_limits(limits: &Limits) -> Self {
        Self {
            nodes: Vec::new(),
            places: vec![0; 256],
            motions: Vec::new(),
            nodes_max: limits.graph_nodes_max.max(1),
            full: false,
        }
    }

    /// True if `other` has the same nodes and motions in the same order.
    pub fn is_same(&self, other: &Self) -> bool {
        self.nodes == other.nodes && self.motions == other.motions
    }

    /// Number of distinct nodes built so far, used or not.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// True if the graph has no nodes.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// True if a node becomes a clause of a tape. Constants and inputs do not.
    pub fn is_clause(&self, id: NodeId) -> bool {
        !matches!(self.node(id), Node::Constant(_) | Node::Input(_))
    }

    /// Returns the node with the given id, which must belong to this graph.
    #[inline(always)]
    pub fn node(&self, id: NodeId) -> Node {
        self.nodes[id.index()]
    }

    /// True if any node, used or not, reads the time, a number that describes the song, or a table of the sound. These
    /// inputs, and motions, may change even while the sound's features stay the same.
    pub fn moves_by_itself(&self) -> bool {
        self.nodes.iter().any(|node| match node {
            Node::Input(Input::T | Input::Motion(_)) => true,
            Node::Input(input) => input.comes_from_song(),
            Node::Unary(op, _) | Node::Binary(op, _, _) => {
                op.properties().has(op::Properties::READS_FRAME) && !Op::SHAPES.contains(op)
            }
            _ => false,
        })
    }

    /// True if any node, used or not, reads a number that the analysis of the whole song gives.
    pub fn reads_song(&self) -> bool {
        self.nodes.iter().any(|node| match node {
            Node::Input(input) => input.comes_from_song(),
            Node::Unary(op, _) => op.level_list().is_some_and(LevelList::comes_from_song),
            _ => false,
        })
    }

    /// True if any node, used or not, reads one of these tables, such as [`Op::CURVES`] or [`Op::PARTS`].
    pub fn reads(&self, tables: &[Op]) -> bool {
        self.nodes
            .iter()
            .any(|node| matches!(node, Node::Unary(op, _) | Node::Binary(op, ..) if tables.contains(op)))
    }

    /// Returns the value of a constant node.
    #[inline(always)]
    pub fn as_constant(&self, id: NodeId) -> Option<f32> {
        self.node(id).as_constant()
    }

    /// Checks that every requested node has been built.
    ///
    /// # Errors
    /// [`GraphError::TooManyNodes`] if a builder has reached the limit. Nodes that were returned after that are
    /// meaningless.
    pub fn check(&self) -> Result<(), GraphError> {
        if self.full { Err(GraphError::TooManyNodes(self.nodes_max)) } else { Ok(()) }
    }

    /// Reserves memory for `nodes` more nodes.
    pub fn reserve(&mut self, nodes: usize) {
        let nodes = (self.nodes.len() + nodes).min(self.nodes_max);
        self.nodes.reserve(nodes - self.nodes.len().min(nodes));
        if nodes * 2 > self.places.len() {
            self.grow((nodes * 2).next_power_of_two());
        }
    }

    // Inlined, so that the compiler removes the code for the kinds of nodes that a caller does not build.
    #[inline(always)]
    fn intern(&mut self, node: Node) -> NodeId {
        let mut slots = Slots::of(node, self.places.len());
        loop {
            match self.places[slots.slot] {
                0 => break,
                taken if self.nodes[taken as usize - 1].is(node) => return NodeId(taken - 1),
                _ => slots.advance(),
            }
        }
        self.push(node, slots.slot)
    }

    fn push(&mut self, node: Node, place: usize) -> NodeId {
        if self.nodes.len() >= self.nodes_max {
            self.full = true;
            return NodeId(0);
        }
        self.nodes.push(node);
        self.places[place] = self.nodes.len() as u32;
        if self.nodes.len() * 2 > self.places.len() {
            self.grow(self.places.len() * 4);
        }
        NodeId(self.nodes.len() as u32 - 1)
    }

    /// Rebuilds the hash table with `count` slots, a power of two.
    #[cold]
    fn grow(&mut self, count: usize) {
        let mut places = vec![0; count];
        for (index, node) in self.nodes.iter().enumerate() {
            let mut slots = Slots::of(*node, count);
            while places[slots.slot] != 0 {
                slots.advance();
            }
            places[slots.slot] = index as u32 + 1;
        }
        self.places = places;
    }
}

/// The slots of the hash table in which a node may be, in the order in which they are tried.
///
/// First come a few slots near twice the position of the node's newest operand. Most nodes are built soon after their
/// operands, so these slots are in the processor's cache even if the table is not. The others follow a hash, so that
/// many nodes with the same newest operand do not fill one part of the table.
struct Slots {
    slot: usize,
    hash: usize,
    near: usize,
    mask: usize,
}

impl Slots {
    /// Number of slots near the newest operand.
    const NEAR: usize = 8;

    #[inline(always)]
    fn of(node: Node, count: usize) -> Self {
        let (hash, mask) = (hash(node.key()) as usize, count - 1);
        let newest = match node {
            Node::Constant(_) | Node::Input(_) => return Self { slot: hash & mask, hash, near: 0, mask },
            Node::Unary(_, a) => a,
            Node::Binary(_, a, b) | Node::Texture { u: a, v: b, .. } => a.max(b),
        };
        Self { slot: (2 * newest.index()) & mask, hash, near: Self::NEAR, mask }
    }

    #[inline(always)]
    fn advance(&mut self) {
        let next = if self.near == 1 { self.hash } else { self.slot + 1 };
        self.near = self.near.saturating_sub(1);
        self.slot = next & self.mask;
    }
}

/// Hashes a node's key. Every bit of the key affects the low bits of the result.
#[inline(always)]
fn hash([head, a, b]: [u32; 3]) -> u32 {
    let operands = u64::from(a) | u64::from(b) << 32;
    let mixed = (operands ^ u64::from(head).wrapping_mul(0x9E37_79B9_7F4A_7C15)).wrapping_add(SEED);
    let product = u128::from(mixed) * 0xD6E8_FEB8_6659_FD93;
    let folded = product as u64 ^ (product >> 64) as u64;
    folded as u32 ^ (folded >> 32) as u32
}

/// Prevents a hash of 0 for small keys. Most keys are small.
const SEED: u64 = 0xA076_1D64_78BD_642F;
