//! The files of this folder that the program contains. They are a package, so that packaged crates contain them.

use include_dir::{Dir, include_dir};

/// The shipped scenes.
pub static SCENES: Dir<'static> = include_dir!("$CARGO_MANIFEST_DIR/scenes");

/// The textures of shipped scenes.
pub static TEXTURES: Dir<'static> = include_dir!("$CARGO_MANIFEST_DIR/textures");

/// The thumbnails of shipped scenes: a JPEG and an animated WebP for each. Drawn by `cargo xtask thumbnails`.
pub static THUMBNAILS: Dir<'static> = include_dir!("$CARGO_MANIFEST_DIR/thumbnails");

/// "Hadal Lanterns", composed by this project.
pub const DEMO_TRACK: &[u8] = include_bytes!("demo.ogg");

/// The show of the demo track.
pub const DEMO_SHOW: &str = include_str!("demo.show");

/// The icon as a PNG of 128 x 128 pixels. Made by the tool `icon` in `tools/`.
pub const ICON: &[u8] = include_bytes!("desktop/icons/128x128/apps/org.mariana.Mariana.png");
