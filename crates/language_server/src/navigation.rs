//! The declaration of a name, and all its uses.

use std::collections::BTreeSet;

use mariana_field::lang::{Meaning, Span};
use serde_json::{Value, json};

use crate::documents::{Context, Documents, included_path};
use crate::positions::{self, Position, offset};
use crate::protocol::Location;
use crate::uri::uri_of;

pub(crate) fn definition(documents: &mut Documents, uri: &str, position: Position) -> Option<Value> {
    let (contexts, byte) = at(documents, uri, position);
    for context in contexts {
        let Some((span, meaning)) = context.parsed.names.at(context.offset(byte)) else { continue };
        if meaning == Meaning::Include {
            return included(documents, uri, &context, span);
        }
        let Meaning::Declared(index) = meaning else { continue };
        let Some(declared) = context.parsed.names.declarations.get(index) else { continue };
        if let Some(location) = documents.location(&context.parsed, declared.name) {
            return Some(json!(location));
        }
    }
    None
}

fn included(documents: &Documents, uri: &str, context: &Context, span: Span) -> Option<Value> {
    let name = context.parsed.sources.text(span).trim_matches('"').to_owned();
    let scene = documents.open.get(uri)?.path.as_deref()?;
    let is_read = context.parsed.sources.files().iter().any(|file| file.name == name);
    let target = uri_of(&included_path(scene, &name)).filter(|_| is_read)?;
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
