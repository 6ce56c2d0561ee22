//! Input of external controllers, and the panel that shows them.

use std::time::Instant;

use super::{Interface, Playback, Session};
use crate::clock;
use crate::commands::{self, Panel};
use crate::config::setting_limits;
use crate::export::print::print_message;
use crate::session::screen::Screen;
use crate::ui::open_panel::OpenPanel;
use mariana_control::action::Action;
use mariana_control::midi::{Outcome, Target};
use mariana_control::{InputBatch, Present};

impl Session {
    /// Applies the parameter changes of controllers. Returns their other actions, and when the oldest input arrived.
    pub(super) fn apply_input(&mut self) -> (Vec<Action>, Option<Instant>) {
        if let Some((sentence, is_bad)) = self.playback.controllers.news() {
            print_message(&sentence);
            if is_bad {
                self.playback.reports.announce(sentence);
            }
        }
        let now = clock::now();
        let batch = self.playback.controllers.drain(now);
        let is_turned = batch.is_some();
        let InputBatch { params, mut actions, knobs, since } = batch.unwrap_or_default();
        let before = self.playback.scene.revision();
        for change in &params {
            if !self.playback.scene.turn(change) {
                self.playback.controllers.input_queue.refuse(1);
            }
        }
        let mut levels = Vec::new();
        if !knobs.is_empty() {
            let tempo = Some(self.playback.tempo()).filter(|tempo| *tempo > 0.0);
            levels.extend(commands::levels(&self.state()));
            levels.extend(tempo.map(|tempo| ("tempo", tempo)));
        }
        let outcomes = self.playback.controllers.midi.apply(&knobs, &self.playback.scene, &levels);
        let learned = self.playback.controllers.midi.finish_learning();
        for outcome in outcomes {
            match outcome {
                Outcome::Turn(change) => drop(self.playback.scene.turn(&change)),
                Outcome::Act(action) => actions.push(action),
                Outcome::Waits { name, leads_to, stands } => {
                    let way = if leads_to < stands { "up" } else { "down" };
                    let words = format!("{name}: turn {way} to {:.0} %", 100.0 * stands);
                    self.playback.reports.answer_fraction(words, Some(leads_to));
                }
            }
        }
        if self.playback.scene.revision() != before {
            self.playback.controllers.record_turned(since, self.playback.scene.revision());
        } else if self.playback.scene.parameters_in_hand().are_turning() {
            // The parameter moves gradually and still has its old value. The frame `before + 1` shows the first step.
            self.playback.controllers.record_turned(since, before + 1);
        }
        self.playback.reports.answer_any(learned);
        self.playback.listening.set_clock(self.playback.controllers.midi.clock());
        self.put_up_board(is_turned, now);
        (actions, since)
    }

    /// Notes that the actions of controllers have changed the scene, if its revision is no longer `before`.
    pub(super) fn record_actions(&mut self, since: Option<Instant>, before: u64) {
        let revision = self.playback.scene.revision();
        if revision != before {
            self.playback.controllers.record_turned(since, revision);
        }
    }

    fn put_up_board(&mut self, turned: bool, now: Instant) {
        if !self.playback.controllers.board_is_due(turned, now) {
            return;
        }
        let state = self.state();
        let (switches, levels) = (commands::switches(&state), commands::levels(&state));
        let tempo = self.playback.tempo();
        let scene = self.playback.scene.parameters_in_hand().title().unwrap_or_default();
        if self.playback.controllers.wants_scenes(&scene) {
            let scenes = self.playback.numbered_scenes();
            self.playback.controllers.scenes =
                (scene.clone(), scenes.into_iter().map(|source| (source.title(), source)).collect());
        }
        let playing = &self.playback.reports.playing;
        let track = match &playing.artist {
            Some(artist) => format!("{artist} – {}", playing.title),
            None => playing.title.clone(),
        };
        let length = playing.duration.unwrap_or_default();
        let controllers = &self.playback.controllers;
        let scenes = controllers.scenes.1.iter().map(|(title, _)| title.clone()).collect();
        let params = self.playback.scene.parameters_in_hand().sliders().to_vec();
        let present = Present { scene, scenes, params, switches, levels, tempo, track, length };
        controllers.board.put(present);
    }
}

impl Playback {
    /// Beats per minute; 0 while unknown.
    pub(super) fn tempo(&self) -> f32 {
        self.pace.shown.map_or(0.0, |shown| shown.moment.features.tempo)
    }

    pub(crate) fn follows(&self) -> bool {
        self.direction.follows(self.listening.playing())
    }

    pub(super) fn set_fade(&mut self, seconds: f32) {
        let seconds = f64::from(seconds).clamp(0.0, setting_limits::FADE_SECONDS_MAX);
        self.reports.answer(self.scene.composer.fading.set_seconds(seconds));
    }

    pub(super) fn seek_to_fraction(&mut self, screen: &mut dyn Screen, fraction: f32) {
        self.with_song(|player| {
            if let Some(duration) = player.status().track.duration {
                player.seek_to(f64::from(fraction) * duration);
            }
        });
        self.answer_position(screen);
    }
}

impl Interface {
    pub(super) fn update_controllers(&mut self, playback: &mut Playback) {
        if self.ui_state.panels.open == Some(Panel::Controllers)
            && playback.controllers.panel_is_due(clock::now())
        {
            self.put_up_controllers(playback);
        }
    }

    pub(super) fn put_up_controllers(&mut self, playback: &mut Playback) {
        if let Some(OpenPanel::Controllers(panel)) = &mut self.ui_state.panel {
            let scene = playback.scene.parameters_in_hand().title().unwrap_or_default();
            panel.update(&playback.controllers.facts(scene, playback.scene.parameters_in_hand().sliders()));
        }
    }

    pub(super) fn start_learning(&mut self, playback: &mut Playback, target: Target) {
        if let Some(why) = playback.controllers.midi_trouble() {
            return playback
                .reports
                .answer(format!("cannot learn a knob, because MIDI is not available: {why}"));
        }
        playback.controllers.midi.start_learning(target);
        self.put_up_controllers(playback);
    }
}
