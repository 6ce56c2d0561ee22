//! The program's entry point: runs the command line, prints an error if there is one, and sets the exit code.

use mariana::ending::{Signal, asked_to_end, begin_to_leave};

fn main() {
    let result = mariana::cli::run();
    let leaving = begin_to_leave();
    let code = match result {
        Ok(()) => asked_to_end().map_or(0, Signal::exit_code),
        Err(error) => {
            mariana::export::print::print_message(&format!("{error:#}"));
            1
        }
    };
    leaving.leave(code)
}
