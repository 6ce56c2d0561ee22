//! GLSL files that a scene includes.

use std::ops::Range;

use super::diagnostic::Diagnostic;
use super::source::Span;
use crate::glsl_import::{GlslFile, Problem, Whole};

/// Endings of the names of GLSL files.
const ENDINGS: [&str; 6] = [".glsl", ".frag", ".fs", ".fsh", ".glslf", ".shadertoy"];

/// True if `include` reads a file of this name as GLSL.
pub fn is_glsl(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    ENDINGS.iter().any(|ending| name.ends_with(ending))
}

/// A parsed GLSL file with all that it includes, and the offset of its own text in the sources.
pub(super) struct ForeignFile {
    pub file: GlslFile,
    pub whole: Whole,
    pub base: u32,
}

impl ForeignFile {
    pub(super) fn span(&self, place: &Range<u32>) -> Span {
        span(self.base, &self.whole.place(place))
    }

    pub(super) fn diagnostic(&self, problem: &Problem, otherwise: Span) -> Diagnostic {
        diagnostic(self.base, &self.whole, problem, otherwise)
    }
}

fn span(base: u32, place: &Range<u32>) -> Span {
    Span::new(base + place.start, base + place.end)
}

/// Returns a problem as a diagnostic in the file at `base`. A problem without a place is reported at `otherwise`.
pub(super) fn diagnostic(base: u32, whole: &Whole, problem: &Problem, otherwise: Span) -> Diagnostic {
    let span = if problem.place.is_empty() { otherwise } else { span(base, &whole.place(&problem.place)) };
    let diagnostic = Diagnostic { fault: problem.kind, ..Diagnostic::new(span, problem.message.clone()) };
    if problem.hint.is_empty() { diagnostic } else { diagnostic.hint(problem.hint.clone()) }
}
