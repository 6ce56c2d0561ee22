//! Sends frames at a constant rate to receivers that read every frame: y4m (a FIFO or standard output) and v4l2.
//!
//! Receivers derive the time from the number of frames, so an unchanged frame is sent again.

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::latest_frame::{LatestFrame, OutgoingFrame};
use super::{SendError, SenderTarget};
use crate::y4m::{self, Chroma};

/// A receiver of frames at a constant rate. Each target has a thread, so each call may block for any time.
pub(super) trait Receiver: Send + 'static {
    /// Waits for a reader.
    ///
    /// # Errors
    /// Fails if no reader can connect any more.
    fn open(&mut self) -> std::io::Result<()>;

    /// Writes a frame.
    ///
    /// # Errors
    /// Fails if the reader has disconnected, or if the frame cannot be written.
    fn write(&mut self, picture: &OutgoingFrame) -> std::io::Result<()>;

    fn can_come_again(&self) -> bool;
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

fn send(mut receiver: impl Receiver, fps: f64, latest_frame: &LatestFrame) {
    let period = Duration::try_from_secs_f64(1.0 / fps).unwrap_or(Duration::from_millis(33));
    // Wait for a frame before opening, because opening sends the stream's header.
    while latest_frame.first().is_some() {
        match receiver.open() {
            Ok(()) => latest_frame.has_receiver(),
            Err(error) => {
                latest_frame.report(format!("no more frames can be sent to {}: {error}", &latest_frame.to));
                return;
            }
        }
        tracing::info!("{} has a receiver", &latest_frame.to);
        let ended = feed(&mut receiver, period, latest_frame);
        latest_frame.has_lost_receiver();
        let Some(error) = ended else { return };
        if !receiver.can_come_again() {
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
    receiver: &mut impl Receiver,
    period: Duration,
    latest_frame: &LatestFrame,
) -> Option<std::io::Error> {
    let mut due = Instant::now();
    loop {
        let picture = latest_frame.first()?;
        let begun = Instant::now();
        latest_frame.set_writing(true);
        let written = receiver.write(&picture);
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
    file: Option<File>,
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
        Ok(Self { path: path.to_owned(), header: y4m::header(size, fps, Chroma::Quarter), file: None })
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
    fn open(&mut self) -> std::io::Result<()> {
        self.file = None;
        // Blocks until the FIFO has a reader.
        let mut file = OpenOptions::new().write(true).open(&self.path)?;
        // A reader that has disconnected already is noticed at the first frame.
        match file.write_all(&self.header) {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => return Err(error),
            _ => {}
        }
        self.file = Some(file);
        Ok(())
    }

    fn write(&mut self, picture: &OutgoingFrame) -> std::io::Result<()> {
        let Some(file) = &mut self.file else { return Err(ErrorKind::NotConnected.into()) };
        let written = file.write_all(&y4m::frame_of_quarter(&picture.rgba, picture.size));
        if written.is_err() {
            // Close the FIFO at once, so that the next reader does not get the rest of this stream.
            self.file = None;
        }
        written
    }

    fn can_come_again(&self) -> bool {
        true
    }
}

pub(super) struct Standard(Vec<u8>);

impl Standard {
    pub(super) fn new(size: (u32, u32), fps: f64) -> Self {
        Self(y4m::header(size, fps, Chroma::Quarter))
    }
}

impl Receiver for Standard {
    fn open(&mut self) -> std::io::Result<()> {
        // A missing reader is noticed at the first frame.
        let _ = std::io::stdout().write_all(&self.0);
        Ok(())
    }

    fn write(&mut self, picture: &OutgoingFrame) -> std::io::Result<()> {
        let mut out = std::io::stdout().lock();
        out.write_all(&y4m::frame_of_quarter(&picture.rgba, picture.size))?;
        out.flush()
    }

    fn can_come_again(&self) -> bool {
        false
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Sender, channel};

    use super::*;

    struct Short {
        taken: Sender<u8>,
        pictures: usize,
        left: usize,
        times: usize,
    }

    impl Receiver for Short {
        fn open(&mut self) -> std::io::Result<()> {
            self.times = self.times.checked_sub(1).ok_or(ErrorKind::NotFound)?;
            self.left = self.pictures;
            Ok(())
        }

        fn write(&mut self, picture: &OutgoingFrame) -> std::io::Result<()> {
            self.left = self.left.checked_sub(1).ok_or(ErrorKind::BrokenPipe)?;
            self.taken.send(picture.rgba[0]).map_err(|_| ErrorKind::BrokenPipe.into())
        }

        fn can_come_again(&self) -> bool {
            true
        }
    }

    #[test]
    fn an_unchanged_frame_is_sent_again_and_receivers_come_and_go() {
        let (taken, pictures) = channel();
        let latest_frame = Arc::new(LatestFrame::new("a place".into()));
        start(Short { taken, pictures: 3, left: 0, times: 2 }, 500.0, latest_frame.clone()).unwrap();
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
