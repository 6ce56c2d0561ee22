//! The library: shapes, operators and the GLSL functions that are not built in. It is written in the scene language.
//!
//! The library's texts are parsed at the first use. Lines that begin with `##` document the function below them. The
//! last of these lines ends with `[exact; source]`, `[bound; source]` or `[source]`. *Exact* functions return the
//! distance to the surface. *Bound* functions return at most that distance, so rays may still step by the result. A
//! line that begins with `#>` is the formula of the function's preview.

use std::sync::LazyLock;

use super::ast::{Ast, Function, Item};
use super::builtin::{BUILTIN_TEXT, BUILTINS, BuiltinRow, FOLDS, INPUTS, InputRow};
use super::diagnostic::Diagnostics;
use super::symbol::{Interner, Symbol};
use super::token::RESERVED;
use super::{lexer, parser};
use crate::graph::{LevelList, PartInput, SongPart};
use crate::limits::LIMITS;

/// The group of the built-in functions.
const BUILT_IN: &str = "Built in";

pub(super) const TEXTS: &[(&str, &str)] = &[
    ("Functions of GLSL", include_str!("glsl.scene")),
    ("Shapes in space", include_str!("solids.scene")),
    ("Shapes in the plane", include_str!("plane.scene")),
    ("Combining shapes", include_str!("combine.scene")),
    ("Changing space and shapes", include_str!("space.scene")),
    ("Noise", include_str!("noise.scene")),
    ("Materials", include_str!("materials.scene")),
    ("Cameras and paths", include_str!("camera.scene")),
];

/// The accuracy of a shape's distance function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Accuracy {
    /// The function returns the distance.
    Exact,
    /// The function returns at most the distance.
    Bound,
}

/// The documentation of a function that scenes can call.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// The title of its group.
    pub group: &'static str,
    /// The name.
    pub name: &'static str,
    /// The name and the parameters, as in a declaration.
    pub signature: String,
    /// The description of the result.
    pub doc: String,
    /// The accuracy of the distance; `None` for functions that return no distance.
    pub accuracy: Option<Accuracy>,
    /// The source of the formula; empty for built-in functions.
    pub source: String,
    /// The formula of its preview.
    pub example: Option<&'static str>,
}

pub(super) struct Library {
    /// Reserved words, inputs, built-in functions and the library's names, in this order.
    pub names: Interner,
    /// The names of the song's parts.
    pub parts: [Symbol; SongPart::ALL.len()],
    pub ast: Ast,
    pub functions: Vec<Function>,
    /// For each symbol: 1 + the function's index; 0 if the symbol is no function.
    by_symbol: Vec<u32>,
    /// For each symbol: 1 + the number of final arguments that every step of a fold gets; 0 if it is no fold.
    pub folds: Vec<u8>,
}

static LIBRARY: LazyLock<Library> = LazyLock::new(build);

pub(super) fn library() -> &'static Library {
    &LIBRARY
}

pub(super) fn input(symbol: Symbol) -> Option<&'static InputRow> {
    INPUTS.get(symbol.index().checked_sub(RESERVED.len())?)
}

pub(super) fn builtin(symbol: Symbol) -> Option<&'static BuiltinRow> {
    BUILTINS.get(symbol.index().checked_sub(RESERVED.len() + INPUTS.len())?)
}

/// Returns the library's function of a name.
pub(super) fn function(symbol: Symbol) -> Option<&'static Function> {
    let number = *LIBRARY.by_symbol.get(symbol.index())? as usize;
    LIBRARY.functions.get(number.checked_sub(1)?)
}

fn build() -> Library {
    let mut names = Interner::default();
    let brought = RESERVED.iter().copied();
    let brought = brought.chain(INPUTS.iter().map(|row| row.name)).chain(BUILTINS.iter().map(|row| row.name));
    for name in brought {
        names.intern(name);
    }
    let parts = SongPart::ALL.map(|part| names.intern(part.name()));
    // Ignore the diagnostics: a test checks that these texts have no mistakes.
    let mut diagnostics = Diagnostics::new(LIMITS.scene_diagnostics_max);
    let (mut ast, mut functions) = (Ast::default(), Vec::new());
    for (_, text) in TEXTS {
        let mut tokens = Vec::new();
        lexer::tokenize(text, 0, usize::MAX, &mut names, &mut tokens, &mut diagnostics);
        let items = parser::parse(&tokens, &names, LIMITS.scene_nesting_max, &mut ast, &mut diagnostics);
        functions.extend(items.into_iter().filter_map(|item| match item {
            Item::Fn(function) => Some(function),
            _ => None,
        }));
    }
    let (mut by_symbol, mut folds) = (vec![0; names.len()], vec![0; names.len()]);
    for (index, function) in functions.iter().enumerate() {
        by_symbol[function.name.symbol.index()] = index as u32 + 1;
    }
    for (name, tail) in FOLDS {
        if let Some(symbol) = names.get(name) {
            folds[symbol.index()] = *tail as u8 + 1;
        }
    }
    Library { names, parts, ast, functions, by_symbol, folds }
}

/// Returns the name and description of each input.
pub fn inputs() -> impl Iterator<Item = (&'static str, &'static str)> {
    INPUTS.iter().map(|row| (row.name, row.doc))
}

/// Returns the name and description of each part of the song.
pub fn parts() -> impl Iterator<Item = (&'static str, &'static str)> {
    SongPart::ALL.into_iter().map(|part| (part.name(), part.doc()))
}

/// True for the name of a part of the song, such as `drums`.
pub fn is_part(name: &str) -> bool {
    SongPart::ALL.iter().any(|part| part.name() == name)
}

/// Returns the name and description of each input that a part of the song has: `volume` in `drums.volume`.
pub fn part_inputs() -> impl Iterator<Item = (&'static str, &'static str)> {
    let names: Vec<&str> =
        PartInput::sounds().map(|input| input.name().split('.').next().unwrap_or_default()).collect();
    let of_parts = move |row: &&InputRow| names.contains(&row.name);
    let band = (LevelList::Band.name(), LevelList::Band.doc());
    INPUTS.iter().filter(of_parts).map(|row| (row.name, row.doc)).chain([band])
}

/// Returns the names of the functions that have a preview, each with the formula that the preview shows.
pub fn examples() -> impl Iterator<Item = (&'static str, &'static str)> {
    entries().iter().filter_map(|entry| Some((entry.name, entry.example?)))
}

/// Returns all functions that a scene can call: the built-in ones, then the library in the order of its texts.
pub fn entries() -> &'static [Entry] {
    static ENTRIES: LazyLock<Vec<Entry>> = LazyLock::new(read_entries);
    &ENTRIES
}

fn read_entries() -> Vec<Entry> {
    let mut entries = Vec::new();
    for (group, text) in std::iter::once(&(BUILT_IN, BUILTIN_TEXT)).chain(TEXTS) {
        let (mut doc, mut example) = (String::new(), None);
        for line in text.lines() {
            if let Some(rest) = line.strip_prefix("## ") {
                if !doc.is_empty() {
                    doc.push(' ');
                }
                doc.push_str(rest);
            } else if let Some(formula) = line.strip_prefix("#> ") {
                example = Some(formula);
            } else if let Some(rest) = line.strip_prefix("fn ") {
                entries.push(entry(group, rest, std::mem::take(&mut doc), example.take()));
            } else {
                doc.clear();
            }
        }
    }
    entries
}

fn entry(group: &'static str, head: &'static str, doc: String, example: Option<&'static str>) -> Entry {
    let name = head.split('(').next().unwrap_or("");
    let doc = LevelList::named(name).map_or(doc, |list| list.doc().to_owned());
    let signature = head.find(')').and_then(|end| head.get(..=end)).unwrap_or(head).to_owned();
    let bracket = doc.rfind('[').unwrap_or(doc.len());
    let (sentences, facts) = doc.split_at(bracket);
    let facts = facts.trim_matches(['[', ']']);
    let (accuracy, source) = match facts.split_once(';') {
        Some(("exact", source)) => (Some(Accuracy::Exact), source),
        Some(("bound", source)) => (Some(Accuracy::Bound), source),
        _ => (None, facts),
    };
    let source = source.trim().to_owned();
    Entry { group, name, signature, doc: sentences.trim().to_owned(), accuracy, source, example }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inputs_and_built_in_functions_are_described() {
        let described: Vec<&Entry> = entries().iter().filter(|entry| entry.group == BUILT_IN).collect();
        assert!(described.iter().all(|entry| !entry.doc.is_empty()));
        assert!(INPUTS.iter().all(|row| !row.doc.is_empty()));
        let names: Vec<&str> = described.iter().map(|entry| entry.name).collect();
        assert_eq!(names, BUILTINS.iter().map(|row| row.name).collect::<Vec<_>>());
    }
}
