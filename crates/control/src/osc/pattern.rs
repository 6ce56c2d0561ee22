//! Address patterns of OSC 1.0: `?` matches one character, `*` any number, `[a-z]` one of a set, `[!a]` one outside a
//! set, `{one,two}` one of several words. No pattern character matches a slash. The matcher keeps a set of reachable
//! positions and never backtracks. Matching takes at most (number of parts) x (number of characters) steps.

use crate::limits::LIMITS;

/// A parsed address pattern.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    parts: Vec<Part>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum Part {
    /// A literal character.
    Is(char),
    /// Any character except a slash.
    Any,
    /// Any number of characters except slashes.
    Many,
    /// A character within (or, if `is_not`, outside) these inclusive ranges.
    OneOf { ranges: Vec<(char, char)>, is_not: bool },
    /// One of these words.
    Word(Vec<Vec<char>>),
}

/// True if an address contains pattern characters.
pub fn is_pattern(address: &str) -> bool {
    address.contains(['?', '*', '[', '{'])
}

impl Pattern {
    /// Parses a pattern. Returns `None` if the pattern is too long or has an unclosed bracket or brace.
    pub fn read(text: &str) -> Option<Self> {
        if text.len() > LIMITS.name_bytes_max {
            return None;
        }
        let mut parts = Vec::new();
        let mut rest = text.chars();
        while let Some(sign) = rest.next() {
            parts.push(match sign {
                '?' => Part::Any,
                // Consecutive stars count as one.
                '*' if parts.last() == Some(&Part::Many) => continue,
                '*' => Part::Many,
                '[' => {
                    let (set, behind) = rest.as_str().split_once(']')?;
                    rest = behind.chars();
                    one_of(set)
                }
                '{' => {
                    let (words, behind) = rest.as_str().split_once('}')?;
                    rest = behind.chars();
                    Part::Word(words.split(',').map(|word| word.chars().collect()).collect())
                }
                sign => Part::Is(sign),
            });
        }
        Some(Self { parts })
    }

    /// True if the pattern matches the whole address.
    pub fn matches(&self, address: &str) -> bool {
        let text: Vec<char> = address.chars().collect();
        // The positions at which the parts so far can end.
        let mut ends = vec![false; text.len() + 1];
        if let Some(first) = ends.first_mut() {
            *first = true;
        }
        for part in &self.parts {
            ends = part.after(&ends, &text);
        }
        ends.last() == Some(&true)
    }
}

impl Part {
    /// Returns the possible end positions of this part for the given start positions.
    fn after(&self, begins: &[bool], text: &[char]) -> Vec<bool> {
        let mut ends = vec![false; begins.len()];
        let mut reach = |end: usize| {
            if let Some(place) = ends.get_mut(end) {
                *place = true;
            }
        };
        if *self == Self::Many {
            let mut goes_on = false;
            for (place, begins) in begins.iter().enumerate() {
                goes_on |= begins;
                if goes_on {
                    reach(place);
                }
                goes_on &= text.get(place) != Some(&'/');
            }
            return ends;
        }
        for place in begins.iter().enumerate().filter(|(_, begins)| **begins).map(|(place, _)| place) {
            let behind = text.get(place..).unwrap_or_default();
            match self {
                Self::Word(words) => {
                    let found = words.iter().filter(|word| behind.starts_with(word));
                    found.for_each(|word| reach(place + word.len()));
                }
                _ if behind.first().is_some_and(|next| self.is(*next)) => reach(place + 1),
                _ => {}
            }
        }
        ends
    }

    fn is(&self, character: char) -> bool {
        match self {
            Self::Is(this) => character == *this,
            Self::Any => character != '/',
            Self::OneOf { ranges, is_not } => {
                let is_in = ranges.iter().any(|(first, last)| (*first..=*last).contains(&character));
                character != '/' && is_in != *is_not
            }
            Self::Many | Self::Word(_) => false,
        }
    }
}

fn one_of(set: &str) -> Part {
    let (is_not, set) = set.strip_prefix('!').map_or((false, set), |set| (true, set));
    let signs: Vec<char> = set.chars().collect();
    let mut ranges = Vec::new();
    let mut rest = signs.as_slice();
    while let [first, behind @ ..] = rest {
        // A hyphen at the end is a literal character.
        (ranges, rest) = match behind {
            ['-', last, behind @ ..] => {
                ([ranges, vec![(*first.min(last), *first.max(last))]].concat(), behind)
            }
            _ => ([ranges, vec![(*first, *first)]].concat(), behind),
        };
    }
    Part::OneOf { ranges, is_not }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn matches(pattern: &str, address: &str) -> bool {
        Pattern::read(pattern).unwrap().matches(address)
    }

    #[test]
    fn each_pattern_character_matches_as_specified() {
        for (pattern, fits, fits_not) in [
            ("/a?c", ["/abc", "/axc"], ["/ac", "/a/c"]),
            ("/param/*", ["/param/size", "/param/"], ["/param/a/b", "/params/x"]),
            ("/*/*", ["/a/b", "/param/size"], ["/a", "/a/b/c"]),
            ("/[a-c]x", ["/ax", "/cx"], ["/dx", "/x"]),
            ("/[c-a-]x", ["/bx", "/-x"], ["/dx", "//x"]),
            ("/[!a-c]x", ["/dx", "/-x"], ["/ax", "//x"]),
            ("/{next,previous}", ["/next", "/previous"], ["/nex", "/next,previous"]),
            ("/{a,ab}c*d", ["/abcd", "/acxxd"], ["/abd", "/abbcd"]),
            ("/b**nd", ["/band", "/bnd"], ["/bandx", "/b/nd"]),
            ("/größ?", ["/größe", "/größß"], ["/größ", "/grösse"]),
        ] {
            assert!(is_pattern(pattern));
            assert!(fits.iter().all(|address| matches(pattern, address)), "{pattern}");
            assert!(!fits_not.iter().any(|address| matches(pattern, address)), "{pattern}");
        }
    }

    #[test]
    fn unclosed_and_oversized_patterns_are_rejected() {
        for broken in ["/[a", "/{a,b", "/a[", &"*?".repeat(LIMITS.name_bytes_max / 2 + 1)] {
            assert_eq!(Pattern::read(broken), None, "{broken}");
        }
        assert!(Pattern::read(&"*?".repeat(LIMITS.name_bytes_max / 2)).is_some());
    }

    /// A pattern with exponential cost in a backtracking matcher.
    #[test]
    fn matching_never_backtracks() {
        let pattern = Pattern::read(&"*a".repeat(LIMITS.name_bytes_max / 2)).unwrap();
        assert!(!pattern.matches(&"a".repeat(LIMITS.name_bytes_max / 2 - 1)));
        assert!(pattern.matches(&"a".repeat(LIMITS.name_bytes_max)));
    }

    proptest! {
        #[test]
        fn an_address_without_pattern_characters_matches_itself(address in "[a-z/]{0,12}", other in "[a-z/]{0,12}") {
            prop_assert_eq!(matches(&address, &other), address == other);
        }

        #[test]
        fn any_pattern_matches_without_panic(pattern in "[a-c/?*\\[\\]{},!-]{0,24}", address in "[a-c/]{0,12}") {
            if let Some(pattern) = Pattern::read(&pattern) {
                let _ = pattern.matches(&address);
            }
        }
    }
}
