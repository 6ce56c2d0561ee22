//! Moving thumbnails of the shipped scenes: short loops, drawn by `cargo xtask thumbnails`.
//!
//! Loops need no drawing, so they move on every machine in the same way, and looking through the list costs the show
//! nothing. Scenes of the user have no loop.

use std::io::Cursor;
use std::sync::Arc;
use std::time::Duration;

use image::codecs::webp::WebPDecoder;
use image::{AnimationDecoder, RgbaImage};

use super::shipped::shipped_loop;
use crate::SceneSource;

/// Size of a loop in pixels.
pub const LOOP_SIZE: (u32, u32) = (192, 108);
/// Frames per second of a loop.
pub const LOOP_RATE: u32 = 8;
/// Number of frames of a loop.
pub const LOOP_FRAMES: u32 = 12;

/// How long each frame of a loop is shown.
pub fn frame_time() -> Duration {
    Duration::from_secs(1) / LOOP_RATE
}

/// Returns the frames of a scene's loop; empty if the scene has no loop.
pub(super) fn frames_of(source: &SceneSource) -> Vec<Arc<RgbaImage>> {
    match source {
        SceneSource::Shipped(name) => shipped_loop(name).map(decoded).unwrap_or_default(),
        SceneSource::Blend(blend) => frames_of(&blend.to.source),
        SceneSource::File(_) | SceneSource::Formula(_) => Vec::new(),
    }
}

fn decoded(bytes: &[u8]) -> Vec<Arc<RgbaImage>> {
    let decoder = match WebPDecoder::new(Cursor::new(bytes)) {
        Ok(decoder) => decoder,
        Err(error) => {
            tracing::warn!("a moving thumbnail cannot be read: {error}");
            return Vec::new();
        }
    };
    let frames = decoder.into_frames().take(LOOP_FRAMES as usize);
    frames.map_while(Result::ok).map(|frame| Arc::new(frame.into_buffer())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shipped_names;

    #[test]
    fn every_shipped_scene_moves_and_all_loops_are_small() {
        let mut bytes = 0;
        for name in shipped_names() {
            bytes += shipped_loop(&name).map_or(0, <[u8]>::len);
            let frames = frames_of(&SceneSource::Shipped(name.clone()));
            assert_eq!(frames.len(), LOOP_FRAMES as usize, "{name}: run cargo xtask thumbnails");
            assert!(frames.iter().all(|frame| frame.dimensions() == LOOP_SIZE), "{name}");
            let changed = frames.windows(2).filter(|pair| pair[0] != pair[1]).count();
            assert!(changed >= frames.len() / 2, "{name} hardly moves: {changed} changes");
        }
        assert!(bytes < 400_000, "{bytes} bytes");
    }

    #[test]
    fn other_scenes_and_damaged_loops_do_not_move() {
        assert!(frames_of(&SceneSource::File("own.scene".into())).is_empty());
        assert!(decoded(b"").is_empty() && decoded(b"RIFF\0\0\0\0WEBPrubbish").is_empty());
        let whole = shipped_loop("orb").unwrap();
        assert!(decoded(&whole[..whole.len() / 2]).len() < LOOP_FRAMES as usize);
    }
}
