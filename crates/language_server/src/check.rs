//! Compiles a document and turns the mistakes into the protocol's diagnostics.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use mariana_field::lang::{self, Compiled, Diagnostic, Fault, NameKind, Section, Span};
use serde_json::{Value, json};

use crate::documents::{Snapshot, included_path, location};
use crate::protocol::Location;

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
        let asked =
            |scene: &PathBuf| compiled.includes_asked.iter().map(|name| included_path(scene, name)).collect();
        let included = self.path.as_ref().map(asked).unwrap_or_default();
        let files = self.snapshot.files(&self.uri, self.path.as_deref(), &compiled.sources);
        let uris = files.iter().filter_map(|file| file.uri.clone());
        let mut diagnostics: BTreeMap<String, Vec<Value>> = uris.map(|uri| (uri, Vec::new())).collect();
        let place = |span: Span| location(&compiled.sources, &files, span);
        let all = compiled.diagnostics.iter().chain(&compiled.warnings);
        for (uri, value) in all.filter_map(|one| self.written(one, place)) {
            diagnostics.entry(uri).or_default().push(value);
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
        let has_object = names.declarations.iter().any(|one| one.kind == NameKind::Section(Section::Object));
        let declares = names.declarations.iter().any(|one| one.local.is_none());
        if has_object || !declares {
            return compiled;
        }
        let mut with_object = self.compile(&format!("{}\nobject _ {{ shape = p.y }}", self.text));
        // Other scenes use the names of this text.
        with_object.warnings.clear();
        if with_object.diagnostics.len() < compiled.diagnostics.len() { with_object } else { compiled }
    }

    /// Returns the address of a diagnostic's file, and the diagnostic as the protocol has it.
    fn written(&self, one: &Diagnostic, place: impl Fn(Span) -> Option<Location>) -> Option<(String, Value)> {
        let Location { uri, range } = place(one.span)?;
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
            match place(*span).filter(|_| self.shows_related) {
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
        Some((uri, value))
    }
}
