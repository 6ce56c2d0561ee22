//! The levels of the sound that scenes read by number, such as `band(i)`: one row for each list. A row gives the list's
//! name, length, range and description for the language, tapes, GLSL, bounds, and `--set`.
//!
//! A frame holds the levels of all lists one after the other. Each list has an operator that reads the level with a
//! computed number.

use super::interval::Interval;

macro_rules! level_lists {
    ($(
        $(#[doc = $doc:literal])+
        $list:ident, $name:literal, $count:literal of $what:literal, $least:literal..$most:literal, $reported:literal,
        $numbers:literal;
    )+) => {
        /// A list of levels that scenes read by number.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[repr(u8)]
        pub enum LevelList {
            $($(#[doc = $doc])+ $list,)+
        }

        const ROWS: &[Row] = &[$(Row {
            name: $name, count: $count, what: $what, range: ($least, $most), doc: $reported, numbers: $numbers,
        },)+];

        /// The number of levels in all lists together.
        pub const LEVEL_COUNT: usize = 0 $(+ $count)+;

        impl LevelList {
            /// All lists, in the order in which frames hold them.
            pub const ALL: [Self; ROWS.len()] = [$(Self::$list,)+];
        }
    };
}

struct Row {
    name: &'static str,
    count: u16,
    what: &'static str,
    range: (f32, f32),
    doc: &'static str,
    numbers: &'static str,
}

level_lists! {
    /// Frequency bands.
    Band, "band", 32 of "band", 0.0..1.0,
        "the level of one of the 32 frequency bands, low to high, 0..1",
        "there are 32 bands, 0 to 31, low to high";
    /// Notes.
    Note, "note", 88 of "note", 0.0..1.0,
        "the level of one of the 88 notes of a piano, 0 for A0 to 87 for C8, without the overtones of lower notes, 0..1",
        "there are 88 notes, 0 for A0 to 87 for C8; middle C is 39";
    /// Pitch classes.
    Chroma, "chroma", 12 of "pitch class", 0.0..1.0,
        "the level of pitch class i, 0..1 (i is 0 for C to 11 for B); in each beat of a song the strongest has level 1",
        "there are 12 pitch classes, 0 for C to 11 for B";
    /// The stereo position of each band.
    Pan, "pan", 32 of "band", -1.0..1.0,
        "where the sound of a band is: -1 left, 0 in the middle, 1 right",
        "there are 32 bands, 0 to 31, low to high";
    /// Difference between the channels in each band.
    Width, "width", 32 of "band", 0.0..1.0,
        "how much the channels differ in a band: 0 for equal channels, 1 for unrelated ones",
        "there are 32 bands, 0 to 31, low to high";
}

impl LevelList {
    const fn row(self) -> &'static Row {
        &ROWS[self as usize]
    }

    /// Returns the name of the function that reads the list in a scene.
    pub const fn name(self) -> &'static str {
        self.row().name
    }

    /// Number of levels in the list.
    pub const fn count(self) -> usize {
        self.row().count as usize
    }

    /// Returns what one level belongs to: a band, a note or a pitch class.
    pub const fn what(self) -> &'static str {
        self.row().what
    }

    /// Least and greatest level.
    pub const fn range(self) -> (f32, f32) {
        self.row().range
    }

    /// Returns the function's description, as printed in docs/language.md.
    pub const fn doc(self) -> &'static str {
        self.row().doc
    }

    /// Returns the hint for a number that does not exist.
    pub const fn numbers(self) -> &'static str {
        self.row().numbers
    }

    /// Position of the list's first level among the levels of all lists.
    pub const fn first(self) -> usize {
        let (mut first, mut list) = (0, 0);
        while list < self as usize {
            first += ROWS[list].count as usize;
            list += 1;
        }
        first
    }

    /// Returns the level with the given number; `None` if the list is shorter.
    pub const fn level(self, number: usize) -> Option<Level> {
        if number < self.count() { Some(Level((self.first() + number) as u8)) } else { None }
    }

    /// Returns the level with the number floor(`index`), clamped to the list; the first level for a NaN.
    pub fn nearest(self, index: f32) -> Level {
        Level((self.first() + (index.max(0.0) as usize).min(self.count() - 1)) as u8)
    }

    /// True for levels that the analysis of the whole song computes.
    pub const fn comes_from_song(self) -> bool {
        matches!(self, Self::Chroma)
    }

    /// Returns the list with that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|list| list.name() == name)
    }
}

const _: () = assert!(LEVEL_COUNT <= 1 << 8, "a level's place is a byte");

/// Returns the GLSL functions that the operators of the lists call. They read `frame_levels`, which has one level in
/// the x of each vec4, so that a computed index reads one number.
pub fn levels_glsl() -> String {
    let function = |list: LevelList| {
        let (name, first, last) = (list.name(), list.first(), list.count() - 1);
        format!(
            "float level_of_{name}(float i) {{ return frame_levels[{first} + int(i > 0.0 ? min(i, {last}.0) : 0.0)].x; }}\n"
        )
    };
    LevelList::ALL.into_iter().map(function).collect()
}

/// One level of a list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Level(u8);

impl Level {
    /// Place among the levels of all lists.
    pub const fn place(self) -> usize {
        self.0 as usize
    }

    /// Returns the level's list, and the level's number in the list.
    pub fn in_list(self) -> (LevelList, usize) {
        let list = LevelList::ALL.into_iter().rev().find(|list| list.first() <= self.place());
        let list = list.unwrap_or(LevelList::Band);
        (list, self.place() - list.first())
    }

    /// Least and greatest value.
    pub fn range(self) -> (f32, f32) {
        self.in_list().0.range()
    }
}

impl std::fmt::Display for Level {
    /// Writes the level as in a scene, for example `band(3)`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (list, number) = self.in_list();
        write!(f, "{}({number})", list.name())
    }
}

/// The values of all levels; all 0 by default.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Levels([f32; LEVEL_COUNT]);

impl Default for Levels {
    fn default() -> Self {
        Self::SILENCE
    }
}

impl Levels {
    /// Silence.
    pub const SILENCE: Self = Self([0.0; LEVEL_COUNT]);

    /// Returns a value for each level, computed by `value` and clamped to the level's range. A value that is not finite
    /// becomes 0.
    pub fn each(mut value: impl FnMut(LevelList, usize) -> f32) -> Self {
        let mut levels = Self::SILENCE;
        for list in LevelList::ALL {
            let (least, most) = list.range();
            for (number, level) in levels.of_mut(list).iter_mut().enumerate() {
                let value = value(list, number);
                *level = if value.is_finite() { value.clamp(least, most) } else { 0.0 };
            }
        }
        levels
    }

    /// Returns the values of one list.
    pub fn of(&self, list: LevelList) -> &[f32] {
        &self.0[list.first()..list.first() + list.count()]
    }

    /// Returns the values of one list for changing them.
    pub fn of_mut(&mut self, list: LevelList) -> &mut [f32] {
        &mut self.0[list.first()..list.first() + list.count()]
    }

    /// Returns the values of all lists.
    pub fn numbers(&self) -> &[f32] {
        &self.0
    }

    /// Returns bounds of the levels from `from` to `to`.
    pub(super) fn bounds(&self, from: Level, to: Level) -> Interval {
        self.0[from.place()..=to.place().max(from.place())]
            .iter()
            .map(|&level| Interval::point(level))
            .reduce(Interval::hull)
            .unwrap_or(Interval::ANY)
    }
}

impl std::ops::Index<Level> for Levels {
    type Output = f32;

    fn index(&self, level: Level) -> &f32 {
        &self.0[level.place()]
    }
}

impl std::ops::IndexMut<Level> for Levels {
    fn index_mut(&mut self, level: Level) -> &mut f32 {
        &mut self.0[level.place()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_level_belongs_to_one_list_and_is_within_its_range() {
        let mut place = 0;
        for list in LevelList::ALL {
            assert_eq!(LevelList::named(list.name()), Some(list), "two lists are called {}", list.name());
            assert_eq!(list.level(list.count()), None);
            assert_eq!([-1.0, f32::NAN, 1e9].map(|i| list.nearest(i).in_list().1), [0, 0, list.count() - 1]);
            for number in 0..list.count() {
                let level = list.level(number).unwrap();
                assert_eq!((level.place(), level.in_list()), (place, (list, number)));
                assert_eq!(level, list.nearest(number as f32 + 0.9));
                place += 1;
            }
        }
        assert_eq!(place, LEVEL_COUNT);
        let levels = Levels::each(|_, number| if number == 3 { f32::NAN } else { -5.0 });
        for list in LevelList::ALL {
            let least = list.range().0;
            assert_eq!((levels.of(list)[3], levels.of(list)[4]), (0.0, least), "{list:?}");
        }
    }
}
