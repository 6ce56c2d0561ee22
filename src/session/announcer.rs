//! Notices, such as the names of tracks, shown over the frame one after another.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use crate::clock;
use crate::export::print::print_message;
use crate::ui::overlay::{Notice, NowPlaying};
use mariana_player::track::{Repeat, TrackInfo};
use mariana_player::{MissedAudio, PlayerStatus, SilenceEnd, TrackErrors};

/// Maximum number of waiting notices. The oldest notices are dropped first.
const WAITING_MAX: usize = 3;
/// Audio that a stopped device misses again and again, as on a busy computer, is reported this often.
const MISSED_EVERY: Duration = Duration::from_secs(600);
/// ... and when a part is this many times as long as the last reported part.
const MISSED_WORSE: f64 = 2.0;

#[derive(Default)]
pub(crate) struct Announcer {
    waiting: VecDeque<String>,
    shown: Option<Sentence>,
    track_errors: u64,
    missed_audio: u64,
    /// The last reported missed part, and when it was reported.
    missed: Option<(MissedAudio, Instant)>,
    track: Option<(u64, String)>,
}

struct Sentence {
    text: String,
    /// Length of the bar below the text, 0..1.
    fraction: Option<f32>,
    since: Instant,
    /// True if the notice shows the position in the track and is updated while it is visible.
    is_position: bool,
}

impl Sentence {
    fn new(text: String, fraction: Option<f32>, since: Instant) -> Self {
        Self { text, fraction, since, is_position: false }
    }
}

impl Announcer {
    /// Shows `text` after the current notices.
    pub(crate) fn announce(&mut self, text: impl Into<String>) {
        if self.waiting.len() == WAITING_MAX {
            self.waiting.pop_front();
        }
        self.waiting.push_back(text.into());
    }

    /// Shows `text` at once, replacing the current notice.
    pub(crate) fn answer(&mut self, text: impl Into<String>) {
        self.answer_fraction(text.into(), None);
    }

    pub(crate) fn answer_fraction(&mut self, text: String, fraction: Option<f32>) {
        tracing::debug!("answer: {text}");
        self.shown = Some(Sentence::new(text, fraction, clock::now()));
    }

    pub(crate) fn answer_position(&mut self, playing: &NowPlaying) {
        let since = clock::now();
        self.shown = Some(Sentence { is_position: true, ..position(playing, since) });
    }

    pub(crate) fn follow(&mut self, playing: &NowPlaying) {
        if let Some(shown) = self.shown.as_mut().filter(|shown| shown.is_position) {
            *shown = Sentence { is_position: true, ..position(playing, shown.since) };
        }
    }

    /// Announces a change of track. Reports new track errors and missed audio, over the frame and on the terminal.
    pub(crate) fn report(&mut self, status: &PlayerStatus) {
        self.report_track_errors(&status.track_errors);
        self.report_missed_audio(status.missed_audio);
        let track = (status.track.id, status.track.name.clone());
        if self.track.as_ref() != Some(&track) {
            // Do not announce the first track: the first notice, about the scene, names it too.
            if self.track.is_some() {
                self.answer(described(&status.track));
            }
            self.track = Some(track);
        }
    }

    fn report_track_errors(&mut self, track_errors: &TrackErrors) {
        let new = track_errors.count - self.track_errors.min(track_errors.count);
        let Some(last) = track_errors.last.as_ref().filter(|_| new > 0) else { return };
        self.track_errors = track_errors.count;
        let text = match new {
            1 => last.clone(),
            _ => format!("{new} track errors, the last error: {last}"),
        };
        print_message(&text);
        self.announce(text);
    }

    fn report_missed_audio(&mut self, missed_audio: MissedAudio) {
        if missed_audio.count == self.missed_audio {
            return;
        }
        self.missed_audio = missed_audio.count;
        let text = missed_audio.to_string();
        let is_repeated = self.missed.is_some_and(|(last, at)| {
            missed_audio.after == SilenceEnd::SameDevice
                && last.after == SilenceEnd::SameDevice
                && missed_audio.seconds < MISSED_WORSE * last.seconds
                && clock::since(at) < MISSED_EVERY
        });
        if is_repeated {
            return tracing::info!("{text}");
        }
        self.missed = Some((missed_audio, clock::now()));
        print_message(&text);
        self.announce(text);
    }

    /// Shows the next waiting notice once the current notice has faded.
    pub(crate) fn update(&mut self, now: Instant) {
        if self.notice().is_none_or(|notice| notice.is_gone(now)) {
            self.shown = self.waiting.pop_front().map(|text| Sentence::new(text, None, now));
        }
    }

    pub(crate) fn notice(&self) -> Option<Notice<'_>> {
        let shown = self.shown.as_ref()?;
        Some(Notice { text: &shown.text, fraction: shown.fraction, since: shown.since })
    }
}

fn position(playing: &NowPlaying, since: Instant) -> Sentence {
    let words = match (playing.live, playing.paused) {
        (false, false) => playing.times(),
        (false, true) => format!("paused · {}", playing.times()),
        (true, false) => "listening".to_owned(),
        (true, true) => "paused".to_owned(),
    };
    Sentence::new(words, playing.fraction().filter(|_| !playing.live), since)
}

fn described(track: &TrackInfo) -> String {
    match track.count {
        0 | 1 => track.name.clone(),
        count => format!("{} · {} of {count}", track.name, track.entry + 1),
    }
}

pub(crate) fn next_repeat(repeat: Repeat) -> Repeat {
    match repeat {
        Repeat::All => Repeat::One,
        Repeat::One => Repeat::Off,
        Repeat::Off => Repeat::All,
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct TrackOrder {
    /// The part of the list that is repeated.
    pub repeat: Repeat,
    pub shuffled: bool,
}

pub(crate) fn words_of(before: TrackOrder, after: TrackOrder) -> &'static str {
    match (before.shuffled, after.shuffled) {
        (false, true) => "tracks in random order",
        (true, false) => "tracks in list order",
        _ => match after.repeat {
            Repeat::All => "repeat all tracks",
            Repeat::One => "repeat this track",
            Repeat::Off => "end after the last track",
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(announcer: &Announcer) -> Option<&str> {
        announcer.shown.as_ref().map(|shown| shown.text.as_str())
    }

    #[test]
    fn missed_audio_is_reported_once() {
        let mut announcer = Announcer::default();
        let missed_audio = |count, seconds| MissedAudio { count, seconds, ..MissedAudio::default() };
        announcer.report_missed_audio(missed_audio(0, 0.0));
        assert_eq!(announcer.waiting, [""; 0]);
        announcer.report_missed_audio(missed_audio(1, 0.42));
        announcer.report_missed_audio(missed_audio(1, 0.42));
        assert_eq!(announcer.waiting, ["0.42 s of the song were not heard: the sound device changed"]);
    }

    #[test]
    fn a_device_that_stopped_again_and_again_was_reported_each_time() {
        clock::by_hand(|| {
            let mut announcer = Announcer::default();
            let mut count = 0;
            let mut miss = |seconds, after| {
                count += 1;
                announcer.report_missed_audio(MissedAudio { count, seconds, after });
                std::mem::take(&mut announcer.waiting).len()
            };
            let stopped = SilenceEnd::SameDevice;
            assert_eq!([0.5, 0.4, 0.6, 0.5].map(|seconds| miss(seconds, stopped)), [1, 0, 0, 0]);
            assert_eq!([1.5, 1.6].map(|seconds| miss(seconds, stopped)), [1, 0], "it has become worse");
            assert_eq!(miss(0.1, SilenceEnd::AnotherDevice), 1, "the user has changed the device");
            assert_eq!([0.5, 0.5].map(|seconds| miss(seconds, stopped)), [1, 0]);
            clock::advance(Duration::from_secs(601));
            assert_eq!([0.5, 0.5].map(|seconds| miss(seconds, stopped)), [1, 0]);
        });
    }

    #[test]
    fn a_requested_position_is_updated_until_a_newer_answer_replaces_it() {
        let mut announcer = Announcer::default();
        let mut playing = NowPlaying { position: 83.0, duration: Some(225.0), ..Default::default() };
        announcer.answer_position(&playing);
        playing.position = 90.0;
        announcer.follow(&playing);
        assert_eq!(text(&announcer), Some("1:30 / 3:45"));
        playing.paused = true;
        announcer.follow(&playing);
        assert_eq!(text(&announcer), Some("paused · 1:30 / 3:45"));
        announcer.answer_fraction("volume 65 %".into(), Some(0.65));
        announcer.follow(&playing);
        assert_eq!(announcer.notice().map(|notice| notice.fraction), Some(Some(0.65)));
        playing.live = true;
        announcer.answer_position(&playing);
        assert_eq!(announcer.notice().map(|notice| (notice.text, notice.fraction)), Some(("paused", None)));
    }

    #[test]
    fn notices_wait_for_each_other_and_many_errors_become_one_notice() {
        let mut announcer = Announcer::default();
        let track_errors = |count| TrackErrors { count, last: Some("x is gone".into()) };
        announcer.report_track_errors(&track_errors(1));
        announcer.report_track_errors(&track_errors(1));
        announcer.report_track_errors(&track_errors(400));
        let mut now = Instant::now();
        announcer.update(now);
        assert_eq!(text(&announcer), Some("x is gone"));
        announcer.update(now + Duration::from_millis(100));
        assert_eq!(text(&announcer), Some("x is gone"));
        now += Duration::from_secs(10);
        announcer.update(now);
        assert_eq!(text(&announcer), Some("399 track errors, the last error: x is gone"));
        (0..9).for_each(|n| announcer.announce(n.to_string()));
        now += Duration::from_secs(10);
        announcer.update(now);
        assert_eq!(text(&announcer), Some("6"));
        announcer.answer("now");
        assert_eq!(text(&announcer), Some("now"));
    }
}
