//! The settings during a show. A change holds at once; a thread writes it to the file, because a disk may be slow.
//!
//! Changes are written as they come, so that an end without warning forgets nothing.

use std::path::PathBuf;

use super::settings::{Settings, SettingsError, SettingsFile};
use super::writer_thread::WriterThread;

/// See the module. Dropping it waits until everything is written.
pub struct KeptSettings {
    settings: Settings,
    writer_thread: WriterThread<Job, Result<Settings, SettingsError>>,
}

enum Job {
    Change(Box<dyn Fn(&mut Settings) + Send>),
    Tracks(Option<Vec<PathBuf>>),
}

impl KeptSettings {
    /// The settings in `file`. Without a thread for writing, changes last as long as the program.
    pub fn of(mut file: SettingsFile) -> Self {
        let settings = file.settings().clone();
        let work = move |job| {
            match job {
                Job::Change(change) => file.change(change)?,
                Job::Tracks(tracks) => file.keep_tracks(tracks.as_deref())?,
            }
            Ok(file.settings().clone())
        };
        Self { settings, writer_thread: WriterThread::start("settings", work) }
    }

    /// The present settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Changes them here and in the file.
    pub fn change(&mut self, change: impl Fn(&mut Settings) + Send + 'static) {
        change(&mut self.settings);
        self.give(Job::Change(Box::new(change)));
    }

    /// Keeps the list of tracks for the next show; `None` removes it.
    pub fn keep_tracks(&mut self, tracks: Option<Vec<PathBuf>>) {
        self.give(Job::Tracks(tracks));
    }

    /// Takes in what was written. Returns the next error, if any.
    pub fn poll(&mut self) -> Option<SettingsError> {
        loop {
            match self.writer_thread.poll()? {
                Err(error) => return Some(error),
                // Other windows write to the file, too. What is still to be written is newer.
                Ok(settings) if self.writer_thread.is_idle() => self.settings = settings,
                Ok(_) => {}
            }
        }
    }

    /// Waits until everything is written. Returns what failed.
    pub fn finish(&mut self) -> Vec<SettingsError> {
        self.writer_thread.finish().into_iter().filter_map(Result::err).collect()
    }

    fn give(&mut self, job: Job) {
        if !self.writer_thread.give(job) {
            tracing::warn!("a setting lasts as long as the program: there is no thread to write it");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_hold_at_once_and_are_written_in_their_order_with_those_of_other_windows() {
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
    fn a_file_that_cannot_be_written_is_reported_and_the_change_holds() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("taken"), "").unwrap();
        let mut kept =
            KeptSettings::of(SettingsFile::open(Some(folder.path().join("taken/settings.toml"))).0);
        kept.change(|settings| settings.system = Some("p:a.monitor".into()));
        assert_eq!(kept.finish().len(), 1);
        assert_eq!(kept.settings().system.as_deref(), Some("p:a.monitor"));
    }
}
