//! Generates the manual pages and shell completions of `assets/desktop`.
//!
//! ```text
//! cargo xtask desktop [FOLDER]
//! ```
//!
//! `FOLDER` defaults to `assets/desktop`. Manual pages and completions come from the definition of the command line
//! (`mariana::cli`). Every run writes the same bytes.

mod manual;
mod scene_names;

use std::path::{Path, PathBuf};

use clap::CommandFactory;
use clap_complete::Shell;
use mariana::atomic_file::AtomicFile;
use mariana::cli::Arguments;

const SHELLS: [(Shell, &str); 3] =
    [(Shell::Bash, "mariana.bash"), (Shell::Zsh, "_mariana"), (Shell::Fish, "mariana.fish")];

pub(crate) fn run(arguments: &[String]) -> anyhow::Result<()> {
    let folder =
        arguments.first().map_or_else(|| Path::new(crate::root::ROOT).join("assets/desktop"), PathBuf::from);
    let mut files = manual::pages(Arguments::command())?;
    for (shell, name) in SHELLS {
        let mut text = Vec::new();
        clap_complete::generate(shell, &mut Arguments::command(), "mariana", &mut text);
        let text = scene_names::offered(shell, &String::from_utf8(text)?)?;
        files.push((format!("completions/{name}"), text.into_bytes()));
    }
    for (name, bytes) in &files {
        AtomicFile::create_with_folder(&folder.join(name))?.write(bytes)?;
    }
    println!("{} files, {} bytes", files.len(), files.iter().map(|(_, bytes)| bytes.len()).sum::<usize>());
    Ok(())
}
