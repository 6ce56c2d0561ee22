//! Splits a text into tokens. It never fails: unknown text is reported and becomes a token of kind `Unknown`.

use super::diagnostic::{Diagnostic, Diagnostics};
use super::source::{BYTE_ORDER_MARK, Span};
use super::symbol::{Interner, Symbol};
use super::token::{Kind, SIGNS, Token};

/// Appends the tokens of `text`, whose first byte has the offset `base`, and a final `End`. If there are more than
/// `tokens_max` tokens, this is reported and the rest is ignored.
pub(super) fn tokenize(
    text: &str,
    base: u32,
    tokens_max: usize,
    names: &mut Interner,
    tokens: &mut Vec<Token>,
    diagnostics: &mut Diagnostics,
) {
    let mut lexer = Lexer {
        text,
        bytes: text.as_bytes(),
        at: 0,
        base,
        newline: false,
        in_brackets: false,
        names,
        diagnostics,
    };
    if text.starts_with(BYTE_ORDER_MARK) {
        lexer.at = BYTE_ORDER_MARK.len_utf8();
    }
    tokens.reserve((text.len() / 3).min(tokens_max) + 1);
    lexer.run(tokens, tokens_max);
    let end = base + text.len() as u32;
    tokens.push(Token { kind: Kind::End, newline: true, symbol: Symbol(0), span: Span::new(end, end) });
}

struct Lexer<'a> {
    text: &'a str,
    bytes: &'a [u8],
    at: usize,
    base: u32,
    newline: bool,
    /// True after a `[` that was reported, until the next `]`.
    in_brackets: bool,
    names: &'a mut Interner,
    diagnostics: &'a mut Diagnostics,
}

impl Lexer<'_> {
    fn run(&mut self, tokens: &mut Vec<Token>, tokens_max: usize) {
        while let Some(&byte) = self.bytes.get(self.at) {
            let start = self.at;
            let (kind, symbol) = match (byte, self.peek(1)) {
                (b' ' | b'\t' | b'\r' | b'\n', _) => {
                    self.newline |= byte == b'\n';
                    self.at += 1;
                    continue;
                }
                (b'#', _) | (b'/', b'/') => {
                    self.skip_line();
                    continue;
                }
                (b'/', b'*') => {
                    self.skip_block();
                    continue;
                }
                (b'a'..=b'z' | b'A'..=b'Z' | b'_', _) => self.name(),
                (b'0'..=b'9', _) | (b'.', b'0'..=b'9') => self.number(),
                (b'"', _) => self.quoted(),
                _ => (self.sign().unwrap_or_else(|| self.unknown()), Symbol(0)),
            };
            if tokens.len() >= tokens_max {
                return self.too_many(start, tokens_max);
            }
            let newline = std::mem::take(&mut self.newline);
            tokens.push(Token { kind, newline, symbol, span: self.span(start) });
        }
    }

    #[cold]
    fn too_many(&mut self, start: usize, tokens_max: usize) {
        let message = format!("the scene has more than {tokens_max} words and signs");
        let over = Diagnostic::over_limit(self.span(start), message);
        self.diagnostics.push(over.hint("split the scene, or write repeated parts with `fn` and `for`"));
    }

    fn span(&self, start: usize) -> Span {
        Span::new(self.base + start as u32, self.base + self.at as u32)
    }

    /// Returns the byte that is `ahead` bytes after the current one; 0 after the end of the text.
    fn peek(&self, ahead: usize) -> u8 {
        self.bytes.get(self.at + ahead).copied().unwrap_or(0)
    }

    fn skip_line(&mut self) {
        if self.rest().starts_with(b"#define ") {
            self.macro_line();
        }
        self.at += self.rest().iter().take_while(|&&byte| byte != b'\n').count();
    }

    /// Reports a macro, because a comment would hide why its name is unknown.
    #[cold]
    fn macro_line(&mut self) {
        let start = self.at as u32 + self.base;
        let line = self.text.get(self.at..).and_then(|rest| rest.lines().next()).unwrap_or_default();
        let head = line.strip_prefix("#define").unwrap_or_default().trim_start();
        let name: String =
            head.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '_').take(60).collect();
        let hint = match head.get(name.len()..).is_some_and(|rest| rest.starts_with('(')) {
            true => format!("write `fn {name}(a) = …`"),
            false => format!("write `let {name} = …`"),
        };
        let span = Span::new(start, start + "#define".len() as u32);
        let unknown = Diagnostic::unsupported(span, "there are no macros, and `#` begins a comment");
        self.diagnostics.push(unknown.hint(hint));
    }

    fn skip_block(&mut self) {
        let start = self.at;
        let rest = self.text.get(start + 2..).unwrap_or("");
        match rest.find("*/") {
            Some(length) => {
                self.newline |= rest[..length].contains('\n');
                self.at += 2 + length + 2;
            }
            None => {
                self.at += 2;
                let open = Diagnostic::new(self.span(start), "this comment is never closed");
                self.diagnostics.push(open.hint("end it with `*/`, or start it with `#`"));
                self.at = self.bytes.len();
            }
        }
    }

    fn rest(&self) -> &[u8] {
        self.bytes.get(self.at..).unwrap_or(&[])
    }

    fn word_length(&self) -> usize {
        self.rest().iter().take_while(|byte| is_of_word(**byte)).count()
    }

    fn name(&mut self) -> (Kind, Symbol) {
        let start = self.at;
        self.at += self.word_length();
        (Kind::Name, self.names.intern(&self.text[start..self.at]))
    }

    fn digits(&mut self) {
        self.at += self.rest().iter().take_while(|byte| byte.is_ascii_digit()).count();
    }

    fn number(&mut self) -> (Kind, Symbol) {
        let start = self.at;
        self.digits();
        // `0..32` is a range. In `0.`, the point belongs to the number.
        if self.peek(0) == b'.' && self.peek(1) != b'.' {
            self.at += 1;
            self.digits();
        }
        if matches!(self.peek(0), b'e' | b'E') {
            let sign = usize::from(matches!(self.peek(1), b'+' | b'-'));
            if self.peek(1 + sign).is_ascii_digit() {
                self.at += 1 + sign;
                self.digits();
            }
        }
        let end = self.at;
        if is_of_word(self.peek(0)) {
            self.at += self.word_length();
            self.number_in_name(start, end);
        }
        let value: f32 = self.text[start..end].parse().unwrap_or(f32::INFINITY);
        (Kind::Number, Symbol(value.to_bits()))
    }

    #[cold]
    fn number_in_name(&mut self, start: usize, end: usize) {
        let (number, tail) = (&self.text[start..end], &self.text[end..self.at]);
        let hint = match tail {
            "f" | "F" | "u" | "lf" => format!("numbers have no suffix: write `{number}`"),
            _ => format!("to multiply write `{number} * {tail}`"),
        };
        let wrong = Diagnostic::new(self.span(start), "a number runs into a name");
        self.diagnostics.push(wrong.hint(hint));
    }

    fn quoted(&mut self) -> (Kind, Symbol) {
        let start = self.at;
        let rest = &self.text[start + 1..];
        let length = rest.find(['"', '\n']).unwrap_or(rest.len());
        self.at = start + 1 + length;
        let text = rest[..length].trim_end_matches('\r');
        if self.peek(0) != b'"' {
            let open = Diagnostic::new(self.span(start), "this text is never closed");
            self.diagnostics.push(open.hint("end it with `\"` on the same line"));
            return (Kind::Unknown, Symbol(0));
        }
        self.at += 1;
        (Kind::Text, self.names.intern(text))
    }

    fn sign(&mut self) -> Option<Kind> {
        let (sign, kind) = SIGNS.iter().find(|(sign, _)| self.rest().starts_with(sign.as_bytes()))?;
        self.at += sign.len();
        Some(*kind)
    }

    /// Reports a run of unknown characters. A character that looks like a sign is treated as that sign.
    fn unknown(&mut self) -> Kind {
        let start = self.at;
        let rest = &self.text[start..];
        let first = rest.chars().next().unwrap_or('\0');
        let alike = match first {
            '\u{2212}' | '\u{2013}' | '\u{2014}' => {
                Some((Kind::Minus, "write the minus sign of the keyboard, `-`"))
            }
            '\u{d7}' | '\u{b7}' | '\u{22c5}' | '\u{2217}' => Some((Kind::Star, "to multiply write `*`")),
            '\u{f7}' | '\u{2215}' => Some((Kind::Slash, "to divide write `/`")),
            '\u{2264}' => Some((Kind::LessEqual, "write `<=`")),
            '\u{2265}' => Some((Kind::GreaterEqual, "write `>=`")),
            _ => None,
        };
        if let Some((kind, hint)) = alike {
            self.at += first.len_utf8();
            let message = format!("the character `{first}` is not part of the language");
            self.diagnostics.push(Diagnostic::new(self.span(start), message).hint(hint));
            return kind;
        }
        let length = rest.find(|c: char| c.is_ascii() && self.starts_token(c)).unwrap_or(rest.len());
        self.at += length.max(first.len_utf8());
        let hint = match first {
            '[' | ']' => "read an element with a dot or a call, as in `volume.x` or `band(3)`",
            '&' => "write `&&`",
            '|' => "write `||`",
            '\'' | '\u{201c}' | '\u{201d}' | '\u{201e}' => "write text between `\"`",
            '²' | '³' => "write a power as `x^2`",
            _ if first.is_alphabetic() => "use only the letters a to z, digits and `_` in names",
            _ => "leave it out",
        };
        let message = if first.is_control() || first == BYTE_ORDER_MARK {
            format!("the character U+{:04X} is not part of the language", first as u32)
        } else {
            format!("the character `{first}` is not part of the language")
        };
        let wrong = Diagnostic::new(self.span(start), message);
        // A `]` after a `[` that was already reported is not reported again.
        if first != ']' || !std::mem::replace(&mut self.in_brackets, false) {
            self.diagnostics.push(wrong.hint(hint));
        }
        self.in_brackets |= first == '[';
        Kind::Unknown
    }

    fn starts_token(&self, character: char) -> bool {
        character.is_ascii_alphanumeric() || " \t\r\n_\"#.(){},;:?+-*/%^=!<>".contains(character)
    }
}

fn is_of_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_'
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lang::token::RESERVED;

    fn lex(text: &str) -> (Vec<(Kind, String, bool)>, Vec<String>) {
        let mut names = Interner::default();
        for word in RESERVED {
            names.intern(word);
        }
        let (mut tokens, mut diagnostics) = (Vec::new(), Diagnostics::new(20));
        tokenize(text, 0, 1000, &mut names, &mut tokens, &mut diagnostics);
        let shown = |token: &Token| {
            let text = text[token.span.start as usize..token.span.end as usize].to_owned();
            (token.kind, text, token.newline)
        };
        let messages = diagnostics.finish().into_iter().map(|one| one.message).collect();
        (tokens.iter().map(shown).collect(), messages)
    }

    fn value(text: &str) -> f32 {
        let (mut tokens, mut diagnostics) = (Vec::new(), Diagnostics::new(20));
        tokenize(text, 0, 1000, &mut Interner::default(), &mut tokens, &mut diagnostics);
        assert_eq!(tokens[0].span.end as usize, text.len());
        tokens[0].value()
    }

    fn words(text: &str) -> Vec<String> {
        let (tokens, errors) = lex(text);
        assert_eq!(errors, Vec::<String>::new(), "{text}");
        tokens.into_iter().filter(|one| one.0 != Kind::End).map(|one| one.1).collect()
    }

    #[test]
    fn numbers_ranges_and_dots_are_distinguished() {
        assert_eq!(words("0..32"), ["0", "..", "32"]);
        assert_eq!(words("0.1 .. 3"), ["0.1", "..", "3"]);
        assert_eq!(words(".5+1.-1e-3"), [".5", "+", "1.", "-", "1e-3"]);
        assert_eq!(words("p.xz*2.5E+2"), ["p", ".", "xz", "*", "2.5E+2"]);
        assert_eq!(words("1...5"), ["1", "..", ".5"]);
    }

    #[test]
    fn numbers_have_the_nearest_value() {
        for text in [
            "0",
            "1",
            "0.1",
            ".3",
            "2.",
            "16777217",
            "33554434.5",
            "18446744073709551617",
            "0.00000000000000000001e21",
            "1.6777217",
            "0.16",
            "123456.7",
            "3.4e38",
            "1e-45",
            "1e999",
        ]
        .into_iter()
        .chain([
            "0.0000000000000000000001",
            "00000000000000000000000000.5",
            "1.234567890123456789e-5",
        ]) {
            assert_eq!(value(text), text.parse::<f32>().unwrap(), "{text}");
        }
        for number in 0..20_000 {
            let text = format!("{}.{}", number % 173, number);
            assert_eq!(value(&text), text.parse::<f32>().unwrap(), "{text}");
        }
    }

    #[test]
    fn comments_and_line_ends_are_blank() {
        let (tokens, errors) = lex("\u{feff}a # one\r\nb // two\nc /* three\n */ d");
        assert!(errors.is_empty(), "{errors:?}");
        let shown: Vec<(&str, bool)> = tokens.iter().map(|one| (one.1.as_str(), one.2)).collect();
        assert_eq!(shown, [("a", false), ("b", true), ("c", true), ("d", true), ("", true)]);
    }

    #[test]
    fn text_without_a_token_is_reported() {
        let (tokens, errors) = lex("1 @@ 2 − 3");
        let shown: Vec<Kind> = tokens.iter().map(|one| one.0).collect();
        assert_eq!(shown, [Kind::Number, Kind::Unknown, Kind::Number, Kind::Minus, Kind::Number, Kind::End]);
        assert_eq!(errors.len(), 2);
        for (text, message) in [
            ("\"abc", "this text is never closed"),
            ("/* abc", "this comment is never closed"),
            ("2x", "a number runs into a name"),
            ("1.0f", "a number runs into a name"),
            ("größe", "the character `ö` is not part of the language"),
            ("\0", "the character U+0000 is not part of the language"),
        ] {
            assert_eq!(lex(text).1[0], message, "{text}");
        }
    }

    #[test]
    fn every_sign_is_known() {
        let text = "( ) { } , ; : ? . .. + - * / % ^ = == != < <= > >= && || !";
        assert_eq!(words(text), text.split(' ').collect::<Vec<_>>());
    }
}
