//! The program without a window. A session draws into memory, in the test's process and on the test's thread.

use std::cell::RefCell;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock, Mutex, Once, PoisonError};
use std::time::{Duration, Instant};

use image::RgbaImage;
use tempfile::TempDir;
use tracing_subscriber::filter::LevelFilter;

use super::apart::is_apart;
use super::desktop::{PROGRAM, command_in};
use super::offscreen::Offscreen;
use mariana::cli::prepare_show;
use mariana::clock;
use mariana::commands::{Command, ShowState};
use mariana::config::Folders;
use mariana::input::{Input, Key, KeyPress, Modifiers, NamedKey, PointerButton, Wheel};
use mariana::session::{Prepared, SessionError};
use mariana::ui::overlay::PanelSwitches;
use mariana_testing::process::{WAIT_LIMIT, output_of};
use mariana_testing::wave::write_wav;

/// Options of most tests: no scenes prepared ahead, no overlay, no state from an earlier session, no sound.
const ALONE: [&str; 5] = ["--prepare-ahead", "off", "--clean", "--new", "--silent"];

/// A frame counts as settled when it has stayed the same for this time.
const REST: Duration = Duration::from_millis(150);
/// A little more than the duration of a frame.
const PICTURE: Duration = Duration::from_millis(20);

pub(crate) struct Place {
    folder: PathBuf,
    /// Removes the folder when this field is dropped; `None` if another process owns the folder.
    _own: Option<TempDir>,
    drawer: PathBuf,
}

impl Place {
    /// A new folder. It contains only the folder `midi`, which simulates the ports of MIDI devices.
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().to_owned();
        std::fs::create_dir(path.join("midi")).unwrap();
        Self { _own: Some(folder), ..Self::at(&path) }
    }

    /// A new folder with a silent song of one minute at [`Self::song`].
    pub(crate) fn with_song() -> Self {
        let place = Self::new();
        place.quiet_song("quiet.wav", 60);
        place
    }

    pub(crate) fn song(&self) -> PathBuf {
        self.path("quiet.wav")
    }

    pub(crate) fn at(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), _own: None, drawer: env!("CARGO_BIN_EXE_mariana").into() }
    }

    pub(crate) fn draw_by(&mut self, program: PathBuf) {
        self.drawer = program;
    }

    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    pub(crate) fn settings(&self) -> PathBuf {
        self.path("config/settings.toml")
    }

    pub(crate) fn save(&self, name: &str, text: &str) -> PathBuf {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, text).unwrap();
        path
    }

    /// Opens a session with `song`, without sound output and without overlay.
    pub(crate) fn open(&self, song: &Path, options: &[&str]) -> App {
        self.begin(&[&[song.to_str().unwrap()], &ALONE[..], options].concat())
    }

    /// Opens a session with the demo track, without sound output and without overlay.
    pub(crate) fn listen(&self, options: &[&str]) -> App {
        self.begin(&[&ALONE[..], options].concat())
    }

    /// Like [`Self::open`], with a separate thread that compiles shaders.
    pub(crate) fn open_with_compiler(&self, song: &Path, options: &[&str]) -> App {
        let platform = std::env::var("EGL_PLATFORM").unwrap_or_default();
        assert_eq!(
            platform, "surfaceless",
            "begin the test with `apart!(\"EGL_PLATFORM\" = \"surfaceless\")`"
        );
        let all = [&[song.to_str().unwrap()], &ALONE[..], options].concat();
        let app = self.start(&all, Offscreen::open_with_compiler);
        assert!(
            !app.reported().contains("cannot create a context on the default display"),
            "{}",
            app.reported()
        );
        app
    }

    pub(crate) fn hear(&self, song: Option<&Path>, options: &[&str]) -> App {
        let song: Vec<&str> = song.iter().map(|song| song.to_str().unwrap()).collect();
        let alone: Vec<&str> = ALONE.into_iter().filter(|option| *option != "--silent").collect();
        self.begin(&[&song[..], &alone, options].concat())
    }

    pub(crate) fn begin(&self, arguments: &[&str]) -> App {
        self.start(arguments, Offscreen::open)
    }

    fn start(&self, arguments: &[&str], open: fn(Prepared) -> Result<Offscreen, SessionError>) -> App {
        assert!(is_apart(), "begin the test with `apart!()`");
        let log = Log::default();
        log.listen();
        let folders = Folders {
            midi_ports: Some(self.path("midi")),
            program: Some(self.drawer.clone()),
            ..Folders::within(self.folder())
        };
        let prepared =
            prepare_show(arguments.iter().copied(), folders).unwrap_or_else(|error| panic!("{error:#}"));
        let session = open(prepared).unwrap_or_else(|error| panic!("{error}"));
        App { session: RefCell::new(session), held: RefCell::default(), log }
    }

    pub(crate) fn saved_settings(&self) -> String {
        std::fs::read_to_string(self.settings()).unwrap_or_default()
    }

    /// Compares frames of the window at their times, in seconds, with stills of the show in the file `show`.
    pub(crate) fn compare_with_stills(
        &self,
        (song, show): (&Path, &str),
        size: &str,
        pictures: &[(f64, RgbaImage)],
    ) {
        let text = std::fs::read_to_string(show).unwrap();
        for (time, picture) in pictures {
            let output = self.path("still.png");
            let mut still = command_in(PROGRAM, self.folder(), None);
            still.arg("still").arg(song).args(["--show", show, "--size", size, "-o"]).arg(&output);
            output_of(still.args(["--at", &time.to_string()]), "mariana").unwrap();
            let found = image::open(&output).unwrap().to_rgba8();
            let apart = |(a, b): (&u8, &u8)| a.abs_diff(*b);
            let most = found.as_raw().iter().zip(picture.as_raw()).map(apart).max();
            assert!(found == *picture, "a different frame at {time} s, by up to {most:?} of 255:\n{text}");
        }
    }

    pub(crate) fn quiet_song(&self, name: &str, seconds: usize) -> PathBuf {
        let song = self.path(name);
        write_wav(&song, 8_000, 2, std::iter::repeat_n(0.0, 2 * 8_000 * seconds));
        song
    }

    /// Ends a session as a power cut would: the folder gets back the state before the end, without the files that the
    /// session writes at its end.
    pub(crate) fn cut_off(&self, app: App) {
        let kept = tempfile::tempdir().unwrap();
        copy_folder(self.folder(), kept.path());
        drop(app);
        for entry in std::fs::read_dir(self.folder()).unwrap().flatten() {
            let path = entry.path();
            if path.is_dir() { std::fs::remove_dir_all(path) } else { std::fs::remove_file(path) }.unwrap();
        }
        copy_folder(kept.path(), self.folder());
    }
}

/// Skips files that disappear meanwhile.
fn copy_folder(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).into_iter().flatten().flatten() {
        let (path, to) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() {
            copy_folder(&path, &to);
        } else {
            let _ = std::fs::copy(path, to);
        }
    }
}

/// The messages and the log of a session.
#[derive(Clone, Default)]
struct Log(Arc<Mutex<Vec<u8>>>);

/// All sessions of a process share a subscriber, which writes to this log.
static NEWEST: LazyLock<Mutex<Log>> = LazyLock::new(Mutex::default);

impl Log {
    /// Redirects the log of all threads of this process to `self`.
    fn listen(&self) {
        static STARTED: Once = Once::new();
        *NEWEST.lock().unwrap() = self.clone();
        STARTED.call_once(|| {
            let lines = tracing_subscriber::fmt()
                .with_writer(|| NEWEST.lock().unwrap().clone())
                .with_ansi(false)
                .without_time()
                .with_max_level(LevelFilter::DEBUG)
                .finish();
            tracing::subscriber::set_global_default(lines).unwrap();
        });
    }

    fn text(&self) -> String {
        String::from_utf8_lossy(&self.0.lock().unwrap_or_else(PoisonError::into_inner)).into_owned()
    }
}

impl Write for Log {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// A session that a test operates as a user. The session advances only during calls of these methods.
pub(crate) struct App {
    session: RefCell<Offscreen>,
    held: RefCell<Modifiers>,
    log: Log,
}

impl App {
    /// Presses keys one after the other, by their X11 names such as `space`, `shift+v` or `Return`.
    pub(crate) fn press(&self, keys: &[&str]) {
        for key in keys {
            self.press_one(key);
        }
    }

    /// Pauses a song of at most a minute and returns to its start, even if it played to its end on a busy machine.
    pub(crate) fn pause_at_start(&self) {
        self.press(&["space"]);
        self.wait_for_title("paused", |title| title.contains("paused"));
        self.press(&["Left"; 60 / 5]);
    }

    fn press_one(&self, written: &str) {
        let (mut held, mut name) = (*self.held.borrow(), written);
        while let Some((modifier, rest)) = name.split_once('+').filter(|(modifier, _)| !modifier.is_empty()) {
            held |= match modifier {
                "shift" => Modifiers::SHIFT,
                "ctrl" => Modifiers::CONTROL,
                "alt" => Modifiers::ALT,
                "super" => Modifiers::SUPER,
                other => panic!("unknown modifier: {other}"),
            };
            name = rest;
        }
        let key = key_of(name, held.contains(Modifiers::SHIFT));
        let text = match &key {
            Key::Character(text) => Some(text.clone()),
            Key::Named(NamedKey::Space) => Some(" ".to_owned()),
            _ => None,
        };
        let latin = text.as_ref().and_then(|text| text.chars().next()).filter(char::is_ascii);
        let before = *self.held.borrow();
        self.send(Input::Modifiers(held));
        self.send(Input::Key(KeyPress { key, latin, text, repeat: false }));
        self.send(Input::Modifiers(before));
    }

    pub(crate) fn type_text(&self, text: &str) {
        for letter in text.chars() {
            let key = match letter {
                ' ' => Key::Named(NamedKey::Space),
                '\n' => Key::Named(NamedKey::Enter),
                letter => Key::Character(letter.to_string()),
            };
            let text = (letter != '\n').then(|| letter.to_string());
            let latin = Some(letter).filter(char::is_ascii);
            self.send(Input::Key(KeyPress { key, latin, text, repeat: false }));
        }
    }

    /// Holds these modifiers from now on.
    pub(crate) fn hold(&self, modifiers: Modifiers) {
        self.held.replace(modifiers);
        self.send(Input::Modifiers(modifiers));
    }

    /// Moves the pointer to a position in pixels of the window.
    pub(crate) fn move_pointer(&self, x: f64, y: f64) {
        self.send(Input::PointerMoved([x, y]));
    }

    /// Presses or releases the primary pointer button. The overlay processes the button before the pointer moves. If
    /// both happened in one frame, a press would grab the widget at the pointer's new position.
    pub(crate) fn hold_button(&self, pressed: bool) {
        clock::by_hand(|| {
            self.send(Input::PointerButton { button: PointerButton::Primary, pressed });
            self.see();
        });
    }

    pub(crate) fn click(&self) {
        self.hold_button(true);
        self.hold_button(false);
    }

    /// Turns the wheel by a number of notches. Positive numbers turn it away from the user.
    pub(crate) fn turn_wheel(&self, notches: f64) {
        self.send(Input::Wheel(Wheel::Notches([0.0, notches])));
    }

    pub(crate) fn send(&self, input: Input) {
        self.session.borrow_mut().send(input);
        self.step();
    }

    pub(crate) fn command(&self, command: Command) {
        self.session.borrow_mut().command(command);
        self.step();
    }

    pub(crate) fn resize(&self, size: (u32, u32)) {
        self.session.borrow_mut().resize(size);
        self.step();
    }

    pub(crate) fn step(&self) -> bool {
        self.session.borrow_mut().step().unwrap_or_else(|error| panic!("{error}; {}", self.reported()))
    }

    pub(crate) fn run_for(&self, time: Duration) {
        let start = Instant::now();
        while start.elapsed() < time && self.step() {}
    }

    pub(crate) fn wait_until(&self, what: &str, mut is_so: impl FnMut(&Self) -> bool) {
        let start = Instant::now();
        loop {
            let goes_on = self.step();
            if is_so(self) {
                return;
            }
            assert!(goes_on, "the session ended while the test waited for {what}: {}", self.reported());
            assert!(start.elapsed() < WAIT_LIMIT, "timed out waiting for {what}: {}", self.reported());
        }
    }

    /// Advances the session until `is_wanted` accepts the frame, and returns the frame.
    pub(crate) fn wait_for(&self, what: &str, is_wanted: impl Fn(&RgbaImage) -> bool) -> RgbaImage {
        self.wait_until(what, |app| is_wanted(&app.session.borrow().window().picture));
        self.session.borrow().window().picture.clone()
    }

    pub(crate) fn wait_for_title(&self, what: &str, is_wanted: impl Fn(&str) -> bool) {
        self.wait_until(&format!("a title with {what}"), |app| {
            is_wanted(&app.session.borrow().window().title)
        });
    }

    pub(crate) fn wait_until_reported(&self, what: &str) {
        self.wait_until(what, |app| app.reported().contains(what));
    }

    /// Advances the session until the frame stays the same for a while at its final quality, and returns the frame.
    pub(crate) fn wait_until_still(&self) -> RgbaImage {
        let (mut last, mut since) = (self.picture(), Instant::now());
        self.wait_until("a frame that stays the same", |app| {
            let now = app.session.borrow().window().picture.clone();
            if now != last {
                (last, since) = (now, Instant::now());
            }
            since.elapsed() > Duration::from_millis(700) && app.session.borrow().is_at_rest()
        });
        last
    }

    /// Advances the session until another frame than `before` stays the same for [`REST`], and returns that frame.
    pub(crate) fn settled(&self, before: &RgbaImage, what: &str) -> RgbaImage {
        let (mut last, mut since) = (before.clone(), Instant::now());
        self.wait_until(&format!("{what}: another frame that stays the same"), |app| {
            let picture = app.picture();
            if picture != last || picture == *before {
                (last, since) = (picture, Instant::now());
            }
            since.elapsed() > REST
        });
        last
    }

    pub(crate) fn picture(&self) -> RgbaImage {
        self.step();
        self.session.borrow().window().picture.clone()
    }

    pub(crate) fn title(&self) -> String {
        self.step();
        self.session.borrow().window().title.clone()
    }

    pub(crate) fn state(&self) -> ShowState {
        self.session.borrow_mut().state()
    }

    pub(crate) fn panels(&self) -> PanelSwitches {
        self.session.borrow().panels()
    }

    /// The log with the messages. Each message to the user follows `message: `.
    pub(crate) fn reported(&self) -> String {
        self.log.text()
    }

    pub(crate) fn runs(&self) -> bool {
        self.step()
    }

    pub(crate) fn shown(&self) -> u64 {
        self.session.borrow().window().shown
    }

    /// Messages to the user, warnings and errors, as a terminal shows them.
    pub(crate) fn reported_problems(&self) -> Vec<String> {
        reported_problems(&self.reported())
    }

    /// Ends the session as its user would. Returns the log.
    pub(crate) fn quit(self) -> String {
        let Self { session, log, .. } = self;
        session.into_inner().finish();
        log.text()
    }

    pub(crate) fn wait_until_reported_times(&self, what: &str, times: usize) {
        self.wait_until(what, |app| app.reported().matches(what).count() >= times);
    }

    /// Advances the session while `act` runs on another thread. Returns the result of `act`.
    pub(crate) fn meanwhile<T: Send>(&self, act: impl FnOnce() -> T + Send) -> T {
        std::thread::scope(|scope| {
            let acting = scope.spawn(act);
            while !acting.is_finished() {
                self.step();
            }
            acting.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        })
    }

    pub(crate) fn point_at(&self, x: u32, y: u32) {
        clock::by_hand(|| {
            self.move_pointer(x.into(), y.into());
            self.see();
            self.see();
        });
    }

    /// Lets the overlay process the input. The clock advances by one frame, even if drawing takes longer.
    fn see(&self) {
        clock::advance(PICTURE);
        self.take_steps(2);
    }

    /// Clicks at a position in the window. The clock stops meanwhile, so that a slow frame does not turn the click into
    /// a long press.
    pub(crate) fn click_at(&self, x: u32, y: u32) {
        self.point_at(x, y);
        clock::by_hand(|| {
            self.hold_button(true);
            self.hold_button(false);
        });
    }

    pub(crate) fn drag(&self, from: (u32, u32), to: (u32, u32)) {
        self.point_at(from.0, from.1);
        self.hold_button(true);
        self.point_at(to.0, to.1);
        self.hold_button(false);
    }

    pub(crate) fn double_click_at(&self, x: u32, y: u32) {
        clock::by_hand(|| {
            self.click_at(x, y);
            self.click_at(x, y);
        });
    }

    pub(crate) fn take_steps(&self, count: usize) {
        for _ in 0..count {
            self.step();
        }
    }

    pub(crate) fn quit_by_key(self) -> String {
        self.press(&["q"]);
        let begun = Instant::now();
        while self.step() {
            assert!(begun.elapsed() < WAIT_LIMIT, "Q does not end the session: {}", self.reported());
        }
        self.quit()
    }

    /// Like [`Self::quit_by_key`], but fails if the session printed a message on standard error.
    pub(crate) fn quit_content(self) -> String {
        let reported = self.quit_by_key();
        assert!(!complains(&reported), "it complains: {reported}");
        reported
    }
}

/// True if the log contains a message that the program prints on standard error.
fn complains(reported: &str) -> bool {
    reported.lines().any(|line| line.trim_start().starts_with("DEBUG message: "))
}

pub(crate) fn reported_problems(reported: &str) -> Vec<String> {
    let is_complaint = |line: &&str| {
        let line = line.trim_start();
        line.starts_with("DEBUG message: ") || line.starts_with("WARN") || line.starts_with("ERROR")
    };
    reported.lines().filter(is_complaint).map(str::to_owned).collect()
}

fn key_of(name: &str, shift: bool) -> Key {
    let named = match name {
        "space" => NamedKey::Space,
        "Return" => NamedKey::Enter,
        "Escape" => NamedKey::Escape,
        "Tab" => NamedKey::Tab,
        "BackSpace" => NamedKey::Backspace,
        "Delete" => NamedKey::Delete,
        "Home" => NamedKey::Home,
        "End" => NamedKey::End,
        "Prior" | "Page_Up" => NamedKey::PageUp,
        "Next" | "Page_Down" => NamedKey::PageDown,
        "Left" => NamedKey::ArrowLeft,
        "Right" => NamedKey::ArrowRight,
        "Up" => NamedKey::ArrowUp,
        "Down" => NamedKey::ArrowDown,
        "F1" => NamedKey::F1,
        "F2" => NamedKey::F2,
        "F3" => NamedKey::F3,
        "F4" => NamedKey::F4,
        "F5" => NamedKey::F5,
        "F6" => NamedKey::F6,
        "F7" => NamedKey::F7,
        "F8" => NamedKey::F8,
        "F9" => NamedKey::F9,
        "F10" => NamedKey::F10,
        "F11" => NamedKey::F11,
        "F12" => NamedKey::F12,
        "comma" => return Key::Character(",".to_owned()),
        "period" => return Key::Character(".".to_owned()),
        "bracketleft" => return Key::Character("[".to_owned()),
        "bracketright" => return Key::Character("]".to_owned()),
        "slash" => return Key::Character("/".to_owned()),
        "less" => return Key::Character("<".to_owned()),
        "greater" => return Key::Character(">".to_owned()),
        "plus" => return Key::Character("+".to_owned()),
        letter => {
            assert_eq!(letter.chars().count(), 1, "unknown key: {letter}");
            let letter = if shift { letter.to_uppercase() } else { letter.to_owned() };
            return Key::Character(letter);
        }
    };
    Key::Named(named)
}
