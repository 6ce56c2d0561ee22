//! Names in functions and blocks.

use super::super::origins::Stretch;
use super::super::symbol::Symbol;
use super::super::value::Value;

/// A name in a function or a block.
pub(super) struct Binding {
    pub symbol: Symbol,
    /// The binding of the same name that it hides, or [`NO_BINDING`].
    hidden: u32,
    value: Value,
    /// What took part in it, if it is a `let`.
    by: Stretch,
}

const NO_BINDING: u32 = u32::MAX;

/// The bindings that are open, the innermost last.
pub(super) struct Scope {
    pub bindings: Vec<Binding>,
    /// By symbol: its innermost binding.
    innermost: Vec<u32>,
    /// Where the bindings of the current function begin.
    pub frame: usize,
}

impl Scope {
    /// No bindings, for symbols below `names`.
    pub(super) fn new(names: usize) -> Self {
        Self { bindings: Vec::new(), innermost: vec![NO_BINDING; names], frame: 0 }
    }

    /// Binds a name until [`Scope::unbind`].
    pub(super) fn bind(&mut self, symbol: Symbol, value: Value) {
        self.bind_made(symbol, value, Stretch::default());
    }

    /// The same of a value in which something took part.
    pub(super) fn bind_made(&mut self, symbol: Symbol, value: Value, by: Stretch) {
        let Some(innermost) = self.innermost.get_mut(symbol.index()) else { return };
        let hidden = std::mem::replace(innermost, self.bindings.len() as u32);
        self.bindings.push(Binding { symbol, hidden, value, by });
    }

    /// Forgets all bindings from `mark` on.
    pub(super) fn unbind(&mut self, mark: usize) {
        while self.bindings.len() > mark {
            if let Some(binding) = self.bindings.pop()
                && let Some(innermost) = self.innermost.get_mut(binding.symbol.index())
            {
                *innermost = binding.hidden;
            }
        }
    }

    pub(super) fn local(&self, symbol: Symbol) -> Option<(Value, Stretch)> {
        let index = *self.innermost.get(symbol.index())? as usize;
        if index < self.frame {
            None
        } else {
            self.bindings.get(index).map(|binding| (binding.value, binding.by))
        }
    }
}
