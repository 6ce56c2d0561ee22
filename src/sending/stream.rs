//! Sends frames at a constant rate to receivers that read every frame: y4m (a FIFO or standard output) and v4l2.
//!
//! Receivers derive the time from the number of frames, so an unchanged frame is sent again.

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::latest_frame::{LatestFrame, OutgoingFrame};
use super::{SendError, SenderTarget};
use crate::y4m::{self, Chroma};

/// Bytes to a reader.
pub(super) type Stream = Box<dyn Write>;

/// A receiver of frames at a constant rate. Each target has a thread, so each call may block for any time.
pub(super) struct Receiver {
    /// Waits for a reader. Fails if no reader can connect any more.
    pub(super) open: Box<dyn FnMut() -> std::io::Result<Stream> + Send>,
    /// Encodes a frame.
    pub(super) bytes: fn(&OutgoingFrame) -> Vec<u8>,
    /// True if another reader can connect after one has disconnected.
    pub(super) comes_again: bool,
}

const PAUSE: Duration = Duration::from_millis(500);

pub(super) fn start(receiver: Receiver, fps: f64, latest_frame: Arc<LatestFrame>) -> Result<(), SendError> {
    let send = move || send(receiver, fps, &latest_frame);
    std::thread::Builder::new().name("sending".into()).spawn(send).map(drop).map_err(SendError::Thread)
}

fn send(mut receiver: Receiver, fps: f64, latest_frame: &LatestFrame) {
    let period = Duration::try_from_secs_f64(1.0 / fps).unwrap_or(Duration::from_millis(33));
    // Wait for a frame before opening, because opening sends the stream's header.
    while latest_frame.first().is_some() {
        let stream = match (receiver.open)() {
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
        if !receiver.comes_again {
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
    receiver: &Receiver,
    mut stream: Stream,
    period: Duration,
    latest_frame: &LatestFrame,
) -> Option<std::io::Error> {
    let mut due = Instant::now();
    loop {
        let picture = latest_frame.first()?;
        let begun = Instant::now();
        latest_frame.set_writing(true);
        let written = stream.write_all(&(receiver.bytes)(&picture)).and_then(|()| stream.flush());
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

/// Returns a FIFO as a receiver of y4m.
pub(super) fn fifo(path: &Path, size: (u32, u32), fps: f64) -> Result<Receiver, SendError> {
    let refused = |reason: &str| SendError::Refused {
        to: SenderTarget::Y4m(Some(path.to_owned())).to_string(),
        reason: reason.to_owned(),
    };
    match std::fs::metadata(path) {
        Ok(found) if is_fifo(&found) => {}
        Ok(_) => {
            return Err(refused("it is no FIFO: make one with mkfifo, or write a file with 'mariana video'"));
        }
        Err(error) if error.kind() == ErrorKind::NotFound => {
            return Err(refused("there is no such FIFO: check the path, or make one with mkfifo"));
        }
        Err(error) => return Err(refused(&format!("{error}: check the path"))),
    }
    let (path, header) = (path.to_owned(), y4m::header(size, fps, Chroma::Quarter));
    let open = move || -> std::io::Result<Stream> {
        // Blocks until the FIFO has a reader.
        let mut file = OpenOptions::new().write(true).open(&path)?;
        // A reader that has disconnected already is noticed at the first frame.
        match file.write_all(&header) {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error),
            _ => Ok(Box::new(file)),
        }
    };
    Ok(Receiver { open: Box::new(open), bytes: y4m_frame, comes_again: true })
}

#[cfg(unix)]
fn is_fifo(found: &std::fs::Metadata) -> bool {
    std::os::unix::fs::FileTypeExt::is_fifo(&found.file_type())
}

#[cfg(not(unix))]
fn is_fifo(_: &std::fs::Metadata) -> bool {
    false
}

/// Returns standard output as a receiver of y4m.
pub(super) fn standard(size: (u32, u32), fps: f64) -> Receiver {
    let header = y4m::header(size, fps, Chroma::Quarter);
    let open = move || -> std::io::Result<Stream> {
        let mut out = std::io::stdout();
        // A missing reader is noticed at the first frame.
        let _ = out.write_all(&header);
        Ok(Box::new(out))
    };
    Receiver { open: Box::new(open), bytes: y4m_frame, comes_again: false }
}

fn y4m_frame(picture: &OutgoingFrame) -> Vec<u8> {
    y4m::frame_of_quarter(&picture.rgba, picture.size)
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Sender, channel};

    use super::*;

    struct ShortStream {
        taken: Sender<u8>,
        left: usize,
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
        let mut times = 2_usize;
        let open = move || -> std::io::Result<Stream> {
            times = times.checked_sub(1).ok_or(ErrorKind::NotFound)?;
            Ok(Box::new(ShortStream { taken: taken.clone(), left: 3 }))
        };
        let bytes = |picture: &OutgoingFrame| picture.rgba.to_vec();
        let receiver = Receiver { open: Box::new(open), bytes, comes_again: true };
        start(receiver, 500.0, latest_frame.clone()).unwrap();
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
            let refused = fifo(path, (2, 2), 30.0).err().map(|error| error.to_string()).unwrap();
            assert!(refused.contains(part) && refused.contains("mkfifo"), "{refused}");
        }
        std::fs::write(&file, "kept").unwrap();
        assert!(fifo(&file, (2, 2), 30.0).is_err());
        assert_eq!(std::fs::read(&file).unwrap(), b"kept");
    }
}
