//! The declaration of a name, and all its uses.

use std::collections::BTreeSet;
use std::path::Path;

use mariana_field::lang::Meaning;
use serde_json::{Value, json};

use crate::documents::{Context, Documents, included_path};
use crate::positions::{self, Position, offset};
use crate::protocol::Location;
use crate::uri::uri_of;

pub(crate) fn definition(documents: &mut Documents, uri: &str, position: Position) -> Value {
    let (contexts, byte) = at(documents, uri, position);
    for context in contexts {
        let Some((span, meaning)) = context.parsed.names.at(context.offset(byte)) else { continue };
        if meaning == Meaning::Include {
            return included(documents, uri, &context, span);
        }
        let Meaning::Declared(index) = meaning else { continue };
        let Some(declared) = context.parsed.names.declarations.get(index) else { continue };
        if let Some(location) = documents.location(&context.parsed, declared.name) {
            return json!(location);
        }
    }
    Value::Null
}

fn included(documents: &Documents, uri: &str, context: &Context, span: mariana_field::lang::Span) -> Value {
    let name = context.parsed.sources.text(span).trim_matches('"').to_owned();
    let scene = documents.open.get(uri).and_then(|document| document.path.clone());
    let file = context.parsed.sources.files().iter().find(|file| file.name == name);
    let target = file.and(scene).and_then(|scene| uri_of(&included_path(Path::new(&scene), &name)));
    target.map_or(Value::Null, |uri| json!({ "uri": uri, "range": positions::Span::default() }))
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
        for location in documents.locations(&context.parsed, spans) {
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
