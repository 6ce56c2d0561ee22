//! Generates `docs/gallery.md`: for each shipped scene a large image, an animated one, and a strip of four moments of the
//! demo track. Run this tool after you change a scene.
//!
//! `cargo xtask gallery [SCENE ...]` draws these scenes, or all scenes.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::animation::{Animation, still};
use anyhow::Context as _;
use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, RgbaImage, imageops};
use mariana::scenes::{SceneSource, first_comment, shipped_names};

/// Times in the demo track in seconds: the quiet start, the first rise, the loudest part and the ending.
const MOMENTS: [f64; 4] = [3.0, 24.0, 62.0, 81.0];
/// Index of the moment that the large image shows.
const LARGE: usize = 2;
const LARGE_SIZE: (u32, u32) = (1280, 720);
const STRIP_SIZE: (u32, u32) = (480, 270);
/// The animated picture of a scene: two seconds of the loudest part.
const MOTION: Animation =
    Animation { start: MOMENTS[LARGE], frames: 24, rate: 12, size: (384, 216), quality: 50 };
const JPEG_QUALITY: u8 = 88;
/// Mathematical surfaces. The page shows them after the scenes for music.
const SURFACES: [&str; 4] = ["barth", "first_steps", "heart", "quadric"];

/// Draws the named scenes, or all scenes, and writes the page.
pub(crate) fn run(wanted: &[String]) -> anyhow::Result<()> {
    let docs = Path::new(crate::root::ROOT).join("docs");
    let folder = docs.join("gallery");
    fs::create_dir_all(&folder)?;
    let (surfaces, music): (Vec<String>, Vec<String>) =
        shipped_names().into_iter().partition(|name| SURFACES.contains(&name.as_str()));
    let mut page = String::from(INTRO);
    for name in music.iter().chain(&surfaces) {
        if wanted.is_empty() || wanted.contains(name) {
            MOTION.draw(name, &folder.join(format!("{name}.webp")))?;
            draw(name, &folder).with_context(|| format!("drawing {name}"))?;
        }
        if Some(name) == surfaces.first() {
            page.push_str("\n# Surfaces\n");
        }
        let introduction =
            first_comment(&SceneSource::Shipped(name.clone()).text()?).collect::<Vec<_>>().join("\n");
        let _ = write!(
            page,
            "\n## {name}\n\n{introduction}\n\n![{name}](gallery/{name}.jpg)\n\n\
![{name} at four moments](gallery/{name}-strip.jpg)\n"
        );
        if folder.join(format!("{name}.webp")).exists() {
            let _ = write!(page, "\n![{name} in motion](gallery/{name}.webp)\n");
        }
    }
    fs::write(docs.join("gallery.md"), page)?;
    Ok(())
}

const INTRO: &str = "\
# Gallery

Choose a scene to play with `mariana --scene NAME`, or to copy from `assets/scenes`. The images show each scene at four
moments of the demo track; the large one is the loudest. `cargo xtask gallery` generates this page.

# Music
";

fn draw(name: &str, folder: &Path) -> anyhow::Result<()> {
    let still = |time, size| still(SceneSource::Shipped(name.to_owned()), time, size);
    write_jpeg(&folder.join(format!("{name}.jpg")), still(MOMENTS[LARGE], LARGE_SIZE)?)?;
    let mut strip = RgbaImage::new(STRIP_SIZE.0 * MOMENTS.len() as u32, STRIP_SIZE.1);
    for (moment, time) in MOMENTS.into_iter().enumerate() {
        let left = i64::from(STRIP_SIZE.0) * moment as i64;
        imageops::replace(&mut strip, &still(time, STRIP_SIZE)?, left, 0);
    }
    write_jpeg(&folder.join(format!("{name}-strip.jpg")), strip)
}

fn write_jpeg(path: &Path, picture: RgbaImage) -> anyhow::Result<()> {
    let mut bytes = Vec::new();
    let encoder = JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY);
    DynamicImage::ImageRgba8(picture).into_rgb8().write_with_encoder(encoder)?;
    Ok(fs::write(path, bytes)?)
}
