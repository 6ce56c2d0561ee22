//! Writes the grammars for editors.
//!
//! ```text
//! cargo xtask grammars [FOLDER]
//! ```
//!
//! `FOLDER` defaults to `editors`.

use std::path::{Path, PathBuf};

use mariana::atomic_file::AtomicFile;
use mariana_language_server::grammars::files;

pub(crate) fn run(arguments: &[String]) -> anyhow::Result<()> {
    let folder =
        arguments.first().map_or_else(|| Path::new(crate::root::ROOT).join("editors"), PathBuf::from);
    for (name, text) in files() {
        AtomicFile::create_with_folder(&folder.join(name))?.write(text.as_bytes())?;
    }
    Ok(())
}
