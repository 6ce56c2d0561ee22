//! Lets a show choose the scenes. The show comes from the director or from a file.

use super::cues::Jump;
use super::{Playback, Session};
use crate::clock;
use crate::commands::SetSetting;
use crate::config::{FollowChoice, Setting};
use crate::session::direction::Playing;
use crate::show::{Hearing, LiveDirector};
use crate::ui::overlay::CueSheet;
use mariana_player::Moment;
use std::sync::Arc;

const FOLLOWS: &str = "the scenes follow the song: press K to keep a scene, A to stop";

impl Session {
    pub(super) fn toggle_follow(&mut self) {
        let playing = self.playback.listening.playing();
        let (follow, words) = match (self.playback.direction.follows(playing), playing) {
            (true, _) => (FollowChoice::Off, "the scene stays: press A to let scenes follow the song"),
            // Not `On`: with `On`, the next run would replace a scene that its command line names.
            (false, Playing::Song | Playing::Demo) => (FollowChoice::Songs, FOLLOWS),
            (false, Playing::Input) => (FollowChoice::On, FOLLOWS),
        };
        self.change_setting(SetSetting { setting: Setting::FollowSong(follow), settled: true });
        self.playback.reports.answer(words);
    }
}

impl Playback {
    pub(super) fn direct(&mut self, moment: Option<Moment>) {
        let Some(moment) = moment else { return };
        self.controllers.network.publish_sound(&moment.features, &moment.song, clock::now());
        let (track, playing) = (self.listening.track_of(moment), self.listening.playing());
        // An input gets an empty structure, because its sections are unknown in advance.
        let song = track.map_or_else(|| Some(Arc::default()), |track| self.listening.structure(track));
        let scene = &self.scene;
        let (current, scenes) =
            (&scene.preparation.library.wanted, || scene.preparation.library.all_sources());
        match self.direction.update(track, playing, song.clone(), current, scenes) {
            Some(Ok(prepared_show)) => {
                if prepared_show.is_some() {
                    tracing::info!("the scenes follow the song");
                }
                self.live = None;
                self.cues.set_show(track, prepared_show.clone(), song);
                match prepared_show {
                    Some(prepared_show) if track.is_none() && !prepared_show.is_by_user() => {
                        let director = LiveDirector::new(prepared_show.cards().to_vec());
                        self.live = Some((prepared_show, director));
                    }
                    _ => self.scene.show.set_prepared_show(self.cues.prepared_show(), self.cues.next()),
                }
            }
            Some(Err(text)) => {
                let heading = match self.scene.show.has_prepared_show() {
                    true => "the show has mistakes; the previous show continues",
                    false => "the show has mistakes and starts when its file is corrected",
                };
                self.scene.messages.set_problem(heading.to_owned(), text);
            }
            None => {}
        }
        if let Jump::Pressed(prepared_show) = self.cues.follow(&moment) {
            self.scene.show.extend_prepared_show(prepared_show, self.cues.next());
        }
        if let Some((show, director)) = &mut self.live {
            let (features, time) = (&moment.features, moment.song_time);
            let (tempo, phase) = (features.tempo, features.phase);
            let (energy, novelty, drop) = (moment.song.energy, features.live.novelty, moment.song.drop);
            let heard = Hearing { time, energy, tempo, phase, novelty, drop };
            if let Some(timeline) = director.process(heard) {
                let prepared_show = Arc::new(show.with_timeline(Some(timeline)));
                self.scene.show.extend_prepared_show(prepared_show, None);
            }
        }
        self.scene.follow(moment.song_time);
        self.scene.follow_controllers(&moment);
        self.follow_master_output(moment.song_time);
    }

    pub(super) fn next_cue(&mut self) {
        let words = match self.listening.now() {
            _ if !self.scene.show.has_prepared_show() => {
                "no show is running: press A to let scenes follow the song".to_owned()
            }
            None => return,
            Some(moment) => match self.cues.press(moment.song_time) {
                Ok((prepared_show, words)) => {
                    self.scene.show.extend_prepared_show(prepared_show, self.cues.next());
                    words
                }
                Err(words) => words.to_owned(),
            },
        };
        self.reports.answer(words);
    }

    /// Goes to the entry of the show with this number, from 1; `None` for the entry before the present one.
    pub(super) fn jump_to_cue(&mut self, number: Option<usize>) {
        let Some(moment) = self.listening.now() else { return };
        let jump = match number {
            Some(number) => number.checked_sub(1).map(|index| self.cues.jump(index, moment.song_time)),
            None => Some(self.cues.back(moment.song_time)),
        };
        match jump.unwrap_or(Jump::Nowhere) {
            Jump::Seek(seconds) => self.with_song(|player| player.seek_to(seconds)),
            Jump::Pressed(prepared_show) => {
                self.scene.show.extend_prepared_show(prepared_show, self.cues.next());
            }
            Jump::Nowhere => self.reports.answer(match self.cues.rows.is_empty() {
                true => "no show is running: press A to let scenes follow the song",
                false => "the show cannot go there: this entry is missing, or follows an entry that waits",
            }),
        }
    }

    /// Returns the entries of the show, for the panel.
    pub(super) fn cue_sheet(&mut self) -> CueSheet {
        let time = self.listening.now().map_or(0.0, |moment| moment.song_time);
        CueSheet { rows: self.cues.rows.clone(), current: self.cues.current(time) }
    }

    /// Locks the current scene until the next call.
    pub(super) fn toggle_keep(&mut self) {
        let words = match self.scene.show.has_prepared_show() {
            false => "the scenes do not follow the song: press A first",
            true if self.scene.show.toggle_lock() => "this scene stays until K is pressed again",
            true => "the scenes follow the song again",
        };
        self.reports.answer(words);
    }
}
