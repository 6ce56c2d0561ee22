//! Carries out commands, whoever sends them.

use super::{Interface, Playback, Session};
use crate::commands::{Command, Panel, SceneName, Sender, SetSetting, ShowState};
use crate::config::Setting;
use crate::placement::Corners;
use crate::session::screen::Screen;
use mariana_control::midi::Target;
use mariana_player::Edit;

impl Session {
    /// Carries out a command. Does nothing if a switch already has the requested state.
    pub(crate) fn carry_out(&mut self, command: Command, sender: Sender) {
        if command.is_done_already(|| self.state()) {
            return self.playback.reports.hurry();
        }
        match command {
            Command::Pause(_) => {
                self.playback.set_paused(!self.playback.listening.paused);
                self.playback.answer_position(&*self.screen);
            }
            Command::Refine => {
                if self.playback.scene.toggle_refinement() {
                    self.playback.set_paused(true);
                }
            }
            Command::SeekBy(seconds) => {
                self.playback.with_song(|player| player.seek_by(seconds));
                self.playback.answer_position(&*self.screen);
            }
            Command::SeekTo(seconds) => self.playback.with_song(|player| player.seek_to(seconds)),
            Command::Position(fraction) => self.playback.seek_to_fraction(&mut *self.screen, fraction),
            Command::VolumeBy(delta) => self.playback.change_volume(|player| player.change_volume(delta)),
            // Show no notice, because the volume slider already shows the volume.
            Command::Volume(volume) if sender == Sender::Window => self.playback.with_song(|player| {
                player.set_volume(volume);
                if player.status().muted {
                    player.toggle_mute();
                }
            }),
            Command::Volume(volume) => self.playback.change_volume(|player| player.set_volume(volume)),
            Command::Mute(_) => self.playback.change_volume(|player| player.toggle_mute()),
            Command::Tap => self.playback.reports.answer_any(self.playback.listening.tap()),
            Command::Tempo(tempo) => {
                let words = self.playback.listening.set_tempo((tempo > 0.0).then_some(f64::from(tempo)));
                self.playback.reports.answer_any(words);
            }
            Command::NextTrack => self.playback.listening.skip(true),
            Command::PreviousTrack => self.playback.listening.skip(false),
            Command::Shuffle(_) => {
                self.playback.reports.answer_any(self.playback.listening.toggle_shuffle());
            }
            Command::NextRepeat => self.playback.reports.answer_any(self.playback.listening.set_repeat(None)),
            Command::Repeat(repeat) => {
                self.playback.reports.answer_any(self.playback.listening.set_repeat(Some(repeat)));
            }
            Command::PlayTrack(entry) => self.playback.with_song(|player| player.play_entry(entry)),
            Command::RemoveTrack(entry) => self.playback.with_song(|player| player.edit(Edit::Remove(entry))),
            Command::MoveTrack((from, to)) => {
                self.playback.with_song(|player| player.edit(Edit::Move { from, to }));
            }
            Command::ClearTracks => self.playback.with_song(|player| player.edit(Edit::Clear)),
            Command::UndoTracks => self.undo_tracks(),
            Command::MarkFolders(folders) => self.playback.listening.sound.kept.change(move |settings| {
                settings.favourite_folders.clone_from(&folders);
            }),
            Command::Open(files) => self.interface.open_files(&mut self.playback, files),
            Command::NextSource => self.playback.listening.next_source(),
            Command::Listen(place) => self.playback.listening.choose_source(place),
            Command::DelayBy(steps) => {
                self.playback.reports.answer(self.playback.listening.sound.shift(steps));
            }
            Command::Delay(delay) => {
                self.playback.listening.sound.shift_to(delay.milliseconds, delay.settled);
                self.update_settings();
            }
            Command::TogglePanel(panel) => self.toggle_panel(panel),
            Command::NextScene => self.playback.scene.step_scene(true),
            Command::PreviousScene => self.playback.scene.step_scene(false),
            Command::Scene(name) => self.playback.show_scene_named(name),
            Command::SceneAt(place) => self.playback.show_scene_number(place + 1),
            Command::ShowScene(source) => {
                self.playback.scene.show_source(*source);
                self.interface.show_scene_in_editor(&mut self.playback);
            }
            Command::ReloadScene => self.playback.scene.preparation.library.load_again(),
            Command::Surprise(number) => self.surprise(number),
            Command::SurpriseBack => self.surprise_back(),
            Command::KeepSurprise => self.keep_surprise(),
            Command::TurnNumbers(turned) => self.playback.scene.parameters.turn_numbers(turned),
            Command::MarkScenes(titles) => self.playback.listening.sound.kept.change(move |settings| {
                settings.favourite_scenes.clone_from(&titles);
            }),
            Command::Cut(switch) => {
                let cuts = switch.applied_to(self.playback.scene.composer.fading.cuts());
                self.playback.reports.answer(self.playback.scene.composer.fading.set_cuts(cuts));
            }
            Command::Fade(seconds) => self.playback.set_fade(seconds),
            Command::Follow(_) => self.toggle_follow(),
            Command::Keep(_) => self.playback.toggle_keep(),
            Command::Decks(_) => self.playback.scene.toggle_decks(),
            Command::Crossfade(position) => self.playback.scene.deck_changes().set_crossfade(position),
            Command::CrossfadeBy(way) => self.playback.scene.deck_changes().crossfade_by(way),
            Command::CrossOver => {
                let seconds = self.playback.scene.composer.fading.seconds();
                self.playback.scene.deck_changes().cross_over(seconds);
            }
            Command::SwapDecks => self.playback.scene.deck_changes().swap(),
            Command::MixDecks(number) => self.playback.scene.deck_changes().mix_by(number.checked_sub(1)),
            Command::TakeDeck(number) => {
                self.playback.scene.deck_changes().hold_deck(number.saturating_sub(1));
            }
            Command::NextCue => self.playback.next_cue(),
            Command::PreviousCue => self.playback.jump_to_cue(None),
            Command::CueAt(number) => self.playback.jump_to_cue(Some(number)),
            Command::Record(_) => self.playback.toggle_recording(),
            Command::Mark(mark) => self.video_desk().mark(mark),
            Command::Video(edit) => self.video_desk().edit(edit),
            Command::SavePicture(scale) => {
                self.pictures.request(scale);
                self.screen.request_redraw();
            }
            Command::ToggleMode => self.playback.scene.toggle_mode(),
            Command::ToggleRegions => self.playback.scene.toggle_regions(),
            Command::ResetCamera => self.playback.scene.give_camera_back(),
            Command::TurnCamera(way) => {
                self.interface.turn_camera(&mut self.playback, &mut *self.screen, way)
            }
            Command::ZoomCamera(notches) => {
                self.interface.zoom_camera(&mut self.playback, &mut *self.screen, notches)
            }
            Command::Inspect(place) => self.interface.inspect(&mut self.playback, &mut *self.screen, place),
            Command::ToggleRay => self.interface.toggle_ray(&mut self.playback),
            Command::NextView => self.playback.switch_view(true),
            Command::PreviousView => self.playback.switch_view(false),
            Command::StepView(larger) => self.playback.scene.step_view(larger),
            Command::ToggleSliders => self.interface.ui_state.panels.sliders ^= true,
            Command::MoveSlider((place, value)) => {
                let turned = self.playback.scene.parameters_in_hand_mut();
                turned.into_iter().for_each(|mut turned| turned.move_slider(place, value));
            }
            Command::Bind(bind) => self.playback.bind(bind),
            Command::WriteBinding(name) => self.write_binding(&name),
            Command::Snapshot(number) => self.snapshots.press(&mut self.playback, number),
            Command::TakeNext(_) => self.snapshots.toggle_take(&mut self.playback),
            Command::Morph(_) => self.snapshots.toggle_morph(&mut self.playback),
            Command::MorphBeats(beats) => self.snapshots.morph_over(&mut self.playback, beats),
            Command::WriteSnapshots => self.snapshots.write(&mut self.playback, &self.interface.folders),
            Command::ToggleSceneLine => self.interface.ui_state.panels.corner ^= true,
            Command::Blackout(_) => self.toggle_blackout(),
            Command::Freeze(_) => self.playback.toggle_freeze(),
            Command::Brightness(fraction) => {
                let percent = (100.0 * fraction).round().clamp(0.0, 100.0) as u8;
                self.change_setting(SetSetting { setting: Setting::Brightness(percent), settled: false });
            }
            Command::Clean(_) => self.toggle_clean(),
            Command::MoveCorner(moved) => self.move_corner(moved),
            Command::ResetCorners => self.set_corners(Corners::default(), 0, true),
            Command::Fullscreen(_) => self.interface.toggle_fullscreen(&mut *self.screen),
            Command::Raise => self.screen.raise(),
            Command::Set(set) => self.change_setting(set),
            Command::Learn(target) => self.interface.start_learning(&mut self.playback, target),
            Command::LearnParameter(name) => {
                let scene = self.playback.scene.parameters_in_hand().title().unwrap_or_default();
                self.interface.start_learning(&mut self.playback, Target::Param { scene, name });
            }
            Command::EditMappings(edit) => {
                self.playback.controllers.midi.memory.change(&edit);
                self.interface.put_up_controllers(&mut self.playback);
            }
            Command::Leave => self.leave(),
            Command::ToggleHelp => self.interface.toggle_help(),
            // The main loop carries out this command.
            Command::Quit => {}
        }
        self.playback.reports.hurry();
    }

    pub(super) fn carry_out_all(&mut self, commands: impl IntoIterator<Item = Command>) {
        for command in commands {
            self.carry_out(command, Sender::Window);
        }
    }

    pub(super) fn state(&mut self) -> ShowState {
        let song = self.playback.listening.with_song(|player| player.status());
        let playing = &self.playback.reports.playing;
        ShowState {
            paused: self.playback.listening.paused,
            muted: song.as_ref().is_some_and(|song| song.muted),
            shuffled: song.as_ref().is_some_and(|song| song.shuffled),
            follows: self.playback.follows(),
            kept: self.playback.scene.show.is_locked,
            recording: self.playback.recording.is_on,
            cuts: self.playback.scene.composer.fading.cuts(),
            decks: self.playback.scene.decks().is_some(),
            crossfade: self.playback.scene.decks().map(|(decks, now)| decks.crossfade(now)),
            snapshots: self.snapshots.keys,
            black: self.playback.master_output.is_black,
            frozen: self.playback.master_output.is_frozen,
            clean: self.interface.ui_state.hidden.by_key,
            fullscreen: self.screen.is_fullscreen(),
            brightness: f32::from(self.choices.stage.brightness) / 100.0,
            position: playing.fraction(),
            volume: (!playing.live).then_some(playing.volume),
        }
    }
}

impl Playback {
    /// Shows the scene with this title or number. Numbers start at 1, with the favourite scenes first.
    fn show_scene_named(&mut self, name: SceneName) {
        match name {
            SceneName::Title(title) => {
                let mut scenes = self.scene.preparation.library.all_sources().into_iter();
                match scenes.find(|scene| scene.title() == title) {
                    Some(scene) => self.scene.show_source(scene),
                    None => self.reports.answer(format!("there is no scene '{title}': press B for a list")),
                }
            }
            SceneName::Number(number) => self.show_scene_number(number),
        }
    }
}

impl Interface {
    fn turn_camera(&mut self, playback: &mut Playback, screen: &mut dyn Screen, way: [f64; 2]) {
        if !self.is_for_picture(screen, self.input.pointer.began()) {
            return;
        }
        let height = f64::from(screen.size().map_or(1, |(_, height)| height));
        let height = height * self.ui_state.picture.map_or(1.0, |[_, top, _, bottom]| bottom - top);
        playback.scene.move_camera(|orbit, own| orbit.drag(way[0] / height, way[1] / height, own));
    }

    fn zoom_camera(&mut self, playback: &mut Playback, screen: &mut dyn Screen, notches: f64) {
        if self.is_for_picture(screen, self.input.pointer.began()) {
            playback.scene.move_camera(|orbit, _| orbit.zoom(notches));
        }
    }

    fn show_scene_in_editor(&mut self, playback: &mut Playback) {
        if let Some(editor) =
            self.ui_state.editor.as_mut().filter(|_| self.ui_state.panels.open == Some(Panel::Editor))
        {
            editor.show_scene(&playback.scene.preparation.library.wanted);
        }
    }
}
