//! Parses blocks and their statements: lets, assignments, loops with state, and `if` with braces.

use super::super::ast::{
    Assignment, BinaryOp, Expr, ExprId, Loop, Name, NameEvent, NameKind, Statement, Statements, When,
};
use super::super::diagnostic::Diagnostic;
use super::super::source::Span;
use super::super::symbol::Symbol;
use super::super::token::{Kind, word};
use super::Parser;
use super::items::Habit;

const LOOP_EXAMPLE: &str = "for i in 0..8 { z = f(z) }";

/// The left side of an assignment.
struct Target {
    name: Symbol,
    components: Option<Symbol>,
    op: Option<BinaryOp>,
    /// The number of tokens up to the value.
    tokens: usize,
}

/// Parses the statements of a block.
struct StatementParser<'p, 'a> {
    outer: &'p mut Parser<'a>,
}

impl Parser<'_> {
    /// Parses `{ statement… result }`, from the opening brace.
    pub(super) fn block(&mut self) -> ExprId {
        let open = self.advance().span;
        let mark = self.lists.len();
        self.ast.record(NameEvent::Opens);
        let result = self.within(false, |parser| {
            loop {
                let result = match (StatementParser { outer: parser }).statements() {
                    Some(choice) => choice,
                    None => parser.block_result(open),
                };
                while parser.eat(Kind::Semicolon) {}
                if parser.eat(Kind::CloseBrace) {
                    return result;
                }
                let wrong = parser.expected("`}` after the block's result").note(open, "for this `{`");
                let hint = "a block consists of statements and one result: `{ let a = 1  a + 2 }`";
                parser.report(if wrong.hint.is_none() { wrong.hint(hint) } else { wrong });
                parser.skip_until(|_| false);
                if !parser.token().is_word(word::LET)
                    && (StatementParser { outer: parser }).target(0).is_none()
                {
                    parser.eat(Kind::CloseBrace);
                    return result;
                }
            }
        });
        self.ast.record(NameEvent::Closes(self.end_before));
        let (first, count) = self.move_list(mark);
        self.push(Expr::Block(first, count, result), open)
    }

    fn block_result(&mut self, open: Span) -> ExprId {
        if matches!(self.kind(), Kind::CloseBrace | Kind::End) {
            let wrong = self.expected("the block's result").note(open, "in this block");
            self.report(wrong.hint("the last expression of a block is its value"));
            return self.error_node();
        }
        self.expression()
    }
}

impl StatementParser<'_, '_> {
    /// Parses statements and pushes them to `lists`. Returns a choice `if a then b else c`, if one follows: it is the
    /// block's result.
    fn statements(&mut self) -> Option<ExprId> {
        loop {
            while self.outer.eat(Kind::Semicolon) {}
            let at = self.outer.at;
            match self.statement() {
                Parsed::Statement(id) => self.outer.lists.push(id.0),
                Parsed::Choice(id) => return Some(id),
                Parsed::Nothing => return None,
            }
            if self.outer.at == at {
                return None;
            }
        }
    }

    fn statement(&mut self) -> Parsed {
        let token = self.outer.token();
        if self.outer.eat_word(word::LET) {
            return self.let_statement(token.span);
        }
        if let Some(target) = self.target(0) {
            return Parsed::Statement(self.assignment(&target));
        }
        match token.symbol {
            _ if token.kind != Kind::Name => return Parsed::Nothing,
            word::IF => return self.when(),
            word::FOR => return Parsed::Statement(self.loop_statement()),
            word::WHILE => return Parsed::Statement(self.while_statement()),
            word::BREAK => {
                self.outer.advance();
                return Parsed::Statement(self.outer.ast.push(Expr::Break, token.span));
            }
            _ => {}
        }
        if token.is_name() && self.counts_up() {
            return Parsed::Statement(self.outer.error_node());
        }
        match self.outer.glsl_habit() {
            Habit::None => Parsed::Nothing,
            Habit::Let => self.let_statement(token.span),
            Habit::Skipped => Parsed::Statement(self.outer.error_node()),
        }
    }

    fn let_statement(&mut self, start: Span) -> Parsed {
        let bound = self.outer.binding();
        let span = self.outer.since(start);
        Parsed::Statement(match bound {
            Some((name, value)) => self.outer.ast.push(Expr::Let(name.symbol, value), span),
            None => self.outer.error_node(),
        })
    }

    /// Reports GLSL's `i++` and `i--`, and skips them.
    fn counts_up(&mut self) -> bool {
        let (first, second) = (self.outer.ahead(1), self.outer.ahead(2));
        let sign = match first.kind {
            Kind::Plus => '+',
            Kind::Minus => '-',
            _ => return false,
        };
        if second.kind != first.kind || first.span.end != second.span.start || first.newline {
            return false;
        }
        let name = self.outer.names.name(self.outer.token().symbol);
        let span = Span::new(self.outer.token().span.start, second.span.end);
        let unknown = Diagnostic::unsupported(span, format!("there is no `{sign}{sign}`"));
        self.outer.report(unknown.hint(format!("write `{name} {sign}= 1`")));
        for _ in 0..3 {
            self.outer.advance();
        }
        true
    }

    /// Recognizes the left side of an assignment that begins `from` tokens ahead.
    fn target(&self, from: usize) -> Option<Target> {
        let ahead = |count: usize| self.outer.ahead(from + count);
        let token = ahead(0);
        if !token.is_name() {
            return None;
        }
        let (components, mut tokens) = match ahead(1).kind {
            Kind::Dot if ahead(2).kind == Kind::Name => (Some(ahead(2).symbol), 3),
            _ => (None, 1),
        };
        let sign = ahead(tokens);
        let op = match sign.kind {
            Kind::Assign => None,
            Kind::Plus => Some(BinaryOp::Add),
            Kind::Minus => Some(BinaryOp::Subtract),
            Kind::Star => Some(BinaryOp::Multiply),
            Kind::Slash => Some(BinaryOp::Divide),
            _ => return None,
        };
        if op.is_some() {
            tokens += 1;
            let equals = ahead(tokens);
            if equals.kind != Kind::Assign || equals.span.start != sign.span.end {
                return None;
            }
        }
        Some(Target { name: token.symbol, components, op, tokens: tokens + 1 })
    }

    fn assignment(&mut self, target: &Target) -> ExprId {
        let start = self.outer.token().span;
        self.outer.ast.record(NameEvent::Reads(Name { symbol: target.name, span: start }));
        if target.components.is_some() {
            self.outer.ast.record(NameEvent::Member(self.outer.ahead(2).span));
        }
        for _ in 0..target.tokens {
            self.outer.advance();
        }
        let value = self.outer.expression();
        self.outer.end_of_entry();
        let span = self.outer.since(start);
        let &Target { name, components, op, .. } = target;
        self.outer.ast.push_statement(Statement::Assign(Assignment { name, components, op, value }), span)
    }

    /// Parses `for i in 0..8 while condition { … }`.
    fn loop_statement(&mut self) -> ExprId {
        let start = self.outer.token().span;
        let Some((variable, first, end)) = self.outer.loop_head(LOOP_EXAMPLE) else {
            self.skip_braces();
            return self.outer.error_node();
        };
        self.outer.ast.record(NameEvent::Opens);
        self.outer.ast.record(NameEvent::Declares(NameKind::LoopVariable, variable));
        let condition = self.outer.eat_word(word::WHILE).then(|| self.outer.expression());
        let body = self.body("the loop's body in braces", LOOP_EXAMPLE);
        self.outer.ast.record(NameEvent::Closes(self.outer.end_before));
        let Some(body) = body else {
            return self.outer.error_node();
        };
        let span = self.outer.since(start);
        let of = Loop { variable: variable.symbol, first, end, condition, body };
        self.outer.ast.push_statement(Statement::Loop(of), span)
    }

    #[cold]
    fn while_statement(&mut self) -> ExprId {
        let unknown =
            Diagnostic::unsupported(self.outer.token().span, "a loop needs a maximum number of iterations");
        self.outer.report(unknown.hint("write `for i in 0..64 while condition { … }`"));
        self.outer.advance();
        self.outer.expression();
        self.skip_braces();
        self.outer.error_node()
    }

    /// Skips a block in braces, if one follows on this line.
    fn skip_braces(&mut self) {
        self.outer.skip_until(|parser| parser.kind() == Kind::OpenBrace || parser.token().newline);
        if self.outer.eat(Kind::OpenBrace) {
            self.outer.skip_until(|_| false);
            self.outer.eat(Kind::CloseBrace);
        }
    }

    /// Parses `if condition { … } else { … }`, or a choice `if a then b else c`.
    fn when(&mut self) -> Parsed {
        if self.outer.nesting >= self.outer.nesting_max {
            return Parsed::Statement(self.outer.too_deep());
        }
        self.outer.nesting += 1;
        let parsed = self.choice_or_when();
        self.outer.nesting -= 1;
        parsed
    }

    fn choice_or_when(&mut self) -> Parsed {
        let start = self.outer.advance().span;
        let condition = self.outer.expression();
        let is_statement = self.outer.kind() == Kind::OpenBrace && self.begins_statements()
            || self.outer.token().is_word(word::BREAK)
            || self.target(0).is_some();
        if !is_statement {
            return Parsed::Choice(self.outer.choice(start, condition));
        }
        let Some(yes) = self.branch() else { return Parsed::Statement(self.outer.error_node()) };
        let mut no = Statements { first: 0, count: 0 };
        if self.outer.eat_word(word::ELSE) {
            let Some(other) = self.branch() else { return Parsed::Statement(self.outer.error_node()) };
            no = other;
        }
        let span = self.outer.since(start);
        let when = Statement::When(When { condition, yes, no });
        Parsed::Statement(self.outer.ast.push_statement(when, span))
    }

    /// True if the braces at the current token hold statements instead of a value.
    fn begins_statements(&self) -> bool {
        let (first, second) = (self.outer.ahead(1), self.outer.ahead(2));
        let words = [word::LET, word::IF, word::FOR, word::WHILE, word::BREAK];
        let is_typed = first.is_name() && second.is_name();
        words.into_iter().any(|word| first.is_word(word))
            || matches!(first.kind, Kind::CloseBrace | Kind::Semicolon)
            || self.target(1).is_some()
            || is_typed
    }

    /// Parses the statements of one side of an `if`: in braces, a single one, or another `if`.
    fn branch(&mut self) -> Option<Statements> {
        if self.outer.kind() == Kind::OpenBrace {
            return self.body("statements in braces", "if a > b { z = a } else { z = b }");
        }
        let mark = self.outer.lists.len();
        self.outer.ast.record(NameEvent::Opens);
        let parsed = self.statement();
        self.outer.ast.record(NameEvent::Closes(self.outer.end_before));
        match parsed {
            Parsed::Statement(id) => {
                self.outer.eat(Kind::Semicolon);
                self.outer.lists.push(id.0);
                let (first, count) = self.outer.move_list(mark);
                Some(Statements { first, count })
            }
            Parsed::Choice(_) | Parsed::Nothing => {
                self.outer
                    .report_missing("statements in braces", "write `if a > b { z = a } else { z = b }`");
                None
            }
        }
    }

    /// Parses `{ statement… }`. `None` if a mistake was reported.
    fn body(&mut self, what: &str, example: &str) -> Option<Statements> {
        let open = self.outer.token().span;
        if !self.outer.eat(Kind::OpenBrace) {
            self.outer.report_missing(what, format!("write `{example}`"));
            return None;
        }
        if self.outer.nesting >= self.outer.nesting_max {
            self.outer.too_deep();
            return None;
        }
        self.outer.nesting += 1;
        let mark = self.outer.lists.len();
        self.outer.ast.record(NameEvent::Opens);
        let choice = self.outer.within(false, |parser| StatementParser { outer: parser }.statements());
        self.outer.ast.record(NameEvent::Closes(self.outer.end_before));
        self.outer.nesting -= 1;
        let (first, count) = self.outer.move_list(mark);
        if choice.is_some() || self.outer.kind() != Kind::CloseBrace {
            let wrong = self.outer.expected("`}` after the statements").note(open, "for this `{`");
            let hint = "these braces hold assignments and no result: `z = a`";
            self.outer.report(if wrong.hint.is_none() { wrong.hint(hint) } else { wrong });
            self.outer.skip_until(|_| false);
        }
        self.outer.eat(Kind::CloseBrace);
        Some(Statements { first, count })
    }
}

enum Parsed {
    Statement(ExprId),
    Choice(ExprId),
    Nothing,
}
