//! Compiles a document and turns the mistakes into the protocol's diagnostics.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use mariana_editing::Buffer;
use mariana_field::lang::{self, Compiled, Fault, NameKind, Sources, Span};
use serde_json::{Value, json};

use crate::documents::{Snapshot, included_path};
use crate::positions::range;
use crate::protocol::Location;
use crate::uri::uri_of;

/// A version of a document that is to be compiled.
pub struct Check {
    pub(crate) uri: String,
    pub(crate) path: Option<PathBuf>,
    pub(crate) text: Arc<str>,
    pub(crate) snapshot: Snapshot,
    /// True if the client shows related locations of a diagnostic.
    pub(crate) shows_related: bool,
}

/// The result of a [`Check`].
pub struct Checked {
    pub(crate) uri: String,
    /// The diagnostics of each file of the scene, by its address.
    pub(crate) diagnostics: BTreeMap<String, Vec<Value>>,
    /// The files that the scene includes.
    pub(crate) included: Vec<PathBuf>,
}

impl Check {
    /// Compiles the document. This may take some hundred milliseconds for a scene near the limits.
    pub fn run(&self) -> Checked {
        let compiled = self.compiled();
        let included = compiled.includes_asked.iter().filter_map(|name| self.included_path(name)).collect();
        let mut diagnostics = BTreeMap::from([(self.uri.clone(), Vec::new())]);
        let texts = compiled.sources.files().iter().map(|file| Buffer::new(file.text.clone().into_bytes()));
        let texts: Vec<Buffer> = texts.collect();
        for file in 1..texts.len() {
            diagnostics.extend(self.uri_of(&compiled.sources, file).map(|uri| (uri, Vec::new())));
        }
        for one in compiled.diagnostics.iter().chain(&compiled.warnings) {
            if let Some(Location { uri, range }) = self.place(&compiled.sources, &texts, one.span) {
                let value = self.diagnostic(one, &compiled.sources, &texts, range);
                diagnostics.entry(uri).or_default().push(value);
            }
        }
        Checked { uri: self.uri.clone(), diagnostics, included }
    }

    fn compile(&self, text: &str) -> Compiled {
        lang::compile(&self.uri, text, &mut self.snapshot.resolver(self.path.as_deref()))
    }

    /// Compiles the document. If it has no object, because other scenes include it, it is compiled with one.
    fn compiled(&self) -> Compiled {
        let compiled = self.compile(&self.text);
        if compiled.scene.is_some() {
            return compiled;
        }
        let (names, _) = lang::names("", &self.text, &mut |_| Ok(String::new()));
        let has_object = names.declarations.iter().any(|one| one.kind == NameKind::Object);
        let declares = names.declarations.iter().any(|one| one.local.is_none());
        if has_object || !declares {
            return compiled;
        }
        let mut with_object = self.compile(&format!("{}\nobject _ {{ shape = p.y }}", self.text));
        // Other scenes use the names of this text.
        with_object.warnings.clear();
        if with_object.diagnostics.len() < compiled.diagnostics.len() { with_object } else { compiled }
    }

    fn included_path(&self, name: &str) -> Option<PathBuf> {
        self.path.as_deref().map(|scene| included_path(scene, name))
    }

    fn uri_of(&self, sources: &Sources, file: usize) -> Option<String> {
        match file {
            0 => Some(self.uri.clone()),
            _ => uri_of(&self.included_path(&sources.files().get(file)?.name)?),
        }
    }

    fn diagnostic(
        &self,
        one: &lang::Diagnostic,
        sources: &Sources,
        texts: &[Buffer],
        range: crate::positions::Span,
    ) -> Value {
        let mut message = one.message.clone();
        if !one.label.is_empty() {
            message.push_str(&format!(" ({})", one.label));
        }
        if let Some(hint) = &one.hint {
            message.push_str(&format!("\nhelp: {hint}"));
        }
        // The protocol's severities are 1 for an error and 2 for a warning.
        let (code, severity) = match one.fault {
            Fault::Malformed => ("malformed", 1),
            Fault::Unsupported => ("unsupported", 1),
            Fault::OverLimit => ("over-limit", 1),
            Fault::Warning => ("warning", 2),
        };
        let mut related = Vec::new();
        for (span, text) in &one.notes {
            match self.place(sources, texts, *span).filter(|_| self.shows_related) {
                Some(location) => related.push(json!({ "location": location, "message": text })),
                None => message.push_str(&format!("\nnote: {text}")),
            }
        }
        let mut value = json!({
            "range": range, "severity": severity, "code": code, "source": "mariana", "message": message,
        });
        if !related.is_empty() {
            value["relatedInformation"] = related.into();
        }
        value
    }

    /// Returns the address of a span's file, and the span in this file.
    fn place(&self, sources: &Sources, texts: &[Buffer], span: Span) -> Option<Location> {
        let (file, bytes) = sources.place_in_file(span)?;
        let buffer = texts.get(file)?;
        Some(Location { uri: self.uri_of(sources, file)?, range: range(buffer, visible(buffer, bytes)) })
    }
}

/// Extends an empty range to the character behind or before it, so that an editor has something to underline.
fn visible(buffer: &Buffer, range: Range<usize>) -> Range<usize> {
    if !range.is_empty() {
        return range;
    }
    let line = buffer.line_range(buffer.line_of(range.start));
    let text = String::from_utf8_lossy(buffer.slice(line.clone())).into_owned();
    let at = range.start.saturating_sub(line.start);
    let length = |letter: Option<char>| letter.map_or(0, char::len_utf8);
    let behind = length(text.get(at..).and_then(|rest| rest.chars().next()));
    let before = length(text.get(..at).and_then(|rest| rest.chars().next_back()));
    if behind > 0 { range.start..range.start + behind } else { range.start - before..range.start }
}
