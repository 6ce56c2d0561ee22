//! Generates the reference of the scene language.
//!
//! ```text
//! cargo xtask language-page [FOLDER]
//! ```
//!
//! Writes `language.md` and, in `shapes/`, an image of each function in [`mariana_field::lang::examples`]. `FOLDER`
//! defaults to `docs`. The text comes from doc comments in the library's texts and in the code
//! (`mariana_field::lang::entries`), and from `intro.md` here.

mod reference;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::imageops::thumbnail;
use image::{DynamicImage, RgbImage};
use mariana::scenes::SceneSource;
use mariana_field::lang::examples;

use crate::animation::still;

const SIZE: (u32, u32) = (200, 150);
/// The width and height of a drawing as a multiple of the image's, to smooth its edges.
const FINER: u32 = 3;

pub(crate) fn run(arguments: &[String]) -> anyhow::Result<()> {
    let folder = arguments.first().map_or_else(|| Path::new(crate::root::ROOT).join("docs"), PathBuf::from);
    let shapes = folder.join("shapes");
    fs::create_dir_all(&shapes)?;
    fs::write(folder.join("language.md"), reference::text())?;
    for (name, formula) in examples() {
        let image = picture(formula).with_context(|| format!("drawing {name}"))?;
        let mut bytes = Vec::new();
        let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::NoFilter);
        image.write_with_encoder(encoder)?;
        fs::write(shapes.join(format!("{name}.png")), &bytes)?;
        println!("{name}: {} bytes", bytes.len());
    }
    Ok(())
}

/// Draws a shape of copper over a grey ground.
fn picture(formula: &str) -> anyhow::Result<RgbImage> {
    let scene =
        format!("object shape {{ shape = {formula}  material = copper }}\n{}", include_str!("around.scene"));
    let drawn = still(SceneSource::Formula(scene), 0.0, (FINER * SIZE.0, FINER * SIZE.1))?;
    let mut image = DynamicImage::from(thumbnail(&drawn, SIZE.0, SIZE.1)).into_rgb8();
    // Even values make smaller files.
    image.iter_mut().for_each(|part| *part &= !1);
    Ok(image)
}
