//! The parameters of the function whose arguments contain a position.

use mariana_editing::{About, call_around};
use serde_json::{Value, json};

use crate::documents::Documents;
use crate::hover::{about, markdown};
use crate::limits;
use crate::positions::{Position, offset};

pub(crate) fn signature(documents: &mut Documents, uri: &str, position: Position) -> Option<Value> {
    let context = documents.contexts(uri).into_iter().next()?;
    let document = documents.open.get_mut(uri)?;
    let byte = offset(&document.buffer, position);
    let (name, argument) =
        call_around(&document.buffer, &mut document.colors, byte, limits::SIGNATURE_LINES_MAX)?;
    let (span, meaning) = context.parsed.names.at(context.offset(name.start))?;
    let about = about(&context.parsed, span, meaning).filter(|about| about.is_function)?;
    Some(answer(&about, argument))
}

fn answer(about: &About, argument: usize) -> Value {
    let head = about.head.strip_prefix("fn ").unwrap_or(&about.head);
    let inside =
        head.split_once('(').and_then(|(_, rest)| rest.rsplit_once(')')).map_or("", |(inside, _)| inside);
    let parameters: Vec<Value> = inside
        .split(',')
        .map(str::trim)
        .filter(|one| !one.is_empty())
        .map(|one| json!({ "label": one }))
        .collect();
    // Further arguments of a function with any number of arguments belong to the last parameter.
    let active = argument.min(parameters.len().saturating_sub(1));
    json!({
        "signatures": [{
            "label": head,
            "documentation": { "kind": "markdown", "value": markdown(about) },
            "parameters": parameters,
            "activeParameter": active,
        }],
        "activeSignature": 0,
        "activeParameter": active,
    })
}
