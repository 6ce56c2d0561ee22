//! The result of lowering an expression: up to four scalar nodes of the graph.

use super::ast::Type;
use super::symbol::{Interner, Symbol};
use crate::graph::NodeId;

/// The order of the fields and the four bytes of `size` let a processor copy a vector with two loads right after it was
/// written. With a smaller `size`, or with the tag of [`Value`] before the parts, each copy would take the time of an
/// addition to the graph.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub(super) struct Vector {
    /// The parts from `size` on are copies of the first part.
    parts: [NodeId; 4],
    size: Size,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
enum Size {
    One = 1,
    Two,
    Three,
    Four,
}

const _: () = assert!(std::mem::size_of::<Value>() == 20);

impl Vector {
    pub(super) fn scalar(part: NodeId) -> Self {
        Self { parts: [part; 4], size: Size::One }
    }

    #[inline]
    pub(super) fn from_slice(parts: &[NodeId]) -> Option<Self> {
        Some(match *parts {
            [a] => Self::scalar(a),
            [a, b] => Self { parts: [a, b, a, a], size: Size::Two },
            [a, b, c] => Self { parts: [a, b, c, a], size: Size::Three },
            [a, b, c, d] => Self { parts: [a, b, c, d], size: Size::Four },
            _ => return None,
        })
    }

    pub(super) fn len(self) -> usize {
        self.size as usize
    }

    pub(super) fn parts(&self) -> &[NodeId] {
        self.parts.get(..self.len()).unwrap_or(&self.parts)
    }

    pub(super) fn first(self) -> NodeId {
        self.parts[0]
    }

    /// Returns the part at `index`; every part of a scalar is the scalar itself.
    pub(super) fn part(self, index: usize) -> NodeId {
        match self.size {
            Size::One => self.parts[0],
            _ => self.parts.get(index).copied().unwrap_or(self.parts[0]),
        }
    }

    pub(super) fn map(self, mut change: impl FnMut(NodeId) -> NodeId) -> Self {
        self.zip(self, |part, _| change(part)).unwrap_or(self)
    }

    /// Combines the parts of two vectors, the first parts first. A scalar combines with every part of a vector. `None`
    /// if the sizes do not fit.
    #[inline]
    pub(super) fn zip(self, other: Self, mut f: impl FnMut(NodeId, NodeId) -> NodeId) -> Option<Self> {
        let size = match (self.size, other.size) {
            (Size::One, size) | (size, Size::One) => size,
            (own, size) if own == size => size,
            _ => return None,
        };
        let (a, b) = (self.parts, other.parts);
        let first = f(a[0], b[0]);
        let mut parts = [first; 4];
        if size != Size::One {
            parts[1] = f(a[1], b[1]);
        }
        if matches!(size, Size::Three | Size::Four) {
            parts[2] = f(a[2], b[2]);
        }
        if size == Size::Four {
            parts[3] = f(a[3], b[3]);
        }
        Some(Self { parts, size })
    }

    /// Returns the vector with `len` parts. A scalar is repeated. `None` if the sizes do not fit.
    pub(super) fn widened(self, len: usize) -> Option<Self> {
        let size = match len {
            1 => Size::One,
            2 => Size::Two,
            3 => Size::Three,
            4 => Size::Four,
            _ => return None,
        };
        match self.size {
            own if own == size => Some(self),
            Size::One => Some(Self { size, ..self }),
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
    /// The number of a matrix in [`Composites`].
    Matrix(u32),
    /// The number of a record in [`Composites`].
    Record(u32),
}

/// A square matrix of two or three columns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Matrix {
    /// The elements, column by column.
    pub(super) parts: Vec<NodeId>,
    /// The number of columns, and of rows.
    pub(super) size: u8,
}

impl Matrix {
    /// `None` unless there are four or nine elements.
    pub(super) fn of_parts(parts: Vec<NodeId>) -> Option<Self> {
        let size = match parts.len() {
            4 => 2,
            9 => 3,
            _ => return None,
        };
        Some(Self { parts, size })
    }
}

/// The matrices and records of all values, because a [`Value`] has room for a vector only.
#[derive(Debug, Default)]
pub(super) struct Composites {
    matrices: Vec<Matrix>,
    records: Vec<Vec<(Symbol, Value)>>,
}

impl Composites {
    pub(super) fn add_matrix(&mut self, matrix: Matrix) -> Value {
        self.matrices.push(matrix);
        Value::Matrix(self.matrices.len() as u32 - 1)
    }

    pub(super) fn matrix(&self, index: u32) -> Option<&Matrix> {
        self.matrices.get(index as usize)
    }

    pub(super) fn add_record(&mut self, fields: Vec<(Symbol, Value)>) -> Value {
        self.records.push(fields);
        Value::Record(self.records.len() as u32 - 1)
    }

    /// Returns the fields of a record; none for an unknown record.
    pub(super) fn record(&self, index: u32) -> &[(Symbol, Value)] {
        self.records.get(index as usize).map_or(&[], Vec::as_slice)
    }

    /// Names the fields of a record in a hint.
    pub(super) fn fields_in_words(&self, index: u32, names: &Interner) -> String {
        let fields = self.record(index).iter().map(|(name, _)| format!("`.{}`", names.name(*name)));
        let fields: Vec<String> = fields.collect();
        format!("a record is read by the names of its values: {}", fields.join(", "))
    }

    pub(super) fn type_of(&self, value: Value) -> Option<Type> {
        Some(match value {
            Value::Unknown | Value::Record(_) => return None,
            Value::Vector(vector) => match vector.len() {
                1 => Type::Number,
                2 => Type::Vec2,
                3 => Type::Vec3,
                _ => Type::Vec4,
            },
            Value::Bool(_) => Type::Bool,
            Value::Text(_) => Type::Texture,
            Value::Matrix(index) if self.matrix(index)?.size == 2 => Type::Mat2,
            Value::Matrix(_) => Type::Mat3,
        })
    }
}

impl Value {
    pub(super) fn scalar(part: NodeId) -> Self {
        Self::Vector(Vector::scalar(part))
    }

    /// Returns the vector of these parts; [`Value::Unknown`] unless there are one to four.
    #[inline]
    pub(super) fn of(parts: &[NodeId]) -> Self {
        Vector::from_slice(parts).map_or(Self::Unknown, Self::Vector)
    }

    pub(super) fn described(self) -> &'static str {
        match self {
            Self::Unknown => "a mistake",
            Self::Matrix(_) => "a matrix",
            Self::Record(_) => "a record",
            other => Composites::default().type_of(other).map_or("a mistake", Type::described),
        }
    }
}
