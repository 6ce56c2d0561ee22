//! The preprocessor: directives, and macros with and without parameters.
//!
//! Tokens from a macro have the position of the macro's call, so that messages point to the user's line.
//! Work is counted: macros that expand without end, or to nothing very often, end in a message.

use std::collections::HashMap;
use std::rc::Rc;

use super::Result;
use super::items::shortened;
use super::tokens::{Kind, Token};
use crate::lang::Diagnostic;
use crate::limits::GLSL_MACRO_PARAMETERS_MAX;
use crate::limits::LIMITS;

#[derive(Debug, Clone)]
struct Macro<'a> {
    parameters: Option<Vec<&'a str>>,
    body: Rc<[Token<'a>]>,
}

/// Definitions before the text, such as the functions of ISF.
pub(super) const PRELUDE: &str = "\
#define GL_ES 1
#define __VERSION__ 300
#define GL_FRAGMENT_PRECISION_HIGH 1
#define HW_PERFORMANCE 1
#define GL_OES_standard_derivatives 1
#define IMG_NORM_PIXEL(image, at) texture(image, at)
#define IMG_PIXEL(image, at) texture(image, (at) / RENDERSIZE)
#define IMG_THIS_PIXEL(image) texture(image, isf_FragNormCoord)
#define IMG_THIS_NORM_PIXEL(image) texture(image, isf_FragNormCoord)
#define IMG_NORM_THIS_PIXEL(image) texture(image, isf_FragNormCoord)
#define IMG_SIZE(image) RENDERSIZE
";

/// Maximum nesting of macro calls in arguments, of parentheses in `#if`, and of `#if` itself.
const NESTING_MAX: usize = 48;

struct Preprocessor<'a> {
    macros: HashMap<&'a str, Macro<'a>>,
    out: Vec<Token<'a>>,
    steps: usize,
    steps_max: usize,
}

/// A condition: `taken` if this branch is read, `done` if some branch was read.
struct Condition<'a> {
    begin: Token<'a>,
    outer: bool,
    taken: bool,
    done: bool,
}

/// Executes the directives of a text and expands its macros. At most `steps_max` tokens are read and written.
pub(super) fn preprocess<'a>(tokens: &[Token<'a>], steps_max: usize) -> Result<Vec<Token<'a>>> {
    let mut this = Preprocessor { macros: HashMap::new(), out: Vec::new(), steps: 0, steps_max };
    let mut conditions: Vec<Condition<'a>> = Vec::new();
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        // A directive ends with its line; the text up to the next directive is expanded at once, because the
        // arguments of a macro may span lines.
        let is_directive = |token: &Token<'_>| token.begins_line && token.is("#");
        if is_directive(token) {
            let rest = tokens.get(at + 1..).unwrap_or_default();
            let length = rest.iter().take_while(|token| !token.begins_line).count();
            let line = rest.get(..length).unwrap_or_default();
            this.directive(line, &mut conditions)?;
            at += 1 + length;
            continue;
        }
        let rest = tokens.get(at..).unwrap_or_default();
        let length = rest.iter().take_while(|token| !is_directive(token)).count().max(1);
        if conditions.last().is_none_or(|condition| condition.taken)
            && let Some(text) = rest.get(..length)
        {
            let expanded = this.expand(text.to_vec(), 0)?;
            this.out.extend(expanded);
        }
        at += length;
    }
    let Some(open) = conditions.last() else { return Ok(this.out) };
    Err(Diagnostic::new(open.begin.place(), "this `#if` has no `#endif`").hint("end it with `#endif`"))
}

impl<'a> Preprocessor<'a> {
    fn step(&mut self, token: &Token<'a>) -> Result<()> {
        self.steps += 1;
        if self.steps > self.steps_max {
            let message = format!("the macros expand to more than {} words and signs", self.steps_max);
            return Err(Diagnostic::over_limit(token.place(), message)
                .hint("make this macro a function, or let it use fewer macros"));
        }
        Ok(())
    }

    fn directive(&mut self, line: &[Token<'a>], conditions: &mut Vec<Condition<'a>>) -> Result<()> {
        let Some((name, rest)) = line.split_first() else { return Ok(()) };
        let active = conditions.last().is_none_or(|condition| condition.taken);
        match name.text {
            "if" | "ifdef" | "ifndef" => {
                if conditions.len() >= NESTING_MAX {
                    let message = format!("`#if` is nested deeper than {NESTING_MAX} levels");
                    return Err(Diagnostic::over_limit(name.place(), message).hint("remove some of them"));
                }
                let holds = active
                    && match name.text {
                        "if" => self.condition(rest, *name)?,
                        "ifdef" => self.is_defined(rest),
                        _ => !self.is_defined(rest),
                    };
                conditions.push(Condition { begin: *name, outer: active, taken: holds, done: holds });
            }
            "elif" | "else" | "endif" => {
                let Some(mut condition) = conditions.pop() else {
                    let message = format!("this `#{}` has no `#if`", name.text);
                    return Err(Diagnostic::new(name.place(), message).hint("remove it"));
                };
                if name.is("endif") {
                    return Ok(());
                }
                let may = condition.outer && !condition.done;
                let holds = may && (name.is("else") || self.condition(rest, *name)?);
                condition.taken = holds;
                condition.done |= holds;
                conditions.push(condition);
            }
            _ if !active => {}
            "define" => self.define(*name, rest)?,
            "undef" => {
                if let Some(of) = rest.first() {
                    self.macros.remove(of.text);
                }
            }
            "error" => {
                return Err(Diagnostic::new(name.place(), "the GLSL refuses to be compiled with `#error`")
                    .hint("define what it asks for, or remove the line"));
            }
            "include" => {
                let file: String = rest.iter().map(|token| token.text).collect();
                let file = shortened(&file);
                let message =
                    format!("the file {file} is not in the folder of this shader, or cannot be read");
                return Err(Diagnostic::unsupported(name.place(), message).hint(format!(
                    "put it there as text, or paste its text here; a shader includes at most {} files, {} deep",
                    LIMITS.scene_includes_max, LIMITS.include_depth_max
                )));
            }
            // Versions, extensions and the directives of viewers change nothing here.
            _ => {}
        }
        Ok(())
    }

    fn is_defined(&self, rest: &[Token<'a>]) -> bool {
        rest.first().is_some_and(|of| self.macros.contains_key(of.text))
    }

    fn define(&mut self, define: Token<'a>, rest: &[Token<'a>]) -> Result<()> {
        let Some((name, rest)) = rest.split_first().filter(|(name, _)| name.is_word()) else {
            let hint = "write `#define NAME value`";
            return Err(Diagnostic::new(define.place(), "`#define` needs a name").hint(hint));
        };
        if let Some(paste) = rest.iter().find(|token| token.is("##") || token.is("#")) {
            return Err(Diagnostic::unsupported(paste.place(), "macros cannot join words with `##`")
                .hint("write the words out"));
        }
        let takes = rest.first().is_some_and(|token| token.is("(") && token.joined);
        let (parameters, body) = if takes {
            let Some(close) = rest.iter().position(|token| token.is(")")) else {
                return Err(Diagnostic::new(name.place(), "the parameters of this macro have no `)`")
                    .hint("close them on the same line"));
            };
            let names = rest.get(1..close).unwrap_or_default().iter();
            let names: Vec<&str> = names.filter(|token| !token.is(",")).map(|token| token.text).collect();
            if names.len() > GLSL_MACRO_PARAMETERS_MAX {
                let message = format!("this macro has more than {GLSL_MACRO_PARAMETERS_MAX} parameters");
                return Err(Diagnostic::over_limit(name.place(), message).hint("make it a function"));
            }
            (Some(names), rest.get(close + 1..).unwrap_or_default())
        } else {
            (None, rest)
        };
        self.macros.insert(name.text, Macro { parameters, body: Rc::from(body) });
        Ok(())
    }

    /// Expands all macros in a list of tokens.
    fn expand(&mut self, tokens: Vec<Token<'a>>, depth: usize) -> Result<Vec<Token<'a>>> {
        // The unread tokens, the next one last. `active` holds the open macros; a macro ends when this list is as short as
        // its number.
        let mut left: Vec<Token<'a>> = tokens;
        left.reverse();
        let mut active: Vec<(&'a str, usize)> = Vec::new();
        let mut out = Vec::new();
        while let Some(mut token) = left.pop() {
            self.step(&token)?;
            while active.last().is_some_and(|(_, length)| left.len() < *length) {
                active.pop();
            }
            let may_be_macro = token.is_word() && !token.final_name;
            let Some(of) = self.macros.get(token.text).filter(|_| may_be_macro).cloned() else {
                out.push(token);
                continue;
            };
            if active.iter().any(|(name, _)| *name == token.text) {
                token.final_name = true;
                out.push(token);
                continue;
            }
            if active.len() >= 4 * NESTING_MAX {
                let message = format!("macros use each other more than {} deep", 4 * NESTING_MAX);
                let hint = "make some of them functions";
                return Err(Diagnostic::over_limit(token.place(), message).hint(hint));
            }
            let body = match &of.parameters {
                None => of.body.to_vec(),
                Some(parameters) => {
                    if left.last().is_none_or(|next| !next.is("(")) {
                        out.push(token);
                        continue;
                    }
                    let arguments = self.arguments(&token, &mut left, depth)?;
                    let given = if parameters.is_empty() { 0 } else { arguments.len() };
                    if given != parameters.len() {
                        let (takes, name) = (parameters.len(), token.text);
                        let message = format!("the macro `{name}` takes {takes} arguments, not {given}");
                        return Err(Diagnostic::new(token.place(), message)
                            .hint("give it as many as its `#define` names"));
                    }
                    self.substitute(&of.body, parameters, &arguments, &token)?
                }
            };
            let floor = left.len();
            while active.last().is_some_and(|(_, length)| floor < *length) {
                active.pop();
            }
            active.push((token.text, floor));
            for part in body.iter().rev() {
                self.step(&token)?;
                left.push(Token { start: token.start, end: token.end, ..*part });
            }
        }
        Ok(out)
    }

    /// Takes the arguments of a macro's call from `left`, and expands each of them.
    fn arguments(
        &mut self,
        name: &Token<'a>,
        left: &mut Vec<Token<'a>>,
        depth: usize,
    ) -> Result<Vec<Vec<Token<'a>>>> {
        if depth >= NESTING_MAX {
            let message = format!("macro calls are nested deeper than {NESTING_MAX} levels");
            return Err(Diagnostic::over_limit(name.place(), message).hint("make this macro a function"));
        }
        left.pop();
        let (mut arguments, mut open) = (vec![Vec::new()], 1);
        while let Some(token) = left.pop() {
            self.step(&token)?;
            match token.text {
                "(" | "[" => open += 1,
                ")" | "]" => open -= 1,
                _ => {}
            }
            if open == 0 {
                let arguments = arguments.into_iter().map(|one| self.expand(one, depth + 1));
                return arguments.collect();
            }
            match arguments.last_mut() {
                Some(_) if open == 1 && token.is(",") => arguments.push(Vec::new()),
                Some(last) => last.push(token),
                None => {}
            }
        }
        let message = format!("the arguments of the macro `{}` have no `)`", name.text);
        Err(Diagnostic::new(name.place(), message).hint("close them before the next `#` line"))
    }

    fn substitute(
        &mut self,
        body: &[Token<'a>],
        parameters: &[&'a str],
        arguments: &[Vec<Token<'a>>],
        call: &Token<'a>,
    ) -> Result<Vec<Token<'a>>> {
        let mut out = Vec::new();
        for token in body {
            let argument = parameters.iter().position(|name| token.is_word() && token.is(name));
            match argument.and_then(|index| arguments.get(index)) {
                Some(argument) => {
                    for part in argument {
                        self.step(call)?;
                        out.push(*part);
                    }
                }
                None => out.push(*token),
            }
        }
        Ok(out)
    }

    fn condition(&mut self, line: &[Token<'a>], of: Token<'a>) -> Result<bool> {
        // `defined` reads names before they are expanded.
        let mut read = Vec::new();
        let mut at = 0;
        while let Some(token) = line.get(at) {
            at += 1;
            if !token.is("defined") {
                read.push(*token);
                continue;
            }
            let open = line.get(at).is_some_and(|token| token.is("("));
            at += usize::from(open);
            let known = line.get(at).is_some_and(|name| self.macros.contains_key(name.text));
            at += 1 + usize::from(open);
            read.push(token.made(if known { "1" } else { "0" }, Kind::Number));
        }
        let expanded = self.expand(read, 0)?;
        let mut reader = Conditional { tokens: &expanded, at: 0, of };
        let value = reader.binary(0, 0)?;
        Ok(value != 0)
    }
}

/// Evaluates the whole-number expression of an `#if`.
struct Conditional<'t, 'a> {
    tokens: &'t [Token<'a>],
    at: usize,
    of: Token<'a>,
}

/// An operator of conditions: the sign, how tightly it binds, and the result.
type Operator = (&'static str, u8, fn(i64, i64) -> i64);

const OPERATORS: [Operator; 18] = [
    ("||", 1, |a, b| i64::from(a != 0 || b != 0)),
    ("&&", 2, |a, b| i64::from(a != 0 && b != 0)),
    ("|", 3, |a, b| a | b),
    ("^", 4, |a, b| a ^ b),
    ("&", 5, |a, b| a & b),
    ("==", 6, |a, b| i64::from(a == b)),
    ("!=", 6, |a, b| i64::from(a != b)),
    ("<", 7, |a, b| i64::from(a < b)),
    (">", 7, |a, b| i64::from(a > b)),
    ("<=", 7, |a, b| i64::from(a <= b)),
    (">=", 7, |a, b| i64::from(a >= b)),
    ("<<", 8, |a, b| a.checked_shl(b as u32).unwrap_or(0)),
    (">>", 8, |a, b| a.checked_shr(b as u32).unwrap_or(0)),
    ("+", 9, i64::wrapping_add),
    ("-", 9, i64::wrapping_sub),
    ("*", 10, i64::wrapping_mul),
    ("/", 10, |a, b| a.checked_div(b).unwrap_or(0)),
    ("%", 10, |a, b| a.checked_rem(b).unwrap_or(0)),
];

impl Conditional<'_, '_> {
    /// Evaluates an expression whose operators bind at least as tightly as `least`.
    fn binary(&mut self, least: u8, depth: usize) -> Result<i64> {
        let mut left = self.operand(depth)?;
        while let Some(sign) = self.tokens.get(self.at)
            && let Some((_, binds, result)) = OPERATORS.iter().find(|row| sign.is(row.0) && row.1 >= least)
        {
            self.at += 1;
            left = result(left, self.binary(binds + 1, depth)?);
        }
        Ok(left)
    }

    fn operand(&mut self, depth: usize) -> Result<i64> {
        let wrong = |place| {
            Diagnostic::new(place, "this `#if` is no whole-number condition")
                .hint("compare macros and whole numbers, as in `#if QUALITY > 1`")
        };
        let Some(token) = self.tokens.get(self.at).copied() else { return Err(wrong(self.of.place())) };
        self.at += 1;
        if depth >= NESTING_MAX {
            let message = format!("this condition is nested deeper than {NESTING_MAX} levels");
            return Err(Diagnostic::over_limit(token.place(), message).hint("use fewer parentheses"));
        }
        match token.text {
            "!" => Ok(i64::from(self.operand(depth + 1)? == 0)),
            "-" => Ok(self.operand(depth + 1)?.wrapping_neg()),
            "+" => self.operand(depth + 1),
            "~" => Ok(!self.operand(depth + 1)?),
            "(" => {
                let value = self.binary(0, depth + 1)?;
                self.at += 1;
                Ok(value)
            }
            _ if token.is_word() => Ok(0),
            text => {
                let plain = text.trim_end_matches(['u', 'U', 'l', 'L']);
                let value = match plain.strip_prefix("0x").or(plain.strip_prefix("0X")) {
                    Some(digits) => i64::from_str_radix(digits, 16).ok(),
                    None => plain.parse::<i64>().ok().or(plain.parse::<f64>().ok().map(|value| value as i64)),
                };
                value.ok_or_else(|| wrong(token.place()))
            }
        }
    }
}
