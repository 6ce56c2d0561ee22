//! The file list and the track list of a session, and the shaders that the user opens: each becomes a scene in the
//! folder of the user's scenes.

use std::path::{Path, PathBuf};

use mariana_work::once;

use super::{Interface, Playback, Session};
use crate::commands::{Files, Panel};
use crate::scenes::{ImportedShader, SceneSource, import_shader, is_scene_file, is_shader_file};
use crate::ui::file_browser::{FileBrowser, RememberedFolders};
use crate::ui::open_panel::OpenPanel;
use crate::ui::track_panel::TrackPanel;
use mariana_player::Edit;

impl Session {
    /// Takes back the last change of the track list.
    pub(super) fn undo_tracks(&mut self) {
        let undone = self.playback.listening.with_song(|player| {
            let edit = player.playlist().undo.clone();
            player.edit(Edit::Undo);
            edit
        });
        let words = match undone {
            Some(Some(edit)) => format!("undone: {edit}"),
            Some(None) => "the track list has no change to undo".to_owned(),
            None => "no song is playing: an audio input has no track list".to_owned(),
        };
        self.playback.reports.answer(words);
    }
}

impl Playback {
    fn folder_of_track(&mut self) -> Option<PathBuf> {
        let entry = self.reports.playing.place.0;
        let tracks = self.listening.with_song(|player| player.playlist())?;
        let file = tracks.entries.get(entry)?.file.as_deref()?;
        std::path::absolute(file).ok()?.parent().map(Path::to_owned)
    }
}

impl Interface {
    /// Shows what the threads have read, and requests the tags of a new track list.
    pub(super) fn update_music_lists(&mut self, playback: &mut Playback) {
        if let Some(OpenPanel::Files(files)) = &mut self.ui_state.panel {
            files.update();
        }
        // Nothing may delay the first frame.
        if playback.pace.shown.is_none() {
            return;
        }
        let list = playback.listening.with_song(|player| player.playlist());
        if let Some(list) = &list {
            self.lists.tags.follow_list(list);
        }
        let list = list.filter(|_| self.ui_state.panels.open == Some(Panel::Tracks));
        let present = playback.reports.playing.place.0;
        match (list, &mut self.ui_state.panel) {
            (Some(list), Some(OpenPanel::Tracks(panel))) => panel.update(&list, present),
            (Some(list), panel) => {
                *panel = Some(OpenPanel::Tracks(TrackPanel::new(list, present, self.lists.tags.clone())));
            }
            (None, panel) => drop(panel.take_if(|panel| matches!(panel, OpenPanel::Tracks(_)))),
        }
    }

    pub(super) fn file_browser(&self, playback: &mut Playback) -> FileBrowser {
        let folder = self.lists.last_folder.clone().or_else(|| playback.folder_of_track());
        let settings = playback.listening.sound.kept.settings();
        let remembered = RememberedFolders {
            favourites: settings.favourite_folders.clone(),
            recent: settings.recent_folders.clone(),
        };
        FileBrowser::start(folder, remembered, self.lists.tags.clone(), self.waker.waking())
    }

    /// Shows the last scene or shader among these files, and plays the other files or appends them to the tracks.
    pub(super) fn open_files(&mut self, playback: &mut Playback, Files { files, append }: Files) {
        let shown = match &self.ui_state.panel {
            Some(OpenPanel::Files(list)) => Some(list.folder.clone()),
            _ => None,
        };
        let folder = shown.or_else(|| files.last().and_then(|file| file.parent()).map(Path::to_owned));
        let (scenes, music): (Vec<_>, Vec<_>) = files.into_iter().partition(|file| is_scene_file(file));
        let (shaders, music): (Vec<_>, Vec<_>) = music.into_iter().partition(|file| is_shader_file(file));
        if let Some(scene) = scenes.into_iter().next_back() {
            playback.scene.show_source(SceneSource::File(scene));
        } else if let Some(shader) = shaders.into_iter().next_back() {
            self.import_shader(playback, shader);
        }
        if !music.is_empty() {
            if let Some(folder) = folder.as_deref().and_then(Path::to_str).map(str::to_owned) {
                playback.listening.sound.kept.change(move |settings| settings.add_recent_folder(&folder));
            }
            playback.reports.answer_any(playback.listening.play_files(music, append));
        }
        self.lists.last_folder = folder;
    }

    /// Makes a scene of a shader, which is shown when it is ready.
    pub(super) fn import_shader(&mut self, playback: &mut Playback, shader: PathBuf) {
        let Some(folder) = self.folders.own_scenes() else {
            let words = "there is no folder for your own scenes: make a scene with `mariana import`";
            return playback.reports.answer(words);
        };
        // Executing a shader may take longer than a frame.
        match once("import", self.waker.waking(), move || import_shader(&shader, &folder)) {
            Ok(import) => self.shader_import = import,
            Err(error) => playback.reports.answer(format!("cannot import the shader: {error}")),
        }
    }

    /// Shows an imported shader. If the import has failed, reports the reason, and the scene stays.
    pub(super) fn update_shader_import(&mut self, playback: &mut Playback) {
        match self.shader_import.poll() {
            Some(Ok(Ok(ImportedShader { scene, notes }))) => {
                let words = [vec![format!("imported as {}", scene.display())], notes].concat();
                playback.reports.answer(words.join("; "));
                playback.scene.show_source(SceneSource::File(scene));
            }
            Some(Ok(Err(error))) => playback.reports.answer(error.to_string()),
            Some(Err(_)) => playback.reports.answer("the shader could not be imported"),
            None => {}
        }
    }
}
