//! Draws `assets/thumbnails`, which the program includes: an image and a short loop of each shipped scene. Run this
//! tool if you change a scene or the renderer and the test `the_shipped_thumbnails_are_up_to_date` fails. It needs
//! ffmpeg, which encodes the loops.

use std::fs;
use std::path::Path;

use anyhow::Context as _;
use mariana::demo_track::DEMO_TRACK;
use mariana::export::output::Output;
use mariana::export::shutter::Shutter;
use mariana::export::still::{StillRequest, write_still};
use mariana::scenes::{SceneSource, shipped_names};
use mariana::thumbnails::{LOOP_FRAMES, LOOP_RATE, LOOP_SIZE, MOMENT, SIZE, jpeg_of};
use mariana_music::Gain;

use crate::animation::Animation;

/// Draws the named scenes, or all scenes, and removes thumbnails without a scene.
pub(crate) fn run(wanted: &[String]) -> anyhow::Result<()> {
    let folder = Path::new(crate::root::ROOT).join("assets/thumbnails");
    fs::create_dir_all(&folder)?;
    let names = shipped_names();
    for name in names.iter().filter(|name| wanted.is_empty() || wanted.contains(name)) {
        let jpeg = draw(name, &folder).with_context(|| format!("drawing {name}"))?;
        fs::write(folder.join(format!("{name}.jpg")), &jpeg)?;
        let moving = folder.join(format!("{name}.webp"));
        draw_loop(name, &moving).with_context(|| format!("drawing the loop of {name}"))?;
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

/// Returns the thumbnail of a scene as a JPEG, drawn in the same way as the thumbnails of a user's scenes.
fn draw(name: &str, folder: &Path) -> anyhow::Result<Vec<u8>> {
    let path = folder.join(format!("{name}.png"));
    write_still(&StillRequest {
        song: DEMO_TRACK,
        at: MOMENT,
        size: SIZE,
        gain: Gain::Auto,
        output: Output::Path(path.clone()),
        scene: SceneSource::Shipped(name.to_owned()).into(),
        show: None,
        blend: None,
        set: Vec::new(),
        ray: None,
        shutter: Shutter::MOMENT,
    })?;
    let picture = image::open(&path);
    fs::remove_file(&path)?;
    Ok(jpeg_of(&picture?.into_rgba8()))
}

/// Draws the loop of a scene from [`MOMENT`] and writes it to `file` as an animated WebP of low quality, because loops
/// are small and move.
fn draw_loop(name: &str, file: &Path) -> anyhow::Result<()> {
    let of_list =
        Animation { start: MOMENT, frames: LOOP_FRAMES, rate: LOOP_RATE, size: LOOP_SIZE, quality: 25 };
    of_list.draw(name, file)
}
