//! Local names: parameters, loop variables and the lets of blocks.

use super::super::origins::Stretch;
use super::super::symbol::Symbol;
use super::super::value::{Composites, Value};

pub(super) struct Binding {
    pub symbol: Symbol,
    /// Index of the binding that this binding hides, or [`NO_BINDING`].
    hidden: u32,
    value: Value,
    /// For a `let`, the notes of the text that computes the value (see `lang::origins`); empty for other names.
    by: Stretch,
}

const NO_BINDING: u32 = u32::MAX;

/// The current bindings, the innermost last.
pub(super) struct Scope {
    pub bindings: Vec<Binding>,
    /// For each symbol, the index of its innermost binding, or [`NO_BINDING`].
    innermost: Vec<u32>,
    /// Index of the current function's first binding.
    pub frame: usize,
    /// The next block is a function's body, which may also change the function's parameters.
    pub enters_body: bool,
    pub composites: Composites,
}

impl Scope {
    pub(super) fn new(names: usize) -> Self {
        Self {
            bindings: Vec::new(),
            innermost: vec![NO_BINDING; names],
            frame: 0,
            enters_body: false,
            composites: Composites::default(),
        }
    }

    pub(super) fn bind(&mut self, symbol: Symbol, value: Value) {
        self.bind_made(symbol, value, Stretch::default());
    }

    pub(super) fn bind_made(&mut self, symbol: Symbol, value: Value, by: Stretch) {
        let Some(innermost) = self.innermost.get_mut(symbol.index()) else { return };
        let hidden = std::mem::replace(innermost, self.bindings.len() as u32);
        self.bindings.push(Binding { symbol, hidden, value, by });
    }

    pub(super) fn unbind(&mut self, mark: usize) {
        while self.bindings.len() > mark {
            if let Some(binding) = self.bindings.pop()
                && let Some(innermost) = self.innermost.get_mut(binding.symbol.index())
            {
                *innermost = binding.hidden;
            }
        }
    }

    /// Changes the value of a name. Returns false if the innermost binding of the name precedes `floor`.
    pub(super) fn assign(&mut self, floor: usize, symbol: Symbol, value: Value, by: Stretch) -> bool {
        let Some(&index) = self.innermost.get(symbol.index()) else { return false };
        let own = index as usize >= floor;
        let Some(binding) = self.bindings.get_mut(index as usize).filter(|_| own) else { return false };
        (binding.value, binding.by) = (value, by);
        true
    }

    /// The values of the bindings from `floor` on.
    pub(super) fn values(&self, floor: usize) -> Vec<Value> {
        self.bindings.iter().skip(floor).map(|binding| binding.value).collect()
    }

    pub(super) fn put_back(&mut self, floor: usize, values: &[Value]) {
        for (binding, value) in self.bindings.iter_mut().skip(floor).zip(values) {
            binding.value = *value;
        }
    }

    /// Changes the values at which `before` and `after` differ, and notes the text that computes them.
    pub(super) fn change(&mut self, floor: usize, before: &[Value], after: &[Value], by: Stretch) {
        let changed = self.bindings.iter_mut().skip(floor).zip(before.iter().zip(after));
        for (binding, (before, after)) in changed {
            binding.value = *after;
            if before != after {
                binding.by = by;
            }
        }
    }

    /// Returns the value and notes of a name, if the current function or block binds it.
    pub(super) fn local(&self, symbol: Symbol) -> Option<(Value, Stretch)> {
        let index = *self.innermost.get(symbol.index())? as usize;
        let binding = self.bindings.get(index).filter(|_| index >= self.frame)?;
        Some((binding.value, binding.by))
    }
}
