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
    pub is_const: bool,
    pub origin: Origin,
}

/// Who sets a global variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Origin {
    /// The GLSL itself.
    Own,
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
    let mut items = Vec::new();
    let mut at = 0;
    while let Some(first) = tokens.get(at) {
        if first.is(";") {
            at += 1;
            continue;
        }
        at += item(tokens.get(at..).unwrap_or_default(), &mut items)?;
    }
    check_structs(&items)?;
    Ok(items)
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

/// Reads one item and returns the number of its tokens, at least 1.
fn item<'a>(tokens: &[Token<'a>], items: &mut Vec<Item<'a>>) -> Result<usize> {
    let Some(first) = tokens.first() else { return Ok(1) };
    let end = |from: usize| {
        let rest = tokens.get(from..).unwrap_or_default();
        from + closing(rest, |token| token.is(";")).map_or(rest.len(), |length| length + 1)
    };
    if first.is("precision") {
        return Ok(end(0));
    }
    let mut start = 0;
    let (mut origin, mut is_const) = (Origin::Own, false);
    while let Some(token) = tokens.get(start) {
        match token.text {
            "layout" => {
                let rest = tokens.get(start + 1..).unwrap_or_default();
                start += 1 + matching(rest);
                continue;
            }
            "uniform" | "buffer" => origin = Origin::Uniform,
            "in" | "varying" | "attribute" => origin = Origin::Varying,
            "out" => origin = Origin::Output,
            "const" => is_const = true,
            word if QUALIFIERS.split(' ').any(|known| known == word) => {}
            _ => break,
        }
        start += 1;
    }
    let Some(of) = tokens.get(start) else { return Ok(tokens.len().max(1)) };
    if of.is(";") {
        return Ok(start + 1);
    }
    if !of.is_word() {
        let message = format!("a declaration cannot begin with `{}`", shortened(of.text));
        return Err(Diagnostic::new(of.place(), message).hint("check the brackets before this line"));
    }
    if of.is("struct") {
        let end = end(start);
        // A struct may declare variables at once.
        let close = (start..end).rfind(|&at| tokens.get(at).is_some_and(|token| token.is("}")));
        let close = close.unwrap_or(end);
        let mut plain = words(tokens.get(start..=close).unwrap_or_default());
        plain.push(of.made(";", Kind::Sign));
        items.push(Item::Plain(plain));
        if let (Some(name), Some(rest)) = (tokens.get(start + 1), tokens.get(close + 1..end)) {
            globals(*name, Vec::new(), rest, is_const, origin, items);
        }
        return Ok(end);
    }
    let after = start + 1;
    if tokens.get(after).is_some_and(|token| token.is("{")) {
        return Ok(block(tokens, start, origin, items));
    }
    let rest = tokens.get(after..).unwrap_or_default();
    let brackets = brackets_length(rest);
    let array = rest.get(..brackets).unwrap_or_default().to_vec();
    let name_at = after + brackets;
    if !tokens.get(name_at).is_some_and(Token::is_word) {
        let found = tokens.get(name_at).unwrap_or(of);
        let message = format!("`{}` begins no declaration", shortened(of.text));
        return Err(Diagnostic::new(of.place().to(found.place()), message)
            .hint("a declaration is a type and a name, such as `float a = 1.0;`"));
    }
    if tokens.get(name_at + 1).is_some_and(|token| token.is("(")) {
        let result: Vec<Token<'a>> = [*of].into_iter().chain(array).collect();
        return Ok(match function(tokens, name_at, result, items) {
            (at, true) => at,
            (at, false) => end(at),
        });
    }
    let end = end(name_at);
    globals(*of, array, tokens.get(name_at..end).unwrap_or_default(), is_const, origin, items);
    Ok(end)
}

/// Reads a function from its name on. Returns the index after it, and whether it has a body.
fn function<'a>(
    tokens: &[Token<'a>],
    name_at: usize,
    result: Vec<Token<'a>>,
    items: &mut Vec<Item<'a>>,
) -> (usize, bool) {
    let Some(name) = tokens.get(name_at) else { return (tokens.len(), true) };
    let parameters = tokens.get(name_at + 1..).unwrap_or_default();
    let close = name_at + 1 + matching(parameters);
    let mut header = result;
    header.extend(words(tokens.get(name_at..close).unwrap_or_default()));
    if tokens.get(close).is_some_and(|brace| brace.is("{")) {
        let body = tokens.get(close..).unwrap_or_default();
        let length = matching(body);
        let body = words(body.get(..length).unwrap_or_default());
        items.push(Item::Function { name: *name, header, body });
        (close + length, true)
    } else {
        header.push(name.made(";", Kind::Sign));
        items.push(Item::Plain(header));
        (close, false)
    }
}

/// Reads an interface block; its members become global variables.
fn block<'a>(tokens: &[Token<'a>], start: usize, origin: Origin, items: &mut Vec<Item<'a>>) -> usize {
    let body = tokens.get(start + 1..).unwrap_or_default();
    let length = matching(body);
    let after = start + 1 + length;
    let members = body.get(1..length.saturating_sub(1)).unwrap_or_default();
    let name = tokens.get(after).filter(|token| token.is_word());
    if let (Some(name), Some(of)) = (name, tokens.get(start)) {
        let mut plain = vec![of.made("struct", Kind::Word), *of];
        plain.extend(words(body.get(..length).unwrap_or_default()));
        plain.push(of.made(";", Kind::Sign));
        items.push(Item::Plain(plain));
        globals(*of, Vec::new(), &[*name], false, origin, items);
    } else {
        for member in members.split(|token| token.is(";")) {
            let member = words(member);
            if let Some((of, rest)) = member.split_first() {
                globals(*of, Vec::new(), rest, false, origin, items);
            }
        }
    }
    let rest = tokens.get(after..).unwrap_or_default();
    after + closing(rest, |token| token.is(";")).map_or(rest.len(), |length| length + 1)
}

/// Reads the names of a declaration, with their arrays and values.
fn globals<'a>(
    of: Token<'a>,
    array: Vec<Token<'a>>,
    names: &[Token<'a>],
    is_const: bool,
    origin: Origin,
    items: &mut Vec<Item<'a>>,
) {
    let mut rest = names;
    while let Some(name) = rest.first().filter(|name| name.is_word()) {
        let own = rest.get(1..).unwrap_or_default();
        let length = closing(own, |token| token.is(",") || token.is(";")).unwrap_or(own.len());
        let own = own.get(..length).unwrap_or_default();
        let equals = own.iter().position(|token| token.is("=")).unwrap_or(own.len());
        let mut brackets = own.get(..equals).unwrap_or_default().to_vec();
        brackets.extend_from_slice(&array);
        let value = words(own.get(equals + 1..).unwrap_or_default());
        items.push(Item::Global(Global { name: *name, of, array: brackets, value, is_const, origin }));
        rest = rest.get(length + 2..).unwrap_or_default();
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
