//! Text on standard output and standard error, which may be closed or full: printing never panics.

use std::io::{ErrorKind, Write};

use super::error::ExportError;

/// Prints a line on standard output. A reader that has read enough and closed it is no error.
///
/// # Errors
/// [`ExportError::Print`] if standard output accepts nothing.
pub fn print_line(text: &str) -> Result<(), ExportError> {
    match writeln!(std::io::stdout(), "{text}") {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => written.map_err(ExportError::Print),
    }
}

/// Prints a sentence for the user on standard error, after the program's name. If standard error is closed, nothing
/// happens.
pub fn tell(sentence: &str) {
    tracing::debug!(target: "report", "{sentence}");
    // There is no other place to report that.
    let _ = writeln!(std::io::stderr(), "mariana: {sentence}");
}
