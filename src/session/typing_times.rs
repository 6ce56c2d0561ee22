//! The response times of the editor's keys, for the log.

use std::time::{Duration, Instant};

use crate::session::times::Times;

#[derive(Debug, Default)]
pub(crate) struct TypingTimes {
    /// Time of the first key press that the displayed text does not show yet.
    pressed: Option<Instant>,
    /// Time of the first key press whose effect no frame shows yet, and the id of the scene shown then.
    pub(crate) drafted: Option<(Instant, Option<u64>)>,
    /// Time spent so far on handling the key presses that the displayed text does not show yet.
    pub(crate) taken: Duration,
    work: Times,
    text: Times,
    picture: Times,
}

impl TypingTimes {
    pub(crate) fn record_key(&mut self, scene: Option<u64>, now: Instant) {
        self.pressed.get_or_insert(now);
        self.drafted.get_or_insert((now, scene));
    }

    /// Notes that the window showed a frame of this scene, a new one if `is_new`. Its overlay took `painting` to draw.
    pub(crate) fn record_shown(
        &mut self,
        scene: Option<u64>,
        is_new: bool,
        painting: Duration,
        now: Instant,
    ) {
        let taken = std::mem::take(&mut self.taken);
        if let Some(pressed) = self.pressed.take() {
            self.work.record(taken + painting);
            self.text.record(now - pressed);
        }
        if let Some((since, _)) = self.drafted.take_if(|(_, before)| is_new && *before != scene) {
            self.picture.record(now - since);
        }
    }
}

impl std::fmt::Display for TypingTimes {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { work, text, picture, .. } = self;
        write!(f, "work for a key: {work}; to its letter: {text}; to the picture: {picture}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_count_until_visible_and_mistakes_count_for_no_frame() {
        let start = Instant::now();
        let at = |ms| start + Duration::from_millis(ms);
        let mut times = TypingTimes::default();
        assert_eq!(times.to_string(), "work for a key: none; to its letter: none; to the picture: none");
        times.record_key(Some(1), at(0));
        times.taken += Duration::from_millis(1);
        times.record_shown(Some(1), true, Duration::from_millis(2), at(4));
        times.record_shown(Some(2), true, Duration::ZERO, at(20));
        times.record_key(Some(2), at(100));
        times.drafted = None;
        times.record_shown(Some(2), true, Duration::from_millis(3), at(102));
        times.record_shown(Some(3), true, Duration::ZERO, at(900));
        let text = "work for a key: 2 times; the last 2: median 3.0 ms, 99 % within 3.0 ms, longest 3.0 ms; \
                    to its letter: 2 times; the last 2: median 4.0 ms, 99 % within 4.0 ms, longest 4.0 ms; \
                    to the picture: 1 times; the last 1: median 20.0 ms, 99 % within 20.0 ms, longest 20.0 ms";
        assert_eq!(times.to_string(), text);
    }
}
