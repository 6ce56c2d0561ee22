//! Colours of words, by their meaning.

use mariana_field::lang::{Meaning, NameKind, WordKind};
use serde_json::{Value, json};

use crate::documents::{Documents, Parsed};
use crate::positions;

/// The types of tokens, in the order of their numbers in the protocol's messages.
pub(crate) const TYPES: [&str; 8] =
    ["comment", "string", "number", "keyword", "function", "variable", "parameter", "property"];

fn number_of(name: &str) -> usize {
    TYPES.iter().position(|one| *one == name).unwrap_or_default()
}

pub(crate) fn tokens(documents: &mut Documents, uri: &str) -> Value {
    json!({ "data": data(documents, uri).unwrap_or_default() })
}

fn data(documents: &mut Documents, uri: &str) -> Option<Vec<usize>> {
    let parsed = documents.parsed(uri)?;
    let document = documents.open.get_mut(uri)?;
    let mut data = Vec::new();
    let (mut last_line, mut last_start) = (0, 0);
    for line in 0..document.buffer.line_count() {
        let begin = document.buffer.line_start(line);
        // The byte up to which the units of the line are counted, and their number.
        let (mut counted, mut units) = (0, 0);
        for word in document.colors.words(&document.buffer, line) {
            let Some(of) = type_of(&parsed, word.kind, begin + word.start) else { continue };
            let bytes = document.buffer.line(line);
            units += positions::units(bytes.get(counted..word.start).unwrap_or_default());
            counted = word.start;
            let start = units;
            let length = positions::units(bytes.get(word.start..word.end).unwrap_or_default());
            if length == 0 {
                continue;
            }
            let from = if line == last_line { last_start } else { 0 };
            data.extend([line - last_line, start - from, length, number_of(of), 0]);
            (last_line, last_start) = (line, start);
        }
    }
    Some(data)
}

fn type_of(parsed: &Parsed, kind: WordKind, byte: usize) -> Option<&'static str> {
    let name = || {
        let offset = parsed.sources.offset(0, byte)?;
        let (_, meaning) = parsed.names.at(offset).filter(|(span, _)| span.start == offset)?;
        Some(match meaning {
            Meaning::Declared(index) => match parsed.names.declarations.get(index)?.kind {
                NameKind::Function => "function",
                NameKind::Param | NameKind::FunctionParameter => "parameter",
                _ => "variable",
            },
            Meaning::Field(_) | Meaning::Member => "property",
            Meaning::OfLanguage | Meaning::Include => return None,
        })
    };
    match kind {
        WordKind::Comment => Some("comment"),
        WordKind::Text => Some("string"),
        WordKind::Number => Some("number"),
        WordKind::Function => Some(name().unwrap_or("function")),
        WordKind::Input | WordKind::Name => Some(name().unwrap_or("variable")),
        WordKind::Keyword => Some(name().unwrap_or("keyword")),
        WordKind::Sign | WordKind::Unknown => None,
    }
}
