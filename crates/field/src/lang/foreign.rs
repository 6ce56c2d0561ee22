//! GLSL files that a scene includes, and scenes that are written in GLSL.

use super::diagnostic::Diagnostic;
use super::parser::{declares_glsl, item_words};
use super::source::{BYTE_ORDER_MARK, Span};
use crate::glsl_import::{GlslFile, Whole};

/// Endings of the names of GLSL files.
const ENDINGS: [&str; 6] = [".glsl", ".frag", ".fs", ".fsh", ".glslf", ".shadertoy"];

/// True if `include` reads a file of this name as GLSL.
pub fn is_glsl(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    ENDINGS.iter().any(|ending| name.ends_with(ending))
}

/// First words of texts in GLSL that are not among the types and qualifiers of the parser of scenes.
const DECLARING: &str = "ivec2 ivec3 ivec4 uvec2 uvec3 uvec4 bvec2 bvec3 bvec4 struct in layout smooth";

/// True if a text is GLSL. Behind comments and lines for the preprocessor, which scenes read as comments, such a text
/// declares something, and it has no part of a scene: no line begins one, and the text does not end with a formula.
pub fn is_shader(text: &str) -> bool {
    let mut rest = text.trim_start_matches(BYTE_ORDER_MARK);
    loop {
        rest = rest.trim_start();
        if let Some(comment) = rest.strip_prefix("/*") {
            rest = comment.split_once("*/").map_or("", |(_, rest)| rest);
        } else if rest.starts_with('#') || rest.starts_with("//") {
            let mut length = 0;
            for line in rest.split_inclusive('\n') {
                length += line.len();
                if !line.trim_end().ends_with('\\') {
                    break;
                }
            }
            rest = rest.get(length..).unwrap_or_default();
        } else {
            break;
        }
    }
    let is_of_word = |c: char| c.is_alphanumeric() || c == '_';
    let (first, follows) = rest.split_at(rest.find(|c| !is_of_word(c)).unwrap_or(rest.len()));
    let declares = declares_glsl(first) || DECLARING.split(' ').any(|word| word == first);
    declares
        && (first == "layout" || follows.trim_start().starts_with(is_of_word))
        && rest.contains(';')
        && !rest.lines().any(begins_part_of_scene)
        && !ends_with_formula(rest)
}

/// True for a line such as `let a = 1` or `object ball {`.
fn begins_part_of_scene(line: &str) -> bool {
    let word = line.split_whitespace().next().unwrap_or_default();
    matches!(word, "let" | "fn" | "param" | "include")
        || (line.contains('{') && item_words().any(|item| item == word))
}

/// The code of a line, without its comment; `None` for a comment or a line for the preprocessor.
fn code_of(line: &str) -> Option<&str> {
    match line.trim() {
        line if line.starts_with('#') || line.ends_with("*/") => None,
        line => line.split("//").next().map(str::trim_end).filter(|code| !code.is_empty()),
    }
}

fn ends_with_formula(text: &str) -> bool {
    let count = |sign| text.bytes().filter(|byte| *byte == sign).count();
    let last = text.lines().rev().find_map(code_of).unwrap_or_default();
    // In a text that is being written, a block may be open.
    count(b'{') <= count(b'}') && !last.ends_with(['}', ';'])
}

/// A parsed GLSL file with all that it includes, and the offset of its own text in the sources.
pub(super) struct ForeignFile {
    pub file: GlslFile,
    pub whole: Whole,
    pub base: u32,
}

impl ForeignFile {
    pub(super) fn span(&self, place: Span) -> Span {
        span(self.base, self.whole.place(place))
    }

    pub(super) fn diagnostic(&self, problem: &Diagnostic, otherwise: Span) -> Diagnostic {
        diagnostic(self.base, &self.whole, problem, otherwise)
    }
}

fn span(base: u32, place: Span) -> Span {
    Span::new(base + place.start, base + place.end)
}

/// Returns a mistake in a GLSL text with its span in the sources, where the text begins at `base`. A mistake without a
/// span gets the span `otherwise`.
pub(super) fn diagnostic(base: u32, whole: &Whole, problem: &Diagnostic, otherwise: Span) -> Diagnostic {
    let span = if problem.span.is_empty() { otherwise } else { span(base, whole.place(problem.span)) };
    Diagnostic { span, ..problem.clone() }
}
