//! The manual pages: one of the program, and one of each subcommand.

use std::io::Write;

use clap::Command;
use clap::builder::Resettable;
use clap_mangen::Man;
use clap_mangen::roff::{Roff, roman};

/// File name and text of every page.
///
/// # Errors
/// None: memory takes whatever is written.
pub(super) fn pages(program: Command) -> std::io::Result<Vec<(String, Vec<u8>)>> {
    let mut program = program.disable_help_subcommand(true).subcommand_value_name("command");
    program.build();
    std::iter::once(&program).chain(program.get_subcommands()).map(|command| page(command.clone())).collect()
}

fn page(command: Command) -> std::io::Result<(String, Vec<u8>)> {
    let after = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    let name = command.get_display_name().unwrap_or_else(|| command.get_name()).to_owned();
    let command =
        command.after_help(Resettable::Reset).mut_args(|arg| match arg.get_long_help().or(arg.get_help()) {
            // A line that begins with a space keeps to itself, as those of lists must.
            Some(help) => {
                let lines = help.to_string().replace('\n', "\n ");
                arg.long_help(lines)
            }
            None => arg,
        });
    let mut text = Vec::new();
    writeln!(text, ".TH {name} 1 \"\" \"mariana {}\" Mariana", env!("CARGO_PKG_VERSION"))?;
    // Whose title leaves out an empty date, so that the version would take its place.
    let mut rendered = Vec::new();
    Man::new(command).render(&mut rendered)?;
    for line in rendered.split_inclusive(|byte| *byte == b'\n').filter(|line| !line.starts_with(b".TH ")) {
        text.extend_from_slice(line);
    }
    further_sections(&after).to_writer(&mut text)?;
    Ok((format!("man/{name}.1"), text))
}

/// What stands behind the options in the help, as sections: the examples keep their lines, the rest is notes.
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
