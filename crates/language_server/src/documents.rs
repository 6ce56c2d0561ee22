//! The open documents, and the names in them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mariana_editing::{Buffer, Colors};
use mariana_field::lang::{self, Names, Sources};

use crate::positions::{Span, offset, range};
use crate::protocol::{Change, Location};
use crate::uri::{path_of, uri_of};

/// Returns the text of a file that a scene file includes, from the scene's path and the file's name, or a reason in plain
/// words. It must not read outside of the scene's folder, not even through links.
pub type ReadInclude = dyn Fn(&Path, &str) -> Result<String, String> + Send + Sync;

/// An open document.
pub(crate) struct Document {
    pub uri: String,
    /// `None` for a document that is no file.
    pub path: Option<PathBuf>,
    pub version: i64,
    pub buffer: Buffer,
    pub colors: Colors,
    /// The same text as `buffer`.
    pub text: Arc<str>,
}

impl Document {
    fn new(uri: String, version: i64, text: String) -> Self {
        let path = path_of(&uri);
        let buffer = Buffer::new(text.clone().into_bytes());
        Self { uri, path, version, buffer, colors: Colors::default(), text: text.into() }
    }

    fn change(&mut self, changes: Vec<Change>) {
        for change in changes {
            match change.range {
                None => {
                    self.buffer = Buffer::new(change.text.into_bytes());
                    self.colors = Colors::default();
                }
                Some(Span { start, end }) => {
                    let start = offset(&self.buffer, start);
                    let end = offset(&self.buffer, end).max(start);
                    self.colors.forget_behind(self.buffer.line_of(start));
                    self.buffer.replace(start..end, change.text.as_bytes());
                }
            }
        }
        self.text = String::from_utf8_lossy(self.buffer.bytes()).into();
    }
}

/// The texts of all open files, at one moment.
#[derive(Clone)]
pub(crate) struct Snapshot {
    open: Arc<BTreeMap<PathBuf, Arc<str>>>,
    read: Arc<ReadInclude>,
}

impl Snapshot {
    /// Returns a function that reads the files that a scene includes.
    pub(crate) fn resolver(&self, scene: Option<&Path>) -> impl FnMut(&str) -> Result<String, String> {
        move |name| {
            let Some(scene) = scene else { return lang::no_includes(name) };
            match self.open.get(&included_path(scene, name)) {
                Some(text) => Ok(text.to_string()),
                None => (self.read)(scene, name),
            }
        }
    }
}

/// Returns the path of an included file.
pub(crate) fn included_path(scene: &Path, name: &str) -> PathBuf {
    let folder = scene.parent().unwrap_or(Path::new(""));
    name.split('/').fold(folder.to_owned(), |path, part| path.join(part))
}

/// The names of a scene and its includes.
pub(crate) struct Parsed {
    pub names: Names,
    pub sources: Sources,
    /// The address of the scene.
    uri: String,
    /// The path of each file of `sources`.
    paths: Vec<Option<PathBuf>>,
}

impl Parsed {
    fn contains(&self, path: &Path) -> bool {
        self.paths.iter().any(|one| one.as_deref() == Some(path))
    }
}

/// A document as a part of a scene. The scene is the document itself, or another document that includes it.
#[derive(Clone)]
pub(crate) struct Context {
    pub parsed: Arc<Parsed>,
    /// The index of the document among the files of the scene.
    pub file: usize,
}

impl Context {
    /// Returns the offset in the scene's sources of a byte of the document.
    pub(crate) fn offset(&self, byte: usize) -> u32 {
        self.parsed.sources.offset(self.file, byte).unwrap_or_default()
    }
}

pub(crate) struct Documents {
    /// The documents by their addresses. [`Documents::insert`], [`change`](Self::change) and [`close`](Self::close) also
    /// forget what is known about scenes that include them.
    pub(crate) open: BTreeMap<String, Document>,
    pub(crate) parsed: BTreeMap<String, Arc<Parsed>>,
    read: Arc<ReadInclude>,
}

impl Documents {
    pub(crate) fn new(read: Arc<ReadInclude>) -> Self {
        Self { open: BTreeMap::new(), parsed: BTreeMap::new(), read }
    }

    pub(crate) fn insert(&mut self, uri: &str, version: i64, text: String) {
        let document = Document::new(uri.to_owned(), version, text);
        self.forget_parsed(uri, document.path.as_deref());
        self.open.insert(uri.to_owned(), document);
    }

    /// Changes a document; false if it is not open.
    pub(crate) fn change(&mut self, uri: &str, version: Option<i64>, changes: Vec<Change>) -> bool {
        let Some(document) = self.open.get_mut(uri) else { return false };
        document.change(changes);
        document.version = version.unwrap_or(document.version + 1);
        let path = document.path.clone();
        self.forget_parsed(uri, path.as_deref());
        true
    }

    pub(crate) fn close(&mut self, uri: &str) {
        if let Some(closed) = self.open.remove(uri) {
            self.forget_parsed(uri, closed.path.as_deref());
        }
    }

    fn forget_parsed(&mut self, uri: &str, path: Option<&Path>) {
        self.parsed.retain(|root, parsed| root != uri && !path.is_some_and(|path| parsed.contains(path)));
    }

    pub(crate) fn snapshot(&self) -> Snapshot {
        let open = self.open.values().filter_map(|one| Some((one.path.clone()?, one.text.clone())));
        Snapshot { open: Arc::new(open.collect()), read: self.read.clone() }
    }

    /// Returns the names of a document and its includes.
    pub(crate) fn parsed(&mut self, uri: &str) -> Option<Arc<Parsed>> {
        if let Some(known) = self.parsed.get(uri) {
            return Some(known.clone());
        }
        let document = self.open.get(uri)?;
        let path = document.path.as_deref();
        let (names, sources) = lang::names(uri, &document.text, &mut self.snapshot().resolver(path));
        let paths = sources.files().iter().enumerate().map(|(index, file)| match (index, path) {
            (0, path) => path.map(Path::to_owned),
            (_, path) => path.map(|path| included_path(path, &file.name)),
        });
        let paths = paths.collect();
        let parsed = Arc::new(Parsed { names, sources, uri: uri.to_owned(), paths });
        self.parsed.insert(uri.to_owned(), parsed.clone());
        Some(parsed)
    }

    /// Returns the open scenes that include a document. Without such a scene, the document itself is the scene.
    pub(crate) fn contexts(&mut self, uri: &str) -> Vec<Context> {
        let path = self.open.get(uri).and_then(|document| document.path.clone());
        let roots: Vec<String> = self.open.keys().filter(|root| *root != uri).cloned().collect();
        let mut found = Vec::new();
        if let Some(path) = path {
            for parsed in roots.iter().filter_map(|root| self.parsed(root)) {
                let file = parsed.paths.iter().position(|one| one.as_ref() == Some(&path));
                found.extend(file.map(|file| Context { parsed: parsed.clone(), file }));
            }
        }
        if found.is_empty() {
            found.extend(self.parsed(uri).map(|parsed| Context { parsed, file: 0 }));
        }
        found
    }

    /// Returns the address of a file of a scene, and its lines.
    fn text_of(&self, parsed: &Parsed, file: usize) -> Option<(String, Buffer)> {
        let path = parsed.paths.get(file)?;
        let open = match (file, path) {
            (0, _) => self.open.get(&parsed.uri),
            (_, path) => self.open.values().find(|document| document.path == *path && path.is_some()),
        };
        if let Some(document) = open {
            return Some((document.uri.clone(), document.buffer.clone()));
        }
        let text = parsed.sources.files().get(file)?.text.clone().into_bytes();
        Some((uri_of(path.as_deref()?)?, Buffer::new(text)))
    }

    /// Returns the location of a span.
    pub(crate) fn location(&self, parsed: &Parsed, span: lang::Span) -> Option<Location> {
        self.locations(parsed, [span]).pop()
    }

    /// Returns the locations of spans. Omits spans in files without an address.
    pub(crate) fn locations(
        &self,
        parsed: &Parsed,
        spans: impl IntoIterator<Item = lang::Span>,
    ) -> Vec<Location> {
        let mut texts: BTreeMap<usize, Option<(String, Buffer)>> = BTreeMap::new();
        let mut found = Vec::new();
        for span in spans {
            let Some((file, bytes)) = parsed.sources.place_in_file(span) else { continue };
            let text = texts.entry(file).or_insert_with(|| self.text_of(parsed, file));
            let Some((uri, buffer)) = text else { continue };
            found.push(Location { uri: uri.clone(), range: range(buffer, bytes) });
        }
        found
    }
}
