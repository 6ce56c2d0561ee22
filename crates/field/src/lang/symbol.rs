//! Interning: represents names by numbers.

use std::collections::HashMap;
use std::sync::Arc;

/// An interned name. Equal names of one [`Interner`] are equal symbols.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Symbol(pub u32);

impl Symbol {
    pub(super) fn index(self) -> usize {
        self.0 as usize
    }
}

#[derive(Debug, Clone, Default)]
pub(super) struct Interner {
    names: Vec<Arc<str>>,
    symbols: HashMap<Arc<str>, Symbol>,
}

impl Interner {
    pub(super) fn len(&self) -> usize {
        self.names.len()
    }

    pub(super) fn name(&self, symbol: Symbol) -> &str {
        self.names.get(symbol.index()).map_or("", |name| name)
    }

    pub(super) fn get(&self, name: &str) -> Option<Symbol> {
        self.symbols.get(name).copied()
    }

    pub(super) fn intern(&mut self, name: &str) -> Symbol {
        if let Some(known) = self.get(name) {
            return known;
        }
        let (symbol, name) = (Symbol(self.names.len() as u32), Arc::<str>::from(name));
        self.names.push(Arc::clone(&name));
        self.symbols.insert(name, symbol);
        symbol
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_names_are_equal_symbols() {
        let mut base = Interner::default();
        let (a, b) = (base.intern("sphere"), base.intern("box"));
        let mut own = base.clone();
        let names = (0..500).map(|number| format!("{}{number}", ["n", "a_longer_name_"][number % 2]));
        let names: Vec<String> = names.collect();
        let symbols: Vec<Symbol> = names.iter().map(|name| own.intern(name)).collect();
        assert_eq!((own.intern("sphere"), own.intern("box")), (a, b));
        for (name, &symbol) in names.iter().zip(&symbols) {
            assert_eq!(own.name(symbol), name);
            assert_eq!(own.get(name), Some(symbol));
            assert_eq!(own.intern(name), symbol);
        }
        assert_eq!(own.name(b), "box");
        assert_eq!(own.len(), 502);
        assert_eq!(own.get("unknown"), None);
    }

    #[test]
    fn names_that_share_bytes_are_distinguished() {
        let names =
            ["", "a", "aa", "a\0", "\0", "sevenab", "eight_ab", "eight_abc", "eight_ab\0", "ä", "\u{7ff}é"];
        let mut own = Interner::default();
        let symbols = names.map(|name| own.intern(name));
        assert_eq!(own.len(), names.len());
        assert_eq!(names.map(|name| own.intern(name)), symbols);
    }
}
