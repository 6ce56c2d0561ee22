use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::*;
use crate::Folders;
use crate::limits::LIMITS;

const WAIT_LIMIT: Duration = Duration::from_secs(10);

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
        self.woken.recv_timeout(WAIT_LIMIT).expect("there is no news");
        self.file_thread.file_events().expect("there was news")
    }

    /// Opens the file and gives what it holds and what was kept.
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
fn what_another_program_wrote_meanwhile_is_not_overwritten_unasked() {
    let place = Place::new();
    let file = place.file();
    fs::write(&file, "mine").unwrap();
    assert_eq!(place.open().0, holds(b"mine"));
    fs::write(&file, "theirs").unwrap();
    place.file_thread.save(&file, bytes(b"mine, too"), Some(holds(b"mine")));
    // The clerk may see the change before the save or by it.
    let seen = [place.file_events()];
    let refused = FileEvent::Refused { file: file.clone(), holds: holds(b"theirs") };
    let changed = FileEvent::Changed { file: file.clone(), holds: holds(b"theirs") };
    assert!(seen.contains(&refused) || seen.contains(&changed) && place.file_events() == refused, "{seen:?}");
    assert_eq!(fs::read(&file).unwrap(), b"theirs");
    // Asked, it is; and what is there already needs no question.
    place.file_thread.save(&file, bytes(b"mine, too"), None);
    assert!(matches!(place.file_events(), FileEvent::Saved { .. }));
    place.file_thread.save(&file, bytes(b"mine, too"), Some(holds(b"long ago")));
    assert!(matches!(place.file_events(), FileEvent::Saved { .. }));
    assert_eq!(fs::read(&file).unwrap(), b"mine, too");
}

#[test]
fn a_save_right_after_a_save_was_taken_for_another_programs() {
    let place = Place::new();
    let file = place.file();
    fs::write(&file, "old").unwrap();
    place.open();
    // Both believe what was read, because nobody has heard of the first yet.
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
fn changes_and_the_end_of_a_file_are_told() {
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
fn what_was_typed_is_kept_over_runs_until_it_is_saved() {
    let mut place = Place::new();
    let file = place.file();
    fs::write(&file, "old").unwrap();
    for text in [b"typed".as_slice(), b"typed more \xff"] {
        place.file_thread.keep(&file, Some(bytes(text)));
    }
    place.file_thread.finish(WAIT_LIMIT);
    place = Place::in_folder(place.folder);
    assert_eq!(place.open(), (holds(b"old"), Some(bytes(b"typed more \xff"))));
    // Another file has its own.
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
fn what_was_typed_was_kept_only_when_the_program_ended() {
    let place = Place::new();
    let kept = KeptTexts::among(&Folders::within(place.folder.path()));
    for text in [b"typed".as_slice(), b"typed more"] {
        place.file_thread.keep(&place.file(), Some(bytes(text)));
        let start = Instant::now();
        while kept.of(&place.file()).is_none_or(|kept| *kept.text != *text) {
            assert!(start.elapsed() < WAIT_LIMIT, "nobody has kept it");
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

#[test]
fn a_damaged_kept_text_is_none() {
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
fn files_over_the_limit_folders_and_pipes_are_refused_in_words() {
    let place = Place::new();
    fs::write(place.file(), vec![b' '; LIMITS.kept_text_bytes_max + 1]).unwrap();
    let reason = |holds| match holds {
        OnDisk::Unreadable(reason) => reason,
        other => panic!("{other:?}"),
    };
    assert!(reason(place.open().0).contains("larger than"));
    fs::remove_file(place.file()).unwrap();
    fs::create_dir(place.file()).unwrap();
    assert!(reason(place.open().0).contains("not a file"));
    place.file_thread.save(&place.file(), bytes(b"x"), None);
    assert!(matches!(place.file_events(), FileEvent::Failed { reason, .. } if reason.contains("one.scene")));
}

#[test]
fn a_new_scene_never_takes_the_place_of_another() {
    let place = Place::new();
    let folder = place.folder.path().join("own/scenes");
    for expected in ["orb.scene", "orb-2.scene"] {
        place.file_thread.create(&folder, "orb.scene", bytes(b"y"));
        assert_eq!(place.file_events(), FileEvent::Created { file: folder.join(expected) });
    }
    place.file_thread.create(Path::new("/dev/null/x"), "orb", bytes(b"y"));
    assert!(matches!(place.file_events(), FileEvent::Failed { .. }));
}
