//! Prints on standard output and standard error. Does not panic if an output is closed or full.

use std::io::{ErrorKind, Write};

use super::error::ExportError;

/// Prints a line on standard output. A closed pipe is no error.
///
/// # Errors
/// [`ExportError::Print`] if standard output cannot be written.
pub fn print_line(text: &str) -> Result<(), ExportError> {
    match writeln!(std::io::stdout(), "{text}") {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => written.map_err(ExportError::Print),
    }
}

/// Prints a text on standard output, without a further line end. A closed pipe is no error.
///
/// # Errors
/// [`ExportError::Print`] if standard output cannot be written.
pub fn print_text(text: &str) -> Result<(), ExportError> {
    let mut output = std::io::stdout().lock();
    match output.write_all(text.as_bytes()).and_then(|()| output.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => written.map_err(ExportError::Print),
    }
}

/// Prints a message for the user on standard error, after the program's name. Does nothing if standard error is closed.
pub fn print_message(sentence: &str) {
    tracing::debug!(target: "message", "{sentence}");
    // An error here cannot be reported anywhere.
    let _ = writeln!(std::io::stderr(), "mariana: {sentence}");
}
