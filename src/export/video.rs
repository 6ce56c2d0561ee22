//! A stretch of a song as a video (by ffmpeg) or as numbered stills.

use std::ffi::OsString;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use super::atomic_file::{AtomicFile, Pending};
use super::error::ExportError;
use super::painter::{Painter, SceneChoice};
use super::song_features::SongFeatures;
use super::still::{refuse_the_song, write_png};
use crate::audio::song::Song;
use crate::dsp::Gain;

/// Which video to make.
#[derive(Debug, Clone)]
pub struct VideoRequest {
    /// The song.
    pub song: Song,
    /// First moment, in seconds.
    pub start: f64,
    /// Length in seconds; none is to the song's end.
    pub duration: Option<f64>,
    /// Frames per second.
    pub fps: f64,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Whether quiet and loud sound move the picture alike.
    pub gain: Gain,
    /// Whether more than three flashes a second are dimmed.
    pub limit_flashes: bool,
    /// The video; or, ending in a slash or being a folder, where numbered stills go.
    pub output: PathBuf,
    /// The scene.
    pub scene: SceneChoice,
}

/// Makes the video or the stills and returns how many frames it has. `progress` hears the frames done and, where
/// the length is known, their number.
///
/// # Errors
/// The song, the driver, ffmpeg or the output refuse. No half video takes the output's place.
pub fn write_video(
    request: &VideoRequest,
    progress: &mut dyn FnMut(u64, Option<u64>),
) -> Result<u64, ExportError> {
    refuse_the_song(&request.song, &request.output)?;
    let mut song = SongFeatures::open_with(&request.song, request.start, request.gain)?;
    song.require(request.start)?;
    let length = match (request.duration, song.duration()) {
        (Some(asked), Some(song)) => Some(asked.min(song - request.start)),
        (asked, song) => asked.or(song.map(|song| song - request.start)),
    };
    let expected = length.map(|seconds| (seconds * request.fps).ceil() as u64);
    let mut painter = Painter::open(&request.scene)?;
    if request.limit_flashes {
        painter.add_flash_limiter(&request.scene.shaders)?;
    }
    let mut sink = Sink::open(request)?;
    let mut frames = 0;
    loop {
        let offset = frames as f64 / request.fps;
        if request.duration.is_some_and(|duration| offset >= duration) {
            break;
        }
        let time = request.start + offset;
        let Some(sound) = song.sound_at(time)? else { break };
        painter.draw(time, sound, request.size)?;
        painter.limit_flashes(1.0 / request.fps)?;
        sink.take(frames, &painter.read())?;
        frames += 1;
        progress(frames, expected);
    }
    sink.finish()?;
    Ok(frames)
}

/// Where frames go.
enum Sink<'a> {
    Stills { folder: &'a Path, size: (u32, u32) },
    Encoder(Box<Encoder>),
}

impl<'a> Sink<'a> {
    fn open(request: &'a VideoRequest) -> Result<Self, ExportError> {
        let output = &request.output;
        let wants_stills = output.is_dir() || output.to_string_lossy().ends_with(['/', '\\']);
        if wants_stills {
            std::fs::create_dir_all(output).map_err(|error| ExportError::Unwritable {
                path: output.clone(),
                reason: error.to_string(),
            })?;
            return Ok(Sink::Stills { folder: output, size: request.size });
        }
        Ok(Sink::Encoder(Box::new(Encoder::start(request)?)))
    }

    fn take(&mut self, index: u64, rgba: &[u8]) -> Result<(), ExportError> {
        match self {
            Sink::Stills { folder, size } => {
                write_png(&folder.join(format!("frame-{index:05}.png")), rgba, *size)
            }
            Sink::Encoder(encoder) => encoder.take(rgba),
        }
    }

    fn finish(self) -> Result<(), ExportError> {
        match self {
            Sink::Stills { .. } => Ok(()),
            Sink::Encoder(encoder) => encoder.finish(),
        }
    }
}

/// How much of the end of ffmpeg's complaints is looked at.
const COMPLAINT_BYTES: u64 = 4096;

/// ffmpeg, fed with raw frames.
struct Encoder {
    child: Child,
    /// Taken when it is put in its place.
    pending: Option<Pending>,
    path: PathBuf,
    /// What it complains of. A file, since a pipe that nobody reads would stop it.
    complaints: File,
    /// Keeps the demo track's file alive while ffmpeg reads it.
    _sound: Option<tempfile::NamedTempFile>,
}

impl Encoder {
    fn start(request: &VideoRequest) -> Result<Self, ExportError> {
        let unwritable = |error: std::io::Error| ExportError::Unwritable {
            path: request.output.clone(),
            reason: error.to_string(),
        };
        let pending = AtomicFile::create(&request.output)?.close();
        let (sound_path, sound) = match (&request.song, request.song.embedded_bytes()) {
            (Song::File(path), _) => (path.clone(), None),
            (Song::Demo, bytes) => {
                let mut file = tempfile::Builder::new().suffix(".ogg").tempfile().map_err(unwritable)?;
                file.write_all(bytes.unwrap_or_default()).map_err(unwritable)?;
                (file.path().to_owned(), Some(file))
            }
        };
        let (width, height) = request.size;
        let mut command = Command::new("ffmpeg");
        command.args(["-v", "error", "-nostdin", "-y"]);
        command.args(["-f", "rawvideo", "-pix_fmt", "rgba", "-s", &format!("{width}x{height}")]);
        command.args(["-r", &request.fps.to_string(), "-i", "pipe:0"]);
        command.args(["-ss", &request.start.to_string(), "-i"]).arg(file_url(&sound_path));
        command.args(["-map", "0:v", "-map", "1:a:0", "-shortest"]);
        // Most players take 4:2:0 only, which needs even sides.
        command.args(["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p", "-crf", "18"]);
        command.arg(file_url(pending.temporary()));
        let complaints = tempfile::tempfile().map_err(unwritable)?;
        let heard = complaints.try_clone().map_err(unwritable)?;
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(heard);
        let child = command.spawn().map_err(ExportError::NoEncoder)?;
        Ok(Self { child, pending: Some(pending), path: request.output.clone(), complaints, _sound: sound })
    }

    fn take(&mut self, rgba: &[u8]) -> Result<(), ExportError> {
        let written = self.child.stdin.as_mut().map_or(Ok(()), |pipe| pipe.write_all(rgba));
        written.map_err(|_| self.last_words())
    }

    fn finish(mut self) -> Result<(), ExportError> {
        drop(self.child.stdin.take());
        match self.child.wait() {
            Ok(status) if status.success() => self.pending.take().map_or(Ok(()), Pending::commit),
            _ => Err(self.last_words()),
        }
    }

    /// What ffmpeg complained of.
    fn last_words(&mut self) -> ExportError {
        drop(self.child.stdin.take());
        let _ = self.child.wait();
        let mut tail = Vec::new();
        // Whatever can be read is the best that is known.
        let length = self.complaints.seek(SeekFrom::End(0)).unwrap_or(0);
        let _ = self.complaints.seek(SeekFrom::Start(length.saturating_sub(COMPLAINT_BYTES)));
        let _ = self.complaints.read_to_end(&mut tail);
        let tail = String::from_utf8_lossy(&tail);
        let message = tail.lines().last().unwrap_or("it ended without a word");
        // It complains of the file that it writes for now.
        let temporary = self.pending.as_ref().map(|pending| file_url(pending.temporary()));
        let message = match temporary.as_ref().and_then(|url| url.to_str()) {
            Some(url) => message.replace(&format!("{url}: "), ""),
            None => message.to_owned(),
        };
        ExportError::Encoder { path: self.path.clone(), message }
    }
}

/// A path as ffmpeg wants it if a colon or a hyphen in it shall mean nothing.
fn file_url(path: &Path) -> OsString {
    let mut url = OsString::from("file:");
    url.push(path);
    url
}

impl Drop for Encoder {
    fn drop(&mut self) {
        // After an error in between: an encoder without input ends by itself, and is reaped.
        drop(self.child.stdin.take());
        let _ = self.child.wait();
    }
}
