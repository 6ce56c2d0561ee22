//! The user's control of the master output: blackout, brightness, freeze, placement, and hiding the panels.

use std::time::Instant;

use super::{Interface, Playback, Session};
use crate::clock;
use crate::commands::{MovedCorner, Panel, SetSetting};
use crate::config::Setting;
use crate::placement::{Area, Corners};
use crate::scenes::SceneSource;
use crate::session::lay::Lay;
use crate::session::screen::Screen;
use crate::show::ShownPicture;
use crate::ui::desk_picture::{is_within, small_in};
use crate::ui::open_panel::OpenPanel;
use crate::ui::overlay::PanelSwitches;

impl Session {
    pub(super) fn toggle_clean(&mut self) {
        let is_hidden = &mut self.interface.ui_state.hidden.by_key;
        *is_hidden = !*is_hidden;
        if *is_hidden {
            self.close_panels();
        } else {
            self.playback.reports.answer("texts and panels are visible again");
        }
        self.screen.request_redraw();
    }

    /// Starts or ends a blackout. Closes the panels over a frame that has no other window.
    pub(super) fn toggle_blackout(&mut self) {
        let is_black = self.playback.master_output.toggle_blackout(clock::now());
        let words = if is_black { "blackout: press X to end it" } else { "the blackout ends" };
        self.playback.reports.answer(words);
        if is_black && !self.screen.has_output() {
            self.close_panels();
        }
    }

    fn close_panels(&mut self) {
        self.interface.ui_state.panels = PanelSwitches::default();
        self.show_open_panel();
    }

    /// Moves a corner of the frame; saves it if `settled`. Ignores positions at which the frame could not be drawn.
    pub(super) fn move_corner(&mut self, MovedCorner { corner, place, settled }: MovedCorner) {
        // Round, because steps finer than a pixel are of no use.
        let place = place.map(|fraction| (fraction * 1e4).round() / 1e4);
        let before = self.choices.stage.corners;
        self.set_corners(before.with(corner, place).unwrap_or(before), corner, settled);
    }

    /// Sets all corners and the selected corner. Saves the corners if `settled`.
    pub(super) fn set_corners(&mut self, corners: Corners, selected: usize, settled: bool) {
        if let Some(OpenPanel::Corners(handles)) = &mut self.interface.ui_state.panel {
            handles.set_corners(selected, corners);
        }
        self.change_setting(SetSetting { setting: Setting::Corners(corners), settled });
    }
}

impl Playback {
    pub(crate) fn toggle_freeze(&mut self) {
        let words = match self.master_output.toggle_freeze() {
            true => {
                self.scene.composer.give_picture_up();
                "frozen: press Z to continue"
            }
            false => {
                self.scene.fade_from_held(self.master_output.fade.as_secs_f64());
                "no longer frozen"
            }
        };
        self.reports.answer(words);
    }

    pub(super) fn holds_picture(&self) -> bool {
        self.master_output.hold() && self.pace.shown.is_some()
    }

    pub(super) fn follow_master_output(&mut self, time: f64) {
        let shown = self.scene.show.picture_at(time);
        let before = std::mem::replace(&mut self.master_output.shown, shown);
        let fraction = |picture: ShownPicture| picture.held.map(|held| held.fraction);
        let (was, is) = (fraction(before), fraction(shown));
        if was == is || self.master_output.is_frozen {
            return;
        }
        let since = |picture: ShownPicture| picture.held.map(|held| held.since);
        if since(before) != since(shown) {
            self.scene.composer.fading.hold_anew();
        }
        match is {
            // A frame held by the show would hide the frame in progress, so abandon the frame in progress.
            Some(1.0..) => self.scene.composer.give_picture_up(),
            fraction => self.scene.composer.mix_held(fraction),
        }
    }

    pub(super) fn is_dimming(&self, now: Instant) -> bool {
        self.pace.shown.is_some() && self.master_output.gain(now) != self.renderer.gain()
    }

    /// All scenes in the order of their numbers, marked scenes first.
    pub(super) fn numbered_scenes(&self) -> Vec<SceneSource> {
        let library = &self.scene.preparation.library;
        library.numbered(&library.wanted)
    }

    pub(super) fn show_scene_number(&mut self, number: usize) {
        let mut scenes = self.numbered_scenes();
        match number.checked_sub(1).filter(|place| *place < scenes.len()) {
            Some(place) => self.scene.show_source(scenes.swap_remove(place)),
            None => {
                let count = scenes.len();
                self.reports.answer(format!("there is no scene {number} of {count}: press B for a list"));
            }
        }
    }
}

impl Interface {
    /// Follows the marks of scenes, which change the scenes' numbers.
    pub(super) fn update_marks(&mut self, playback: &mut Playback) {
        let marks = &playback.listening.sound.kept.settings().favourite_scenes;
        if playback.scene.preparation.library.marks != *marks {
            playback.scene.preparation.library.marks.clone_from(marks);
            self.ui_state.placed_scene = None;
        }
    }

    /// Returns the part of a window of `size` pixels that shows the frame. It is as large as possible. While an output
    /// shows the frame, it is small and leaves room for the panels, unless corners are moved or panels are hidden.
    pub(super) fn update_area(&mut self, screen: &mut dyn Screen, lay: &Lay, size: (u32, u32)) -> Area {
        let is_small = screen.has_output()
            && !self.ui_state.hidden.is_bare()
            && self.ui_state.panels.open != Some(Panel::Corners);
        self.ui_state.picture = is_small.then(|| small_in(size, lay.screen));
        self.ui_state.picture.unwrap_or_else(|| lay.area_in(size))
    }

    /// True if pointer input at this position, in pixels, is meant for the frame.
    pub(super) fn is_for_picture(&self, screen: &dyn Screen, place: [f64; 2]) -> bool {
        let size = screen.size().unwrap_or_default();
        self.ui_state.picture.is_none_or(|area| is_within(area, size, place))
    }
}
