//! The reports of a session: over the frame, in the title, on the terminal and to the desktop.

use std::time::{Duration, Instant};

use crate::clock;
use crate::commands::Command;
use crate::export::print::print_message;
use crate::session::announcer::Announcer;
use crate::session::desktop::DesktopControls;
use crate::ui::overlay::{Notice, NowPlaying};
use mariana_player::PlayerStatus;
use mariana_player::input::LiveStatus;

const INTERVAL: Duration = Duration::from_millis(100);

pub(crate) struct Reports {
    announcer: Announcer,
    desktop: Box<dyn DesktopControls>,
    pub(crate) due: Instant,
    reported_silent: bool,
    reported_refused: Option<String>,
    title: String,
    pub(crate) playing: NowPlaying,
}

impl Reports {
    pub(crate) fn new(announcer: Announcer, desktop: Box<dyn DesktopControls>, now: Instant) -> Self {
        Self {
            announcer,
            desktop,
            due: now,
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

    pub(crate) fn command_of_desktop(&self) -> Option<Command> {
        self.desktop.poll()
    }

    pub(crate) fn answer(&mut self, text: impl Into<String>) {
        self.announcer.answer(text);
    }

    pub(crate) fn answer_fraction(&mut self, text: String, fraction: Option<f32>) {
        self.announcer.answer_fraction(text, fraction);
    }

    pub(crate) fn answer_position(&mut self) {
        self.announcer.answer_position(&self.playing);
    }

    pub(crate) fn announce(&mut self, text: impl Into<String>) {
        self.announcer.announce(text);
    }

    /// Shows the next notice once the last one has faded. Notices wait while they are not `seen`.
    pub(crate) fn update(&mut self, now: Instant, seen: bool) {
        if seen {
            self.announcer.update(now);
        }
    }

    pub(crate) fn notice(&self) -> Option<Notice<'_>> {
        self.announcer.notice()
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
                self.announcer.answer(reason.clone());
            }
        }
    }

    /// Reports news about the song, over the frame and to the desktop. `started` is true after the first frame.
    pub(crate) fn report_song(&mut self, status: &PlayerStatus, started: bool, fullscreen: bool) {
        self.playing = NowPlaying::of_song(status);
        self.announcer.follow(&self.playing);
        self.announcer.report(status);
        self.desktop.show(status, started, fullscreen);
    }

    pub(crate) fn report_input(&mut self, status: &LiveStatus, paused: bool) {
        self.playing = NowPlaying::of_input(status, paused);
        self.announcer.follow(&self.playing);
    }

    /// Returns `title` if it has changed, because some window systems are slow to set a title.
    pub(crate) fn changed_title(&mut self, title: String) -> Option<&str> {
        let is_new = title != self.title;
        self.title = title;
        is_new.then_some(&*self.title)
    }
}
