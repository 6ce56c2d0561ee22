//! ffmpeg, fed with raw frames.

use std::ffi::OsStr;
use std::fs::File;
use std::io::{Cursor, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ExitStatus, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use image::{ImageFormat, ImageReader, Limits};

use super::VideoRequest;
use super::encoding::{arguments_of, is_mp4};
use crate::atomic_file::{AtomicFile, Unfinished, without_path};
use crate::ending::{self, Undo};
use crate::export::error::ExportError;
use mariana_player::decode::{Cover, CoverKind, Decoder};
use mariana_player::ffmpeg::{CommandLine, Demuxer, ReadBy, Source, file_address};
use mariana_player::song::Song;

/// How much of the end of ffmpeg's messages is read.
const COMPLAINT_BYTES: u64 = 4096;

/// Extensions for which ffmpeg writes a list and further files beside it, named after the list's temporary name.
const SEVERAL_FILES: &[&str] = &["m3u8", "mpd"];

/// Widest and highest cover, in pixels: one of 100 megapixels, which a megabyte can hold, takes many seconds to read.
const COVER_SIDE_MAX: u32 = 4096;

/// How often to check whether ffmpeg has ended.
const LOOK_PERIOD: Duration = Duration::from_millis(5);

/// ffmpeg at work.
pub(super) struct Encoder {
    child: Arc<Mutex<Child>>,
    /// None once ffmpeg has all frames.
    frames: Option<ChildStdin>,
    /// Taken when the output is put in its place.
    output: Option<AtomicFile>,
    path: PathBuf,
    /// ffmpeg's messages. A file, because a pipe that nobody reads would stop ffmpeg.
    complaints: File,
    /// What ffmpeg reads: a song that was no file, the song's cover.
    _inputs: Vec<Unfinished>,
    /// Ends ffmpeg with this process.
    _end: Undo,
}

impl Encoder {
    /// Starts ffmpeg for the video at `path`.
    pub(super) fn start(request: &VideoRequest, path: &Path) -> Result<Self, ExportError> {
        if SEVERAL_FILES.iter().any(|end| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(end))) {
            let message =
                "that format consists of several files, which cannot be put in place at once".to_owned();
            return Err(ExportError::Encoder { path: path.to_owned(), message });
        }
        let output = AtomicFile::create(path)?;
        let mut inputs = Vec::new();
        let (width, height) = request.size;
        let raw = ["-pix_fmt", "rgba", "-s", &format!("{width}x{height}"), "-r", &request.fps.to_string()]
            .map(str::to_owned);
        let mut line = CommandLine::ffmpeg().options(["-y"]);
        line = line.input(Source::StandardInput, ReadBy::Demuxer(Demuxer::RAW_VIDEO), raw);
        let decoder = request.sound.then(|| request.song.open()).transpose()?;
        let sound = decoder.as_ref().map(|decoder| decoder.info().demuxer);
        if let Some(demuxer) = sound {
            let song = song_file(&request.song, &mut inputs)?;
            let from = ["-ss".to_owned(), request.start.to_string()];
            line = line.input(Source::File(&song), ReadBy::Demuxer(demuxer), from);
        }
        let cover = decoder.as_ref().and_then(|decoder| cover_file(decoder, path, &mut inputs));
        if let Some((cover, kind)) = cover.as_ref().filter(|_| is_mp4(path)) {
            let demuxer = match kind {
                CoverKind::Jpeg => Demuxer::JPEG,
                CoverKind::Png => Demuxer::PNG,
            };
            line = line.input(Source::File(cover), ReadBy::Demuxer(demuxer), [""; 0]);
        }
        line = line.options(["-map", "0:v"]);
        if let Some(demuxer) = sound {
            line = line.options(["-map", "1:a:0", "-map_metadata", "1"]);
            if demuxer == Demuxer::OGG {
                // Ogg has its tags in the stream of the sound.
                line = line.options(["-map_metadata", "1:s:a:0"]);
            }
        }
        match &cover {
            Some(_) if is_mp4(path) => {
                line = line.options(["-map", "2:v", "-c:v:1", "copy", "-disposition:v:1", "attached_pic"]);
            }
            Some((cover, kind)) => {
                let (mime, name) = match kind {
                    CoverKind::Jpeg => ("mimetype=image/jpeg", "filename=cover.jpg"),
                    CoverKind::Png => ("mimetype=image/png", "filename=cover.png"),
                };
                line = line.options([OsStr::new("-attach"), &file_address(cover)]);
                line = line.options(["-metadata:s:t:0", mime, "-metadata:s:t:0", name]);
            }
            None => {}
        }
        match (&cover, request.duration) {
            // The picture of the cover would be the shortest stream.
            (Some(_), Some(seconds)) => line = line.options(["-t", &seconds.to_string()]),
            (Some(_), None) => {}
            (None, _) => line = line.options(["-shortest"]),
        }
        line = line.options(arguments_of(request, path)).options([file_address(output.temporary())]);
        let mut command = line.command();
        let complaints = tempfile::tempfile().map_err(no_room)?;
        let heard = complaints.try_clone().map_err(no_room)?;
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(heard);
        // Ctrl-C goes to this process, which ends ffmpeg: otherwise both would race to end first.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let (child, end) = ending::begin(|| {
            let child = Arc::new(Mutex::new(command.spawn()?));
            let its = child.clone();
            Ok((child, move || end_child(&mut lock(&its))))
        })
        .map_err(ExportError::NoEncoder)?;
        let frames = lock(&child).stdin.take();
        let path = path.to_owned();
        Ok(Self { child, frames, output: Some(output), path, complaints, _inputs: inputs, _end: end })
    }

    /// Takes a frame of RGBA bytes.
    pub(super) fn take(&mut self, rgba: &[u8]) -> Result<(), ExportError> {
        let written = self.frames.as_mut().map_or(Ok(()), |pipe| pipe.write_all(rgba));
        written.map_err(|_| self.last_words())
    }

    /// Waits for ffmpeg's end, and puts the video in its place.
    pub(super) fn finish(mut self) -> Result<(), ExportError> {
        match self.wait() {
            Ok(status) if status.success() => Ok(self.output.take().map_or(Ok(()), AtomicFile::commit)?),
            _ => Err(self.last_words()),
        }
    }

    /// Waits for ffmpeg's end without locking it, so that a signal can end it.
    fn wait(&mut self) -> std::io::Result<ExitStatus> {
        self.frames = None;
        loop {
            if let Some(status) = lock(&self.child).try_wait()? {
                return Ok(status);
            }
            std::thread::sleep(LOOK_PERIOD);
        }
    }

    /// What ffmpeg complained of.
    fn last_words(&mut self) -> ExportError {
        let _ = self.wait();
        let mut tail = Vec::new();
        // Whatever can be read is the best information there is.
        let length = self.complaints.seek(SeekFrom::End(0)).unwrap_or(0);
        let _ = self.complaints.seek(SeekFrom::Start(length.saturating_sub(COMPLAINT_BYTES)));
        let _ = self.complaints.read_to_end(&mut tail);
        let mut tail = String::from_utf8_lossy(&tail).into_owned();
        if let Some(output) = &self.output {
            // ffmpeg's message names the temporary file that it writes.
            let url = file_address(output.temporary());
            tail = tail.replace(&format!("{}: ", url.to_string_lossy()), "");
        }
        let message = tail.lines().last().unwrap_or("it ended without a message").to_owned();
        ExportError::Encoder { path: self.path.clone(), message }
    }
}

/// The song as a file.
fn song_file(song: &Song, inputs: &mut Vec<Unfinished>) -> Result<PathBuf, ExportError> {
    match song {
        Song::File(path) => Ok(path.clone()),
        Song::Embedded { name, bytes } => {
            let ending = Path::new(name).extension().map(|ending| ending.to_string_lossy());
            keep(bytes, &ending.map(|ending| format!(".{ending}")).unwrap_or_default(), inputs)
        }
    }
}

/// The song's cover as a file, if it has one and the video can: as mp4 and Matroska can.
fn cover_file(
    decoder: &Decoder,
    output: &Path,
    inputs: &mut Vec<Unfinished>,
) -> Option<(PathBuf, CoverKind)> {
    let can = is_mp4(output) || output.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mkv"));
    let Cover { kind, bytes } = decoder.cover().ok()?.filter(|_| can)?;
    let (ending, format) = match kind {
        CoverKind::Jpeg => (".jpg", ImageFormat::Jpeg),
        CoverKind::Png => (".png", ImageFormat::Png),
    };
    // Nor does ffmpeg go on with one that it cannot read.
    let mut reader = ImageReader::with_format(Cursor::new(&bytes), format);
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(COVER_SIDE_MAX), Some(COVER_SIDE_MAX));
    reader.limits(limits);
    reader.decode().ok()?;
    // A video without its cover is better than none.
    Some((keep(&bytes, ending, inputs).ok()?, kind))
}

/// Writes a file for ffmpeg to read.
fn keep(bytes: &[u8], ending: &str, inputs: &mut Vec<Unfinished>) -> Result<PathBuf, ExportError> {
    let mut file = Unfinished::create(&std::env::temp_dir(), OsStr::new(ending)).map_err(no_room)?;
    file.write_all(bytes).map_err(no_room)?;
    let path = file.path().to_owned();
    inputs.push(file);
    Ok(path)
}

fn no_room(error: std::io::Error) -> ExportError {
    ExportError::Temporary { folder: std::env::temp_dir(), reason: without_path(error).to_string() }
}

fn lock(child: &Mutex<Child>) -> MutexGuard<'_, Child> {
    child.lock().unwrap_or_else(PoisonError::into_inner)
}

fn end_child(child: &mut Child) {
    // An error means that it has ended already.
    let _ = child.kill();
    let _ = child.wait();
}

impl Drop for Encoder {
    fn drop(&mut self) {
        // After an error nobody wants what ffmpeg has written.
        end_child(&mut lock(&self.child));
    }
}
