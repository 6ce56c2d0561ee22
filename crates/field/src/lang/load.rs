//! Loads a scene's text and its includes, and parses them into one syntax tree.

use super::ast::{Ast, Item, Name};
use super::diagnostic::{Diagnostic, Diagnostics};
use super::foreign::{self, ForeignFile, is_glsl, is_shader};
use super::source::{Sources, Span};
use super::symbol::Interner;
use super::{Resolver, lexer, library, parser, path};
use crate::glsl_import::{GlslFile, Shown, scene_around_file, whole};
use crate::limits::Limits;

#[derive(Default)]
pub(super) struct Loaded {
    pub ast: Ast,
    pub names: Interner,
    pub items: Vec<Item>,
    pub includes: Vec<String>,
    pub foreign: Vec<ForeignFile>,
    /// True if a GLSL file cannot be read. Its functions are not reported as missing then.
    pub foreign_broken: bool,
}

/// Parses `text` and its includes, depth first: an included text precedes the text that includes it. Also returns the
/// texts and the mistakes. The tree has [`Ast::name_events`] if `records_names` is set.
pub(super) fn load(
    name: &str,
    text: &str,
    resolve: &mut Resolver<'_>,
    limits: &Limits,
    records_names: bool,
) -> (Loaded, Sources, Diagnostics) {
    let mut loaded = Loaded { names: library::library().names.clone(), ..Loaded::default() };
    loaded.ast.name_events = records_names.then(Vec::new);
    let (sources, diagnostics) = (Sources::default(), Diagnostics::new(limits.scene_diagnostics_max));
    // A file that includes itself is in the scene's folder.
    let open = name.rsplit(['/', '\\']).next().map(str::to_owned).into_iter().collect();
    let mut loader = Loader { loaded, resolve, limits, sources, diagnostics, bytes: 0, tokens: 0, open };
    if is_shader(text) {
        loader.shader(name, text);
    } else {
        loader.file(name, text, None);
    }
    (loader.loaded, loader.sources, loader.diagnostics)
}

struct Loader<'a, 'b> {
    loaded: Loaded,
    resolve: &'a mut Resolver<'b>,
    limits: &'a Limits,
    sources: Sources,
    diagnostics: Diagnostics,
    bytes: usize,
    tokens: usize,
    /// Files that are being read, the outermost first.
    open: Vec<String>,
}

impl Loader<'_, '_> {
    /// Recurses no deeper than the limit for includes.
    fn file(&mut self, name: &str, text: &str, included: Option<Span>) {
        if let Some(base) = self.keep(name, text, included) {
            self.parse(text, base);
        }
    }

    /// Parses a scene's text, whose first byte has the offset `base`.
    fn parse(&mut self, text: &str, base: u32) {
        let mut tokens = Vec::new();
        let left = self.limits.scene_tokens_max.saturating_sub(self.tokens);
        lexer::tokenize(text, base, left, &mut self.loaded.names, &mut tokens, &mut self.diagnostics);
        self.tokens += tokens.len();
        let nesting = self.limits.scene_nesting_max;
        let items =
            parser::parse(&tokens, &self.loaded.names, nesting, &mut self.loaded.ast, &mut self.diagnostics);
        drop(tokens);
        for item in items {
            match item {
                Item::Include { path } => self.include(path),
                item => self.loaded.items.push(item),
            }
        }
    }

    /// Adds a text to the sources. Reports a text that is too long, and returns `None`.
    fn keep(&mut self, name: &str, text: &str, included: Option<Span>) -> Option<u32> {
        self.bytes = self.bytes.saturating_add(text.len());
        let max = self.limits.scene_bytes_max;
        let base = if self.bytes > max { None } else { self.sources.add(name, text) };
        if base.is_none() {
            // The text is too long to be kept. Report this at its include, or at the start of an empty scene.
            let span = included.unwrap_or_else(|| {
                self.sources.add(name, "");
                Span::default()
            });
            let message = format!("the scene is larger than {max} bytes, counting its includes");
            let hint = "split it into scenes, or write repeated parts with `fn` and `for`";
            self.diagnostics.push(Diagnostic::over_limit(span, message).hint(hint));
        }
        base
    }

    /// Reads a text in GLSL as the scene that the import of shaders makes of it.
    fn shader(&mut self, name: &str, text: &str) {
        self.glsl(name, text, None);
        let Some(ForeignFile { file, whole, base }) = self.loaded.foreign.last() else { return };
        match scene_around_file(file, Shown::default()) {
            Ok(around) => {
                if !around.left_out.is_empty() {
                    let message = format!("the shader's scene leaves out {}", around.left_out.join("; "));
                    self.diagnostics.warn(Diagnostic::warning(Span::default(), message));
                }
                if let Some(base) = self.sources.end() {
                    self.parse(&around.body, base);
                }
            }
            Err(problem) => {
                self.loaded.foreign_broken = true;
                self.diagnostics.push(foreign::diagnostic(*base, whole, &problem, Span::default()));
            }
        }
    }

    /// Reads a GLSL file: an included one, or the text itself.
    fn glsl(&mut self, name: &str, text: &str, included: Option<Span>) {
        let Some(base) = self.keep(name, text, included) else {
            self.loaded.foreign_broken = true;
            return;
        };
        let folder = included.and_then(|_| name.rsplit_once('/'));
        let folder = folder.map_or(String::new(), |(folder, _)| format!("{folder}/"));
        let resolve = &mut *self.resolve;
        let whole = whole(text, &mut |name| {
            path::checked(&format!("{folder}{name}")).ok().and_then(|path| resolve(&path).ok())
        });
        self.loaded.includes.extend(whole.files.iter().map(|file| format!("{folder}{file}")));
        match GlslFile::parse(&whole.text, self.limits) {
            Ok(file) => {
                for function in file.functions() {
                    self.loaded.names.intern(&function.name);
                }
                self.loaded.foreign.push(ForeignFile { file, whole, base });
            }
            Err(problem) => {
                self.loaded.foreign_broken = true;
                let place = included.unwrap_or_default();
                self.diagnostics.push(foreign::diagnostic(base, &whole, &problem, place));
            }
        }
    }

    fn include(&mut self, written: Name) {
        let span = written.span;
        let name = match path::checked(self.loaded.names.name(written.symbol)) {
            Ok(name) => name,
            Err((message, hint)) => return self.diagnostics.push(Diagnostic::new(span, message).hint(hint)),
        };
        if let Some(position) = self.open.iter().position(|open| *open == name) {
            let mut circle: Vec<String> =
                self.open.iter().skip(position).map(|one| format!("`{one}`")).collect();
            circle.push(format!("`{name}`"));
            let message = format!("files include each other in a circle: {}", circle.join(" includes "));
            return self.diagnostics.push(Diagnostic::new(span, message).hint("remove this `include`"));
        }
        // If the list of mistakes is full, request no more files, so that failing includes cost no time.
        if self.loaded.includes.contains(&name) || self.diagnostics.full() {
            return;
        }
        let (depth, count) = (self.limits.include_depth_max, self.limits.scene_includes_max);
        if self.open.len() > depth {
            let message = format!("files include each other more than {depth} deep");
            let hint = "include this file from the scene or from a less deeply included file";
            return self.diagnostics.push(Diagnostic::over_limit(span, message).hint(hint));
        }
        if self.loaded.includes.len() >= count {
            let message = format!("the scene includes more than {count} files");
            let hint = "merge some of them into one file";
            return self.diagnostics.push(Diagnostic::over_limit(span, message).hint(hint));
        }
        match (self.resolve)(&name) {
            Err(reason) => {
                self.loaded.foreign_broken |= is_glsl(&name);
                let wrong = Diagnostic::new(span, format!("`{name}` cannot be included: {reason}"));
                self.diagnostics.push(wrong);
            }
            Ok(text) => {
                self.loaded.includes.push(name.clone());
                if is_glsl(&name) {
                    return self.glsl(&name, &text, Some(span));
                }
                self.open.push(name.clone());
                self.file(&name, &text, Some(span));
                self.open.pop();
            }
        }
    }
}
