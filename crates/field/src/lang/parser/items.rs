//! Parses items, the top level of a scene.

use super::super::ast::{
    Entry, Expr, ExprId, Function, Item, Name, NameEvent, NameKind, Parameter, Section, Type,
};
use super::super::diagnostic::Diagnostic;
use super::super::suggest;
use super::super::token::{Kind, Token, word};
use super::Parser;

pub(crate) fn is_keyword(name: &str) -> bool {
    item_words().any(|word| word == name)
}

/// Returns the words that begin a part of a scene. They may also be names.
pub fn item_words() -> impl Iterator<Item = &'static str> {
    ["param", "include"].into_iter().chain(Section::ALL.map(|(_, word)| word))
}

/// GLSL types and qualifiers that people write out of habit.
const GLSL_TYPES: &[&str] = &[
    "float", "int", "uint", "bool", "double", "vec2", "vec3", "vec4", "mat2", "mat3", "mat4", "var", "void",
];
const GLSL_QUALIFIERS: &str = "const uniform varying attribute inout out highp mediump lowp flat precision";
/// True for a GLSL type or qualifier.
pub(in crate::lang) fn declares_glsl(word: &str) -> bool {
    GLSL_TYPES.contains(&word) || GLSL_QUALIFIERS.split(' ').any(|qualifier| qualifier == word)
}

/// Maximum number of words before a declared name, such as `const highp float`.
const GLSL_WORDS_MAX: usize = 4;

/// Returns the word here if it begins an item: a name, a text or an opening brace follows.
pub(super) fn keyword(parser: &Parser<'_>) -> Option<&'static str> {
    let token = parser.token();
    let next = parser.ahead(1);
    if !token.is_name() || !matches!(next.kind, Kind::Name | Kind::Text | Kind::OpenBrace) {
        return None;
    }
    let text = parser.names.name(token.symbol);
    item_words().find(|word| *word == text)
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Habit {
    /// The text does not look like GLSL, or only `return` was skipped.
    None,
    /// The rest of the declaration is parsed as if it followed a `let`.
    Let,
    Skipped,
}

impl Parser<'_> {
    pub(super) fn items(&mut self) -> Vec<Item> {
        let mut items = Vec::new();
        while self.kind() != Kind::End && !self.diagnostics.full() {
            let start = self.at;
            if self.eat(Kind::Semicolon) {
                continue;
            }
            self.ast.record(NameEvent::Item(self.token().span.start));
            if let Some(item) = self.item() {
                self.ast.record(NameEvent::EndOfItem(self.end_before));
                items.push(item);
            } else {
                self.skip_until(|parser| parser.token().newline && parser.token().is_word(word::LET));
                if matches!(self.kind(), Kind::CloseParen | Kind::CloseBrace) {
                    let message = format!("{} has no opening bracket", self.found());
                    self.report(Diagnostic::new(self.token().span, message).hint("leave it out"));
                    self.advance();
                }
            }
            if self.at == start {
                self.advance();
            }
        }
        items
    }

    fn item(&mut self) -> Option<Item> {
        match keyword(self) {
            None => {}
            Some("param") => return self.param(),
            Some("include") => return self.include(),
            Some(word) => return self.section(Section::named(word)?),
        }
        if self.eat_word(word::FN) {
            return self.function();
        }
        if self.eat_word(word::LET) {
            return self.binding().map(|(name, value)| Item::Let { name, value });
        }
        match self.glsl_habit() {
            Habit::None => {}
            Habit::Let => return self.binding().map(|(name, value)| Item::Let { name, value }),
            Habit::Skipped => return None,
        }
        let token = self.token();
        let next = self.ahead(1);
        if token.is_name() && !next.newline && (next.is_name() || next.kind == Kind::OpenBrace) {
            let typed = self.names.name(token.symbol);
            let known = item_words().chain(["fn", "let"]);
            let unknown = Diagnostic::new(token.span, format!("{} is not a keyword", self.found()));
            let near = suggest::nearest(typed, known);
            self.report(if typed == "struct" {
                unknown.hint("a function returns several values by names: `(near = a, index = b)`")
            } else {
                let keywords = "keywords are `object`, `material`, `light`, `medium`, `swarm`, `camera`, `sky`, \
                     `picture`, `about`, `param`, `include`, `fn` and `let`";
                unknown.hint(keywords).did_you_mean(near)
            });
            self.advance();
            return None;
        }
        if matches!(token.kind, Kind::CloseParen | Kind::CloseBrace) {
            return None;
        }
        let value = self.expression();
        let next = self.token();
        if next.kind != Kind::End && next.kind != Kind::Semicolon && !next.newline {
            self.report_expected("an operator or the end of the expression");
            self.skip_until(|parser| parser.token().newline && parser.token().is_word(word::LET));
        }
        Some(Item::Bare(value))
    }

    /// Consumes a name that is not reserved, or reports that `what` is expected.
    pub(super) fn name(&mut self, what: &str) -> Option<Name> {
        let token = self.token();
        if token.is_name() {
            self.advance();
            return Some(Name { symbol: token.symbol, span: token.span });
        }
        if token.is_reserved() {
            self.report_missing(what, "this word is reserved: choose another name");
        } else {
            self.report_expected(what);
        }
        None
    }

    pub(super) fn binding(&mut self) -> Option<(Name, ExprId)> {
        let name = self.name("a name after `let`").filter(|_| self.demand(Kind::Assign, "after the name"));
        let Some(name) = name else {
            self.skip_line();
            return None;
        };
        let value = self.expression();
        self.ast.record(NameEvent::Declares(NameKind::Let, name));
        self.end_of_entry();
        Some((name, value))
    }

    pub(super) fn end_of_entry(&mut self) {
        let kind = self.kind();
        let hint = match kind {
            Kind::Comma => "separate entries by a line end, a space or `;`",
            Kind::CloseParen if !self.in_parens => "it has no matching `(`",
            Kind::Assign => "`=` gives a name its value; to compare write `==`",
            _ => return,
        };
        self.report_missing("the end of the expression", hint);
        if kind == Kind::Assign {
            self.skip_line();
        } else {
            self.advance();
        }
    }

    fn skip_line(&mut self) {
        self.skip_until(|parser| parser.token().newline || parser.kind() == Kind::Semicolon);
    }

    /// Recognizes GLSL's declarations and `return`, and reports how to write them in this language.
    pub(super) fn glsl_habit(&mut self) -> Habit {
        let (token, next) = (self.token(), self.ahead(1));
        if !token.is_name() {
            return Habit::None;
        }
        let text = self.names.name(token.symbol);
        if text == "return" && !matches!(next.kind, Kind::Assign | Kind::Dot) {
            let unknown = Diagnostic::unsupported(token.span, "there is no `return`");
            self.report(unknown.hint("the last expression of a block is its value"));
            self.advance();
            return Habit::None;
        }
        // Qualifiers and types precede the name, as in `const float name`.
        let is_type = |token: Token| token.is_name() && declares_glsl(self.names.name(token.symbol));
        let words = (0..GLSL_WORDS_MAX).take_while(|at| is_type(self.ahead(*at))).count();
        let named = self.ahead(words);
        if words == 0 || !named.is_name() {
            return Habit::None;
        }
        let name = self.names.name(named.symbol);
        let is_function = self.ahead(words + 1).kind == Kind::OpenParen;
        let hint = match is_function {
            true if matches!(name, "main" | "mainImage") => {
                "leave it out: a scene is a distance, and Mariana traces its rays".to_owned()
            }
            true => format!("write `fn {name}(p) {{ … }}`"),
            false if text == "uniform" => format!("declare a slider: `param {name} = 0.5 in 0 .. 1`"),
            false => format!("write `let {name} = …`"),
        };
        let unknown = Diagnostic::unsupported(token.span, "a declaration does not begin with a type");
        self.report(unknown.hint(hint));
        for _ in 0..words {
            self.advance();
        }
        if self.begins_assignment() {
            return Habit::Let;
        }
        self.advance();
        self.skip_line();
        Habit::Skipped
    }

    fn param(&mut self) -> Option<Item> {
        self.advance();
        let name = self.name("the parameter's name")?;
        self.ast.record(NameEvent::Declares(NameKind::Param, name));
        if !self.demand(Kind::Assign, "and the parameter's default") {
            return self.broken(name);
        }
        let value = self.expression();
        let mut range = None;
        if self.eat_word(word::IN) {
            let first = self.expression();
            if !self.eat(Kind::Range) {
                let hint = "write a parameter as `param melt = 1.3 in 0.1 .. 3`";
                self.report_missing("`..` and the parameter's largest value", hint);
                return self.broken(name);
            }
            range = Some((first, self.expression()));
        }
        Some(Item::Param { name, value, range })
    }

    fn broken(&mut self, name: Name) -> Option<Item> {
        self.skip_until(|parser| parser.token().newline && parser.kind() == Kind::Name);
        while matches!(self.kind(), Kind::CloseParen | Kind::CloseBrace) {
            self.advance();
            self.skip_until(|parser| parser.token().newline && parser.kind() == Kind::Name);
        }
        Some(Item::Broken(name))
    }

    fn include(&mut self) -> Option<Item> {
        self.advance();
        let token = self.token();
        if token.kind != Kind::Text {
            self.report_missing("a file's name in quotes", "write `include \"shapes.scene\"`");
            return None;
        }
        self.advance();
        let path = Name { symbol: token.symbol, span: token.span };
        self.ast.record(NameEvent::Includes(path));
        Some(Item::Include { path })
    }

    fn function(&mut self) -> Option<Item> {
        let name = self.name("the function's name")?;
        self.ast.record(NameEvent::Declares(NameKind::Function, name));
        self.ast.record(NameEvent::Opens);
        let open = self.token().span;
        if !self.demand(Kind::OpenParen, "and the function's parameters") {
            return self.broken(name);
        }
        let mut parameters = Vec::new();
        while self.kind() != Kind::CloseParen {
            let Some(parameter) = self.parameter() else { return self.broken(name) };
            parameters.push(parameter);
            if !self.eat(Kind::Comma) {
                break;
            }
        }
        if !self.eat(Kind::CloseParen) {
            self.report(self.expected("`,` or `)`").note(open, "for this `(`"));
            return self.broken(name);
        }
        let body = if self.kind() == Kind::OpenBrace {
            self.block()
        } else if self.eat(Kind::Assign) {
            self.expression()
        } else {
            self.report_missing("the function's body", "write `fn f(p) { … }` or `fn f(p) = …`");
            return self.broken(name);
        };
        self.ast.record(NameEvent::Closes(self.end_before));
        Some(Item::Fn(Function { name, parameters, body }))
    }

    fn parameter(&mut self) -> Option<Parameter> {
        if self.token().is_word(word::IN) {
            let unknown = Diagnostic::unsupported(self.token().span, "every parameter is an `in`");
            self.report(unknown.hint("write its name alone, as in `fn f(p)`"));
            self.advance();
            if self.ahead(1).is_name() && GLSL_TYPES.contains(&self.names.name(self.token().symbol)) {
                self.advance();
            }
        }
        let token = self.token();
        if token.is_name() && self.ahead(1).is_name() && GLSL_TYPES.contains(&self.names.name(token.symbol)) {
            let (of, name) = (self.names.name(token.symbol), self.names.name(self.ahead(1).symbol));
            let unknown = Diagnostic::unsupported(token.span, "a parameter's type follows its name");
            let hint = format!("write `{name}: {of}`, or just `{name}`");
            self.report(unknown.hint(hint));
            self.advance();
        }
        let name = self.name("a parameter's name")?;
        self.ast.record(NameEvent::Declares(NameKind::FunctionParameter, name));
        if !self.eat(Kind::Colon) {
            return Some(Parameter { name, of: None });
        }
        let of = self.name("the parameter's type")?;
        let text = self.names.name(of.symbol);
        let known = Type::ALL.iter().find(|one| one.name() == text).copied();
        if known.is_none() {
            let unknown = Diagnostic::new(of.span, format!("there is no type `{text}`"));
            let near = suggest::nearest(text, Type::ALL.iter().map(|one| one.name()));
            let unknown = unknown.hint("types are number, bool, vec2, vec3, vec4, mat2, mat3 and texture");
            self.diagnostics.push(unknown.did_you_mean(near));
        }
        Some(Parameter { name, of: known })
    }

    fn section(&mut self, section: Section) -> Option<Item> {
        let word = self.names.name(self.token().symbol);
        let head = self.advance().span;
        let mut name = None;
        if section == Section::Camera {
            name = if self.token().is_name() { self.name("a name") } else { None };
        } else if !matches!(section, Section::Sky | Section::Picture | Section::About) {
            if self.kind() == Kind::OpenBrace {
                self.report_missing("a name", format!("each {word} has a name: `{word} first {{ … }}`"));
            }
            name = Some(self.name("a name")?);
        } else if self.token().is_name() {
            self.report_missing("`{`", "`sky`, `picture` and `about` have no names: a scene has one of each");
            self.advance();
        }
        let span = self.since(head);
        let open = self.token().span;
        if !self.demand(Kind::OpenBrace, "and the fields") {
            return name.and_then(|name| self.broken(name));
        }
        if let Some(name) = name {
            self.ast.record(NameEvent::Declares(NameKind::Section(section), name));
        }
        self.ast.record(NameEvent::Opens);
        let (mut entries, mut broken) = (Vec::new(), false);
        loop {
            while self.eat(Kind::Semicolon) {}
            let token = self.token();
            if matches!(token.kind, Kind::CloseBrace | Kind::End) || (token.newline && self.begins_item()) {
                break;
            }
            if self.eat_word(word::LET) {
                if let Some((name, value)) = self.binding() {
                    entries.push(Entry { is_let: true, name, value, end: None });
                }
            } else if token.is_name() && self.ahead(1).kind == Kind::Assign {
                self.advance();
                self.advance();
                let name = Name { symbol: token.symbol, span: token.span };
                self.ast.record(NameEvent::Field(section, name));
                let value = self.expression();
                let end = self.eat(Kind::Range).then(|| self.expression());
                entries.push(Entry { is_let: false, name, value, end });
                if self.ast.expr(value) == Expr::Error { self.skip_to_field() } else { self.end_of_entry() }
            } else if self.kind() == Kind::Comma {
                self.report_missing("a field", "separate fields by a line end, a space or `;`");
                self.advance();
            } else {
                broken = true;
                self.report_missing("a field, as in `name = value`", "a block ends with `}`");
                self.advance();
                self.skip_to_field();
            }
        }
        if !self.eat(Kind::CloseBrace) {
            self.report(self.expected("`}`").note(open, "for this `{`"));
        }
        self.ast.record(NameEvent::Closes(self.end_before));
        Some(Item::Section { section, name, span, entries, broken })
    }

    fn skip_to_field(&mut self) {
        while self.kind() != Kind::End {
            self.skip_until(|parser| parser.kind() == Kind::Semicolon || parser.begins_assignment());
            if self.kind() != Kind::CloseParen {
                return;
            }
            self.advance();
        }
    }
}
