//! The files of this folder, embedded. They are a package, so that a packaged renderer contains its shaders.

use include_dir::{Dir, include_dir};

/// The shaders, without folders. `Cargo.toml`, `README.md` and `lib.rs` are in it too.
pub static SHADERS: Dir<'static> = include_dir!("$CARGO_MANIFEST_DIR");
