//! The panels over the frame. They are plain values, which this module changes on key and pointer commands.

use super::{Interface, Playback, Session};
use crate::clock;
use crate::commands::{Command, Panel, SetSetting};
use crate::config::Setting;
use crate::thumbnails::Thumbnails;
use crate::ui::controllers_panel::ControllersPanel;
use crate::ui::corner_handles::CornerHandles;
use crate::ui::help_panel::HelpPanel;
use crate::ui::open_panel::OpenPanel;
use crate::ui::overlay::{Acts, PanelAct};
use crate::ui::scene_browser::SceneBrowser;
use crate::ui::settings_panel::SettingsPanel;
use crate::ui::video_panel::VideoPanel;

impl Session {
    pub(super) fn toggle_panel(&mut self, panel: Panel) {
        if panel == Panel::Editor && self.gives_focus_to_editor() {
            return;
        }
        self.interface.ui_state.panels.toggle(panel);
        // Keys now act on the panel.
        self.interface.overlay.drop_key_focus();
        if self.interface.ui_state.panels.open == Some(Panel::Sources) {
            self.playback.listening.sound.show_list();
        }
        self.show_open_panel();
    }

    /// Shows the open panel, and closes all others.
    pub(super) fn show_open_panel(&mut self) {
        let open = self.interface.ui_state.panels.open;
        self.write_text(open == Some(Panel::Editor));
        match self.interface.ui_state.panel.take() {
            Some(OpenPanel::Controllers(_)) => _ = self.playback.controllers.midi.stop_learning(),
            Some(OpenPanel::Corners(_)) => {
                // A handle may still be dragged, so save the corners now.
                let setting = Setting::Corners(self.choices.stage.corners);
                self.change_setting(SetSetting { setting, settled: true });
            }
            _ => {}
        }
        self.interface.ui_state.panel = match open {
            Some(Panel::Scenes) => Some(OpenPanel::Scenes(self.interface.scene_browser(&self.playback))),
            Some(Panel::Files) => Some(OpenPanel::Files(self.interface.file_browser(&mut self.playback))),
            Some(Panel::Settings) => {
                self.screen.update_monitors();
                Some(OpenPanel::Settings(SettingsPanel::default()))
            }
            Some(Panel::Controllers) => Some(OpenPanel::Controllers(ControllersPanel::default())),
            Some(Panel::Corners) => Some(OpenPanel::Corners(CornerHandles::new(self.choices.stage.corners))),
            Some(Panel::Video) => {
                self.video_desk().begin();
                Some(OpenPanel::Video(VideoPanel::default()))
            }
            // The track list opens once the player has one.
            Some(Panel::Tracks | Panel::Sources | Panel::Editor | Panel::Cues) | None => None,
        };
        self.update_settings();
        self.interface.put_up_controllers(&mut self.playback);
        self.video_desk().update(clock::now());
        self.screen.request_redraw();
    }

    /// Closes the topmost panel, or leaves full screen.
    pub(super) fn leave(&mut self) {
        if self.playback.controllers.midi.stop_learning() {
            return self.interface.put_up_controllers(&mut self.playback);
        }
        let has_sliders = !self.playback.scene.parameters_in_hand().sliders().is_empty();
        if !self.interface.ui_state.panels.close(has_sliders) {
            self.screen.set_fullscreen(false);
        }
        if self.interface.ui_state.panels.open.is_none() {
            self.show_open_panel();
        }
    }

    /// Changes the panels by the user's input in them. Returns the commands.
    pub(super) fn handle_acts(&mut self) -> Vec<Command> {
        let Acts { on_panels, commands } = std::mem::take(&mut self.interface.acts);
        let (ui, mut of_panels) = (&mut self.interface.ui_state, Vec::new());
        for act in on_panels {
            of_panels.extend(match (act, &mut ui.panel) {
                (PanelAct::Help(act), _) => act(&mut ui.help),
                (PanelAct::Editor(act), _) => {
                    ui.editor.as_mut().map(act);
                    continue;
                }
                (PanelAct::Scenes(act), Some(OpenPanel::Scenes(panel))) => act(panel),
                (PanelAct::Files(act), Some(OpenPanel::Files(panel))) => act(panel),
                (PanelAct::Tracks(act), Some(OpenPanel::Tracks(panel))) => act(panel),
                (PanelAct::Settings(act), Some(OpenPanel::Settings(panel))) => act(panel),
                // The panel has closed since.
                _ => continue,
            });
        }
        self.follow_editor();
        of_panels.extend(commands);
        of_panels
    }
}

impl Interface {
    /// Shows the table of keys without a search text, or hides the table.
    pub(super) fn toggle_help(&mut self) {
        self.ui_state.panels.help ^= true;
        self.ui_state.help = HelpPanel::default();
        self.overlay.drop_key_focus();
    }

    pub(super) fn takes_text(&self) -> bool {
        let of_panel = self.ui_state.panel.as_ref().is_some_and(OpenPanel::takes_text);
        self.ui_state.panels.help || of_panel || self.editor_has_focus()
    }

    fn scene_browser(&mut self, playback: &Playback) -> SceneBrowser {
        let scenes = playback.scene.preparation.library.all_sources();
        let favourites = playback.listening.sound.kept.settings().favourite_scenes.clone();
        let browser = SceneBrowser::new(scenes, playback.scene.scenes.shown_source(), favourites);
        if let Some(thumbnails) = self.started_thumbnails() {
            browser.request_descriptions(thumbnails);
        }
        browser
    }

    /// The thread of thumbnails, which starts with the first call.
    fn started_thumbnails(&mut self) -> Option<&mut Thumbnails> {
        if self.thumbnails.is_none() {
            match Thumbnails::start(&self.folders, self.waker.waking()) {
                Ok(thumbnails) => self.thumbnails = Some(thumbnails),
                Err(error) => tracing::warn!("cannot show thumbnails of scenes: {error}"),
            }
        }
        self.thumbnails.as_mut()
    }

    /// Passes finished thumbnails to the scene list and the phones, and requests thumbnails that phones want.
    pub(super) fn update_thumbnails(&mut self, playback: &mut Playback) {
        let wanted = playback.controllers.wanted_pictures();
        if !wanted.is_empty()
            && let Some(thumbnails) = self.started_thumbnails()
        {
            thumbnails.request_pictures_later(wanted);
        }
        let Some(thumbnails) = &mut self.thumbnails else { return };
        let found: Vec<_> = std::iter::from_fn(|| thumbnails.poll()).collect();
        found.iter().for_each(|looked| playback.controllers.phones.record_picture(looked));
        if let Some(OpenPanel::Scenes(browser)) = &mut self.ui_state.panel {
            browser.request_thumbnails(thumbnails);
            browser.set_present(playback.scene.scenes.shown_source());
            browser.store(found);
        }
    }
}
