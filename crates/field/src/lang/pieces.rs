//! Splits a text into tokens and comments, with the blanks between them.

use super::diagnostic::{Diagnostics, columns};
use super::lexer;
use super::source::BYTE_ORDER_MARK;
use super::symbol::Interner;
use super::token::{Kind, RESERVED};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PieceKind {
    /// A token that is not a reserved word.
    Token(Kind),
    Reserved,
    /// A comment to the end of the line, or a `/*` that is never closed.
    LineComment,
    /// A comment between `/*` and `*/`.
    BlockComment,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Piece<'a> {
    pub kind: PieceKind,
    /// The first byte in the text.
    pub start: usize,
    pub text: &'a str,
    /// Line breaks between the previous piece and this piece.
    pub breaks: usize,
    /// Blanks between the previous piece and this piece; without meaning if there is a line break.
    pub blanks: usize,
    /// True for a token that begins a line for the parser: a line ends between the previous token and this token,
    /// perhaps in a comment.
    pub newline: bool,
    /// Column in the text, from 0.
    pub column: usize,
}

impl Piece<'_> {
    pub(super) fn is(&self, kind: Kind) -> bool {
        self.kind == PieceKind::Token(kind)
    }

    pub(super) fn is_word(&self, word: &str) -> bool {
        self.kind == PieceKind::Reserved && self.text == word
    }

    pub(super) fn is_comment(&self) -> bool {
        matches!(self.kind, PieceKind::LineComment | PieceKind::BlockComment)
    }

    /// True if an expression can end with this token.
    pub(super) fn ends_operand(&self) -> bool {
        match self.kind {
            PieceKind::Token(kind) => {
                matches!(kind, Kind::Number | Kind::Name | Kind::Text | Kind::CloseParen | Kind::CloseBrace)
            }
            PieceKind::Reserved => matches!(self.text, "true" | "false" | "break"),
            PieceKind::LineComment | PieceKind::BlockComment => false,
        }
    }
}

/// Returns the tokens and comments of a text. Mistakes are ignored here: compiling the text reports them.
pub(super) fn pieces(text: &str) -> Vec<Piece<'_>> {
    let (mut names, mut tokens, mut mistakes) = (Interner::default(), Vec::new(), Diagnostics::new(1));
    lexer::tokenize(text, 0, text.len(), &mut names, &mut tokens, &mut mistakes);
    let mut cutter = Cutter { text, at: 0, column: 0, pieces: Vec::with_capacity(tokens.len()) };
    for token in &tokens {
        let (start, end) = (token.span.start as usize, token.span.end as usize);
        cutter.comments(start);
        if token.kind != Kind::End {
            let reserved =
                token.kind == Kind::Name && text.get(start..end).is_some_and(|word| RESERVED.contains(&word));
            let kind = if reserved { PieceKind::Reserved } else { PieceKind::Token(token.kind) };
            cutter.cut(start, end, kind, token.newline);
        }
    }
    cutter.pieces
}

struct Cutter<'a> {
    text: &'a str,
    /// The end of the last piece, in bytes.
    at: usize,
    /// The column at the end of the last piece.
    column: usize,
    pieces: Vec<Piece<'a>>,
}

impl<'a> Cutter<'a> {
    /// Cuts the comments up to the token at the byte `to`.
    fn comments(&mut self, to: usize) {
        loop {
            let gap = self.text.get(self.at..to).unwrap_or_default();
            let blank = |letter: char| letter.is_whitespace() || letter == BYTE_ORDER_MARK;
            let rest = gap.trim_start_matches(blank);
            if rest.is_empty() {
                return;
            }
            let start = to - rest.len();
            let (length, kind) = match rest.strip_prefix("/*").and_then(|inner| inner.find("*/")) {
                Some(inner) => (inner + 4, PieceKind::BlockComment),
                None => {
                    let line = rest.split('\n').next().unwrap_or(rest);
                    (line.trim_end().len(), PieceKind::LineComment)
                }
            };
            self.cut(start, start + length.max(1), kind, false);
        }
    }

    fn cut(&mut self, start: usize, end: usize, kind: PieceKind, newline: bool) {
        let gap = self.text.get(self.at..start).unwrap_or_default();
        let text = self.text.get(start..end).unwrap_or_default();
        let (breaks, column) = match gap.rsplit_once('\n') {
            Some((before, behind)) => (1 + before.matches('\n').count(), width(behind)),
            None => (0, self.column + width(gap)),
        };
        let blanks = gap.chars().filter(|letter| matches!(letter, ' ' | '\t')).count();
        self.pieces.push(Piece { kind, start, text, breaks, blanks, newline, column });
        self.at = end;
        self.column = behind(column, text);
    }
}

/// Returns the column behind `text`, which begins in `column`.
pub(super) fn behind(column: usize, text: &str) -> usize {
    match text.rsplit_once('\n') {
        Some((_, last)) => width(last),
        None => column + width(text),
    }
}

pub(super) fn width(text: &str) -> usize {
    text.chars().filter(|letter| *letter != '\r').map(columns).sum()
}
