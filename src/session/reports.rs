//! What the show reports while it plays: over the picture, in the title, on the terminal, to the desktop.

use std::time::{Duration, Instant};

use crate::clock;
use crate::commands::Command;
use crate::export::print::tell;
use crate::session::announcer::Announcer;
use crate::session::desktop::DesktopControls;
use crate::ui::overlay::{Notice, NowPlaying};
use mariana_player::PlayerStatus;
use mariana_player::input::LiveStatus;

/// How often the state of the sound is looked at.
const INTERVAL: Duration = Duration::from_millis(100);

/// See the module.
pub(crate) struct Reports {
    announcer: Announcer,
    desktop: Box<dyn DesktopControls>,
    /// When the state of the sound is to be looked at.
    due: Instant,
    /// Whether it was told that there is no sound.
    reported_silent: bool,
    /// Why the last choice of an output was refused, if it was.
    reported_refused: Option<String>,
    /// The window's title.
    title: String,
    playing: NowPlaying,
}

impl Reports {
    /// Begins with what `announcer` has to say already.
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

    /// Whether the state of the sound is to be looked at now. If so, it is a while until it is again.
    pub(crate) fn is_due(&mut self, now: Instant) -> bool {
        let is_due = now >= self.due;
        if is_due {
            self.due = now + INTERVAL;
        }
        is_due
    }

    /// Looks at the state of the sound at once, because something was changed.
    pub(crate) fn hurry(&mut self) {
        self.due = clock::now();
    }

    /// The next command of media keys and the desktop, if any.
    pub(crate) fn command_of_desktop(&self) -> Option<Command> {
        self.desktop.poll()
    }

    /// Shows `text` over the picture at once.
    pub(crate) fn answer(&mut self, text: String) {
        self.announcer.answer(text);
    }

    /// The same with a share below the text, 0..1.
    pub(crate) fn answer_fraction(&mut self, text: String, fraction: Option<f32>) {
        self.announcer.answer_fraction(text, fraction);
    }

    /// Shows where in the track we are.
    pub(crate) fn answer_position(&mut self) {
        self.announcer.answer_position(&self.playing);
    }

    /// What played when it was last looked at.
    pub(crate) fn playing(&self) -> &NowPlaying {
        &self.playing
    }

    /// Shows `text` over the picture when there is room.
    pub(crate) fn say(&mut self, text: String) {
        self.announcer.say(text);
    }

    /// Makes room over the picture for the sentences that wait.
    pub(crate) fn update(&mut self, now: Instant) {
        self.announcer.update(now);
    }

    /// What shows over the picture.
    pub(crate) fn notice(&self) -> Option<Notice<'_>> {
        self.announcer.notice()
    }

    /// Tells once why an output that was chosen does not play, and why there is no sound, unless `silence_asked`. That the reason changes meanwhile (a server that has
    /// died has no devices either) is no news.
    pub(crate) fn tell_silence(&mut self, status: &PlayerStatus, silence_asked: bool) {
        if let Some(reason) = status.silent.as_ref().filter(|_| !silence_asked && !self.reported_silent) {
            tell(&format!("the song plays without sound: {reason}"));
        }
        self.reported_silent = status.silent.is_some();
        if self.reported_refused != status.refused {
            self.reported_refused.clone_from(&status.refused);
            if let Some(reason) = &status.refused {
                tell(reason);
                self.announcer.answer(reason.clone());
            }
        }
    }

    /// Reports what is new of the song, over the picture and to the desktop; `started` once it plays or could.
    pub(crate) fn look(&mut self, status: &PlayerStatus, started: bool, fullscreen: bool) {
        self.playing = NowPlaying::of_song(status);
        self.announcer.follow(&self.playing);
        self.announcer.look(status);
        self.desktop.show(status, started, fullscreen);
    }

    /// Notes what is new of the input.
    pub(crate) fn look_at_input(&mut self, status: &LiveStatus, paused: bool) {
        self.playing = NowPlaying::of_input(status, paused);
        self.announcer.follow(&self.playing);
    }

    /// The window's title, if it is another than before. (Window systems take their time for each.)
    pub(crate) fn changed_title(&mut self, title: String) -> Option<&str> {
        let is_new = title != self.title;
        self.title = title;
        is_new.then_some(&*self.title)
    }
}
