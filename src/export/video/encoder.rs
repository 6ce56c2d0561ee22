//! Encodes a video with ffmpeg: builds its command line and feeds it frames. [`super::encoder_process`] runs ffmpeg.

use std::ffi::OsStr;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::time::Duration;

use image::{ImageFormat, ImageReader, Limits};

use super::encoder_process::EncoderProcess;
use super::encoding::{
    arguments_of, copying_arguments, default_codec, has_sound, is_matroska, is_mp4, is_quicktime,
};
use super::request::VideoRequest;
use super::spherical::{self, is_marked};
use crate::atomic_file::{AtomicFile, Unfinished, without_path};
use crate::covers::format_of;
use crate::export::error::ExportError;
use crate::frame::projection::Projection;
use crate::limits;
use mariana_player::decode::{Cover, CoverKind, Decoder};
use mariana_player::ffmpeg::{CommandLine, Demuxer, ReadBy, Source, file_address};
use mariana_player::song::Song;

/// Extensions of formats that consist of several files. ffmpeg would name these files after the temporary file.
const SEVERAL_FILES: &[&str] = &["m3u8", "mpd"];

/// Largest side of a cover, in pixels. A cover of 1 MB can have 100 megapixels, which take many seconds to decode.
const COVER_SIDE_MAX: u32 = 4096;

/// Words of ffmpeg about a file that is not complete.
const NOT_WRITTEN: &[&str] = &["No space left on device", "Error writing trailer", "Input/output error"];

/// The origin of a video's frames.
#[derive(Clone, Copy)]
pub(super) enum Frames<'a> {
    /// Drawn frames, for [`Encoder::encode`].
    Drawn,
    /// The frames of a video, which are copied.
    File(&'a Path),
    /// The frames of several videos, which are copied one after the other. Each has its length in seconds.
    Files(&'a [(PathBuf, f64)]),
}

pub(super) struct Encoder {
    process: EncoderProcess,
    output: AtomicFile,
    path: PathBuf,
    keeps_others: bool,
    /// The projection that the file's metadata must name.
    marked: Option<Projection>,
    /// The video that is made of the output; `None` if the output is the video.
    next: Option<Box<(VideoRequest, PathBuf)>>,
    _inputs: Vec<Unfinished>,
}

impl Encoder {
    /// Starts ffmpeg. `note` is a comment in the file's metadata.
    pub(super) fn start(
        request: &VideoRequest,
        path: &Path,
        frames: Frames<'_>,
        note: Option<&str>,
    ) -> Result<Self, ExportError> {
        if SEVERAL_FILES.iter().any(|end| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(end))) {
            let message = "the format consists of several files, which cannot be replaced in one step";
            return Err(failed(path, message));
        }
        let is_copy = matches!(frames, Frames::File(_));
        let mut output = AtomicFile::create(path)?;
        let projection = request.scene.projection;
        let needs_mark = is_marked(&projection) && note.is_none() && !is_copy;
        // ffmpeg copies the metadata of a projection from MP4 to Matroska, but has no option for them. MP4 has no codec
        // for transparent videos, which are parts of other videos.
        let goes_on = needs_mark && is_matroska(path) && !request.scene.alpha;
        let next = goes_on.then(|| Box::new((request.clone(), path.to_owned())));
        let silent;
        let (mut made, mut request) = (path.to_owned(), request);
        if next.is_some() {
            made.set_extension("mp4");
            output = AtomicFile::create(&made)?;
            let codec = request.codec.or(Some(default_codec(path)));
            silent = VideoRequest { sound: false, codec, ..request.clone() };
            request = &silent;
        }
        let mut inputs = Vec::new();
        let mut line = command_line(request, &made, frames, &mut inputs)?;
        if let Some(note) = note {
            line = line.options(["-metadata".to_owned(), format!("comment={note}")]);
        }
        let line = line.options([file_address(output.temporary())]);
        let reported_problems = tempfile::tempfile().map_err(no_room)?;
        let patience = Duration::from_secs_f64(limits::ENCODER_WAIT_SECONDS);
        let process = EncoderProcess::start(line.command(), output.temporary(), reported_problems, patience)
            .map_err(no_encoder)?;
        let keeps_others = request.keeps_others;
        let marked = (needs_mark && is_quicktime(&made)).then_some(projection);
        let path = path.to_owned();
        Ok(Self { process, output, path, keeps_others, marked, next, _inputs: inputs })
    }

    pub(super) fn encode(&mut self, rgba: &[u8]) -> Result<(), ExportError> {
        self.process.write(rgba).map_err(|_| self.last_words())
    }

    /// Waits for ffmpeg and puts the video at its path. Returns the path.
    pub(super) fn finish(mut self) -> Result<PathBuf, ExportError> {
        let has_ended = self.process.wait().is_ok_and(|status| status.success());
        // On a full disk, ffmpeg reports that it could not write the end of the file, and succeeds.
        if !has_ended || NOT_WRITTEN.iter().any(|words| self.process.complaint().contains(words)) {
            return Err(self.last_words());
        }
        if let Some(projection) = &self.marked {
            spherical::mark(self.output.temporary(), projection).map_err(|error| {
                let error = without_path(error);
                failed(&self.path, &format!("the projection cannot be noted in the file: {error}"))
            })?;
        }
        if let Some((request, path)) = self.next.as_deref() {
            return Self::start(request, path, Frames::File(self.output.temporary()), None)?.finish();
        }
        if self.keeps_others {
            return Ok(self.output.commit_beside()?);
        }
        self.output.commit()?;
        Ok(self.path)
    }

    fn last_words(&mut self) -> ExportError {
        let _ = self.process.wait();
        if self.process.has_stalled() {
            return ExportError::Refused(format!(
                "ffmpeg made no progress for {:.0} s while writing {} and was stopped: check the disk, or choose \
                 another codec by --codec",
                limits::ENCODER_WAIT_SECONDS,
                self.path.display()
            ));
        }
        // Remove the name of the temporary output from the message.
        let url = file_address(self.output.temporary());
        let tail = self.process.complaint().replace(&format!("{}: ", url.to_string_lossy()), "");
        let said = tail.lines().map(str::trim).rfind(|line| !line.is_empty());
        failed(&self.path, said.unwrap_or("it ended without a message"))
    }
}

/// Returns ffmpeg's command line for the video at `path`, without the output. Adds temporary input files to `inputs`.
fn command_line(
    request: &VideoRequest,
    path: &Path,
    frames: Frames<'_>,
    inputs: &mut Vec<Unfinished>,
) -> Result<CommandLine, ExportError> {
    let (width, height) = request.size;
    let mut line = CommandLine::ffmpeg().options(["-y"]);
    line = match frames {
        Frames::Drawn => {
            let raw =
                ["-pix_fmt", "rgba", "-s", &format!("{width}x{height}"), "-r", &request.fps.to_string()];
            line.input(Source::StandardInput, ReadBy::Demuxer(Demuxer::RAW_VIDEO), raw.map(str::to_owned))
        }
        Frames::File(file) => line.input(Source::File(file), ReadBy::AnyVideoDemuxer, [""; 0]),
        Frames::Files(files) => {
            let list = keep(&list_of(files), ".txt", inputs)?;
            line.input(Source::File(&list), ReadBy::List, ["-safe", "0"])
        }
    };
    let encoding = match frames {
        Frames::Drawn => arguments_of(request, path),
        Frames::File(_) | Frames::Files(_) => copying_arguments(request, path),
    };
    let decoder = has_sound(request, path).then(|| request.song.open()).transpose()?;
    let Some(decoder) = decoder else {
        return Ok(line.options(["-map", "0:v"]).options(encoding));
    };
    let demuxer = decoder.info().demuxer;
    let song = song_file(&request.song, inputs)?;
    let from = ["-ss".to_owned(), request.start.to_string()];
    line = line.input(Source::File(&song), ReadBy::Demuxer(demuxer), from);
    let cover = cover_file(&decoder, path, inputs);
    if let Some((cover, kind)) = cover.as_ref().filter(|_| is_mp4(path)) {
        let demuxer = if *kind == CoverKind::Jpeg { Demuxer::JPEG } else { Demuxer::PNG };
        line = line.input(Source::File(cover), ReadBy::Demuxer(demuxer), [""; 0]);
    }
    line = line.options(["-map", "0:v", "-map", "1:a:0", "-map_metadata", "1"]);
    if demuxer == Demuxer::OGG {
        // Ogg stores its tags in the audio stream.
        line = line.options(["-map_metadata", "1:s:a:0"]);
    }
    match &cover {
        Some(_) if is_mp4(path) => {
            line = line.options(["-map", "2:v", "-c:v:1", "copy", "-disposition:v:1", "attached_pic"]);
        }
        Some((cover, kind)) => {
            let (mime, name) = match kind {
                CoverKind::Jpeg => ("mimetype=image/jpeg", "filename=cover.jpg"),
                _ => ("mimetype=image/png", "filename=cover.png"),
            };
            line = line.options([OsStr::new("-attach"), &file_address(cover)]);
            line = line.options(["-metadata:s:t:0", mime, "-metadata:s:t:0", name]);
        }
        None => {}
    }
    match (&cover, request.duration) {
        // With `-shortest`, the cover's single frame would end the video.
        (Some(_), Some(seconds)) => line = line.options(["-t", &seconds.to_string()]),
        (Some(_), None) => {}
        (None, _) => line = line.options(["-shortest"]),
    }
    Ok(line.options(encoding))
}

/// Returns the list by which ffmpeg joins videos: the beginning of each is the end of the previous one.
fn list_of(files: &[(PathBuf, f64)]) -> Vec<u8> {
    let mut list = Vec::new();
    for (file, seconds) in files {
        let file = std::path::absolute(file).unwrap_or_else(|_| file.clone());
        list.extend(b"file '");
        for byte in file_address(&file).as_encoded_bytes() {
            match byte {
                b'\'' => list.extend(b"'\\''"),
                byte => list.push(*byte),
            }
        }
        list.extend(format!("'\nduration {seconds:.6}\n").bytes());
    }
    list
}

/// Returns the path of the song. Writes an embedded song to a temporary file.
fn song_file(song: &Song, inputs: &mut Vec<Unfinished>) -> Result<PathBuf, ExportError> {
    match song {
        Song::File(path) => Ok(path.clone()),
        Song::Embedded { name, bytes } => {
            let ending = Path::new(name).extension().map(|ending| ending.to_string_lossy());
            keep(bytes, &ending.map(|ending| format!(".{ending}")).unwrap_or_default(), inputs)
        }
    }
}

/// Writes the cover to a temporary file, if the song has a cover and the format supports covers (mp4, Matroska). Covers
/// other than JPEG become PNG.
fn cover_file(
    decoder: &Decoder,
    output: &Path,
    inputs: &mut Vec<Unfinished>,
) -> Option<(PathBuf, CoverKind)> {
    let can = is_mp4(output) || output.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mkv"));
    let Cover { kind, mut bytes } = decoder.cover().ok()?.filter(|_| can)?;
    let format = format_of(kind);
    let ending = if kind == CoverKind::Jpeg { ".jpg" } else { ".png" };
    // Decode the cover here first, because ffmpeg fails on a cover that it cannot decode.
    let mut reader = ImageReader::with_format(Cursor::new(&bytes), format);
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(COVER_SIDE_MAX), Some(COVER_SIDE_MAX));
    reader.limits(limits);
    let image = reader.decode().ok()?;
    if ending == ".png" && format != ImageFormat::Png {
        let mut png = Cursor::new(Vec::new());
        image.write_to(&mut png, ImageFormat::Png).ok()?;
        bytes = png.into_inner();
    }
    // A missing cover is no error.
    Some((keep(&bytes, ending, inputs).ok()?, kind))
}

fn keep(bytes: &[u8], ending: &str, inputs: &mut Vec<Unfinished>) -> Result<PathBuf, ExportError> {
    let mut file = Unfinished::create(&std::env::temp_dir(), OsStr::new(ending)).map_err(no_room)?;
    file.write_all(bytes).map_err(no_room)?;
    let path = file.path().to_owned();
    inputs.push(file);
    Ok(path)
}

/// The error of a temporary file: an input for ffmpeg, ffmpeg's messages or the frames of a loop's seam.
pub(super) fn no_room(error: std::io::Error) -> ExportError {
    let (folder, error) = (std::env::temp_dir(), without_path(error));
    ExportError::Refused(format!(
        "temporary files cannot be written in {} ({error}): set TMPDIR to a folder with enough space",
        folder.display()
    ))
}

/// The error of ffmpeg, with its last message.
pub(crate) fn failed(path: &Path, message: &str) -> ExportError {
    ExportError::Refused(format!(
        "ffmpeg could not write {} ({message}): give -o a path with enough space and a name that ends in .mp4, .mkv \
         or .mov",
        path.display()
    ))
}

pub(crate) fn no_encoder(error: std::io::Error) -> ExportError {
    ExportError::Refused(format!(
        "a video needs ffmpeg, which was not found ({error}): install ffmpeg, or give -o a folder ending in '/' for \
         stills"
    ))
}
