//! Reports mistakes at places in the scene's own text.

use super::super::diagnostic::{Diagnostic, Diagnostics};
use super::super::source::Span;
use super::super::symbol::{Interner, Symbol};
use super::super::value::Value;

/// Most calls that a diagnostic lists on the way to its place.
const CALLS_SHOWN: usize = 3;

/// Where diagnostics go, and the calls that lead to the place that is being lowered.
pub(super) struct Reports<'a> {
    pub diagnostics: &'a mut Diagnostics,
    pub names: &'a Interner,
    /// Scene functions and lets that are being expanded: the name and its place.
    pub calls: Vec<(Symbol, Span)>,
    /// Where the scene calls the library: mistakes inside the library are reported at the call.
    pub library_call: Option<(Symbol, Span)>,
    /// A limit was reached: everything else is unknown.
    pub stopped: bool,
}

impl Reports<'_> {
    /// Reports a mistake; a mistake in the library is placed where the scene called it.
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

    /// Reports that a limit is reached and ends the work.
    #[cold]
    pub(super) fn stop(&mut self, span: Span, message: String, hint: &str) -> Value {
        let value = self.add(Diagnostic::over_limit(span, message).hint(hint));
        self.stopped = true;
        value
    }

    /// Reports that a name is defined by itself, with the names in between.
    #[cold]
    pub(super) fn circle(&mut self, symbol: Symbol, span: Span) -> Value {
        let first = self.calls.iter().position(|call| call.0 == symbol).unwrap_or(0);
        let way = self.calls.iter().skip(first).map(|call| call.0).chain([symbol]);
        let way: Vec<String> = way.map(|symbol| format!("`{}`", self.names.name(symbol))).collect();
        let message = if way.len() <= 2 {
            format!("{} uses itself", way.first().map_or("this", String::as_str))
        } else {
            format!("these use each other in a circle: {}", way.join(" → "))
        };
        let hint = "functions are expanded where they are called, so none can call itself: repeat with `for`";
        // The calls on the way would only repeat the message.
        let calls = std::mem::take(&mut self.calls);
        let value = self.add(Diagnostic::unsupported(span, message).hint(hint));
        self.calls = calls;
        value
    }

    /// Reports that `what` takes vectors of one size.
    #[cold]
    pub(super) fn sizes_differ(&mut self, what: &str, left: Value, right: Value, span: Span) -> Value {
        let (a, b) = (left.described(), right.described());
        let wrong = Diagnostic::new(span, format!("{what} needs vectors of the same size, not {a} and {b}"));
        self.add(wrong.hint("take the same number of components of both, as in `p.xz`"))
    }

    /// Reports a call with the wrong number of arguments.
    #[cold]
    pub(super) fn count_message(
        &mut self,
        name: Symbol,
        count: usize,
        (least, most): (usize, usize),
        hint: String,
        span: Span,
    ) {
        let number = match (least, most) {
            (1, 1) => "1 argument".to_owned(),
            (least, most) if least == most => format!("{most} arguments"),
            (least, most) => format!("{least} to {most} arguments"),
        };
        let message = format!("`{}` takes {number}, but gets {count}", self.names.name(name));
        self.add(Diagnostic::new(span, message).hint(hint));
    }
}
