//! The TextMate grammar, which VS Code, Zed's extensions, Sublime Text and GitHub read. It colours words; it does not
//! know scopes.

use super::{CHANGING, HEAD};
use mariana_field::lang::{
    entries, inputs, item_words, operators, part_inputs, parts, reserved_words, section_fields, type_names,
};
use serde_json::{Value, json};

/// Words that have a value.
const CONSTANTS: [&str; 2] = ["true", "false"];
/// Reserved words that declare a name.
const DECLARING: [&str; 2] = ["let", "fn"];

pub(super) fn grammar() -> String {
    let grammar = json!({
        "$comment": HEAD,
        "name": "Mariana",
        "scopeName": "source.mariana",
        "fileTypes": ["scene"],
        "patterns": patterns(),
    });
    format!("{grammar:#}\n")
}

/// Returns an expression for any of these words, longer words first.
fn any_of<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    let mut words: Vec<&str> = words.into_iter().collect();
    words.sort_by_key(|word| (std::cmp::Reverse(word.len()), *word));
    words.dedup();
    words.join("|")
}

fn escaped(sign: &str) -> String {
    sign.chars().map(|letter| format!("\\{letter}")).collect()
}

fn rule(scope: &str, expression: &str) -> Value {
    json!({ "name": format!("{scope}.mariana"), "match": expression })
}

fn patterns() -> Vec<Value> {
    let functions: Vec<&str> = entries().iter().map(|entry| entry.name).collect();
    let fields = any_of(section_fields().flat_map(|(_, fields)| fields.iter().map(|field| field.name)));
    let choosing = reserved_words().filter(|word| !CONSTANTS.contains(word) && !DECLARING.contains(word));
    let input_names = any_of(inputs().chain(parts()).map(|(name, _)| name));
    let of_parts = any_of(part_inputs().map(|(name, _)| name));
    let part_names = any_of(parts().map(|(name, _)| name));
    let mut signs: Vec<&str> =
        operators().map(|one| one.sign).chain(["..", "=", "!"]).chain(CHANGING).collect();
    signs.sort_by_key(|sign| (std::cmp::Reverse(sign.len()), *sign));
    let signs = signs.into_iter().map(escaped).collect::<Vec<_>>().join("|");
    vec![
        rule("comment.line.number-sign", "#.*$"),
        rule("comment.line.double-slash", "//.*$"),
        json!({ "name": "comment.block.mariana", "begin": "/\\*", "end": "\\*/" }),
        rule("string.quoted.double", "\"[^\"\\n]*\""),
        rule(
            "constant.numeric",
            "(?<![A-Za-z0-9_])(?:[0-9]+(?:\\.(?!\\.)[0-9]*)?|\\.[0-9]+)(?:[eE][+-]?[0-9]+)?(?![A-Za-z0-9_])",
        ),
        json!({
            "match": "\\b(fn)\\s+([A-Za-z_][A-Za-z0-9_]*)",
            "captures": {
                "1": { "name": "storage.type.function.mariana" },
                "2": { "name": "entity.name.function.mariana" },
            },
        }),
        json!({
            "match": format!("\\b({})\\s+([A-Za-z_][A-Za-z0-9_]*)(?=\\s*[={{])", any_of(item_words().chain(["let"]))),
            "captures": {
                "1": { "name": "storage.type.mariana" },
                "2": { "name": "variable.other.definition.mariana" },
            },
        }),
        rule("storage.type", &format!("\\b(?:{})\\b(?=\\s*[{{\"])", any_of(item_words()))),
        rule("storage.type", &format!("\\b(?:{})\\b", any_of(DECLARING))),
        rule("constant.language", &format!("\\b(?:{})\\b", any_of(CONSTANTS))),
        rule("keyword.control", &format!("\\b(?:{})\\b", any_of(choosing))),
        rule("support.type", &format!("(?<=:)\\s*(?:{})\\b", any_of(type_names()))),
        json!({
            "match": format!("\\b({part_names})(\\.)({of_parts})\\b"),
            "captures": {
                "1": { "name": "variable.language.mariana" },
                "2": { "name": "keyword.operator.mariana" },
                "3": { "name": "variable.language.mariana" },
            },
        }),
        rule("variable.other.member", "(?<=\\.)[A-Za-z_][A-Za-z0-9_]*"),
        rule("support.function", &format!("\\b(?:{})(?=\\s*\\()", any_of(functions))),
        rule("entity.name.function", "\\b[A-Za-z_][A-Za-z0-9_]*(?=\\s*\\()"),
        rule("support.type.property-name", &format!("\\b(?:{fields})(?=\\s*=(?!=))")),
        rule("variable.language", &format!("\\b(?:{input_names})\\b")),
        rule("variable.other", "\\b[A-Za-z_][A-Za-z0-9_]*\\b"),
        rule("keyword.operator", &signs),
        rule("punctuation", "[(){},;:.]"),
    ]
}
