//! The subcommand `format`: gives scenes regular indentation and blanks.

use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::Args;

use super::common::colors;
use super::files::{is_standard, scene_of};
use crate::atomic_file::AtomicFile;
use crate::export::output::write_standard;
use crate::export::print::{print_line, print_message};
use crate::scenes::SceneSource;
use mariana_field::lang::{check_syntax, formatted, render_all};

#[derive(Args)]
pub(super) struct FormatArguments {
    /// Scene files, which are changed; '-' reads a scene from standard input and writes it to standard output
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Change nothing: print the names of the files that would change, and fail if there are any
    #[arg(long)]
    check: bool,
}

pub(super) fn run(arguments: &FormatArguments) -> anyhow::Result<()> {
    let (mut unformatted, mut refused) = (0, 0);
    for file in &arguments.files {
        match format(file, arguments.check) {
            Ok(true) => {}
            Ok(false) => unformatted += 1,
            Err(error) if arguments.files.len() == 1 => return Err(error),
            Err(error) => {
                print_message(&format!("{error:#}"));
                refused += 1;
            }
        }
    }
    let count = |number: usize, one: &str, many: &str| match number {
        1 => one.to_owned(),
        _ => format!("{number} {many}"),
    };
    if refused > 0 {
        bail!("{} not formatted: see above", count(refused, "a file was", "files were"));
    }
    if unformatted > 0 {
        bail!("{} not formatted: run 'mariana format'", count(unformatted, "a file is", "files are"));
    }
    Ok(())
}

/// Formats a file. With `check`, prints its name instead if it would change, and returns false.
fn format(file: &Path, check: bool) -> anyhow::Result<bool> {
    let is_standard = is_standard(file);
    let source = if is_standard { scene_of("-")? } else { SceneSource::File(file.to_owned()) };
    let (name, text) = (source.name(), source.text()?);
    let Some(formatted) = formatted(&text) else {
        let (mistakes, sources) = check_syntax(&name, &text);
        let mistakes = render_all(&mistakes, &sources, colors(&std::io::stderr()));
        bail!("{name} has mistakes and was not changed: correct what is underlined\n{}", mistakes.trim_end());
    };
    if check {
        if formatted != text {
            print_line(&name)?;
        }
        return Ok(formatted == text);
    }
    if is_standard {
        write_standard(formatted.as_bytes())?;
    } else if formatted != text {
        AtomicFile::create(file)?.write(formatted.as_bytes())?;
    }
    Ok(true)
}
