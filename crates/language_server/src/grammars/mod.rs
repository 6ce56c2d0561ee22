//! Grammars for editors, generated from the tables of the language: a TextMate grammar, and a grammar with queries for
//! tree-sitter. `cargo xtask grammars` writes them to `editors/`.

mod textmate;
mod tree_sitter;

/// The operators that change the value of a name.
const CHANGING: [&str; 4] = ["+=", "-=", "*=", "/="];

/// Returns the path in `editors/` and the text of each file.
pub fn files() -> Vec<(&'static str, String)> {
    vec![
        ("vscode/syntaxes/mariana.tmLanguage.json", textmate::grammar()),
        ("tree-sitter/grammar.js", tree_sitter::grammar()),
        ("tree-sitter/queries/highlights.scm", tree_sitter::highlights()),
        ("tree-sitter/queries/locals.scm", tree_sitter::locals()),
    ]
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    #[test]
    fn the_files_in_the_folder_are_current() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../editors");
        for (path, text) in super::files() {
            let kept = std::fs::read_to_string(folder.join(path)).unwrap_or_default();
            assert!(kept == text, "editors/{path} is old: run `cargo xtask grammars`");
        }
    }
}
