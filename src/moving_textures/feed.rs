//! A thread that decodes a video ahead of the show, or reads a camera.

use std::collections::VecDeque;
use std::io;
use std::sync::Arc;
use std::time::Duration;

use image::RgbaImage;

use super::image_of;
use crate::scenes::TextureSource;
use mariana_player::video::{Camera, VideoError, VideoFrame, VideoInfo, VideoReader};
use mariana_work::{Latest, Shared, looping};

/// Decoded frames of a video that are kept: the shown one, and the next ones. At the limit of 1,920 x 1,080 pixels they
/// take 50 MB.
const FRAMES_KEPT: usize = 6;
/// Pause before a source that has failed is opened again.
const RETRY: Duration = Duration::from_secs(2);

/// A source on its own thread. Dropping this ends the thread without waiting. The default has no thread and no picture.
#[derive(Default)]
pub(super) struct Feed(Latest<FeedState>);

#[derive(Default)]
struct FeedState {
    /// The time of the show's last frame, in seconds of the song.
    time: f64,
    info: Option<VideoInfo>,
    /// Frames by their numbers, in rising order.
    frames: VecDeque<(u64, Arc<RgbaImage>)>,
    /// True if the show lacks a newer picture than the one that it got.
    waits: bool,
    /// True if a picture has come for which the show waits.
    has_come: bool,
    message: Option<String>,
}

/// The thread of a source. It calls `wake` when a picture comes that the show lacks, and when the source fails.
struct FeedThread<'a> {
    shared: &'a Shared<FeedState>,
    wake: &'a dyn Fn(),
}

impl Feed {
    /// Starts the thread of a video or a camera, from `time` seconds of the song on.
    ///
    /// # Errors
    /// Fails if the system cannot start a thread.
    pub(super) fn start(
        source: TextureSource,
        time: f64,
        wake: impl Fn() + Send + 'static,
    ) -> io::Result<Self> {
        let state = FeedState { time, ..FeedState::default() };
        let work = move |shared: &Shared<_>| FeedThread { shared, wake: &wake }.run(&source);
        looping("moving texture", state, work).map(Self)
    }

    /// Returns the picture at `time` seconds of the song: the newest one that has come. Never waits for one.
    pub(super) fn at(&self, time: f64) -> Option<Arc<RgbaImage>> {
        self.0.change(|state| {
            state.time = time;
            let number = state.number();
            let found = state.frames.iter().rev().find(|(known, _)| *known <= number).cloned();
            state.waits = found.as_ref().is_none_or(|(known, _)| *known < number);
            found.map(|(_, picture)| picture)
        })
    }

    /// True once after a picture has come that the show lacks.
    pub(super) fn has_new_picture(&self) -> bool {
        std::mem::take(&mut self.0.lock().has_come)
    }

    /// A sentence about a failure, or a camera that is switched on, once.
    pub(super) fn drain_message(&self) -> Option<String> {
        self.0.lock().message.take()
    }
}

impl FeedState {
    /// The number of the wanted frame. A camera always shows its newest frame.
    fn number(&self) -> u64 {
        self.info.map_or(u64::MAX, |info| info.number_at(self.time))
    }

    /// The number of the frame to decode next; `None` while enough frames are decoded.
    fn next(&mut self) -> Option<u64> {
        let number = self.number();
        let [first, last] = [self.frames.front(), self.frames.back()].map(|frame| frame.map(|frame| frame.0));
        let (Some(first), Some(last)) = (first, last) else { return Some(number) };
        if number < first {
            // The song has jumped back. The show keeps its picture meanwhile.
            self.frames.clear();
            return Some(number);
        }
        if number > last {
            return Some(number);
        }
        while self.frames.get(1).is_some_and(|(second, _)| *second <= number) {
            self.frames.pop_front();
        }
        (self.frames.len() < FRAMES_KEPT).then_some(last + 1)
    }

    fn put(&mut self, number: u64, picture: Arc<RgbaImage>) {
        if self.frames.back().is_some_and(|(last, _)| *last >= number) {
            self.frames.clear();
        }
        if self.frames.len() >= FRAMES_KEPT {
            self.frames.pop_front();
        }
        self.frames.push_back((number, picture));
    }
}

impl FeedThread<'_> {
    /// Reads the source until the show no longer needs it. Opens it again after failures.
    fn run(&self, source: &TextureSource) {
        let mut told = None;
        while !self.shared.is_over() {
            let failed = match source {
                TextureSource::Video { file, .. } => {
                    VideoReader::open(file, &source.name()).and_then(|mut reader| self.follow(&mut reader))
                }
                TextureSource::Camera(number) => {
                    Camera::numbered(*number).and_then(|mut it| self.watch(&mut it))
                }
                TextureSource::CameraDevice(device) => {
                    Camera::open(device, &source.name()).and_then(|mut it| self.watch(&mut it))
                }
                TextureSource::Cover => return,
            };
            let Err(error) = failed else { return };
            let words = error.to_string();
            if told.as_ref() != Some(&words) {
                self.shared.lock().message = Some(words.clone());
                told = Some(words);
                (self.wake)();
            }
            self.shared.rest(RETRY);
        }
    }

    /// Decodes a video ahead of the show, until the show ends.
    fn follow(&self, reader: &mut VideoReader) -> Result<(), VideoError> {
        self.shared.lock().info = Some(reader.info());
        loop {
            let mut next = None;
            drop(self.shared.wait_while(Duration::MAX, |state| {
                next = state.next();
                next.is_none()
            }));
            let Some(number) = next.filter(|_| !self.shared.is_over()) else { return Ok(()) };
            let frame = reader.frame(number)?.clone();
            self.put(number, frame);
        }
    }

    /// Reads a camera until the show ends.
    fn watch(&self, camera: &mut Camera) -> Result<(), VideoError> {
        for number in 0.. {
            let frame = camera.next_frame()?;
            if self.shared.is_over() {
                break;
            }
            if number == 0 {
                self.shared.lock().message =
                    Some(format!("{} is on, because a scene shows it", camera.name()));
                (self.wake)();
            }
            self.put(number, frame);
        }
        Ok(())
    }

    fn put(&self, number: u64, frame: VideoFrame) {
        let Some(picture) = image_of(frame) else { return };
        let mut state = self.shared.lock();
        state.put(number, Arc::new(picture));
        let wakes = state.waits && (state.info.is_none() || number <= state.number());
        state.has_come |= wakes;
        drop(state);
        if wakes {
            (self.wake)();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(time: f64) -> FeedState {
        let info = VideoInfo { size: (2, 2), rate: (25, 1), frames: 75 };
        FeedState { time, info: Some(info), ..FeedState::default() }
    }

    fn fill(state: &mut FeedState) -> Vec<u64> {
        let mut decoded = Vec::new();
        while let Some(number) = state.next() {
            assert!(decoded.len() < 100, "{decoded:?}");
            decoded.push(number);
            state.put(number, Arc::new(RgbaImage::new(1, 1)));
        }
        decoded
    }

    #[test]
    fn frames_are_decoded_ahead_and_after_jumps() {
        let mut state = state(1.0);
        assert_eq!(fill(&mut state), [25, 26, 27, 28, 29, 30]);
        state.time = 1.08;
        assert_eq!(fill(&mut state), [31, 32]);
        assert_eq!(state.frames.front().map(|frame| frame.0), Some(27));
        state.time = 0.4;
        assert_eq!(fill(&mut state), [10, 11, 12, 13, 14, 15]);
        // After a jump ahead, the old frames stay until the new ones come.
        state.time = 9.0;
        assert_eq!(state.next(), Some(225));
        assert_eq!(state.frames.len(), FRAMES_KEPT);
        assert_eq!(fill(&mut state), [225, 226, 227, 228, 229, 230]);
        assert_eq!(state.frames.len(), FRAMES_KEPT);
    }
}
