//! The result of lowering an expression: up to four scalar nodes of the graph.

use super::ast::Type;
use super::symbol::Symbol;
use crate::graph::NodeId;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Vector {
    len: u8,
    /// The parts from `len` on are copies of the first part.
    parts: [NodeId; 4],
}

impl Vector {
    pub(super) fn scalar(part: NodeId) -> Self {
        Self { len: 1, parts: [part; 4] }
    }

    pub(super) fn of<const N: usize>(parts: [NodeId; N]) -> Option<Self> {
        Self::from_slice(&parts)
    }

    pub(super) fn from_slice(parts: &[NodeId]) -> Option<Self> {
        let first = *parts.first()?;
        let mut all = [first; 4];
        all.get_mut(..parts.len())?.copy_from_slice(parts);
        Some(Self { len: parts.len() as u8, parts: all })
    }

    pub(super) fn len(self) -> usize {
        usize::from(self.len)
    }

    pub(super) fn parts(&self) -> &[NodeId] {
        self.parts.get(..self.len()).unwrap_or(&self.parts)
    }

    pub(super) fn first(self) -> NodeId {
        self.parts[0]
    }

    /// Returns the part at `index`; every part of a scalar is the scalar itself.
    pub(super) fn part(self, index: usize) -> NodeId {
        match self.len {
            1 => self.parts[0],
            _ => self.parts.get(index).copied().unwrap_or(self.parts[0]),
        }
    }

    pub(super) fn map(self, mut change: impl FnMut(NodeId) -> NodeId) -> Self {
        let mut parts = self.parts;
        for part in parts.iter_mut().take(self.len()) {
            *part = change(*part);
        }
        for index in self.len()..4 {
            parts[index] = parts[0];
        }
        Self { len: self.len, parts }
    }

    /// Returns the vector with `len` parts. A scalar is repeated. `None` if the sizes do not fit.
    pub(super) fn widened(self, len: usize) -> Option<Self> {
        match self.len() {
            own if own == len => Some(self),
            1 if len <= 4 => Some(Self { len: len as u8, parts: self.parts }),
            _ => None,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Value {
    /// The value of an expression with a reported mistake, or of a function's unknown argument. It has every type.
    Unknown,
    Vector(Vector),
    /// 0 or 1.
    Bool(NodeId),
    Text(Symbol),
}

impl Value {
    pub(super) fn scalar(part: NodeId) -> Self {
        Self::Vector(Vector::scalar(part))
    }

    pub(super) fn type_of(self) -> Option<Type> {
        match self {
            Self::Unknown => None,
            Self::Vector(vector) => Some(match vector.len() {
                1 => Type::Number,
                2 => Type::Vec2,
                3 => Type::Vec3,
                _ => Type::Vec4,
            }),
            Self::Bool(_) => Some(Type::Bool),
            Self::Text(_) => Some(Type::Texture),
        }
    }

    pub(super) fn described(self) -> &'static str {
        self.type_of().map_or("a mistake", Type::described)
    }
}
