//! Output without a window: stills, videos, analyses, measurements, show files. [`show_painter`] draws the frames of
//! stills and videos.

mod alpha;
pub mod analyze;
pub mod bench;
mod earlier_sound;
pub mod error;
mod exact_textures;
mod fingerprint;
pub mod mesh;
pub mod output;
pub mod painter;
mod panorama;
mod path_store;
pub mod paths;
pub mod print;
pub mod show_file;
pub mod show_painter;
pub mod showing;
pub mod shutter;
pub mod song_features;
pub mod song_page;
pub mod still;
pub mod structure;
pub mod video;

pub use error::ExportError;
pub use output::Output;
pub use painter::SceneChoice;
pub use print::{print_line, print_message};
pub use showing::Showing;
pub use shutter::Shutter;
