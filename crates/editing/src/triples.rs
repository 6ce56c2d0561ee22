//! Colours and positions: a `vec3` of three number literals.

use std::ops::Range;
use std::sync::LazyLock;

use mariana_field::lang::{Word, WordKind, section_fields};

use crate::buffer::Buffer;
use crate::colors::Colors;
use crate::numbers::Number;

/// Maximum number of lines to search upwards for the field to which a line belongs.
const LINES_ABOVE: usize = 24;
const DECIMALS: usize = 3;

/// The meaning of the three numbers, guessed from the text around them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TripleKind {
    /// The value of a colour field.
    Color,
    /// A position that is added, subtracted, or used directly.
    Place {
        /// True if the position is the negative of the numbers, as in `p + vec3(1, 2, 3)`.
        turned: bool,
    },
    /// A factor.
    Other,
}

/// A `vec3` of three number literals.
#[derive(Debug, Clone, PartialEq)]
pub struct Triple {
    /// Byte range of the whole call in the line.
    pub range: Range<usize>,
    /// Byte range of the word `vec3`.
    pub word: Range<usize>,
    /// The numbers.
    pub numbers: [Number; 3],
    /// The meaning of the numbers.
    pub kind: TripleKind,
}

impl Triple {
    /// The values of the numbers.
    pub fn values(&self) -> [f64; 3] {
        self.numbers.each_ref().map(|number| number.value)
    }
}

static COLORS: LazyLock<Vec<&'static str>> = LazyLock::new(|| {
    let fields = section_fields().flat_map(|(_, fields)| fields.iter());
    fields.filter(|field| field.is_color()).map(|field| field.name).collect()
});

/// Finds the calls of `vec3` in `line` whose arguments are number literals.
pub fn triples(buffer: &Buffer, colors: &mut Colors, line: usize) -> Vec<Triple> {
    let text = buffer.line(line);
    let words = colors.words(buffer, line);
    let found = |at: usize| words.get(at..).and_then(|rest| numbers_of(text, &words, rest));
    let mut triples = Vec::new();
    let mut at = 0;
    while at < words.len() {
        let Some((numbers, length)) = found(at) else {
            at += 1;
            continue;
        };
        let (Some(first), Some(last)) = (words.get(at), words.get(at + length - 1)) else { break };
        let is_color = match field_before(text, &words, at) {
            Some(name) => COLORS.contains(&name),
            None => field_above(buffer, colors, line).is_some_and(|name| COLORS.contains(&&*name)),
        };
        let kind = kind_of(is_color, text, &words, at, length);
        triples.push(Triple { range: first.start..last.end, word: first.start..first.end, numbers, kind });
        at += length;
    }
    triples
}

/// Formats one component of a colour or a position.
pub fn written_part(value: f64) -> String {
    let text = format!("{value:.DECIMALS$}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

fn word_text<'a>(text: &'a [u8], word: &Word) -> &'a [u8] {
    text.get(word.start..word.end).unwrap_or_default()
}

/// Reads the `vec3` call at the start of `rest`. Returns its numbers and its length in words.
fn numbers_of(text: &[u8], words: &[Word], rest: &[Word]) -> Option<([Number; 3], usize)> {
    let is = |at: usize, wanted: &[u8]| rest.get(at).is_some_and(|word| word_text(text, word) == wanted);
    if !is(0, b"vec3") {
        return None;
    }
    let mut at = 1;
    let mut numbers = Vec::with_capacity(3);
    for sign in [b"(", b",", b","] {
        if !is(at, sign) {
            return None;
        }
        at += 1 + usize::from(is(at + 1, b"-"));
        let word = rest.get(at).filter(|word| word.kind == WordKind::Number)?;
        numbers.push(Number::at(text, words, word.start)?);
        at += 1;
    }
    is(at, b")").then_some(())?;
    Some((numbers.try_into().ok()?, at + 1))
}

/// Returns the last field or name before the word at `at` that is followed by `=`.
fn field_before<'a>(text: &'a [u8], words: &[Word], at: usize) -> Option<&'a str> {
    let before = words.get(..at)?;
    let given = before.windows(2).rev().find_map(|pair| match pair {
        [name, sign] if word_text(text, sign) == b"=" => Some(name),
        _ => None,
    })?;
    std::str::from_utf8(word_text(text, given)).ok()
}

fn field_above(buffer: &Buffer, colors: &mut Colors, line: usize) -> Option<String> {
    (line.saturating_sub(LINES_ABOVE)..line).rev().find_map(|above| {
        let words = colors.words(buffer, above);
        field_before(buffer.line(above), &words, words.len()).map(str::to_owned)
    })
}

fn kind_of(is_color: bool, text: &[u8], words: &[Word], at: usize, length: usize) -> TripleKind {
    if is_color {
        return TripleKind::Color;
    }
    let of = |at: Option<usize>| at.and_then(|at| words.get(at)).map(|word| word_text(text, word));
    if matches!(of(Some(at + length)), Some(b"*" | b"/")) {
        return TripleKind::Other;
    }
    // `p - v` moves the origin to v, and `p + v` moves it to -v.
    match of(at.checked_sub(1)) {
        Some(b"*" | b"/") => TripleKind::Other,
        Some(b"+") => TripleKind::Place { turned: true },
        Some(b"-") => {
            let before = at.checked_sub(2).and_then(|at| words.get(at));
            let is_taken_away = before.is_some_and(|word| {
                word.kind != WordKind::Sign || matches!(word_text(text, word), b")" | b"}")
            });
            TripleKind::Place { turned: !is_taken_away }
        }
        _ => TripleKind::Place { turned: false },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str, line: usize) -> Vec<(String, TripleKind, [f64; 3])> {
        let buffer = Buffer::new(text.as_bytes().to_vec());
        let start = buffer.line_start(line);
        let found = triples(&buffer, &mut Colors::default(), line);
        let reported = |one: Triple| {
            let words = text[start + one.range.start..start + one.range.end].to_owned();
            assert_eq!(&text[start + one.word.start..start + one.word.end], "vec3");
            (words, one.kind, one.values())
        };
        found.into_iter().map(reported).collect()
    }

    #[test]
    fn fields_mark_colours_and_signs_mark_positions() {
        let text = "material m { color = mix(vec3(0.1, 0.2, .3), vec3(1,1,1), x) * 2  emission =\n  vec3(3, 2, 1) }\n\
                    object o { shape = sphere(p - vec3(1, -2, 3.5), 1) + box(p + vec3(1, 0, 0), 2 * vec3(1, 1, 1)) }\n\
                    camera { position = vec3(0, 2, -5)  target = -vec3(1, 2, 3) }";
        let place = |turned| TripleKind::Place { turned };
        assert_eq!(
            of(text, 0),
            [
                ("vec3(0.1, 0.2, .3)".to_owned(), TripleKind::Color, [0.1, 0.2, 0.3]),
                ("vec3(1,1,1)".to_owned(), TripleKind::Color, [1.0; 3])
            ]
        );
        assert_eq!(of(text, 1), [("vec3(3, 2, 1)".to_owned(), TripleKind::Color, [3.0, 2.0, 1.0])]);
        let kinds: Vec<_> = of(text, 2).into_iter().map(|(_, kind, values)| (kind, values)).collect();
        let wanted =
            [(place(false), [1.0, -2.0, 3.5]), (place(true), [1.0, 0.0, 0.0]), (TripleKind::Other, [1.0; 3])];
        assert_eq!(kinds, wanted);
        let kinds: Vec<_> = of(text, 3).into_iter().map(|(_, kind, _)| kind).collect();
        assert_eq!(kinds, [place(false), place(true)]);
    }

    #[test]
    fn a_vec3_of_other_expressions_is_ignored() {
        for text in
            ["vec3(1)", "vec3(1, 2)", "vec3(a, 1, 2)", "vec3(1, 2, 3", "vec3(1, 2 + 1, 3)", "vec2(1, 2, 3)"]
        {
            assert_eq!(of(text, 0), [], "{text}");
        }
    }

    #[test]
    fn components_have_no_superfluous_zeros() {
        let written = [0.5, 1.0, -0.0001, 12.34567, 0.0, -3.0].map(written_part);
        assert_eq!(written, ["0.5", "1", "0", "12.346", "0", "-3"]);
    }
}
