//! The settings during a show. A change applies at once, and a writer thread stores it immediately, so that a crash
//! loses no settings and a slow disk delays nothing.

use std::path::PathBuf;
use std::time::Duration;

use mariana_work::{Worker, in_order};

use super::settings::{Settings, SettingsFile};
use super::stored_file::StoredFileError;

/// The current settings and the thread that writes them. Dropping it waits until everything is written.
pub struct KeptSettings {
    settings: Settings,
    writer_thread: Worker<Job, Result<Settings, StoredFileError>>,
}

/// Writes a change.
type Job = Box<dyn FnOnce(&mut SettingsFile) -> Result<(), StoredFileError> + Send>;

impl KeptSettings {
    /// Starts with the settings in `file`. If the writer thread cannot start, changes last until the program ends.
    pub fn of(mut file: SettingsFile) -> Self {
        let settings = file.settings().clone();
        let work = move |job: Job| Some(job(&mut file).map(|()| file.settings().clone()));
        let writer_thread = in_order("settings", || {}, || work).unwrap_or_default();
        Self { settings, writer_thread: writer_thread.finished_at_drop(Duration::MAX) }
    }

    /// Returns the current settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Changes the settings here and in the file.
    pub fn change(&mut self, change: impl Fn(&mut Settings) + Send + 'static) {
        change(&mut self.settings);
        self.give(Box::new(move |file: &mut SettingsFile| file.change(change)));
    }

    /// Stores the track list for the next run; `None` removes it.
    pub fn keep_tracks(&mut self, tracks: Option<Vec<PathBuf>>) {
        self.give(Box::new(move |file: &mut SettingsFile| file.keep_tracks(tracks.as_deref())));
    }

    /// Takes the results of finished writes. Returns the next error, if any.
    pub fn poll(&mut self) -> Option<StoredFileError> {
        loop {
            match self.writer_thread.poll()? {
                Err(error) => return Some(error),
                // Adopt other windows' changes to the file, unless a change from here still waits to be written.
                Ok(settings) if self.writer_thread.is_idle() => self.settings = settings,
                Ok(_) => {}
            }
        }
    }

    /// Waits until everything is written. Returns the errors.
    pub fn finish(&mut self) -> Vec<StoredFileError> {
        self.writer_thread.finish(Duration::MAX);
        std::iter::from_fn(|| self.poll()).collect()
    }

    fn give(&mut self, job: Job) {
        if !self.writer_thread.send(job) {
            tracing::warn!(
                "a setting is not saved and lasts until the program ends: the writer thread is not running"
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_apply_at_once_and_are_merged_with_other_windows_changes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mariana/settings.toml");
        let open = || SettingsFile::open(Some(path.clone())).0;
        let mut kept = KeptSettings::of(open());
        open().change(|settings| settings.system = Some("p:tv.monitor".into())).unwrap();
        for number in 0..20 {
            kept.change(move |settings| settings.microphone = Some(format!("p:mic {number}")));
            assert_eq!(kept.settings().microphone, Some(format!("p:mic {number}")));
        }
        kept.keep_tracks(Some(vec!["/music/a.ogg".into()]));
        assert!(kept.finish().is_empty());
        let next = open();
        assert_eq!(next.settings().microphone.as_deref(), Some("p:mic 19"));
        assert_eq!(next.settings().system.as_deref(), Some("p:tv.monitor"));
        assert!(next.last_tracks().is_some());
    }

    #[test]
    fn a_failed_write_is_reported_and_the_change_still_applies() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("taken"), "").unwrap();
        let mut kept =
            KeptSettings::of(SettingsFile::open(Some(folder.path().join("taken/settings.toml"))).0);
        kept.change(|settings| settings.system = Some("p:a.monitor".into()));
        assert_eq!(kept.finish().len(), 1);
        assert_eq!(kept.settings().system.as_deref(), Some("p:a.monitor"));
    }
}
