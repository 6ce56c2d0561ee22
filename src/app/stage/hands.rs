//! What hands from outside do on the stage.

use std::time::Instant;

use super::Stage;
use crate::app::frame_times::FrameTimes;
use crate::app::hands::deeds;
use crate::app::hands::panel::HandsRequest;
use crate::app::keys::Action;
use crate::app::overlay::Panel;
use crate::config::KnobEdit;
use crate::export::print::tell;
use crate::limits::LIMITS;
use mariana_control::deed::{Deed, Given};
use mariana_control::midi::{Outcome, Target};
use mariana_control::{Heard, Present};

impl Stage {
    /// Turns what hands wish to turn, and returns what they wish to be done.
    pub(in crate::app) fn take_wishes(&mut self) -> Vec<Deed> {
        if let Some((sentence, is_bad)) = self.hands.news() {
            tell(&sentence);
            if is_bad {
                self.reports.say(sentence);
            }
        }
        let now = Instant::now();
        let heard = self.hands.take(now);
        let is_turned = heard.is_some();
        let Heard { params, mut deeds, knobs, since } = heard.unwrap_or_default();
        let before = self.scene.revision();
        for wish in &params {
            if !self.scene.shown_parameters_mut().turn(wish) {
                self.hands.note_unknown();
            }
        }
        let (outcomes, learned) = self.hands.take_knobs(&knobs, &self.scene);
        for outcome in outcomes {
            match outcome {
                Outcome::Turn(wish) => drop(self.scene.shown_parameters_mut().turn(&wish)),
                Outcome::Act(deed) => deeds.push(deed),
                Outcome::Waits { name, leads_to, stands } => {
                    let way = if leads_to < stands { "up" } else { "down" };
                    let words = format!("{name}: turn {way} to {:.0} %", 100.0 * stands);
                    self.reports.answer_share(words, Some(leads_to));
                }
            }
        }
        if self.scene.revision() != before {
            self.hands.note_turned(since, self.scene.revision());
        } else if self.scene.shown_parameters().are_turning() {
            // It begins where it was, and the next picture shows it a little further.
            self.hands.note_turned(since, before + 1);
        }
        self.answer(learned);
        self.listening.set_clock(self.hands.clock());
        self.put_up_board(is_turned, now);
        deeds
    }

    /// Puts up how the show stands for those who ask, if it is time.
    fn put_up_board(&mut self, turned: bool, now: Instant) {
        if !self.hands.board_is_due(turned, now) {
            return;
        }
        let (switches, levels) = (deeds::switches(self), deeds::levels(self));
        let tempo = self.pace.shown().map_or(0.0, |shown| shown.moment.features.tempo);
        let scene = self.scene.scenes().name().unwrap_or_default();
        if self.hands.wants_scenes(&scene) {
            let scenes = self.numbered_scenes();
            self.hands.note_scenes(scene.clone(), scenes);
        }
        let playing = self.reports.playing();
        let track = match &playing.artist {
            Some(artist) => format!("{artist} – {}", playing.title),
            None => playing.title.clone(),
        };
        let length = playing.duration.unwrap_or_default();
        let present = Present { scene, switches, levels, tempo, track, length, ..Present::default() };
        self.hands.put_up(present, self.scene.scenes().sliders());
    }

    /// Does what a hand wishes for, as far as it is no key's; else returns what that key does, if there is something to
    /// do.
    pub(in crate::app) fn obey_deed(&mut self, deed: &Deed) -> Option<Action> {
        match deeds::does(deed.name)? {
            deeds::Does::Key(action) => Some(action),
            deeds::Does::Switch { action, is_on } => {
                let wanted = match deed.given {
                    Given::Number(number) => Some(number >= 0.5),
                    _ => None,
                };
                let is_so = wanted.is_some() && wanted == Some(is_on(self));
                (!is_so).then_some(action)
            }
            deeds::Does::Turn { set, is_on } => {
                let wanted = match deed.given {
                    Given::Number(number) => number >= 0.5,
                    _ => !is_on(self),
                };
                set(self, wanted);
                None
            }
            deeds::Does::Set(set) | deeds::Does::Level { set, .. } => {
                set(self, &deed.given);
                None
            }
        }
    }

    /// How long it took from messages to the frames that show them, for the log.
    pub(in crate::app) fn message_times(&self) -> &FrameTimes {
        self.hands.times()
    }

    /// When there is something to do for hands.
    pub(in crate::app) fn hands_due(&self) -> Option<Instant> {
        self.hands.due()
    }

    /// Whether the user wants a pause.
    pub(in crate::app) fn is_paused(&self) -> bool {
        self.listening.is_paused()
    }

    /// Whether the song is muted.
    pub(in crate::app) fn is_muted(&mut self) -> bool {
        self.listening.with_song(|player| player.status().muted).unwrap_or_default()
    }

    /// Whether scenes follow the song.
    pub(in crate::app) fn follows(&self) -> bool {
        self.direction.follows(self.listening.playing())
    }

    /// Whether the picture is black, or on its way there.
    pub(in crate::app) fn is_black(&self) -> bool {
        self.masters.is_black()
    }

    /// Whether the picture is held.
    pub(in crate::app) fn is_frozen(&self) -> bool {
        self.masters.is_frozen()
    }

    /// Whether no words and panels show.
    pub(in crate::app) fn is_bare(&self) -> bool {
        self.desk.bare
    }

    /// Which share of their light pictures have, 0..1.
    pub(in crate::app) fn brightness(&self) -> Option<f32> {
        Some(f32::from(self.choices.stage.brightness) / 100.0)
    }

    /// How much of the song has passed, 0..1.
    pub(in crate::app) fn song_share(&self) -> Option<f32> {
        self.reports.playing().share()
    }

    /// The volume of the song, 0..1.
    pub(in crate::app) fn volume(&self) -> Option<f32> {
        let playing = self.reports.playing();
        (!playing.live).then_some(playing.volume)
    }

    /// Shows pictures with this share of their light, 0..1, in this run.
    pub(in crate::app) fn dim(&mut self, given: &Given) {
        if let Given::Number(share) = given {
            self.set_brightness(100.0 * f64::from(*share), false);
        }
    }

    /// Goes to a scene by its title, or by its number from 1, marked ones first.
    pub(in crate::app) fn show_scene_named(&mut self, given: &Given) {
        match given {
            Given::Text(name) => {
                match self.scene.library().all_sources().into_iter().find(|scene| scene.title() == *name) {
                    Some(scene) => self.scene.show_source(scene),
                    None => self.reports.answer(format!("there is no scene '{name}': B shows them all")),
                }
            }
            // What is no number of a scene is beyond the list.
            Given::Number(number) => self.show_scene_at((number.round() as usize).wrapping_sub(1)),
            Given::Nothing => {}
        }
    }

    /// Cuts from scene to scene where hands change them, or lets them fade.
    pub(in crate::app) fn cut_by_hand(&mut self, cuts: bool) {
        let words = self.scene.composer_mut().fading_mut().set_cuts(cuts);
        self.reports.answer(words);
    }

    /// Lets a fade from scene to scene by hand take so many seconds.
    pub(in crate::app) fn set_fade(&mut self, given: &Given) {
        if let Given::Number(seconds) = given {
            let words = self
                .scene
                .composer_mut()
                .fading_mut()
                .set_seconds(f64::from(*seconds).clamp(0.0, LIMITS.fade_seconds_max));
            self.reports.answer(words);
        }
    }

    /// Sets the tempo, or gives it back to what is heard.
    pub(in crate::app) fn set_tempo(&mut self, given: &Given) {
        let tempo = match given {
            Given::Number(tempo) if *tempo > 0.0 => Some(f64::from(*tempo)),
            _ => None,
        };
        let words = self.listening.set_tempo(tempo);
        self.answer(words);
    }

    /// Goes to a share of the track, 0..1.
    pub(in crate::app) fn seek_to_share(&mut self, given: &Given) {
        let Given::Number(share) = *given else { return };
        self.with_song(|player| {
            if let Some(duration) = player.status().track.duration {
                player.seek_to(f64::from(share) * duration);
            }
        });
        self.answer_position();
    }

    /// Sets the volume, 0..1.
    pub(in crate::app) fn set_volume(&mut self, given: &Given) {
        let Given::Number(volume) = *given else { return };
        self.change_volume(|player| player.set_volume(volume));
    }

    /// Opens the panel of knobs from outside, or closes it; then nothing is learned any more.
    pub(super) fn show_hands(&mut self, open: bool) {
        if open {
            self.desk.hands.get_or_insert_default();
            self.put_up_hands();
        } else if self.desk.hands.take().is_some() {
            self.hands.stop_learning();
        }
    }

    /// Brings the panel up to date, if it is open.
    pub(super) fn update_hands(&mut self) {
        if self.desk.hands.is_some() && self.hands.panel_is_due(Instant::now()) {
            self.put_up_hands();
        }
    }

    fn put_up_hands(&mut self) {
        if let Some(panel) = &mut self.desk.hands {
            let scene = self.scene.scenes().name().unwrap_or_default();
            panel.update(&self.hands.facts(scene, self.scene.scenes().sliders()));
        }
    }

    /// Does what was asked of the panel.
    pub(super) fn obey_in_hands(&mut self, request: HandsRequest) {
        match request {
            HandsRequest::Learn(target) => self.learn(target),
            HandsRequest::Change(before, after) => self.hands.edit(&KnobEdit::Change(before, after)),
            HandsRequest::Remove(mapping) => self.hands.edit(&KnobEdit::Remove(mapping)),
            HandsRequest::Clock(on) => self.hands.edit(&KnobEdit::Clock(on)),
            HandsRequest::Close => return self.toggle_panel(Panel::Hands),
        }
        self.update_hands();
    }

    /// Learns what turns a parameter of the scene on the stage, or stops.
    pub(super) fn learn_param(&mut self, name: String) {
        let scene = self.scene.scenes().name().unwrap_or_default();
        self.learn(Target::Param { scene, name });
        self.update_hands();
    }

    fn learn(&mut self, target: Target) {
        if let Some(why) = self.hands.midi_trouble() {
            return self.reports.answer(format!("no knob can be learned, because there is no MIDI: {why}"));
        }
        self.hands.learn(target);
    }
}
