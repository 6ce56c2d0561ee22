//! `mariana video`: a part of a song as a video (encoded by ffmpeg), as numbered stills or as a stream of raw frames.

mod drawing;
mod encoder;
mod encoder_process;
mod encoding;
mod join;
mod lyric_captions;
mod part;
mod place;
mod report;
mod request;
mod seam;
mod sink;
mod spherical;
mod title_card;

use super::error::ExportError;
use super::output::{Output, refuse_the_song};

use drawing::VideoFrames;
#[cfg(test)]
pub(crate) use drawing::loop_too_long;
#[cfg(test)]
pub(crate) use encoder::{failed, no_encoder};
pub(crate) use encoder_process::last_messages;
pub use encoding::{Codec, EncodingQuality};
pub use join::join_parts;
pub use place::{Preset, VideoPlace};
pub use report::{CONTINUE, PAUSE, VideoReport};
use request::frames_in;
pub use request::{VideoPart, VideoRequest, Written};
use seam::Seam;
use sink::{FrameWriter, Sink};

/// Writes the video or stills. `progress` gets the number so far and the known total.
///
/// # Errors
/// Fails if the song cannot be decoded, the driver or ffmpeg fails, or the output cannot be written. An incomplete
/// video never replaces an existing file.
pub fn write_video(
    request: &VideoRequest,
    progress: &mut dyn FnMut(u64, Option<u64>),
) -> Result<Written, ExportError> {
    if request.scene.alpha {
        encoding::require_alpha(&request.output)?;
    }
    if let Output::Path(path) = &request.output {
        refuse_the_song(&request.song, path)?;
        encoding::require_fit(request.codec, request.fps, path)?;
    }
    if let Some(part) = request.part {
        return part::write_part(request, part, progress);
    }
    if let Output::Path(path) = &request.output {
        sink::refuse_frames(path)?;
    }
    let asked = request.duration.map(|seconds| frames_in(seconds, request.fps));
    let mut seam = match (request.seam, asked) {
        (Some(seconds), Some(frames)) => Some(Seam::new(frames, frames_in(seconds, request.fps))?),
        _ => None,
    };
    let asked = seam.as_ref().map(Seam::needed).or(asked);
    let mut drawing = VideoFrames::open(request, asked, seam.is_some())?;
    let mut writer = FrameWriter::start(Sink::open(request, 0)?)?;
    let (mut drawn, mut written) = (0, 0);
    while asked.is_none_or(|asked| drawn < asked) {
        let Some(picture) = drawing.draw(drawn)? else { break };
        drawn += 1;
        let next = match &mut seam {
            Some(seam) => seam.pass(picture)?,
            None => Some(picture),
        };
        if let Some(mut picture) = next {
            drawing.letter(&mut picture, written);
            if !writer.write(picture) {
                break;
            }
            written += 1;
        }
        progress(drawn, drawing.expected);
    }
    if seam.is_some() {
        drawing.require_all(asked, drawn)?;
    }
    Ok(Written { frames: written, file: writer.finish()? })
}
