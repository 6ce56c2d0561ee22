//! Mistakes in a scene, and their rendering as text.
//!
//! A mistake is printed like an error of a command-line compiler: message, location, source line, underline, hint. Tabs
//! become four columns, wide characters take two columns, control characters are replaced by a placeholder, and a very
//! long line is cut around its mistake.

use std::fmt::Write;

use super::source::{BYTE_ORDER_MARK, Sources, Span};

/// The kind of a mistake, or a warning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// The text has no valid meaning.
    Malformed,
    /// The text is clear but asks for something that the language does not support.
    Unsupported,
    /// The text exceeds one of the [`crate::limits`].
    OverLimit,
    /// Not a mistake: the text is valid, but probably does not do what its author wants. The scene is drawn.
    Warning,
}

/// One mistake in a scene, or one warning.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// The kind: malformed, unsupported or over a limit.
    pub fault: Fault,
    /// The message, one sentence without its full stop.
    pub message: String,
    /// The location of the mistake.
    pub span: Span,
    /// The words after the underline; may be empty.
    pub label: String,
    /// The advice on how to fix the mistake.
    pub hint: Option<String>,
    /// Related locations, each with an explanation.
    pub notes: Vec<(Span, String)>,
}

impl Diagnostic {
    /// Returns a [`Fault::Malformed`] mistake at `span`.
    pub fn new(span: Span, message: impl Into<String>) -> Self {
        Self {
            fault: Fault::Malformed,
            message: message.into(),
            span,
            label: String::new(),
            hint: None,
            notes: Vec::new(),
        }
    }

    /// Returns a [`Fault::Unsupported`] mistake at `span`.
    pub fn unsupported(span: Span, message: impl Into<String>) -> Self {
        Self { fault: Fault::Unsupported, ..Self::new(span, message) }
    }

    /// Returns a [`Fault::OverLimit`] mistake at `span`.
    pub fn over_limit(span: Span, message: impl Into<String>) -> Self {
        Self { fault: Fault::OverLimit, ..Self::new(span, message) }
    }

    /// Returns a [`Fault::Warning`] at `span`.
    pub fn warning(span: Span, message: impl Into<String>) -> Self {
        Self { fault: Fault::Warning, ..Self::new(span, message) }
    }

    /// Adds `label` after the underline.
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    /// Adds `hint` below the source line.
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// Adds a related location with a note.
    pub fn note(mut self, span: Span, text: impl Into<String>) -> Self {
        self.notes.push((span, text.into()));
        self
    }

    /// Adds the hint "did you mean `similar`?" if `similar` is `Some`.
    pub fn did_you_mean(self, similar: Option<&str>) -> Self {
        match similar {
            Some(name) => self.hint(format!("did you mean `{name}`?")),
            None => self,
        }
    }

    /// Returns the diagnostic as text of several lines, with terminal colours if `color` is set; ends with a newline.
    pub fn render(&self, sources: &Sources, color: bool) -> String {
        let gutter = (self.notes.iter().map(|(span, _)| span))
            .chain([&self.span])
            .filter_map(|span| sources.place(span.start))
            .map(|place| place.line.to_string().len())
            .max()
            .unwrap_or(1);
        let mut printer = Printer { out: String::new(), sources, gutter, color };
        let kind = match self.fault {
            Fault::Warning => printer.painted(WARNING, "warning"),
            _ => printer.painted(ERROR, "error"),
        };
        let message = printer.painted(STRONG, &format!(": {}", self.message));
        let _ = writeln!(printer.out, "{kind}{message}");
        printer.excerpt(self.span, &self.label, '^');
        for (span, text) in &self.notes {
            printer.excerpt(*span, text, '-');
        }
        if let Some(hint) = &self.hint {
            let (sign, help) = (printer.painted(FRAME, "="), printer.painted(STRONG, "help: "));
            let _ = writeln!(printer.out, "{:gutter$} {sign} {help}{hint}", "");
        }
        printer.out
    }
}

/// Returns all diagnostics as text, separated by blank lines; empty if there are none.
pub fn render_all(diagnostics: &[Diagnostic], sources: &Sources, color: bool) -> String {
    let texts: Vec<String> = diagnostics.iter().map(|one| one.render(sources, color)).collect();
    texts.join("\n")
}

/// Maximum width of a source line in columns. Longer lines are cut.
const WIDTH_SHOWN: usize = 120;
/// Number of columns that a cut line shows before its mistake.
const WIDTH_BEFORE: usize = 40;
const TAB: &str = "    ";

/// Prints one diagnostic.
struct Printer<'a> {
    out: String,
    sources: &'a Sources,
    /// The width of the line numbers.
    gutter: usize,
    color: bool,
}

impl Printer<'_> {
    fn painted(&self, code: &str, text: &str) -> String {
        if self.color { format!("\x1b[{code}m{text}\x1b[0m") } else { text.to_owned() }
    }

    fn excerpt(&mut self, span: Span, label: &str, mark: char) {
        let (sources, gutter) = (self.sources, self.gutter);
        let Some(place) = sources.place(span.start) else { return };
        let bar = self.painted(FRAME, "|");
        let arrow = self.painted(FRAME, if mark == '^' { "-->" } else { ":::" });
        let _ =
            writeln!(self.out, "{:gutter$}{arrow} {}:{}:{}", "", place.file.name, place.line, place.column);
        let _ = writeln!(self.out, "{:gutter$} {bar}", "");

        // For each character, the printed text and its width in columns.
        let length = (span.end - span.start) as usize;
        let (mut shown, mut before, mut under) = (String::new(), 0, 0);
        let (first, last) = (place.byte, place.byte + length.max(1));
        let lead: usize = place.text.get(..first).unwrap_or("").chars().map(columns).sum();
        let skip = if lead > WIDTH_SHOWN - WIDTH_BEFORE { lead - WIDTH_BEFORE } else { 0 };
        if skip > 0 {
            shown.push('…');
            before += 1;
        }
        let mut column = 0;
        for (at, character) in place.text.char_indices() {
            let (text, width) = cell(character);
            column += width;
            if column <= skip {
                continue;
            }
            if column > skip + WIDTH_SHOWN {
                break;
            }
            shown.push_str(text.unwrap_or(character.encode_utf8(&mut [0; 4])));
            if at < first {
                before += width;
            } else if at < last {
                under += width;
            }
        }
        if column > skip + WIDTH_SHOWN {
            shown.push('…');
        }
        let number = self.painted(FRAME, &format!("{:>gutter$}", place.line));
        let _ = writeln!(self.out, "{number} {bar} {}", shown.trim_end());
        let marks = mark.to_string().repeat(under.max(1));
        let text = if label.is_empty() { marks } else { format!("{marks} {label}") };
        let text = self.painted(if mark == '^' { ERROR } else { FRAME }, &text);
        let _ = writeln!(self.out, "{:gutter$} {bar} {:before$}{text}", "", "");
    }
}

/// Returns the width of a character in terminal columns.
pub fn columns(character: char) -> usize {
    cell(character).1
}

/// Returns the replacement text of a character, if it has one, and its width in columns.
fn cell(character: char) -> (Option<&'static str>, usize) {
    match character {
        '\t' => (Some(TAB), TAB.len()),
        BYTE_ORDER_MARK => (Some(""), 0),
        // Control characters, and characters that change the direction of writing.
        '\0'..='\x1f' | '\x7f'..='\u{9f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => {
            (Some("\u{fffd}"), 1)
        }
        '\u{300}'..='\u{36f}' | '\u{200b}'..='\u{200d}' | '\u{fe00}'..='\u{fe0f}' => (None, 0),
        '\u{1100}'..='\u{115f}'
        | '\u{2e80}'..='\u{a4cf}'
        | '\u{ac00}'..='\u{d7a3}'
        | '\u{f900}'..='\u{faff}'
        | '\u{fe30}'..='\u{fe6f}'
        | '\u{ff00}'..='\u{ff60}'
        | '\u{ffe0}'..='\u{ffe6}'
        | '\u{1f300}'..='\u{1faff}'
        | '\u{20000}'..='\u{3fffd}' => (None, 2),
        _ => (None, 1),
    }
}

const ERROR: &str = "1;31";
const WARNING: &str = "1;33";
const FRAME: &str = "1;34";
const STRONG: &str = "1";

#[derive(Debug, Default)]
pub(super) struct Diagnostics {
    list: Vec<Diagnostic>,
    max: usize,
    dropped: usize,
    warnings: Vec<Diagnostic>,
}

impl Diagnostics {
    pub(super) fn new(max: usize) -> Self {
        Self { list: Vec::new(), max: max.max(1), ..Self::default() }
    }

    /// Adds `diagnostic`, unless the list is full or has an equal message at the same location.
    pub(super) fn push(&mut self, diagnostic: Diagnostic) {
        let known = |one: &Diagnostic| one.span == diagnostic.span && one.message == diagnostic.message;
        if self.list.iter().any(known) {
            return;
        }
        if self.list.len() < self.max { self.list.push(diagnostic) } else { self.dropped += 1 }
    }

    /// Adds a warning, unless its place has one, or there are already as many as mistakes are allowed.
    pub(super) fn warn(&mut self, warning: Diagnostic) {
        let is_known = self.warnings.iter().any(|one| one.span == warning.span);
        if !is_known && self.warnings.len() < self.max {
            self.warnings.push(warning);
        }
    }

    /// Takes the warnings in the order of their locations.
    pub(super) fn drain_warnings(&mut self) -> Vec<Diagnostic> {
        self.warnings.sort_by_key(|one| one.span);
        std::mem::take(&mut self.warnings)
    }

    pub(super) fn full(&self) -> bool {
        self.dropped > 0
    }

    pub(super) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Returns the diagnostics in the order of their locations. If diagnostics were dropped, the last one reports this.
    pub(super) fn finish(mut self) -> Vec<Diagnostic> {
        // `previous(pixel)` in a place without images and pixels is one mistake.
        let unsupported = self.list.iter().filter(|one| one.fault == Fault::Unsupported);
        let spans: Vec<Span> = unsupported.map(|one| one.span).collect();
        let holds =
            |outer: &Span, span: Span| *outer != span && outer.start <= span.start && span.end <= outer.end;
        self.list.retain(|one| {
            one.fault != Fault::Unsupported || !spans.iter().any(|outer| holds(outer, one.span))
        });
        self.list.sort_by_key(|one| one.span);
        if self.dropped > 0 {
            let span = self.list.last().map_or(Span::default(), |last| last.span);
            let message = format!("there are more mistakes: only the first {} are shown", self.max);
            self.list.push(Diagnostic::over_limit(span, message));
        }
        self.list
    }
}
