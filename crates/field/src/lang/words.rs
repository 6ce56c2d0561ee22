//! Splits a line of a scene's text into words for syntax highlighting.
//!
//! The words come from the compiler's lexer. Each line is split separately, so that an editor needs only the visible
//! lines. Only a comment between `/*` and `*/` can continue on the next line.

use super::pieces::{Piece, PieceKind, pieces};
use super::token::Kind;
use super::{library, parser};

/// The kind of a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum WordKind {
    /// A number without its sign.
    Number,
    /// A reserved word, or a word that begins a part of a scene.
    Keyword,
    /// A function of the library.
    Function,
    /// An input, such as `p` or `volume`.
    Input,
    /// Any other name.
    Name,
    /// A text in quotes.
    Text,
    /// A comment.
    Comment,
    /// A sign or a bracket.
    Sign,
    /// Unknown characters.
    Unknown,
}

/// A word of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Word {
    /// The kind.
    pub kind: WordKind,
    /// The first byte in the line.
    pub start: usize,
    /// The byte after the last one.
    pub end: usize,
}

/// Returns the words of `line` in order, without blanks, and true if a comment is open at the end of the line.
/// `in_comment` is true if a comment is open at the start of the line.
pub fn words(line: &str, in_comment: bool) -> (Vec<Word>, bool) {
    let mut found = Vec::new();
    let mut begin = 0;
    if in_comment {
        let Some(end) = line.find("*/") else {
            found.push(Word { kind: WordKind::Comment, start: 0, end: line.len() });
            return (found, true);
        };
        begin = end + 2;
        found.push(Word { kind: WordKind::Comment, start: 0, end: begin });
    }
    let rest = line.get(begin..).unwrap_or_default();
    let pieces = pieces(rest);
    found.extend(pieces.iter().map(|piece| {
        let end =
            if piece.kind == PieceKind::LineComment { rest.len() } else { piece.start + piece.text.len() };
        Word { kind: kind_of(piece), start: begin + piece.start, end: begin + end }
    }));
    let is_open = |last: &Piece<'_>| last.kind == PieceKind::LineComment && last.text.starts_with("/*");
    (found, pieces.last().is_some_and(is_open))
}

fn kind_of(piece: &Piece<'_>) -> WordKind {
    match piece.kind {
        PieceKind::LineComment | PieceKind::BlockComment => WordKind::Comment,
        PieceKind::Reserved => WordKind::Keyword,
        PieceKind::Token(Kind::Number) => WordKind::Number,
        PieceKind::Token(Kind::Text) => WordKind::Text,
        // A text without its closing quote.
        PieceKind::Token(Kind::Unknown) if piece.text.starts_with('"') => WordKind::Text,
        PieceKind::Token(Kind::Unknown) => WordKind::Unknown,
        PieceKind::Token(Kind::Name) => kind_of_name(piece.text),
        PieceKind::Token(_) => WordKind::Sign,
    }
}

fn kind_of_name(name: &str) -> WordKind {
    let library = library::library();
    if parser::is_keyword(name) {
        return WordKind::Keyword;
    }
    let Some(symbol) = library.names.get(name) else { return WordKind::Name };
    if library::input(symbol).is_some() || library.parts.contains(&symbol) {
        WordKind::Input
    } else if library::builtin(symbol).is_some() || library::function(symbol).is_some() {
        WordKind::Function
    } else {
        WordKind::Name
    }
}

/// Returns the words that begin a part of a scene, and the reserved words.
pub fn keywords() -> impl Iterator<Item = &'static str> {
    parser::item_words().chain(reserved_words())
}

/// Returns the words that cannot be names.
pub fn reserved_words() -> impl Iterator<Item = &'static str> {
    super::token::RESERVED.iter().copied()
}

/// Returns the names of the types that a function's parameter can require.
pub fn type_names() -> impl Iterator<Item = &'static str> {
    super::ast::Type::ALL.iter().map(|one| one.name())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(line: &str, in_comment: bool) -> (Vec<(WordKind, &str)>, bool) {
        let (words, open) = words(line, in_comment);
        (words.into_iter().map(|word| (word.kind, &line[word.start..word.end])).collect(), open)
    }

    #[test]
    fn a_space_of_another_script_ended_a_comment_twice() {
        assert_eq!(seen("# a\u{a0}", false), (vec![(WordKind::Comment, "# a\u{a0}")], false));
        assert_eq!(seen("/* a\u{3000}", false), (vec![(WordKind::Comment, "/* a\u{3000}")], true));
    }

    #[test]
    fn every_kind_of_word_is_recognized() {
        use WordKind::{Comment, Function, Input, Keyword, Name, Number, Sign, Text, Unknown};
        let line = "let r = sphere(p, 1.5e2) # ball";
        let expected = [
            (Keyword, "let"),
            (Name, "r"),
            (Sign, "="),
            (Function, "sphere"),
            (Sign, "("),
            (Input, "p"),
            (Sign, ","),
            (Number, "1.5e2"),
            (Sign, ")"),
            (Comment, "# ball"),
        ];
        assert_eq!(seen(line, false), (expected.to_vec(), false));
        let found = seen("drums.beat", false).0;
        assert_eq!(found, [(Input, "drums"), (Sign, "."), (Input, "beat")]);
        assert_eq!(
            seen("include \"a b.scene\" $ max", false).0,
            [(Keyword, "include"), (Text, "\"a b.scene\""), (Unknown, "$"), (Function, "max")]
        );
    }

    #[test]
    fn comments_extend_over_lines_until_they_are_closed() {
        use WordKind::{Comment, Name, Number};
        assert_eq!(seen("a /* b */ c /* d", false).0.last(), Some(&(Comment, "/* d")));
        assert!(seen("a /* b */ c /* d", false).1);
        assert_eq!(seen("still", true), (vec![(Comment, "still")], true));
        assert_eq!(
            seen("end */ 5 // x", true),
            (vec![(Comment, "end */"), (Number, "5"), (Comment, "// x")], false)
        );
        assert_eq!(
            seen("/* a *//* b */q", false),
            (vec![(Comment, "/* a */"), (Comment, "/* b */"), (Name, "q")], false)
        );
        assert_eq!(seen("", false), (vec![], false));
        assert_eq!(seen("# /* not open", false), (vec![(Comment, "# /* not open")], false));
    }
}
