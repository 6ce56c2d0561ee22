//! The parameters of the function whose arguments contain a position.

use mariana_field::lang::{Meaning, WordKind};
use serde_json::{Value, json};

use crate::documents::Documents;
use crate::hover::{about, markdown};
use crate::limits;
use crate::positions::{Position, offset};

pub(crate) fn signature(documents: &mut Documents, uri: &str, position: Position) -> Option<Value> {
    let context = documents.contexts(uri).into_iter().next()?;
    let document = documents.open.get_mut(uri)?;
    let byte = offset(&document.buffer, position);
    let last = document.buffer.line_of(byte);
    let (mut closed, mut argument) = (0_usize, 0_usize);
    let mut opening = false;
    for line in (last.saturating_sub(limits::SIGNATURE_LINES_MAX)..=last).rev() {
        let start = document.buffer.line_start(line);
        for word in document.colors.words(&document.buffer, line).iter().rev() {
            if start + word.end > byte {
                continue;
            }
            let text = document.buffer.slice(start + word.start..start + word.end);
            if opening {
                let is_name = matches!(
                    word.kind,
                    WordKind::Name | WordKind::Function | WordKind::Input | WordKind::Keyword
                );
                let (span, meaning) =
                    context.parsed.names.at(context.offset(start + word.start)).filter(|_| is_name)?;
                let is_call = meaning != Meaning::Member;
                let about = about(&context.parsed, span, meaning).filter(|one| one.is_function && is_call)?;
                return Some(answer(&about, argument));
            }
            match text {
                b")" | b"}" => closed += 1,
                b"(" | b"{" if closed > 0 => closed -= 1,
                b"(" => opening = true,
                b"{" => return None,
                b"," if closed == 0 => argument += 1,
                _ => {}
            }
        }
    }
    None
}

fn answer(about: &mariana_editing::About, argument: usize) -> Value {
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
