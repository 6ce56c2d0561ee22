//! The response times of the editor's keys, for the log.

use std::time::{Duration, Instant};

const KEPT: usize = 4096;

#[derive(Debug, Default)]
pub(crate) struct TypingTimes {
    /// Time of the first key press that the displayed text does not show yet.
    pressed: Option<Instant>,
    /// Time of the first key press whose effect no frame shows yet, and the id of the scene shown then.
    pub(crate) drafted: Option<(Instant, Option<u64>)>,
    /// Time spent so far on handling the key presses that the displayed text does not show yet.
    pub(crate) taken: Duration,
    work: Vec<f32>,
    text: Vec<f32>,
    picture: Vec<f32>,
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
            record(&mut self.work, taken + painting);
            record(&mut self.text, now - pressed);
        }
        if let Some((since, _)) = self.drafted.take_if(|(_, before)| is_new && *before != scene) {
            record(&mut self.picture, now - since);
        }
    }
}

fn record(list: &mut Vec<f32>, time: Duration) {
    if list.len() < KEPT {
        list.push(1000.0 * time.as_secs_f32());
    }
}

impl std::fmt::Display for TypingTimes {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let summary = |list: &[f32]| {
            let mut sorted = list.to_vec();
            sorted.sort_by(f32::total_cmp);
            let at = |fraction: f64| sorted.get((fraction * sorted.len() as f64) as usize).copied();
            match at(0.5).zip(at(0.99)) {
                Some((median, most)) => {
                    format!("{} times, median {median:.1} ms, 99 of 100 within {most:.1} ms", sorted.len())
                }
                None => "never".to_owned(),
            }
        };
        let [work, text, picture] = [&self.work, &self.text, &self.picture].map(|list| summary(list));
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
        assert_eq!(times.to_string(), "work for a key: never; to its letter: never; to the picture: never");
        times.record_key(Some(1), at(0));
        times.taken += Duration::from_millis(1);
        times.record_shown(Some(1), true, Duration::from_millis(2), at(4));
        times.record_shown(Some(2), true, Duration::ZERO, at(20));
        times.record_key(Some(2), at(100));
        times.drafted = None;
        times.record_shown(Some(2), true, Duration::from_millis(3), at(102));
        times.record_shown(Some(3), true, Duration::ZERO, at(900));
        let text = "work for a key: 2 times, median 3.0 ms, 99 of 100 within 3.0 ms; \
                    to its letter: 2 times, median 4.0 ms, 99 of 100 within 4.0 ms; \
                    to the picture: 1 times, median 20.0 ms, 99 of 100 within 20.0 ms";
        assert_eq!(times.to_string(), text);
    }
}
