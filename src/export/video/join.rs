//! Joins the parts of a video: copies their frames without encoding again, and adds the song's sound once.

use std::path::PathBuf;

use super::encoder::{Encoder, Frames};
use super::encoding;
use super::part::PartRecord;
use super::request::{VideoRequest, Written};
use crate::export::error::ExportError;
use crate::export::fingerprint::song_hash;
use crate::export::output::Output;
use crate::export::still::{refuse_the_song, same_file};

/// Joins parts in any order. `request` has the song and the output; the parts' records decide about everything else.
///
/// # Errors
/// Fails if a file is no part, if parts are missing or belong to different videos, or if ffmpeg fails.
pub fn join_parts(request: &VideoRequest, files: &[PathBuf]) -> Result<Written, ExportError> {
    let path = match &request.output {
        Output::Path(path) if encoding::can_be_joined(path) => path,
        output => return Err(ExportError::JoinFormat { output: output.to_string() }),
    };
    refuse_the_song(&request.song, path)?;
    let mut parts = Vec::new();
    for file in files {
        if same_file(file, path) {
            return Err(ExportError::OverThePart { path: path.clone() });
        }
        let metadata = std::fs::metadata(file);
        if let Some(reason) = metadata.err().map(|error| error.to_string()) {
            return Err(ExportError::UnreadablePart { path: file.clone(), reason });
        }
        let record = PartRecord::read(file).ok_or_else(|| ExportError::NoPart { path: file.clone() })?;
        parts.push((file, record));
    }
    parts.sort_by_key(|(_, record)| record.first);
    let Some((first_file, first)) = parts.first() else { return Err(ExportError::NoParts) };
    let of = first.part.of;
    for (file, record) in &parts {
        let difference = first.video.difference(&record.video);
        let difference = difference.or((record.part.of != of).then_some("another number of parts"));
        if let Some(difference) = difference {
            let (path, other) = ((*file).clone(), (*first_file).clone());
            return Err(ExportError::OtherPart { path, other, difference });
        }
    }
    let has = |number: u64| parts.iter().filter(|(_, record)| record.part.number == number).count();
    if let Some(number) = (1..=of).find(|number| has(*number) != 1) {
        return Err(match has(number) {
            0 => ExportError::MissingPart { number, of },
            _ => ExportError::TwicePart { number },
        });
    }
    let video = &first.video;
    if video.sound && song_hash(&request.song)? != video.song {
        return Err(ExportError::OtherSong);
    }
    let mut whole = VideoRequest {
        start: video.start,
        duration: video.duration,
        fps: video.fps,
        size: video.size,
        sound: video.sound,
        sound_rate: video.sound_rate,
        ..request.clone()
    };
    whole.scene.projection = video.projection;
    let pieces: Vec<_> = parts.iter().map(|(file, record)| ((*file).clone(), record.seconds())).collect();
    let frames = first.total;
    let file = Encoder::start(&whole, path, Frames::Files(&pieces), None)?.finish()?;
    Ok(Written { frames, file: Some(file) })
}
