//! The subcommand `lsp`: connects the language server to standard input and standard output.

mod framing;

use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use anyhow::{Context, bail};
use clap::Args;
use serde_json::Value;

use crate::export::output::write_standard;
use crate::scenes::included_text;
use framing::{framed, read_message};
use mariana_language_server::{Check, Checked, Ending, Server};
use mariana_work::{Worker, in_order};

#[derive(Args)]
pub(super) struct LspArguments {
    /// Use standard input and output, as always; editors add this flag out of habit
    #[arg(long, hide = true)]
    stdio: bool,
}

enum Event {
    /// A message, or the explanation why it cannot be read.
    Message(Result<Value, String>),
    /// The other thread has checked a text.
    Checked,
    /// Standard input has ended or cannot be read.
    Closed,
}

pub(super) fn run(_: &LspArguments) -> anyhow::Result<()> {
    if std::io::stdin().is_terminal() {
        bail!("standard input is a terminal: let an editor start 'mariana lsp' (docs/editor.md)");
    }
    let (events, arrived) = channel();
    let checked = events.clone();
    let wake = move || drop(checked.send(Event::Checked));
    let checker = in_order("check", wake, || |check: Check| Some(check.run()))?;
    thread::Builder::new().name("input".to_owned()).spawn(move || read_input(&events))?;
    match serve(&arrived, &checker)? {
        Some(Ending::Orderly) => Ok(()),
        Some(Ending::Early) => bail!("the editor sent 'exit' without 'shutdown'"),
        None => bail!("standard input ended without 'exit'"),
    }
}

fn read_input(events: &Sender<Event>) {
    let mut input = std::io::stdin().lock();
    loop {
        let read = read_message(&mut input);
        let is_last = read.is_err();
        let Some(message) = read.unwrap_or_else(|error| Some(Err(error.to_string()))) else { break };
        if events.send(Event::Message(message)).is_err() || is_last {
            break;
        }
    }
    // The receiver may be gone already.
    let _ = events.send(Event::Closed);
}

/// Answers messages until the client ends the server; `None` if standard input ends before.
fn serve(arrived: &Receiver<Event>, checker: &Worker<Check, Checked>) -> anyhow::Result<Option<Ending>> {
    let mut server = Server::new(Arc::new(included_text));
    let mut is_closed = false;
    while !is_closed {
        let first = arrived.recv().context("the thread that reads standard input has ended")?;
        let mut messages = Vec::new();
        let mut answers: Vec<Value> = Vec::new();
        // Messages that are waiting are taken together, so that the newest text is compiled.
        for event in std::iter::once(first).chain(arrived.try_iter()) {
            match event {
                Event::Message(message) => messages.push(message),
                Event::Checked => {
                    answers.extend(checker.poll().into_iter().flat_map(|checked| server.checked(checked)));
                }
                Event::Closed => is_closed = true,
            }
        }
        answers.extend(server.receive(messages));
        let bytes: Vec<u8> = answers.iter().flat_map(framed).collect();
        let is_open = write_standard(&bytes)?;
        if !is_open || server.ending().is_some() {
            return Ok(server.ending());
        }
        if checker.is_idle()
            && let Some(check) = server.next_check()
        {
            checker.send(check);
        }
    }
    Ok(None)
}
