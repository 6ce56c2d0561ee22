//! The scene language: compiles text to a checked scene.
//!
//! ```text
//! text → lexer → tokens → parser → tree → lower → Scene (one expression graph, and the meaning of its nodes)
//! ```
//!
//! [`compile`] accepts every text. If there is no mistake, it returns a [`Scene`]; otherwise it returns the mistakes
//! as [`Diagnostic`]s, up to a limit. It never panics. Recursion and memory are limited by [`crate::limits`].
//!
//! **Meaning.** The language follows GLSL: vectors of two to four numbers with swizzles, functions that apply to each
//! component, scalars that combine with every vector. Types are inferred for each use. Functions are expanded and
//! loops are unrolled: a scene is one expression, and recursion is a mistake. For integer exponents `x^2` is a
//! product, defined for negative x; `^` groups from the right and binds tighter than a preceding minus. `a % b` is
//! GLSL's mod. Division by zero gives 0 (see [`crate::graph`]).
//!
//! **Names.** A name in a function is a parameter, a `let` of the function, a `let` or `param` of the scene, or an
//! input, in this order. Functions have a separate namespace, so `let box = box(p, 1)` is fine. A scene's function
//! hides the library's, except within the library.
//!
//! This module does no I/O: a [`Resolver`] supplies the texts that `include` names.

mod about;
mod ast;
mod builtin;
mod changing;
mod diagnostic;
mod fields;
mod foreign;
mod formatting;
mod glsl_names;
mod lexer;
mod library;
mod load;
mod lower;
mod material;
mod names;
mod origins;
mod parser;
mod path;
mod pieces;
mod scene;
mod shape;
mod source;
mod suggest;
mod symbol;
#[cfg(test)]
mod tests;
mod token;
mod value;
mod words;

pub use about::{About, TransitionStyle};
pub use ast::{NameKind, Section};
pub use changing::{Turning, changed_numbers, number_place};
pub use diagnostic::{Diagnostic, Fault, columns, render_all};
pub use fields::{DefaultValue, Field, FieldRange, Holds};
pub use foreign::{is_glsl, is_shader};
pub use formatting::formatted;
pub use library::{Accuracy, Entry, entries, examples, inputs, is_part, part_inputs, parts};
pub(crate) use lower::{FORGOTTEN, VISIBLE, outlasting};
pub use lower::{plural, section_fields};
pub use material::{Material, material_glsl};
pub(crate) use material::{SURFACE_NUMBERS, material_members};
pub use names::{Declaration, Meaning, Names, names};
pub use origins::{Origins, TextPlace};
pub use parser::{Operator, PREFIX_BINDS, item_words, operators};
pub use scene::{
    Camera, Light, LightKind, Medium, MovingTexture, Object, Param, Picture, Scene, Sky, Swarm, TextureRef,
    ToneMap,
};
pub use shape::{ShapeRef, ShapeSource, SongText, TextBaker};
pub use source::{Place, SourceFile, Sources, Span};
pub use suggest::nearest;
#[cfg(test)]
pub(crate) use tests::SHAPES;
pub use words::{Word, WordKind, keywords, reserved_words, type_names, words};

use std::collections::BTreeSet;

use crate::limits::{LIMITS, Limits};
use changing::ChangingNumbers;

/// Returns the text of an included file, or an error message in plain words. The path is relative to the scene's
/// folder, has `/` between folders and never leads out of the folder.
pub type Resolver<'a> = dyn FnMut(&str) -> Result<String, String> + 'a;

/// A [`Resolver`] for scenes that are not files: nothing can be included.
///
/// # Errors
/// Always returns an error message.
pub fn no_includes(_path: &str) -> Result<String, String> {
    Err("only a scene that is a file can include other files".to_owned())
}

/// The result of compiling a text.
#[derive(Debug, Clone)]
pub struct Compiled {
    /// The scene, if there was no mistake.
    pub scene: Option<Scene>,
    /// The mistakes, in the order of the text; empty if and only if there is a scene.
    pub diagnostics: Vec<Diagnostic>,
    /// The warnings of a scene without mistakes, in the order of the text.
    pub warnings: Vec<Diagnostic>,
    /// The texts that spans refer to.
    pub sources: Sources,
    /// Paths that were requested from the [`Resolver`], including refused paths: in order, without duplicates.
    pub includes_asked: Vec<String>,
}

impl Compiled {
    /// Returns all diagnostics as text, with terminal colours if `color` is set; empty if there are none.
    pub fn render(&self, color: bool) -> String {
        render_all(&self.diagnostics, &self.sources, color)
    }
}

/// Compiles a scene, or a bare formula, with the program's limits. `name` is the text's name in diagnostics.
pub fn compile(name: &str, text: &str, resolve: &mut Resolver<'_>) -> Compiled {
    compile_all(name, text, resolve, &LIMITS, ChangingNumbers::default())
}

/// Compiles a text in which some numbers are being edited. The numbers with the indices `changing`
/// ([`changed_numbers`]) become inputs of a frame, numbered after the scene's parameters. The numbers in `turning` are
/// being dragged: a frame may set such a number within its range without compiling the text again.
pub fn compile_while_changing(
    name: &str,
    text: &str,
    resolve: &mut Resolver<'_>,
    changing: &BTreeSet<usize>,
    turning: &[Turning],
) -> Compiled {
    if !changing.is_empty() || !turning.is_empty() {
        let compiled =
            compile_all(name, text, resolve, &LIMITS, ChangingNumbers::of(text, changing, turning));
        if compiled.scene.is_some() {
            return compiled;
        }
    }
    // The mistake may be that an edited number has to be constant, so compile again with constants.
    compile(name, text, resolve)
}

fn compile_all(
    name: &str,
    text: &str,
    resolve: &mut Resolver<'_>,
    limits: &Limits,
    changing: ChangingNumbers,
) -> Compiled {
    let mut includes_asked = Vec::new();
    let mut note_and_resolve = |path: &str| {
        if !includes_asked.iter().any(|known| known == path) {
            includes_asked.push(path.to_owned());
        }
        resolve(path)
    };
    let (loaded, sources, mut diagnostics) = load::load(name, text, &mut note_and_resolve, limits, false);
    let scene = lower::lower(loaded, changing, limits, &sources, &mut diagnostics);
    let scene = if diagnostics.is_empty() { scene } else { None };
    let warnings = if scene.is_some() { diagnostics.drain_warnings() } else { Vec::new() };
    Compiled { scene, warnings, diagnostics: diagnostics.finish(), sources, includes_asked }
}

/// Checks only a text's tokens and grammar: reads no includes, resolves no names. Returns mistakes and sources.
pub fn check_syntax(name: &str, text: &str) -> (Vec<Diagnostic>, Sources) {
    let (_, sources, diagnostics) = load::load(name, text, &mut |_| Ok(String::new()), &LIMITS, false);
    (diagnostics.finish(), sources)
}
