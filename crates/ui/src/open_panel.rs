//! The open panel, for panels that have a state.

use std::hash::{Hash, Hasher};

use mariana_commands::Command;
use mariana_commands::input::{Key, Modifiers};

use crate::controllers_panel::ControllersPanel;
use crate::corner_handles::CornerHandles;
use crate::file_browser::FileBrowser;
use crate::scene_browser::SceneBrowser;
use crate::settings_panel::SettingsPanel;
use crate::track_panel::TrackPanel;
use crate::video_panel::VideoPanel;

/// The open panel. Its state ends when the panel closes.
pub enum OpenPanel {
    /// The track list.
    Tracks(TrackPanel),
    /// The scene list.
    Scenes(SceneBrowser),
    /// The file list.
    Files(FileBrowser),
    /// The settings panel.
    Settings(SettingsPanel),
    /// The controllers panel.
    Controllers(ControllersPanel),
    /// The panel that makes videos.
    Video(VideoPanel),
    /// The handles at the corners of the image.
    Corners(CornerHandles),
}

impl OpenPanel {
    /// Applies a key. Returns its commands, or `None` if the panel does not use the key.
    pub fn handle_key(&mut self, key: &Key, held: Modifiers) -> Option<Vec<Command>> {
        let command = held.intersects(Modifiers::CONTROL | Modifiers::SUPER);
        match self {
            Self::Tracks(panel) => panel.handle_key(key, held),
            Self::Scenes(panel) => Some(panel.handle_key(key, command)),
            Self::Files(panel) => Some(panel.handle_key(key, held)),
            Self::Settings(panel) => panel.handle_key(key),
            Self::Controllers(panel) => panel.handle_key(key),
            Self::Video(panel) => panel.handle_key(key),
            Self::Corners(panel) => panel.handle_key(key, held.contains(Modifiers::SHIFT)),
        }
    }

    /// True if the panel has a search text, to which letters belong.
    pub fn is_searching(&self) -> bool {
        match self {
            Self::Tracks(panel) => panel.is_searching(),
            Self::Scenes(panel) => !panel.query().is_empty(),
            Self::Files(panel) => !panel.query().is_empty(),
            _ => false,
        }
    }

    /// True if letters begin or extend a search text.
    pub fn takes_text(&self) -> bool {
        matches!(self, Self::Scenes(_) | Self::Files(_)) || self.is_searching()
    }
}

impl Hash for OpenPanel {
    fn hash<H: Hasher>(&self, state: &mut H) {
        std::mem::discriminant(self).hash(state);
        match self {
            Self::Tracks(panel) => {
                (panel.revision(), panel.present, panel.selected, panel.query()).hash(state);
            }
            Self::Scenes(panel) => (panel.revision, panel.selected).hash(state),
            Self::Files(panel) => (panel.revision(), panel.selected, panel.selected_place).hash(state),
            Self::Settings(panel) => (panel.revision, panel.selected, panel.turned).hash(state),
            Self::Controllers(panel) => (panel.revision, panel.selected, panel.field()).hash(state),
            Self::Video(panel) => (panel.revision, panel.selected, panel.selected_button()).hash(state),
            Self::Corners(handles) => {
                (handles.selected, handles.places().map(|place| place.map(f64::to_bits))).hash(state);
            }
        }
    }
}
