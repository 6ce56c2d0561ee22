//! Draws a thumbnail in a separate process.

use std::fs;
use std::io::{self, Cursor};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};

use image::codecs::webp::WebPDecoder;
use image::{AnimationDecoder, RgbaImage};
use mariana_assets::THUMBNAILS;
use mariana_files::child::{ChildLimits, ChildProcess};

use super::{MOMENT, SIZE};
use crate::{SceneSource, limits};

const INTERVAL: Duration = Duration::from_millis(20);
/// A driver's cache of programs may be a large file.
const CHILD_LIMITS: ChildLimits =
    ChildLimits { memory: Some(4 << 30), cpu_seconds: Some(300), file: Some(1 << 30) };

/// Draws the thumbnail of a scene in a separate process and returns the bytes of a PNG. The process runs `program`,
/// or the running executable if that is `None`. Polls `is_stopped` and ends the process when it returns true.
///
/// # Errors
/// Fails with a reason.
pub(super) fn draw(
    program: Option<&Path>,
    source: &SceneSource,
    mut is_stopped: impl FnMut() -> bool,
) -> io::Result<Vec<u8>> {
    let place = tempfile::tempdir()?;
    let file = place.path().join("picture.png");
    let scene = match source {
        SceneSource::Blend(blend) => return draw(program, &blend.to.source, is_stopped),
        SceneSource::Shipped(name) => name.into(),
        SceneSource::File(path) => path.clone().into_os_string(),
        SceneSource::Formula(text) => text.into(),
    };
    let mut option = std::ffi::OsString::from("--scene=");
    option.push(scene);
    let program = program.map_or_else(std::env::current_exe, |program| Ok(program.to_owned()))?;
    let mut command = Command::new(program);
    let size = format!("{}x{}", SIZE.0, SIZE.1);
    command.args(["still", "--at", &MOMENT.to_string(), "--size", &size, "-o"]).arg(&file);
    // The process ends when its input closes, so it never outlives this process.
    command.args(["--controlled"]).arg(option).env("LP_NUM_THREADS", "1");
    command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
    let mut child = ChildProcess::start(&mut command, CHILD_LIMITS)?;
    let until = Instant::now() + Duration::from_secs_f64(limits::THUMBNAIL_SECONDS_MAX);
    loop {
        match child.ended()? {
            Some(status) if status.success() => return fs::read(&file),
            Some(status) => return Err(io::Error::other(status.to_string())),
            None if is_stopped() => return Err(io::ErrorKind::Interrupted.into()),
            None if Instant::now() > until => {
                let words = format!("it takes more than {} s", limits::THUMBNAIL_SECONDS_MAX);
                return Err(io::Error::new(io::ErrorKind::TimedOut, words));
            }
            None => std::thread::sleep(INTERVAL),
        }
    }
}

// Thumbnails of the shipped scenes, drawn by `cargo xtask thumbnails`.

/// Returns the thumbnail of a shipped scene as a JPEG; `None` for an unknown name.
pub fn shipped(name: &str) -> Option<&'static [u8]> {
    THUMBNAILS.get_file(format!("{name}.jpg")).map(|file| file.contents())
}

/// Returns the moving thumbnail of a shipped scene as an animated WebP; `None` for an unknown name.
pub(super) fn shipped_loop(name: &str) -> Option<&'static [u8]> {
    THUMBNAILS.get_file(format!("{name}.webp")).map(|file| file.contents())
}

// Moving thumbnails of the shipped scenes: short loops, drawn by `cargo xtask thumbnails`.
//
// Loops need no drawing, so they move on every machine in the same way, and looking through the list costs the show
// nothing. Scenes of the user have no loop.

/// Size of a loop in pixels.
pub const LOOP_SIZE: (u32, u32) = (192, 108);
/// Frames per second of a loop.
pub const LOOP_RATE: u32 = 8;
/// Number of frames of a loop.
pub const LOOP_FRAMES: u32 = 12;

/// Returns the frames of a scene's loop; empty if the scene has no loop.
pub(super) fn frames_of(source: &SceneSource) -> Vec<Arc<RgbaImage>> {
    match source {
        SceneSource::Shipped(name) => shipped_loop(name).map(decoded).unwrap_or_default(),
        SceneSource::Blend(blend) => frames_of(&blend.to.source),
        SceneSource::File(_) | SceneSource::Formula(_) => Vec::new(),
    }
}

fn decoded(bytes: &[u8]) -> Vec<Arc<RgbaImage>> {
    let Ok(decoder) = WebPDecoder::new(Cursor::new(bytes)) else { return Vec::new() };
    let frames = decoder.into_frames().take(LOOP_FRAMES as usize);
    frames.map_while(Result::ok).map(|frame| Arc::new(frame.into_buffer())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shipped_names;

    #[test]
    fn every_shipped_scene_has_a_thumbnail_and_there_are_no_others() {
        for extension in ["jpg", "webp"] {
            let files = THUMBNAILS.files().map(|file| file.path());
            let files = files.filter(|path| path.extension().is_some_and(|found| found == extension));
            let mut names: Vec<_> = files.map(|path| path.with_extension("").display().to_string()).collect();
            names.sort();
            assert_eq!(names, shipped_names(), "run cargo xtask thumbnails");
        }
        assert_eq!(THUMBNAILS.files().count(), 2 * shipped_names().len());
    }
}

#[cfg(test)]
mod moving_tests {
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
        assert!(bytes < 15_000 * shipped_names().len(), "{bytes} bytes");
    }

    #[test]
    fn other_scenes_and_damaged_loops_do_not_move() {
        assert!(frames_of(&SceneSource::File("own.scene".into())).is_empty());
        assert!(decoded(b"").is_empty() && decoded(b"RIFF\0\0\0\0WEBPrubbish").is_empty());
        let whole = shipped_loop("orb").unwrap();
        assert!(decoded(&whole[..whole.len() / 2]).len() < LOOP_FRAMES as usize);
    }
}
