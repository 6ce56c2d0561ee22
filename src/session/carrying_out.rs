//! The one place that carries out commands, whoever sent them.

use super::Session;
use crate::commands::{Command, Panel, SceneName, Sender, SetSetting, ShowState};
use crate::config::Setting;
use crate::placement::Corners;
use crate::session::announcer::{TrackOrder, next_repeat};
use mariana_control::midi::Target;

impl Session {
    /// Carries out a command. Does nothing if it asks a switch for the state that it has already.
    pub(crate) fn carry_out(&mut self, command: Command, sender: Sender) {
        if command.row().is_on.is_some() && command.is_done_already(&self.state()) {
            return self.hurry_reports();
        }
        match command {
            Command::Pause(_) => {
                self.set_paused(!self.listening.is_paused());
                self.answer_position();
            }
            Command::SeekBy(seconds) => {
                self.with_song(|player| player.seek_by(seconds));
                self.answer_position();
            }
            Command::SeekTo(seconds) => self.with_song(|player| player.seek_to(seconds)),
            Command::Position(share) => self.seek_to_share(share),
            Command::VolumeBy(delta) => self.change_volume(|player| player.change_volume(delta)),
            // The rail of the bar shows the volume by itself.
            Command::Volume(volume) if sender == Sender::Window => self.with_song(|player| {
                player.set_volume(volume);
                if player.status().muted {
                    player.toggle_mute();
                }
            }),
            Command::Volume(volume) => self.change_volume(|player| player.set_volume(volume)),
            Command::Mute(_) => self.change_volume(|player| player.toggle_mute()),
            Command::Tap => {
                let words = self.listening.tap();
                self.answer(words);
            }
            Command::Tempo(tempo) => {
                let words = self.listening.set_tempo((tempo > 0.0).then_some(f64::from(tempo)));
                self.answer(words);
            }
            Command::NextTrack => self.listening.skip(true),
            Command::PreviousTrack => self.listening.skip(false),
            Command::Shuffle(_) => {
                self.set_order(|order| TrackOrder { shuffled: !order.shuffled, ..order });
            }
            Command::NextRepeat => {
                self.set_order(|order| TrackOrder { repeat: next_repeat(order.repeat), ..order });
            }
            Command::Repeat(repeat) => self.set_order(|order| TrackOrder { repeat, ..order }),
            Command::PlayTrack(entry) => self.with_song(|player| player.play_entry(entry)),
            Command::RemoveTrack(entry) => self.with_song(|player| player.remove_entry(entry)),
            Command::MoveTrack((from, to)) => self.with_song(|player| player.move_entry(from, to)),
            Command::Open(files) => self.open_files(files),
            Command::NextSource => self.listening.next_source(),
            Command::Listen(place) => self.listening.choose_source(place),
            Command::DelayBy(steps) => {
                let words = self.listening.shift(steps);
                self.answer(Some(words));
            }
            Command::Delay(delay) => {
                self.listening.shift_to(delay.milliseconds, delay.settled);
                self.update_settings();
            }
            Command::TogglePanel(panel) => self.toggle_panel(panel),
            Command::NextScene => self.scene.go(true),
            Command::PreviousScene => self.scene.go(false),
            Command::Scene(name) => self.show_scene_named(name),
            Command::SceneAt(place) => self.show_scene_number(place + 1),
            Command::ShowScene(source) => {
                self.scene.show_source(*source);
                self.show_scene_in_editor();
            }
            Command::ReloadScene => self.scene.library_mut().load_again(),
            Command::TurnNumbers(turned) => {
                self.scene.parameters_mut().turn_numbers(&turned.file, turned.values)
            }
            Command::MarkScenes(titles) => self.listening.remember(move |settings| {
                settings.favourite_scenes.clone_from(&titles);
            }),
            Command::Cut(switch) => {
                let cuts = switch.applied_to(self.scene.composer().fading().cuts());
                let words = self.scene.composer_mut().fading_mut().set_cuts(cuts);
                self.answer(Some(words));
            }
            Command::Fade(seconds) => self.set_fade(seconds),
            Command::Follow(_) => self.toggle_follow(),
            Command::Keep(_) => self.toggle_keep(),
            Command::NextCue => self.next_cue(),
            Command::Record(_) => self.toggle_recording(),
            Command::ToggleMode => self.scene.toggle_mode(),
            Command::ToggleRegions => self.scene.toggle_regions(),
            Command::ResetCamera => self.scene.give_camera_back(),
            Command::TurnCamera(way) => self.turn_camera(way),
            Command::ZoomCamera(notches) => self.zoom_camera(notches),
            Command::Inspect(place) => self.look_at(place),
            Command::NextView => self.go_view(true),
            Command::PreviousView => self.go_view(false),
            Command::StepView(larger) => self.scene.step_view(larger),
            Command::ToggleSliders => self.desk.panels.toggle_sliders(),
            Command::ToggleSceneLine => self.desk.panels.toggle_corner(),
            Command::Blackout(_) => self.toggle_blackout(),
            Command::Freeze(_) => self.toggle_freeze(),
            Command::Brightness(share) => {
                let percent = (100.0 * share).round().clamp(0.0, 100.0) as u8;
                self.change_setting(SetSetting { setting: Setting::Brightness(percent), settled: false });
            }
            Command::Clean(_) => self.toggle_clean(),
            Command::MoveCorner(moved) => self.move_corner(moved),
            Command::ResetCorners => self.set_corners(Corners::default(), 0, true),
            Command::Fullscreen(_) => self.toggle_fullscreen(),
            Command::Raise => self.screen.raise(),
            Command::Set(set) => self.change_setting(set),
            Command::Learn(target) => self.learn(target),
            Command::LearnParameter(name) => {
                let scene = self.scene.scenes().name().unwrap_or_default();
                self.learn(Target::Param { scene, name });
            }
            Command::EditMappings(edit) => {
                self.hands.edit(&edit);
                self.update_hands();
            }
            Command::Leave => self.leave(),
            Command::ToggleHelp => self.desk.panels.toggle_help(),
            // The loop ends before it comes here.
            Command::Quit => {}
        }
        self.hurry_reports();
    }

    /// Carries out commands of keys and panels.
    pub(super) fn carry_out_all(&mut self, commands: impl IntoIterator<Item = Command>) {
        for command in commands {
            self.carry_out(command, Sender::Window);
        }
    }

    /// The state of the show, for those who display or control it.
    pub(super) fn state(&mut self) -> ShowState {
        let song = self.listening.with_song(|player| player.status());
        let playing = self.reports.playing();
        ShowState {
            paused: self.listening.is_paused(),
            muted: song.as_ref().is_some_and(|song| song.muted),
            shuffled: song.as_ref().is_some_and(|song| song.shuffled),
            follows: self.follows(),
            kept: self.scene.show().is_locked(),
            recording: self.is_recording(),
            cuts: self.scene.composer().fading().cuts(),
            black: self.masters.is_black(),
            frozen: self.masters.is_frozen(),
            clean: self.desk.bare,
            fullscreen: self.screen.is_fullscreen(),
            brightness: f32::from(self.choices.stage.brightness) / 100.0,
            position: playing.share(),
            volume: (!playing.live).then_some(playing.volume),
        }
    }

    /// Shows the scene of this title, or of this number from 1, marked ones first.
    fn show_scene_named(&mut self, name: SceneName) {
        match name {
            SceneName::Title(title) => {
                match self.scene.library().all_sources().into_iter().find(|scene| scene.title() == title) {
                    Some(scene) => self.scene.show_source(scene),
                    None => self.reports.answer(format!("there is no scene '{title}': B shows them all")),
                }
            }
            SceneName::Number(number) => self.show_scene_number(number),
        }
    }

    /// Turns the camera by a movement of the pointer, in pixels.
    fn turn_camera(&mut self, way: [f64; 2]) {
        if !self.is_for_picture(self.input.began()) {
            return;
        }
        let height = f64::from(self.screen.size().map_or(1, |(_, height)| height));
        let height = height * self.desk.picture.map_or(1.0, |[_, top, _, bottom]| bottom - top);
        self.scene.move_camera(|hand, own| hand.drag((way[0] / height, way[1] / height), own));
    }

    /// Moves the camera nearer by notches of the wheel.
    fn zoom_camera(&mut self, notches: f64) {
        if self.is_for_picture(self.input.began()) {
            self.scene.move_camera(|hand, _| hand.zoom(notches));
        }
    }

    /// Shows the present scene in an editor that is open.
    fn show_scene_in_editor(&mut self) {
        if let Some(editor) =
            self.desk.editor.as_mut().filter(|_| self.desk.panels.open() == Some(Panel::Editor))
        {
            editor.show_scene(self.scene.library().wanted());
        }
    }
}
