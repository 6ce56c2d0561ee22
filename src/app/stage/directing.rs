//! Lets the scenes follow the song, as the director or a show file says.

use super::Stage;
use crate::app::direction::News;
use crate::app::settings_panel::SettingChange;
use crate::config::FollowChoice;
use mariana_player::Moment;

impl Stage {
    /// Brings the scene on that the show has at a moment.
    pub(super) fn direct(&mut self, moment: Option<Moment>) {
        let Some(moment) = moment else { return };
        let (song, list) = (self.listening.structure(moment.track), self.listening.listed());
        let scene = &self.scene;
        match self.direction.update(moment.track, list, song, || scene.all_sources()) {
            Some(News::Programme(programme)) => {
                if programme.is_some() {
                    tracing::info!("the scenes follow the song");
                }
                self.scene.set_programme(programme);
            }
            Some(News::Problem { heading, text }) => self.scene.set_problem(heading, text),
            None => {}
        }
        self.scene.follow(moment.song_time);
    }

    /// Lets the scenes follow the songs, or stay as they are.
    pub(in crate::app) fn toggle_follow(&mut self) {
        let follows = self.direction.follows(self.listening.listed());
        let (follow, words) = match follows {
            true => (FollowChoice::Off, "the scene stays: A lets the scenes follow the song"),
            false if !self.listening.plays_song() => {
                (FollowChoice::On, "the scenes follow songs, and an input is listened to")
            }
            false => (FollowChoice::On, "the scenes follow the song: K keeps one, A ends it"),
        };
        self.change_setting(SettingChange::Follow(follow));
        self.reports.answer(words.to_owned());
    }

    /// Keeps the scene that is on until this is called again.
    pub(in crate::app) fn toggle_keep(&mut self) {
        let words = match self.scene.is_directed() {
            false => "the scenes do not follow the song: A lets them",
            true if self.scene.toggle_lock() => "this scene stays until K is pressed again",
            true => "the scenes follow the song again",
        };
        self.reports.answer(words.to_owned());
    }
}
