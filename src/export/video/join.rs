//! Joins the parts of a video: copies their frames without encoding again, and adds the song's sound once.

use std::path::PathBuf;

use super::encoder::{Encoder, Frames};
use super::encoding;
use super::part::PartRecord;
use super::request::{VideoRequest, Written};
use crate::export::error::{ExportError, refuse};
use crate::export::fingerprint::song_hash;
use crate::export::output::{Output, refuse_the_song, same_file};

/// Joins parts in any order. `request` has the song and the output; the parts' records decide about everything else.
///
/// # Errors
/// Fails if a file is no part, if parts are missing or belong to different videos, or if ffmpeg fails.
pub fn join_parts(request: &VideoRequest, files: &[PathBuf]) -> Result<Written, ExportError> {
    let path = match &request.output {
        Output::Path(path) if encoding::can_be_joined(path) => path,
        output => {
            return refuse(format!(
                "parts cannot be joined into {output}: give -o a name that ends in .mp4, .mkv, .mov or .webm"
            ));
        }
    };
    refuse_the_song(&request.song, path)?;
    let mut parts = Vec::new();
    for file in files {
        let name = file.display();
        if same_file(file, path) {
            return refuse(format!("{} is one of the parts: choose another path with -o", path.display()));
        }
        if let Err(error) = std::fs::metadata(file) {
            return refuse(format!("{name} cannot be read ({error}): check the name of the part"));
        }
        let Some(record) = PartRecord::read(file) else {
            return refuse(format!(
                "{name} is no finished part of a video: name files that 'mariana video --part' has written, and let \
                 unfinished parts finish"
            ));
        };
        parts.push((file, record));
    }
    parts.sort_by_key(|(_, record)| record.first);
    let Some((first_file, first)) = parts.first() else {
        return refuse("there are no parts to join: name their files after --join");
    };
    let of = first.part.of;
    for (file, record) in &parts {
        let difference = first.video.difference(&record.video);
        let difference = difference.or((record.part.of != of).then_some("another number of parts"));
        if let Some(difference) = difference {
            return refuse(format!(
                "{} has {difference} than {}: render it again with the flags of the other parts",
                file.display(),
                first_file.display()
            ));
        }
    }
    let has = |number: u64| parts.iter().filter(|(_, record)| record.part.number == number).count();
    if let Some(number) = (1..=of).find(|number| has(*number) != 1) {
        return refuse(match has(number) {
            0 => format!(
                "part {number} of {of} is missing: render it with --part {number}/{of}, or name its file"
            ),
            _ => format!("two files are part {number}: name each part once"),
        });
    }
    let video = &first.video;
    if video.sound && song_hash(&request.song)? != video.song {
        return refuse("the parts were made for another song: name the song from which they were rendered");
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
