//! Names as numbers.

/// A name: equal names of one [`Interner`] are equal symbols.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Symbol(pub u32);

impl Symbol {
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Gives equal names equal numbers, counted from 0; continues the numbers of `base`, whose names it knows.
#[derive(Debug, Default)]
pub(super) struct Interner {
    base: Option<&'static Interner>,
    text: String,
    /// Where each name ends in `text`.
    ends: Vec<u32>,
    /// Open addressing with linear probing: the hash, and 0 if free, else the own number plus 1. A power of two, at most
    /// half full.
    table: Vec<(u32, u32)>,
}

impl Interner {
    pub fn extending(base: Option<&'static Interner>) -> Self {
        Self { base, ..Self::default() }
    }

    fn offset(&self) -> usize {
        self.base.map_or(0, Self::len)
    }

    /// How many names are known.
    pub fn len(&self) -> usize {
        self.offset() + self.ends.len()
    }

    pub fn name(&self, symbol: Symbol) -> &str {
        match self.base {
            Some(base) if symbol.index() < base.len() => base.name(symbol),
            _ => self.own_name(symbol.index().wrapping_sub(self.offset())),
        }
    }

    fn own_range(&self, index: usize) -> std::ops::Range<usize> {
        let start =
            index.checked_sub(1).and_then(|before| self.ends.get(before)).map_or(0, |&end| end as usize);
        start..self.ends.get(index).map_or(start, |&end| end as usize)
    }

    fn own_name(&self, index: usize) -> &str {
        self.text.get(self.own_range(index)).unwrap_or("")
    }

    fn own_bytes(&self, index: usize) -> &[u8] {
        self.text.as_bytes().get(self.own_range(index)).unwrap_or(&[])
    }

    pub fn intern(&mut self, name: &str) -> Symbol {
        let hash = hash(name);
        if let Some(found) = self.base.and_then(|base| base.find(name, hash)) {
            return found;
        }
        if let Some(found) = self.find(name, hash) {
            return found;
        }
        self.text.push_str(name);
        self.ends.push(self.text.len() as u32);
        if self.table.len() < 2 * (self.ends.len() + 1) {
            self.grow();
        }
        self.place(hash, self.ends.len() as u32);
        Symbol((self.len() - 1) as u32)
    }

    /// The symbol of a name that is known already.
    pub fn get(&self, name: &str) -> Option<Symbol> {
        let hash = hash(name);
        self.base.and_then(|base| base.find(name, hash)).or_else(|| self.find(name, hash))
    }

    fn find(&self, name: &str, hash: u32) -> Option<Symbol> {
        let mask = self.table.len().checked_sub(1)?;
        let mut slot = hash as usize & mask;
        loop {
            let &(known, number) = self.table.get(slot)?;
            let index = number.checked_sub(1)? as usize;
            if known == hash && self.own_bytes(index) == name.as_bytes() {
                return Some(Symbol((self.offset() + index) as u32));
            }
            slot = (slot + 1) & mask;
        }
    }

    fn place(&mut self, hash: u32, number: u32) {
        let mask = self.table.len() - 1;
        let mut slot = hash as usize & mask;
        while self.table[slot].1 != 0 {
            slot = (slot + 1) & mask;
        }
        self.table[slot] = (hash, number);
    }

    fn grow(&mut self) {
        let size = (4 * (self.ends.len() + 1)).next_power_of_two();
        let before = std::mem::replace(&mut self.table, vec![(0, 0); size]);
        for (hash, number) in before {
            if number != 0 {
                self.place(hash, number);
            }
        }
    }
}

/// Multiply and fold over eight bytes at a time.
fn hash(name: &str) -> u32 {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64 ^ name.len() as u64;
    for chunk in name.as_bytes().chunks(8) {
        let word = match chunk.try_into() {
            Ok(eight) => u64::from_le_bytes(eight),
            Err(_) => chunk.iter().fold(0, |word, &byte| word << 8 | u64::from(byte)),
        };
        let product = u128::from(state ^ word) * 0xd6e8_feb8_6659_fd93_u128;
        state = product as u64 ^ (product >> 64) as u64;
    }
    (state ^ state >> 32) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_names_are_equal_symbols_across_the_base() {
        let mut base = Interner::default();
        let (a, b) = (base.intern("sphere"), base.intern("box"));
        let base: &'static Interner = Box::leak(Box::new(base));
        let mut own = Interner::extending(Some(base));
        let names: Vec<String> = (0..500).map(|number| format!("name_{number}")).collect();
        let symbols: Vec<Symbol> = names.iter().map(|name| own.intern(name)).collect();
        assert_eq!((own.intern("sphere"), own.intern("box")), (a, b));
        for (name, &symbol) in names.iter().zip(&symbols) {
            assert_eq!(own.name(symbol), name);
            assert_eq!(own.get(name), Some(symbol));
        }
        assert_eq!(own.name(b), "box");
        assert_eq!(own.len(), 502);
        assert_eq!(own.get("unknown"), None);
    }
}
