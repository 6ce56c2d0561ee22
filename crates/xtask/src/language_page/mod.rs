//! Generates the reference of the scene language.
//!
//! ```text
//! cargo xtask language-page [FOLDER]
//! ```
//!
//! Writes `language.md` and, in `shapes/`, an image of each function in [`mariana_field::lang::examples`]. `FOLDER`
//! defaults to `docs`. The text comes from doc comments in the library's texts and in the code
//! (`mariana_field::lang::entries`), and from `intro.md` here. Every run writes the same bytes.

mod draw;
mod field;
mod reference;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use mariana_field::graph::FrameInputs;

use mariana_field::lang::examples;

pub(crate) fn run(arguments: &[String]) -> anyhow::Result<()> {
    let folder = arguments.first().map_or_else(|| Path::new(crate::root::ROOT).join("docs"), PathBuf::from);
    let shapes = folder.join("shapes");
    std::fs::create_dir_all(&shapes)?;
    std::fs::write(folder.join("language.md"), reference::text())?;

    let (next, examples): (_, Vec<_>) = (AtomicUsize::new(0), examples().collect());
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    let sizes = std::thread::scope(|scope| {
        let work = || -> Result<usize, String> {
            let mut bytes = 0;
            while let Some((name, formula)) = examples.get(next.fetch_add(1, Ordering::Relaxed)) {
                bytes += picture(&shapes, name, formula)?;
            }
            Ok(bytes)
        };
        let threads: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        threads
            .into_iter()
            .map(|thread| {
                thread.join().unwrap_or_else(|_| Err("a thread panicked while drawing an image".to_owned()))
            })
            .collect::<Result<Vec<usize>, String>>()
    })
    .map_err(anyhow::Error::msg)?;
    println!("{} images, {} bytes", examples.len(), sizes.iter().sum::<usize>());
    Ok(())
}

/// Draws one image and returns the size of its file in bytes.
fn picture(folder: &Path, name: &str, formula: &str) -> Result<usize, String> {
    let tape = field::tape(name, formula)?;
    let frame = FrameInputs::default();
    let mut field = field::SampledField::new(&tape, &frame);
    let pixels = draw::draw(&mut field).ok_or_else(|| format!("{name}: {formula} has no visible surface"))?;
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::NoFilter)
        .write_image(&pixels, draw::WIDTH as u32, draw::HEIGHT as u32, ExtendedColorType::Rgb8)
        .map_err(|error| format!("{name}: {error}"))?;
    let path = folder.join(format!("{name}.png"));
    std::fs::write(&path, &bytes).map_err(|error| format!("{}: {error}", path.display()))?;
    println!("{name}: {} bytes, steps of {:.2}", bytes.len(), field.step);
    Ok(bytes.len())
}
