//! The outline of a document: what it declares.

use mariana_field::lang::{NameKind, Section};
use serde_json::{Value, json};

use crate::documents::Documents;
use crate::positions::range;

/// Kinds of the protocol.
fn symbol_kind(kind: NameKind) -> u8 {
    match kind {
        NameKind::Param => 7,
        NameKind::Function => 12,
        NameKind::Let | NameKind::FunctionParameter | NameKind::LoopVariable => 13,
        NameKind::Section(Section::Object) => 19,
        NameKind::Section(Section::Material) => 23,
        NameKind::Section(Section::Camera) => 11,
        NameKind::Section(_) => 24,
    }
}

pub(crate) fn outline(documents: &mut Documents, uri: &str) -> Value {
    let Some(parsed) = documents.parsed(uri) else { return json!([]) };
    let Some(document) = documents.open.get(uri) else { return json!([]) };
    let buffer = &document.buffer;
    let declared = parsed.names.declarations.iter().filter(|one| one.local.is_none());
    let symbols = declared.filter_map(|one| {
        let (file, name) = parsed.sources.place_in_file(one.name)?;
        let (_, item) = parsed.sources.place_in_file(one.item)?;
        (file == 0).then(|| {
            json!({
                "name": parsed.sources.text(one.name),
                "kind": symbol_kind(one.kind),
                "range": range(buffer, item.start..item.end.max(name.end)),
                "selectionRange": range(buffer, name),
            })
        })
    });
    json!(symbols.collect::<Vec<_>>())
}
