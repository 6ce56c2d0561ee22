//! Pictures of textures that change during the song: videos, cameras and the cover of the song.
//!
//! The picture of a video depends only on the time of the frame: `mariana still`, `mariana video` and the window show
//! the same picture at the same moment. Exports wait for each picture. The window ([`LiveTextures`]) decodes ahead on
//! threads and never waits: the last picture stays until the next one has come.

mod feed;
mod live;

use std::sync::Arc;

use image::RgbaImage;

pub use live::LiveTextures;

use crate::scenes::TextureSource;
use mariana_field::world::World;
use mariana_player::video::{VideoError, VideoFrame, VideoReader};

/// Describes a source for `mariana check`. Reads the first frame of a video; leaves cameras alone.
///
/// # Errors
/// Fails if the video cannot be decoded.
pub fn description(source: &TextureSource) -> Result<String, VideoError> {
    let name = source.name();
    let TextureSource::Video { file, .. } = source else {
        return Ok(match source {
            TextureSource::Cover => "shows the cover of the song".to_owned(),
            _ => format!("shows {name}, which is live only: grey in stills and videos"),
        });
    };
    let mut reader = VideoReader::open(file, &name)?;
    reader.frame(0)?;
    let info = reader.info();
    let ((width, height), rate, seconds) = (info.size, info.rate(), info.seconds());
    let rate = (rate * 1000.0).round() / 1000.0;
    Ok(format!("{name}: {width} x {height} pixels, {rate} frames a second, repeats after {seconds:.2} s"))
}

/// The pictures of a world's moving textures, by the numbers of the textures. `picture` returns that of a source.
pub(crate) fn pictures_of(
    world: &World,
    mut picture: impl FnMut(TextureSource) -> Option<Arc<RgbaImage>>,
) -> Vec<Option<Arc<RgbaImage>>> {
    let mut pictures = Vec::new();
    for (number, source) in TextureSource::of_world(world) {
        pictures.resize(number, None);
        pictures.push(picture(source));
    }
    pictures
}

/// Copies no pixels. `None` if the number of pixels does not fit the size.
pub(crate) fn image_of(frame: VideoFrame) -> Option<RgbaImage> {
    RgbaImage::from_raw(frame.size.0, frame.size.1, frame.rgba)
}
