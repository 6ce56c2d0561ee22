//! The subcommand `lsp`: connects the language server to standard input and standard output.

use std::io::{IsTerminal, Read, Write};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use anyhow::{Context, bail};
use clap::Args;
use serde_json::Value;

use crate::scenes::included_text;
use mariana_language_server::{Check, Checked, Ending, Framing, Server, framed};
use mariana_work::{Worker, in_order};

#[derive(Args)]
pub(super) struct LspArguments {
    /// Use standard input and output, as always; editors add this flag out of habit
    #[arg(long, hide = true)]
    stdio: bool,
}

enum Event {
    /// Messages that arrived together.
    Messages(Vec<Result<Value, String>>),
    /// The other thread has checked a text.
    Checked,
    /// Standard input has ended or cannot be read.
    Closed,
}

/// Bytes that are read at once.
const CHUNK: usize = 1 << 16;

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
    let mut framing = Framing::default();
    let mut chunk = vec![0; CHUNK];
    loop {
        let length = input.read(&mut chunk).unwrap_or(0);
        framing.push(chunk.get(..length).unwrap_or_default());
        let messages: Vec<_> = std::iter::from_fn(|| framing.message()).collect();
        let is_sent = messages.is_empty() || events.send(Event::Messages(messages)).is_ok();
        if length == 0 || framing.is_broken() || !is_sent {
            // The receiver may be gone already.
            let _ = events.send(Event::Closed);
            return;
        }
    }
}

/// Answers messages until the client ends the server; `None` if standard input ends before.
fn serve(arrived: &Receiver<Event>, checker: &Worker<Check, Checked>) -> anyhow::Result<Option<Ending>> {
    let mut server = Server::new(Arc::new(included_text));
    let mut is_closed = false;
    while !is_closed {
        let first = arrived.recv().context("the thread that reads standard input has ended")?;
        let mut messages = Vec::new();
        let mut answers = Vec::new();
        // Messages that are waiting are taken together, so that the newest text is compiled.
        for event in std::iter::once(first).chain(arrived.try_iter()) {
            match event {
                Event::Messages(new) => messages.extend(new),
                Event::Checked => {
                    answers.extend(checker.poll().into_iter().flat_map(|checked| server.checked(checked)));
                }
                Event::Closed => is_closed = true,
            }
        }
        answers.extend(server.receive(messages));
        if !write(&answers)? || server.ending().is_some() {
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

/// Writes messages to standard output; false if the client has closed it.
fn write(messages: &[Value]) -> anyhow::Result<bool> {
    let mut output = std::io::stdout().lock();
    for message in messages {
        match output.write_all(&framed(message)) {
            Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => return Ok(false),
            written => written.context("standard output cannot be written")?,
        }
    }
    match output.flush() {
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(false),
        flushed => flushed.map(|()| true).context("standard output cannot be written"),
    }
}
