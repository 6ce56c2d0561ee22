//! A stretch of a song as a video (made with ffmpeg) or as numbered stills.

use std::ffi::OsString;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::error::ExportError;
use super::painter::{Painter, SceneChoice};
use super::song_features::SongFeatures;
use super::still::{refuse_the_song, write_png};
use crate::atomic_file::{AtomicFile, Unfinished, without_path};
use crate::ending::{self, Undo};
use mariana_music::Gain;
use mariana_player::song::Song;

/// Which video to make.
#[derive(Debug, Clone)]
pub struct VideoRequest {
    /// The song.
    pub song: Song,
    /// First moment, in seconds.
    pub start: f64,
    /// Length in seconds; none means to the song's end.
    pub duration: Option<f64>,
    /// Frames per second.
    pub fps: f64,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Whether quiet and loud sound move the picture alike.
    pub gain: Gain,
    /// Whether more than three flashes a second are dimmed.
    pub limit_flashes: bool,
    /// The video; or, if it ends in a slash or is a folder, where numbered stills go.
    pub output: PathBuf,
    /// The scene.
    pub scene: SceneChoice,
}

/// Makes the video or the stills and returns the number of frames. `progress` gets the number of frames done and, if
/// the length is known, the total.
///
/// # Errors
/// The song, the driver, ffmpeg or the output is refused. An incomplete video never takes the output's place.
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

/// Where the frames go.
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

/// How much of the end of ffmpeg's messages is read.
const COMPLAINT_BYTES: u64 = 4096;

/// Extensions for which ffmpeg writes a list and further files beside it, named after the list's temporary name.
const SEVERAL_FILES: &[&str] = &["m3u8", "mpd"];

/// What happens to the pictures: most players take 4:2:0 only, which needs even sides; and the colours become those of
/// [`COLORS`].
const PICTURES: &str = "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv";
/// The colours that a video's header tells. Players take BT.709 for large pictures and BT.601 for small ones unless they
/// are told, and ffmpeg makes BT.601 of RGB unless it is told.
const COLORS: [[&str; 2]; 4] = [
    ["-colorspace", "bt709"],
    ["-color_primaries", "bt709"],
    ["-color_trc", "bt709"],
    ["-color_range", "tv"],
];

/// How often to check whether ffmpeg has ended.
const LOOK_PERIOD: Duration = Duration::from_millis(5);

/// ffmpeg, fed with raw frames.
struct Encoder {
    child: Arc<Mutex<Child>>,
    /// None once ffmpeg has all frames.
    frames: Option<ChildStdin>,
    /// Taken when the output is put in its place.
    output: Option<AtomicFile>,
    path: PathBuf,
    /// ffmpeg's messages. A file, because a pipe that nobody reads would stop ffmpeg.
    complaints: File,
    /// Keeps the demo track's file for as long as ffmpeg reads it.
    _sound: Option<Unfinished>,
    /// Ends ffmpeg with this process.
    _end: Undo,
}

impl Encoder {
    fn start(request: &VideoRequest) -> Result<Self, ExportError> {
        let folder = std::env::temp_dir();
        let no_room = |error: std::io::Error| ExportError::Temporary {
            folder: folder.clone(),
            reason: without_path(error).to_string(),
        };
        if SEVERAL_FILES
            .iter()
            .any(|end| request.output.extension().is_some_and(|e| e.eq_ignore_ascii_case(end)))
        {
            let message =
                "that format consists of several files, which cannot be put in place at once".to_owned();
            return Err(ExportError::Encoder { path: request.output.clone(), message });
        }
        let output = AtomicFile::create(&request.output)?;
        let (sound_path, sound) = match &request.song {
            Song::File(path) => (path.clone(), None),
            Song::Embedded { bytes, .. } => {
                let mut file = Unfinished::create(&folder, ".ogg".as_ref()).map_err(no_room)?;
                file.write_all(bytes).map_err(no_room)?;
                (file.path().to_owned(), Some(file))
            }
        };
        let (width, height) = request.size;
        let mut command = Command::new("ffmpeg");
        command.args(["-v", "error", "-nostdin", "-y"]);
        command.args(["-f", "rawvideo", "-pix_fmt", "rgba", "-s", &format!("{width}x{height}")]);
        command.args(["-r", &request.fps.to_string(), "-i", "pipe:0"]);
        // Whatever the song says, no other file and no network address is opened.
        command.args(["-protocol_whitelist", "file", "-ss", &request.start.to_string()]);
        command.arg("-i").arg(file_url(&sound_path));
        command.args(["-map", "0:v", "-map", "1:a:0", "-shortest"]);
        command.args(["-vf", PICTURES, "-pix_fmt", "yuv420p", "-crf", "18"]);
        command.args(COLORS.as_flattened());
        command.arg(file_url(output.temporary()));
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
        let path = request.output.clone();
        Ok(Self { child, frames, output: Some(output), path, complaints, _sound: sound, _end: end })
    }

    fn take(&mut self, rgba: &[u8]) -> Result<(), ExportError> {
        let written = self.frames.as_mut().map_or(Ok(()), |pipe| pipe.write_all(rgba));
        written.map_err(|_| self.last_words())
    }

    fn finish(mut self) -> Result<(), ExportError> {
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
            let url = file_url(output.temporary());
            tail = tail.replace(&format!("{}: ", url.to_string_lossy()), "");
        }
        let message = tail.lines().last().unwrap_or("it ended without a message").to_owned();
        ExportError::Encoder { path: self.path.clone(), message }
    }
}

fn lock(child: &Mutex<Child>) -> MutexGuard<'_, Child> {
    child.lock().unwrap_or_else(PoisonError::into_inner)
}

fn end_child(child: &mut Child) {
    // An error means that it has ended already.
    let _ = child.kill();
    let _ = child.wait();
}

/// A path in a form in which ffmpeg gives no meaning to a colon or a hyphen.
fn file_url(path: &Path) -> OsString {
    let mut url = OsString::from("file:");
    url.push(path);
    url
}

impl Drop for Encoder {
    fn drop(&mut self) {
        // After an error nobody wants what ffmpeg has written.
        end_child(&mut lock(&self.child));
    }
}
