//! Parts of the grammar for tree-sitter, which Neovim, Helix, Emacs and Zed read: the words and operators for
//! `editors/tree-sitter/grammar.js`, and the colours.

use super::{CHANGING, HEAD};
use mariana_field::lang::{
    PREFIX_BINDS, entries, inputs, item_words, operators, parts, reserved_words, type_names,
};
use serde_json::json;

/// The words and operators that the grammar reads.
pub(super) fn words() -> String {
    let sections = item_words().filter(|word| !matches!(*word, "param" | "include"));
    let operators = operators().map(
        |one| json!({ "sign": one.sign, "binds": one.binds, "fromTheRight": one.groups_from_the_right }),
    );
    let words = json!({
        "types": type_names().collect::<Vec<_>>(),
        "sections": sections.collect::<Vec<_>>(),
        "changing": CHANGING,
        "prefixBinds": PREFIX_BINDS,
        "operators": operators.collect::<Vec<_>>(),
    });
    format!("// {HEAD}\nmodule.exports = {words:#};\n")
}

pub(super) fn highlights() -> String {
    let strings =
        |words: Vec<&str>| words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(" ");
    let functions: Vec<&str> = entries().iter().map(|entry| entry.name).collect();
    let inputs: Vec<&str> = inputs().chain(parts()).map(|(name, _)| name).collect();
    let words: Vec<&str> = item_words()
        .chain(reserved_words())
        .filter(|word| !matches!(*word, "true" | "false" | "break"))
        .collect();
    let signs: Vec<&str> = operators().map(|one| one.sign).chain(["=", "..", "!"]).chain(CHANGING).collect();
    format!(
        r#"; {HEAD}
; If several patterns match a node, the last one counts.

(comment) @comment
(text) @string
(number) @number
(range_start) @number
(boolean) @boolean
(type) @type

(name) @variable
((name) @variable.builtin
  (#any-of? @variable.builtin {inputs}))

(param name: (name) @variable.parameter)
(parameter name: (name) @variable.parameter)
(for variable: (name) @variable.parameter)
(loop variable: (name) @variable.parameter)
(entry name: (name) @property)
(field name: (name) @property)
(member name: (name) @property)
(part name: (name) @property)
(section name: (name) @type.definition)

(function name: (name) @function)
(call function: (name) @function.call)
((call function: (name) @function.builtin)
  (#any-of? @function.builtin {functions}))

[{words}] @keyword
(break) @keyword
[{signs}] @operator
["(" ")" "{{" "}}"] @punctuation.bracket
["," ":" "."] @punctuation.delimiter
"#,
        inputs = strings(inputs),
        functions = strings(functions),
        words = strings(words),
        signs = strings(signs),
    )
}
