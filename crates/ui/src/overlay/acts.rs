//! What the user's input in the panels does.

use crate::editor::Editor;
use crate::file_browser::FileBrowser;
use crate::help_panel::HelpPanel;
use crate::scene_browser::SceneBrowser;
use crate::settings_panel::SettingsPanel;
use crate::track_panel::TrackPanel;
use mariana_commands::Command;

/// A pass of egui over the panels, and what the input in it does.
pub(super) struct Pass<'a> {
    pub context: &'a egui::Context,
    pub acts: &'a mut Acts,
}

/// What the user's input does: first the changes of the panels in their order, then the commands.
#[derive(Default)]
pub struct Acts {
    /// Changes of the panels.
    pub on_panels: Vec<PanelAct>,
    /// Commands for the session.
    pub commands: Vec<Command>,
}

impl Acts {
    /// Adds a change that the editor shows.
    pub(super) fn on_editor(&mut self, act: impl FnOnce(&mut Editor) + Send + 'static) {
        self.on_panels.push(PanelAct::Editor(Box::new(|editor: &mut Editor| {
            editor.revision += 1;
            act(editor);
        })));
    }
}

/// A change of an open panel.
pub enum PanelAct {
    /// Of the table of keys.
    Help(On<HelpPanel>),
    /// Of the scene editor.
    Editor(Box<dyn FnOnce(&mut Editor) + Send>),
    /// Of the scene list.
    Scenes(On<SceneBrowser>),
    /// Of the file list.
    Files(On<FileBrowser>),
    /// Of the track list.
    Tracks(On<TrackPanel>),
    /// Of the settings panel.
    Settings(On<SettingsPanel>),
}

/// Changes a panel. Returns the panel's commands, if it sends any.
pub type On<Panel> = Box<dyn FnOnce(&mut Panel) -> Vec<Command> + Send>;

/// A change without a command.
pub(super) fn on<Panel>(act: impl FnOnce(&mut Panel) + Send + 'static) -> On<Panel> {
    Box::new(move |panel| {
        act(panel);
        Vec::new()
    })
}
