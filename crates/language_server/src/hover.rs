//! The documentation of the name under the pointer.

use mariana_editing::{About, Buffer, about_field, about_language, about_part_input, declaration};
use mariana_field::lang::{Meaning, NameKind, Span};
use serde_json::{Value, json};

use crate::documents::{Context, Documents, Parsed};
use crate::positions::{self, Position};

pub(crate) fn hover(documents: &mut Documents, uri: &str, position: Position) -> Option<Value> {
    let context = documents.contexts(uri).into_iter().next()?;
    let document = documents.open.get(uri)?;
    let byte = positions::offset(&document.buffer, position);
    let (span, about) = match context.parsed.names.at(context.offset(byte)) {
        Some((span, meaning)) => (span, about(&context.parsed, span, meaning)?),
        None => {
            let (word, span) = word_at(&context, &document.buffer, byte)?;
            (span, about_language(&word).filter(|about| !about.text.is_empty())?)
        }
    };
    let (_, bytes) = context.parsed.sources.place_in_file(span)?;
    Some(json!({
        "contents": { "kind": "markdown", "value": markdown(&about) },
        "range": positions::range(&document.buffer, bytes),
    }))
}

/// Returns the word around a byte, such as a keyword.
fn word_at(context: &Context, buffer: &Buffer, byte: usize) -> Option<(String, Span)> {
    let is_letter = |byte: &u8| byte.is_ascii_alphanumeric() || *byte == b'_';
    let line = buffer.line_range(buffer.line_of(byte));
    let before = buffer.slice(line.start..byte).iter().rev().take_while(|byte| is_letter(byte)).count();
    let behind = buffer.slice(byte..line.end).iter().take_while(|byte| is_letter(byte)).count();
    let range = byte - before..byte + behind;
    let word = String::from_utf8_lossy(buffer.slice(range.clone())).into_owned();
    (!word.is_empty()).then(|| (word, Span::new(context.offset(range.start), context.offset(range.end))))
}

/// Returns the documentation of a name.
pub(crate) fn about(parsed: &Parsed, span: Span, meaning: Meaning) -> Option<About> {
    let name = parsed.sources.text(span);
    match meaning {
        Meaning::Declared(index) => of_declaration(parsed, index),
        Meaning::OfLanguage => about_language(name),
        Meaning::Field(section) => about_field(section, name),
        Meaning::Member => about_part_input(name).filter(|_| follows_a_part(parsed, span)),
        Meaning::Include => None,
    }
}

fn follows_a_part(parsed: &Parsed, span: Span) -> bool {
    let names = &parsed.names.all;
    let index = names.partition_point(|(other, _)| other.start < span.start);
    let before = index.checked_sub(1).and_then(|before| names.get(before));
    before.is_some_and(|(other, meaning)| {
        *meaning == Meaning::OfLanguage
            && other.end + 1 == span.start
            && mariana_field::lang::is_part(parsed.sources.text(*other))
    })
}

fn of_declaration(parsed: &Parsed, index: usize) -> Option<About> {
    let declared = parsed.names.declarations.get(index)?;
    let name = parsed.sources.text(declared.name);
    let plain = |head: String, text: &str| About {
        head,
        text: text.to_owned(),
        facts: String::new(),
        is_function: false,
    };
    match declared.kind {
        NameKind::FunctionParameter => return Some(plain(name.to_owned(), "a parameter of this function")),
        NameKind::LoopVariable => return Some(plain(format!("for {name} in"), "the variable of this loop")),
        _ => {}
    }
    let (file, bytes) = parsed.sources.place_in_file(declared.name)?;
    let source = parsed.sources.files().get(file)?;
    let buffer = Buffer::new(source.text.clone().into_bytes());
    let facts = if file == 0 { String::new() } else { format!("declared in {}", source.name) };
    Some(About { facts, ..declaration(&buffer, buffer.line_of(bytes.start)) })
}

/// Returns the documentation as Markdown.
pub(crate) fn markdown(about: &About) -> String {
    let mut text = format!("```mariana\n{}\n```", about.head);
    for part in [&about.text, &about.facts] {
        if !part.is_empty() {
            text.push_str("\n\n");
            text.push_str(&escaped(part));
        }
    }
    text
}

/// Escapes the signs that have a meaning in Markdown.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        if matches!(letter, '\\' | '`' | '*' | '_' | '<' | '>' | '[' | ']' | '#' | '|') {
            out.push('\\');
        }
        out.push(letter);
    }
    out
}
