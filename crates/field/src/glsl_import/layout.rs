//! The parts of values: every value of GLSL is a list of scalars, in the order in which its type names them.

use std::collections::BTreeMap;

use naga::front::Typifier;
use naga::proc::ResolveContext;
use naga::{Expression, Function, Handle, Module, ScalarKind, Type, TypeInner};

use crate::graph::NodeId;

/// An expression of a function.
pub(super) type ExprId = Handle<Expression>;

/// One scalar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    /// A float, a condition (0 or 1), or a whole number that is not constant.
    Node(NodeId),
    Int(i32),
    Uint(u32),
    /// A global without a value, by its index.
    Unset(u32),
}

/// The type of an expression. For a pointer, the type of its target.
#[derive(Debug, Clone, Copy)]
pub(super) struct Info {
    pub kind: ScalarKind,
    /// Columns of a matrix; 0 for other values.
    pub columns: u8,
    /// Rows of a matrix; components of a vector; 0 for other values.
    pub rows: u8,
    /// Number of parts.
    pub len: u32,
    /// Number of elements that an index selects, and the parts of each.
    pub count: u32,
    pub stride: u32,
    /// The type of a struct.
    pub of: Option<Handle<Type>>,
}

/// Largest number of parts of one value.
pub(super) const PARTS_MAX: u32 = 1 << 16;

/// Returns the number of parts of a type; `None` if it is no value of numbers or has too many parts.
pub(super) fn size(module: &Module, of: Handle<Type>) -> Option<u32> {
    inner_size(module, &module.types.get_handle(of).ok()?.inner)
}

fn inner_size(module: &Module, inner: &TypeInner) -> Option<u32> {
    let parts = match inner {
        TypeInner::Scalar(_) => 1,
        TypeInner::Vector { size, .. } => *size as u32,
        TypeInner::Matrix { columns, rows, .. } => *columns as u32 * *rows as u32,
        TypeInner::Array { base, size: naga::ArraySize::Constant(count), .. } => {
            size(module, *base)?.checked_mul(count.get())?
        }
        TypeInner::Struct { members, .. } => {
            members.iter().try_fold(0_u32, |sum, member| sum.checked_add(size(module, member.ty)?))?
        }
        _ => return None,
    };
    (parts <= PARTS_MAX).then_some(parts)
}

fn info(module: &Module, inner: &TypeInner, of: Option<Handle<Type>>) -> Option<Info> {
    let plain = Info { kind: ScalarKind::Float, columns: 0, rows: 0, len: 0, count: 0, stride: 0, of };
    let len = |inner| inner_size(module, inner);
    Some(match inner {
        TypeInner::Scalar(scalar) => Info { kind: scalar.kind, len: 1, ..plain },
        TypeInner::Vector { size, scalar } => {
            let size = *size as u8;
            let len = u32::from(size);
            Info { kind: scalar.kind, rows: size, len, count: len, stride: 1, ..plain }
        }
        TypeInner::Matrix { columns, rows, scalar } => Info {
            kind: scalar.kind,
            columns: *columns as u8,
            rows: *rows as u8,
            len: len(inner)?,
            count: *columns as u32,
            stride: *rows as u32,
            ..plain
        },
        TypeInner::Array { base, size: naga::ArraySize::Constant(count), .. } => {
            Info { len: len(inner)?, count: count.get(), stride: size(module, *base)?, ..plain }
        }
        TypeInner::Struct { .. } => Info { len: len(inner)?, ..plain },
        TypeInner::Pointer { base, .. } => {
            info(module, &module.types.get_handle(*base).ok()?.inner, Some(*base))?
        }
        TypeInner::ValuePointer { size: None, scalar, .. } => Info { kind: scalar.kind, len: 1, ..plain },
        TypeInner::ValuePointer { size: Some(size), scalar, .. } => {
            info(module, &TypeInner::Vector { size: *size, scalar: *scalar }, None)?
        }
        _ => return None,
    })
}

/// Returns what is known about each expression of a function; `None` for expressions that are no values.
pub(super) fn infos(module: &Module, function: &Function) -> Vec<Option<Info>> {
    let mut typifier = Typifier::new();
    let context = ResolveContext::with_locals(module, &function.local_variables, &function.arguments);
    let mut list = Vec::with_capacity(function.expressions.len());
    for (handle, _) in function.expressions.iter() {
        if typifier.grow(handle, &function.expressions, &context).is_err() {
            // Expressions after this one may depend on it.
            list.resize(function.expressions.len(), None);
            break;
        }
        let of = match &typifier[handle] {
            naga::proc::TypeResolution::Handle(of) => Some(*of),
            naga::proc::TypeResolution::Value(_) => None,
        };
        list.push(info(module, typifier.get(handle, &module.types), of));
    }
    list
}

/// Offset and number of parts of a struct's member.
pub(super) fn member(module: &Module, of: Handle<Type>, index: u32) -> Option<(u32, u32)> {
    let TypeInner::Struct { members, .. } = &module.types.get_handle(of).ok()?.inner else { return None };
    let (member, before) = members.get(..=index as usize)?.split_last()?;
    let offset = before.iter().map(|member| size(module, member.ty)).sum::<Option<u32>>()?;
    Some((offset, size(module, member.ty)?))
}

// The values of variables on the path that is being executed, and how they came about.

/// The parts of all variables: globals first, then the locals of the calls that are open.
#[derive(Debug, Default)]
pub(super) struct Memory {
    pub parts: Vec<Part>,
    /// Changes: the slot and its earlier value.
    trail: Vec<(u32, Part)>,
}

impl Memory {
    /// The state now, for the methods that compare with it.
    pub(super) fn mark(&self) -> usize {
        self.trail.len()
    }

    pub(super) fn forget_changes(&mut self) {
        self.trail.clear();
    }

    pub(super) fn at(&self, slot: u32) -> Part {
        self.parts.get(slot as usize).copied().unwrap_or(Part::Int(0))
    }

    pub(super) fn read(&self, slots: std::ops::Range<usize>) -> Vec<Part> {
        self.parts.get(slots).unwrap_or_default().to_vec()
    }

    pub(super) fn store_part(&mut self, slot: u32, part: Part) {
        if let Some(place) = self.parts.get_mut(slot as usize)
            && *place != part
        {
            self.trail.push((slot, *place));
            *place = part;
        }
    }

    /// Restores the state at a mark.
    pub(super) fn undo(&mut self, mark: usize) {
        while self.trail.len() > mark {
            if let Some((slot, part)) = self.trail.pop()
                && let Some(place) = self.parts.get_mut(slot as usize)
            {
                *place = part;
            }
        }
    }

    /// The slots that changed since a mark, with their values at the mark.
    pub(super) fn changes(&self, mark: usize) -> BTreeMap<u32, Part> {
        let mut changes = BTreeMap::new();
        for (slot, part) in self.trail.get(mark..).unwrap_or_default() {
            if (*slot as usize) < self.parts.len() {
                changes.entry(*slot).or_insert(*part);
            }
        }
        changes
    }

    /// The slots that changed since a mark, with their values now. Restores the state at the mark.
    pub(super) fn rewind_changes(&mut self, mark: usize) -> BTreeMap<u32, Part> {
        let mut changes = self.changes(mark);
        for (slot, part) in &mut changes {
            *part = self.at(*slot);
        }
        self.undo(mark);
        changes
    }

    pub(super) fn apply(&mut self, changed: BTreeMap<u32, Part>) {
        for (slot, part) in changed {
            self.store_part(slot, part);
        }
    }

    /// Keeps one change of each slot since a mark.
    pub(super) fn compact(&mut self, mark: usize) {
        let changes = self.changes(mark);
        self.trail.truncate(mark);
        self.trail.extend(changes);
    }
}
