use std::cell::RefCell;
use std::fs;
use std::io::Write;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::Receiver;
use std::thread::sleep;

use mariana_testing::process::WAIT_LIMIT;
use tempfile::TempDir;

use super::*;

/// Longer than any wait of the loader.
const EVER: Duration = Duration::from_secs(600);
/// Tests wait this long. A loader that wrongly reads the file at once would have read it by then.
const PAUSE: Duration = Duration::from_millis(300);

/// A folder with `main.scene`, and a loader that returns the text of the source's file.
struct Place {
    folder: TempDir,
    loader: Loader<String>,
    woken: Receiver<()>,
    loads: Arc<AtomicUsize>,
}

impl Place {
    fn new(patience: Duration) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let loads = Arc::new(AtomicUsize::new(0));
        let (count, (wake, woken)) = (Arc::clone(&loads), channel());
        let load = move |source: &SceneSource| {
            let path = source.file().unwrap();
            let text = fs::read_to_string(path).unwrap_or_else(|error| error.kind().to_string());
            count.fetch_add(1, Ordering::SeqCst);
            assert!(text != "panic", "requested by the test");
            (text, vec![path.to_owned()])
        };
        let loader = Loader::start_with(load, move || wake.send(()).unwrap(), patience).unwrap();
        Self { folder, loader, woken, loads }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn begin(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
        self.loader.request(SceneSource::File(self.path(name)));
        assert_eq!(self.result(), text);
    }

    #[track_caller]
    fn result(&self) -> String {
        self.woken.recv_timeout(WAIT_LIMIT).expect("no load finished");
        self.loader.poll().expect("the loader woke without a result").value
    }
}

#[test]
fn a_file_that_still_grows_is_not_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("main.scene");
    fs::write(&path, "old").unwrap();
    let texts = RefCell::new(Vec::new());
    let load = |_: &SceneSource| {
        texts.borrow_mut().push(fs::read_to_string(&path).unwrap());
        ((), vec![path.clone()])
    };
    let publish = |_: Loaded<()>| ();
    let mut worker = Worker { load, publish, patience: EVER, current: None, noticed: None };
    worker.begin(SceneSource::File(path.clone()));
    for text in ["first half", "first half and second half"] {
        fs::write(&path, text).unwrap();
        worker.check();
    }
    assert_eq!(*texts.borrow(), ["old"]);
    worker.check();
    assert_eq!(*texts.borrow(), ["old", "first half and second half"]);
}

#[test]
fn a_briefly_missing_file_is_awaited() {
    let place = Place::new(EVER);
    place.begin("main.scene", "old");
    fs::remove_file(place.path("main.scene")).unwrap();
    sleep(PAUSE);
    fs::write(place.path("main.scene"), "new").unwrap();
    assert_eq!(place.result(), "new");
    fs::write(place.path("main.scene"), "").unwrap();
    sleep(PAUSE);
    fs::write(place.path("main.scene"), "newer").unwrap();
    assert_eq!(place.result(), "newer");
}

#[test]
fn a_missing_file_is_reported() {
    let place = Place::new(PATIENCE);
    place.begin("main.scene", "old");
    fs::remove_file(place.path("main.scene")).unwrap();
    assert_eq!(place.result(), "entity not found");
    fs::write(place.path("main.scene"), "back").unwrap();
    assert_eq!(place.result(), "back");
}

#[test]
fn saves_of_equal_length_in_one_tick_of_the_clock_are_found() {
    let place = Place::new(PATIENCE);
    place.begin("main.scene", "old");
    let modified = fs::metadata(place.path("main.scene")).unwrap().modified().unwrap();
    let mut file = fs::File::options().write(true).open(place.path("main.scene")).unwrap();
    file.write_all(b"new").unwrap();
    file.set_modified(modified).unwrap();
    assert_eq!(place.result(), "new");
}

#[test]
fn a_panic_is_contained_and_the_next_save_is_loaded() {
    let place = Place::new(PATIENCE);
    place.begin("main.scene", "old");
    fs::write(place.path("main.scene"), "panic").unwrap();
    while place.loads.load(Ordering::SeqCst) < 2 {
        sleep(Duration::from_millis(5));
    }
    fs::write(place.path("main.scene"), "mended").unwrap();
    assert_eq!(place.result(), "mended");
    // A panic in the first load of a scene is contained as well.
    fs::write(place.path("other.scene"), "panic").unwrap();
    place.loader.request(SceneSource::File(place.path("other.scene")));
    while place.loads.load(Ordering::SeqCst) < 4 {
        sleep(Duration::from_millis(5));
    }
    fs::write(place.path("other.scene"), "mended too").unwrap();
    assert_eq!(place.result(), "mended too");
}

/// Starts a loader of two files that returns their texts. The loader learns of the second file only from the first
/// load. `also` is called at the end of each load.
fn pair(
    folder: &TempDir,
    also: impl Fn(&[PathBuf; 2]) + Send + 'static,
) -> ([PathBuf; 2], Loader<[String; 2]>, Receiver<()>) {
    let paths = ["main.scene", "part.scene"].map(|name| folder.path().join(name));
    fs::write(&paths[0], "main").unwrap();
    fs::write(&paths[1], "part").unwrap();
    let file = fs::File::options().append(true).open(&paths[1]).unwrap();
    file.set_modified(SystemTime::UNIX_EPOCH).unwrap();
    let (wake, woken) = channel();
    let known = paths.clone();
    let load = move |_: &SceneSource| {
        let texts = known.clone().map(|path| fs::read_to_string(path).unwrap_or_default());
        also(&known);
        (texts, known.to_vec())
    };
    let loader = Loader::start_with(load, move || wake.send(()).unwrap(), EVER).unwrap();
    loader.request(SceneSource::File(paths[0].clone()));
    (paths, loader, woken)
}

#[test]
fn a_change_is_kept_while_another_file_is_briefly_missing() {
    let folder = tempfile::tempdir().unwrap();
    let (paths, loader, woken) = pair(&folder, |_| ());
    woken.recv_timeout(WAIT_LIMIT).unwrap();
    assert_eq!(loader.poll().unwrap().value, ["main", "part"]);
    fs::remove_file(&paths[1]).unwrap();
    fs::write(&paths[0], "new main").unwrap();
    sleep(PAUSE);
    fs::write(&paths[1], "part").unwrap();
    woken.recv_timeout(WAIT_LIMIT).unwrap();
    assert_eq!(loader.poll().unwrap().value, ["new main", "part"]);
}

#[test]
fn a_change_during_a_load_causes_another_load() {
    for which in [0, 1] {
        let folder = tempfile::tempdir().unwrap();
        let (_, loader, woken) = pair(&folder, move |paths| fs::write(&paths[which], "new").unwrap());
        for expected in [["main", "part"], [["new", "part"], ["main", "new"]][which]] {
            woken.recv_timeout(WAIT_LIMIT).expect("the source was not loaded again");
            assert_eq!(loader.poll().unwrap().value, expected);
        }
    }
}

#[test]
fn saves_in_place_by_rename_and_after_deletion_are_reported() {
    let place = Place::new(PATIENCE);
    place.begin("main.scene", "old");
    fs::write(place.path("main.scene"), "in place").unwrap();
    assert_eq!(place.result(), "in place");
    for text in ["by rename", "and again"] {
        fs::write(place.path("next"), text).unwrap();
        fs::rename(place.path("next"), place.path("main.scene")).unwrap();
        assert_eq!(place.result(), text);
    }
    fs::remove_file(place.path("main.scene")).unwrap();
    fs::write(place.path("main.scene"), "anew").unwrap();
    assert_eq!(place.result(), "anew");
}

#[test]
fn files_in_newly_created_folders_are_found() {
    let place = Place::new(PATIENCE);
    place.loader.request(SceneSource::File(place.path("a/b/main.scene")));
    assert_eq!(place.result(), "entity not found");
    for folder in ["a", "a/b"] {
        fs::create_dir(place.path(folder)).unwrap();
        sleep(PAUSE);
    }
    fs::write(place.path("a/b/main.scene"), "there").unwrap();
    assert_eq!(place.result(), "there");
    fs::remove_dir_all(place.path("a")).unwrap();
    assert_eq!(place.result(), "entity not found");
    fs::create_dir_all(place.path("a/b")).unwrap();
    fs::write(place.path("a/b/main.scene"), "again").unwrap();
    assert_eq!(place.result(), "again");
}

#[test]
fn files_in_replaced_folders_are_found() {
    let place = Place::new(PATIENCE);
    fs::create_dir(place.path("in")).unwrap();
    place.begin("in/main.scene", "old");
    fs::create_dir(place.path("next")).unwrap();
    fs::write(place.path("next/main.scene"), "moved here").unwrap();
    fs::rename(place.path("in"), place.path("aside")).unwrap();
    fs::rename(place.path("next"), place.path("in")).unwrap();
    assert_eq!(place.result(), "moved here");
    // A new folder may get the inode number of the deleted one.
    for text in ["anew", "and once more"] {
        fs::remove_dir_all(place.path("in")).unwrap();
        fs::create_dir(place.path("in")).unwrap();
        fs::write(place.path("in/main.scene"), text).unwrap();
        assert_eq!(place.result(), text);
    }
    fs::write(place.path("in/main.scene"), "in place").unwrap();
    assert_eq!(place.result(), "in place");
}

#[cfg(unix)]
#[test]
fn targets_of_links_are_watched() {
    use std::os::unix::fs::symlink;
    let place = Place::new(PATIENCE);
    fs::create_dir(place.path("far")).unwrap();
    fs::create_dir(place.path("near")).unwrap();
    fs::write(place.path("far/real"), "real").unwrap();
    symlink("../far/real", place.path("near/link")).unwrap();
    symlink("near/link", place.path("main.scene")).unwrap();
    place.loader.request(SceneSource::File(place.path("main.scene")));
    assert_eq!(place.result(), "real");
    fs::write(place.path("far/real"), "really new").unwrap();
    assert_eq!(place.result(), "really new");
    fs::write(place.path("other"), "other").unwrap();
    symlink("../other", place.path("next")).unwrap();
    fs::rename(place.path("next"), place.path("near/link")).unwrap();
    assert_eq!(place.result(), "other");
}
