//! Splits GLSL into tokens, and drops comments.

use super::Result;
use crate::lang::{Diagnostic, Span};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Kind {
    Word,
    #[default]
    Number,
    Sign,
}

/// One token. The text is a slice of the source or a constant. For a token from a macro, `start` and `end`
/// locate the macro's call.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Token<'a> {
    pub text: &'a str,
    pub kind: Kind,
    pub start: u32,
    pub end: u32,
    /// The token is the first on its line.
    pub begins_line: bool,
    /// True if the token directly follows the previous token. In the definition of a macro, a `(` that directly follows
    /// the name begins parameters.
    pub joined: bool,
    /// The name of a macro that must not be expanded again.
    pub final_name: bool,
}

impl<'a> Token<'a> {
    pub(super) fn place(&self) -> Span {
        Span::new(self.start, self.end)
    }

    /// Returns a token that is not in the text, with the location of this token.
    pub(super) fn made(self, text: &'a str, kind: Kind) -> Self {
        Self { text, kind, ..self }
    }

    pub(super) fn is(&self, text: &str) -> bool {
        self.text == text
    }

    pub(super) fn is_word(&self) -> bool {
        self.kind == Kind::Word
    }
}

const LONG_SIGNS: [&str; 23] = [
    "<<=", ">>=", "##", "++", "--", "<<", ">>", "<=", ">=", "==", "!=", "&&", "||", "^^", "+=", "-=", "*=",
    "/=", "%=", "&=", "|=", "^=", "\\",
];

/// Returns the tokens of a text. Lines that end in `\` are joined.
pub(super) fn tokenize(text: &str, tokens_max: usize) -> Result<Vec<Token<'_>>> {
    let bytes = text.as_bytes();
    let mut tokens = Vec::new();
    let (mut at, mut begins_line, mut joined) = (0, true, false);
    while let Some(&byte) = bytes.get(at) {
        let rest = bytes.get(at..).unwrap_or_default();
        let start = at;
        if byte.is_ascii_whitespace() || rest.starts_with(b"\xEF\xBB\xBF") || byte == 0x0B {
            begins_line |= byte == b'\n';
            joined = false;
            at += if byte == 0xEF { 3 } else { 1 };
            continue;
        }
        if byte == b'\\' {
            // The line continues on the next line: skip the end of the line.
            let blank = rest.iter().skip(1).take_while(|byte| matches!(byte, b' ' | b'\t' | b'\r')).count();
            if rest.get(1 + blank) == Some(&b'\n') {
                joined = false;
                at += 2 + blank;
                continue;
            }
        }
        if rest.starts_with(b"//") {
            at += rest.iter().take_while(|&&byte| byte != b'\n').count();
            continue;
        }
        if rest.starts_with(b"/*") {
            let Some(end) = text.get(at + 2..).and_then(|rest| rest.find("*/")) else {
                let place = Span::new(at as u32, at as u32 + 2);
                return Err(Diagnostic::new(place, "this comment has no end").hint("close it with `*/`"));
            };
            at += end + 4;
            joined = false;
            continue;
        }
        let kind = if byte.is_ascii_alphabetic() || byte == b'_' {
            at += rest.iter().take_while(|byte| byte.is_ascii_alphanumeric() || **byte == b'_').count();
            Kind::Word
        } else if byte.is_ascii_digit() || (byte == b'.' && rest.get(1).is_some_and(u8::is_ascii_digit)) {
            at += number_length(rest);
            Kind::Number
        } else if byte == b'"' {
            at += 1 + rest.iter().skip(1).take_while(|&&byte| byte != b'"' && byte != b'\n').count();
            at = (at + usize::from(bytes.get(at) == Some(&b'"'))).min(bytes.len());
            Kind::Sign
        } else if byte.is_ascii_graphic() {
            let long = LONG_SIGNS.iter().find(|sign| rest.starts_with(sign.as_bytes()));
            at += long.map_or(1, |sign| sign.len());
            Kind::Sign
        } else {
            let character = text.get(at..).and_then(|rest| rest.chars().next()).unwrap_or('\u{fffd}');
            let length = character.len_utf8() as u32;
            let message = format!("GLSL has no character `{}`", character.escape_default());
            let problem = Diagnostic::new(Span::new(at as u32, at as u32 + length), message);
            return Err(problem.hint("remove it, or put it into a comment"));
        };
        let Some(word) = text.get(start..at) else { break };
        let (start, end) = (start as u32, at as u32);
        if tokens.len() >= tokens_max {
            let message = format!("the GLSL has more than {tokens_max} words and signs");
            return Err(
                Diagnostic::over_limit(Span::new(start, end), message).hint("split it into several files")
            );
        }
        tokens.push(Token { text: word, kind, start, end, begins_line, joined, final_name: false });
        begins_line = false;
        joined = true;
    }
    Ok(tokens)
}

/// Length of the number at the start. A second point ends it: naga reads `0.5.x.x` as a number and components, whose
/// nesting is limited.
fn number_length(bytes: &[u8]) -> usize {
    let count = |from: usize, belongs: fn(&u8) -> bool| {
        bytes.iter().skip(from).take_while(|byte| belongs(byte)).count()
    };
    let mut length = count(0, u8::is_ascii_digit);
    if bytes.get(length) == Some(&b'.') {
        length += 1;
        length += count(length, u8::is_ascii_digit);
    }
    if let Some(b'e' | b'E') = bytes.get(length) {
        let sign = usize::from(matches!(bytes.get(length + 1), Some(b'+' | b'-')));
        length += 1 + sign;
    }
    length + count(length, u8::is_ascii_alphanumeric)
}
