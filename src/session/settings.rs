//! The settings panel: changes take effect at once and are saved.

use super::Session;
use crate::commands::SetSetting;
use crate::config::Setting;
use crate::ui::open_panel::OpenPanel;
use crate::ui::settings_panel::Facts;

impl Session {
    pub(super) fn update_settings(&mut self) {
        if let Some(OpenPanel::Settings(panel)) = &mut self.interface.ui_state.panel {
            let facts = self.playback.listening.facts(&self.choices, self.names_output);
            panel.update(&Facts { monitors: self.screen.monitors(), ..facts });
        }
    }

    /// Applies a setting, and saves it once it is settled.
    pub(super) fn change_setting(&mut self, SetSetting { setting, settled }: SetSetting) {
        match &setting {
            Setting::Output(id) => {
                self.playback.listening.sound.choose_output(id.clone());
                self.names_output = false;
            }
            Setting::Quality(quality) => {
                self.playback.pace.resolution = self.playback.pace.resolution.chosen_anew(*quality)
            }
            Setting::FlashLimiter(on) => {
                if !on {
                    self.playback.renderer.remove_flash_limiter();
                } else if let Err(error) = self.playback.renderer.add_flash_limiter(&self.playback.shaders) {
                    return self.playback.reports.answer(format!("cannot limit flashes: {error}"));
                }
            }
            Setting::ToneMap(tone_map) => {
                self.playback.renderer.set_tone_map(*tone_map);
                self.playback.scene.composer.redraw();
            }
            Setting::Gain(gain) => self.playback.listening.sound.set_gain(*gain),
            Setting::FollowSong(follow) => self.playback.direction.set_follow(*follow),
            Setting::LastTracks(on) => {
                if !on {
                    self.playback.listening.sound.kept.keep_tracks(None);
                }
            }
            Setting::Screen(name) => self.screen.request_output(name.clone()),
            Setting::Brightness(percent) => {
                self.playback.master_output.set_brightness(f32::from(*percent) / 100.0)
            }
            Setting::BlackoutFade(seconds) => self.playback.master_output.set_fade(*seconds),
            Setting::Flip(_) | Setting::Crop(_) | Setting::Corners(_) => {
                self.screen.lie_differently();
            }
            // The next look at the status follows it.
            Setting::StayAwake(_) => {}
            Setting::NextScene(_) => self.screen.request_redraw(),
            Setting::Hints(on) => self.interface.ui_state.hidden.by_setting = !on,
        }
        self.choices.set(&setting);
        if settled {
            self.playback.listening.sound.kept.change(move |settings| settings.choices.set(&setting));
        }
        self.update_settings();
    }
}
