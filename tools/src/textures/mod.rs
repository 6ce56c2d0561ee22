//! Generates the shipped textures `wood.png` and `mallard.png`.
//!
//! ```text
//! cargo run --manifest-path tools/Cargo.toml -- textures [FOLDER]
//! ```
//!
//! `FOLDER` defaults to `assets/textures`. Both images are computed. Their only randomness is an integer hash, so
//! that every run writes the same bytes.

pub(crate) mod canvas;
mod feather;
mod mallard;
mod noise;
mod shape;
mod wood;

use std::io::BufWriter;
use std::path::{Path, PathBuf};

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

pub(crate) fn run(arguments: &[String]) -> anyhow::Result<()> {
    let folder = arguments
        .first()
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/textures"), PathBuf::from);
    std::fs::create_dir_all(&folder)?;
    let side = wood::SIDE as u32;
    write_png(&folder.join("wood.png"), &wood::paint(), side, ExtendedColorType::Rgb8)?;
    let side = mallard::SIDE as u32;
    write_png(&folder.join("mallard.png"), &mallard::paint(), side, ExtendedColorType::Rgba8)?;
    Ok(())
}

fn write_png(path: &Path, pixels: &[u8], side: u32, color: ExtendedColorType) -> anyhow::Result<()> {
    let file = BufWriter::new(std::fs::File::create(path)?);
    PngEncoder::new_with_quality(file, CompressionType::Best, FilterType::Adaptive)
        .write_image(pixels, side, side, color)?;
    println!("{}: {side} x {side}, {} bytes", path.display(), std::fs::metadata(path)?.len());
    Ok(())
}
