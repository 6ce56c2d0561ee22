//! Output without a window: stills, videos, analyses, measurements, show files. [`painter`] draws the frames for all.

mod alpha;
pub mod analyze;
pub mod bench;
mod earlier_sound;
pub mod error;
mod exact_textures;
pub mod output;
pub mod painter;
mod panorama;
pub mod paths;
pub mod print;
pub mod show_file;
mod show_painter;
pub mod showing;
pub mod shutter;
pub mod song_features;
pub mod song_page;
pub mod still;
pub mod structure;
pub mod video;

pub use error::ExportError;
