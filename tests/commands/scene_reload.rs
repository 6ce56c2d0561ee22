//! Reloading of saved scenes: once per save, only if the text changed, and never half a file. Tests imitate the ways in
//! which editors save.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::fs;
use std::io::Write;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime};

use mariana::scenes::{Loaded, Loader, SceneSource, TextureCache};
use mariana_field::graph::{FrameInputs, Point};
use mariana_field::lang::render_all;
use mariana_field::tape::{PointEvaluator, Tape};
use mariana_testing::process::WAIT_LIMIT;
use tempfile::TempDir;

/// A test waits for this time to show that the loader loads nothing. A load takes far less time.
const STILLNESS: Duration = Duration::from_millis(200);

/// A loaded scene in these tests: the distance at (0, 0, 0) and the widths of the textures, or the errors.
type Seen = Result<(f32, Vec<u32>), String>;

struct Place {
    folder: TempDir,
    loader: Loader<Seen>,
    woken: Receiver<()>,
    loads: Arc<AtomicUsize>,
}

fn load(source: &SceneSource, cache: &mut TextureCache) -> (Seen, Vec<PathBuf>) {
    let compiled = match source.compile() {
        Ok(compiled) => compiled,
        Err(error) => return (Err(error.to_string()), source.files(None)),
    };
    let files = source.files(Some(&compiled));
    let Some(scene) = &compiled.scene else { return (Err(compiled.render(false)), files) };
    let pictures = match cache.load(source, scene) {
        Ok(pictures) => pictures,
        Err(wrong) => return (Err(render_all(&wrong, &compiled.sources, false)), files),
    };
    let tape = Tape::new(&scene.graph, &[scene.distance]);
    let distance = PointEvaluator::new(&tape, &FrameInputs::default()).at(&Point::at(0.0, 0.0, 0.0))[0];
    (Ok((distance, pictures.iter().map(|picture| picture.width()).collect())), files)
}

impl Place {
    fn new() -> Self {
        let loads = Arc::new(AtomicUsize::new(0));
        let (count, (wake, woken)): (_, (Sender<()>, _)) = (Arc::clone(&loads), channel());
        let mut cache = TextureCache::default();
        let load = move |source: &SceneSource| {
            count.fetch_add(1, Ordering::SeqCst);
            load(source, &mut cache)
        };
        // The receiver may be gone, because the test may end before the loader's thread.
        let loader = Loader::start(load, move || wake.send(()).unwrap_or_default()).unwrap();
        let place = Self { folder: tempfile::tempdir().unwrap(), loader, woken, loads };
        fs::create_dir(place.folder.path().join("scenes")).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join("scenes").join(name)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::write(self.path(name), bytes).unwrap();
    }

    /// Writes a file with an old modification time, so that the loader does not treat it as just modified.
    fn old(&self, name: &str, bytes: impl AsRef<[u8]>) {
        self.write(name, bytes);
        let file = fs::File::options().append(true).open(self.path(name)).unwrap();
        file.set_modified(SystemTime::UNIX_EPOCH).unwrap();
    }

    #[track_caller]
    fn begin(&self, text: &str) -> Loaded<Seen> {
        self.write("main.scene", text);
        self.loader.request(SceneSource::File(self.path("main.scene")));
        self.result()
    }

    #[track_caller]
    fn result(&self) -> Loaded<Seen> {
        let until = Instant::now() + WAIT_LIMIT;
        loop {
            let left = until.saturating_duration_since(Instant::now());
            self.woken.recv_timeout(left).expect("nothing was loaded");
            // The result of an earlier wake-up may have been replaced by a newer result.
            if let Some(loaded) = self.loader.poll() {
                return loaded;
            }
        }
    }

    #[track_caller]
    fn comes_to(&self, distance: f32) {
        let until = Instant::now() + WAIT_LIMIT;
        loop {
            let last = self.result().value;
            if last == Ok((distance, vec![])) {
                return;
            }
            assert!(Instant::now() < until, "the last result was {last:?}");
        }
    }

    /// Fails unless the next result is `distance` and the loader has loaded `loads` times in total.
    #[track_caller]
    fn shows(&self, distance: f32, loads: usize) {
        assert_eq!(self.result().value, Ok((distance, vec![])));
        assert_eq!(self.loads.load(Ordering::SeqCst), loads);
    }

    #[track_caller]
    fn stays_still(&self) {
        let loads = self.loads.load(Ordering::SeqCst);
        sleep(STILLNESS);
        assert_eq!(self.loads.load(Ordering::SeqCst), loads, "a scene was loaded again");
        assert_eq!(self.loader.poll(), None);
    }
}

fn at(distance: f32) -> String {
    format!("length(p) + {distance}\n")
}

fn png(width: u32) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::RgbaImage::new(width, 1).write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

const TEXTURED: &str = "material m { color = texture(\"a.png\", p.xy).rgb }\n\
                        object o { shape = length(p) + 1  material = m }\n";

#[test]
fn a_save_in_place_is_loaded_once() {
    let place = Place::new();
    let first = place.begin(&at(1.0));
    assert_eq!(first.value, Ok((1.0, vec![])));
    assert_eq!(first.source, SceneSource::File(place.path("main.scene")));
    place.stays_still();
    for save in 2..5_u8 {
        place.write("main.scene", at(f32::from(save)));
        place.shows(f32::from(save), usize::from(save));
    }
    place.stays_still();
}

#[test]
fn a_save_by_rename_is_loaded_once() {
    let place = Place::new();
    place.begin(&at(1.0));
    for save in 2..5_u8 {
        place.write("main.scene.tmp", at(f32::from(save)));
        fs::rename(place.path("main.scene.tmp"), place.path("main.scene")).unwrap();
        place.shows(f32::from(save), usize::from(save));
    }
    place.stays_still();
}

/// vim renames the file, writes a new one and deletes the old one. Emacs copies the file and overwrites it.
#[test]
fn saves_with_backups_are_loaded_once() {
    let place = Place::new();
    place.begin(&at(1.0));
    for save in [2_u8, 3] {
        place.write("4913", "");
        fs::remove_file(place.path("4913")).unwrap();
        fs::rename(place.path("main.scene"), place.path("main.scene~")).unwrap();
        place.write("main.scene", at(f32::from(save)));
        fs::remove_file(place.path("main.scene~")).unwrap();
        place.shows(f32::from(save), usize::from(save));
    }
    fs::copy(place.path("main.scene"), place.path("main.scene~")).unwrap();
    place.write("main.scene", at(4.0));
    place.shows(4.0, 4);
    place.stays_still();
}

#[test]
fn a_deleted_and_recreated_file_is_loaded_once() {
    let place = Place::new();
    place.begin(&at(1.0));
    for save in [2_u8, 3] {
        fs::remove_file(place.path("main.scene")).unwrap();
        sleep(Duration::from_millis(50));
        place.write("main.scene", at(f32::from(save)));
        place.shows(f32::from(save), usize::from(save));
    }
    place.stays_still();
}

#[test]
fn a_file_written_in_two_halves_is_loaded_whole() {
    let place = Place::new();
    place.begin(&at(1.0));
    // The file stays open between the two writes.
    let mut file = fs::File::create(place.path("main.scene")).unwrap();
    file.write_all(b"length(p) +").unwrap();
    sleep(Duration::from_millis(50));
    file.write_all(b" 2").unwrap();
    drop(file);
    place.comes_to(2.0);
    // The file is closed between the two writes, so the loader cannot know that a second write follows.
    place.write("main.scene", "length(p) +");
    sleep(Duration::from_millis(100));
    let mut file = fs::File::options().append(true).open(place.path("main.scene")).unwrap();
    file.write_all(b" 3").unwrap();
    drop(file);
    place.comes_to(3.0);
}

#[test]
fn the_last_of_two_hundred_saves_is_loaded() {
    let place = Place::new();
    place.begin(&at(0.0));
    for save in 1..=200_u8 {
        // Every second save renames another file to this one. All texts have the same length.
        let text = format!("length(p) + {save:03}\n");
        if save % 2 == 0 {
            place.write("main.scene", text);
        } else {
            place.write("next", text);
            fs::rename(place.path("next"), place.path("main.scene")).unwrap();
        }
    }
    place.comes_to(200.0);
    place.stays_still();
    assert!(place.loads.load(Ordering::SeqCst) < 200, "saves in a burst were not combined");
}

#[test]
fn saves_without_changes_load_nothing() {
    let place = Place::new();
    place.begin(&at(1.0));
    place.write("other.scene", at(5.0));
    place.write("main.scene~", at(5.0));
    fs::create_dir(place.path("sub")).unwrap();
    place.stays_still();
    // Save the same text again, change the file's time, and rename the file to another name and back.
    place.write("main.scene", at(1.0));
    let file = fs::File::options().append(true).open(place.path("main.scene")).unwrap();
    file.set_modified(SystemTime::UNIX_EPOCH).unwrap();
    place.stays_still();
    fs::rename(place.path("main.scene"), place.path("aside")).unwrap();
    fs::rename(place.path("aside"), place.path("main.scene")).unwrap();
    place.stays_still();
    place.write("main.scene", at(2.0));
    place.shows(2.0, 2);
}

#[test]
fn a_mistake_and_its_correction_are_loaded() {
    let place = Place::new();
    place.begin(&at(1.0));
    place.write("main.scene", "length(p) + zz");
    let wrong = place.result().value.unwrap_err();
    assert!(wrong.contains("there is no `zz` here"), "{wrong}");
    place.write("main.scene", at(2.0));
    place.shows(2.0, 3);
    place.write("main.scene", [0xff, 0xfe]);
    let wrong = place.result().value.unwrap_err();
    assert!(wrong.contains("is not text"), "{wrong}");
    place.write("main.scene", at(3.0));
    place.shows(3.0, 5);
}

#[test]
fn a_changed_include_loads_the_scene_again() {
    let place = Place::new();
    fs::create_dir(place.path("sub")).unwrap();
    place.old("sub/part.scene", "let part = 1\ninclude \"deeper.scene\"");
    place.old("deeper.scene", "let deeper = 10");
    let first = place.begin("include \"sub/part.scene\"\nlength(p) + part + deeper");
    assert_eq!(first.value, Ok((11.0, vec![])));
    place.write("sub/part.scene", "let part = 2\ninclude \"deeper.scene\"");
    place.shows(12.0, 2);
    place.write("deeper.scene", "let deeper = 20");
    place.shows(22.0, 3);
    // Once a file is not included any more, changes to it have no effect.
    place.write("main.scene", at(1.0));
    place.shows(1.0, 4);
    place.write("deeper.scene", "let deeper = 30");
    place.stays_still();
}

#[test]
fn creating_a_missing_include_mends_the_scene() {
    let place = Place::new();
    let text = "include \"part.scene\"\ninclude \"new/folder/far.scene\"\nlength(p) + part + far";
    let wrong = place.begin(text).value.unwrap_err();
    assert!(wrong.contains("`part.scene` cannot be included: there is no such file"), "{wrong}");
    place.write("part.scene", "let part = 1");
    let wrong = place.result().value.unwrap_err();
    assert!(!wrong.contains("`part.scene`") && wrong.contains("`new/folder/far.scene`"), "{wrong}");
    // These folders did not exist when the scene was loaded.
    fs::create_dir_all(place.path("new/folder")).unwrap();
    sleep(Duration::from_millis(50));
    place.write("new/folder/far.scene", "let far = 2");
    place.comes_to(3.0);
    place.write("new/folder/far.scene", "let far = 3");
    place.comes_to(4.0);
}

#[test]
fn a_replaced_texture_loads_the_scene_again() {
    let place = Place::new();
    place.old("a.png", png(3));
    let first = place.begin(TEXTURED);
    assert_eq!(first.value, Ok((1.0, vec![3])));
    place.write("a.png", png(4));
    assert_eq!(place.result().value, Ok((1.0, vec![4])));
    place.write("next.png", png(5));
    fs::rename(place.path("next.png"), place.path("a.png")).unwrap();
    assert_eq!(place.result().value, Ok((1.0, vec![5])));
    place.stays_still();
}

#[test]
fn creating_a_missing_texture_mends_the_scene() {
    let place = Place::new();
    let wrong = place.begin(TEXTURED).value.unwrap_err();
    assert!(wrong.contains("there is no image `a.png`"), "{wrong}");
    place.write("a.png", png(6));
    assert_eq!(place.result().value, Ok((1.0, vec![6])));
}

#[test]
fn a_scene_behind_links_is_watched_at_its_target() {
    let place = Place::new();
    fs::create_dir(place.folder.path().join("dotfiles")).unwrap();
    let real = place.folder.path().join("dotfiles/real.scene");
    fs::write(&real, at(1.0)).unwrap();
    symlink("../dotfiles/real.scene", place.path("link.scene")).unwrap();
    symlink("link.scene", place.path("main.scene")).unwrap();
    place.loader.request(SceneSource::File(place.path("main.scene")));
    place.shows(1.0, 1);
    fs::write(&real, at(2.0)).unwrap();
    place.shows(2.0, 2);
    fs::write(place.folder.path().join("dotfiles/other.scene"), at(3.0)).unwrap();
    symlink("../dotfiles/other.scene", place.path("next")).unwrap();
    fs::rename(place.path("next"), place.path("link.scene")).unwrap();
    place.shows(3.0, 3);
}

#[test]
fn a_replaced_folder_is_watched_again() {
    let place = Place::new();
    place.begin(&at(1.0));
    let scenes = place.path("");
    fs::create_dir(place.folder.path().join("next")).unwrap();
    fs::write(place.folder.path().join("next/main.scene"), at(2.0)).unwrap();
    fs::rename(&scenes, place.folder.path().join("last")).unwrap();
    fs::rename(place.folder.path().join("next"), &scenes).unwrap();
    place.shows(2.0, 2);
    place.write("main.scene", at(3.0));
    place.shows(3.0, 3);
    // The new folder may get the inode number of the deleted folder.
    fs::remove_dir_all(&scenes).unwrap();
    fs::create_dir(&scenes).unwrap();
    place.write("main.scene", at(4.0));
    place.comes_to(4.0);
    place.write("main.scene", at(5.0));
    place.comes_to(5.0);
}

#[test]
fn only_the_last_request_is_watched() {
    let place = Place::new();
    place.begin(&at(1.0));
    place.write("other.scene", at(2.0));
    place.loader.request(SceneSource::File(place.path("other.scene")));
    place.shows(2.0, 2);
    place.write("main.scene", at(3.0));
    place.stays_still();
    place.write("other.scene", at(4.0));
    place.shows(4.0, 3);
    place.loader.request(SceneSource::Shipped("speakers".into()));
    let shipped = place.result();
    assert_eq!(shipped.value.unwrap().1.len(), 2);
    // Repeat the request, as a held key does.
    place.loader.request(SceneSource::Shipped("speakers".into()));
    assert!(place.result().value.is_ok());
}

#[test]
fn a_waiting_request_is_replaced() {
    let (begun, begins) = channel();
    let (release, held) = channel::<()>();
    let load = move |source: &SceneSource| {
        begun.send(source.name()).unwrap();
        held.recv().unwrap();
        (source.name(), vec![])
    };
    let (wake, woken) = channel();
    let loader = Loader::start(load, move || wake.send(()).unwrap()).unwrap();
    let formula = |name: &str| SceneSource::Shipped(name.to_owned());
    loader.request(formula("a"));
    assert_eq!(begins.recv_timeout(WAIT_LIMIT).unwrap(), "a.scene");
    for name in ["b", "c", "d"] {
        loader.request(formula(name));
    }
    assert_eq!(loader.poll(), None);
    release.send(()).unwrap();
    assert_eq!(begins.recv_timeout(WAIT_LIMIT).unwrap(), "d.scene");
    assert_eq!(loader.poll().unwrap().value, "a.scene");
    release.send(()).unwrap();
    woken.recv_timeout(WAIT_LIMIT).unwrap();
    woken.recv_timeout(WAIT_LIMIT).unwrap();
    assert_eq!(loader.poll().unwrap().value, "d.scene");
    assert_eq!(loader.poll(), None);
}

/// The test checks that the thread drops all objects that its load function owns.
#[test]
fn dropping_the_loader_ends_its_thread() {
    let folder = tempfile::tempdir().unwrap();
    let path: &Path = &folder.path().join("main.scene");
    fs::write(path, at(1.0)).unwrap();
    let (held, ended) = channel::<()>();
    let (wake, woken) = channel();
    let load = move |source: &SceneSource| {
        let _held = &held;
        ((), source.files(None))
    };
    let loader = Loader::start(load, move || wake.send(()).unwrap()).unwrap();
    loader.request(SceneSource::File(path.to_owned()));
    woken.recv_timeout(WAIT_LIMIT).unwrap();
    drop(loader);
    let disconnected = ended.recv_timeout(WAIT_LIMIT);
    assert_eq!(disconnected, Err(std::sync::mpsc::RecvTimeoutError::Disconnected));
}
