//! Splits preprocessed tokens into top-level items: structs, functions and global variables.

use std::collections::HashMap;

use super::Result;
use super::layout::PARTS_MAX;
use super::tokens::{Kind, Token};
use crate::lang::Diagnostic;
use crate::limits::{GLSL_NESTING_MAX, GLSL_STRUCT_VALUES_MAX};

#[derive(Debug, Clone)]
pub(super) enum Item<'a> {
    /// A struct or a function without a body: its tokens.
    Plain(Vec<Token<'a>>),
    Function {
        name: Token<'a>,
        /// Result and parameters, up to the closing parenthesis.
        header: Vec<Token<'a>>,
        /// The braces and all between them.
        body: Vec<Token<'a>>,
    },
    Global(Global<'a>),
}

/// One global variable.
#[derive(Debug, Clone)]
pub(super) struct Global<'a> {
    pub name: Token<'a>,
    pub of: Token<'a>,
    /// The brackets after the type and after the name.
    pub array: Vec<Token<'a>>,
    pub value: Vec<Token<'a>>,
    pub origin: Origin,
}

/// Who sets a global variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Origin {
    /// The GLSL itself.
    Own,
    /// The GLSL itself, only once.
    Const,
    /// The program around the shader: a uniform.
    Uniform,
    /// An earlier stage of the shader.
    Varying,
    /// The GLSL itself, as the colour that it draws.
    Output,
}

/// Words in front of a declaration that do not change its type.
const QUALIFIERS: &str = "const uniform in out inout varying attribute flat smooth centroid highp mediump \
    lowp buffer shared invariant noperspective precise static readonly writeonly coherent restrict volatile";

pub(super) fn split<'a>(tokens: &[Token<'a>]) -> Result<Vec<Item<'a>>> {
    check_nesting(tokens)?;
    check_sizes(tokens)?;
    let mut reader = ItemReader { rest: tokens, items: Vec::new() };
    while !reader.rest.is_empty() {
        reader.item()?;
    }
    check_structs(&reader.items)?;
    Ok(reader.items)
}

/// Refuses structs with very many values, which naga and the import visit for each use, and structs that are nested
/// deeply.
fn check_structs(items: &[Item<'_>]) -> Result<()> {
    let mut known: HashMap<&str, (usize, usize)> = HashMap::new();
    for item in items {
        let Item::Plain(tokens) = item else { continue };
        let [first, name, rest @ ..] = tokens.as_slice() else { continue };
        if !first.is("struct") {
            continue;
        }
        let (mut size, mut depth) = (1_usize, 1);
        for member in rest.split(|token| token.is(";") || token.is("{")) {
            let of = member.first().and_then(|of| known.get(of.text)).copied().unwrap_or((1, 0));
            let names = 1 + member.iter().filter(|token| token.is(",")).count();
            size = size.saturating_add(of.0.saturating_mul(names));
            depth = depth.max(of.1 + 1);
        }
        if size > GLSL_STRUCT_VALUES_MAX || depth > GLSL_NESTING_MAX {
            let message = format!(
                "the struct `{}` has more than {GLSL_STRUCT_VALUES_MAX} values or {GLSL_NESTING_MAX} levels",
                shortened(name.text)
            );
            return Err(Diagnostic::over_limit(name.place(), message).hint("nest fewer structs in it"));
        }
        known.insert(name.text, (size, depth));
    }
    Ok(())
}

/// Reads items from the front of a list of tokens.
struct ItemReader<'t, 'a> {
    /// The tokens that are not read yet.
    rest: &'t [Token<'a>],
    items: Vec<Item<'a>>,
}

impl<'t, 'a> ItemReader<'t, 'a> {
    /// Reads one item, at least one token.
    fn item(&mut self) -> Result<()> {
        let mut origin = Origin::Own;
        let of = loop {
            let Some(token) = self.read(1).first() else { return Ok(()) };
            match token.text {
                ";" => return Ok(()),
                "precision" => {
                    self.read_statement();
                    return Ok(());
                }
                "layout" => _ = self.read(matching(self.rest)),
                "uniform" | "buffer" => origin = Origin::Uniform,
                "in" | "varying" | "attribute" => origin = Origin::Varying,
                "out" => origin = Origin::Output,
                "const" => origin = Origin::Const,
                word if QUALIFIERS.split(' ').any(|known| known == word) => {}
                _ => break *token,
            }
        };
        if !of.is_word() {
            let message = format!("a declaration cannot begin with `{}`", shortened(of.text));
            return Err(Diagnostic::new(of.place(), message).hint("check the brackets before this line"));
        }
        if of.is("struct") {
            // A struct may declare variables at once.
            let statement = self.read_statement();
            let close = statement.iter().rposition(|token| token.is("}"));
            let (body, names) = statement.split_at(close.map_or(statement.len(), |at| at + 1));
            self.structure(&[of], body);
            if let Some(name) = body.first() {
                self.globals(*name, &[], names, origin);
            }
            return Ok(());
        }
        if self.rest.first().is_some_and(|token| token.is("{")) {
            self.block(of, origin);
            return Ok(());
        }
        let array = self.read(brackets_length(self.rest));
        let found = self.rest.first();
        if !found.is_some_and(Token::is_word) {
            let place = of.place().to(found.unwrap_or(&of).place());
            let message = format!("`{}` begins no declaration", shortened(of.text));
            return Err(Diagnostic::new(place, message)
                .hint("a declaration is a type and a name, such as `float a = 1.0;`"));
        }
        if self.rest.get(1).is_some_and(|token| token.is("(")) {
            self.function([of].into_iter().chain(array.iter().copied()).collect());
        } else {
            let names = self.read_statement();
            self.globals(of, array, names, origin);
        }
        Ok(())
    }

    /// Reads tokens: as many, or all that are left.
    fn read(&mut self, count: usize) -> &'t [Token<'a>] {
        let (read, rest) = self.rest.split_at(count.min(self.rest.len()));
        self.rest = rest;
        read
    }

    /// Reads up to the next `;` outside of brackets. Returns the tokens before it.
    fn read_statement(&mut self) -> &'t [Token<'a>] {
        let length = closing(self.rest, |token| token.is(";")).unwrap_or(self.rest.len());
        let statement = self.read(length);
        self.read(1);
        statement
    }

    /// Reads a function from its name on. A function without a body ends with `;`.
    fn function(&mut self, result: Vec<Token<'a>>) {
        let [name, parameters @ ..] = self.rest else { return };
        let mut header = result;
        header.extend(words(self.read(1 + matching(parameters))));
        if self.rest.first().is_some_and(|brace| brace.is("{")) {
            let body = words(self.read(matching(self.rest)));
            self.items.push(Item::Function { name: *name, header, body });
        } else {
            self.read_statement();
            header.push(name.made(";", Kind::Sign));
            self.items.push(Item::Plain(header));
        }
    }

    /// Reads an interface block; its members become global variables.
    fn block(&mut self, of: Token<'a>, origin: Origin) {
        let body = self.read(matching(self.rest));
        if let Some(name) = self.read_statement().first().filter(|token| token.is_word()) {
            self.structure(&[of.made("struct", Kind::Word), of], body);
            return self.globals(of, &[], &[*name], origin);
        }
        let members = body.get(1..body.len().saturating_sub(1)).unwrap_or_default();
        for member in members.split(|token| token.is(";")) {
            if let Some((of, rest)) = words(member).split_first() {
                self.globals(*of, &[], rest, origin);
            }
        }
    }

    fn structure(&mut self, head: &[Token<'a>], body: &[Token<'a>]) {
        let mut plain = [head, &words(body)].concat();
        plain.extend(head.first().map(|of| of.made(";", Kind::Sign)));
        self.items.push(Item::Plain(plain));
    }

    /// Reads the names of a declaration, with their arrays and values.
    fn globals(&mut self, of: Token<'a>, array: &[Token<'a>], names: &[Token<'a>], origin: Origin) {
        let mut rest = names;
        while let Some(name) = rest.first().filter(|name| name.is_word()) {
            let own = rest.get(1..).unwrap_or_default();
            let length = closing(own, |token| token.is(",")).unwrap_or(own.len());
            let own = own.get(..length).unwrap_or_default();
            let equals = own.iter().position(|token| token.is("=")).unwrap_or(own.len());
            let array = [own.get(..equals).unwrap_or_default(), array].concat();
            let value = words(own.get(equals + 1..).unwrap_or_default());
            self.items.push(Item::Global(Global { name: *name, of, array, value, origin }));
            rest = rest.get(length + 2..).unwrap_or_default();
        }
    }
}

/// Returns the tokens without qualifiers that naga does not take everywhere.
fn words<'a>(tokens: &[Token<'a>]) -> Vec<Token<'a>> {
    let dropped = |token: &&Token<'_>| {
        !matches!(token.text, "const" | "highp" | "mediump" | "lowp" | "precise" | "static")
    };
    tokens.iter().filter(dropped).copied().collect()
}

/// Number of tokens of the brackets at the start, such as `[3][2]`.
pub(super) fn brackets_length(tokens: &[Token<'_>]) -> usize {
    let mut length = 0;
    while tokens.get(length).is_some_and(|token| token.is("[")) {
        length += matching(tokens.get(length..).unwrap_or_default());
    }
    length
}

/// Number of tokens up to the bracket that closes the first token; all of them if none does.
pub(super) fn matching(tokens: &[Token<'_>]) -> usize {
    let mut open = 0_usize;
    for (at, token) in tokens.iter().enumerate() {
        match token.text {
            "(" | "[" | "{" => open += 1,
            ")" | "]" | "}" => open = open.saturating_sub(1),
            _ => {}
        }
        if open == 0 {
            return at + 1;
        }
    }
    tokens.len()
}

/// Index of the first token outside brackets for which `stops` holds. The bracket around the tokens ends the search, so
/// that a search for each statement does not read the rest of the file.
pub(super) fn closing(tokens: &[Token<'_>], stops: impl Fn(&Token<'_>) -> bool) -> Option<usize> {
    let mut open = 0_usize;
    for (at, token) in tokens.iter().enumerate() {
        if open == 0 && stops(token) {
            return Some(at);
        }
        match token.text {
            "(" | "[" | "{" => open += 1,
            ")" | "]" | "}" => open = open.checked_sub(1)?,
            _ => {}
        }
    }
    None
}

pub(super) fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}

/// Refuses arrays of so many values that naga or a scene cannot hold them.
fn check_sizes(tokens: &[Token<'_>]) -> Result<()> {
    let (mut product, mut end) = (1_u64, 0);
    for (at, three) in tokens.windows(3).enumerate() {
        if let [open, size, close] = three
            && open.is("[")
            && close.is("]")
            && let Ok(size) = size.text.trim_end_matches(['u', 'U']).parse::<u64>()
        {
            product = if end == at { product.saturating_mul(size) } else { size };
            if product > u64::from(PARTS_MAX) {
                let (place, hint) = (open.place().to(close.place()), "make it smaller");
                let message = format!("an array has more than {PARTS_MAX} values");
                return Err(Diagnostic::over_limit(place, message).hint(hint));
            }
            end = at + 3;
        }
    }
    Ok(())
}

/// An open bracket in [`check_nesting`], and the depth of its content's syntax tree.
#[derive(Default)]
struct OpenBracket<'t, 'a> {
    bracket: Option<&'t Token<'a>>,
    /// Operators and branches since the last `,` or `;`.
    operators: usize,
    /// Depth of the current operand: `a.b[c]` is deeper than `a` and deeper than `c`.
    operand: usize,
    /// Depth of the deepest operand since the last `,` or `;`.
    deepest: usize,
    /// Depth of everything before the last `,` or `;`.
    before: usize,
}

impl OpenBracket<'_, '_> {
    fn depth(&self) -> usize {
        self.before.max(self.operators + self.deepest)
    }

    /// Ends an expression, and returns the number of its operators.
    fn end(&mut self) -> usize {
        self.before = self.depth();
        (self.operand, self.deepest) = (0, 0);
        std::mem::take(&mut self.operators)
    }
}

/// Refuses statements that are nested so deeply that a recursive parser might use up its stack, and brackets that do
/// not match.
fn check_nesting(tokens: &[Token<'_>]) -> Result<()> {
    let (mut open, mut level, mut total) = (Vec::new(), OpenBracket::default(), 0_usize);
    for (at, token) in tokens.iter().enumerate() {
        let goes_on = tokens.get(at + 1).is_some_and(|next| next.is("else"));
        match token.text {
            "(" | "[" | "{" => {
                open.push(std::mem::take(&mut level));
                level.bracket = Some(token);
                total += 1;
            }
            ")" | "]" | "}" => {
                let opens = match token.text {
                    ")" => "(",
                    "]" => "[",
                    _ => "{",
                };
                let outer = open.pop().filter(|_| level.bracket.is_some_and(|bracket| bracket.is(opens)));
                let Some(outer) = outer else {
                    let message = format!("this `{}` closes nothing", token.text);
                    return Err(Diagnostic::new(token.place(), message)
                        .hint("check that every bracket is opened and closed"));
                };
                let inner = std::mem::replace(&mut level, outer);
                total -= 1 + inner.operators;
                if !token.is("}") {
                    level.operand = level.operand.max(inner.depth()) + 1;
                } else if !goes_on {
                    total -= level.end();
                }
            }
            "," | ";" if goes_on => {}
            "," | ";" => total -= level.end(),
            "." => level.operand += 1,
            text => {
                let nests = token.kind == Kind::Sign
                    || matches!(text, "if" | "else" | "for" | "while" | "do" | "switch");
                if nests {
                    level.operators += 1;
                    level.operand = 0;
                    total += 1;
                }
            }
        }
        level.deepest = level.deepest.max(level.operand);
        if total + level.deepest > GLSL_NESTING_MAX {
            let message = format!("this statement nests more than {GLSL_NESTING_MAX} operators and brackets");
            let hint = "split it into several statements";
            return Err(Diagnostic::over_limit(token.place(), message).hint(hint));
        }
    }
    let Some(bracket) = level.bracket else { return Ok(()) };
    let message = format!("this `{}` is never closed", bracket.text);
    Err(Diagnostic::new(bracket.place(), message).hint("check that every bracket is opened and closed"))
}
