//! Reports of mistakes, always at a location in the scene's own text rather than in the library.

use super::super::diagnostic::{Diagnostic, Diagnostics};
use super::super::source::Span;
use super::super::symbol::{Interner, Symbol};
use super::super::value::Value;
use super::super::{library, suggest};
use crate::graph::SongPart;
use crate::limits::Limits;

const CALLS_SHOWN: usize = 3;

/// The list of diagnostics, and the calls around the expression that is being lowered.
pub(super) struct Reports<'a> {
    pub diagnostics: &'a mut Diagnostics,
    pub names: &'a Interner,
    /// The scene's functions and lets that are being expanded, each with the location of its use.
    pub calls: Vec<(Symbol, Span)>,
    /// The scene's outermost call of a library function, if one is being expanded.
    pub library_call: Option<(Symbol, Span)>,
    pub stopped: bool,
}

impl Reports<'_> {
    /// Reports a mistake. A mistake in a library function is reported at the scene's call of that function. Returns
    /// [`Value::Unknown`].
    #[cold]
    pub(super) fn add(&mut self, mut diagnostic: Diagnostic) -> Value {
        if let Some((_, span)) = self.library_call {
            diagnostic.span = span;
            diagnostic.notes.clear();
        }
        for (symbol, span) in self.calls.iter().rev().take(CALLS_SHOWN) {
            diagnostic.notes.push((*span, format!("`{}` is used here", self.names.name(*symbol))));
        }
        self.diagnostics.push(diagnostic);
        self.stopped |= self.diagnostics.full();
        Value::Unknown
    }

    /// Like [`Self::add`], and returns `None`.
    #[cold]
    pub(super) fn refuse<T>(&mut self, diagnostic: Diagnostic) -> Option<T> {
        self.add(diagnostic);
        None
    }

    #[cold]
    pub(super) fn stop(&mut self, span: Span, message: String, hint: &str) -> Value {
        let value = self.add(Diagnostic::over_limit(span, message).hint(hint));
        self.stopped = true;
        value
    }

    /// Reports expressions that are nested deeper than `max` levels.
    #[cold]
    pub(super) fn too_deep(&mut self, max: usize, span: Span) {
        let message = format!("expressions and function calls are nested deeper than {max} levels");
        self.stop(span, message, "nest fewer function calls");
    }

    /// Reports a list that has no room for one more entry. `what` names the entries.
    pub(super) fn is_full(&mut self, count: usize, max: usize, what: &str, hint: &str, span: Span) -> bool {
        let is_full = count >= max;
        if is_full {
            self.stop(span, format!("the scene has more than {max} {what}"), hint);
        }
        is_full
    }

    /// Reports a loop with too many iterations.
    pub(super) fn loop_too_long(&mut self, iterations: i64, limits: &Limits, hint: &str, span: Span) -> bool {
        let max = limits.scene_loop_max;
        let is_too_long = iterations > max as i64;
        if is_too_long {
            let message = format!("this loop has {iterations} iterations; the maximum is {max}");
            self.add(Diagnostic::over_limit(span, message).hint(hint));
        }
        is_too_long
    }

    /// Returns a loop's bound. Reports a number that is not whole or too large.
    pub(super) fn whole_bound(&mut self, value: f32, span: Span) -> Option<i64> {
        if value.fract() != 0.0 || value.abs() > 1e6 {
            let message = format!("a loop's bounds must be whole numbers up to 1000000, but this is {value}");
            return self.refuse(Diagnostic::new(span, message));
        }
        Some(value as i64)
    }

    /// Reports that a name depends on itself, and through which names it does.
    #[cold]
    pub(super) fn circle(&mut self, symbol: Symbol, span: Span) -> Value {
        let first = self.calls.iter().position(|call| call.0 == symbol).unwrap_or(0);
        let style = self.calls.iter().skip(first).map(|call| call.0).chain([symbol]);
        let style: Vec<String> = style.map(|symbol| format!("`{}`", self.names.name(symbol))).collect();
        let message = if style.len() <= 2 {
            format!("{} uses itself", style.first().map_or("this", String::as_str))
        } else {
            format!("these names depend on each other in a circle: {}", style.join(" → "))
        };
        let hint = "there is no recursion: repeat with `for`";
        // The message already names the calls, so they need no notes.
        let calls = std::mem::take(&mut self.calls);
        let value = self.add(Diagnostic::unsupported(span, message).hint(hint));
        self.calls = calls;
        value
    }

    #[cold]
    pub(super) fn loop_without_values(&mut self, name: &str, span: Span) -> Value {
        let empty = Diagnostic::new(span, format!("this loop has no iterations, so `{name}` has no values"));
        self.add(empty.hint(
            "`for i in a..b` runs from a to b - 1, so let b be larger; to leave out a shape, add a far one: \
             `union(1000, for …)`",
        ))
    }

    #[cold]
    pub(super) fn sizes_differ(&mut self, what: &str, left: Value, right: Value, span: Span) -> Value {
        let (a, b) = (left.described(), right.described());
        let wrong = Diagnostic::new(span, format!("{what} needs vectors of the same size, not {a} and {b}"));
        self.add(wrong.hint("give both the same number of components, as in `p.xz`"))
    }

    #[cold]
    pub(super) fn count_message(
        &mut self,
        name: Symbol,
        count: usize,
        takes: (usize, usize),
        hint: String,
        span: Span,
    ) {
        let number = match takes {
            (1, 1) => "1 argument".to_owned(),
            (least, most) if least == most => format!("{most} arguments"),
            (least, most) => format!("{least} to {most} arguments"),
        };
        let message = format!("`{}` takes {number}, but gets {count}", self.names.name(name));
        self.add(Diagnostic::new(span, message).hint(hint));
    }

    #[cold]
    pub(super) fn no_such_number(&mut self, part: SongPart, name: &str, span: Span) -> Value {
        let names: Vec<&str> = library::part_inputs().map(|(name, _)| name).collect();
        let near = suggest::nearest(name, names.iter().copied());
        let short: String = name.chars().take(60).collect();
        let unknown = Diagnostic::new(span, format!("`{}` has no input `{short}`", part.name()));
        let of_song = crate::graph::SoundInput::named(name).is_some();
        let hint = match near {
            _ if name == "band" => format!("write the band's number, as in `{}.band(3)`", part.name()),
            Some(near) => format!("did you mean `{}.{near}`?", part.name()),
            None if of_song => {
                format!("`{name}` describes the whole song: read it without `{}.`", part.name())
            }
            None => format!("a part of the song has {}", names.join(", ")),
        };
        self.add(unknown.hint(hint))
    }
}
