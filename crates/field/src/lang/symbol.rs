//! Interning: represents names by numbers.

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
    text: String,
    ends: Vec<u32>,
    /// Open addressing with linear probing. The number of slots is a power of two. At most half of the slots are taken.
    table: Vec<Place>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Place {
    key: Key,
    /// The name's number plus 1; 0 for a free slot.
    number: u32,
}

impl Interner {
    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    pub(super) fn name(&self, symbol: Symbol) -> &str {
        let index = symbol.index();
        let start =
            index.checked_sub(1).and_then(|before| self.ends.get(before)).map_or(0, |&end| end as usize);
        let end = self.ends.get(index).map_or(start, |&end| end as usize);
        self.text.get(start..end).unwrap_or("")
    }

    pub(super) fn intern(&mut self, name: &str) -> Symbol {
        self.intern_with_key(name, Key::of(name.as_bytes()))
    }

    #[inline]
    pub(super) fn intern_with_key(&mut self, name: &str, key: Key) -> Symbol {
        match self.find(name, key) {
            Some(known) => known,
            None => self.add(name, key),
        }
    }

    fn add(&mut self, name: &str, key: Key) -> Symbol {
        self.text.push_str(name);
        self.ends.push(self.text.len() as u32);
        if self.table.len() < 2 * self.ends.len() {
            self.grow();
        }
        self.place(Place { key, number: self.ends.len() as u32 });
        Symbol(self.ends.len() as u32 - 1)
    }

    pub(super) fn get(&self, name: &str) -> Option<Symbol> {
        self.find(name, Key::of(name.as_bytes()))
    }

    #[inline]
    fn find(&self, name: &str, key: Key) -> Option<Symbol> {
        let mask = self.table.len().checked_sub(1)?;
        let mut slot = key.hash() & mask;
        loop {
            let place = self.table.get(slot)?;
            let symbol = Symbol(place.number.checked_sub(1)?);
            if place.key == key && (key.is_whole_name() || self.name(symbol) == name) {
                return Some(symbol);
            }
            slot = (slot + 1) & mask;
        }
    }

    fn place(&mut self, place: Place) {
        let mask = self.table.len() - 1;
        let mut slot = place.key.hash() & mask;
        while self.table[slot].number != 0 {
            slot = (slot + 1) & mask;
        }
        self.table[slot] = place;
    }

    fn grow(&mut self) {
        let size = (4 * self.ends.len()).next_power_of_two();
        let before = std::mem::replace(&mut self.table, vec![Place::default(); size]);
        for place in before {
            if place.number != 0 {
                self.place(place);
            }
        }
    }
}

/// The key of a name in the hash table: the name itself if it has at most [`Key::WHOLE_MAX`] bytes, else a digest.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Key(u64);

impl Key {
    /// Length of the longest name that fits into a key. The highest byte of the key is the length.
    const WHOLE_MAX: usize = 7;
    const DIGEST: u64 = 0xff << 56;

    pub(super) fn of(name: &[u8]) -> Self {
        Self::of_first(name, name.len())
    }

    /// Returns the key of the first `length` bytes of `text`. The text must have at least that many bytes.
    #[inline]
    pub(super) fn of_first(text: &[u8], length: usize) -> Self {
        if length > Self::WHOLE_MAX {
            return Self::digest(text.get(..length).unwrap_or(text));
        }
        let word = match text.first_chunk() {
            Some(eight) => u64::from_le_bytes(*eight) & ((1 << (8 * length)) - 1),
            None => text.iter().take(length).rev().fold(0, |word, &byte| word << 8 | u64::from(byte)),
        };
        Self(word | (length as u64) << 56)
    }

    fn digest(name: &[u8]) -> Self {
        let mut state = 0x9e37_79b9_7f4a_7c15_u64 ^ name.len() as u64;
        for chunk in name.chunks(8) {
            let word = match chunk.try_into() {
                Ok(eight) => u64::from_le_bytes(eight),
                Err(_) => chunk.iter().fold(0, |word, &byte| word << 8 | u64::from(byte)),
            };
            state = multiply_and_fold(state ^ word);
        }
        Self(state | Self::DIGEST)
    }

    fn is_whole_name(self) -> bool {
        self.0 < Self::DIGEST
    }

    #[inline]
    fn hash(self) -> usize {
        multiply_and_fold(self.0) as usize
    }
}

#[inline]
fn multiply_and_fold(word: u64) -> u64 {
    let product = u128::from(word) * 0xd6e8_feb8_6659_fd93_u128;
    product as u64 ^ (product >> 64) as u64
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
