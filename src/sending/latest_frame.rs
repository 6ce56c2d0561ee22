//! A mailbox with the latest frame for a receiver, and messages about the receiver. Putting a frame never blocks.

use std::sync::Arc;
use std::time::{Duration, Instant};

use mariana_work::Shared;

/// A frame to be sent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OutgoingFrame {
    /// Width and height in pixels, both even.
    pub size: (u32, u32),
    /// RGBA bytes, top row first.
    pub rgba: Arc<Vec<u8>>,
}

/// A write that takes longer than this is reported as blocked.
const BLOCKS_AFTER: Duration = Duration::from_secs(2);

/// The mailbox of a receiver.
pub struct LatestFrame {
    shared: Shared<State>,
    pub(super) to: String,
}

#[derive(Default)]
struct State {
    /// The frame with its number, counted from 1.
    picture: Option<(u64, OutgoingFrame)>,
    count: u64,
    receivers: usize,
    news: Vec<String>,
    writing: Option<Instant>,
    reported_slow: bool,
    reported_blocked: bool,
}

impl LatestFrame {
    pub(super) fn new(to: String) -> Self {
        Self { shared: Shared::default(), to }
    }

    /// Replaces the frame that is sent.
    pub fn put(&self, picture: OutgoingFrame) {
        self.shared.change(|state| {
            state.count += 1;
            state.picture = Some((state.count, picture));
        });
    }

    pub(super) fn end(&self) {
        self.shared.end();
    }

    pub(super) fn is_over(&self) -> bool {
        self.shared.is_over()
    }

    /// Waits for a frame; `None` at the end.
    pub(super) fn first(&self) -> Option<OutgoingFrame> {
        self.after(0).map(|(_, picture)| picture)
    }

    /// Waits for a frame with a higher number; `None` at the end.
    pub(super) fn after(&self, number: u64) -> Option<(u64, OutgoingFrame)> {
        let is_old = |state: &mut State| {
            state.picture.as_ref().is_none_or(|(latest_frame, _)| *latest_frame <= number)
        };
        let state = self.shared.wait_while(Duration::MAX, is_old);
        state.picture.clone().filter(|_| !self.is_over())
    }

    /// Waits for `time`, or until the end. Returns true at the end.
    pub(super) fn rest(&self, time: Duration) -> bool {
        self.shared.rest(time);
        self.is_over()
    }

    pub(super) fn report(&self, sentence: String) {
        self.shared.lock().news.push(sentence);
    }

    /// Counts a new receiver. The first receiver gets no frame that is older than its connection.
    pub(super) fn has_receiver(&self) {
        let mut state = self.shared.lock();
        (state.reported_slow, state.reported_blocked) = (false, false);
        state.receivers += 1;
        if state.receivers == 1 {
            state.picture = None;
        }
    }

    pub(super) fn has_lost_receiver(&self) {
        let mut state = self.shared.lock();
        state.receivers = state.receivers.saturating_sub(1);
    }

    /// True if a receiver is connected, or no frame has been put yet.
    pub fn is_wanted(&self) -> bool {
        let state = self.shared.lock();
        state.receivers > 0 || state.count == 0
    }

    pub(super) fn set_writing(&self, writes: bool) {
        self.shared.lock().writing = writes.then(Instant::now);
    }

    /// Reports once that the receiver is too slow to get every frame.
    pub(super) fn report_slow(&self) {
        let mut state = self.shared.lock();
        if !std::mem::replace(&mut state.reported_slow, true) {
            let sentence = format!("{} is too slow: some frames are dropped", self.reader());
            state.news.push(sentence);
        }
    }

    /// Returns the messages about receivers since the last call.
    pub fn news(&self) -> Vec<String> {
        let mut state = self.shared.lock();
        let blocks = state.writing.is_some_and(|since| since.elapsed() > BLOCKS_AFTER);
        if blocks && !std::mem::replace(&mut state.reported_blocked, true) {
            let sentence = format!("{} has stopped reading: the show continues without it", self.reader());
            state.news.push(sentence);
        }
        std::mem::take(&mut state.news)
    }

    fn reader(&self) -> String {
        format!("the reader of {}", self.to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(value: u8) -> OutgoingFrame {
        OutgoingFrame { size: (2, 2), rgba: Arc::new(vec![value; 16]) }
    }

    #[test]
    fn a_reader_gets_the_latest_frame_and_never_the_same_one_twice() {
        let latest_frame = Arc::new(LatestFrame::new("a place".into()));
        latest_frame.put(picture(1));
        latest_frame.put(picture(2));
        assert_eq!(latest_frame.first(), Some(picture(2)));
        assert_eq!(latest_frame.after(1), Some((2, picture(2))));
        let (reader, put) = (latest_frame.clone(), latest_frame.clone());
        let waits = std::thread::spawn(move || reader.after(2));
        put.put(picture(3));
        assert_eq!(waits.join().unwrap(), Some((3, picture(3))));
        latest_frame.end();
        assert!(latest_frame.is_over() && latest_frame.rest(Duration::from_secs(60)));
        assert_eq!((latest_frame.first(), latest_frame.after(0)), (None, None));
    }

    #[test]
    fn each_slow_receiver_is_reported_once() {
        let latest_frame = LatestFrame::new("a place".into());
        latest_frame.report_slow();
        latest_frame.report_slow();
        let reported = latest_frame.news();
        assert!(
            matches!(&reported[..], [one] if one.contains("a place") && one.contains("dropped")),
            "{reported:?}"
        );
        assert!(latest_frame.is_wanted(), "the first frame is not wanted");
        latest_frame.put(picture(1));
        assert!(!latest_frame.is_wanted());
        latest_frame.has_receiver();
        assert!(
            latest_frame.is_wanted() && latest_frame.shared.lock().picture.is_none(),
            "an old frame was kept"
        );
        latest_frame.put(picture(2));
        latest_frame.has_receiver();
        latest_frame.has_lost_receiver();
        assert!(latest_frame.is_wanted() && latest_frame.first() == Some(picture(2)));
        latest_frame.has_lost_receiver();
        assert!(!latest_frame.is_wanted());
        latest_frame.report_slow();
        assert_eq!(latest_frame.news().len(), 1);
        assert!(latest_frame.news().is_empty());
    }

    #[test]
    fn a_slow_receiver_that_stops_reading_is_reported_too() {
        let latest_frame = LatestFrame::new("a place".into());
        latest_frame.report_slow();
        latest_frame.shared.lock().writing = Instant::now().checked_sub(2 * BLOCKS_AFTER);
        let reported = latest_frame.news();
        assert!(matches!(&reported[..], [_, one] if one.contains("has stopped reading")), "{reported:?}");
        assert!(latest_frame.news().is_empty());
    }
}
