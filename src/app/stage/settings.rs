//! What is chosen in the panel of settings: it takes effect at once, and is remembered.

use super::Stage;
use crate::app::overlay::{Panel, SettingRequest};
use crate::app::settings_panel::{Facts, SettingChange, SettingsPanel};
use crate::config::Choices;

impl Stage {
    /// Opens the panel of settings, or closes it.
    pub(super) fn show_settings(&mut self, open: bool) {
        if open {
            self.output.look_at_monitors();
        }
        self.desk.settings = open.then(SettingsPanel::default);
        self.update_settings();
    }

    /// Brings the panel up to date, if it is open.
    pub(super) fn update_settings(&mut self) {
        if let Some(panel) = &mut self.desk.settings {
            let facts = self.listening.facts(&self.choices, self.names_output);
            panel.update(&Facts { monitors: self.output.monitors(), ..facts });
        }
    }

    /// Does what the pointer asked of the panel.
    pub(super) fn obey_in_settings(&mut self, request: SettingRequest) {
        let Some(panel) = &mut self.desk.settings else { return };
        let change = match request {
            SettingRequest::Pick { row, value } => panel.pick(row, value),
            SettingRequest::Shift { row, shift, settled } => panel.shift(row, shift, settled),
            SettingRequest::Close => return self.toggle_panel(Panel::Settings),
        };
        if let Some(change) = change {
            self.change_setting(change);
        }
    }

    /// Does what was chosen, and remembers it.
    pub(super) fn change_setting(&mut self, change: SettingChange) {
        match change {
            SettingChange::Output(id) => {
                self.listening.choose_output(id.clone());
                (self.names_output, self.chose_output) = (false, true);
                self.choose(move |choices| choices.output.clone_from(&id));
            }
            SettingChange::Latency { shift, settled } => self.listening.shift_to(shift, settled),
            SettingChange::Quality(quality) => {
                self.pace.set_quality(quality);
                self.choose(move |choices| choices.quality = quality);
            }
            SettingChange::FlashLimiter(on) => self.limit_flashes(on),
            SettingChange::ToneMap(tone_map) => {
                self.renderer.set_tone_map(tone_map);
                self.scene.composer_mut().look_different();
                self.choose(move |choices| choices.tone_map = tone_map);
            }
            SettingChange::Gain(gain) => {
                self.listening.set_gain(gain);
                self.choose(move |choices| choices.gain = gain);
            }
            SettingChange::Follow(follow) => {
                self.direction.set_follow(follow);
                self.choose(move |choices| choices.follow_song = follow);
            }
            SettingChange::LastTracks(on) => {
                if !on {
                    self.listening.keep_tracks(None);
                }
                self.choose(move |choices| choices.last_tracks = on);
            }
            SettingChange::Screen(name) => self.choose_output_monitor(name),
            SettingChange::Brightness { percent, settled } => self.set_brightness(percent, settled),
            SettingChange::BlackoutFade(seconds) => {
                self.masters.set_fade(seconds);
                self.choose(move |choices| choices.stage.blackout_fade = seconds);
            }
            SettingChange::Flip(flip) => {
                self.choose(move |choices| choices.stage.flip = flip);
                self.output.look_different();
                self.window.request_redraw();
            }
            SettingChange::Crop(crop) => {
                self.choose(move |choices| choices.stage.crop = crop);
                self.output.look_different();
                self.window.request_redraw();
            }
            SettingChange::NextScene(on) => {
                self.choose(move |choices| choices.next_scene = on);
                self.window.request_redraw();
            }
            SettingChange::Hints(on) => {
                self.desk.clean = !on;
                self.choose(move |choices| choices.hints = on);
            }
        }
        self.update_settings();
    }

    fn limit_flashes(&mut self, on: bool) {
        if !on {
            self.renderer.remove_flash_limiter();
        } else if let Err(error) = self.renderer.add_flash_limiter(&self.shaders) {
            return self.reports.answer(format!("flashes cannot be limited: {error}"));
        }
        self.choose(move |choices| choices.flash_limiter = on);
    }

    /// Notes a choice for this run and for those that follow.
    pub(super) fn choose(&mut self, change: impl Fn(&mut Choices) + Send + 'static) {
        change(&mut self.choices);
        self.listening.remember(move |settings| change(&mut settings.choices));
    }
}
