//! What is remembered from one run to the next, in a small TOML file in the user's folder for settings.
//!
//! ```toml
//! microphone = "pulseaudio:alsa_input.usb-mic"        # what --mic listens to; absent: the default input
//! system = "pulseaudio:hdmi.monitor"                   # what --system listens to; absent: what the default output plays
//!
//! [choices]                                            # what the panel of settings changes, by the names of flags
//! quality = "high"
//! flash_limiter = "off"
//!
//! [latency_ms]                                         # by device: how much later the picture is shown
//! "pulseaudio:bluez_output.headphones" = 180.0
//! ```
//!
//! Devices are remembered by their ids, which are names, not numbers. A file that cannot be read is reported once and
//! changes nothing else; when a new one is written, the unreadable one is kept beside it. What a newer version has
//! written is read as far as it is known, and stays in the file.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{File, TryLockError, create_dir_all};
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::time::Duration;

use mariana_player::limits::LIMITS as PLAYER_LIMITS;
use serde::{Deserialize, Serialize};

use super::aside::aside;
use super::choices::Choices;
use super::last_show::{self, LastShow};
use super::understood::{rewrite, understood};
use crate::limits::LIMITS;
use mariana_files::Folders;
use mariana_files::atomic_file::AtomicFile;

/// What is remembered.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Id of the input that `--mic` listens to; none is the default input.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub microphone: Option<String>,
    /// Id of the monitor that `--system` listens to; none is the default output's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub system: Option<String>,
    /// What was chosen in the panel of settings.
    #[serde(skip_serializing_if = "is_untouched")]
    pub choices: Choices,
    /// Names of the scenes that the user has marked.
    #[serde(skip_serializing_if = "BTreeSet::is_empty")]
    pub favourite_scenes: BTreeSet<String>,
    /// The last show, with which the next one begins.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub last_show: Option<LastShow>,
    /// By a scene's name: the sliders that were moved, by theirs.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub sliders: BTreeMap<String, BTreeMap<String, f32>>,
    /// By a device's id: how much later than the device says the picture is shown, in milliseconds.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub latency_ms: BTreeMap<String, f64>,
}

fn is_untouched(choices: &Choices) -> bool {
    *choices == Choices::default()
}

/// Most keys that a message names.
const NAMED_MAX: usize = 3;
/// Most letters of a key in it.
const NAME_LETTERS_MAX: usize = 40;

/// Why settings are not read or written, or not all of them. The show continues with those that it has.
#[derive(Debug, thiserror::Error)]
pub enum SettingsError {
    /// The file holds something other than settings.
    #[error("the settings in {} cannot be understood ({reason}): the defaults apply, and the first change keeps this file as {}", path.display(), aside.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
        /// Where it will be kept.
        aside: PathBuf,
    },
    /// A newer version has written it, or somebody has misspelt something.
    #[error("the settings in {} hold what this version does not know ({names}): that is kept, and all else applies", path.display())]
    Newer {
        /// The file.
        path: PathBuf,
        /// The keys, separated by commas.
        names: String,
    },
    /// The file is larger than settings ever are.
    #[error("the settings in {} are larger than {} bytes: the defaults apply, and the first change keeps this file as {}", path.display(), LIMITS.settings_bytes_max, aside.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Where it will be kept.
        aside: PathBuf,
    },
    /// The system refuses.
    #[error("the settings in {} cannot be {doing} ({reason}); check that folder's permissions", path.display())]
    System {
        /// The file.
        path: PathBuf,
        /// What was tried: read or written.
        doing: &'static str,
        /// What the system says.
        reason: String,
    },
}

/// The file, and what it holds.
#[derive(Debug)]
pub struct SettingsFile {
    /// None if the system has no place for settings: then they last as long as the program.
    path: Option<PathBuf>,
    settings: Settings,
}

impl SettingsFile {
    /// The user's file, and what is wrong with it, if anything. A missing file is not an error.
    pub fn among(folders: &Folders) -> (Self, Option<SettingsError>) {
        Self::open(folders.config.as_ref().map(|config| config.join("settings.toml")))
    }

    /// The same for another file; without one, settings last as long as the program.
    pub fn open(path: Option<PathBuf>) -> (Self, Option<SettingsError>) {
        let read = path.as_deref().map_or_else(|| Ok(Found::default()), read);
        let (settings, error) = match (read, &path) {
            (Ok(Found { settings, strange, .. }), Some(path)) if !strange.is_empty() => {
                (settings, Some(newer(path, &strange)))
            }
            (Ok(found), _) => (found.settings, None),
            (Err(error), _) => (Settings::default(), Some(error)),
        };
        (Self { path, settings }, error)
    }

    /// What is remembered.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The file with the list of the last show's tracks, if there is one.
    pub fn last_tracks(&self) -> Option<PathBuf> {
        self.path.as_deref().map(last_show::tracks_file).filter(|file| file.is_file())
    }

    /// Keeps the list of tracks for the next show, if there is a place for it and each can be named; else there is
    /// none for it.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn keep_tracks(&self, tracks: Option<&[PathBuf]>) -> Result<(), SettingsError> {
        self.path.as_deref().map_or(Ok(()), |path| last_show::keep_tracks(path, tracks))
    }

    /// Changes the settings here and in the file, which other windows may have changed in the meantime.
    ///
    /// # Errors
    /// The file cannot be written; then the change lasts as long as the program.
    pub fn change(&mut self, change: impl Fn(&mut Settings)) -> Result<(), SettingsError> {
        change(&mut self.settings);
        let Some(path) = &self.path else { return Ok(()) };
        let _turn = turn_of(path);
        let Found { mut table, settings: before, .. } = match read(path) {
            Ok(found) => found,
            Err(SettingsError::Malformed { aside, .. } | SettingsError::TooLarge { aside, .. }) => {
                std::fs::rename(path, aside).map_err(|error| refused(path, "written", &error))?;
                return write(path, &mut toml::Table::new(), &Settings::default(), &self.settings);
            }
            Err(error) => return Err(error),
        };
        let mut after = before.clone();
        change(&mut after);
        write(path, &mut table, &before, &after)?;
        self.settings = after;
        Ok(())
    }
}

/// Waits until no other window is between reading and writing the settings in `path`: a lock on their folder, held until
/// the result is dropped. `None` if the folder cannot be locked, or not within half a second.
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

/// How often, and how many times, [`turn_of`] tries.
const TURN_PERIOD: Duration = Duration::from_millis(5);
const TURN_LOOKS: u32 = 100;

/// What is in a file.
#[derive(Default)]
struct Found {
    /// Everything.
    table: toml::Table,
    /// As much of it as this version knows.
    settings: Settings,
    /// The names of the rest.
    strange: Vec<String>,
}

fn newer(path: &Path, strange: &[String]) -> SettingsError {
    let short = |name: &String| name.chars().take(NAME_LETTERS_MAX).filter(|c| !c.is_control()).collect();
    let mut names: Vec<String> = strange.iter().take(NAMED_MAX).map(short).collect();
    if strange.len() > NAMED_MAX {
        names.push(format!("{} more", strange.len() - NAMED_MAX));
    }
    SettingsError::Newer { path: path.to_owned(), names: names.join(", ") }
}

pub(super) fn refused(path: &Path, doing: &'static str, error: &dyn std::fmt::Display) -> SettingsError {
    SettingsError::System { path: path.to_owned(), doing, reason: error.to_string() }
}

fn read(path: &Path) -> Result<Found, SettingsError> {
    let file = match File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Found::default()),
        Err(error) => return Err(refused(path, "read", &error)),
    };
    let mut bytes = Vec::new();
    let limit = LIMITS.settings_bytes_max as u64;
    file.take(limit + 1).read_to_end(&mut bytes).map_err(|error| refused(path, "read", &error))?;
    if bytes.len() as u64 > limit {
        return Err(SettingsError::TooLarge { path: path.to_owned(), aside: aside(path) });
    }
    let malformed =
        |reason: String| SettingsError::Malformed { path: path.to_owned(), reason, aside: aside(path) };
    let text = std::str::from_utf8(&bytes).map_err(|error| malformed(error.to_string()))?;
    let table: toml::Table =
        toml::from_str(text).map_err(|error| malformed(error.message().trim().replace('\n', " ")))?;
    let (mut settings, strange): (Settings, _) = understood(&table);
    let range = -PLAYER_LIMITS.latency_ms_max..=PLAYER_LIMITS.latency_ms_max;
    settings.latency_ms.retain(|_, shift| range.contains(shift));
    for sliders in settings.sliders.values_mut() {
        sliders.retain(|_, value| value.is_finite());
    }
    Ok(Found { table, settings, strange })
}

/// Writes what `table` holds, changed as `after` differs from `before`.
fn write(
    path: &Path,
    table: &mut toml::Table,
    before: &Settings,
    after: &Settings,
) -> Result<(), SettingsError> {
    let failed = |error: &dyn std::fmt::Display| refused(path, "written", error);
    rewrite(table, before, after).map_err(|error| failed(&error))?;
    let text = toml::to_string(table).map_err(|error| failed(&error))?;
    let folder = path.parent().unwrap_or(Path::new("."));
    create_dir_all(folder).map_err(|error| failed(&error))?;
    let written = AtomicFile::create(path).and_then(|file| file.write(text.as_bytes()));
    written.map_err(|error| failed(&error.reason))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn folder() -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mariana/settings.toml");
        (folder, path)
    }

    fn with_text(path: &Path, text: &[u8]) -> (SettingsFile, Option<SettingsError>) {
        create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
        SettingsFile::open(Some(path.to_owned()))
    }

    #[test]
    fn what_is_changed_is_there_in_the_next_run_and_windows_do_not_undo_each_other() {
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
        // There is no other file beside it.
        assert_eq!(std::fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
    }

    #[test]
    fn changes_of_windows_at_the_same_time_were_lost() {
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
    fn a_broken_file_that_was_moved_already_was_to_be_corrected_or_deleted() {
        for text in
            [&b"microphone = "[..], b"[latency_ms", b"\xff\xfe", b"unknown = \"key\" = 3", &[b'#'; 1 << 21]]
        {
            let (_folder, path) = folder();
            let (mut file, error) = with_text(&path, text);
            let reported = error.expect("it is broken").to_string();
            let aside = path.with_extension("toml.broken");
            assert!(reported.ends_with(&format!("keeps this file as {}", aside.display())), "{reported}");
            assert!(!reported.contains("delete"), "{reported}");
            assert_eq!(*file.settings(), Settings::default());
            assert_eq!(std::fs::read(&path).unwrap(), text, "it was touched");
            file.change(|settings| settings.system = Some("p:a.monitor".into())).unwrap();
            assert_eq!(std::fs::read(&aside).unwrap(), text);
            let (next, error) = SettingsFile::open(Some(path.clone()));
            assert!(error.is_none());
            assert_eq!(next.settings().system.as_deref(), Some("p:a.monitor"));
            // Another one does not take its place.
            let (mut file, _) = with_text(&path, b"[");
            file.change(|settings| settings.system = None).unwrap();
            assert_eq!(std::fs::read(&aside).unwrap(), text);
            assert_eq!(std::fs::read(path.with_extension("toml.broken-2")).unwrap(), b"[");
        }
    }

    #[test]
    fn what_a_newer_version_wrote_is_told_and_stays() {
        let (_folder, path) = folder();
        let text = b"microphone = \"p:mic\"\nmood = 3\n[choices]\nquality = \"ultra\"\ngain = \"off\"\n\
                     [last_show]\nvolume = 0.5\nhat = true\n";
        let (mut file, error) = with_text(&path, text);
        let reported = error.expect("it is told").to_string();
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
        // What is chosen anew takes the place of what was not known.
        file.change(|settings| settings.choices.quality = crate::QualityChoice::Low).unwrap();
        let (next, error) = SettingsFile::open(Some(path));
        assert_eq!(next.settings().choices.quality, crate::QualityChoice::Low);
        assert!(error.is_some_and(|error| error.to_string().contains("(last_show.hat, mood)")));
        // A message stays short.
        let many: Vec<String> = (0..9).map(|n| format!("{n}\n").repeat(100)).collect();
        assert!(newer(Path::new("a"), &many).to_string().len() < 300);
    }

    #[test]
    fn a_place_that_takes_no_file_costs_nothing_but_a_sentence() {
        let (folder, _) = folder();
        std::fs::write(folder.path().join("taken"), "").unwrap();
        let (mut file, error) = SettingsFile::open(Some(folder.path().join("taken/settings.toml")));
        let reported = error.expect("there is no such folder").to_string();
        assert!(reported.contains("cannot be read"), "{reported}");
        assert!(file.change(|settings| settings.system = Some("p:a.monitor".into())).is_err());
        assert_eq!(file.settings().system.as_deref(), Some("p:a.monitor"));
        // Nowhere at all.
        let (mut file, error) = SettingsFile::open(None);
        assert!(error.is_none());
        file.change(|settings| settings.microphone = Some("m".into())).unwrap();
        assert_eq!(file.settings().microphone.as_deref(), Some("m"));
    }

    /// A full disk, simulated in a process of its own: none of its files may grow. The test runs itself there.
    #[cfg(unix)]
    #[test]
    fn settings_that_do_not_fit_on_the_disk_cost_those_that_were_there() {
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
        assert_eq!(std::fs::read_dir(path.parent().unwrap()).unwrap().count(), 1, "something lies beside it");
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic_or_leave_the_limits(text in "(microphone|system|\\[latency_ms\\]|\"a\"| |=|\n|\"b\"|1e9|nan|-5.5|\\PC){0,24}") {
            let (_folder, path) = folder();
            let (file, _) = with_text(&path, text.as_bytes());
            prop_assert!(file.settings().latency_ms.values().all(|shift| shift.abs() <= PLAYER_LIMITS.latency_ms_max));
        }
    }
}
