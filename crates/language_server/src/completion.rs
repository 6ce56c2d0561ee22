//! Names that can be inserted at a position.

use std::collections::BTreeSet;

use mariana_editing::{About, Proposal, proposals};
use mariana_field::lang::{NameKind, keywords};
use serde_json::{Value, json};

use crate::documents::Documents;
use crate::hover::markdown;
use crate::positions::{self, Position};
use crate::protocol::TextEdit;

/// Kinds of the protocol.
mod kind {
    pub(crate) const FUNCTION: u8 = 3;
    pub(crate) const FIELD: u8 = 5;
    pub(crate) const VARIABLE: u8 = 6;
    pub(crate) const KEYWORD: u8 = 14;
}

pub(crate) fn completion(documents: &mut Documents, uri: &str, position: Position, snippets: bool) -> Value {
    let items = items(documents, uri, position, snippets).unwrap_or_default();
    // The list holds the best candidates only, so the client asks again with more letters.
    json!({ "isIncomplete": true, "items": items })
}

fn items(documents: &mut Documents, uri: &str, position: Position, snippets: bool) -> Option<Vec<Value>> {
    let context = documents.contexts(uri).into_iter().next()?;
    let document = documents.open.get_mut(uri)?;
    let byte = positions::offset(&document.buffer, position);
    let (range, found) = proposals(&document.buffer, &mut document.colors, byte, true);
    let offset = context.offset(byte);
    let (names, sources) = (&context.parsed.names, &context.parsed.sources);
    let is_valid = |one: &&mariana_field::lang::Declaration| {
        one.local.is_none_or(|local| local.start <= offset && offset <= local.end) && one.name.end != offset
    };
    let valid: Vec<_> = names.declarations.iter().filter(is_valid).collect();
    let valid_names: BTreeSet<&str> = valid.iter().map(|one| sources.text(one.name)).collect();
    // A local name of another function is not valid here.
    let is_local_elsewhere =
        |one: &Proposal| one.about.facts == OWN && !valid_names.contains(one.name.as_str());
    let mut all: Vec<Proposal> = found.into_iter().filter(|one| !is_local_elsewhere(one)).collect();
    if !all.is_empty() || range.is_empty() {
        let typed = String::from_utf8_lossy(document.buffer.slice(range.clone())).to_lowercase();
        let behind_point = range.start.checked_sub(1).map(|at| document.buffer.slice(at..at + 1) == b".");
        let known: BTreeSet<String> = all.iter().map(|one| one.name.clone()).collect();
        for one in valid.iter().filter(|_| behind_point != Some(true)) {
            let name = sources.text(one.name);
            let is_value = !matches!(
                one.kind,
                NameKind::Object | NameKind::Light | NameKind::Medium | NameKind::Swarm | NameKind::Camera
            );
            if is_value && !known.contains(name) && name.to_lowercase().starts_with(&typed) {
                let is_function = one.kind == NameKind::Function;
                let about =
                    About { head: name.to_owned(), text: String::new(), facts: OWN.to_owned(), is_function };
                all.insert(0, Proposal { name: name.to_owned(), about });
            }
        }
    }
    let calls = document.buffer.slice(byte..byte + 1) == b"(";
    let items = all.iter().enumerate().map(|(index, one)| {
        let about = &one.about;
        let kind = match () {
            () if about.is_function => kind::FUNCTION,
            () if about.head.contains('{') && about.head.ends_with("= }") => kind::FIELD,
            () if keywords().any(|word| word == one.name) => kind::KEYWORD,
            () => kind::VARIABLE,
        };
        let has_parameters = snippets && about.is_function && !calls;
        let new_text = if has_parameters { format!("{}($0)", one.name) } else { one.name.clone() };
        let edit = TextEdit { range: positions::range(&document.buffer, range.clone()), new_text };
        json!({
            "label": one.name,
            "kind": kind,
            "detail": about.head,
            "documentation": { "kind": "markdown", "value": markdown(about) },
            "sortText": format!("{index:04}"),
            "filterText": one.name,
            "insertTextFormat": if has_parameters { 2 } else { 1 },
            "textEdit": edit,
        })
    });
    Some(items.collect())
}

/// The facts of names that the text declares, from [`mariana_editing::declaration`].
const OWN: &str = "declared in this scene";
