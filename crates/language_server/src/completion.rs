//! Names that can be inserted at a position.

use mariana_editing::{Proposal, proposals};
use mariana_field::lang::{Declaration, Meaning, NameKind, Section, keywords};
use serde_json::{Value, json};

use crate::documents::Documents;
use crate::hover::{about, markdown};
use crate::positions::{self, Position};
use crate::protocol::TextEdit;

pub(crate) fn completion(documents: &mut Documents, uri: &str, position: Position, snippets: bool) -> Value {
    let items = items(documents, uri, position, snippets).unwrap_or_default();
    // The list holds the best candidates only, so the client asks again with more letters.
    json!({ "isIncomplete": true, "items": items })
}

fn items(documents: &mut Documents, uri: &str, position: Position, snippets: bool) -> Option<Vec<Value>> {
    let context = documents.contexts(uri).into_iter().next()?;
    let document = documents.open.get_mut(uri)?;
    let byte = positions::offset(&document.buffer, position);
    let (offset, parsed) = (context.offset(byte), &context.parsed);
    let is_valid = |one: &Declaration| {
        let is_here = one.local.is_none_or(|local| local.start <= offset && offset <= local.end);
        // A formula uses no other section than a material.
        let is_value = !matches!(one.kind, NameKind::Section(section) if section != Section::Material);
        is_here && one.name.end != offset && is_value
    };
    let own = |_: usize| -> Vec<Proposal> {
        let valid = parsed.names.declarations.iter().enumerate().filter(|(_, one)| is_valid(one));
        let valid = valid.filter_map(|(index, one)| {
            let about = about(parsed, one.name, Meaning::Declared(index))?;
            Some(Proposal { name: parsed.sources.text(one.name).to_owned(), about })
        });
        valid.collect()
    };
    let (range, all) = proposals(&document.buffer, &mut document.colors, byte, true, own);
    let calls = document.buffer.slice(byte..byte + 1) == b"(";
    let items = all.iter().enumerate().map(|(index, one)| {
        let about = &one.about;
        // The protocol's kinds are 3 for a function, 5 for a field, 14 for a keyword and 6 for a variable.
        let kind = match () {
            () if about.is_function => 3,
            () if about.head.contains('{') && about.head.ends_with("= }") => 5,
            () if keywords().any(|word| word == one.name) => 14,
            () => 6,
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
