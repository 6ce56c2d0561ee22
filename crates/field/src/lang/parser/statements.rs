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

impl Parser<'_> {
    /// Parses `{ statement… result }`, from the opening brace.
    pub(super) fn block(&mut self) -> ExprId {
        let open = self.advance().span;
        let mark = self.lists.len();
        self.ast.record(NameEvent::Opens);
        let result = self.within(false, |parser| {
            loop {
                let result = match statements(parser) {
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
                if !parser.token().is_word(word::LET) && target(parser, 0).is_none() {
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

/// Parses statements and pushes them to `lists`. Returns a choice `if a then b else c`, if one follows: it is the
/// block's result.
fn statements(parser: &mut Parser<'_>) -> Option<ExprId> {
    loop {
        while parser.eat(Kind::Semicolon) {}
        let at = parser.at;
        match statement(parser) {
            Parsed::Statement(id) => parser.lists.push(id.0),
            Parsed::Choice(id) => return Some(id),
            Parsed::Nothing => return None,
        }
        if parser.at == at {
            return None;
        }
    }
}

fn statement(parser: &mut Parser<'_>) -> Parsed {
    let token = parser.token();
    if parser.eat_word(word::LET) {
        return let_statement(parser, token.span);
    }
    if let Some(target) = target(parser, 0) {
        return Parsed::Statement(assignment(parser, &target));
    }
    match token.symbol {
        _ if token.kind != Kind::Name => return Parsed::Nothing,
        word::IF => return when(parser),
        word::FOR => return Parsed::Statement(loop_statement(parser)),
        word::WHILE => return Parsed::Statement(while_statement(parser)),
        word::BREAK => {
            parser.advance();
            return Parsed::Statement(parser.ast.push(Expr::Break, token.span));
        }
        _ => {}
    }
    if token.is_name() && counts_up(parser) {
        return Parsed::Statement(parser.error_node());
    }
    match parser.glsl_habit() {
        Habit::None => Parsed::Nothing,
        Habit::Let => let_statement(parser, token.span),
        Habit::Skipped => Parsed::Statement(parser.error_node()),
    }
}

fn let_statement(parser: &mut Parser<'_>, start: Span) -> Parsed {
    let bound = parser.binding();
    let span = parser.since(start);
    Parsed::Statement(match bound {
        Some((name, value)) => parser.ast.push(Expr::Let(name.symbol, value), span),
        None => parser.error_node(),
    })
}

/// Reports GLSL's `i++` and `i--`, and skips them.
fn counts_up(parser: &mut Parser<'_>) -> bool {
    let (first, second) = (parser.ahead(1), parser.ahead(2));
    let sign = match first.kind {
        Kind::Plus => '+',
        Kind::Minus => '-',
        _ => return false,
    };
    if second.kind != first.kind || first.span.end != second.span.start || first.newline {
        return false;
    }
    let name = parser.names.name(parser.token().symbol);
    let span = Span::new(parser.token().span.start, second.span.end);
    let unknown = Diagnostic::unsupported(span, format!("there is no `{sign}{sign}`"));
    parser.report(unknown.hint(format!("write `{name} {sign}= 1`")));
    for _ in 0..3 {
        parser.advance();
    }
    true
}

/// Recognizes the left side of an assignment that begins `from` tokens ahead.
fn target(parser: &Parser<'_>, from: usize) -> Option<Target> {
    let ahead = |count: usize| parser.ahead(from + count);
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

fn assignment(parser: &mut Parser<'_>, target: &Target) -> ExprId {
    let start = parser.token().span;
    parser.ast.record(NameEvent::Reads(Name { symbol: target.name, span: start }));
    if target.components.is_some() {
        parser.ast.record(NameEvent::Member(parser.ahead(2).span));
    }
    for _ in 0..target.tokens {
        parser.advance();
    }
    let value = parser.expression();
    parser.end_of_entry();
    let span = parser.since(start);
    let &Target { name, components, op, .. } = target;
    parser.ast.push_statement(Statement::Assign(Assignment { name, components, op, value }), span)
}

/// Parses `for i in 0..8 while condition { … }`.
fn loop_statement(parser: &mut Parser<'_>) -> ExprId {
    let start = parser.token().span;
    let Some((variable, first, end)) = parser.loop_head(LOOP_EXAMPLE) else {
        skip_braces(parser);
        return parser.error_node();
    };
    parser.ast.record(NameEvent::Opens);
    parser.ast.record(NameEvent::Declares(NameKind::LoopVariable, variable));
    let condition = parser.eat_word(word::WHILE).then(|| parser.expression());
    let body = body(parser, "the loop's body in braces", LOOP_EXAMPLE);
    parser.ast.record(NameEvent::Closes(parser.end_before));
    let Some(body) = body else {
        return parser.error_node();
    };
    let span = parser.since(start);
    let of = Loop { variable: variable.symbol, first, end, condition, body };
    parser.ast.push_statement(Statement::Loop(of), span)
}

#[cold]
fn while_statement(parser: &mut Parser<'_>) -> ExprId {
    let unknown = Diagnostic::unsupported(parser.token().span, "a loop needs a maximum number of iterations");
    parser.report(unknown.hint("write `for i in 0..64 while condition { … }`"));
    parser.advance();
    parser.expression();
    skip_braces(parser);
    parser.error_node()
}

/// Skips a block in braces, if one follows on this line.
fn skip_braces(parser: &mut Parser<'_>) {
    parser.skip_until(|parser| parser.kind() == Kind::OpenBrace || parser.token().newline);
    if parser.eat(Kind::OpenBrace) {
        parser.skip_until(|_| false);
        parser.eat(Kind::CloseBrace);
    }
}

/// Parses `if condition { … } else { … }`, or a choice `if a then b else c`.
fn when(parser: &mut Parser<'_>) -> Parsed {
    if parser.nesting >= parser.nesting_max {
        return Parsed::Statement(parser.too_deep());
    }
    parser.nesting += 1;
    let parsed = choice_or_when(parser);
    parser.nesting -= 1;
    parsed
}

fn choice_or_when(parser: &mut Parser<'_>) -> Parsed {
    let start = parser.advance().span;
    let condition = parser.expression();
    let is_statement = parser.kind() == Kind::OpenBrace && begins_statements(parser)
        || parser.token().is_word(word::BREAK)
        || target(parser, 0).is_some();
    if !is_statement {
        return Parsed::Choice(parser.choice(start, condition));
    }
    let Some(yes) = branch(parser) else { return Parsed::Statement(parser.error_node()) };
    let mut no = Statements { first: 0, count: 0 };
    if parser.eat_word(word::ELSE) {
        let Some(other) = branch(parser) else { return Parsed::Statement(parser.error_node()) };
        no = other;
    }
    let span = parser.since(start);
    let when = Statement::When(When { condition, yes, no });
    Parsed::Statement(parser.ast.push_statement(when, span))
}

/// True if the braces at the current token hold statements instead of a value.
fn begins_statements(parser: &Parser<'_>) -> bool {
    let (first, second) = (parser.ahead(1), parser.ahead(2));
    let words = [word::LET, word::IF, word::FOR, word::WHILE, word::BREAK];
    let is_typed = first.is_name() && second.is_name();
    words.into_iter().any(|word| first.is_word(word))
        || matches!(first.kind, Kind::CloseBrace | Kind::Semicolon)
        || target(parser, 1).is_some()
        || is_typed
}

/// Parses the statements of one side of an `if`: in braces, a single one, or another `if`.
fn branch(parser: &mut Parser<'_>) -> Option<Statements> {
    if parser.kind() == Kind::OpenBrace {
        return body(parser, "statements in braces", "if a > b { z = a } else { z = b }");
    }
    let mark = parser.lists.len();
    parser.ast.record(NameEvent::Opens);
    let parsed = statement(parser);
    parser.ast.record(NameEvent::Closes(parser.end_before));
    match parsed {
        Parsed::Statement(id) => {
            parser.eat(Kind::Semicolon);
            parser.lists.push(id.0);
            let (first, count) = parser.move_list(mark);
            Some(Statements { first, count })
        }
        Parsed::Choice(_) | Parsed::Nothing => {
            parser.report_missing("statements in braces", "write `if a > b { z = a } else { z = b }`");
            None
        }
    }
}

/// Parses `{ statement… }`. `None` if a mistake was reported.
fn body(parser: &mut Parser<'_>, what: &str, example: &str) -> Option<Statements> {
    let open = parser.token().span;
    if !parser.eat(Kind::OpenBrace) {
        parser.report_missing(what, format!("write `{example}`"));
        return None;
    }
    if parser.nesting >= parser.nesting_max {
        parser.too_deep();
        return None;
    }
    parser.nesting += 1;
    let mark = parser.lists.len();
    parser.ast.record(NameEvent::Opens);
    let choice = parser.within(false, statements);
    parser.ast.record(NameEvent::Closes(parser.end_before));
    parser.nesting -= 1;
    let (first, count) = parser.move_list(mark);
    if choice.is_some() || parser.kind() != Kind::CloseBrace {
        let wrong = parser.expected("`}` after the statements").note(open, "for this `{`");
        let hint = "these braces hold assignments and no result: `z = a`";
        parser.report(if wrong.hint.is_none() { wrong.hint(hint) } else { wrong });
        parser.skip_until(|_| false);
    }
    parser.eat(Kind::CloseBrace);
    Some(Statements { first, count })
}

enum Parsed {
    Statement(ExprId),
    Choice(ExprId),
    Nothing,
}
