//! The tokens of the language.

use super::source::Span;
use super::symbol::Symbol;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Number,
    /// A name or a word of [`RESERVED`].
    Name,
    /// A text in quotes. The symbol is the text between the quotes.
    Text,
    OpenParen,
    CloseParen,
    OpenBrace,
    CloseBrace,
    Comma,
    Semicolon,
    Colon,
    Question,
    Dot,
    Range,
    Plus,
    Minus,
    Star,
    Slash,
    Percent,
    Caret,
    Assign,
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    And,
    Or,
    Not,
    Unknown,
    End,
}

/// The signs, each before the signs with which it begins.
pub(super) const SIGNS: [(&str, Kind); 26] = [
    ("(", Kind::OpenParen),
    (")", Kind::CloseParen),
    (",", Kind::Comma),
    ("..", Kind::Range),
    (".", Kind::Dot),
    ("==", Kind::Equal),
    ("=", Kind::Assign),
    ("*", Kind::Star),
    ("+", Kind::Plus),
    ("-", Kind::Minus),
    ("/", Kind::Slash),
    ("{", Kind::OpenBrace),
    ("}", Kind::CloseBrace),
    ("^", Kind::Caret),
    ("%", Kind::Percent),
    (":", Kind::Colon),
    (";", Kind::Semicolon),
    ("?", Kind::Question),
    ("!=", Kind::NotEqual),
    ("!", Kind::Not),
    ("<=", Kind::LessEqual),
    ("<", Kind::Less),
    (">=", Kind::GreaterEqual),
    (">", Kind::Greater),
    ("&&", Kind::And),
    ("||", Kind::Or),
];

impl Kind {
    /// Returns the sign of a token; empty for other tokens.
    pub(super) fn sign(self) -> &'static str {
        SIGNS.iter().find(|(_, kind)| *kind == self).map_or("", |(sign, _)| sign)
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Token {
    pub kind: Kind,
    /// True if a line ends between the previous token and this token.
    pub newline: bool,
    /// The symbol of a name or text; for a number the bits of its value (see [`Token::value`]).
    pub symbol: Symbol,
    pub span: Span,
}

/// Words that cannot be names, in the order of their symbols.
pub(super) const RESERVED: &[&str] =
    &["let", "fn", "for", "in", "if", "then", "else", "true", "false", "while", "break"];

/// The symbols of [`RESERVED`], which are the first symbols of every interner.
pub(super) mod word {
    use super::Symbol;
    pub(crate) const LET: Symbol = Symbol(0);
    pub(crate) const FN: Symbol = Symbol(1);
    pub(crate) const FOR: Symbol = Symbol(2);
    pub(crate) const IN: Symbol = Symbol(3);
    pub(crate) const IF: Symbol = Symbol(4);
    pub(crate) const THEN: Symbol = Symbol(5);
    pub(crate) const ELSE: Symbol = Symbol(6);
    pub(crate) const TRUE: Symbol = Symbol(7);
    pub(crate) const FALSE: Symbol = Symbol(8);
    pub(crate) const WHILE: Symbol = Symbol(9);
    pub(crate) const BREAK: Symbol = Symbol(10);
}

impl Token {
    pub(super) fn is_reserved(self) -> bool {
        self.kind == Kind::Name && self.symbol.index() < RESERVED.len()
    }

    /// Returns the value of a number; infinite if the number is too large.
    pub(super) fn value(self) -> f32 {
        f32::from_bits(self.symbol.0)
    }

    pub(super) fn is_name(self) -> bool {
        self.kind == Kind::Name && !self.is_reserved()
    }

    pub(super) fn is_word(self, word: Symbol) -> bool {
        self.kind == Kind::Name && self.symbol == word
    }
}
