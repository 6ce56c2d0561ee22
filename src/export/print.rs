//! Prints on standard output and standard error. Does not panic if an output is closed or full.

use std::io::{ErrorKind, Write};

use super::error::ExportError;
use mariana_field::lang::plural;

/// Prints a line on standard output. A closed pipe is no error.
///
/// # Errors
/// [`ExportError::Print`] if standard output cannot be written.
pub fn print_line(text: &str) -> Result<(), ExportError> {
    is_open(writeln!(std::io::stdout(), "{text}")).map(drop)
}

/// Returns false if the reader of an output has closed it.
///
/// # Errors
/// [`ExportError::Print`] if the output could not be written for another reason.
pub(super) fn is_open(written: std::io::Result<()>) -> Result<bool, ExportError> {
    match written {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
        written => written.map(|()| true).map_err(ExportError::Print),
    }
}

/// A number of things: `1 frame`, `2 frames`.
pub fn counted(number: impl TryInto<u64>, what: &str) -> String {
    match number.try_into().unwrap_or(u64::MAX) {
        1 => format!("1 {what}"),
        number => format!("{number} {}", plural(what)),
    }
}

/// Prints a message for the user on standard error, after the program's name. Does nothing if standard error is closed.
pub fn print_message(sentence: &str) {
    tracing::debug!(target: "message", "{sentence}");
    // An error here cannot be reported anywhere.
    let _ = writeln!(std::io::stderr(), "mariana: {sentence}");
}
