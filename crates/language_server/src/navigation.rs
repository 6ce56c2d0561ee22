//! The declaration of a name, and all its uses.

use std::collections::BTreeSet;

use mariana_field::lang::{Meaning, Span};
use serde_json::{Value, json};

use crate::documents::{Context, Documents, Parsed, location};
use crate::positions::{self, Position, offset};
use crate::protocol::Location;

pub(crate) fn definition(documents: &mut Documents, uri: &str, position: Position) -> Option<Value> {
    let (contexts, byte) = at(documents, uri, position);
    for context in contexts {
        let Some((span, meaning)) = context.parsed.names.at(context.offset(byte)) else { continue };
        if meaning == Meaning::Include {
            return included(&context.parsed, span);
        }
        let Meaning::Declared(index) = meaning else { continue };
        let Some(declared) = context.parsed.names.declarations.get(index) else { continue };
        if let Some(location) = location(&context.parsed.sources, &context.parsed.files, declared.name) {
            return Some(json!(location));
        }
    }
    None
}

fn included(parsed: &Parsed, span: Span) -> Option<Value> {
    let name = parsed.sources.text(span).trim_matches('"');
    let file = parsed.sources.files().iter().position(|file| file.name == name)?;
    let target = parsed.files.get(file)?.uri.as_ref()?;
    Some(json!({ "uri": target, "range": positions::Span::default() }))
}

/// Returns the uses of a name in the document itself.
pub(crate) fn highlights(documents: &mut Documents, uri: &str, position: Position) -> Value {
    let all = places(documents, uri, position, true);
    let here = all.into_iter().filter(|one| one.uri == uri);
    json!(here.map(|one| json!({ "range": one.range })).collect::<Vec<_>>())
}

/// Returns the locations of the name at a position, in all open scenes that contain the document.
pub(crate) fn places(
    documents: &mut Documents,
    uri: &str,
    position: Position,
    with_declaration: bool,
) -> Vec<Location> {
    let (contexts, byte) = at(documents, uri, position);
    let mut found = Vec::new();
    let mut seen = BTreeSet::new();
    for context in contexts {
        let Some((_, Meaning::Declared(index))) = context.parsed.names.at(context.offset(byte)) else {
            continue;
        };
        let declared = context.parsed.names.declarations.get(index).map(|one| one.name);
        let spans = context.parsed.names.places(index);
        let spans = spans.filter(|span| with_declaration || Some(*span) != declared);
        let Parsed { sources, files, .. } = &*context.parsed;
        for location in spans.filter_map(|span| location(sources, files, span)) {
            if seen.insert((location.uri.clone(), location.range.start)) {
                found.push(location);
            }
        }
    }
    found
}

/// Returns the scenes that contain a document, and the byte of a position in the document.
pub(crate) fn at(documents: &mut Documents, uri: &str, position: Position) -> (Vec<Context>, usize) {
    let contexts = documents.contexts(uri);
    let byte = documents.open.get(uri).map_or(0, |document| offset(&document.buffer, position));
    (contexts, byte)
}
