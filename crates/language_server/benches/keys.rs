//! Measures the answers to a key in a scene of 1,000 lines: the change with a completion, the help, and the diagnostics.
//! After the measurements it prints the 99th percentile and the maximum of 1,000 keys.

#![allow(missing_docs, clippy::unwrap_used)]

use std::sync::Arc;
use std::time::{Duration, Instant};

use criterion::{Criterion, criterion_group, criterion_main};
use mariana_language_server::Server;
use serde_json::{Value, json};

const URI: &str = "file:///scenes/long.scene";
const LINES: usize = 1_000;
const KEYS: usize = 1_000;

/// A scene of 1,000 lines in the style of the shipped scenes: 100 functions and 100 objects with materials.
fn long_scene() -> String {
    let mut text = String::new();
    for number in 0..LINES / 20 {
        text.push_str(&format!(
            "# Part {number}: a ring of pillars that the music raises.\n\
             param size_{number} = 0.5 in 0.1 .. 2\n\
             let spread_{number} = 2.5 + 0.1 * size_{number}\n\n\
             fn pillar_{number}(p, level) {{\n\
             \x20 let height = 0.3 + level * size_{number}\n\
             \x20 round_box(p - vec3(0, height, 0), vec3(0.25, height, 0.25), 0.05)\n\
             }}\n\n\
             material stone_{number} {{\n\
             \x20 let u     = smoothstep(0, 2, p.y)\n\
             \x20 color     = mix(vec3(0.6, 0.55, 0.5), hsv(0.1 * u, 0.5, 0.7), noise(4 * p))\n\
             \x20 roughness = 0.8 - 0.3 * band({number} % 32)\n\
             }}\n\n\
             object pillars_{number} {{\n\
             \x20 let q    = polar_repeat(p, 8) - vec3(spread_{number} + {number}, 0, 0)\n\
             \x20 shape    = union(pillar_{number}(q, band(3)), sphere(q - vec3(0, 1, 0), 0.2))\n\
             \x20 material = stone_{number}\n\
             }}\n"
        ));
    }
    text
}

/// A server with the scene open, and the line and column at which the keys are pressed.
struct Typing {
    server: Server,
    line: usize,
    typed: usize,
    version: u64,
}

const WORD: &str = "smooth_union";

impl Typing {
    fn new() -> Self {
        let text = long_scene();
        let line = text.lines().position(|line| line == "object pillars_25 {").unwrap();
        let mut server = Server::new(Arc::new(|_, _| Err("there are no files".to_owned())));
        let document = json!({ "uri": URI, "languageId": "mariana", "version": 1, "text": text });
        server.receive(vec![
            Ok(json!({ "id": 0, "method": "initialize", "params": { "capabilities": {} } })),
            Ok(json!({ "method": "textDocument/didOpen", "params": { "textDocument": document } })),
        ]);
        let shown = diagnostics(&mut server);
        assert!(shown.iter().all(|one| one["params"]["diagnostics"] == json!([])), "{shown:?}");
        Self { server, line, typed: 0, version: 1 }
    }

    /// Types the next letter of a word, or deletes the whole word.
    fn change(&mut self) -> Value {
        let at = |character: usize| json!({ "line": self.line, "character": character });
        let (range, text) = match WORD.get(self.typed..=self.typed) {
            Some(letter) => (json!({ "start": at(self.typed), "end": at(self.typed) }), letter),
            None => (json!({ "start": at(0), "end": at(self.typed) }), ""),
        };
        self.typed = if text.is_empty() { 0 } else { self.typed + 1 };
        self.version += 1;
        let document = json!({ "uri": URI, "version": self.version });
        let changes = json!([{ "range": range, "text": text }]);
        json!({ "method": "textDocument/didChange", "params": { "textDocument": document, "contentChanges": changes } })
    }

    fn request(&self, method: &str) -> Value {
        let position = json!({ "line": self.line, "character": self.typed });
        let params = json!({ "textDocument": { "uri": URI }, "position": position });
        json!({ "id": self.version, "method": method, "params": params })
    }

    /// Sends the messages of a key press: the change, and requests for completion, arguments and colours.
    fn key(&mut self) -> Vec<Value> {
        let mut messages = vec![Ok(self.change())];
        for method in
            ["textDocument/completion", "textDocument/signatureHelp", "textDocument/semanticTokens/full"]
        {
            messages.push(Ok(self.request(method)));
        }
        let answers = self.server.receive(messages);
        assert!(answers.iter().all(|answer| answer.get("error").is_none()), "{answers:?}");
        answers
    }
}

fn diagnostics(server: &mut Server) -> Vec<Value> {
    let check = server.next_check().unwrap();
    server.checked(check.run())
}

/// Prints the median, the 99th percentile and the maximum.
fn print(what: &str, mut times: Vec<Duration>) {
    times.sort_unstable();
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
    println!("{what}: median {:?}, p99 {:?}, maximum {:?} of {}", at(0.5), at(0.99), at(1.0), times.len());
}

fn keys(criterion: &mut Criterion) {
    let mut typing = Typing::new();
    criterion.bench_function("answers to a key in 1,000 lines", |bencher| bencher.iter(|| typing.key()));
    let mut typing = Typing::new();
    criterion.bench_function("diagnostics after a key in 1,000 lines", |bencher| {
        bencher.iter(|| {
            let change = typing.change();
            typing.server.receive(vec![Ok(change)]);
            diagnostics(&mut typing.server)
        });
    });
    let mut typing = Typing::new();
    let (mut answered, mut checked) = (Vec::new(), Vec::new());
    for _ in 0..KEYS {
        let start = Instant::now();
        typing.key();
        answered.push(start.elapsed());
        diagnostics(&mut typing.server);
        checked.push(start.elapsed());
    }
    print("completion, arguments and colours after a key", answered);
    print("the same, and diagnostics", checked);
}

criterion_group!(benches, keys);
criterion_main!(benches);
