//! Writes the frames of a video on a separate thread, so that the next frame is drawn meanwhile.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

use super::encoder::{Encoder, Frames};
use super::request::VideoRequest;
use crate::export::alpha::straight;
use crate::export::error::ExportError;
use crate::export::output::{Output, write_standard};
use crate::export::still::Pixels;
use crate::y4m::{self, Chroma};

pub(super) enum Sink {
    Stills { folder: PathBuf, size: (u32, u32), has_alpha: bool, written: u64 },
    Standard,
    Encoder { ffmpeg: Box<Encoder>, has_alpha: bool },
}

/// True if the output is a folder, or will be a folder because it ends in a slash.
pub(super) fn is_folder(path: &Path) -> bool {
    path.is_dir() || path.to_string_lossy().ends_with(['/', '\\'])
}

impl Sink {
    /// Opens the output of a request. `first` is the number of the first frame, by which stills are named.
    pub(super) fn open(request: &VideoRequest, first: u64) -> Result<Self, ExportError> {
        let path = match &request.output {
            Output::Standard => {
                write_standard(&y4m::header(request.size, request.fps, Chroma::Whole))?;
                return Ok(Self::Standard);
            }
            Output::Path(path) => path,
        };
        if is_folder(path) {
            std::fs::create_dir_all(path)
                .map_err(|error| ExportError::Unwritable { path: path.clone(), reason: error.to_string() })?;
            return Ok(Self::Stills {
                folder: path.clone(),
                size: request.size,
                has_alpha: request.alpha,
                written: first,
            });
        }
        Ok(Self::encoder(Encoder::start(request, path, Frames::Drawn, None)?, request.alpha))
    }

    pub(super) fn encoder(ffmpeg: Encoder, has_alpha: bool) -> Self {
        Self::Encoder { ffmpeg: Box::new(ffmpeg), has_alpha }
    }

    /// Writes a frame of RGBA bytes. Returns false if the reader has closed the output.
    fn write(&mut self, rgba: &[u8]) -> Result<bool, ExportError> {
        match self {
            Self::Stills { folder, size, has_alpha, written } => {
                let pixels = if *has_alpha { Pixels::transparent(rgba) } else { Pixels::opaque(rgba) };
                pixels.write_png(&folder.join(format!("frame-{written:05}.png")), *size)?;
                *written += 1;
                Ok(true)
            }
            Self::Standard => write_standard(&y4m::frame(rgba)),
            Self::Encoder { ffmpeg, has_alpha: true } => ffmpeg.encode(&straight(rgba)).map(|()| true),
            Self::Encoder { ffmpeg, .. } => ffmpeg.encode(rgba).map(|()| true),
        }
    }

    fn finish(self) -> Result<Option<PathBuf>, ExportError> {
        match self {
            Self::Stills { .. } | Self::Standard => Ok(None),
            Self::Encoder { ffmpeg, .. } => ffmpeg.finish().map(Some),
        }
    }
}

/// Maximum number of frames that wait to be written, besides the frame being drawn and the frame being written.
const WAITING_MAX: usize = 1;

/// A [`Sink`] on its own thread. A drop without [`FrameWriter::finish`] does not replace the output.
pub(super) struct FrameWriter {
    frames: SyncSender<Vec<u8>>,
    thread: JoinHandle<Result<Sink, ExportError>>,
}

impl FrameWriter {
    pub(super) fn start(sink: Sink) -> Result<Self, ExportError> {
        let (frames, incoming) = sync_channel(WAITING_MAX);
        let work = move || write_all(sink, &incoming);
        let thread =
            std::thread::Builder::new().name("frames".into()).spawn(work).map_err(ExportError::Thread)?;
        Ok(Self { frames, thread })
    }

    /// Passes a frame to the thread. Returns false if writing has ended; [`FrameWriter::finish`] returns the error.
    pub(super) fn write(&self, rgba: Vec<u8>) -> bool {
        self.frames.send(rgba).is_ok()
    }

    /// Waits until all frames are written, and moves the output to its path. Returns the path of a video.
    pub(super) fn finish(self) -> Result<Option<PathBuf>, ExportError> {
        drop(self.frames);
        let sink = self.thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        sink?.finish()
    }
}

fn write_all(mut sink: Sink, incoming: &Receiver<Vec<u8>>) -> Result<Sink, ExportError> {
    for rgba in incoming {
        if !sink.write(&rgba)? {
            break;
        }
    }
    Ok(sink)
}
