//! A client that talks to the server by messages.

#![allow(clippy::unwrap_used, reason = "tests")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mariana_language_server::{Ending, Server};
use proptest::prelude::*;
use serde_json::{Value, json};

struct Client {
    server: Server,
    id: u64,
    /// The last diagnostics of each document.
    diagnostics: BTreeMap<String, Vec<Value>>,
}

const SCENE: &str = "file:///scenes/main.scene";
const PART: &str = "file:///scenes/part.scene";

impl Client {
    fn new(files: &[(&str, &str)]) -> Self {
        // Files without a disk.
        let files = files.iter().map(|(path, text)| (PathBuf::from(path), (*text).to_owned()));
        let files: BTreeMap<PathBuf, String> = files.collect();
        let read = move |scene: &Path, name: &str| {
            let text = files.get(&scene.parent().unwrap().join(name));
            text.cloned().ok_or_else(|| "there is no such file".to_owned())
        };
        Self { server: Server::new(Arc::new(read)), id: 0, diagnostics: BTreeMap::new() }
    }

    fn started(files: &[(&str, &str)]) -> Self {
        let mut client = Self::new(files);
        let related = json!({ "publishDiagnostics": { "relatedInformation": true } });
        client.request("initialize", json!({ "capabilities": { "textDocument": related } })).unwrap();
        client.notify("initialized", json!({}));
        client
    }

    fn with(text: &str) -> Self {
        let mut client = Self::started(&[]);
        client.open(SCENE, text);
        client
    }

    fn receive(&mut self, messages: Vec<Value>) -> Vec<Value> {
        let mut answers = self.server.receive(messages.into_iter().map(Ok).collect());
        while let Some(check) = self.server.next_check() {
            answers.extend(self.server.checked(check.run()));
        }
        for answer in &answers {
            if answer["method"] == "textDocument/publishDiagnostics" {
                let list = answer["params"]["diagnostics"].as_array().unwrap().clone();
                self.diagnostics.insert(answer["params"]["uri"].as_str().unwrap().to_owned(), list);
            }
        }
        answers
    }

    fn request(&mut self, method: &str, params: Value) -> Result<Value, Value> {
        self.id += 1;
        let id = self.id;
        let message = json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params });
        let answers = self.receive(vec![message]);
        let answer = answers.into_iter().find(|answer| answer["id"] == id).unwrap();
        match answer.get("error") {
            Some(error) => Err(error.clone()),
            None => Ok(answer["result"].clone()),
        }
    }

    fn notify(&mut self, method: &str, params: Value) -> Vec<Value> {
        self.receive(vec![json!({ "jsonrpc": "2.0", "method": method, "params": params })])
    }

    fn open(&mut self, uri: &str, text: &str) {
        let document = json!({ "uri": uri, "languageId": "mariana", "version": 1, "text": text });
        self.notify("textDocument/didOpen", json!({ "textDocument": document }));
    }

    fn messages(&self, uri: &str) -> Vec<String> {
        let list = self.diagnostics.get(uri).cloned().unwrap_or_default();
        list.iter().map(|one| one["message"].as_str().unwrap().to_owned()).collect()
    }

    /// Sends a request about the place in `text` before the mark `|` in `marked`, which is a part of the text.
    fn ask(&mut self, method: &str, text: &str, marked: &str, more: Value) -> Result<Value, Value> {
        let (line, character) = place(text, marked);
        let mut params =
            json!({ "textDocument": { "uri": SCENE }, "position": { "line": line, "character": character } });
        params.as_object_mut().unwrap().extend(more.as_object().cloned().unwrap_or_default());
        self.request(method, params)
    }
}

fn place(text: &str, marked: &str) -> (usize, usize) {
    let inside = marked.find('|').unwrap();
    let at = text.find(&marked.replace('|', "")).unwrap() + inside;
    let before = &text[..at];
    (before.matches('\n').count(), before.rsplit('\n').next().unwrap().encode_utf16().count())
}

/// Applies the edits of one document.
fn edited(text: &str, edits: &Value) -> String {
    let offset = |position: &Value| {
        let line = position["line"].as_u64().unwrap() as usize;
        let start: usize = text.split_inclusive('\n').take(line).map(str::len).sum();
        let mut units = position["character"].as_u64().unwrap() as usize;
        let mut at = start;
        for letter in text[start..].chars().take_while(|letter| *letter != '\n') {
            if units == 0 {
                break;
            }
            units -= letter.len_utf16();
            at += letter.len_utf8();
        }
        at
    };
    let mut places: Vec<(usize, usize, &str)> = edits
        .as_array()
        .unwrap()
        .iter()
        .map(|edit| {
            let range = &edit["range"];
            (offset(&range["start"]), offset(&range["end"]), edit["newText"].as_str().unwrap())
        })
        .collect();
    places.sort_unstable();
    let mut out = text.to_owned();
    for (start, end, new) in places.into_iter().rev() {
        out.replace_range(start..end, new);
    }
    out
}

const GOOD: &str = "\
# How far.
param spread = 2 in 0 .. 3
# A ball of this size.
fn ball(q, size) = sphere(q, size)
material gold { color = vec3(1, 0.5, 0.1)  roughness = 0.2 }
object one {
  let at = p - vec3(spread, 0, 0)
  shape = union(for i in 0..3: ball(at + i, 0.5))
  material = gold
}
";

#[test]
fn the_server_begins_and_ends_as_the_protocol_says() {
    let mut client = Client::new(&[]);
    assert_eq!(client.request("textDocument/hover", json!({})).unwrap_err()["code"], -32002);
    for wrong in [json!({}), json!({ "capabilities": [] }), Value::Null] {
        assert_eq!(client.request("initialize", wrong).unwrap_err()["code"], -32602);
    }
    let answer = client
        .request(
            "initialize",
            json!({ "capabilities": { "general": { "positionEncodings": ["utf-8", "utf-32"] } } }),
        )
        .unwrap();
    assert_eq!(answer["capabilities"]["positionEncoding"], "utf-16");
    assert_eq!(client.request("initialize", json!({})).unwrap_err()["code"], -32600);
    assert_eq!(client.request("textDocument/unknown", json!({})).unwrap_err()["code"], -32601);
    assert_eq!(client.request("textDocument/hover", json!({})).unwrap_err()["code"], -32602);
    assert_eq!(client.notify("$/unknown", json!({})), [Value::Null; 0]);
    assert_eq!(client.request("shutdown", Value::Null), Ok(Value::Null));
    assert_eq!(client.request("textDocument/hover", json!({})).unwrap_err()["code"], -32600);
    client.notify("exit", Value::Null);
    assert_eq!(client.server.ending(), Some(Ending::Orderly));

    let mut client = Client::started(&[]);
    client.notify("exit", Value::Null);
    assert_eq!(client.server.ending(), Some(Ending::Early));
}

#[test]
fn unreadable_messages_and_cancelled_requests_get_errors() {
    let mut client = Client::started(&[]);
    let answers = client.server.receive(vec![Err("no JSON".to_owned())]);
    assert_eq!((&answers[0]["id"], &answers[0]["error"]["code"]), (&Value::Null, &json!(-32700)));
    for wrong in [json!([]), json!(7), json!({ "id": 3 }), json!({ "method": 5, "id": 3 })] {
        assert_eq!(client.receive(vec![wrong])[0]["error"]["code"], -32600);
    }
    assert_eq!(client.receive(vec![json!({ "id": 3, "result": null })]), [Value::Null; 0]);
    let answers = client.receive(vec![
        json!({ "id": "a", "method": "textDocument/hover", "params": {} }),
        json!({ "id": "b", "method": "shutdown" }),
        json!({ "method": "$/cancelRequest", "params": { "id": "a" } }),
    ]);
    assert_eq!((&answers[0]["error"]["code"], &answers[1]["id"]), (&json!(-32800), &json!("b")));
}

#[test]
fn mistakes_are_published_with_their_place_and_hint() {
    let client = Client::with("object ä { shape = 1 }\nlet a = spere(p, 1)");
    assert!(client.messages(SCENE).len() > 1);
    let mut client =
        Client::with("let ok = 1\nobject a { shape = length(p) - spread }\nobject a { shape = \u{1f600} }");
    let list = client.diagnostics[SCENE].clone();
    assert!(list.iter().all(|one| one["severity"] == 1 && one["source"] == "mariana"), "{list:?}");
    let smiley = list.iter().find(|one| one["message"].as_str().unwrap().contains('\u{1f600}')).unwrap();
    let range = json!({ "start": { "line": 2, "character": 19 }, "end": { "line": 2, "character": 21 } });
    assert_eq!(smiley["range"], range);
    assert!(list.iter().any(|one| one["message"].as_str().unwrap().contains("\nhelp: ")), "{list:?}");

    let change = json!({ "range": { "start": { "line": 0, "character": 0 }, "end": { "line": 3, "character": 0 } },
                         "text": "object a { shape = p.y }\nobject a { shape = p.x }" });
    let document = json!({ "uri": SCENE, "version": 2 });
    client.notify("textDocument/didChange", json!({ "textDocument": document, "contentChanges": [change] }));
    let list = &client.diagnostics[SCENE];
    assert_eq!(list.len(), 1, "{list:?}");
    let first = json!({ "start": { "line": 0, "character": 7 }, "end": { "line": 0, "character": 8 } });
    assert_eq!(list[0]["relatedInformation"][0]["location"], json!({ "uri": SCENE, "range": first }));
    client.notify("textDocument/didClose", json!({ "textDocument": { "uri": SCENE } }));
    assert_eq!(client.diagnostics[SCENE], [Value::Null; 0]);
}

#[test]
fn warnings_are_published_but_not_for_files_that_other_scenes_include() {
    let mut client = Client::with("let lost = 1\nobject a { shape = p.y }");
    let list = &client.diagnostics[SCENE];
    assert_eq!(list.len(), 1, "{list:?}");
    assert_eq!((&list[0]["severity"], &list[0]["code"]), (&json!(2), &json!("warning")));
    client.open(PART, "fn ball(q) = sphere(q, 1)\n");
    assert_eq!(client.messages(PART), [""; 0]);
}

#[test]
fn a_burst_of_changes_is_compiled_once() {
    let mut client = Client::with(GOOD);
    let change = |version: u64| {
        let text = format!("{GOOD}let a = {version} +");
        json!({ "method": "textDocument/didChange", "params": {
            "textDocument": { "uri": SCENE, "version": version }, "contentChanges": [{ "text": text }] } })
    };
    let old = {
        client.server.receive(vec![Ok(change(2))]);
        client.server.next_check().unwrap()
    };
    let messages = (3..100).map(|version| Ok(change(version))).collect();
    client.server.receive(messages);
    assert_eq!(client.server.checked(old.run()), [Value::Null; 0], "an old result is shown");
    let newest = client.server.next_check().unwrap();
    assert!(client.server.next_check().is_none(), "every version is compiled");
    let shown = client.server.checked(newest.run());
    assert_eq!(shown[0]["params"]["version"], 99);
}

#[test]
fn included_files_are_read_from_open_documents_first() {
    let part = "fn ball(q) = sphere(q, 1)\nlet wrong = bal(p)\n";
    let files = [("/scenes/part.scene", part), ("/scenes/other.scene", "fn f(p) = 2 f(p)")];
    let main = "include \"part.scene\"\nobject a { shape = ball(p) }\n";
    let mut client = Client::started(&files);
    client.open(SCENE, main);
    assert_eq!(client.messages(SCENE), [""; 0]);
    assert_eq!(client.messages(PART).len(), 1, "the mistake is in the included file");
    client.open(PART, "fn ball(q) = sphere(q, 2)\n");
    assert_eq!(client.messages(PART), [""; 0], "the open document has no mistake");
    let document = json!({ "uri": PART, "version": 2 });
    let change = json!([{ "text": "fn ball(q) = sphere(q, vec3(1))\n" }]);
    client.notify("textDocument/didChange", json!({ "textDocument": document, "contentChanges": change }));
    assert_eq!(client.messages(PART).len(), 1, "the scene that includes the document is compiled again");

    let found = client.ask("textDocument/definition", main, "= ba|ll(p)", json!({})).unwrap();
    assert_eq!((&found["uri"], &found["range"]["start"]["character"]), (&json!(PART), &json!(3)));
    let found = client.ask("textDocument/definition", main, "part|.scene", json!({})).unwrap();
    assert_eq!(found["uri"], PART);
    let renamed = client.ask("textDocument/rename", main, "= ba|ll(p)", json!({ "newName": "orb" })).unwrap();
    let changes = &renamed["changes"];
    assert_eq!(edited(main, &changes[SCENE]), main.replace("ball", "orb"));
    assert_eq!(
        edited("fn ball(q) = sphere(q, vec3(1))\n", &changes[PART]),
        "fn orb(q) = sphere(q, vec3(1))\n"
    );

    client.notify("textDocument/didClose", json!({ "textDocument": { "uri": SCENE } }));
    assert_eq!(client.messages(PART).len(), 1, "a file of functions needs no object of its own");
    client.open("untitled:1", main);
    assert!(client.messages("untitled:1")[0].contains("only a scene that is a file can include"));
    for path in ["../part.scene", "/scenes/part.scene", "file:///scenes/part.scene"] {
        client.open(SCENE, &format!("include \"{path}\"\nobject a {{ shape = p.y }}"));
        assert_eq!(client.messages(SCENE).len(), 1, "{path}");
    }
}

#[test]
fn files_that_include_each_other_are_both_reported() {
    let mut client = Client::started(&[]);
    client.open(SCENE, "include \"part.scene\"\nobject a { shape = p.y }");
    client.open(PART, "include \"main.scene\"\n");
    assert!(client.messages(SCENE).iter().chain(&client.messages(PART)).any(|one| one.contains("circle")));
}

#[test]
fn hover_shows_documentation_and_comments() {
    let mut client = Client::with(GOOD);
    let mut hover = |marked: &str| {
        let answer = client.ask("textDocument/hover", GOOD, marked, json!({})).unwrap();
        answer["contents"]["value"].as_str().unwrap_or_default().to_owned()
    };
    assert!(hover("= sph|ere(q").contains("sphere(p, radius"));
    assert!(hover(": ba|ll(at").contains("A ball of this size."));
    assert!(hover("vec3(spr|ead").contains("How far."));
    assert!(hover("rough|ness").contains("polished"));
    assert!(hover("ball(|at").contains("let at = "));
    assert!(hover("sphere(q, si|ze)").contains("a parameter"));
    assert!(hover("at + |i,").contains("loop"));
    assert_eq!(hover("0.|2 }"), "");
}

#[test]
fn completion_offers_valid_names_only() {
    let text = format!("{GOOD}fn other(place) = pla\nlet b = size_\n");
    let mut client = Client::with(&text);
    let mut labels = |marked: &str| -> Vec<String> {
        let answer = client.ask("textDocument/completion", &text, marked, json!({})).unwrap();
        let items = answer["items"].as_array().unwrap().clone();
        items.iter().map(|item| item["label"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(labels("= pla|\n")[0], "place");
    assert!(labels(": bal|l(at").contains(&"ball".to_owned()));
    assert!(!labels("let b = |size_").contains(&"at".to_owned()), "a local name of an object");
    assert!(labels("vec3(spread, 0|").is_empty());
    let answer = client.ask("textDocument/completion", &text, "= sph|ere", json!({})).unwrap();
    let sphere = answer["items"].as_array().unwrap().iter().find(|one| one["label"] == "sphere").unwrap();
    assert_eq!(sphere["textEdit"]["newText"], "sphere");
    assert!(sphere["documentation"]["value"].as_str().unwrap().contains("exact"));
}

/// Regression: a value in the line of its function was offered as a function.
#[test]
fn a_local_value_is_offered_as_a_variable() {
    let text = "fn f(q) { let radius = 0.5  length(q) - radius }\nf(p)\n";
    let mut client = Client::with(text);
    let answer = client.ask("textDocument/completion", text, "- rad|ius", json!({})).unwrap();
    let radius = answer["items"].as_array().unwrap().iter().find(|one| one["label"] == "radius").unwrap();
    assert_eq!((&radius["kind"], &radius["textEdit"]["newText"]), (&json!(6), &json!("radius")));
}

#[test]
fn signatures_follow_the_arguments() {
    let text = "fn f(first, second) = 1\nlet a = f(vec2(1, 2),\n  3) + mix(1, 2, 3)";
    let mut client = Client::with(text);
    let mut active = |marked: &str| {
        let answer = client.ask("textDocument/signatureHelp", text, marked, json!({})).unwrap();
        let label = answer["signatures"][0]["label"].as_str().unwrap_or_default().to_owned();
        (label, answer["activeParameter"].as_u64().unwrap_or_default())
    };
    assert_eq!(active("= f(|vec2").0, "f(first, second)");
    assert_eq!(active("  3|)"), ("f(first, second)".to_owned(), 1));
    let (label, argument) = active("mix(1, 2, |3)");
    assert!(label.starts_with("mix("));
    assert_eq!(argument, 2);
    assert_eq!(active(" |+ mix"), (String::new(), 0));
}

#[test]
fn references_and_outline_list_what_is_declared() {
    let mut client = Client::with(GOOD);
    let with = json!({ "context": { "includeDeclaration": true } });
    let found = client.ask("textDocument/references", GOOD, "(q, si|ze) =", with).unwrap();
    assert_eq!(found.as_array().unwrap().len(), 2);
    let without = json!({ "context": { "includeDeclaration": false } });
    let found = client.ask("textDocument/references", GOOD, "|gold {", without).unwrap();
    assert_eq!(found[0]["range"]["start"], json!({ "line": 8, "character": 13 }));
    let outline =
        client.request("textDocument/documentSymbol", json!({ "textDocument": { "uri": SCENE } })).unwrap();
    let names: Vec<&str> =
        outline.as_array().unwrap().iter().map(|one| one["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["spread", "ball", "gold", "one"]);
    assert_eq!(outline[3]["range"]["end"], json!({ "line": 9, "character": 1 }));
    let document = json!({ "textDocument": { "uri": SCENE } });
    let colors = client.request("textDocument/documentColor", document.clone()).unwrap();
    assert_eq!(colors.as_array().unwrap().len(), 1);
    let params = json!({ "color": colors[0]["color"], "range": colors[0]["range"] });
    let texts = client.request("textDocument/colorPresentation", params).unwrap();
    assert_eq!(texts[0]["label"], "vec3(1, 0.5, 0.1)");
    let tokens = client.request("textDocument/semanticTokens/full", document).unwrap();
    assert_eq!(tokens["data"].as_array().unwrap()[..5], [json!(0), json!(0), json!(10), json!(0), json!(0)]);
    assert_eq!(tokens["data"].as_array().unwrap().len() % 5, 0);
}

#[test]
fn a_new_name_may_not_change_the_scene() {
    let mut client = Client::with(GOOD);
    let mut rename = |marked: &str, name: &str| {
        client.ask("textDocument/rename", GOOD, marked, json!({ "newName": name })).map(|answer| {
            let edits = answer["changes"][SCENE].clone();
            edited(GOOD, &edits)
        })
    };
    assert_eq!(rename("let a|t", "here").unwrap(), GOOD.replace("at ", "here "));
    assert_eq!(rename("for |i", "k").unwrap(), GOOD.replace("for i", "for k").replace("+ i", "+ k"));
    assert_eq!(rename("ball(|q", "p").unwrap(), GOOD.replace("(q", "(p"));
    for (marked, name) in [
        ("spr|ead", "p"),
        ("for |i", "at"),
        ("ba|ll(q", "sphere"),
        ("(q, |size)", "q"),
        ("let a|t", "let"),
        ("let a|t", "2a"),
        ("let a|t", ""),
        ("let a|t", "a b"),
        ("= |p -", "q"),
        ("sph|ere", "orb"),
    ] {
        let error = rename(marked, name).unwrap_err();
        assert_eq!(error["code"], -32803, "{marked} {name}");
        assert!(error["message"].as_str().unwrap().len() > 10, "{error}");
    }
    let range = client.ask("textDocument/prepareRename", GOOD, "spr|ead", json!({})).unwrap();
    assert_eq!(range["placeholder"], "spread");
    assert_eq!(client.ask("textDocument/prepareRename", GOOD, "sph|ere", json!({})), Ok(Value::Null));
}

#[test]
fn formatting_edits_only_the_lines_that_change() {
    let text = "let ä = 1\n";
    let mut client = Client::with(text);
    let format =
        json!({ "textDocument": { "uri": SCENE }, "options": { "tabSize": 4, "insertSpaces": true } });
    assert_eq!(
        client.request("textDocument/formatting", format.clone()),
        Ok(Value::Null),
        "there is a mistake"
    );
    for text in
        [GOOD.replace("  let at =", " let  at="), GOOD.trim_end().to_owned(), GOOD.replace('\n', "\n\n\n")]
    {
        client.open(SCENE, &text);
        let edits = client.request("textDocument/formatting", format.clone()).unwrap();
        let formatted = mariana_field::lang::formatted(&text).unwrap();
        assert_eq!(edited(&text, &edits), formatted);
        assert_ne!(text, formatted);
    }
    client.open(SCENE, GOOD);
    assert_eq!(client.request("textDocument/formatting", format), Ok(json!([])));
}

#[test]
fn documents_over_the_limits_get_a_message() {
    let large = "# x\n".repeat((1 << 18) + 1);
    let mut client = Client::with(&large);
    assert!(client.messages(SCENE)[0].contains("larger than"), "{:?}", client.messages(SCENE));
    assert_eq!(client.ask("textDocument/hover", &large, "|#", json!({})), Ok(Value::Null));
    let mut client = Client::started(&[]);
    for number in 0..256 {
        client.open(&format!("file:///a/{number}.scene"), "object a { shape = p.y }");
    }
    let document = json!({ "uri": SCENE, "languageId": "mariana", "version": 1, "text": "x" });
    let answers = client.notify("textDocument/didOpen", json!({ "textDocument": document }));
    assert_eq!(answers[0]["method"], "window/showMessage");
}

/// All texts of shipped scenes.
fn shipped() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/scenes");
    let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let scenes = paths.filter(|path| path.extension().is_some_and(|end| end == "scene"));
    scenes.map(|path| std::fs::read_to_string(path).unwrap()).collect()
}

#[test]
fn every_global_name_of_the_shipped_scenes_can_be_renamed() {
    for text in shipped() {
        let mut client = Client::with(&text);
        assert_eq!(client.messages(SCENE), [""; 0]);
        let document = json!({ "textDocument": { "uri": SCENE } });
        let outline = client.request("textDocument/documentSymbol", document).unwrap();
        for symbol in outline.as_array().unwrap() {
            let position = &symbol["selectionRange"]["start"];
            let params =
                json!({ "textDocument": { "uri": SCENE }, "position": position, "newName": "fresh_name" });
            let renamed = client.request("textDocument/rename", params).unwrap();
            let after = edited(&text, &renamed["changes"][SCENE]);
            let compile = |text: &str| {
                mariana_field::lang::compile("", text, &mut mariana_field::lang::no_includes).scene.unwrap()
            };
            assert!(compile(&text).draws_the_same(&compile(&after)), "{}", symbol["name"]);
            assert_ne!(text, after);
        }
    }
}

const METHODS: &[&str] = &[
    "initialize",
    "initialized",
    "shutdown",
    "textDocument/didOpen",
    "textDocument/didChange",
    "textDocument/didClose",
    "textDocument/hover",
    "textDocument/completion",
    "textDocument/signatureHelp",
    "textDocument/definition",
    "textDocument/references",
    "textDocument/documentHighlight",
    "textDocument/prepareRename",
    "textDocument/rename",
    "textDocument/documentSymbol",
    "textDocument/semanticTokens/full",
    "textDocument/documentColor",
    "textDocument/colorPresentation",
    "textDocument/formatting",
    "workspace/didChangeWatchedFiles",
    "$/cancelRequest",
    "none",
];

/// Any JSON, and often parts of valid messages.
fn any_json() -> impl Strategy<Value = Value> {
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        (0..40_u64).prop_map(Value::from),
        Just(json!(SCENE)),
        "[a-z(){}=. \n]{0,12}".prop_map(Value::from),
    ];
    let names =
        prop::sample::select(&["textDocument", "position", "uri", "text", "range", "line", "newName"][..]);
    leaf.prop_recursive(3, 12, 4, move |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..3).prop_map(Value::from),
            prop::collection::btree_map(names.clone().prop_map(str::to_owned), inner, 0..4)
                .prop_map(|map| Value::Object(map.into_iter().collect())),
        ]
    })
}

/// Valid parameters for most methods.
fn valid(line: u64, character: u64, text: &str) -> Value {
    let range = json!({ "start": { "line": line, "character": character }, "end": { "line": line + 1, "character": 0 } });
    json!({
        "textDocument": { "uri": SCENE, "version": 1, "text": text },
        "position": { "line": line, "character": character },
        "newName": "fresh",
        "context": { "includeDeclaration": true },
        "contentChanges": [{ "range": range, "text": text }],
        "range": range,
        "color": { "red": 0.5, "green": 2.0, "blue": -1.0, "alpha": 1 },
        "capabilities": {},
    })
}

proptest! {
    #[test]
    fn any_messages_get_answers_without_a_panic(
        steps in prop::collection::vec(
            (prop::sample::select(METHODS), any_json(), 0..60_u64, 0..60_u64, any::<bool>(), "[a-z(){}=.,;\" \n0-9]{0,30}"),
            1..20,
        ),
    ) {
        let mut client = Client::started(&[]);
        client.open(SCENE, GOOD);
        for (number, (method, junk, line, character, is_valid, text)) in steps.into_iter().enumerate() {
            let mut params = valid(line, character, &text);
            if !is_valid {
                match (&mut params, junk) {
                    (Value::Object(params), Value::Object(junk)) => params.extend(junk),
                    (params, junk) => *params = junk,
                }
            }
            let is_notification = method.contains("did") || method == "initialized" || method.starts_with('$');
            let mut message = json!({ "jsonrpc": "2.0", "method": method, "params": params });
            if !is_notification {
                message["id"] = number.into();
            }
            let answers = client.receive(vec![message]);
            if !is_notification {
                prop_assert!(answers.iter().any(|answer| answer["id"] == number), "{} has no answer", method);
            }
        }
    }

    #[test]
    fn changes_in_the_text_arrive_as_they_were_made(
        edits in prop::collection::vec((0..20_u32, 0..60_u32, 0..3_u32, 0..20_u32, "[a-zä\u{1f600}\n\r{}]{0,6}"), 1..12),
    ) {
        let mut client = Client::with(GOOD);
        for (version, (line, character, lines, end, text)) in edits.into_iter().enumerate() {
            let last = if lines == 0 { character + end } else { end };
            let range = json!({ "start": { "line": line, "character": character },
                                "end": { "line": line + lines, "character": last } });
            let document = json!({ "uri": SCENE, "version": version });
            let change = json!([{ "range": range, "text": text }]);
            client.notify("textDocument/didChange", json!({ "textDocument": document, "contentChanges": change }));
        }
        // Every answer has places inside of the text.
        let document = json!({ "textDocument": { "uri": SCENE } });
        for method in ["textDocument/semanticTokens/full", "textDocument/documentSymbol", "textDocument/formatting"] {
            client.request(method, document.clone()).unwrap();
        }
    }
}
