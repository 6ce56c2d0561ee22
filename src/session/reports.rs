//! The reports of a session: over the frame, in the title, on the terminal and to the desktop. Notices, such as the names
//! of tracks, are shown over the frame one after another.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use crate::clock;
use crate::export::print::print_message;
use crate::session::desktop::DesktopControls;
use crate::session::screen::Screen;
use crate::ui::overlay::{Notice, NowPlaying};
use mariana_player::input::LiveStatus;
use mariana_player::track::TrackInfo;
use mariana_player::{MissedAudio, PlayerStatus, SilenceEnd, TrackErrors};

const INTERVAL: Duration = Duration::from_millis(100);
/// Maximum number of waiting notices. The oldest notices are dropped first.
const WAITING_MAX: usize = 3;
/// Audio that a stopped device misses again and again, as on a busy computer, is reported this often.
const MISSED_EVERY: Duration = Duration::from_secs(600);
/// ... and when a part is this many times as long as the last reported part.
const MISSED_WORSE: f64 = 2.0;

pub(crate) struct Reports {
    pub(super) desktop: Box<dyn DesktopControls>,
    pub(crate) due: Instant,
    waiting: VecDeque<String>,
    shown: Option<Sentence>,
    track_errors: u64,
    missed_audio: u64,
    /// The last reported missed part, and when it was reported.
    missed: Option<(MissedAudio, Instant)>,
    track: Option<(u64, String)>,
    reported_silent: bool,
    reported_refused: Option<String>,
    title: String,
    pub(crate) playing: NowPlaying,
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

impl Reports {
    pub(crate) fn new(desktop: Box<dyn DesktopControls>, now: Instant) -> Self {
        Self {
            desktop,
            due: now,
            waiting: VecDeque::new(),
            shown: None,
            track_errors: 0,
            missed_audio: 0,
            missed: None,
            track: None,
            reported_silent: false,
            reported_refused: None,
            title: String::new(),
            playing: NowPlaying::default(),
        }
    }

    /// True if the state of the sound is to be checked now. Schedules the next check.
    pub(crate) fn is_due(&mut self, now: Instant) -> bool {
        let is_due = now >= self.due;
        if is_due {
            self.due = now + INTERVAL;
        }
        is_due
    }

    pub(crate) fn hurry(&mut self) {
        self.due = clock::now();
    }

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

    pub(crate) fn answer_any(&mut self, text: Option<impl Into<String>>) {
        text.into_iter().for_each(|text| self.answer(text));
    }

    pub(crate) fn answer_fraction(&mut self, text: String, fraction: Option<f32>) {
        tracing::debug!("answer: {text}");
        self.shown = Some(Sentence::new(text, fraction, clock::now()));
    }

    pub(crate) fn answer_position(&mut self) {
        let since = clock::now();
        self.shown = Some(Sentence { is_position: true, ..position(&self.playing, since) });
    }

    fn set_playing(&mut self, playing: NowPlaying) {
        self.playing = playing;
        if let Some(shown) = self.shown.as_mut().filter(|shown| shown.is_position) {
            *shown = Sentence { is_position: true, ..position(&self.playing, shown.since) };
        }
    }

    fn report_track_errors(&mut self, track_errors: &TrackErrors) {
        let new = track_errors.count - self.track_errors.min(track_errors.count);
        let Some(last) = track_errors.last.as_ref().filter(|_| new > 0) else { return };
        self.track_errors = track_errors.count;
        let text = match new {
            1 => last.clone(),
            _ => format!("{last}; {new} new track errors"),
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

    /// Shows the next waiting notice once the current notice has faded. Notices wait while they are not `seen`.
    pub(crate) fn update(&mut self, now: Instant, seen: bool) {
        if seen && self.notice().is_none_or(|notice| notice.is_gone(now)) {
            self.shown = self.waiting.pop_front().map(|text| Sentence::new(text, None, now));
        }
    }

    pub(crate) fn notice(&self) -> Option<Notice<'_>> {
        let shown = self.shown.as_ref()?;
        Some(Notice { text: &shown.text, fraction: shown.fraction, since: shown.since })
    }

    /// Reports once why the chosen output is not used. Unless `silence_asked`, also reports why there is no sound, but
    /// only the first reason: if the sound server dies, missing devices are a consequence.
    pub(crate) fn report_silence(&mut self, status: &PlayerStatus, silence_asked: bool) {
        if let Some(reason) = status.silent.as_ref().filter(|_| !silence_asked && !self.reported_silent) {
            print_message(&format!("the song plays without sound: {reason}"));
        }
        self.reported_silent = status.silent.is_some();
        if self.reported_refused != status.refused {
            self.reported_refused.clone_from(&status.refused);
            if let Some(reason) = &status.refused {
                print_message(reason);
                self.answer(reason.clone());
            }
        }
    }

    /// Announces a change of track. Reports track errors and missed audio, over the frame and on the terminal, and the
    /// state of the song to the desktop. `started` is true after the first frame.
    pub(crate) fn report_song(&mut self, status: &PlayerStatus, started: bool, fullscreen: bool) {
        self.set_playing(NowPlaying::of_song(status));
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
        self.desktop.show(status, started, fullscreen);
    }

    pub(crate) fn report_input(&mut self, status: &LiveStatus, paused: bool) {
        self.set_playing(NowPlaying::of_input(status, paused));
    }

    /// Sets the window's title if it has changed, because some window systems are slow to set a title.
    pub(crate) fn set_title(&mut self, screen: &mut dyn Screen, title: String) {
        if title != self.title {
            screen.set_title(&title);
            self.title = title;
        }
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

/// The window's title: track, program, notes on the scene, unusual states. Silence is unusual unless `silence_asked`.
pub(crate) fn title(scene: Vec<String>, status: &PlayerStatus, silence_asked: bool) -> String {
    let track = &status.track;
    let mut title = format!("{} - Mariana", track.name);
    let mut notes = Vec::new();
    if track.count > 1 {
        notes.push(format!("{}/{}", track.entry + 1, track.count));
    }
    notes.extend(scene);
    if status.paused {
        notes.push("paused".to_owned());
    }
    if status.muted {
        notes.push("muted".to_owned());
    } else if status.volume < 0.995 {
        notes.push(format!("volume {:.0} %", status.volume * 100.0));
    }
    if status.silent.is_some() && !silence_asked {
        notes.push("no sound device".to_owned());
    }
    if !notes.is_empty() {
        title.push_str(&format!(" ({})", notes.join(", ")));
    }
    title
}

pub(crate) fn live_title(status: &LiveStatus, scene: Vec<String>, paused: bool) -> String {
    let mut notes = scene;
    if paused {
        notes.push("paused".to_owned());
    }
    notes.push(if status.silent.is_some() { "no sound".to_owned() } else { "live".to_owned() });
    format!("{} - Mariana ({})", status.name, notes.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::Command;

    struct NoDesktop;

    impl DesktopControls for NoDesktop {
        fn poll(&self) -> Option<Command> {
            None
        }

        fn show(&self, _: &PlayerStatus, _: bool, _: bool) {}
    }

    fn reports() -> Reports {
        Reports::new(Box::new(NoDesktop), clock::now())
    }

    fn text(reports: &Reports) -> Option<&str> {
        reports.shown.as_ref().map(|shown| shown.text.as_str())
    }

    #[test]
    fn missed_audio_is_reported_once() {
        let mut reports = reports();
        let missed_audio = |count, seconds| MissedAudio { count, seconds, ..MissedAudio::default() };
        reports.report_missed_audio(missed_audio(0, 0.0));
        assert_eq!(reports.waiting, [""; 0]);
        reports.report_missed_audio(missed_audio(1, 0.42));
        reports.report_missed_audio(missed_audio(1, 0.42));
        assert_eq!(reports.waiting, ["0.42 s of the song were not heard: the sound device changed"]);
    }

    #[test]
    fn a_device_that_stopped_again_and_again_was_reported_each_time() {
        clock::by_hand(|| {
            let mut reports = reports();
            let mut count = 0;
            let mut miss = |seconds, after| {
                count += 1;
                reports.report_missed_audio(MissedAudio { count, seconds, after });
                std::mem::take(&mut reports.waiting).len()
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
        let mut reports = reports();
        let mut playing = NowPlaying { position: 83.0, duration: Some(225.0), ..Default::default() };
        reports.set_playing(playing.clone());
        reports.answer_position();
        playing.position = 90.0;
        reports.set_playing(playing.clone());
        assert_eq!(text(&reports), Some("1:30 / 3:45"));
        playing.paused = true;
        reports.set_playing(playing.clone());
        assert_eq!(text(&reports), Some("paused · 1:30 / 3:45"));
        reports.answer_fraction("volume 65 %".into(), Some(0.65));
        reports.set_playing(playing.clone());
        assert_eq!(reports.notice().map(|notice| notice.fraction), Some(Some(0.65)));
        playing.live = true;
        reports.set_playing(playing);
        reports.answer_position();
        assert_eq!(reports.notice().map(|notice| (notice.text, notice.fraction)), Some(("paused", None)));
    }

    #[test]
    fn notices_wait_for_each_other_and_many_errors_become_one_notice() {
        let mut reports = reports();
        let track_errors = |count| TrackErrors { count, last: Some("x is gone".into()) };
        reports.report_track_errors(&track_errors(1));
        reports.report_track_errors(&track_errors(1));
        reports.report_track_errors(&track_errors(400));
        let mut now = Instant::now();
        reports.update(now, true);
        assert_eq!(text(&reports), Some("x is gone"));
        reports.update(now + Duration::from_millis(100), true);
        assert_eq!(text(&reports), Some("x is gone"));
        now += Duration::from_secs(10);
        reports.update(now, true);
        assert_eq!(text(&reports), Some("x is gone; 399 new track errors"));
        (0..9).for_each(|n| reports.announce(n.to_string()));
        now += Duration::from_secs(10);
        reports.update(now, true);
        assert_eq!(text(&reports), Some("6"));
        reports.answer("now");
        assert_eq!(text(&reports), Some("now"));
    }
}
