//! A small reader of Rust source: tokens without comments, and the paths that a file refers to.
//!
//! It knows as much of the grammar as the walls need: comments and literals, `use` trees with groups, globs and
//! renames, paths in code, inline modules, and items under `#[cfg(test)]`.

use std::collections::HashMap;

/// A word, `::`, a single mark, or a string literal (which keeps its opening quote and drops the closing one).
#[derive(Debug, Clone, PartialEq)]
pub struct Token {
    pub text: String,
    /// Counted from 1.
    pub line: usize,
}

/// A path that the source refers to, resolved to start at `crate`, `std` or another crate's name.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    pub path: Vec<String>,
    pub line: usize,
}

/// A module that exists for tests only and lives in a file of its own.
#[derive(Debug, PartialEq)]
pub struct TestModule {
    pub name: String,
    /// What `#[path = ...]` says, if it is there.
    pub path: Option<String>,
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The tokens of `text`, without comments, lifetimes' quotes and characters' contents.
pub fn tokens(text: &str) -> Vec<Token> {
    let chars: Vec<char> = text.chars().collect();
    let at = |i: usize| chars.get(i).copied().unwrap_or('\0');
    let mut found = Vec::new();
    let (mut i, mut line) = (0, 1);
    while i < chars.len() {
        let start = i;
        let mut word = None;
        match (at(i), at(i + 1)) {
            ('/', '/') => {
                while i < chars.len() && at(i) != '\n' {
                    i += 1;
                }
            }
            ('/', '*') => i = end_of_block_comment(&chars, i),
            ('"', _) => {
                i = end_of_string(&chars, i);
                word = Some(chars[start..i - 1].iter().collect());
            }
            ('\'', quoted) => {
                // A character ('a', '\n') or a lifetime ('a), of which the name is left to be an ordinary word.
                i += match (quoted, at(i + 2)) {
                    ('\\', _) => (i + 3..chars.len()).find(|&k| at(k) == '\'').map_or(1, |k| k + 1 - i),
                    (_, '\'') => 3,
                    _ => 1,
                };
            }
            (':', ':') => {
                i += 2;
                word = Some("::".into());
            }
            (c, _) if is_word(c) => {
                while is_word(at(i)) {
                    i += 1;
                }
                let prefix: String = chars[start..i].iter().collect();
                let hashes = (i..).take_while(|&k| at(k) == '#').count();
                let literal = matches!(prefix.as_str(), "r" | "b" | "br" | "c" | "cr");
                if literal && prefix.ends_with('r') && at(i + hashes) == '"' {
                    let body = i + hashes + 1;
                    i = end_of_raw_string(&chars, body, hashes);
                    word = Some(format!("\"{}", chars[body..i - hashes - 1].iter().collect::<String>()));
                } else if !(literal && matches!(at(i), '"' | '\'') || prefix == "r" && at(i) == '#') {
                    word = Some(prefix);
                }
            }
            (c, _) => {
                i += 1;
                word = (!c.is_whitespace()).then(|| c.to_string());
            }
        }
        found.extend(word.map(|text| Token { text, line }));
        line += chars[start..i.min(chars.len())].iter().filter(|&&c| c == '\n').count();
    }
    found
}

/// Block comments nest.
fn end_of_block_comment(chars: &[char], start: usize) -> usize {
    let (mut i, mut depth) = (start, 0);
    while i < chars.len() {
        match (chars[i], chars.get(i + 1)) {
            ('/', Some('*')) => (i, depth) = (i + 2, depth + 1),
            ('*', Some('/')) => (i, depth) = (i + 2, depth - 1),
            _ => i += 1,
        }
        if depth == 0 {
            break;
        }
    }
    i
}

fn end_of_string(chars: &[char], start: usize) -> usize {
    let mut i = start + 1;
    while i < chars.len() && chars[i] != '"' {
        i += if chars[i] == '\\' { 2 } else { 1 };
    }
    i + 1
}

fn end_of_raw_string(chars: &[char], body: usize, hashes: usize) -> usize {
    let closes = |i: usize| chars[i] == '"' && chars[i + 1..].iter().take(hashes).all(|&c| c == '#');
    (body..chars.len()).find(|&i| closes(i)).unwrap_or(chars.len() - hashes) + 1 + hashes
}

/// Whether `wanted` stands at `i`.
pub fn stands_at(tokens: &[Token], i: usize, wanted: &[&str]) -> bool {
    tokens.len() >= i + wanted.len()
        && tokens[i..].iter().zip(wanted).all(|(token, text)| token.text == *text)
}

/// Index after the bracket that closes the one at `open`.
fn after_closing(tokens: &[Token], open: usize) -> usize {
    let mut depth = 0;
    for (i, token) in tokens.iter().enumerate().skip(open) {
        match token.text.as_str() {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return i + 1;
        }
    }
    tokens.len()
}

/// Cuts out every item under `#[cfg(test)]`; modules among them that live in other files come back by name.
pub fn without_tests(tokens: &[Token]) -> (Vec<Token>, Vec<TestModule>) {
    let (mut kept, mut modules) = (Vec::new(), Vec::new());
    let mut i = 0;
    while i < tokens.len() {
        let attribute_end = if stands_at(tokens, i, &["#", "["]) { after_closing(tokens, i + 1) } else { i };
        let attribute = &tokens[i..attribute_end];
        let has = |word: &str| attribute.iter().any(|token| token.text == word);
        if !(has("cfg") && has("test") && !has("not")) {
            kept.push(tokens[i].clone());
            i += 1;
            continue;
        }
        i = attribute_end;
        let mut path = None;
        while stands_at(tokens, i, &["#", "["]) {
            if stands_at(tokens, i, &["#", "[", "path", "="]) {
                path = Some(tokens[i + 4].text.trim_start_matches('"').to_owned());
            }
            i = after_closing(tokens, i + 1);
        }
        let item = i;
        while i < tokens.len() && !matches!(tokens[i].text.as_str(), "{" | ";") {
            i = if matches!(tokens[i].text.as_str(), "(" | "[") { after_closing(tokens, i) } else { i + 1 };
        }
        let in_other_file = stands_at(tokens, i, &[";"]);
        if let Some(at) = (item..i).find(|&k| tokens[k].text == "mod").filter(|_| in_other_file) {
            modules.push(TestModule { name: tokens[at + 1].text.clone(), path });
        }
        i = if in_other_file { i + 1 } else { after_closing(tokens, i) };
    }
    (kept, modules)
}

/// Everything that `tokens` refer to by `use` or by a path of two segments or more.
///
/// `module` is the file's own module below the crate (`["audio", "clock"]`), by which `self` and `super` resolve.
/// Names that the file imports resolve to what they stand for, wherever in the file they were imported.
pub fn references(tokens: &[Token], module: &[String]) -> Vec<Reference> {
    let mut names: HashMap<String, Vec<String>> = HashMap::new();
    let mut found = Vec::new();
    let mut blocks: Vec<Option<String>> = Vec::new();
    let mut inline_module = None;
    let mut i = 0;
    while i < tokens.len() {
        let here: Vec<String> = module.iter().chain(blocks.iter().flatten()).cloned().collect();
        // After `::` a word continues a path, unless nothing that could be a path stands before the `::`.
        let continues = i >= 2
            && tokens[i - 1].text == "::"
            && (tokens[i - 2].text == ">" || tokens[i - 2].text.starts_with(is_word));
        match tokens[i].text.as_str() {
            "{" => blocks.push(inline_module.take()),
            "}" => drop(blocks.pop()),
            "mod" if stands_at(tokens, i + 2, &["{"]) => inline_module = Some(tokens[i + 1].text.clone()),
            "use" if !stands_at(tokens, i + 1, &["<"]) => {
                let mut imports = Vec::new();
                i = use_tree(tokens, i + 1, &[], &mut imports);
                for (path, name, line) in imports {
                    let path = from_root(path, &here);
                    names.insert(name, path.clone());
                    found.push(Reference { path, line });
                }
                continue;
            }
            first if first.starts_with(is_word) && !continues && stands_at(tokens, i + 1, &["::"]) => {
                let line = tokens[i].line;
                let mut path = vec![first.to_owned()];
                while stands_at(tokens, i + 1, &["::"])
                    && tokens.get(i + 2).is_some_and(|token| token.text.starts_with(is_word))
                {
                    path.push(tokens[i + 2].text.clone());
                    i += 2;
                }
                found.push(Reference { path: from_root(path, &here), line });
            }
            _ => {}
        }
        i += 1;
    }
    for reference in &mut found {
        // A name may stand for a path that begins with another imported name; a few steps end every honest chain.
        for _ in 0..4 {
            let Some(meaning) = names.get(&reference.path[0]).filter(|path| path[0] != reference.path[0])
            else {
                break;
            };
            reference.path.splice(0..1, meaning.iter().cloned());
        }
    }
    found
}

/// Reads one `use` tree and returns the index after it; each import is a path, the name it gets, and its line.
fn use_tree(
    tokens: &[Token],
    mut i: usize,
    prefix: &[String],
    imports: &mut Vec<(Vec<String>, String, usize)>,
) -> usize {
    let mut path = prefix.to_vec();
    while i < tokens.len() {
        let Token { text, line } = &tokens[i];
        match text.as_str() {
            "::" => i += 1,
            "{" => {
                i += 1;
                while i < tokens.len() && tokens[i].text != "}" {
                    i = if tokens[i].text == "," { i + 1 } else { use_tree(tokens, i, &path, imports) };
                }
                return i + 1;
            }
            word => {
                i += 1;
                if word != "self" || path.is_empty() {
                    path.push(word.to_owned());
                }
                if stands_at(tokens, i, &["::"]) {
                    continue;
                }
                let mut name = path.last().cloned().unwrap_or_default();
                if stands_at(tokens, i, &["as"]) {
                    name = tokens[i + 1].text.clone();
                    i += 2;
                }
                imports.push((path, name, *line));
                return i;
            }
        }
    }
    i
}

/// `path` as seen from the crate's root when it stands in the module `here`. The binary calls the library `mariana`.
fn from_root(path: Vec<String>, here: &[String]) -> Vec<String> {
    let mut rest = path.as_slice();
    let mut base = match path[0].as_str() {
        "crate" | "mariana" => {
            rest = &rest[1..];
            Vec::new()
        }
        "self" | "super" => here.to_vec(),
        _ => return path,
    };
    while let Some(step @ ("self" | "super")) = rest.first().map(String::as_str) {
        if step == "super" {
            base.pop();
        }
        rest = &rest[1..];
    }
    std::iter::once("crate".to_owned()).chain(base).chain(rest.iter().cloned()).collect()
}
