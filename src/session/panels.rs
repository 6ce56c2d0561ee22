//! The panels over the frame. They are plain values, which this module changes on key and pointer commands.

use std::time::{Duration, Instant};

use super::{Interface, Playback, Session};
use crate::clock;
use crate::commands::{Command, Panel};
use crate::limits;
use crate::thumbnails::Thumbnails;
use crate::ui::help_panel::HelpPanel;
use crate::ui::overlay::{Acts, PanelAct};
use crate::ui::scene_browser::SceneBrowser;
use crate::ui::track_panel::TrackPanel;

pub(super) fn thumbnails_ahead_at(now: Instant) -> Instant {
    now + Duration::from_secs_f64(limits::THUMBNAILS_AHEAD_AFTER)
}

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
        self.interface.toggle_scene_browser(&mut self.playback, open == Some(Panel::Scenes));
        self.interface.toggle_file_browser(&mut self.playback, open == Some(Panel::Files));
        self.show_settings(open == Some(Panel::Settings));
        self.interface.show_controllers(&mut self.playback, open == Some(Panel::Controllers));
        self.show_corners(open == Some(Panel::Corners));
        self.video_desk().show(open == Some(Panel::Video));
    }

    /// Closes the topmost panel, or leaves full screen.
    pub(super) fn leave(&mut self) {
        if self.playback.controllers.midi.stop_learning() {
            return self.interface.update_controllers(&mut self.playback);
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
            match act {
                PanelAct::Help(act) => of_panels.extend(act(&mut ui.help)),
                PanelAct::Editor(act) => _ = ui.editor.as_mut().map(act),
                PanelAct::Scenes(act) => of_panels.extend(ui.browser.as_mut().map(act).unwrap_or_default()),
                PanelAct::Files(act) => of_panels.extend(ui.files.as_mut().map(act).unwrap_or_default()),
                PanelAct::Tracks(act) => _ = ui.tracks.as_mut().map(act),
                PanelAct::Settings(act) => {
                    of_panels.extend(ui.settings.as_mut().map(act).unwrap_or_default());
                }
            }
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
        self.ui_state.panels.help
            || self.ui_state.browser.is_some()
            || self.ui_state.files.is_some()
            || self.ui_state.tracks.as_ref().is_some_and(TrackPanel::is_searching)
            || self.editor_has_focus()
    }

    fn toggle_scene_browser(&mut self, playback: &mut Playback, open: bool) {
        self.ui_state.browser = None;
        if !open {
            return;
        }
        self.request_thumbnails();
        let scenes = playback.scene.preparation.library.all_sources();
        let favourites = playback.listening.sound.settings().favourite_scenes.clone();
        let browser = SceneBrowser::new(scenes, playback.scene.scenes.shown_source(), favourites);
        if let Some(thumbnails) = &mut self.thumbnails {
            browser.request_descriptions(thumbnails);
        }
        self.ui_state.browser = Some(browser);
    }

    fn request_thumbnails(&mut self) {
        if self.thumbnails.is_none() {
            match Thumbnails::start(&self.folders, self.waker.waking()) {
                Ok(thumbnails) => self.thumbnails = Some(thumbnails),
                Err(error) => tracing::warn!("cannot show thumbnails of scenes: {error}"),
            }
        }
    }

    fn draw_thumbnails_ahead(&mut self, playback: &mut Playback) {
        if self.thumbnails_ahead.take_if(|due| clock::now() >= *due).is_none() {
            return;
        }
        let scenes = playback.scene.preparation.library.all_sources().into_iter();
        let of_folder = scenes.filter(|source| source.file().is_some());
        let of_folder: Vec<_> = of_folder.take(limits::THUMBNAILS_AHEAD_MAX).collect();
        if of_folder.is_empty() {
            return;
        }
        self.request_thumbnails();
        if let Some(thumbnails) = &mut self.thumbnails {
            thumbnails.draw_ahead(of_folder.into_iter());
        }
    }

    /// Passes finished thumbnails to the scene list and the phones, and requests thumbnails that phones want.
    pub(super) fn update_thumbnails(&mut self, playback: &mut Playback) {
        self.draw_thumbnails_ahead(playback);
        let wanted = playback.controllers.wanted_pictures();
        if !wanted.is_empty() {
            self.request_thumbnails();
        }
        let Some(thumbnails) = &mut self.thumbnails else { return };
        if !wanted.is_empty() {
            thumbnails.request_pictures_later(wanted);
        }
        if let Some(browser) = &mut self.ui_state.browser {
            browser.request_thumbnails(thumbnails);
        }
        let found: Vec<_> = std::iter::from_fn(|| thumbnails.poll()).collect();
        found.iter().for_each(|looked| playback.controllers.phones.record_picture(looked));
        if let Some(browser) = &mut self.ui_state.browser {
            browser.set_present(playback.scene.scenes.shown_source());
            browser.store(found);
        }
    }
}
