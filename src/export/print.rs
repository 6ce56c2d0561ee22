//! Text on standard output and standard error, which may be closed or full: printing never panics.

use std::io::{ErrorKind, Write};

use super::error::ExportError;

/// Prints a line on standard output. A reader that has read enough and left is no error.
///
/// # Errors
/// [`ExportError::Print`] if standard output takes nothing.
pub fn print_line(text: &str) -> Result<(), ExportError> {
    match writeln!(std::io::stdout(), "{text}") {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => written.map_err(ExportError::Print),
    }
}

/// Tells the user a sentence on standard error, under the program's name. Where nobody listens, nothing is told.
pub fn tell(sentence: &str) {
    // There is no other place to complain of it.
    let _ = writeln!(std::io::stderr(), "mariana: {sentence}");
}
