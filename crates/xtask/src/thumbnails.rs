//! Draws `assets/thumbnails`, which the program includes: an image and a short loop of each shipped scene. Run this
//! tool if you change a scene or the renderer and the test `the_shipped_thumbnails_are_up_to_date` fails. It needs
//! ffmpeg, which encodes the loops.

use std::fs;
use std::path::Path;

use anyhow::Context as _;
use mariana::scenes::{SceneSource, shipped_names};
use mariana::thumbnails::{LOOP_FRAMES, LOOP_RATE, LOOP_SIZE, MOMENT, SIZE, jpeg_of};

use crate::animation::{Animation, still};

/// The loops are of low quality, because they are small and move.
const LOOP: Animation =
    Animation { start: MOMENT, frames: LOOP_FRAMES, rate: LOOP_RATE, size: LOOP_SIZE, quality: 19 };

/// Draws the named scenes, or all scenes, and removes thumbnails without a scene.
pub(crate) fn run(wanted: &[String]) -> anyhow::Result<()> {
    let folder = Path::new(crate::root::ROOT).join("assets/thumbnails");
    fs::create_dir_all(&folder)?;
    let names = shipped_names();
    for name in names.iter().filter(|name| wanted.is_empty() || wanted.contains(name)) {
        let jpeg = still(SceneSource::Shipped(name.clone()), MOMENT, SIZE)
            .map(|picture| jpeg_of(&picture))
            .with_context(|| format!("drawing {name}"))?;
        fs::write(folder.join(format!("{name}.jpg")), &jpeg)?;
        let moving = folder.join(format!("{name}.webp"));
        LOOP.draw(name, &moving).with_context(|| format!("drawing the loop of {name}"))?;
        let bytes = jpeg.len() as u64 + fs::metadata(&moving)?.len();
        println!("{name}: {} KiB", bytes.div_ceil(1024));
    }
    for entry in fs::read_dir(&folder)? {
        let path = entry?.path();
        if !names.iter().any(|name| path.file_stem().is_some_and(|stem| stem == name.as_str())) {
            fs::remove_file(path)?;
        }
    }
    Ok(())
}
