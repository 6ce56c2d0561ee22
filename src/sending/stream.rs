//! Sends frames at a constant rate to receivers that read every frame: y4m (a FIFO or standard output) and v4l2.
//!
//! Receivers derive the time from the number of frames, so an unchanged frame is sent again.

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Stdout, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::latest_frame::{LatestFrame, OutgoingFrame};
use super::{SendError, SenderTarget};
use crate::y4m::{self, Chroma};

/// A receiver of frames at a constant rate. Each target has a thread, so each call may block for any time.
pub(super) trait Receiver: Send + 'static {
    type Stream: Write;

    /// True if another reader can connect after one has disconnected.
    const COMES_AGAIN: bool = true;

    /// Waits for a reader.
    ///
    /// # Errors
    /// Fails if no reader can connect any more.
    fn open(&mut self) -> std::io::Result<Self::Stream>;

    fn bytes(&self, picture: &OutgoingFrame) -> Vec<u8> {
        y4m::frame_of_quarter(&picture.rgba, picture.size)
    }
}

const PAUSE: Duration = Duration::from_millis(500);

pub(super) fn start(
    receiver: impl Receiver,
    fps: f64,
    latest_frame: Arc<LatestFrame>,
) -> Result<(), SendError> {
    let send = move || send(receiver, fps, &latest_frame);
    std::thread::Builder::new().name("sending".into()).spawn(send).map(drop).map_err(SendError::Thread)
}

fn send<R: Receiver>(mut receiver: R, fps: f64, latest_frame: &LatestFrame) {
    let period = Duration::try_from_secs_f64(1.0 / fps).unwrap_or(Duration::from_millis(33));
    // Wait for a frame before opening, because opening sends the stream's header.
    while latest_frame.first().is_some() {
        let stream = match receiver.open() {
            Ok(stream) => stream,
            Err(error) => {
                latest_frame.report(format!("no more frames can be sent to {}: {error}", &latest_frame.to));
                return;
            }
        };
        latest_frame.has_receiver();
        tracing::info!("{} has a receiver", &latest_frame.to);
        let ended = feed(&receiver, stream, period, latest_frame);
        latest_frame.has_lost_receiver();
        let Some(error) = ended else { return };
        if !R::COMES_AGAIN {
            latest_frame.report(format!(
                "the reader of {} has disconnected: no more frames are sent there",
                &latest_frame.to
            ));
            return;
        }
        latest_frame.report(format!(
            "the reader of {} has disconnected: the next reader gets frames",
            &latest_frame.to
        ));
        tracing::debug!("{error}");
        if latest_frame.rest(PAUSE) {
            return;
        }
    }
}

/// Writes frames. Returns the error if the reader disconnects, `None` at the end.
fn feed(
    receiver: &impl Receiver,
    mut stream: impl Write,
    period: Duration,
    latest_frame: &LatestFrame,
) -> Option<std::io::Error> {
    let mut due = Instant::now();
    loop {
        let picture = latest_frame.first()?;
        let begun = Instant::now();
        latest_frame.set_writing(true);
        let written = stream.write_all(&receiver.bytes(&picture)).and_then(|()| stream.flush());
        latest_frame.set_writing(false);
        if let Err(error) = written {
            return Some(error);
        }
        due += period;
        let now = Instant::now();
        if now > due + period {
            // The first frame and a busy machine are no fault of the reader.
            if now > begun + period {
                latest_frame.report_slow();
            }
            due = now;
        }
        if latest_frame.rest(due.saturating_duration_since(now)) {
            return None;
        }
    }
}

pub(super) struct Fifo {
    path: PathBuf,
    header: Vec<u8>,
}

impl Fifo {
    pub(super) fn new(path: &Path, size: (u32, u32), fps: f64) -> Result<Self, SendError> {
        let refused = |reason: &str| SendError::Refused {
            to: SenderTarget::Y4m(Some(path.to_owned())).to_string(),
            reason: reason.to_owned(),
        };
        match std::fs::metadata(path) {
            Ok(found) if is_fifo(&found) => {}
            Ok(_) => {
                return Err(refused(
                    "it is no FIFO: make one with mkfifo, or write a file with 'mariana video'",
                ));
            }
            Err(error) if error.kind() == ErrorKind::NotFound => {
                return Err(refused("there is no such FIFO: check the path, or make one with mkfifo"));
            }
            Err(error) => return Err(refused(&format!("{error}: check the path"))),
        }
        Ok(Self { path: path.to_owned(), header: y4m::header(size, fps, Chroma::Quarter) })
    }
}

#[cfg(unix)]
fn is_fifo(found: &std::fs::Metadata) -> bool {
    std::os::unix::fs::FileTypeExt::is_fifo(&found.file_type())
}

#[cfg(not(unix))]
fn is_fifo(_: &std::fs::Metadata) -> bool {
    false
}

impl Receiver for Fifo {
    type Stream = File;

    fn open(&mut self) -> std::io::Result<File> {
        // Blocks until the FIFO has a reader.
        let mut file = OpenOptions::new().write(true).open(&self.path)?;
        // A reader that has disconnected already is noticed at the first frame.
        match file.write_all(&self.header) {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error),
            _ => Ok(file),
        }
    }
}

pub(super) struct Standard(Vec<u8>);

impl Standard {
    pub(super) fn new(size: (u32, u32), fps: f64) -> Self {
        Self(y4m::header(size, fps, Chroma::Quarter))
    }
}

impl Receiver for Standard {
    type Stream = Stdout;

    const COMES_AGAIN: bool = false;

    fn open(&mut self) -> std::io::Result<Stdout> {
        let mut out = std::io::stdout();
        // A missing reader is noticed at the first frame.
        let _ = out.write_all(&self.0);
        Ok(out)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Sender, channel};

    use super::*;

    struct Short {
        taken: Sender<u8>,
        pictures: usize,
        times: usize,
    }

    struct ShortStream {
        taken: Sender<u8>,
        left: usize,
    }

    impl Receiver for Short {
        type Stream = ShortStream;

        fn open(&mut self) -> std::io::Result<ShortStream> {
            self.times = self.times.checked_sub(1).ok_or(ErrorKind::NotFound)?;
            Ok(ShortStream { taken: self.taken.clone(), left: self.pictures })
        }

        fn bytes(&self, picture: &OutgoingFrame) -> Vec<u8> {
            picture.rgba.to_vec()
        }
    }

    impl Write for ShortStream {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.left = self.left.checked_sub(1).ok_or(ErrorKind::BrokenPipe)?;
            self.taken.send(bytes[0]).map_err(|_| ErrorKind::BrokenPipe)?;
            Ok(bytes.len())
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn an_unchanged_frame_is_sent_again_and_receivers_come_and_go() {
        let (taken, pictures) = channel();
        let latest_frame = Arc::new(LatestFrame::new("a place".into()));
        start(Short { taken, pictures: 3, times: 2 }, 500.0, latest_frame.clone()).unwrap();
        let feeder = latest_frame.clone();
        let feeds = std::thread::spawn(move || {
            while !feeder.rest(Duration::from_millis(1)) {
                if feeder.is_wanted() {
                    feeder.put(OutgoingFrame { size: (2, 2), rgba: Arc::new(vec![7; 16]) });
                }
            }
        });
        assert_eq!(pictures.iter().collect::<Vec<_>>(), [7; 6]);
        latest_frame.end();
        feeds.join().unwrap();
        let reported = latest_frame.news();
        let gone = |sentence: &String| sentence.contains("has disconnected: the next reader");
        assert_eq!(reported.iter().filter(|sentence| gone(sentence)).count(), 2, "{reported:?}");
        assert!(
            reported.last().is_some_and(|last| last.contains("no more frames can be sent to")),
            "{reported:?}"
        );
    }

    #[cfg(unix)]
    #[test]
    fn other_files_than_fifos_are_refused_with_advice() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.y4m");
        for (path, part) in [(file.as_path(), "there is no such FIFO"), (folder.path(), "it is no FIFO")] {
            let refused = Fifo::new(path, (2, 2), 30.0).err().map(|error| error.to_string()).unwrap();
            assert!(refused.contains(part) && refused.contains("mkfifo"), "{refused}");
        }
        std::fs::write(&file, "kept").unwrap();
        assert!(Fifo::new(&file, (2, 2), 30.0).is_err());
        assert_eq!(std::fs::read(&file).unwrap(), b"kept");
    }
}
