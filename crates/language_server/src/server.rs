//! The server: its state, and the answer to each message.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use mariana_field::lang::formatted;
use serde_json::{Value, json};

use crate::check::{Check, Checked};
use crate::documents::{Documents, ReadInclude};
use crate::positions::range;
use crate::protocol::{
    ChangedDocument, Failure, OpenedDocument, TextEdit, answer, code, notification, parameter,
};
use crate::semantic_tokens::TYPES;
use crate::uri::path_of;
use crate::{color, completion, hover, limits, navigation, outline, rename, semantic_tokens, signature};

/// How the client has ended the server.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// After a `shutdown`: the exit code is 0.
    Orderly,
    /// Without a `shutdown`: the exit code is 1.
    Early,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    New,
    Ready,
    ShutDown,
    Ended(Ending),
}

/// A language server.
pub struct Server {
    state: State,
    /// The capabilities of the client.
    client: Value,
    documents: Documents,
    /// The documents whose newest version is not yet being compiled.
    wanted: BTreeSet<String>,
    /// The last result for each document.
    results: BTreeMap<String, Checked>,
    /// The diagnostics that the client shows, by document.
    shown: BTreeMap<String, Vec<Value>>,
}

impl Server {
    /// Returns a server that waits for `initialize`.
    pub fn new(read: Arc<ReadInclude>) -> Self {
        Self {
            state: State::New,
            client: Value::Null,
            documents: Documents::new(read),
            wanted: BTreeSet::new(),
            results: BTreeMap::new(),
            shown: BTreeMap::new(),
        }
    }

    /// How the client has ended the server; `None` while it runs.
    pub fn ending(&self) -> Option<Ending> {
        match self.state {
            State::Ended(ending) => Some(ending),
            _ => None,
        }
    }

    /// Handles the messages that have arrived, and returns the answers. A request is not executed if its cancellation
    /// is among the messages.
    pub fn receive(&mut self, messages: Vec<Result<Value, String>>) -> Vec<Value> {
        let cancelled: Vec<Value> = messages
            .iter()
            .flatten()
            .filter(|message| message["method"] == "$/cancelRequest")
            .map(|message| message["params"]["id"].clone())
            .collect();
        let mut answers = Vec::new();
        for message in messages {
            match message {
                Ok(message) => self.message(&message, &cancelled, &mut answers),
                Err(text) => {
                    answers.push(answer(&Value::Null, Err(Failure::new(code::PARSE_ERROR, text))));
                }
            }
            if self.ending().is_some() {
                break;
            }
        }
        answers
    }

    fn message(&mut self, message: &Value, cancelled: &[Value], answers: &mut Vec<Value>) {
        let (method, id) = (message.get("method").and_then(Value::as_str), message.get("id"));
        let params = message.get("params").unwrap_or(&Value::Null);
        match (method, id) {
            (Some(method), Some(id)) => {
                let result = if cancelled.contains(id) {
                    Err(Failure::new(code::REQUEST_CANCELLED, "the request was cancelled"))
                } else {
                    self.request(method, params)
                };
                answers.push(answer(id, result));
            }
            (Some(method), None) => answers.extend(self.notification(method, params)),
            // An answer to a request of the server.
            (None, Some(_)) if message.get("result").is_some() || message.get("error").is_some() => {}
            (None, id) => {
                let wrong = Failure::new(
                    code::INVALID_REQUEST,
                    "a message has no method: send an object with `method`",
                );
                answers.push(answer(id.unwrap_or(&Value::Null), Err(wrong)));
            }
        }
    }

    fn request(&mut self, method: &str, params: &Value) -> Result<Value, Failure> {
        let (code, message) = match (self.state, method) {
            (State::New, "initialize") if params["capabilities"].is_object() => {
                return Ok(self.initialize(params));
            }
            (State::New, "initialize") => (code::INVALID_PARAMS, "send an object with `capabilities`"),
            (State::New, _) => (code::NOT_INITIALIZED, "send the request `initialize` first"),
            (State::Ready, "initialize") => (code::INVALID_REQUEST, "the server is already initialized"),
            (State::Ready, "shutdown") => {
                self.state = State::ShutDown;
                return Ok(Value::Null);
            }
            (State::Ready, _) => return self.of_document(method, params),
            (State::ShutDown | State::Ended(_), _) => {
                (code::INVALID_REQUEST, "the server is shut down: send `exit`")
            }
        };
        Err(Failure::new(code, message))
    }

    /// Answers a request about a document. A document that is too large for the language gets empty answers.
    fn of_document(&mut self, method: &str, params: &Value) -> Result<Value, Failure> {
        let documents = &mut self.documents;
        if let Some(uri) = params["textDocument"]["uri"].as_str() {
            let Some(document) = documents.open.get(uri) else {
                let message = format!("the document {uri} is not open: send `textDocument/didOpen` first");
                return Err(Failure::new(code::INVALID_PARAMS, message));
            };
            if document.buffer.len() > mariana_editing::limits::TEXT_BYTES_MAX {
                return Ok(Value::Null);
            }
        }
        let uri = || uri_in(params);
        let position = || parameter(&params["position"]);
        let snippets = has(&self.client, "/textDocument/completion/completionItem/snippetSupport");
        Ok(match method {
            "textDocument/hover" => hover::hover(documents, uri()?, position()?).into(),
            "textDocument/completion" => completion::completion(documents, uri()?, position()?, snippets),
            "textDocument/signatureHelp" => signature::signature(documents, uri()?, position()?).into(),
            "textDocument/definition" => navigation::definition(documents, uri()?, position()?).into(),
            "textDocument/references" => {
                let with_declaration = params["context"]["includeDeclaration"] == true;
                json!(navigation::places(documents, uri()?, position()?, with_declaration))
            }
            "textDocument/documentHighlight" => navigation::highlights(documents, uri()?, position()?),
            "textDocument/prepareRename" => rename::prepare(documents, uri()?, position()?).into(),
            "textDocument/rename" => {
                let name: String = parameter(&params["newName"])?;
                rename::rename(documents, uri()?, position()?, &name)?
            }
            "textDocument/documentSymbol" => outline::outline(documents, uri()?),
            "textDocument/semanticTokens/full" => semantic_tokens::tokens(documents, uri()?),
            "textDocument/documentColor" => color::colors(documents, uri()?),
            "textDocument/colorPresentation" => {
                color::presentations(parameter(&params["color"])?, parameter(&params["range"])?)
            }
            "textDocument/formatting" => formatting(documents, uri()?),
            _ => {
                let message = format!("there is no request `{method}`");
                return Err(Failure::new(code::METHOD_NOT_FOUND, message));
            }
        })
    }

    fn initialize(&mut self, params: &Value) -> Value {
        self.state = State::Ready;
        self.client = params["capabilities"].clone();
        json!({
            "capabilities": {
                "positionEncoding": "utf-16",
                "textDocumentSync": { "openClose": true, "change": 2 },
                "hoverProvider": true,
                "completionProvider": { "triggerCharacters": ["."] },
                "signatureHelpProvider": { "triggerCharacters": ["(", ","] },
                "definitionProvider": true,
                "referencesProvider": true,
                "documentHighlightProvider": true,
                "renameProvider": { "prepareProvider": true },
                "documentSymbolProvider": true,
                "documentFormattingProvider": true,
                "colorProvider": true,
                "semanticTokensProvider": {
                    "legend": { "tokenTypes": TYPES, "tokenModifiers": [] },
                    "full": true,
                },
            },
            "serverInfo": { "name": "mariana", "version": env!("CARGO_PKG_VERSION") },
        })
    }

    fn notification(&mut self, method: &str, params: &Value) -> Vec<Value> {
        match (self.state, method) {
            (State::ShutDown, "exit") => self.state = State::Ended(Ending::Orderly),
            (_, "exit") => self.state = State::Ended(Ending::Early),
            (State::Ready, "initialized") => return self.watch_files(),
            (State::Ready, "textDocument/didOpen") => return self.open(params),
            (State::Ready, "textDocument/didChange") => self.change(params),
            (State::Ready, "textDocument/didClose") => return self.close(params),
            (State::Ready, "workspace/didChangeWatchedFiles") => {
                self.documents.parsed.clear();
                self.wanted.extend(self.documents.open.keys().cloned());
            }
            _ => {}
        }
        Vec::new()
    }

    /// Asks the client to report changes of files, so that scenes are compiled again when an include is saved.
    fn watch_files(&self) -> Vec<Value> {
        if !has(&self.client, "/workspace/didChangeWatchedFiles/dynamicRegistration") {
            return Vec::new();
        }
        let watchers = json!([{ "globPattern": "**/*.scene" }]);
        let registration = json!({
            "id": "scenes", "method": "workspace/didChangeWatchedFiles", "registerOptions": { "watchers": watchers },
        });
        let params = json!({ "registrations": [registration] });
        vec![
            json!({ "jsonrpc": "2.0", "id": "watch", "method": "client/registerCapability", "params": params }),
        ]
    }

    fn open(&mut self, params: &Value) -> Vec<Value> {
        let opened = parameter(&params["textDocument"]);
        let Ok(OpenedDocument { uri, version, text }) = opened else { return Vec::new() };
        if !self.documents.open.contains_key(&uri) && self.documents.open.len() >= limits::DOCUMENTS_MAX {
            let max = limits::DOCUMENTS_MAX;
            let message =
                format!("more than {max} scenes are open: close some, to see the mistakes in {uri}");
            return vec![notification("window/showMessage", json!({ "type": 2, "message": message }))];
        }
        self.documents.insert(&uri, version, text);
        self.changed(&uri);
        Vec::new()
    }

    fn change(&mut self, params: &Value) {
        let Ok(ChangedDocument { uri, version }) = parameter(&params["textDocument"]) else { return };
        let Ok(changes) = parameter(&params["contentChanges"]) else { return };
        if self.documents.change(&uri, version, changes) {
            self.changed(&uri);
        }
    }

    fn close(&mut self, params: &Value) -> Vec<Value> {
        let Ok(uri) = uri_in(params) else { return Vec::new() };
        self.documents.close(uri);
        // Scenes that include the document now read the file. Documents that it includes are checked alone.
        self.changed(uri);
        let included = self.results.remove(uri).map(|result| result.included).unwrap_or_default();
        let alone = self.documents.open.keys().filter(|uri| is_among(uri, &included));
        self.wanted.extend(alone.cloned());
        self.wanted.remove(uri);
        self.publish(uri)
    }

    /// Requests diagnostics of a document and of all scenes that include it.
    fn changed(&mut self, uri: &str) {
        self.wanted.insert(uri.to_owned());
        let Some(path) = path_of(uri) else { return };
        let roots = self.results.values().filter(|result| result.included.contains(&path));
        let roots = roots.map(|result| &result.uri).filter(|root| self.documents.open.contains_key(*root));
        self.wanted.extend(roots.cloned());
    }

    /// Returns a document that is to be compiled. The caller passes the result to [`Server::checked`], and then asks for
    /// the next document.
    pub fn next_check(&mut self) -> Option<Check> {
        while let Some(uri) = self.wanted.pop_first() {
            let Some(document) = self.documents.open.get(&uri) else { continue };
            return Some(Check {
                path: document.path.clone(),
                text: document.text.clone(),
                snapshot: self.documents.snapshot(),
                shows_related: has(&self.client, "/textDocument/publishDiagnostics/relatedInformation"),
                uri,
            });
        }
        None
    }

    /// Takes the result of a check, and returns the diagnostics for the client. A result for a text that has changed
    /// since is ignored.
    pub fn checked(&mut self, result: Checked) -> Vec<Value> {
        let uri = result.uri.clone();
        if self.wanted.contains(&uri) || !self.documents.open.contains_key(&uri) {
            return Vec::new();
        }
        self.results.insert(uri.clone(), result);
        self.publish(&uri)
    }

    /// Returns the diagnostics of a document that was checked, and of all documents whose diagnostics have changed. A
    /// document has the diagnostics of the scenes that include it or, without such a scene, its own.
    fn publish(&mut self, checked: &str) -> Vec<Value> {
        let results = &self.results;
        // A document belongs to the scenes that include it, unless they include each other.
        let is_part = |part: &Checked| {
            let includes = |a: &Checked, b: &Checked| is_among(&b.uri, &a.included);
            results
                .values()
                .any(|scene| scene.uri != part.uri && includes(scene, part) && !includes(part, scene))
        };
        let mut all: BTreeMap<String, Vec<Value>> = BTreeMap::from([(checked.to_owned(), Vec::new())]);
        for result in results.values().filter(|result| !is_part(result)) {
            for (uri, diagnostics) in &result.diagnostics {
                let list = all.entry(uri.clone()).or_default();
                let new: Vec<&Value> = diagnostics.iter().filter(|one| !list.contains(one)).collect();
                list.extend(new.into_iter().cloned());
            }
        }
        for uri in self.shown.keys() {
            all.entry(uri.clone()).or_default();
        }
        let none = Vec::new();
        let is_new = |uri: &str, list: &Vec<Value>| self.shown.get(uri).unwrap_or(&none) != list;
        let changed = all.iter().filter(|(uri, list)| *uri == checked || is_new(uri, list));
        let messages = changed.map(|(uri, diagnostics)| {
            let mut params = json!({ "uri": uri, "diagnostics": diagnostics });
            if let Some(document) = self.documents.open.get(uri) {
                params["version"] = document.version.into();
            }
            notification("textDocument/publishDiagnostics", params)
        });
        let messages = messages.collect();
        self.shown = all.into_iter().filter(|(_, list)| !list.is_empty()).collect();
        messages
    }
}

/// True if the client sets the flag at this path in its capabilities.
fn has(client: &Value, path: &str) -> bool {
    client.pointer(path) == Some(&Value::Bool(true))
}

fn is_among(uri: &str, paths: &[std::path::PathBuf]) -> bool {
    path_of(uri).is_some_and(|path| paths.contains(&path))
}

fn uri_in(params: &Value) -> Result<&str, Failure> {
    let missing =
        || Failure::new(code::INVALID_PARAMS, "the parameters are wrong: there is no `textDocument`");
    params["textDocument"]["uri"].as_str().ok_or_else(missing)
}

/// Returns the edits that format a document: at most one, of the lines that change. A text with mistakes gets none.
fn formatting(documents: &Documents, uri: &str) -> Value {
    let Some(document) = documents.open.get(uri) else { return Value::Null };
    let before = &*document.text;
    let Some(after) = formatted(before) else { return Value::Null };
    if before == after {
        return json!([]);
    }
    let same_lines = |a: &mut dyn Iterator<Item = &str>, b: &mut dyn Iterator<Item = &str>| -> usize {
        a.zip(b).take_while(|(a, b)| a == b).map(|(a, _)| a.len()).sum()
    };
    let head = same_lines(&mut before.split_inclusive('\n'), &mut after.split_inclusive('\n'));
    let (rest, new) = (before.get(head..).unwrap_or_default(), after.get(head..).unwrap_or_default());
    let tail = same_lines(&mut rest.split_inclusive('\n').rev(), &mut new.split_inclusive('\n').rev());
    let range = range(&document.buffer, head..before.len() - tail);
    let new_text = new.get(..new.len() - tail).unwrap_or_default().to_owned();
    json!([TextEdit { range, new_text }])
}
