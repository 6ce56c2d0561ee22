//! Names for damaged files, which are renamed and never overwritten.

use std::path::{Path, PathBuf};

/// Returns a free name for the damaged TOML file at `path`, such as `settings.toml.broken`.
pub(super) fn aside(path: &Path) -> PathBuf {
    let named = |number: u32| match number {
        1 => path.with_extension("toml.broken"),
        _ => path.with_extension(format!("toml.broken-{number}")),
    };
    (1..100).map(named).find(|path| !path.exists()).unwrap_or_else(|| named(1))
}
