use std::fs;
use std::io::Write;
use std::sync::atomic::AtomicUsize;
use std::sync::mpsc::Receiver;
use std::thread::sleep;

use tempfile::TempDir;

use super::*;

const WAIT_LIMIT: Duration = Duration::from_secs(10);
/// Longer than any wait of the loader takes, so that what it waits for must have happened.
const EVER: Duration = Duration::from_secs(600);
/// Long enough to be noticed by a loader that does not wait.
const PAUSE: Duration = Duration::from_millis(120);

/// A folder with `main.scene`, and a loader whose values are the text of the source's file.
struct Place {
    folder: TempDir,
    loader: Loader<String>,
    woken: Receiver<()>,
    loads: Arc<AtomicUsize>,
}

impl Place {
    fn new(waits: Waits, watch: fn(Tell) -> Watch) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let loads = Arc::new(AtomicUsize::new(0));
        let (count, (wake, woken)) = (Arc::clone(&loads), channel());
        let load = move |source: &SceneSource| {
            let path = source.file().unwrap();
            let text = fs::read_to_string(path).unwrap_or_else(|error| error.kind().to_string());
            count.fetch_add(1, Ordering::SeqCst);
            assert!(text != "panic", "as asked");
            (text, vec![path.to_owned()])
        };
        let loader = Loader::start_with(load, move || wake.send(()).unwrap(), waits, watch).unwrap();
        Self { folder, loader, woken, loads }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes `text` into main.scene and loads it.
    fn begin(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
        self.loader.request(SceneSource::File(self.path(name)));
        assert_eq!(self.result(), text);
    }

    #[track_caller]
    fn result(&self) -> String {
        self.woken.recv_timeout(WAIT_LIMIT).expect("nothing was loaded");
        self.loader.poll().expect("a result was there").value
    }
}

#[test]
fn half_a_file_is_not_read_while_its_writer_has_it_open() {
    let place = Place::new(Waits { patience: EVER, ..Waits::USUAL }, Watch::new);
    place.begin("main.scene", "old");
    let mut file = fs::File::create(place.path("main.scene")).unwrap();
    file.write_all(b"first half").unwrap();
    sleep(PAUSE);
    file.write_all(b" and second half").unwrap();
    drop(file);
    assert_eq!(place.result(), "first half and second half");
}

#[test]
fn a_writer_that_never_closes_is_not_waited_for_for_ever() {
    let place = Place::new(Waits::USUAL, Watch::new);
    place.begin("main.scene", "old");
    let mut file = fs::File::create(place.path("main.scene")).unwrap();
    file.write_all(b"new").unwrap();
    assert_eq!(place.result(), "new");
}

#[test]
fn a_file_that_is_gone_for_a_moment_is_waited_for() {
    let place = Place::new(Waits { patience: EVER, ..Waits::USUAL }, Watch::new);
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
fn a_file_that_is_gone_for_good_is_told() {
    let place = Place::new(Waits::USUAL, Watch::new);
    place.begin("main.scene", "old");
    fs::remove_file(place.path("main.scene")).unwrap();
    assert_eq!(place.result(), "entity not found");
    fs::write(place.path("main.scene"), "back").unwrap();
    assert_eq!(place.result(), "back");
}

#[test]
fn without_watches_the_files_are_looked_at() {
    let place =
        Place::new(Waits { look_blind: Duration::from_millis(10), ..Waits::USUAL }, |_| Watch::blind());
    place.begin("main.scene", "old");
    for text in ["new", "newer"] {
        fs::write(place.path("main.scene"), text).unwrap();
        assert_eq!(place.result(), text);
    }
}

/// No event tells that a folder further up was replaced.
#[test]
fn what_the_system_does_not_tell_is_found_by_looking() {
    let place = Place::new(Waits { look: Duration::from_millis(30), ..Waits::USUAL }, Watch::new);
    fs::create_dir_all(place.path("a/b")).unwrap();
    place.begin("a/b/main.scene", "old");
    fs::create_dir_all(place.path("other/b")).unwrap();
    fs::write(place.path("other/b/main.scene"), "other").unwrap();
    fs::rename(place.path("a"), place.path("aside")).unwrap();
    fs::rename(place.path("other"), place.path("a")).unwrap();
    assert_eq!(place.result(), "other");
}

#[test]
fn a_panic_is_contained_and_the_next_save_is_loaded() {
    let place = Place::new(Waits::USUAL, Watch::new);
    place.begin("main.scene", "old");
    fs::write(place.path("main.scene"), "panic").unwrap();
    while place.loads.load(Ordering::SeqCst) < 2 {
        sleep(Duration::from_millis(5));
    }
    fs::write(place.path("main.scene"), "mended").unwrap();
    assert_eq!(place.result(), "mended");
    // From the first load on too.
    fs::write(place.path("other.scene"), "panic").unwrap();
    place.loader.request(SceneSource::File(place.path("other.scene")));
    while place.loads.load(Ordering::SeqCst) < 4 {
        sleep(Duration::from_millis(5));
    }
    fs::write(place.path("other.scene"), "mended too").unwrap();
    assert_eq!(place.result(), "mended too");
}

#[test]
fn a_change_beside_a_file_that_is_gone_for_a_moment_is_not_forgotten() {
    let folder = tempfile::tempdir().unwrap();
    let paths = ["main.scene", "part.scene"].map(|name| folder.path().join(name));
    let (wake, woken) = channel();
    let read = {
        let paths = paths.clone();
        move |_: &SceneSource| {
            (paths.clone().map(|path| fs::read_to_string(path).unwrap_or_default()), paths.to_vec())
        }
    };
    let waits = Waits { patience: EVER, ..Waits::USUAL };
    fs::write(&paths[0], "main").unwrap();
    fs::write(&paths[1], "part").unwrap();
    let file = fs::File::options().append(true).open(&paths[1]).unwrap();
    file.set_modified(SystemTime::UNIX_EPOCH).unwrap();
    drop(file);
    let loader = Loader::start_with(read, move || wake.send(()).unwrap(), waits, Watch::new).unwrap();
    loader.request(SceneSource::File(paths[0].clone()));
    woken.recv_timeout(WAIT_LIMIT).unwrap();
    assert_eq!(loader.poll().unwrap().value, ["main", "part"]);

    fs::remove_file(&paths[1]).unwrap();
    fs::write(&paths[0], "new main").unwrap();
    sleep(PAUSE);
    fs::write(&paths[1], "part").unwrap();
    woken.recv_timeout(WAIT_LIMIT).unwrap();
    assert_eq!(loader.poll().unwrap().value, ["new main", "part"]);
}
