//! The program: arguments in, one printed error and the exit code out.

use std::process::ExitCode;

fn main() -> ExitCode {
    match mariana::cli::run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            mariana::export::print::tell(&format!("{error:#}"));
            ExitCode::FAILURE
        }
    }
}
