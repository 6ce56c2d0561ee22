//! The settings file: a small TOML file in the user's configuration folder.
//!
//! ```toml
//! microphone = "pulseaudio:alsa_input.usb-mic"        # the source of --mic; absent: the default input
//! system = "pulseaudio:hdmi.monitor"                   # the source of --system; absent: the default output's monitor
//!
//! [choices]                                            # the settings panel, by the names of the flags
//! quality = "high"
//! flash_limiter = "off"
//!
//! [latency_ms]                                         # by device: the delay of the image in milliseconds
//! "pulseaudio:bluez_output.headphones" = 180.0
//! ```
//!
//! Devices are stored by their ids, which are names, not numbers. A file that cannot be read is reported once, and
//! Mariana continues with the defaults; the next write keeps the unreadable file under another name. Entries of a newer
//! version are kept in the file.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::time::Duration;

use mariana_control::SoundBinding;
use mariana_player::limits as player_limits;
use serde::{Deserialize, Serialize};

use super::choices::Choices;
use super::last_show::{self, LastShow};
use super::stored_file::{SETTINGS, StoredFileError};
use super::understood::{rewrite, understood};
use crate::limits;
use mariana_files::Folders;

/// The contents of the settings file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// The id of the input for `--mic`; `None` is the default input.
    pub microphone: Option<String>,
    /// The id of the monitor for `--system`; `None` is the default output's monitor.
    pub system: Option<String>,
    /// The choices in the settings panel.
    pub choices: Choices,
    /// The titles of the marked scenes.
    pub favourite_scenes: BTreeSet<String>,
    /// The folders that the user has marked in the file list.
    pub favourite_folders: BTreeSet<String>,
    /// The folders from which music was opened, the newest first.
    pub recent_folders: Vec<String>,
    /// The state of the last show, for the next start.
    pub last_show: Option<LastShow>,
    /// The values of moved sliders, by scene and parameter.
    pub sliders: BTreeMap<String, BTreeMap<String, f32>>,
    /// The sounds that move sliders, by scene and parameter.
    pub bindings: BTreeMap<String, BTreeMap<String, SoundBinding>>,
    /// The snapshots of sliders, by scene and number.
    pub snapshots: BTreeMap<String, BTreeMap<String, Snapshot>>,
    /// The extra delay of the image by device id, in milliseconds, on top of the latency that the device reports.
    pub latency_ms: BTreeMap<String, f64>,
}

impl Settings {
    /// Notes that music was opened from `folder`.
    pub fn add_recent_folder(&mut self, folder: &str) {
        self.recent_folders.retain(|known| known != folder);
        self.recent_folders.insert(0, folder.to_owned());
        self.recent_folders.truncate(limits::RECENT_FOLDERS_MAX);
    }

    /// Returns the moved sliders of the scene with this title, and their sounds.
    pub fn moved(&self, title: &str) -> Snapshot {
        Snapshot {
            sliders: self.sliders.get(title).cloned().unwrap_or_default(),
            bindings: self.bindings.get(title).cloned().unwrap_or_default(),
        }
    }
}

/// All sliders of a scene at a moment.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Snapshot {
    /// The values, by parameter.
    pub sliders: BTreeMap<String, f32>,
    /// The sounds that move sliders, by parameter.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub bindings: BTreeMap<String, SoundBinding>,
}

/// The maximum number of keys that a message names.
const NAMED_MAX: usize = 3;
/// The maximum number of characters that a message shows of a key.
const NAME_LETTERS_MAX: usize = 40;

/// The settings file and its contents.
#[derive(Debug)]
pub struct SettingsFile {
    /// `None` if the system has no settings folder: then settings last until the program ends.
    path: Option<PathBuf>,
    settings: Settings,
}

impl SettingsFile {
    /// Opens the user's file and returns its problem, if any. A missing file is not an error.
    pub fn among(folders: &Folders) -> (Self, Option<StoredFileError>) {
        Self::open(folders.config.as_ref().map(|config| config.join("settings.toml")))
    }

    /// Opens the file at `path`; with `None`, settings last until the program ends.
    pub fn open(path: Option<PathBuf>) -> (Self, Option<StoredFileError>) {
        let read = path.as_deref().map_or_else(|| Ok(Found::default()), |path| SETTINGS.read(path, parse));
        let (settings, error) = match (read, &path) {
            (Ok(Found { settings, strange, .. }), Some(path)) if !strange.is_empty() => {
                (settings, Some(newer(path, &strange)))
            }
            (Ok(found), _) => (found.settings, None),
            (Err(error), _) => (Settings::default(), Some(error)),
        };
        (Self { path, settings }, error)
    }

    /// Returns the current settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Returns the file with the track list of the last show, if it exists.
    pub fn last_tracks(&self) -> Option<PathBuf> {
        self.path.as_deref().map(last_show::tracks_file).filter(|file| file.is_file())
    }

    /// Stores the track list for the next start. Removes the stored list if a path cannot be written in a list.
    ///
    /// # Errors
    /// Fails if the file cannot be written.
    pub fn keep_tracks(&self, tracks: Option<&[PathBuf]>) -> Result<(), StoredFileError> {
        self.path.as_deref().map_or(Ok(()), |path| last_show::keep_tracks(path, tracks))
    }

    /// Changes the settings here and in the file's current contents, which other windows may have changed.
    ///
    /// # Errors
    /// Fails if the file cannot be written. The change then lasts until the program ends.
    pub fn change(&mut self, change: impl Fn(&mut Settings)) -> Result<(), StoredFileError> {
        change(&mut self.settings);
        let Some(path) = &self.path else { return Ok(()) };
        let _turn = turn_of(path);
        let Some(Found { mut table, settings: before, .. }) = SETTINGS.read_or_rename(path, parse)? else {
            return write(path, &mut toml::Table::new(), &Settings::default(), &self.settings);
        };
        let mut after = before.clone();
        change(&mut after);
        write(path, &mut table, &before, &after)?;
        self.settings = after;
        Ok(())
    }
}

/// Locks the folder of the settings file, so that no two windows read and write the file at the same time. The lock
/// lasts until the result is dropped. Returns `None` if the folder cannot be locked within half a second.
fn turn_of(path: &Path) -> Option<File> {
    let folder = File::open(path.parent()?).ok()?;
    for _ in 0..TURN_LOOKS {
        match folder.try_lock() {
            Ok(()) => return Some(folder),
            Err(TryLockError::WouldBlock) => std::thread::sleep(TURN_PERIOD),
            Err(TryLockError::Error(_)) => return None,
        }
    }
    None
}

/// The interval between the attempts of [`turn_of`], and the number of attempts.
const TURN_PERIOD: Duration = Duration::from_millis(5);
const TURN_LOOKS: u32 = 100;

#[derive(Default)]
struct Found {
    table: toml::Table,
    settings: Settings,
    /// The names of the unknown entries.
    strange: Vec<String>,
}

fn newer(path: &Path, strange: &[String]) -> StoredFileError {
    let short = |name: &String| name.chars().take(NAME_LETTERS_MAX).filter(|c| !c.is_control()).collect();
    let mut names: Vec<String> = strange.iter().take(NAMED_MAX).map(short).collect();
    if strange.len() > NAMED_MAX {
        names.push(format!("{} more", strange.len() - NAMED_MAX));
    }
    StoredFileError::Newer { path: path.to_owned(), names: names.join(", ") }
}

fn parse(text: &str) -> Result<Found, String> {
    let table: toml::Table =
        toml::from_str(text).map_err(|error| error.message().trim().replace('\n', " "))?;
    let (mut settings, strange): (Settings, _) = understood(&table);
    let range = -player_limits::LATENCY_MS_MAX..=player_limits::LATENCY_MS_MAX;
    settings.latency_ms.retain(|_, shift| range.contains(shift));
    let snapshots = settings.snapshots.values_mut().flat_map(BTreeMap::values_mut);
    let (sliders, bindings): (Vec<_>, Vec<_>) =
        snapshots.map(|one| (&mut one.sliders, &mut one.bindings)).unzip();
    for sliders in settings.sliders.values_mut().chain(sliders) {
        sliders.retain(|_, value| value.is_finite());
    }
    for bindings in settings.bindings.values_mut().chain(bindings) {
        bindings.retain(|_, binding| binding.clone().mended().is_some());
    }
    Ok(Found { table, settings, strange })
}

/// Writes `table` with the differences between `before` and `after` applied.
fn write(
    path: &Path,
    table: &mut toml::Table,
    before: &Settings,
    after: &Settings,
) -> Result<(), StoredFileError> {
    let failed = |error: &dyn std::fmt::Display| SETTINGS.refused(path, "written", error);
    rewrite(table, before, after).map_err(|error| failed(&error))?;
    let text = toml::to_string(table).map_err(|error| failed(&error))?;
    SETTINGS.write(path, &text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::fs::create_dir_all;

    fn folder() -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mariana/settings.toml");
        (folder, path)
    }

    fn with_text(path: &Path, text: &[u8]) -> (SettingsFile, Option<StoredFileError>) {
        create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
        SettingsFile::open(Some(path.to_owned()))
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn settings_that_are_a_pipe_stopped_the_start() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("settings.toml");
        assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
        assert!(matches!(SettingsFile::open(Some(path)).1, Some(StoredFileError::Refused { .. })));
    }

    #[test]
    fn changes_are_read_back_and_merged_with_other_windows_changes() {
        let (_folder, path) = folder();
        let (mut one, error) = SettingsFile::open(Some(path.clone()));
        assert!(error.is_none() && *one.settings() == Settings::default());
        let (mut other, _) = SettingsFile::open(Some(path.clone()));
        one.change(|settings| settings.microphone = Some("p:\"odd\" mic\n".into())).unwrap();
        other.change(|settings| settings.latency_ms = [("p:tv".into(), -35.0)].into()).unwrap();
        let (next, error) = SettingsFile::open(Some(path.clone()));
        assert!(error.is_none());
        assert_eq!(next.settings().microphone.as_deref(), Some("p:\"odd\" mic\n"));
        assert_eq!(next.settings().latency_ms, [("p:tv".to_owned(), -35.0)].into());
        assert_eq!(std::fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
    }

    #[test]
    fn simultaneous_changes_of_several_windows_are_all_kept() {
        let (_folder, path) = folder();
        create_dir_all(path.parent().unwrap()).unwrap();
        std::thread::scope(|scope| {
            for window in 0..4 {
                let (mut file, _) = SettingsFile::open(Some(path.clone()));
                scope.spawn(move || {
                    for device in 0..10 {
                        let id = format!("p:{window}.{device}");
                        file.change(|settings| {
                            settings.latency_ms.insert(id.clone(), 5.0);
                        })
                        .unwrap();
                    }
                });
            }
        });
        assert_eq!(SettingsFile::open(Some(path)).0.settings().latency_ms.len(), 40);
    }

    #[test]
    fn a_broken_file_is_reported_and_renamed_at_the_first_change() {
        for text in
            [&b"microphone = "[..], b"[latency_ms", b"\xff\xfe", b"unknown = \"key\" = 3", &[b'#'; 1 << 21]]
        {
            let (_folder, path) = folder();
            let (mut file, error) = with_text(&path, text);
            let reported = error.expect("a broken file is reported").to_string();
            let aside = path.with_extension("toml.broken");
            assert!(reported.ends_with(&format!("renames this file to {}", aside.display())), "{reported}");
            assert!(!reported.contains("delete"), "{reported}");
            assert_eq!(*file.settings(), Settings::default());
            assert_eq!(std::fs::read(&path).unwrap(), text, "opening must not change the file");
            file.change(|settings| settings.system = Some("p:a.monitor".into())).unwrap();
            assert_eq!(std::fs::read(&aside).unwrap(), text);
            let (next, error) = SettingsFile::open(Some(path.clone()));
            assert!(error.is_none());
            assert_eq!(next.settings().system.as_deref(), Some("p:a.monitor"));
            // A second broken file does not overwrite the first.
            let (mut file, _) = with_text(&path, b"[");
            file.change(|settings| settings.system = None).unwrap();
            assert_eq!(std::fs::read(&aside).unwrap(), text);
            assert_eq!(std::fs::read(path.with_extension("toml.broken-2")).unwrap(), b"[");
        }
    }

    #[test]
    fn unknown_entries_are_reported_and_kept() {
        let (_folder, path) = folder();
        let text = b"microphone = \"p:mic\"\nmood = 3\n[choices]\nquality = \"ultra\"\ngain = \"off\"\n\
                     [last_show]\nvolume = 0.5\nhat = true\n";
        let (mut file, error) = with_text(&path, text);
        let reported = error.expect("unknown entries are reported").to_string();
        assert!(
            reported.contains("(choices.quality, last_show.hat, mood)") && reported.contains("kept"),
            "{reported}"
        );
        assert_eq!(file.settings().microphone.as_deref(), Some("p:mic"));
        assert_eq!(file.settings().last_show.as_ref().and_then(|show| show.volume), Some(0.5));
        assert_eq!(file.settings().choices, Choices { gain: mariana_music::Gain::Off, ..Choices::default() });
        file.change(|settings| {
            settings.microphone = None;
            settings.last_show = Some(LastShow { volume: Some(0.25), ..LastShow::default() });
        })
        .unwrap();
        let kept: toml::Table = std::fs::read_to_string(&path).unwrap().parse().unwrap();
        assert_eq!((kept.get("microphone"), kept["mood"].as_integer()), (None, Some(3)));
        assert_eq!(kept["choices"]["quality"].as_str(), Some("ultra"));
        assert_eq!(kept["choices"]["gain"].as_str(), Some("off"));
        assert_eq!(kept["last_show"]["hat"].as_bool(), Some(true));
        assert_eq!(kept["last_show"]["volume"].as_float(), Some(0.25));
        assert!(!path.with_extension("toml.broken").exists());
        file.change(|settings| settings.choices.quality = crate::QualityChoice::Low).unwrap();
        let (next, error) = SettingsFile::open(Some(path));
        assert_eq!(next.settings().choices.quality, crate::QualityChoice::Low);
        assert!(error.is_some_and(|error| error.to_string().contains("(last_show.hat, mood)")));
        // The message stays short.
        let many: Vec<String> = (0..9).map(|n| format!("{n}\n").repeat(100)).collect();
        assert!(newer(Path::new("a"), &many).to_string().len() < 300);
    }

    #[test]
    fn an_unwritable_folder_is_reported_and_changes_still_apply() {
        let (folder, _) = folder();
        std::fs::write(folder.path().join("taken"), "").unwrap();
        let (mut file, error) = SettingsFile::open(Some(folder.path().join("taken/settings.toml")));
        let reported = error.expect("the folder does not exist").to_string();
        assert!(reported.contains("cannot be read"), "{reported}");
        assert!(file.change(|settings| settings.system = Some("p:a.monitor".into())).is_err());
        assert_eq!(file.settings().system.as_deref(), Some("p:a.monitor"));
        let (mut file, error) = SettingsFile::open(None);
        assert!(error.is_none());
        file.change(|settings| settings.microphone = Some("m".into())).unwrap();
        assert_eq!(file.settings().microphone.as_deref(), Some("m"));
    }

    /// Simulates a full disk: the test runs itself in a child process whose files may not grow.
    #[cfg(unix)]
    #[test]
    fn a_full_disk_does_not_damage_the_old_settings() {
        const PLACE: &str = "MARIANA_TEST_SETTINGS";
        let refused = "the settings are refused";
        if let Some(path) = std::env::var_os(PLACE) {
            let (mut file, error) = SettingsFile::open(Some(path.into()));
            assert!(error.is_none());
            let error = file.change(|settings| settings.system = Some("p:a.monitor".into())).unwrap_err();
            println!("{refused}: {error}");
            return;
        }
        let (_folder, path) = folder();
        let (mut file, _) = SettingsFile::open(Some(path.clone()));
        file.change(|settings| settings.microphone = Some("p:mic".into())).unwrap();
        let before = std::fs::read(&path).unwrap();
        let own = std::thread::current().name().unwrap().to_owned();
        let mut shell = std::process::Command::new("sh");
        shell.args(["-c", "trap '' XFSZ; ulimit -f 0; exec \"$0\" --exact --nocapture \"$1\""]);
        shell.arg(std::env::current_exe().unwrap()).arg(own).env(PLACE, &path);
        let output = shell.output().unwrap();
        let reported = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{reported} {}", String::from_utf8_lossy(&output.stderr));
        let sentence =
            reported.lines().find(|line| line.contains(refused)).unwrap_or_else(|| panic!("{reported}"));
        assert!(sentence.contains("settings.toml cannot be written"), "{sentence}");
        assert!(!sentence.contains(".mariana-"), "{sentence}");
        assert_eq!(std::fs::read(&path).unwrap(), before);
        assert_eq!(
            std::fs::read_dir(path.parent().unwrap()).unwrap().count(),
            1,
            "a temporary file was left"
        );
    }

    proptest! {
        #[test]
        fn any_text_parses_within_the_limits(text in "(microphone|system|\\[latency_ms\\]|\"a\"| |=|\n|\"b\"|1e9|nan|-5.5|\\PC){0,24}") {
            let (_folder, path) = folder();
            let (file, _) = with_text(&path, text.as_bytes());
            prop_assert!(file.settings().latency_ms.values().all(|shift| shift.abs() <= player_limits::LATENCY_MS_MAX));
        }
    }
}
