//! The text of the reference page.

use std::fmt::Write;

use mariana_field::lang::{Accuracy, Entry, Holds, Material, entries, inputs, part_inputs, parts};

/// Generates `docs/language.md`.
pub fn text() -> String {
    let mut text = include_str!("intro.md").replace("\r\n", "\n");
    let _ = writeln!(text, "```\n{}\n```", excerpt());
    text.push_str("\n## Inputs\n\n| name | what it is |\n|---|---|\n");
    for (name, doc) in inputs() {
        let _ = writeln!(text, "| `{name}` | {doc} |", doc = cell(doc));
    }
    text.push_str("\n| part | what it is |\n|---|---|\n");
    for (name, doc) in parts() {
        let _ = writeln!(text, "| `{name}` | {doc} |", doc = cell(doc));
    }
    let names: Vec<String> = part_inputs().map(|(name, _)| format!("`{name}`")).collect();
    let _ = writeln!(text, "\nEach part has the inputs {}.", names.join(", "));
    text.push_str("\n## Fields of a material\n\n| field | what it is | default |\n|---|---|---|\n");
    for field in Material::FIELDS {
        let kind = if field.holds == Holds::Vector { " (vec3)" } else { "" };
        let _ = writeln!(text, "| `{}`{kind} | {} | {} |", field.name, cell(field.doc), field.default);
    }
    let entries = entries();
    for group in entries.chunk_by(|a, b| a.group == b.group) {
        let (shown, plain): (Vec<_>, Vec<_>) = group.iter().partition(|entry| entry.example.is_some());
        let title = group.first().map_or("", |entry| entry.group);
        let _ = writeln!(text, "\n## {title}");
        if !shown.is_empty() {
            text.push_str("\n| | |\n|---|---|\n");
            for entry in shown {
                let name = entry.name;
                let (formula, described) = (cell(entry.example.unwrap_or("")), described(entry));
                let _ = writeln!(text, "| ![{name}](shapes/{name}.png)<br>`{formula}` | {described} |");
            }
        }
        if !plain.is_empty() {
            text.push_str("\n| function | |\n|---|---|\n");
            for entry in plain {
                let (signature, doc, facts) = (cell(&entry.signature), cell(&entry.doc), facts(entry));
                let _ = writeln!(text, "| `{signature}` | {doc}{facts} |");
            }
        }
    }
    text
}

/// Returns the part of the shipped scene `speakers` that defines the woofers.
fn excerpt() -> String {
    let scene = include_str!("../../../../assets/scenes/speakers.scene").replace("\r\n", "\n");
    let rest = scene.find("fn woofers").and_then(|start| scene.get(start..)).unwrap_or("");
    let end = rest.find("\n}").map_or(rest.len(), |end| end + 2);
    rest.get(..end).unwrap_or("").to_owned()
}

fn described(entry: &Entry) -> String {
    format!("`{}`<br>{}{}", cell(&entry.signature), cell(&entry.doc), facts(entry))
}

/// Formats the accuracy and the source of an entry, if the entry has any.
fn facts(entry: &Entry) -> String {
    let accuracy = entry.accuracy.map(|accuracy| match accuracy {
        Accuracy::Exact => "**exact**",
        Accuracy::Bound => "**bound**",
    });
    let source = (!entry.source.is_empty()).then(|| format!("*{}*", cell(&entry.source)));
    let facts: Vec<String> = accuracy.map(str::to_owned).into_iter().chain(source).collect();
    if facts.is_empty() { String::new() } else { format!("<br>{}", facts.join(" · ")) }
}

/// Escapes text for a table cell.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}
