use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::*;
use crate::{Folders, limits};

const WAIT_LIMIT: Duration = Duration::from_secs(240);

struct Place {
    folder: TempDir,
    file_thread: FileThread,
    woken: Receiver<()>,
}

impl Place {
    fn new() -> Self {
        Self::in_folder(tempfile::tempdir().unwrap())
    }

    fn in_folder(folder: TempDir) -> Self {
        let (wake, woken) = channel();
        let file_thread =
            FileThread::start(&Folders::within(folder.path()), move || wake.send(()).unwrap_or_default())
                .unwrap();
        Self { folder, file_thread, woken }
    }

    fn file(&self) -> PathBuf {
        self.folder.path().join("one.scene")
    }

    #[track_caller]
    fn file_events(&self) -> FileEvent {
        self.woken.recv_timeout(WAIT_LIMIT).expect("no event arrived");
        self.file_thread.file_events().expect("the thread was woken without an event")
    }

    #[track_caller]
    fn open(&self) -> (OnDisk, Option<Bytes>) {
        self.file_thread.open(&self.file());
        match self.file_events() {
            FileEvent::Opened { holds, kept, .. } => (holds, kept.map(|kept| kept.text)),
            other => panic!("{other:?}"),
        }
    }
}

fn bytes(text: &[u8]) -> Bytes {
    Arc::from(text)
}

fn holds(text: &[u8]) -> OnDisk {
    OnDisk::Bytes(bytes(text))
}

#[test]
fn a_text_is_saved_byte_for_byte_where_it_was_read() {
    let place = Place::new();
    let file = place.file();
    assert_eq!(place.open(), (OnDisk::Missing, None));
    let text = b"a\r\nb\n\xff";
    place.file_thread.save(&file, bytes(text), Some(OnDisk::Missing));
    assert_eq!(place.file_events(), FileEvent::Saved { file: file.clone(), text: bytes(text) });
    assert_eq!(fs::read(&file).unwrap(), text);
    assert_eq!(place.open(), (holds(text), None));
}

#[test]
fn a_change_by_another_program_is_not_overwritten() {
    let place = Place::new();
    let file = place.file();
    fs::write(&file, "mine").unwrap();
    assert_eq!(place.open().0, holds(b"mine"));
    fs::write(&file, "theirs").unwrap();
    place.file_thread.save(&file, bytes(b"mine, too"), Some(holds(b"mine")));
    // The thread may notice the change before the save or during the save.
    let seen = [place.file_events()];
    let refused = FileEvent::Refused { file: file.clone(), holds: holds(b"theirs") };
    let changed = FileEvent::Changed { file: file.clone(), holds: holds(b"theirs") };
    assert!(seen.contains(&refused) || seen.contains(&changed) && place.file_events() == refused, "{seen:?}");
    assert_eq!(fs::read(&file).unwrap(), b"theirs");
    // `None` overwrites any content. If the file has the text already, any expected content is accepted.
    place.file_thread.save(&file, bytes(b"mine, too"), None);
    assert!(matches!(place.file_events(), FileEvent::Saved { .. }));
    place.file_thread.save(&file, bytes(b"mine, too"), Some(holds(b"long ago")));
    assert!(matches!(place.file_events(), FileEvent::Saved { .. }));
    assert_eq!(fs::read(&file).unwrap(), b"mine, too");
}

#[test]
fn a_second_save_does_not_mistake_the_first_for_a_foreign_change() {
    let place = Place::new();
    let file = place.file();
    fs::write(&file, "old").unwrap();
    place.open();
    // Both saves expect the old content, because the event of the first save has not been read yet.
    for text in [b"one".as_slice(), b"other"] {
        place.file_thread.save(&file, bytes(text), Some(holds(b"old")));
    }
    for text in [b"one".as_slice(), b"other"] {
        assert_eq!(place.file_events(), FileEvent::Saved { file: file.clone(), text: bytes(text) });
    }
    fs::write(&file, "theirs").unwrap();
    place.file_thread.save(&file, bytes(b"mine"), Some(holds(b"old")));
    let reported = [place.file_events()];
    assert!(!matches!(reported, [FileEvent::Saved { .. }]), "{reported:?}");
}

#[test]
fn changes_and_the_removal_of_a_file_are_reported() {
    let place = Place::new();
    let file = place.file();
    fs::write(&file, "one").unwrap();
    place.open();
    fs::write(&file, "other").unwrap();
    assert_eq!(place.file_events(), FileEvent::Changed { file: file.clone(), holds: holds(b"other") });
    fs::remove_file(&file).unwrap();
    assert_eq!(place.file_events(), FileEvent::Changed { file, holds: OnDisk::Missing });
}

#[test]
fn unsaved_text_survives_restarts_until_it_is_saved() {
    let mut place = Place::new();
    let file = place.file();
    fs::write(&file, "old").unwrap();
    for text in [b"typed".as_slice(), b"typed more \xff"] {
        place.file_thread.keep(&file, Some(bytes(text)));
    }
    place.file_thread.finish(WAIT_LIMIT);
    place = Place::in_folder(place.folder);
    assert_eq!(place.open(), (holds(b"old"), Some(bytes(b"typed more \xff"))));
    // Backups of other files are separate.
    assert_eq!(KeptTexts::among(&Folders::within(place.folder.path())).of(Path::new("/other")), None);
    place.file_thread.save(&file, bytes(b"typed more"), Some(holds(b"old")));
    assert!(matches!(place.file_events(), FileEvent::Saved { .. }));
    assert_eq!(place.open().1, None);
    place.file_thread.keep(&file, Some(bytes(b"again")));
    place.file_thread.keep(&file, None);
    place.file_thread.finish(WAIT_LIMIT);
    assert_eq!(place.open().1, None);
}

#[test]
fn the_backup_of_a_relative_path_belongs_to_the_absolute_path() {
    let folder = tempfile::tempdir().unwrap();
    let kept = KeptTexts::among(&Folders::within(folder.path()));
    let (relative, absolute) = (Path::new("sc/one.scene"), std::path::absolute("sc/one.scene").unwrap());
    kept.keep(relative, b"typed").unwrap();
    assert_eq!(kept.of(&absolute).map(|kept| kept.text), Some(bytes(b"typed")));
    let stored = fs::read_dir(folder.path().join("state/unsaved"));
    let head = stored.unwrap().flatten().map(|file| fs::read_to_string(file.path()).unwrap()).next().unwrap();
    assert!(head.contains(absolute.to_str().unwrap()), "{head}");
    kept.forget(&absolute);
    assert_eq!(kept.of(relative), None);
}

#[test]
fn unsaved_text_is_backed_up_while_the_program_runs() {
    let place = Place::new();
    let kept = KeptTexts::among(&Folders::within(place.folder.path()));
    for text in [b"typed".as_slice(), b"typed more"] {
        place.file_thread.keep(&place.file(), Some(bytes(text)));
        let start = Instant::now();
        while kept.of(&place.file()).is_none_or(|kept| *kept.text != *text) {
            assert!(start.elapsed() < WAIT_LIMIT, "no backup was written");
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

#[test]
fn a_damaged_backup_is_ignored() {
    let place = Place::new();
    let folders = Folders::within(place.folder.path());
    let kept = KeptTexts::among(&folders);
    kept.keep(&place.file(), b"text").unwrap();
    let stored =
        fs::read_dir(folders.state.unwrap().join("unsaved")).unwrap().next().unwrap().unwrap().path();
    assert!(kept.of(&place.file()).is_some());
    for damage in [b"".as_slice(), b"\xff\n", b"{}\ntext", b"no line"] {
        fs::write(&stored, damage).unwrap();
        assert_eq!(kept.of(&place.file()), None);
    }
}

#[test]
fn too_large_files_and_folders_are_refused_with_a_reason() {
    let place = Place::new();
    fs::write(place.file(), vec![b' '; limits::KEPT_TEXT_BYTES_MAX + 1]).unwrap();
    let reason = |holds| match holds {
        OnDisk::Unreadable(reason) => reason,
        other => panic!("{other:?}"),
    };
    assert!(reason(place.open().0).contains("larger than"));
    fs::remove_file(place.file()).unwrap();
    fs::create_dir(place.file()).unwrap();
    assert!(reason(place.open().0).contains("not a file"));
    place.file_thread.save(&place.file(), bytes(b"x"), None);
    assert!(matches!(place.file_events(), FileEvent::Failed(reason) if reason.contains("one.scene")));
}

#[test]
fn a_new_scene_never_replaces_another() {
    let place = Place::new();
    let folder = place.folder.path().join("own/scenes");
    for expected in ["orb.scene", "orb-2.scene"] {
        place.file_thread.create(&folder, "orb.scene", bytes(b"y"));
        assert_eq!(place.file_events(), FileEvent::Created(folder.join(expected)));
    }
    place.file_thread.create(Path::new("/dev/null/x"), "orb", bytes(b"y"));
    assert!(matches!(place.file_events(), FileEvent::Failed(_)));
}
