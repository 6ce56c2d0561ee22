//! Gives a name another name. The scene must stay the same, so every renamed scene is read again and compared.

use std::collections::BTreeMap;

use mariana_field::lang::{self, Meaning, Names};
use serde_json::{Value, json};

use crate::documents::{Context, Documents, Parsed, location};
use crate::limits;
use crate::navigation::{at, places};
use crate::positions::Position;
use crate::protocol::{Failure, TextEdit, code};

/// Returns the range of the name under the cursor, if it can be renamed.
pub(crate) fn prepare(documents: &mut Documents, uri: &str, position: Position) -> Option<Value> {
    let (contexts, byte) = at(documents, uri, position);
    let (context, span) = contexts.iter().find_map(|context| {
        let (span, meaning) = context.parsed.names.at(context.offset(byte))?;
        matches!(meaning, Meaning::Declared(_)).then_some((context, span))
    })?;
    let location = location(&context.parsed.sources, &context.parsed.files, span)?;
    Some(json!({ "range": location.range, "placeholder": context.parsed.sources.text(span) }))
}

pub(crate) fn rename(
    documents: &mut Documents,
    uri: &str,
    position: Position,
    name: &str,
) -> Result<Value, Failure> {
    let refuse = |message: String| Failure::new(code::REQUEST_FAILED, message);
    let is_letter = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_';
    if name.is_empty()
        || name.len() > limits::NAME_BYTES_MAX
        || !name.bytes().all(is_letter)
        || name.as_bytes()[0].is_ascii_digit()
    {
        return Err(refuse(format!("`{name}` is not a name: use the letters a to z, digits and `_`")));
    }
    let (contexts, byte) = at(documents, uri, position);
    let declared = |context: &Context| match context.parsed.names.at(context.offset(byte)) {
        Some((_, Meaning::Declared(index))) => Some(index),
        _ => None,
    };
    if !contexts.iter().any(|context| declared(context).is_some()) {
        return Err(refuse("only names that a scene declares can be renamed".to_owned()));
    }
    for context in &contexts {
        if let Some(index) = declared(context) {
            compare(&context.parsed, index, name).map_err(refuse)?;
        }
    }
    let mut changes: BTreeMap<String, Vec<TextEdit>> = BTreeMap::new();
    for place in places(documents, uri, position, true) {
        let edit = TextEdit { range: place.range, new_text: name.to_owned() };
        changes.entry(place.uri).or_default().push(edit);
    }
    Ok(json!({ "changes": changes }))
}

/// Fails if the scene does not stay the same when a declaration gets another name.
fn compare(parsed: &Parsed, index: usize, name: &str) -> Result<(), String> {
    let sources = &parsed.sources;
    let texts: Vec<String> =
        (0..sources.files().len()).map(|file| renamed(parsed, file, index, name)).collect();
    let mut after = |path: &str| {
        let file = sources.files().iter().skip(1).position(|file| file.name == path);
        file.and_then(|file| texts.get(file + 1)).cloned().ok_or_else(|| "it was not read".to_owned())
    };
    let mut before = |path: &str| {
        let file = sources.files().iter().skip(1).find(|file| file.name == path);
        file.map(|file| file.text.clone()).ok_or_else(|| "it was not read".to_owned())
    };
    let text = texts.first().map(String::as_str).unwrap_or_default();
    let (names, _) = lang::names("", text, &mut after);
    if meanings(&names) != meanings(&parsed.names) {
        return Err(format!("`{name}` already has a meaning here: choose another name"));
    }
    let original = sources.files().first().map(|file| file.text.as_str()).unwrap_or_default();
    // A scene with mistakes cannot be compared further.
    let Some(original) = lang::compile("", original, &mut before).scene else { return Ok(()) };
    let compiled = lang::compile("", text, &mut after);
    match compiled.scene {
        Some(scene) if scene.draws_the_same(&original) => Ok(()),
        Some(_) => Err(format!("with the name `{name}` the scene would change: choose another name")),
        None => Err(compiled.diagnostics.first().map_or_else(String::new, |first| first.message.clone())),
    }
}

/// Returns the text of a file in which a declaration and its uses have another name.
fn renamed(parsed: &Parsed, file: usize, index: usize, name: &str) -> String {
    let text = parsed.sources.files().get(file).map(|file| file.text.as_str()).unwrap_or_default();
    let places = parsed.names.places(index).filter_map(|span| parsed.sources.place_in_file(span));
    let (mut out, mut at) = (String::with_capacity(text.len()), 0);
    for (_, bytes) in places.filter(|(of, _)| *of == file) {
        out.push_str(text.get(at..bytes.start).unwrap_or_default());
        out.push_str(name);
        at = bytes.end;
    }
    out.push_str(text.get(at..).unwrap_or_default());
    out
}

fn meanings(names: &Names) -> Vec<Meaning> {
    names.all.iter().map(|(_, meaning)| *meaning).collect()
}
