//! The subcommands for other editors: `format` and `lsp`.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used)]

use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::process::Stdio;
use std::sync::mpsc::{Receiver, channel};

use crate::support::program::{Outcome, Workplace};
use mariana_testing::process::{Process, WAIT_LIMIT, wait_until};
use serde_json::{Value, json};

const UGLY: &str = "object  a{shape=p.y}\n";
const NEAT: &str = "object a { shape = p.y }\n";

#[test]
fn files_are_formatted_in_place() {
    let place = Workplace::new();
    place.write("ugly.scene", UGLY);
    place.write("neat.scene", NEAT);
    place.write("wrong.scene", "object  a { shape = ( }\n");
    let checked = place.run(&["format", "--check", "ugly.scene", "neat.scene"]);
    assert_eq!((checked.code, checked.stdout.as_str()), (1, "ugly.scene\n"));
    assert_eq!(place.read("ugly.scene"), UGLY.as_bytes());
    place.run(&["format", "wrong.scene"]).refused_with_details(&[
        "wrong.scene:1:",
        "was not changed",
        "expected",
    ]);
    let all = place.run(&["format", "wrong.scene", "ugly.scene", "neat.scene"]);
    assert_eq!(all.code, 1, "{all:?}");
    assert_eq!(place.read("ugly.scene"), NEAT.as_bytes());
    assert_eq!(place.read("wrong.scene"), b"object  a { shape = ( }\n");
    assert_eq!(place.run(&["format", "--check", "ugly.scene", "neat.scene"]).done(), "");
    assert_eq!(place.names(), ["neat.scene", "ugly.scene", "wrong.scene"]);

    place.write("ugly.scene", UGLY);
    let mut command = place.command(&["format", "-"]);
    let fed = Outcome::of(command.stdin(File::open(place.path("ugly.scene")).unwrap()));
    assert_eq!(fed.done(), NEAT);
    place.write("latin.scene", b"\xe4");
    place.run(&["format", "latin.scene"]).refused(&["latin.scene", "UTF-8"]);
    place.run(&["format", "none.scene"]).refused(&["none.scene"]);
    place.run(&["format"]).refused_arguments("required arguments were not provided", &[]);
}

fn framed(message: &Value) -> Vec<u8> {
    let body = message.to_string();
    format!("Content-Length: {}\r\n\r\n{body}", body.len()).into_bytes()
}

/// Reads a message; `None` at the end of the output.
fn read_message(output: &mut impl BufRead) -> Option<Value> {
    let mut header = String::new();
    output.read_line(&mut header).unwrap();
    let length: usize = header.strip_prefix("Content-Length: ")?.trim_end().parse().unwrap();
    let mut body = vec![0; length + 2];
    output.read_exact(&mut body).unwrap();
    Some(serde_json::from_slice(&body[2..]).unwrap())
}

/// A language server with its answers.
struct Running {
    process: Process,
    messages: Receiver<Value>,
}

impl Running {
    fn start(place: &Workplace) -> Self {
        let mut command = place.command(&["lsp", "--stdio"]);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut process = Process::start(&mut command, "mariana");
        let output = process.stdout();
        let (sender, messages) = channel();
        std::thread::spawn(move || {
            let mut output = BufReader::new(output);
            while let Some(message) = read_message(&mut output) {
                sender.send(message).unwrap();
            }
        });
        Self { process, messages }
    }

    fn send(&mut self, message: &Value) {
        self.process.child().stdin.as_mut().unwrap().write_all(&framed(message)).unwrap();
    }

    /// Returns the next message with this value at this key.
    fn wait_for(&self, key: &str, value: impl Into<Value>) -> Value {
        let value = value.into();
        loop {
            let message = self.messages.recv_timeout(WAIT_LIMIT).unwrap();
            if message[key] == value {
                return message;
            }
        }
    }

    fn end(mut self) -> i32 {
        let mut code = None;
        wait_until("the server ends", || {
            code = self.process.ended().map(|status| status.code().unwrap());
            code.is_some()
        });
        code.unwrap()
    }
}

#[test]
fn the_language_server_talks_over_standard_streams() {
    let place = Workplace::new();
    place.write("part.scene", "fn ball(q) = sphere(q, 1)\n");
    let uri = format!("file://{}", place.path("main.scene").display());
    let mut server = Running::start(&place);
    server.send(&json!({ "id": 1, "method": "initialize", "params": { "capabilities": {} } }));
    assert_eq!(server.wait_for("id", 1)["result"]["capabilities"]["hoverProvider"], true);
    let open = |text: &str, version: u64| {
        let document = json!({ "uri": uri, "languageId": "mariana", "version": version, "text": text });
        json!({ "method": "textDocument/didOpen", "params": { "textDocument": document } })
    };
    server.send(&open("include \"part.scene\"\nobject a { shape = ball(p) }\n", 1));
    let shown = server.wait_for("method", "textDocument/publishDiagnostics");
    assert_eq!(shown["params"]["diagnostics"], json!([]), "the file is read from the scene's folder");
    server.send(&open("include \"../outside.scene\"\nobject a { shape = p.y }\n", 2));
    let shown = server.wait_for("method", "textDocument/publishDiagnostics");
    assert_eq!(shown["params"]["diagnostics"].as_array().unwrap().len(), 1, "{shown}");
    server.process.child().stdin.as_mut().unwrap().write_all(b"Content-Length: 2\r\n\r\n{]").unwrap();
    assert_eq!(server.wait_for("id", Value::Null)["error"]["code"], -32700);
    server.send(&json!({ "id": 2, "method": "shutdown" }));
    assert_eq!(server.wait_for("id", 2)["result"], Value::Null);
    server.send(&json!({ "method": "exit" }));
    assert_eq!(server.end(), 0);

    for early in [framed(&json!({ "method": "exit" })), Vec::new(), b"no header\r\n\r\n".to_vec()] {
        let mut server = Running::start(&place);
        server.process.child().stdin.take().unwrap().write_all(&early).unwrap();
        assert_eq!(server.end(), 1);
    }
}
