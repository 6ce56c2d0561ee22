//! Writes the frames of a video on separate threads, so that the next frames are drawn meanwhile.

use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use super::encoder::{Encoder, Frames};
use super::request::VideoRequest;
use crate::atomic_file::Unwritable;
use crate::export::alpha::straight;
use crate::export::error::{ExportError, refuse};
use crate::export::output::{Output, is_folder, write_standard};
use crate::export::still::Pixels;
use crate::y4m::{self, Chroma};

pub(super) enum Sink {
    /// `first` is the number of the first frame, by which stills are named.
    Stills {
        folder: PathBuf,
        size: (u32, u32),
        has_alpha: bool,
        first: u64,
    },
    Standard,
    Encoder {
        ffmpeg: Box<Encoder>,
        has_alpha: bool,
    },
}

/// Refuses a folder that has frames already: those that this video does not replace would stay among its own.
pub(super) fn refuse_frames(folder: &Path) -> Result<(), ExportError> {
    let names = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names = names.filter_map(|entry| entry.file_name().into_string().ok());
    match names.filter(|name| name.starts_with("frame-") && name.ends_with(".png")).min() {
        Some(frame) => refuse(format!(
            "{} has frames already, such as {frame}: choose another folder with -o, or remove them first",
            folder.display()
        )),
        None => Ok(()),
    }
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
            std::fs::create_dir_all(path).map_err(|error| Unwritable::new(path, &error))?;
            return Ok(Self::Stills {
                folder: path.clone(),
                size: request.size,
                has_alpha: request.scene.alpha,
                first,
            });
        }
        Ok(Self::encoder(Encoder::start(request, path, Frames::Drawn, None)?, request.scene.alpha))
    }

    pub(super) fn encoder(ffmpeg: Encoder, has_alpha: bool) -> Self {
        Self::Encoder { ffmpeg: Box::new(ffmpeg), has_alpha }
    }

    /// Writes the frame with this number, counted from 0, of RGBA bytes. Returns false if the reader has closed the output.
    fn write(&mut self, number: u64, rgba: &[u8]) -> Result<bool, ExportError> {
        match self {
            Self::Stills { folder, size, has_alpha, first } => {
                let number = *first + number;
                Pixels::of(rgba, *has_alpha)
                    .write_png(&folder.join(format!("frame-{number:05}.png")), *size)?;
                Ok(true)
            }
            Self::Standard => write_standard(&y4m::frame(rgba)),
            Self::Encoder { ffmpeg, has_alpha: true } => ffmpeg.encode(&straight(rgba)).map(|()| true),
            Self::Encoder { ffmpeg, .. } => ffmpeg.encode(rgba).map(|()| true),
        }
    }

    /// The sinks of the threads that share the work.
    fn shared(self) -> Vec<Self> {
        let Self::Stills { folder, size, has_alpha, first } = self else { return vec![self] };
        let frames = STILLS_BYTES_MAX / (4 * size.0 as usize * size.1 as usize).max(1);
        let processors = std::thread::available_parallelism().map_or(1, NonZero::get);
        let still = |_| Self::Stills { folder: folder.clone(), size, has_alpha, first };
        (0..processors.min(frames).max(1)).map(still).collect()
    }

    fn finish(self) -> Result<Option<PathBuf>, ExportError> {
        match self {
            Self::Stills { .. } | Self::Standard => Ok(None),
            Self::Encoder { ffmpeg, .. } => ffmpeg.finish().map(Some),
        }
    }
}

/// Maximum number of frames that wait to be written, besides the frame being drawn and the frames being written.
const WAITING_MAX: usize = 1;

/// Maximum size in bytes of the frames being written as stills, each by a thread of its own.
const STILLS_BYTES_MAX: usize = 256 << 20;

type Frame = (u64, Vec<u8>);

/// A [`Sink`] on its own threads: one for each processor for stills, which are encoded here, else one. A drop without
/// [`FrameWriter::finish`] does not replace the output.
pub(super) struct FrameWriter {
    frames: SyncSender<Frame>,
    sent: u64,
    threads: Vec<JoinHandle<Result<Sink, FailedFrame>>>,
}

/// The number of a frame that could not be written, and the error.
type FailedFrame = (u64, ExportError);

impl FrameWriter {
    pub(super) fn start(sink: Sink) -> Result<Self, ExportError> {
        let (frames, incoming) = sync_channel(WAITING_MAX);
        let incoming = Arc::new(Mutex::new(Some(incoming)));
        let sinks = sink.shared();
        let threads = sinks.into_iter().map(|sink| {
            let incoming = incoming.clone();
            let work = move || write_all(sink, &incoming);
            std::thread::Builder::new().name("frames".into()).spawn(work).map_err(|error| {
                ExportError::Refused(format!("no thread can be started ({error}): close other programs"))
            })
        });
        let threads = threads.collect::<Result<_, _>>()?;
        Ok(Self { frames, sent: 0, threads })
    }

    /// Passes a frame to a thread. Returns false if writing has ended; [`FrameWriter::finish`] returns the error.
    pub(super) fn write(&mut self, rgba: Vec<u8>) -> bool {
        self.sent += 1;
        self.frames.send((self.sent - 1, rgba)).is_ok()
    }

    /// Waits until all frames are written, and moves the output to its path. Returns the path of a video, or the
    /// error of the first frame of the video that could not be written.
    pub(super) fn finish(self) -> Result<Option<PathBuf>, ExportError> {
        drop(self.frames);
        let join =
            |thread: JoinHandle<_>| thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        // Wait for all threads before an error is returned, so that none leaves a file half written.
        let mut ended: Vec<Result<Sink, FailedFrame>> = self.threads.into_iter().map(join).collect();
        ended.sort_by_key(|ended| ended.as_ref().err().map_or(u64::MAX, |(number, _)| *number));
        ended.into_iter().try_fold(None, |_, sink| sink.map_err(|(_, error)| error)?.finish())
    }
}

/// Writes frames until no more come. The thread that fails ends the writing for all.
fn write_all(mut sink: Sink, incoming: &Mutex<Option<Receiver<Frame>>>) -> Result<Sink, FailedFrame> {
    let lock = || incoming.lock().unwrap_or_else(PoisonError::into_inner);
    loop {
        let next = lock().as_ref().map(Receiver::recv);
        let Some(Ok((number, rgba))) = next else { return Ok(sink) };
        match sink.write(number, &rgba) {
            Ok(true) => {}
            ended => {
                lock().take();
                return ended.map(|_| sink).map_err(|error| (number, error));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stills_that_cannot_be_written_end_the_video_and_the_first_is_reported() {
        let folder = tempfile::tempdir().unwrap();
        // A file cannot replace a folder.
        for number in 3..11 {
            std::fs::create_dir(folder.path().join(format!("frame-{number:05}.png"))).unwrap();
        }
        let sink =
            Sink::Stills { folder: folder.path().to_owned(), size: (1, 1), has_alpha: false, first: 0 };
        let mut writer = FrameWriter::start(sink).unwrap();
        let written = (0..20_000).take_while(|_| writer.write(vec![0; 4])).count();
        assert!((3..20_000).contains(&written), "{written} frames");
        let error = writer.finish().unwrap_err().to_string();
        assert!(error.contains("frame-00003.png"), "{error}");
    }
}
