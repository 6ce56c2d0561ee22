//! What hands from outside do on the stage.

use std::time::Instant;

use super::{Interface, Playback, Session};
use crate::clock;
use crate::commands;
use crate::config::SETTING_LIMITS;
use crate::export::print::tell;
use crate::session::frame_times::FrameTimes;
use crate::session::screen::Screen;
use mariana_control::deed::Deed;
use mariana_control::midi::{Outcome, Target};
use mariana_control::{Heard, Present};

impl Session {
    /// Turns what hands wish to turn, and returns what they wish to be done.
    pub(super) fn take_wishes(&mut self) -> Vec<Deed> {
        if let Some((sentence, is_bad)) = self.playback.hands.news() {
            tell(&sentence);
            if is_bad {
                self.playback.reports.say(sentence);
            }
        }
        let now = clock::now();
        let heard = self.playback.hands.take(now);
        let is_turned = heard.is_some();
        let Heard { params, mut deeds, knobs, since } = heard.unwrap_or_default();
        let before = self.playback.scene.revision();
        for wish in &params {
            if !self.playback.scene.shown_parameters_mut().turn(wish) {
                self.playback.hands.note_unknown();
            }
        }
        let (outcomes, learned) = self.playback.hands.take_knobs(&knobs, &self.playback.scene);
        for outcome in outcomes {
            match outcome {
                Outcome::Turn(wish) => drop(self.playback.scene.shown_parameters_mut().turn(&wish)),
                Outcome::Act(deed) => deeds.push(deed),
                Outcome::Waits { name, leads_to, stands } => {
                    let way = if leads_to < stands { "up" } else { "down" };
                    let words = format!("{name}: turn {way} to {:.0} %", 100.0 * stands);
                    self.playback.reports.answer_share(words, Some(leads_to));
                }
            }
        }
        if self.playback.scene.revision() != before {
            self.playback.hands.note_turned(since, self.playback.scene.revision());
        } else if self.playback.scene.shown_parameters().are_turning() {
            // It begins where it was, and the next picture shows it a little further.
            self.playback.hands.note_turned(since, before + 1);
        }
        self.playback.answer(learned);
        self.playback.listening.set_clock(self.playback.hands.clock());
        self.put_up_board(is_turned, now);
        deeds
    }

    /// Puts up how the show stands for those who ask, if it is time.
    fn put_up_board(&mut self, turned: bool, now: Instant) {
        if !self.playback.hands.board_is_due(turned, now) {
            return;
        }
        let state = self.state();
        let (switches, levels) = (commands::switches(&state), commands::levels(&state));
        let tempo = self.playback.pace.shown().map_or(0.0, |shown| shown.moment.features.tempo);
        let scene = self.playback.scene.scenes().name().unwrap_or_default();
        if self.playback.hands.wants_scenes(&scene) {
            let scenes = self.playback.numbered_scenes();
            self.playback.hands.note_scenes(scene.clone(), scenes);
        }
        let playing = self.playback.reports.playing();
        let track = match &playing.artist {
            Some(artist) => format!("{artist} – {}", playing.title),
            None => playing.title.clone(),
        };
        let length = playing.duration.unwrap_or_default();
        let present = Present { scene, switches, levels, tempo, track, length, ..Present::default() };
        self.playback.hands.put_up(present, self.playback.scene.scenes().sliders());
    }
}

impl Playback {
    /// How long it took from messages to the frames that show them, for the log.
    pub(super) fn message_times(&self) -> &FrameTimes {
        self.hands.times()
    }

    /// When there is something to do for hands.
    pub(super) fn hands_due(&self) -> Option<Instant> {
        self.hands.due()
    }

    /// Whether scenes follow the song.
    pub(crate) fn follows(&self) -> bool {
        self.direction.follows(self.listening.playing())
    }

    /// Lets a fade from scene to scene by hand take so many seconds.
    pub(super) fn set_fade(&mut self, seconds: f32) {
        let seconds = f64::from(seconds).clamp(0.0, SETTING_LIMITS.fade_seconds_max);
        let words = self.scene.composer_mut().fading_mut().set_seconds(seconds);
        self.reports.answer(words);
    }

    /// Goes to a share of the track, 0..1.
    pub(super) fn seek_to_share(&mut self, screen: &mut dyn Screen, share: f32) {
        self.with_song(|player| {
            if let Some(duration) = player.status().track.duration {
                player.seek_to(f64::from(share) * duration);
            }
        });
        self.answer_position(screen);
    }
}

impl Interface {
    /// Opens the panel of knobs from outside, or closes it; then nothing is learned any more.
    pub(super) fn show_hands(&mut self, playback: &mut Playback, open: bool) {
        if open {
            self.desk.hands.get_or_insert_default();
            self.put_up_hands(playback);
        } else if self.desk.hands.take().is_some() {
            playback.hands.stop_learning();
        }
    }

    /// Brings the panel up to date, if it is open.
    pub(super) fn update_hands(&mut self, playback: &mut Playback) {
        if self.desk.hands.is_some() && playback.hands.panel_is_due(clock::now()) {
            self.put_up_hands(playback);
        }
    }

    fn put_up_hands(&mut self, playback: &mut Playback) {
        if let Some(panel) = &mut self.desk.hands {
            let scene = playback.scene.scenes().name().unwrap_or_default();
            panel.update(&playback.hands.facts(scene, playback.scene.scenes().sliders()));
        }
    }

    /// Learns which knob turns something, or stops learning it.
    pub(super) fn learn(&mut self, playback: &mut Playback, target: Target) {
        if let Some(why) = playback.hands.midi_trouble() {
            return playback
                .reports
                .answer(format!("no knob can be learned, because there is no MIDI: {why}"));
        }
        playback.hands.learn(target);
        self.update_hands(playback);
    }
}
