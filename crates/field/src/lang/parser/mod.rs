//! The parser: builds the syntax tree from tokens. It never fails: a mistake is reported once and becomes
//! [`Expr::Error`](super::ast::Expr::Error), and parsing continues after the mistake.
//!
//! In the grammar, `?` marks an optional part and `*` a repeated part. `;` is allowed between any two items, fields or
//! lets.
//!
//! ```text
//! scene   = item*
//! item    = "param" name "=" expr ("in" expr ".." expr)?
//!         | "fn" name "(" params ")" (block | "=" expr)
//!         | "let" name "=" expr
//!         | ("object" | "material" | "light") name fields
//!         | "camera" name? fields
//!         | ("sky" | "picture" | "about") fields
//!         | "include" text
//!         | expr
//! params  = (name (":" type)?)*, separated by ","
//! fields  = "{" (name "=" expr (".." expr)? | "let" name "=" expr)* "}"
//! block   = "{" statement* expr "}"
//! statement = "let" name "=" expr
//!         | name ("." name)? ("=" | "+=" | "-=" | "*=" | "/=") expr
//!         | "for" name "in" expr ".." expr ("while" expr)? "{" statement* "}"
//!         | "if" expr branch ("else" branch)?
//!         | "break"
//! branch  = "{" statement* "}" | statement
//! expr    = "if" expr "then" expr "else" expr
//!         | "for" name "in" expr ".." expr ":" expr
//!         | expr operator expr | "-" expr | "!" expr | expr "." name
//!         | number | text | name | name "(" exprs ")" | "(" expr ")" | block
//!         | "(" name "=" expr ("," name "=" expr)* ")"
//! ```
//!
//! A line end matters only if the next line could either continue the expression or begin a new one. If the next line
//! begins with `(…)` or with `-x` without a space, it begins a new expression; `- x` continues the previous expression.
//! Inside parentheses line ends have no meaning. The words `param include object material light camera sky picture
//! about` are reserved only at the start of an item.

mod expr;
mod items;
mod statements;
#[cfg(test)]
mod tests;

use super::ast::{Ast, Expr, ExprId, Item};
use super::diagnostic::{Diagnostic, Diagnostics};
use super::source::Span;
use super::symbol::{Interner, Symbol};
use super::token::{Kind, Token, word};

pub use expr::{Operator, PREFIX_BINDS, operators};
pub use items::item_words;
pub(super) use items::{declares_glsl, is_keyword};

/// Parses one file's tokens, the last of which must be `End`, into items. Adds their expressions to `ast`.
pub(super) fn parse(
    tokens: &[Token],
    names: &Interner,
    nesting_max: usize,
    ast: &mut Ast,
    diagnostics: &mut Diagnostics,
) -> Vec<Item> {
    ast.reserve(tokens.len());
    let mut parser = Parser {
        tokens,
        at: 0,
        current: tokens.first().copied().unwrap_or(END),
        end_before: 0,
        names,
        ast,
        diagnostics,
        nesting: 0,
        nesting_max,
        in_parens: false,
        reported: None,
        lists: Vec::new(),
    };
    parser.items()
}

struct Parser<'a> {
    tokens: &'a [Token],
    at: usize,
    current: Token,
    /// The end of the previous token; 0 at the start.
    end_before: u32,
    names: &'a Interner,
    ast: &'a mut Ast,
    diagnostics: &'a mut Diagnostics,
    nesting: usize,
    nesting_max: usize,
    in_parens: bool,
    /// Index of the last reported token. Each token is reported at most once.
    reported: Option<usize>,
    /// A stack of the children of all calls and blocks that are being parsed.
    lists: Vec<u32>,
}

const END: Token =
    Token { kind: Kind::End, newline: true, symbol: Symbol(0), span: Span { start: 0, end: 0 } };

impl Parser<'_> {
    fn token(&self) -> Token {
        self.current
    }

    fn ahead(&self, count: usize) -> Token {
        match self.tokens.get(self.at + count).or(self.tokens.last()) {
            Some(&token) => token,
            None => END,
        }
    }

    fn kind(&self) -> Kind {
        self.current.kind
    }

    /// Consumes the current token, unless it is the final `End`.
    #[inline]
    fn advance(&mut self) -> Token {
        let token = self.current;
        if let Some(&next) = self.tokens.get(self.at + 1) {
            self.at += 1;
            self.current = next;
            self.end_before = token.span.end;
        }
        token
    }

    fn eat(&mut self, kind: Kind) -> bool {
        let found = self.kind() == kind;
        if found {
            self.advance();
        }
        found
    }

    fn eat_word(&mut self, word: Symbol) -> bool {
        let found = self.token().is_word(word);
        if found {
            self.advance();
        }
        found
    }

    fn since(&self, start: Span) -> Span {
        Span::new(start.start, self.end_before.max(start.end))
    }

    /// Reports `diagnostic`, unless the parser or the lexer has already reported the current token.
    fn report(&mut self, diagnostic: Diagnostic) {
        if self.reported != Some(self.at) && self.kind() != Kind::Unknown {
            self.reported = Some(self.at);
            self.diagnostics.push(diagnostic);
        }
    }

    fn found(&self) -> String {
        let token = self.token();
        match token.kind {
            Kind::End => "the end of the text".to_owned(),
            Kind::Number => "a number".to_owned(),
            Kind::Text => "a text".to_owned(),
            Kind::Name => {
                let name = self.names.name(token.symbol);
                let short: String = name.chars().take(NAME_SHOWN).collect();
                format!("`{short}{}`", if short.len() < name.len() { "…" } else { "" })
            }
            other => format!("`{}`", other.sign()),
        }
    }

    fn expected(&self, what: &str) -> Diagnostic {
        let diagnostic =
            Diagnostic::new(self.token().span, format!("expected {what}, found {}", self.found()));
        match self.kind() {
            Kind::Assign => diagnostic.hint("`=` gives a name its value; to compare write `==`"),
            _ => diagnostic,
        }
    }

    /// Reports that `what` is missing here.
    fn report_expected(&mut self, what: &str) {
        self.report(self.expected(what));
    }

    /// Reports that `what` is missing here, with a hint.
    fn report_missing(&mut self, what: &str, hint: impl Into<String>) {
        self.report(self.expected(what).hint(hint));
    }

    /// Adds an expression that began at `start` and ends here.
    fn push(&mut self, expr: Expr, start: Span) -> ExprId {
        let span = self.since(start);
        self.ast.push(expr, span)
    }

    fn demand(&mut self, kind: Kind, after: &str) -> bool {
        let found = self.eat(kind);
        if !found {
            self.report_expected(&format!("`{}` {after}", kind.sign()));
        }
        found
    }

    /// Skips tokens until `stop` returns true. Brackets that open in the skipped text are skipped as a whole. Also
    /// stops before an unmatched closing bracket, a `let`, a field or item on a new line, and the end of the text.
    fn skip_until(&mut self, stop: impl Fn(&Self) -> bool) {
        let mut open = 0_usize;
        loop {
            match self.kind() {
                Kind::End => return,
                Kind::CloseParen | Kind::CloseBrace if open == 0 => return,
                _ if open == 0 && stop(self) => return,
                _ if self.token().newline && self.begins_item() => return,
                _ if open == 0 && self.begins_entry() => return,
                Kind::OpenParen | Kind::OpenBrace => open += 1,
                Kind::CloseParen | Kind::CloseBrace => open -= 1,
                _ => {}
            }
            self.advance();
        }
    }

    fn begins_assignment(&self) -> bool {
        self.token().is_name() && self.ahead(1).kind == Kind::Assign
    }

    fn begins_entry(&self) -> bool {
        let token = self.token();
        token.is_word(word::LET) || (token.newline && self.begins_assignment())
    }

    /// True at the start of an item that is not a bare expression or a `let`.
    fn begins_item(&self) -> bool {
        self.token().is_word(word::FN) || items::keyword(self).is_some()
    }
}

const NAME_SHOWN: usize = 60;
