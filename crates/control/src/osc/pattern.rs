//! Patterns in addresses, as OSC 1.0 has them: `?` is a character, `*` any number of them, `[a-z]` one of these, `[!a]`
//! one that is none of these, `{one,two}` one of these words. None of them stands for a slash.
//!
//! A pattern takes no more steps than it has parts, for each character of what it is compared with: what has matched so far
//! is a set of places, so that no pattern makes it go back.

use crate::limits::LIMITS;

/// An address with such signs in it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    parts: Vec<Part>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum Part {
    /// This character.
    Is(char),
    /// A character.
    Any,
    /// Any number of characters.
    Many,
    /// One of these characters, each from its first to its last, or none of them.
    OneOf { ranges: Vec<(char, char)>, is_not: bool },
    /// One of these words.
    Word(Vec<Vec<char>>),
}

/// Whether an address has signs of patterns in it.
pub fn is_pattern(address: &str) -> bool {
    address.contains(['?', '*', '[', '{'])
}

impl Pattern {
    /// Reads a pattern; none if it is too long, or a bracket or a brace of it does not end.
    pub fn read(text: &str) -> Option<Self> {
        if text.len() > LIMITS.name_bytes_max {
            return None;
        }
        let mut parts = Vec::new();
        let mut rest = text.chars();
        while let Some(sign) = rest.next() {
            parts.push(match sign {
                '?' => Part::Any,
                // Two are one, and cost as much.
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

    /// Whether it is a pattern of an address.
    pub fn matches(&self, address: &str) -> bool {
        let text: Vec<char> = address.chars().collect();
        // After which characters what was read so far may end.
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
    /// Where this part may end that begins at one of the places.
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

    /// Whether that is a character of it.
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

/// What stands between brackets.
fn one_of(set: &str) -> Part {
    let (is_not, set) = set.strip_prefix('!').map_or((false, set), |set| (true, set));
    let signs: Vec<char> = set.chars().collect();
    let mut ranges = Vec::new();
    let mut rest = signs.as_slice();
    while let [first, behind @ ..] = rest {
        // A hyphen at the end is one.
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
    fn each_sign_stands_for_what_it_says() {
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
    fn what_does_not_end_or_is_too_long_is_no_pattern() {
        for broken in ["/[a", "/{a,b", "/a[", &"*?".repeat(LIMITS.name_bytes_max / 2 + 1)] {
            assert_eq!(Pattern::read(broken), None, "{broken}");
        }
        assert!(Pattern::read(&"*?".repeat(LIMITS.name_bytes_max / 2)).is_some());
    }

    /// What takes others as many steps as there are ways to share out the characters.
    #[test]
    fn no_pattern_goes_back() {
        let pattern = Pattern::read(&"*a".repeat(LIMITS.name_bytes_max / 2)).unwrap();
        assert!(!pattern.matches(&"a".repeat(LIMITS.name_bytes_max / 2 - 1)));
        assert!(pattern.matches(&"a".repeat(LIMITS.name_bytes_max)));
    }

    proptest! {
        #[test]
        fn an_address_without_signs_is_a_pattern_of_itself(address in "[a-z/]{0,12}", other in "[a-z/]{0,12}") {
            prop_assert_eq!(matches(&address, &other), address == other);
        }

        #[test]
        fn no_text_is_too_bad(pattern in "[a-c/?*\\[\\]{},!-]{0,24}", address in "[a-c/]{0,12}") {
            if let Some(pattern) = Pattern::read(&pattern) {
                let _ = pattern.matches(&address);
            }
        }
    }
}
