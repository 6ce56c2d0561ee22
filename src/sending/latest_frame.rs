//! The newest picture of a send, and what there is to say of it. Whoever puts one waits for nobody.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// A picture to be sent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OutgoingFrame {
    /// Width and height in pixels, both even.
    pub size: (u32, u32),
    /// Four bytes for each pixel, the top row first.
    pub rgba: Arc<Vec<u8>>,
}

/// A receiver that has taken nothing for this long blocks.
const BLOCKS_AFTER: Duration = Duration::from_secs(2);

/// See the module.
pub(super) struct LatestFrame {
    state: Mutex<State>,
    changed: Condvar,
    /// Where it is sent to, in words.
    to: String,
}

#[derive(Default)]
struct State {
    /// With its number, from 1.
    picture: Option<(u64, OutgoingFrame)>,
    count: u64,
    over: bool,
    receivers: usize,
    news: Vec<String>,
    /// Since when a receiver takes a picture.
    writing: Option<Instant>,
    /// Whether it was told that this receiver is slow, or blocks.
    reported_slow: bool,
}

impl LatestFrame {
    /// No picture yet; `to` is where it is sent, in words.
    pub(super) fn new(to: String) -> Self {
        Self { state: Mutex::default(), changed: Condvar::new(), to }
    }

    /// Where it is sent, in words.
    pub(super) fn to(&self) -> &str {
        &self.to
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // Whoever panicked has left whole values.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// This is the newest picture.
    pub(super) fn put(&self, picture: OutgoingFrame) {
        let mut state = self.lock();
        state.count += 1;
        state.picture = Some((state.count, picture));
        self.changed.notify_all();
    }

    /// There will be no more.
    pub(super) fn end(&self) {
        self.lock().over = true;
        self.changed.notify_all();
    }

    /// Whether there will be no more.
    pub(super) fn is_over(&self) -> bool {
        self.lock().over
    }

    /// The newest picture, as soon as there is one; none at the end.
    pub(super) fn first(&self) -> Option<OutgoingFrame> {
        self.after(0).map(|(_, picture)| picture)
    }

    /// The newest picture, as soon as its number is greater than this; none at the end.
    pub(super) fn after(&self, number: u64) -> Option<(u64, OutgoingFrame)> {
        let is_old = |state: &mut State| {
            !state.over && state.picture.as_ref().is_none_or(|(latest_frame, _)| *latest_frame <= number)
        };
        let state = self.changed.wait_while(self.lock(), is_old).unwrap_or_else(PoisonError::into_inner);
        state.picture.clone().filter(|_| !state.over)
    }

    /// Waits for so long, or until the end. Returns whether it is the end.
    pub(super) fn rest(&self, time: Duration) -> bool {
        let waited = self.changed.wait_timeout_while(self.lock(), time, |state| !state.over);
        waited.unwrap_or_else(PoisonError::into_inner).0.over
    }

    /// There is this to say.
    pub(super) fn tell(&self, sentence: String) {
        self.lock().news.push(sentence);
    }

    /// Another receiver has come, of which nothing was told. The first one waits for a picture of its own time.
    pub(super) fn has_receiver(&self) {
        let mut state = self.lock();
        state.reported_slow = false;
        state.receivers += 1;
        if state.receivers == 1 {
            state.picture = None;
        }
    }

    /// A receiver has gone.
    pub(super) fn has_lost_receiver(&self) {
        let mut state = self.lock();
        state.receivers = state.receivers.saturating_sub(1);
    }

    /// Whether somebody takes pictures, or waits for the first.
    pub(super) fn is_wanted(&self) -> bool {
        let state = self.lock();
        state.receivers > 0 || state.count == 0
    }

    /// Whether a receiver is taking a picture.
    pub(super) fn note_writing(&self, writes: bool) {
        self.lock().writing = writes.then(Instant::now);
    }

    /// The receiver is too slow for all pictures. It is told once.
    pub(super) fn note_slow(&self) {
        let mut state = self.lock();
        if !std::mem::replace(&mut state.reported_slow, true) {
            let sentence = format!("{} takes pictures too slowly: some are left out", self.reader());
            state.news.push(sentence);
        }
    }

    /// What there is to say since the last call.
    pub(super) fn news(&self) -> Vec<String> {
        let mut state = self.lock();
        let blocks = state.writing.is_some_and(|since| since.elapsed() > BLOCKS_AFTER);
        if blocks && !std::mem::replace(&mut state.reported_slow, true) {
            let sentence = format!("{} takes no pictures: the show goes on without it", self.reader());
            state.news.push(sentence);
        }
        std::mem::take(&mut state.news)
    }

    fn reader(&self) -> String {
        format!("whoever reads {}", self.to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(value: u8) -> OutgoingFrame {
        OutgoingFrame { size: (2, 2), rgba: Arc::new(vec![value; 16]) }
    }

    #[test]
    fn a_reader_gets_the_newest_picture_and_never_the_same_one_twice() {
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
    fn a_slow_receiver_is_told_once_and_the_next_one_anew() {
        let latest_frame = LatestFrame::new("a place".into());
        latest_frame.note_slow();
        latest_frame.note_slow();
        let reported = latest_frame.news();
        assert!(
            matches!(&reported[..], [one] if one.contains("a place") && one.contains("left out")),
            "{reported:?}"
        );
        assert!(latest_frame.is_wanted(), "the first picture is");
        latest_frame.put(picture(1));
        assert!(!latest_frame.is_wanted());
        latest_frame.has_receiver();
        assert!(latest_frame.is_wanted() && latest_frame.lock().picture.is_none(), "an old picture is left");
        latest_frame.put(picture(2));
        latest_frame.has_receiver();
        latest_frame.has_lost_receiver();
        assert!(latest_frame.is_wanted() && latest_frame.first() == Some(picture(2)));
        latest_frame.has_lost_receiver();
        assert!(!latest_frame.is_wanted());
        latest_frame.note_slow();
        assert_eq!(latest_frame.news().len(), 1);
        assert!(latest_frame.news().is_empty());
    }
}
