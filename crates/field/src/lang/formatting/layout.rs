//! Arranges the pieces of each line: where the line begins, and the blanks between its pieces.

use super::super::pieces::{Piece, PieceKind};
use super::super::token::Kind;
use super::spacing::{Role, blanks, continues, role};

/// Where a line begins, relative to an earlier line with this index.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Start {
    /// At the left margin.
    Margin,
    /// Below the beginning of the line.
    Below(usize),
    /// One level deeper than the line.
    Inside(usize),
    /// At the author's place, moved as much as the line is moved.
    Behind(usize),
}

/// A line of the result.
#[derive(Debug, Clone)]
pub(super) struct Line {
    /// True if a blank line precedes this line.
    pub gap: bool,
    pub start: Start,
    /// The column of the line in the text.
    pub written_at: usize,
    /// The pieces before the `=` of [`Line::equals`]; without such a `=`, all pieces. Without indentation.
    pub head: String,
    /// The `=` of the first entry of the line.
    pub equals: Option<Tail>,
    /// A comment behind the tokens, to the end of the line.
    pub comment: Option<Tail>,
}

/// The rest of a line: a comment, or a `=` and the pieces behind it.
#[derive(Debug, Clone)]
pub(super) struct Tail {
    pub text: String,
    /// Blanks before the text.
    pub blanks: usize,
    /// The column in the scene's text.
    pub written_at: usize,
}

/// The inside of a bracket, or the top level.
#[derive(Clone, Copy)]
struct Frame {
    in_parens: bool,
    /// Where the `}` begins.
    closing: Start,
    /// Where items, fields, lets and results begin.
    inside: Start,
    /// The line in which the current statement begins.
    statement: usize,
}

pub(super) fn lines(pieces: &[Piece<'_>]) -> Vec<Line> {
    let top = Frame { in_parens: false, closing: Start::Margin, inside: Start::Margin, statement: 0 };
    let mut next = pieces.len();
    let mut next_token: Vec<usize> = Vec::with_capacity(pieces.len());
    for (index, piece) in pieces.iter().enumerate().rev() {
        next = if piece.is_comment() { next } else { index };
        next_token.push(next);
    }
    next_token.reverse();
    let mut layout =
        Layout { pieces, next_token, lines: Vec::new(), frames: vec![top], token: None, role: Role::Other };
    for index in 0..pieces.len() {
        layout.place(index);
    }
    layout.lines
}

struct Layout<'a> {
    pieces: &'a [Piece<'a>],
    lines: Vec<Line>,
    /// The open brackets, in the top level.
    frames: Vec<Frame>,
    /// For each piece, the index of the first token from this piece on.
    next_token: Vec<usize>,
    /// The index of the last token.
    token: Option<usize>,
    /// The role of the last piece.
    role: Role,
}

impl<'a> Layout<'a> {
    fn place(&mut self, index: usize) {
        let Some(piece) = self.pieces.get(index) else { return };
        let in_parens = self.frames.last().is_some_and(|frame| frame.in_parens);
        let begins = !in_parens && self.begins_statement(index);
        let closes = piece.is(Kind::CloseBrace);
        let role = if piece.is_comment() {
            Role::Other
        } else {
            let before = self.token.and_then(|token| self.pieces.get(token));
            role(before, piece, self.pieces.get(index + 1), in_parens, begins)
        };
        match index.checked_sub(1).and_then(|before| self.pieces.get(before)) {
            Some(before) if piece.breaks == 0 => {
                self.append(piece, blanks((before, self.role), (piece, role)))
            }
            _ => self.begin_line(piece, begins, closes),
        }
        if begins && !closes && !piece.is_comment() {
            let line = self.last_line();
            if let Some(frame) = self.frames.last_mut() {
                frame.statement = line;
            }
        }
        self.record_bracket(index);
        self.role = role;
        if !piece.is_comment() {
            self.token = Some(index);
        }
    }

    fn last_line(&self) -> usize {
        self.lines.len().saturating_sub(1)
    }

    /// True if the piece begins an item, a field, a `let` or a result. A comment counts as the token behind it.
    fn begins_statement(&self, index: usize) -> bool {
        let at = self.next_token.get(index).copied().unwrap_or(index);
        let (Some(this), Some(before)) =
            (self.pieces.get(at), self.token.and_then(|token| self.pieces.get(token)))
        else {
            return true;
        };
        if before.is(Kind::OpenBrace) || before.is(Kind::Semicolon) || this.is(Kind::CloseBrace) {
            return true;
        }
        // A `-` that begins a line begins an expression if its operand follows without a blank.
        let glued = |next: &Piece<'_>| next.breaks == 0 && next.blanks == 0 && !next.is_comment();
        let negates = this.is(Kind::Minus) && this.newline && self.pieces.get(at + 1).is_some_and(glued);
        let calls = this.is(Kind::OpenParen) && !this.newline && before.is(Kind::Name);
        before.ends_operand() && !calls && (negates || !continues(this))
    }

    fn begin_line(&mut self, piece: &Piece<'_>, begins: bool, closes: bool) {
        let start = self.frames.last().map_or(Start::Margin, |frame| match (closes, begins) {
            (true, _) => frame.closing,
            (false, true) => frame.inside,
            (false, false) => Start::Behind(frame.statement),
        });
        self.lines.push(Line {
            gap: piece.breaks > 1 && !self.lines.is_empty(),
            start,
            written_at: piece.column,
            head: piece.text.to_owned(),
            equals: None,
            comment: None,
        });
    }

    fn append(&mut self, piece: &Piece<'_>, blanks: usize) {
        let in_statement = self.frames.last().is_some_and(|frame| frame.statement == self.last_line());
        let begins_value = piece.is(Kind::Assign) && in_statement && self.role != Role::Compound;
        let Some(line) = self.lines.last_mut() else { return };
        let (text, written_at) = (piece.text.to_owned(), piece.column);
        if piece.kind == PieceKind::LineComment {
            line.comment = Some(Tail { text, blanks: blanks.max(1), written_at });
        } else if let Some(equals) = &mut line.equals {
            push(&mut equals.text, blanks, &text);
        } else if begins_value && !line.head.contains(['{', '}', '\n', '=']) {
            line.equals = Some(Tail { text, blanks, written_at });
        } else {
            push(&mut line.head, blanks, &text);
        }
    }

    fn record_bracket(&mut self, index: usize) {
        let (Some(piece), Some(&outer)) = (self.pieces.get(index), self.frames.last()) else { return };
        let line = self.last_line();
        if piece.is(Kind::OpenParen) {
            self.frames.push(Frame { in_parens: true, ..outer });
        } else if piece.is(Kind::OpenBrace) {
            let hangs = self.pieces.get(index + 1).is_some_and(|next| next.breaks == 0 && !next.is_comment());
            let inside = if hangs { Start::Behind(line) } else { Start::Inside(line) };
            let closing = Start::Below(line);
            self.frames.push(Frame { in_parens: false, closing, inside, statement: line });
        } else if (piece.is(Kind::CloseParen) || piece.is(Kind::CloseBrace)) && self.frames.len() > 1 {
            self.frames.pop();
        }
    }
}

pub(super) fn push(line: &mut String, blanks: usize, text: &str) {
    line.extend(std::iter::repeat_n(' ', blanks));
    line.push_str(text);
}
