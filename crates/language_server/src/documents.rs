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
    /// `None` for a document that is no file.
    pub path: Option<PathBuf>,
    pub version: i64,
    pub buffer: Buffer,
    pub colors: Colors,
    /// The same text as `buffer`.
    pub text: Arc<str>,
}

impl Document {
    fn new(uri: &str, version: i64, text: String) -> Self {
        let buffer = Buffer::new(text.clone().into_bytes());
        Self { path: path_of(uri), version, buffer, colors: Colors::default(), text: text.into() }
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
    /// The address and the text of each file.
    open: Arc<BTreeMap<PathBuf, (String, Arc<str>)>>,
    read: Arc<ReadInclude>,
}

impl Snapshot {
    /// Returns a function that reads the files that a scene includes.
    pub(crate) fn resolver(&self, scene: Option<&Path>) -> impl FnMut(&str) -> Result<String, String> {
        move |name| {
            let Some(scene) = scene else { return lang::no_includes(name) };
            match self.open.get(&included_path(scene, name)) {
                Some((_, text)) => Ok(text.to_string()),
                None => (self.read)(scene, name),
            }
        }
    }

    /// Returns the files of the scene with this address and path.
    pub(crate) fn files(&self, uri: &str, scene: Option<&Path>, sources: &Sources) -> Vec<SceneFile> {
        let uri_of_file = |index: usize, name: &str| match index {
            0 => Some(uri.to_owned()),
            _ => self.uri_of(&included_path(scene?, name)),
        };
        let files = sources.files().iter().enumerate().map(|(index, file)| {
            let buffer = Buffer::new(file.text.clone().into_bytes());
            SceneFile { uri: uri_of_file(index, &file.name), buffer }
        });
        files.collect()
    }

    /// Returns the address of a file. The client's own address of an open file may have other escapes.
    fn uri_of(&self, path: &Path) -> Option<String> {
        self.open.get(path).map(|(uri, _)| uri.clone()).or_else(|| uri_of(path))
    }
}

/// A file of a scene: the scene itself, or a file that it includes.
pub(crate) struct SceneFile {
    /// The address; `None` for a path without one.
    pub uri: Option<String>,
    pub buffer: Buffer,
}

/// Returns the location of a span in the files of a scene; `None` in a file without an address.
pub(crate) fn location(sources: &Sources, files: &[SceneFile], span: lang::Span) -> Option<Location> {
    let (file, bytes) = sources.place_in_file(span)?;
    let SceneFile { uri, buffer } = files.get(file)?;
    Some(Location { uri: uri.clone()?, range: range(buffer, bytes) })
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
    /// The files of `sources`.
    pub files: Vec<SceneFile>,
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
    /// forget the names of all scenes.
    pub(crate) open: BTreeMap<String, Document>,
    pub(crate) parsed: BTreeMap<String, Arc<Parsed>>,
    read: Arc<ReadInclude>,
}

impl Documents {
    pub(crate) fn new(read: Arc<ReadInclude>) -> Self {
        Self { open: BTreeMap::new(), parsed: BTreeMap::new(), read }
    }

    pub(crate) fn insert(&mut self, uri: &str, version: i64, text: String) {
        self.parsed.clear();
        self.open.insert(uri.to_owned(), Document::new(uri, version, text));
    }

    /// Changes a document; false if it is not open.
    pub(crate) fn change(&mut self, uri: &str, version: Option<i64>, changes: Vec<Change>) -> bool {
        let Some(document) = self.open.get_mut(uri) else { return false };
        document.change(changes);
        document.version = version.unwrap_or(document.version + 1);
        // Scenes without this document stay: a client may hold many open.
        let is_other = |parsed: &Parsed| parsed.files.iter().all(|file| file.uri.as_deref() != Some(uri));
        self.parsed.retain(|root, parsed| root != uri && is_other(parsed));
        true
    }

    pub(crate) fn close(&mut self, uri: &str) {
        self.open.remove(uri);
        self.parsed.clear();
    }

    pub(crate) fn snapshot(&self) -> Snapshot {
        let open = self.open.iter();
        let open = open.filter_map(|(uri, one)| Some((one.path.clone()?, (uri.clone(), one.text.clone()))));
        Snapshot { open: Arc::new(open.collect()), read: self.read.clone() }
    }

    /// Returns the names of a document and its includes.
    pub(crate) fn parsed(&mut self, uri: &str) -> Option<Arc<Parsed>> {
        if let Some(known) = self.parsed.get(uri) {
            return Some(known.clone());
        }
        let document = self.open.get(uri)?;
        let (snapshot, path) = (self.snapshot(), document.path.as_deref());
        let (names, sources) = lang::names(uri, &document.text, &mut snapshot.resolver(path));
        let files = snapshot.files(uri, path, &sources);
        let parsed = Arc::new(Parsed { names, sources, files });
        self.parsed.insert(uri.to_owned(), parsed.clone());
        Some(parsed)
    }

    /// Returns the open scenes that include a document. Without such a scene, the document itself is the scene.
    pub(crate) fn contexts(&mut self, uri: &str) -> Vec<Context> {
        let roots: Vec<String> = self.open.keys().filter(|root| *root != uri).cloned().collect();
        let mut found = Vec::new();
        for parsed in roots.iter().filter_map(|root| self.parsed(root)) {
            let file = parsed.files.iter().position(|file| file.uri.as_deref() == Some(uri));
            found.extend(file.map(|file| Context { parsed: parsed.clone(), file }));
        }
        if found.is_empty() {
            found.extend(self.parsed(uri).map(|parsed| Context { parsed, file: 0 }));
        }
        found
    }
}
