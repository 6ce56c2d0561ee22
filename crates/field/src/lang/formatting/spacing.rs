//! The blanks between two pieces of a line.

use super::super::ast::BinaryOp;
use super::super::parser::is_keyword;
use super::super::pieces::{Piece, PieceKind};
use super::super::token::Kind;

/// The meaning of a piece in its line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// An operator or `..` with blanks around it.
    Spaced,
    /// An operator or `..` that the author has written without blanks.
    Tight,
    /// A sign before its operand.
    Prefix,
    /// An operator whose `=` follows at once, as in `+=`.
    Compound,
    /// A `-` that begins a line outside of parentheses: the parser distinguishes `-x` and `- x`.
    FirstMinus,
    /// A word such as `object`, which begins an item.
    ItemWord,
    Other,
}

fn is_binary(kind: PieceKind) -> bool {
    matches!(kind, PieceKind::Token(kind) if BinaryOp::infix(kind).is_some())
}

fn is_any(piece: &Piece<'_>, kinds: &[Kind]) -> bool {
    kinds.iter().any(|kind| piece.is(*kind))
}

/// True if a piece after a complete expression continues this expression.
pub(super) fn continues(piece: &Piece<'_>) -> bool {
    use Kind::{Assign, CloseParen, Colon, Comma, Dot, OpenBrace, Range};
    let sign = is_any(piece, &[Dot, Range, Colon, Assign, Comma, CloseParen, OpenBrace]);
    sign || is_binary(piece.kind) || ["then", "else", "in", "while"].iter().any(|word| piece.is_word(word))
}

/// Returns the role of the piece `this` between the tokens `before` and `after`.
pub(super) fn role(
    before: Option<&Piece<'_>>,
    this: &Piece<'_>,
    after: Option<&Piece<'_>>,
    in_parens: bool,
    begins_statement: bool,
) -> Role {
    let is_glued = |after: &Piece<'_>| after.breaks == 0 && after.blanks == 0;
    let first = this.newline || before.is_none();
    if is_binary(this.kind) && after.is_some_and(|after| after.is(Kind::Assign) && is_glued(after)) {
        return Role::Compound;
    }
    if this.is(Kind::Minus) && first && !in_parens {
        return Role::FirstMinus;
    }
    if this.is(Kind::Not) || this.is(Kind::Minus) && !before.is_some_and(Piece::ends_operand) {
        return Role::Prefix;
    }
    let may_be_tight = is_any(this, &[Kind::Star, Kind::Slash, Kind::Percent, Kind::Caret, Kind::Range]);
    if is_binary(this.kind) || this.is(Kind::Range) {
        let tight = may_be_tight && !first && this.blanks == 0 && after.is_some_and(is_glued);
        return if tight { Role::Tight } else { Role::Spaced };
    }
    let names = |after: &Piece<'_>| after.is(Kind::Name) || after.is(Kind::Text);
    if begins_statement && this.is(Kind::Name) && is_keyword(this.text) && after.is_some_and(names) {
        return Role::ItemWord;
    }
    Role::Other
}

/// Returns the number of blanks between two pieces of a line.
pub(super) fn blanks(before: (&Piece<'_>, Role), this: (&Piece<'_>, Role)) -> usize {
    let ((a, role_a), (b, role_b)) = (before, this);
    let written = b.blanks;
    if a.is_comment() || b.is_comment() {
        return written;
    }
    match role_a {
        Role::Prefix | Role::Compound => return 0,
        Role::FirstMinus => return written.min(1),
        _ => {}
    }
    let ends = [Kind::Comma, Kind::Semicolon, Kind::Colon, Kind::CloseParen];
    if is_any(b, &ends) || a.is(Kind::OpenParen) {
        return 0;
    }
    if a.is(Kind::Dot) || b.is(Kind::Dot) {
        // In `1 .x` the blank keeps the point from the number.
        return if a.is(Kind::Number) { written.min(1) } else { 0 };
    }
    if role_a == Role::Tight || role_b == Role::Tight {
        return 0;
    }
    if a.is(Kind::OpenBrace) {
        return usize::from(!b.is(Kind::CloseBrace));
    }
    if b.is(Kind::OpenParen) && a.is(Kind::Name) {
        return 0;
    }
    let one = b.is(Kind::CloseBrace)
        || b.is(Kind::OpenBrace) && a.is(Kind::CloseParen)
        || is_any(a, &[Kind::Comma, Kind::Colon, Kind::Assign])
        || matches!(role_a, Role::Spaced | Role::ItemWord)
        || matches!(role_b, Role::Spaced | Role::Compound)
        || a.kind == PieceKind::Reserved && !a.ends_operand();
    if one { 1 } else { written.max(1) }
}
