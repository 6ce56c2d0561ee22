//! What the hands on a show do to every picture alike: blackout, brightness, holding it, where it lies, and nothing over
//! it.

use std::time::Instant;

use winit::keyboard::{Key, ModifiersState};

use super::Stage;
use crate::app::corner_hands::{CornerHands, Moved};
use crate::app::overlay::{Panel, PanelSwitches};
use crate::placement::{Corners, Placement};
use crate::scenes::SceneSource;
use crate::show::Picture;

impl Stage {
    /// Lets the picture fade to black, or come back.
    pub(in crate::app) fn toggle_blackout(&mut self) {
        let words = match self.masters.toggle_blackout(Instant::now()) {
            true => "blackout: X brings the picture back",
            false => "the picture comes back",
        };
        self.reports.answer(words.to_owned());
    }

    /// Holds the picture that shows while the song goes on, or lets it go.
    pub(in crate::app) fn toggle_freeze(&mut self) {
        let words = match self.masters.toggle_freeze() {
            true => {
                self.scene.composer_mut().give_picture_up();
                "the picture is held: Z lets it go"
            }
            false => {
                self.scene.fade_from_held(self.masters.fade_seconds());
                "the picture goes on"
            }
        };
        self.reports.answer(words.to_owned());
    }

    /// Whether the picture that shows is held.
    pub(super) fn holds_picture(&self) -> bool {
        self.masters.hold() && self.pace.shown().is_some()
    }

    /// Does to whole pictures what the show does to them at `time` seconds of the song.
    pub(super) fn follow_masters(&mut self, time: f64) {
        let shown = self.scene.show().picture_at(time);
        let before = self.masters.follow_show(shown);
        let share = |picture: Picture| picture.held.map(|held| held.share);
        let (was, is) = (share(before), share(shown));
        if was == is || self.masters.is_frozen() {
            return;
        }
        let since = |picture: Picture| picture.held.map(|held| held.since);
        if since(before) != since(shown) {
            self.scene.composer_mut().fading_mut().hold_anew();
        }
        match is {
            // It is held as it is.
            Some(1.0..) => self.scene.composer_mut().give_picture_up(),
            share => self.scene.composer_mut().mix_held(share),
        }
    }

    /// Whether the picture that shows is brighter or darker than it is to be.
    pub(super) fn is_dimming(&self, now: Instant) -> bool {
        self.pace.shown().is_some() && self.masters.gain(now) != self.renderer.gain()
    }

    /// Hides every word and panel until this is called again.
    pub(in crate::app) fn toggle_clean(&mut self) {
        self.desk.bare = !self.desk.bare;
        self.window.request_redraw();
        if self.desk.bare {
            self.desk.panels = PanelSwitches::default();
            self.leave_panels();
        } else {
            self.reports.answer("words and panels show again".to_owned());
        }
    }

    /// All scenes in the order of their numbers: marked ones first.
    pub(super) fn numbered_scenes(&self) -> Vec<SceneSource> {
        let marks = &self.listening.settings().favourite_scenes;
        let scenes = self.scene.library().all_sources();
        let (marked, others): (Vec<_>, Vec<_>) =
            scenes.into_iter().partition(|scene| marks.contains(&scene.title()));
        marked.into_iter().chain(others).collect()
    }

    /// Shows the scene at a place of the list of scenes, marked ones first, from 0.
    pub(in crate::app) fn show_scene_at(&mut self, place: usize) {
        let scenes = self.numbered_scenes();
        let count = scenes.len();
        match scenes.into_iter().nth(place) {
            Some(scene) => self.scene.show_source(scene),
            None => {
                let words = format!("there is no scene {} among these {count}: B shows them", place + 1);
                self.reports.answer(words);
            }
        }
    }

    /// Lets the corners of the picture be moved, or is done with that.
    pub(in crate::app) fn toggle_corners(&mut self) {
        self.toggle_panel(Panel::Corners);
    }

    /// Where the picture lies on its screen.
    pub(super) fn placement(&self) -> Placement {
        self.choices.stage.placement()
    }

    /// Shows pictures with so many percent of their light, and remembers it once that is `settled`.
    pub(super) fn set_brightness(&mut self, percent: f64, settled: bool) {
        let percent = percent.round().clamp(0.0, 100.0) as u8;
        self.masters.set_brightness(f32::from(percent) / 100.0);
        self.choices.stage.brightness = percent;
        if settled {
            self.choose(move |choices| choices.stage.brightness = percent);
        }
    }

    /// Lets the corners be moved, or no longer.
    pub(super) fn show_corners(&mut self, open: bool) {
        if !open && self.desk.corners.is_some() {
            // One may still be held.
            self.remember_corners();
        }
        self.desk.corners = open.then(|| CornerHands::new(self.choices.stage.corners));
        self.window.request_redraw();
    }

    /// Moves a corner of the picture to a place of its screen, and remembers it once that is `settled`. A place at which
    /// nothing could be drawn is left out.
    pub(super) fn move_corner(&mut self, corner: usize, place: [f64; 2], settled: bool) {
        // Finer than a pixel is no use to anybody.
        let place = place.map(|share| (share * 1e4).round() / 1e4);
        if let Some(corners) = self.choices.stage.corners.with(corner, place) {
            self.choices.stage.corners = corners;
        }
        let corners = self.choices.stage.corners;
        if let Some(hands) = &mut self.desk.corners {
            hands.take(corner, corners);
        }
        if settled {
            self.remember_corners();
        }
        self.output.look_different();
        self.window.request_redraw();
    }

    fn remember_corners(&mut self) {
        let corners = self.choices.stage.corners;
        self.choose(move |choices| choices.stage.corners = corners);
    }

    /// Does what a key asks of the corners, while they are moved. Returns whether it was one of theirs.
    pub(super) fn take_corner_key(&mut self, key: &Key, held: ModifiersState) -> bool {
        let Some(hands) = &mut self.desk.corners else { return false };
        match hands.take_key(key, held.shift_key()) {
            None => return false,
            Some(Moved::Nothing) => {}
            Some(Moved::Corner { corner, place }) => self.move_corner(corner, place, true),
            Some(Moved::Back) => {
                self.choices.stage.corners = Corners::default();
                self.move_corner(0, [0.0; 2], true);
            }
        }
        true
    }
}
