//! The manual pages: one for the program and one for each subcommand.

use std::io::Write;

use clap::Command;
use clap::builder::Resettable;
use clap_mangen::Man;
use clap_mangen::roff::{Roff, roman};

/// Returns the file names and texts of all pages.
///
/// # Errors
/// Never fails, because the text is written to memory.
pub(super) fn pages(program: Command) -> std::io::Result<Vec<(String, Vec<u8>)>> {
    let mut program = program.disable_help_subcommand(true).subcommand_value_name("command");
    program.build();
    std::iter::once(&program).chain(program.get_subcommands()).map(|command| page(command.clone())).collect()
}

fn page(command: Command) -> std::io::Result<(String, Vec<u8>)> {
    let after = command.get_after_long_help().or(command.get_after_help());
    let after = after.map(ToString::to_string).unwrap_or_default();
    let name = command.get_display_name().unwrap_or_else(|| command.get_name()).to_owned();
    let command = command.after_help(Resettable::Reset).after_long_help(Resettable::Reset);
    let command = command.mut_args(|arg| match arg.get_long_help().or(arg.get_help()) {
        // A space at the start of a line keeps the line break before it, which lists need.
        Some(help) => {
            let lines = help.to_string().replace('\n', "\n ");
            arg.long_help(lines)
        }
        None => arg,
    });
    let mut text = Vec::new();
    writeln!(text, ".TH {name} 1 \"\" \"mariana {}\" Mariana", env!("CARGO_PKG_VERSION"))?;
    // Write the title line here: `Man` omits an empty date, and the version would then take the date's place.
    let mut rendered = Vec::new();
    Man::new(command).render(&mut rendered)?;
    for line in rendered.split_inclusive(|byte| *byte == b'\n').filter(|line| !line.starts_with(b".TH ")) {
        text.extend_from_slice(line);
    }
    further_sections(&after).to_writer(&mut text)?;
    Ok((format!("man/{name}.1"), text))
}

/// Converts the help text after the options: examples become a section that keeps its lines, other text becomes notes.
fn further_sections(after: &str) -> Roff {
    let mut roff = Roff::new();
    let (examples, notes): (Vec<&str>, Vec<&str>) =
        after.split("\n\n").filter(|part| !part.is_empty()).partition(|part| part.starts_with("Examples:"));
    for part in examples {
        roff.control("SH", ["EXAMPLES"]).control("nf", []);
        for line in part.lines().skip(1) {
            roff.text([roman(line.trim_start())]);
        }
        roff.control("fi", []);
    }
    for (number, part) in notes.into_iter().enumerate() {
        if number == 0 {
            roff.control("SH", ["NOTES"]);
        } else {
            roff.control("PP", []);
        }
        for line in part.lines() {
            roff.text([roman(line)]);
        }
    }
    roff
}
