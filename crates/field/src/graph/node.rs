//! Nodes of the expression graph.

use super::op::Op;
use super::screen_input::ScreenInput;
use super::{Level, SoundInput};

/// Identifies a node of one [`super::Graph`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct NodeId(pub(super) u32);

impl NodeId {
    /// Position of the node in its graph. Operands precede the nodes that use them.
    pub const fn index(self) -> usize {
        self.0 as usize
    }

    /// Returns the node at a position. A position that exceeds 32 bits gives the last possible node.
    pub(crate) fn at(position: usize) -> Self {
        Self(u32::try_from(position).unwrap_or(u32::MAX))
    }
}

/// A number that an expression reads from outside the graph.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Input {
    /// Position, x.
    X,
    /// Position, y.
    Y,
    /// Position, z.
    Z,
    /// Surface normal, x; used in materials.
    NX,
    /// Surface normal, y.
    NY,
    /// Surface normal, z.
    NZ,
    /// Time in seconds.
    T,
    /// One of the numbers that describe the sound.
    Sound(SoundInput),
    /// One of the levels that scenes read by number, such as `band(3)`.
    Level(Level),
    /// Position of the eye, x.
    EyeX,
    /// Position of the eye, y.
    EyeY,
    /// Position of the eye, z.
    EyeZ,
    /// A number of the picture as a whole or of the pointer over it.
    Screen(ScreenInput),
    /// A parameter of the scene, by its number.
    Param(u16),
    /// A number with inertia, by its number ([`Motion`](super::Motion)).
    Motion(u16),
    /// A value that is computed once per frame from the inputs above (see [`World`](crate::world::World)).
    Hoisted(u16),
}

impl Input {
    /// The inputs that differ from point to point, in the order in which a tape reads them.
    pub const OF_POINT: [Input; 6] = [Input::X, Input::Y, Input::Z, Input::NX, Input::NY, Input::NZ];

    /// Index in [`Input::OF_POINT`]; `None` for inputs that are the same at all points of a frame.
    pub const fn of_point(self) -> Option<usize> {
        let code = self.code() as usize;
        if code < Self::OF_POINT.len() { Some(code) } else { None }
    }

    /// True if a scene may declare a value of the same name ([`SoundInput::may_be_hidden`]).
    pub const fn may_be_hidden(self) -> bool {
        matches!(self, Input::Sound(input) if input.may_be_hidden())
    }

    /// True for a number that the analysis of the whole song computes. Before, live analysis computes the tempo and the
    /// phase.
    pub fn comes_from_song(self) -> bool {
        match self {
            Input::Sound(input) => {
                input.is_of_song() || matches!(input, SoundInput::Tempo | SoundInput::Phase)
            }
            Input::Level(level) => level.in_list().0.comes_from_song(),
            _ => false,
        }
    }

    /// A number for each input. The inputs of the point begin with 0, in the order of [`Input::OF_POINT`].
    #[inline(always)]
    const fn code(self) -> u32 {
        match self {
            Input::X => 0,
            Input::Y => 1,
            Input::Z => 2,
            Input::NX => 3,
            Input::NY => 4,
            Input::NZ => 5,
            Input::T => 6,
            Input::EyeX => 7,
            Input::EyeY => 8,
            Input::EyeZ => 9,
            Input::Screen(input) => 0xA + input as u32,
            Input::Sound(input) => 0x10 + input as u32,
            Input::Level(level) => 0x100 | level.place() as u32,
            Input::Param(i) => 0x1_0000 | i as u32,
            Input::Hoisted(i) => 0x2_0000 | i as u32,
            Input::Motion(i) => 0x3_0000 | i as u32,
        }
    }
}

impl std::fmt::Display for Input {
    /// Returns the name as printed in a tape, such as `X`, `VOLUME.X` or `BAND(3)`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Input::EyeX => "EYE.X",
            Input::EyeY => "EYE.Y",
            Input::EyeZ => "EYE.Z",
            Input::Screen(input) => input.name(),
            Input::Sound(input) => return f.write_str(&input.name().to_uppercase()),
            Input::Level(level) => return f.write_str(&level.to_string().to_uppercase()),
            Input::Param(i) => return write!(f, "PARAM({i})"),
            Input::Hoisted(i) => return write!(f, "HOISTED({i})"),
            Input::Motion(i) => return write!(f, "MOTION({i})"),
            of_point_or_time => return write!(f, "{of_point_or_time:?}"),
        })
    }
}

/// A node: a number, or an operator on earlier nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Node {
    /// A constant. It is never -0, and all NaNs have the same bits.
    Constant(f32),
    /// An input.
    Input(Input),
    /// A one-operand operator.
    Unary(Op, NodeId),
    /// A two-operand operator.
    Binary(Op, NodeId, NodeId),
    /// One channel of a texture of the scene at the coordinates (u, v). The texture repeats beyond 0..1.
    Texture {
        /// The texture's number in the scene.
        texture: u16,
        /// 0 red, 1 green, 2 blue, 3 alpha.
        channel: u8,
        /// Horizontal coordinate.
        u: NodeId,
        /// Vertical coordinate.
        v: NodeId,
    },
}

impl Node {
    /// Three words that are equal if and only if the nodes are equal.
    #[inline(always)]
    pub(super) const fn key(self) -> [u32; 3] {
        match self {
            Node::Constant(value) => [0, value.to_bits(), 0],
            Node::Input(input) => [1, input.code(), 0],
            Node::Unary(op, a) => [op.number() as u32, a.0, 0],
            Node::Binary(op, a, b) => [op.number() as u32, a.0, b.0],
            Node::Texture { texture, channel, u, v } => {
                [(texture as u32) << 16 | (channel as u32) << 8 | 2, u.0, v.0]
            }
        }
    }

    /// True if the keys of both nodes are equal. Constants compare by their bits, so that NaN equals NaN.
    #[inline(always)]
    pub(super) fn is(self, other: Self) -> bool {
        match (self, other) {
            (Node::Constant(a), Node::Constant(b)) => a.to_bits() == b.to_bits(),
            _ => self == other,
        }
    }

    /// Returns the operands of this node, in order.
    #[inline(always)]
    pub fn operands(self) -> impl DoubleEndedIterator<Item = NodeId> {
        let (a, b) = match self {
            Node::Constant(_) | Node::Input(_) => (None, None),
            Node::Unary(_, a) => (Some(a), None),
            Node::Binary(_, a, b) => (Some(a), Some(b)),
            Node::Texture { u, v, .. } => (Some(u), Some(v)),
        };
        a.into_iter().chain(b)
    }

    /// Returns the node with other operands.
    #[inline(always)]
    pub(crate) fn with_operands(self, mut other: impl FnMut(NodeId) -> NodeId) -> Self {
        match self {
            Node::Constant(_) | Node::Input(_) => self,
            Node::Unary(op, a) => Node::Unary(op, other(a)),
            Node::Binary(op, a, b) => Node::Binary(op, other(a), other(b)),
            Node::Texture { texture, channel, u, v } => {
                Node::Texture { texture, channel, u: other(u), v: other(v) }
            }
        }
    }

    /// Returns the index in [`Input::OF_POINT`], or the largest number for all other nodes.
    pub(super) fn place_of_point(self) -> usize {
        match self {
            Node::Input(input) => input.of_point().unwrap_or(usize::MAX),
            _ => usize::MAX,
        }
    }

    /// Returns the value of a constant node; `None` for other nodes.
    #[inline(always)]
    pub const fn as_constant(self) -> Option<f32> {
        match self {
            Node::Constant(value) => Some(value),
            _ => None,
        }
    }
}
