//! Parses expressions by precedence climbing.

use super::super::ast::{BinaryOp, Expr, ExprId, Name, NameEvent, NameKind};
use super::super::diagnostic::Diagnostic;
use super::super::source::Span;
use super::super::symbol::Symbol;
use super::super::token::{Kind, word};
use super::Parser;

/// The binding power of prefix operators: below a power and above a product, so that -x^2 is -(x^2).
const PREFIX: u8 = 7;

/// An operator between two expressions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Operator {
    /// The sign, such as `+`.
    pub sign: &'static str,
    /// How tightly it binds: operators with a larger number bind tighter.
    pub binds: u8,
    /// True if `a ^ b ^ c` is `a ^ (b ^ c)`.
    pub groups_from_the_right: bool,
}

/// How tightly a prefix operator binds, on the scale of [`Operator::binds`].
pub const PREFIX_BINDS: u8 = PREFIX;

/// Returns the operators between two expressions, from the loosest to the tightest.
pub fn operators() -> impl Iterator<Item = Operator> {
    let infix = BinaryOp::TOKENS.iter().copied().filter_map(BinaryOp::infix);
    infix.map(|(op, binds, right_least)| Operator {
        sign: op.sign(),
        binds,
        groups_from_the_right: right_least <= binds,
    })
}

impl Parser<'_> {
    pub(super) fn expression(&mut self) -> ExprId {
        self.binary(0)
    }

    pub(super) fn error_node(&mut self) -> ExprId {
        let span = self.token().span;
        self.ast.push(Expr::Error, span)
    }

    /// Parses an expression whose operators have a binding power of at least `least`.
    fn binary(&mut self, least: u8) -> ExprId {
        if self.nesting >= self.nesting_max {
            return self.too_deep();
        }
        self.nesting += 1;
        let start = self.token().span;
        let mut left = self.prefix();
        loop {
            let token = self.token();
            if token.kind == Kind::Question && least == 0 {
                left = self.ternary(left, start);
                continue;
            }
            if token.kind == Kind::Unknown && (self.in_parens || !token.newline) {
                left = self.behind_unknown();
                continue;
            }
            let Some((op, binds, right_least)) = BinaryOp::infix(token.kind) else { break };
            if binds < least || self.begins_negation() {
                break;
            }
            self.advance();
            let right = self.binary(right_least);
            left = self.push(Expr::Binary(op, left, right), start);
        }
        self.nesting -= 1;
        left
    }

    /// Skips unknown characters and the expression after them. The lexer has already reported them as one mistake.
    #[cold]
    fn behind_unknown(&mut self) -> ExprId {
        self.advance();
        let token = self.token();
        let begins = matches!(token.kind, Kind::Number | Kind::OpenParen) || token.is_name();
        if begins && (self.in_parens || !token.newline) {
            self.postfix();
        }
        self.error_node()
    }

    /// True at a `-` that begins a new line and has no space after it. Such a `-` begins an expression.
    fn begins_negation(&self) -> bool {
        let token = self.token();
        token.kind == Kind::Minus
            && token.newline
            && !self.in_parens
            && self.ahead(1).span.start == token.span.end
            && self.at > 0
    }

    #[cold]
    pub(super) fn too_deep(&mut self) -> ExprId {
        let span = self.token().span;
        let message = format!("expressions are nested deeper than {} levels", self.nesting_max);
        self.report(Diagnostic::over_limit(span, message).hint("give the inner parts names with `let`"));
        let node = self.error_node();
        let in_parens = self.in_parens;
        self.skip_until(|parser| {
            let kind = parser.kind();
            matches!(kind, Kind::Comma | Kind::Semicolon) || (!in_parens && parser.token().newline)
        });
        node
    }

    fn prefix(&mut self) -> ExprId {
        let token = self.token();
        match token.kind {
            Kind::Minus | Kind::Not => {
                self.advance();
                let inner = self.binary(PREFIX);
                let span = self.since(token.span);
                let node = if token.kind == Kind::Not { Expr::Not(inner) } else { Expr::Negate(inner) };
                self.ast.push(node, span)
            }
            Kind::Plus => {
                let extra = Diagnostic::new(token.span, "an expression cannot begin with `+`");
                self.report(extra.hint("leave it out"));
                self.advance();
                self.binary(PREFIX)
            }
            _ => self.postfix(),
        }
    }

    fn postfix(&mut self) -> ExprId {
        let start = self.token().span;
        let mut inner = self.primary();
        while self.kind() == Kind::Dot {
            self.advance();
            if self.kind() != Kind::Name {
                self.report_expected("the components of a vector, as in `p.xz`");
                break;
            }
            let member = self.advance();
            let components = member.symbol;
            self.ast.record(NameEvent::Member(member.span));
            if self.kind() == Kind::OpenParen && (self.in_parens || !self.token().newline) {
                inner = self.part_band(inner, components, start);
                continue;
            }
            inner = self.push(Expr::Swizzle(inner, components), start);
        }
        inner
    }

    fn primary(&mut self) -> ExprId {
        let token = self.token();
        match token.kind {
            Kind::Number => self.number(),
            Kind::Text => {
                self.advance();
                self.ast.push(Expr::Text(token.symbol), token.span)
            }
            Kind::OpenParen => self.parenthesized(),
            Kind::OpenBrace => self.block(),
            Kind::Name => match token.symbol {
                word::IF => self.if_expression(),
                word::FOR => self.for_expression(),
                word::TRUE | word::FALSE => {
                    self.advance();
                    self.ast.push(Expr::Bool(token.symbol == word::TRUE), token.span)
                }
                _ if token.is_reserved() || token.newline && self.begins_item() => self.no_expression(),
                _ => {
                    self.advance();
                    let name = Name { symbol: token.symbol, span: token.span };
                    let next = self.token();
                    if next.kind == Kind::OpenParen && (self.in_parens || !next.newline) {
                        self.ast.record(NameEvent::Calls(name));
                        return self.call();
                    }
                    self.ast.record(NameEvent::Reads(name));
                    self.ast.push(Expr::Name(token.symbol), token.span)
                }
            },
            _ => self.no_expression(),
        }
    }

    #[cold]
    fn no_expression(&mut self) -> ExprId {
        self.report_expected("an expression");
        let node = self.error_node();
        // Skip an operator, so that parsing continues with the next expression.
        if self.kind() == Kind::Unknown
            || BinaryOp::infix(self.kind()).is_some() && self.kind() != Kind::Minus
        {
            self.advance();
        }
        node
    }

    fn number(&mut self) -> ExprId {
        let token = self.token();
        self.advance();
        let value = token.value();
        if !value.is_finite() {
            let large = Diagnostic::new(token.span, "this number is too large");
            let hint = format!("the largest is about {:.1e}", f32::MAX);
            self.diagnostics.push(large.hint(hint));
            return self.ast.push(Expr::Error, token.span);
        }
        self.ast.push(Expr::Number(value), token.span)
    }

    /// Runs `parse` after an opening bracket. `in_parens` is true if line ends have no meaning inside.
    pub(super) fn within<T>(&mut self, in_parens: bool, parse: impl FnOnce(&mut Self) -> T) -> T {
        let outside = std::mem::replace(&mut self.in_parens, in_parens);
        let result = parse(self);
        self.in_parens = outside;
        result
    }

    fn parenthesized(&mut self) -> ExprId {
        let open = self.advance().span;
        if self.begins_assignment() {
            return self.record(open);
        }
        let inner = self.within(true, Self::expression);
        if self.kind() == Kind::Comma {
            let hint = "write a vector as `vec2(…)`, `vec3(…)` or `vec4(…)`; several results need names: \
                        `(near = a, index = b)`";
            self.report_missing("`)`", hint);
        }
        if self.close_paren(open, "`)`") { inner } else { self.error_node() }
    }

    /// Parses `name = value, …)`, from the first name.
    fn record(&mut self, open: Span) -> ExprId {
        let mark = self.lists.len();
        self.within(true, |parser| {
            while parser.begins_assignment() {
                let name = parser.advance();
                parser.ast.record(NameEvent::Member(name.span));
                parser.advance();
                let value = parser.expression();
                parser.lists.extend([name.symbol.0, value.0]);
                if !parser.eat(Kind::Comma) {
                    break;
                }
            }
        });
        let (first, count) = self.move_list(mark);
        let closed = self.close_paren(open, "`,` or `)`");
        self.push(if closed { Expr::Record(first, count / 2) } else { Expr::Error }, open)
    }

    /// Consumes the `)` that matches `open`. If another token is there, reports it, skips to the `)` and returns false.
    fn close_paren(&mut self, open: Span, what: &str) -> bool {
        if self.eat(Kind::CloseParen) {
            return true;
        }
        let wrong = self.expected(what).note(open, "for this `(`");
        // The closing bracket may be inside an unclosed text, which the lexer has already reported.
        let unknown =
            self.at > 0 && self.tokens.get(self.at - 1).is_some_and(|token| token.kind == Kind::Unknown);
        if !unknown {
            self.report(wrong);
        }
        self.skip_until(|_| false);
        self.eat(Kind::CloseParen);
        false
    }

    fn call(&mut self) -> ExprId {
        let name = self.tokens[self.at - 1];
        let open = self.advance().span;
        let mark = self.lists.len();
        self.within(true, |parser| {
            while !matches!(parser.kind(), Kind::CloseParen | Kind::End) {
                let argument = parser.expression();
                parser.lists.push(argument.0);
                if !parser.eat(Kind::Comma) {
                    break;
                }
            }
        });
        let closed = self.close_paren(open, "`,` or `)`");
        let (first, count) = self.move_list(mark);
        let span = self.since(name.span);
        if !closed {
            return self.ast.push(Expr::Error, span);
        }
        self.ast.push(Expr::Call(name.symbol, first, count), span)
    }

    /// Parses the index in `part.band(index)`, from the opening parenthesis.
    fn part_band(&mut self, of: ExprId, function: Symbol, start: Span) -> ExprId {
        let index = self.parenthesized();
        let span = self.since(start);
        match self.ast.expr(of) {
            Expr::Error => self.ast.push(Expr::Error, span),
            Expr::Name(part) if self.names.name(function) == "band" => {
                self.ast.push(Expr::PartBand(part, index), span)
            }
            _ => {
                let message = format!("there is no function `.{}`", self.names.name(function));
                let hint = "only parts of the song have a function behind a point: `drums.band(3)`";
                self.report(Diagnostic::new(span, message).hint(hint));
                self.ast.push(Expr::Error, span)
            }
        }
    }

    /// Moves the entries of `lists` from `mark` on into the tree, and returns their first index and their count.
    pub(super) fn move_list(&mut self, mark: usize) -> (u32, u32) {
        let first = self.ast.extra.len() as u32;
        let count = (self.lists.len() - mark) as u32;
        self.ast.extra.extend(self.lists.drain(mark..));
        (first, count)
    }

    fn if_expression(&mut self) -> ExprId {
        let start = self.advance().span;
        let condition = self.expression();
        self.choice(start, condition)
    }

    /// Parses `then a else b`, after the condition of an `if` that begins at `start`.
    pub(super) fn choice(&mut self, start: Span, condition: ExprId) -> ExprId {
        if !self.eat_word(word::THEN) {
            self.report_missing("`then` after the condition", "write a choice as `if a then b else c`");
            if self.kind() == Kind::OpenBrace {
                // This `if` is written with braces, as in GLSL. The code below parses the braces as a block.
            } else if !self.token().is_word(word::ELSE) {
                return self.ast.push(Expr::Error, start);
            }
        }
        let yes = self.expression();
        if !self.eat_word(word::ELSE) {
            self.report_missing("`else`", "an `if` needs a value in both cases: `if a then b else c`");
            return self.ast.push(Expr::Error, start);
        }
        let no = self.expression();
        self.push(Expr::If(condition, yes, no), start)
    }

    #[cold]
    fn ternary(&mut self, condition: ExprId, start: Span) -> ExprId {
        let sign = self.token().span;
        let unknown = Diagnostic::unsupported(sign, "there is no operator `?`");
        self.report(unknown.hint("write a choice as `if a then b else c`"));
        self.advance();
        let yes = self.expression();
        if !self.eat(Kind::Colon) {
            return self.ast.push(Expr::Error, sign);
        }
        let no = self.expression();
        self.push(Expr::If(condition, yes, no), start)
    }

    fn for_expression(&mut self) -> ExprId {
        let start = self.token().span;
        let Some((variable, first, end)) = self.loop_head("union(for i in 0..32: expression)") else {
            return self.ast.push(Expr::Error, start);
        };
        if !self.eat(Kind::Colon) {
            self.report_missing("`:` before the loop's body", "write a loop as `for i in 0..8: expression`");
        }
        self.ast.record(NameEvent::Opens);
        self.ast.record(NameEvent::Declares(NameKind::LoopVariable, variable));
        let body = self.expression();
        self.ast.record(NameEvent::Closes(self.end_before));
        let index = self.ast.extra.len() as u32;
        self.ast.extra.extend([variable.symbol.0, first.0, end.0, body.0]);
        self.push(Expr::For(index), start)
    }

    /// Parses `for variable in first..end`. `example` shows how to write such a loop. `None` if a mistake was reported.
    pub(super) fn loop_head(&mut self, example: &str) -> Option<(Name, ExprId, ExprId)> {
        self.advance();
        let hint = format!("write a loop as `{example}`");
        if self.kind() == Kind::OpenParen {
            self.report_missing("the loop's variable", hint);
            return None;
        }
        let variable = self.name("the loop's variable")?;
        if !self.eat_word(word::IN) {
            self.report_missing("`in` after the loop's variable", hint);
            return None;
        }
        let first = self.expression();
        if !self.eat(Kind::Range) {
            self.report_missing("`..` and the loop's end", hint);
            return None;
        }
        Some((variable, first, self.expression()))
    }
}
