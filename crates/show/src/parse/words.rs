//! Splits the text of a show file into words, line by line.

use mariana_field::lang::Span;

/// A word, a number, a quoted text or a sign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Word<'a> {
    pub kind: Kind,
    /// Without quotes.
    pub text: &'a str,
    pub span: Span,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Name,
    Number,
    Quoted,
    Sign,
}

impl Word<'_> {
    /// Formats the word for messages.
    pub(super) fn shown(&self) -> String {
        match self.kind {
            Kind::Quoted => format!("\"{}\"", self.text),
            _ => format!("`{}`", self.text),
        }
    }
}

/// Returns the words of each line, without comments and empty lines.
pub(super) fn lines(text: &str) -> impl Iterator<Item = Vec<Word<'_>>> {
    let mut start = 0;
    let lines = text.split('\n').map(move |line| {
        let base = start;
        start += line.len() + 1;
        words(line, base)
    });
    lines.filter(|words| !words.is_empty())
}

fn words(line: &str, base: usize) -> Vec<Word<'_>> {
    let mut words = Vec::new();
    let mut rest = line;
    while let Some(first) = rest.chars().next() {
        let at = line.len() - rest.len();
        if first == '#' {
            break;
        }
        if first.is_whitespace() || (at == 0 && first == '\u{feff}') {
            rest = rest.get(first.len_utf8()..).unwrap_or("");
            continue;
        }
        let (kind, length) = match first {
            '"' => (Kind::Quoted, rest[1..].find('"').map_or(rest.trim_end().len(), |end| end + 2)),
            _ if first.is_ascii_digit() || first == '.' => {
                (Kind::Number, length_of(rest, |c, _| c.is_ascii_digit() || c == '.'))
            }
            _ if first.is_alphabetic() || first == '_' => {
                let goes_on = |c: char, next: Option<char>| {
                    // These signs join the parts of a file name.
                    c.is_alphanumeric()
                        || c == '_'
                        || (matches!(c, '-' | '.' | '/') && next.is_some_and(char::is_alphanumeric))
                };
                (Kind::Name, length_of(rest, goes_on))
            }
            '-' if rest.starts_with("->") => (Kind::Sign, 2),
            _ => (Kind::Sign, first.len_utf8()),
        };
        let (word, behind) = rest.split_at_checked(length).unwrap_or((rest, ""));
        let text = if kind == Kind::Quoted { word.trim_matches('"') } else { word };
        let span = Span::new((base + at) as u32, (base + at + word.len()) as u32);
        words.push(Word { kind, text, span });
        rest = behind;
    }
    words
}

/// Returns the length in bytes of the longest prefix for which `goes_on` is true. The arguments of `goes_on` are a
/// character and the character after it.
fn length_of(text: &str, goes_on: impl Fn(char, Option<char>) -> bool) -> usize {
    let mut characters = text.char_indices().peekable();
    while let Some((at, character)) = characters.next() {
        if !goes_on(character, characters.peek().map(|(_, next)| *next)) {
            return at;
        }
    }
    text.len()
}
