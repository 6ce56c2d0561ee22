//! The documentation of the name under the pointer.

use mariana_editing::{About, about_field, about_language, about_part_input, declaration};
use mariana_field::lang::{Meaning, NameKind, Span};
use serde_json::{Value, json};

use crate::documents::{Documents, Parsed};
use crate::positions::{self, Position};

pub(crate) fn hover(documents: &mut Documents, uri: &str, position: Position) -> Option<Value> {
    let context = documents.contexts(uri).into_iter().next()?;
    let document = documents.open.get(uri)?;
    let byte = positions::offset(&document.buffer, position);
    let (span, meaning) = context.parsed.names.at(context.offset(byte))?;
    let about = about(&context.parsed, span, meaning)?;
    let (_, bytes) = context.parsed.sources.place_in_file(span)?;
    Some(json!({
        "contents": { "kind": "markdown", "value": markdown(&about) },
        "range": positions::range(&document.buffer, bytes),
    }))
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
    let (source, buffer) = (parsed.sources.files().get(file)?, &parsed.files.get(file)?.buffer);
    let facts = if file == 0 { String::new() } else { format!("declared in {}", source.name) };
    // A `let` may be in the line of its function.
    let is_function = declared.kind == NameKind::Function;
    Some(About { facts, is_function, ..declaration(buffer, buffer.line_of(bytes.start)) })
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
