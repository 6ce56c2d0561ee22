//! Parts of a video, which several machines render.
//!
//! A frame depends on its time alone, so that a part has the frames of the whole video. A part is written in pieces,
//! each complete on the disk before the next one begins: a run that follows an interrupted one continues with the
//! first missing piece. Each file has a record in its metadata, by which [`super::join`] and later runs know it.

use std::fs::{File, TryLockError};
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::drawing::VideoFrames;
use super::encoder::{Encoder, Frames};
use super::encoding::can_be_joined;
use super::request::{VideoPart, VideoRequest, Written, frames_in};
use super::sink::{FrameWriter, Sink};
use crate::atomic_file::Unwritable;
use crate::ending;
use crate::export::error::{ExportError, refuse};
use crate::export::fingerprint::{Fingerprint, song_hash};
use crate::export::output::{Output, is_folder, pieces_of};
use crate::export::showing::Showing;
use crate::frame::projection::Projection;
use crate::show::ShowSource;
use mariana_player::ffmpeg::{CommandLine, ReadBy, Source};

/// Frames of a piece. An interruption loses less than these.
const PIECE_FRAMES: u64 = 300;
/// Frames of a piece by paths of light, each of which may take minutes.
const PATH_PIECE_FRAMES: u64 = 30;
/// Begins the record in a file's metadata.
const MARK: &str = "mariana part ";

/// The description of a part in its file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct PartRecord {
    pub(super) part: VideoPart,
    /// The first frame in the file, the number of frames in the file, and the number of the video's frames.
    pub(super) first: u64,
    pub(super) frames: u64,
    pub(super) total: u64,
    pub(super) video: WholeRecord,
}

/// The description of the video to which a part belongs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct WholeRecord {
    pub(super) program: String,
    /// Hash of the song's bytes.
    pub(super) song: u64,
    /// Hash of the scenes' texts and files, and of the settings that change the frames.
    pub(super) look: u64,
    pub(super) start: f64,
    pub(super) duration: Option<f64>,
    pub(super) fps: f64,
    pub(super) size: (u32, u32),
    pub(super) sound: bool,
    pub(super) sound_rate: Option<u32>,
    pub(super) projection: Projection,
}

impl PartRecord {
    /// Reads the record of a video file; `None` if the file has none.
    pub(super) fn read(path: &Path) -> Option<Self> {
        let line = CommandLine::ffprobe().options(["-of", "json", "-show_entries", "format_tags"]);
        let line = line.input(Source::File(path), ReadBy::AnyVideoDemuxer, [""; 0]);
        let output = line.command().output().ok()?;
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).ok()?;
        // Matroska writes names of tags in capitals.
        let tags = report.get("format")?.get("tags")?.as_object()?;
        let (_, note) = tags.iter().find(|(name, _)| name.eq_ignore_ascii_case("comment"))?;
        serde_json::from_str(note.as_str()?.strip_prefix(MARK)?).ok()
    }

    pub(super) fn describe(&self) -> String {
        // A record of numbers and names can always be written.
        format!("{MARK}{}", serde_json::to_string(self).unwrap_or_default())
    }

    pub(super) fn seconds(&self) -> f64 {
        self.frames as f64 / self.video.fps
    }
}

impl WholeRecord {
    fn of(request: &VideoRequest) -> Result<Self, ExportError> {
        Ok(Self {
            program: env!("CARGO_PKG_VERSION").to_owned(),
            song: song_hash(&request.song)?,
            look: hash_of_frames(request)?,
            start: request.start,
            duration: request.duration,
            fps: request.fps,
            size: request.size,
            sound: request.sound,
            sound_rate: request.sound_rate,
            projection: request.scene.projection,
        })
    }

    /// What two videos differ in, in words; `None` if they are the same video.
    pub(super) fn difference(&self, other: &Self) -> Option<&'static str> {
        let differences = [
            (self.program != other.program, "another version of Mariana"),
            (self.song != other.song, "another song"),
            (self.size != other.size, "another size"),
            (self.fps != other.fps, "another frame rate"),
            ((self.start, self.duration) != (other.start, other.duration), "another start or length"),
            (self != other, "another scene or other settings"),
        ];
        differences.into_iter().find_map(|(is_other, words)| is_other.then_some(words))
    }
}

/// Hashes all that determines the frames, except the song and the fields of [`WholeRecord`]. Paths do not count, because
/// machines may have different ones.
fn hash_of_frames(request: &VideoRequest) -> Result<u64, ExportError> {
    let mut look = Fingerprint::default();
    let scene = &request.scene;
    look.add(&(
        request.gain,
        &request.set,
        &request.lyrics,
        request.scene.alpha,
        request.codec,
        request.quality,
    ));
    look.add(&(request.title_card, request.shutter, request.limit_flashes));
    look.add(&(scene.sdf, scene.cells, scene.view, scene.paths, scene.edges, scene.tone_map));
    let mut files = Vec::new();
    let scenes: Vec<_> = match &request.showing {
        Showing::Scenes(scenes) => scenes.iter().map(|(from, scene)| (Some(from.to_bits()), scene)).collect(),
        Showing::Show(source, scenes) => {
            match source {
                ShowSource::File(file) => files.push(file.clone()),
                other => look.add(other),
            }
            scenes.iter().map(|scene| (None, scene)).collect()
        }
    };
    for (from, scene) in scenes {
        let compiled = scene.compile()?;
        look.add(&(from, scene.text()?));
        files.extend(scene.files(Some(&compiled)));
    }
    for file in files {
        let bytes = std::fs::read(file).ok();
        look.add(&bytes.as_ref().map(Vec::len));
        look.add_bytes(&bytes.unwrap_or_default());
    }
    Ok(look.number())
}

/// Draws and writes a part, and calls `progress` with the frames of the part.
pub(super) fn write_part(
    request: &VideoRequest,
    part: VideoPart,
    progress: &mut dyn FnMut(u64, Option<u64>),
) -> Result<Written, ExportError> {
    let refused =
        |what: &str, instead: &str| refuse(format!("{what} cannot be rendered in parts: {instead}"));
    let path = match &request.output {
        Output::Path(path) if is_folder(path) || can_be_joined(path) => path,
        _ => {
            return refused(
                "this output",
                "give -o a folder, or a name that ends in .mp4, .mkv, .mov or .webm",
            );
        }
    };
    if request.limit_flashes {
        return refused("the flash limiter, which remembers earlier frames,", "add --flash-limiter off");
    }
    if request.seam.is_some() {
        return refused("a loop, whose end fades into its beginning,", "leave out --for loop");
    }
    let asked = request.duration.map(|seconds| frames_in(seconds, request.fps));
    let mut drawing = VideoFrames::open(request, asked, false)?;
    let Some(total) = drawing.expected else {
        return refused("a song of unknown length", "add --duration");
    };
    let (first, end) = part.range(total);
    let frames = end - first;
    if frames == 0 {
        let parts = part.of;
        return refuse(format!(
            "the video has only {total} frames, too few for {parts} parts: choose fewer parts with --part"
        ));
    }
    // The length in the song's header may be too short.
    let is_open = part.number == part.of && asked.is_none_or(|asked| asked > total);
    let range = first..if is_open { u64::MAX } else { end };
    let mut progress = |number: u64| progress(number - first, Some(frames));
    if is_folder(path) {
        let end = write_frames(&mut drawing, Sink::open(request, first)?, None, range, &mut progress)?;
        return Ok(Written { frames: end - first, file: None });
    }
    let record = PartRecord { part, first, frames, total, video: WholeRecord::of(request)? };
    let is_complete = PartRecord::read(path).as_ref() == Some(&record);
    let file = if is_complete {
        path.clone()
    } else {
        write_pieces(request, path, &record, &mut drawing, range, &mut progress)?
    };
    Ok(Written { frames, file: Some(file) })
}

/// Writes a part in pieces, and joins the pieces. `range` has its first frame and the first frame after it.
fn write_pieces(
    request: &VideoRequest,
    path: &Path,
    record: &PartRecord,
    drawing: &mut VideoFrames<'_>,
    range: Range<u64>,
    progress: &mut dyn FnMut(u64),
) -> Result<PathBuf, ExportError> {
    let silent = VideoRequest { sound: false, ..request.clone() };
    let piece_request = VideoRequest { keeps_others: false, ..silent.clone() };
    let folder = pieces_of(path);
    let (lock, undo) = ending::begin(|| {
        std::fs::create_dir_all(&folder).map_err(|error| Unwritable::new(&folder, &error))?;
        let (lock, empty) = (File::open(&folder), folder.clone());
        // A folder with pieces stays, because it is not empty.
        Ok::<_, ExportError>((lock, move || drop(std::fs::remove_dir(empty))))
    })?;
    // On systems that cannot open folders, two runs disturb each other.
    if lock.as_ref().is_ok_and(|folder| matches!(folder.try_lock(), Err(TryLockError::WouldBlock))) {
        return refuse(format!(
            "another run renders {} already: wait for it to end, or give -o another path",
            path.display()
        ));
    }
    let piece_frames = if request.scene.paths.is_some() { PATH_PIECE_FRAMES } else { PIECE_FRAMES };
    let mut pieces = Vec::new();
    let Range { start: mut number, end } = range;
    while number < end {
        let last = number.saturating_add(piece_frames).min(end);
        let piece = PartRecord { first: number, frames: last - number, ..record.clone() };
        let file = folder.join(format!("{number:08}")).with_extension(path.extension().unwrap_or_default());
        if PartRecord::read(&file).as_ref() != Some(&piece) {
            let Some(picture) = drawing.draw(number)? else { break };
            let encoder = Encoder::start(&piece_request, &file, Frames::Drawn, Some(&piece.describe()))?;
            let sink = Sink::encoder(encoder, request.scene.alpha);
            write_frames(drawing, sink, Some(picture), number..last, progress)?;
        }
        pieces.push((file, piece.seconds()));
        number = last;
    }
    let file = Encoder::start(&silent, path, Frames::Files(&pieces), Some(&record.describe()))?.finish()?;
    // Pieces that cannot be removed only take room.
    let _ = undo.settle(|| std::fs::remove_dir_all(&folder));
    Ok(file)
}

/// Draws and writes frames up to `end` or the song's end. `picture` is the first frame, if it is drawn already. Returns
/// the number after the last frame.
fn write_frames(
    drawing: &mut VideoFrames<'_>,
    sink: Sink,
    mut picture: Option<Vec<u8>>,
    range: Range<u64>,
    progress: &mut dyn FnMut(u64),
) -> Result<u64, ExportError> {
    let mut writer = FrameWriter::start(sink)?;
    let Range { start: mut number, end } = range;
    while number < end {
        let next = match picture.take() {
            Some(picture) => Some(picture),
            None => drawing.draw(number)?,
        };
        let Some(mut picture) = next else { break };
        drawing.letter(&mut picture, number);
        if !writer.write(picture) {
            break;
        }
        number += 1;
        progress(number);
    }
    writer.finish()?;
    Ok(number)
}
