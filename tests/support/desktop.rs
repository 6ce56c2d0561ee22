//! A private desktop (an X server without a screen, and a window manager), and the program in a window on this desktop.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use image::{Rgba, RgbaImage};
use tempfile::TempDir;

use x11rb::connection::Connection;
use x11rb::protocol::randr::{ConnectionExt as _, MonitorInfo};
use x11rb::protocol::xproto::{ConnectionExt as _, ImageFormat};
use x11rb::rust_connection::RustConnection;

use super::compare::{TIGHT, assert_alike, difference};
use mariana_testing::process::{
    LOOK_PERIOD, Process, WAIT_LIMIT, output_of, private_folder, session_environment, wait_until,
};

pub(crate) const PROGRAM: &str = env!("CARGO_BIN_EXE_mariana");

/// Width and height of the screen, in pixels. The screen is small, because it is drawn without a graphics card.
pub(crate) const SCREEN: (u32, u32) = (800, 600);

/// Options of most tests. They turn off preparing scenes ahead, because tests run in parallel and share the processors.
/// They also hide the overlay and ignore the state that an earlier run saved.
const ALONE: [&str; 4] = ["--prepare-ahead", "off", "--clean", "--new"];

/// The unit of processor times in `/proc`.
const TICKS_PER_SECOND: f64 = 100.0;

/// Limits the number of simultaneous desktops, because the programs on them share the processors.
static PLACES: Places = Places { free: Mutex::new(2), freed: Condvar::new() };

struct Places {
    free: Mutex<usize>,
    freed: Condvar,
}

/// A permit to run a desktop. Dropping it lets the next desktop start.
pub(crate) struct Place;

impl Place {
    pub(crate) fn wait_for() -> Self {
        let free = PLACES.free.lock().unwrap_or_else(PoisonError::into_inner);
        let mut free =
            PLACES.freed.wait_while(free, |free| *free == 0).unwrap_or_else(PoisonError::into_inner);
        *free -= 1;
        Self
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        *PLACES.free.lock().unwrap_or_else(PoisonError::into_inner) += 1;
        PLACES.freed.notify_one();
    }
}

/// An X server with a window manager, and a folder for the session. Dropping it ends both and deletes the folder.
pub(crate) struct Desktop {
    // Field order matters: the window manager ends before its server.
    _manager: Process,
    server: Process,
    display: String,
    folder: TempDir,
    _place: Place,
}

impl Desktop {
    pub(crate) fn start() -> Self {
        let place = Place::wait_for();
        let folder = private_folder();
        let (server, display) = start_x_server();
        let manager = Process::start(
            command_in("openbox", folder.path(), Some(&display)).stdout(Stdio::null()).stderr(Stdio::null()),
            "openbox",
        );
        let desktop = Self { _manager: manager, server, display, folder, _place: place };
        wait_until("the window manager", || {
            output_of(desktop.command("wmctrl").arg("-m"), "wmctrl")
                .is_ok_and(|about| String::from_utf8_lossy(&about).contains("Openbox"))
        });
        desktop
    }

    pub(crate) fn folder(&self) -> &Path {
        self.folder.path()
    }

    pub(crate) fn command(&self, name: &str) -> Command {
        command_in(name, self.folder(), Some(&self.display))
    }

    /// Opens the program with `song` and waits for its window. The window shows no overlay unless `options` turn it on.
    pub(crate) fn open(&self, song: &Path, options: &[&str]) -> App<'_> {
        self.open_printing_to(Stdio::piped(), song, options)
    }

    /// Like [`Self::open`], with the default overlay.
    pub(crate) fn open_with_words(&self, song: &Path, options: &[&str]) -> App<'_> {
        let mut command = self.command(PROGRAM);
        command.arg(song).args(options).stdout(Stdio::piped()).stderr(Stdio::piped());
        self.show(command, song)
    }

    /// Opens the program without a song: it listens to live input or plays the demo track.
    pub(crate) fn listen(&self, options: &[&str]) -> App<'_> {
        self.listen_printing_to(Stdio::piped(), options)
    }

    pub(crate) fn listen_printing_to(&self, stdout: Stdio, options: &[&str]) -> App<'_> {
        let mut command = self.command(PROGRAM);
        command.args(ALONE).args(options).stdout(stdout).stderr(Stdio::piped());
        self.show(command, Path::new(""))
    }

    pub(crate) fn open_with(&self, variables: &[(&str, &str)], song: &Path, options: &[&str]) -> App<'_> {
        let mut command = self.command(PROGRAM);
        command.envs(variables.iter().copied()).arg(song).args(ALONE).args(options);
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        self.show(command, song)
    }

    pub(crate) fn kill_server(&self) {
        self.signal_server("-KILL");
    }

    /// Stops the X server, or resumes it. A stopped server accepts requests and answers them after it is resumed.
    pub(crate) fn halt_server(&self, halt: bool) {
        self.signal_server(if halt { "-STOP" } else { "-CONT" });
    }

    fn signal_server(&self, signal: &str) {
        let number = self.server.id().to_string();
        output_of(Command::new("kill").args([signal, &number]), "procps").unwrap();
    }

    pub(crate) fn screen(&self) -> RgbaImage {
        let (server, root) = self.connect();
        let (width, height) = (SCREEN.0 as u16, SCREEN.1 as u16);
        let image = server.get_image(ImageFormat::Z_PIXMAP, root, 0, 0, width, height, u32::MAX).unwrap();
        let image = image.reply().unwrap();
        assert_eq!(image.data.len(), (4 * SCREEN.0 * SCREEN.1) as usize, "the screen's pixels are not BGRX");
        RgbaImage::from_fn(SCREEN.0, SCREEN.1, |x, y| {
            let at = 4 * (y * SCREEN.0 + x) as usize;
            Rgba([image.data[at + 2], image.data[at + 1], image.data[at], 255])
        })
    }

    /// Declares a part of the screen as a monitor, by its left edge and width. Before the first call, the whole screen
    /// is a monitor.
    pub(crate) fn plug_monitor(&self, name: &str, left: i16, width: u16) {
        let (server, root) = self.connect();
        let outputs = server.randr_get_screen_resources_current(root).unwrap().reply().unwrap().outputs;
        let info = MonitorInfo {
            name: server.intern_atom(false, name.as_bytes()).unwrap().reply().unwrap().atom,
            primary: left == 0,
            automatic: false,
            x: left,
            y: 0,
            width,
            height: SCREEN.1 as u16,
            width_in_millimeters: 100,
            height_in_millimeters: 100,
            // The screen has one output. The monitor that gets it replaces the monitor of the whole screen.
            outputs: if left == 0 { outputs } else { Vec::new() },
        };
        server.randr_set_monitor(root, info).unwrap().check().unwrap();
    }

    pub(crate) fn pull_monitor(&self, name: &str) {
        let (server, root) = self.connect();
        let name = server.intern_atom(false, name.as_bytes()).unwrap().reply().unwrap().atom;
        server.randr_delete_monitor(root, name).unwrap().check().unwrap();
    }

    /// Connects to the X server. Returns the connection and the root window.
    pub(crate) fn connect(&self) -> (RustConnection, u32) {
        let (server, number) = x11rb::connect(Some(&self.display)).unwrap();
        let root = server.setup().roots[number].root;
        (server, root)
    }

    pub(crate) fn display(&self) -> &str {
        &self.display
    }

    pub(crate) fn open_printing_to(&self, stdout: Stdio, song: &Path, options: &[&str]) -> App<'_> {
        let mut command = self.command(PROGRAM);
        command.arg(song).args(ALONE).args(options).stdout(stdout).stderr(Stdio::piped());
        self.show(command, song)
    }

    /// Runs `command`, which starts the program with `song`. Waits until the window is visible and focused.
    pub(crate) fn show(&self, command: Command, song: &Path) -> App<'_> {
        let mut app = self.show_without_focus(command, song);
        app.wait("the keyboard focus", |app| {
            let active = output_of(app.desktop.command("xdotool").arg("getactivewindow"), "xdotool").ok()?;
            (String::from_utf8_lossy(&active).trim() == app.window).then_some(())
        });
        app
    }

    pub(crate) fn show_without_focus(&self, mut command: Command, song: &Path) -> App<'_> {
        let mut process = Process::start(&mut command, "mariana");
        let printed = process.child().stdout.take().map(collect).unwrap_or_default();
        let reported = collect(process.child().stderr.take().unwrap());
        let mut app =
            App { desktop: self, process, song: song.to_owned(), printed, reported, window: String::new() };
        app.wait("its window", |app| {
            let mut search = app.desktop.command("xdotool");
            let own = app.process.id().to_string();
            search.args(["search", "--all", "--onlyvisible", "--pid", &own, "--name", " - Mariana"]);
            let found = output_of(&mut search, "xdotool").ok()?;
            let found = String::from_utf8_lossy(&found);
            app.window = found.lines().next()?.to_owned();
            Some(())
        });
        app
    }
}

/// Starts an X server. Returns the process and the display's name.
pub(crate) fn start_x_server() -> (Process, String) {
    let screen = format!("{}x{}x24", SCREEN.0, SCREEN.1);
    let mut server = Process::start(
        Command::new("Xvfb")
            // Without -noreset, the server resets when its first client disconnects. If that client is wmctrl, the
            // reset ends the window manager.
            .args(["-displayfd", "1", "-noreset", "-nolisten", "tcp", "-screen", "0", &screen])
            .stdout(Stdio::piped())
            .stderr(Stdio::null()),
        "xvfb",
    );
    let number = collect(server.stdout());
    wait_until("the X server's display", || lock(&number).ends_with('\n'));
    let display = format!(":{}", lock(&number).trim());
    (server, display)
}

pub(crate) fn command_in(name: &str, folder: &Path, display: Option<&str>) -> Command {
    let mut command = Command::new(name);
    command.stdin(Stdio::null()).envs(session_environment(folder));
    for other in [
        "DISPLAY",
        "WAYLAND_DISPLAY",
        "WAYLAND_SOCKET",
        "XDG_CONFIG_HOME",
        "XDG_CACHE_HOME",
        "XDG_DATA_HOME",
        "XDG_STATE_HOME",
        "DBUS_SESSION_BUS_ADDRESS",
    ] {
        command.env_remove(other);
    }
    if let Some(display) = display {
        command.env("DISPLAY", display);
    }
    command
}

pub(crate) type Size = (u32, u32);

/// Dropping it ends the program.
pub(crate) struct App<'d> {
    desktop: &'d Desktop,
    process: Process,
    song: PathBuf,
    printed: Text,
    reported: Text,
    window: String,
}

impl App<'_> {
    /// Presses keys one after the other, by their X11 names.
    pub(crate) fn press(&self, keys: &[&str]) {
        self.xdotool(&[&["key"], keys].concat());
    }

    pub(crate) fn xdotool(&self, arguments: &[&str]) -> String {
        let printed = output_of(self.desktop.command("xdotool").args(arguments), "xdotool");
        String::from_utf8_lossy(&printed.unwrap_or_else(|error| panic!("{error}; {}", self.reported())))
            .into_owned()
    }

    pub(crate) fn window(&self) -> &str {
        &self.window
    }

    pub(crate) fn process_id(&self) -> u32 {
        self.process.id()
    }

    pub(crate) fn title(&self) -> String {
        self.xdotool(&["getwindowname", &self.window]).trim().to_owned()
    }

    pub(crate) fn wait_for_title(&mut self, what: &str, wanted: impl Fn(&str) -> bool) {
        let start = Instant::now();
        self.wait(&format!("a title with {what}"), |app| {
            let title = app.title();
            assert!(
                wanted(&title) || start.elapsed() < WAIT_LIMIT,
                "timed out waiting for {what} in the \
                title, which is '{title}'"
            );
            wanted(&title).then_some(())
        });
    }

    pub(crate) fn size(&self) -> Size {
        let text = self.xdotool(&["getwindowgeometry", "--shell", &self.window]);
        let number = |name: &str| {
            let line = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix('='));
            line.and_then(|number| number.parse().ok()).unwrap_or_else(|| panic!("no {name} in {text}"))
        };
        (number("WIDTH"), number("HEIGHT"))
    }

    pub(crate) fn wait_for_size(&mut self, size: Size) {
        self.wait(&format!("a window of {size:?}"), |app| (app.size() == size).then_some(()));
    }

    pub(crate) fn picture(&self) -> RgbaImage {
        let mut picture = None;
        wait_until("a screenshot of the window", || {
            picture = self.try_picture().ok();
            picture.is_some()
        });
        picture.unwrap()
    }

    fn try_picture(&self) -> Result<RgbaImage, String> {
        let mut command = self.desktop.command("xwd");
        let dump = output_of(command.args(["-silent", "-id", &self.window]), "x11-apps")?;
        // While a window opens or closes, the server returns only a part of the window.
        let picture = decode_window_dump(&dump)?;
        if picture.dimensions() == self.size() {
            Ok(picture)
        } else {
            Err("only a part of the window is visible".into())
        }
    }

    pub(crate) fn still(&self, at: f64, size: Size) -> RgbaImage {
        let path = self.desktop.folder().join("still.png");
        let mut command = command_in(PROGRAM, self.desktop.folder(), None);
        command.arg("still").arg(&self.song).arg("-o").arg(&path);
        command.args(["--at", &at.to_string(), "--size", &format!("{}x{}", size.0, size.1)]);
        output_of(&mut command, "mariana").unwrap_or_else(|error| panic!("{error}"));
        image::open(&path).unwrap().to_rgba8()
    }

    /// Waits until the window's image equals the image of `mariana still` for this time, at the window's size.
    pub(crate) fn wait_for_moment(&mut self, at: f64) -> RgbaImage {
        let size = self.size();
        let wanted = self.still(at, size);
        let start = Instant::now();
        // The image may differ for a while during a resize or a redraw.
        let alike = |seen: &RgbaImage| {
            let found = difference(seen, &wanted, TIGHT.visible);
            found.mean <= TIGHT.mean_max && found.fraction <= TIGHT.fraction_max
        };
        loop {
            let seen = self.try_picture();
            match &seen {
                Ok(seen) if seen.dimensions() == size && alike(seen) => return seen.clone(),
                _ if start.elapsed() < WAIT_LIMIT => std::thread::sleep(LOOK_PERIOD),
                Ok(seen) => {
                    assert_alike(&format!("window-{}x{}-at-{at}", size.0, size.1), seen, &wanted, TIGHT)
                }
                Err(error) => panic!("{error}; {}", self.reported()),
            }
        }
    }

    pub(crate) fn load(&self, time: Duration) -> f64 {
        load_of(self.process.id(), || std::thread::sleep(time))
    }

    pub(crate) fn memory_mib(&self) -> f64 {
        let text = std::fs::read_to_string(format!("/proc/{}/status", self.process.id())).unwrap();
        let line = text.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
        line.trim().trim_end_matches(" kB").trim().parse::<f64>().unwrap() / 1024.0
    }

    pub(crate) fn printed(&self) -> String {
        lock(&self.printed).clone()
    }

    pub(crate) fn reported(&self) -> String {
        lock(&self.reported).clone()
    }

    pub(crate) fn wait_until_reported(&mut self, what: &str) {
        self.wait(&format!("'{what}'"), |app| app.reported().contains(what).then_some(()));
    }

    pub(crate) fn wait_until_reported_times(&mut self, what: &str, times: usize) {
        let reported = |app: &mut Self| (app.reported().matches(what).count() >= times).then_some(());
        self.wait(&format!("'{what}', {times} times"), reported);
    }

    pub(crate) fn runs(&mut self) -> bool {
        self.process.ended().is_none()
    }

    pub(crate) fn wait_for_end(mut self) -> (ExitStatus, String) {
        let start = Instant::now();
        loop {
            if let Some(status) = self.process.ended() {
                return (status, wait_for_all(&self.reported));
            }
            assert!(start.elapsed() < WAIT_LIMIT, "still running after {WAIT_LIMIT:?}; {}", self.reported());
            std::thread::sleep(LOOK_PERIOD);
        }
    }

    /// Polls `look` until it returns a value. Fails on a timeout, or if the program ends.
    fn wait<T>(&mut self, what: &str, mut look: impl FnMut(&mut Self) -> Option<T>) -> T {
        let start = Instant::now();
        loop {
            if let Some(ended) = self.process.ended() {
                panic!("the program ended ({ended}) while the test waited for {what}: {}", self.reported());
            }
            if let Some(found) = look(self) {
                return found;
            }
            assert!(
                start.elapsed() < WAIT_LIMIT,
                "timed out waiting for {what}; standard error: {}",
                self.reported()
            );
            std::thread::sleep(LOOK_PERIOD);
        }
    }
}

/// Returns the average number of processors that a process uses while `act` runs.
pub(crate) fn load_of(process: u32, act: impl FnOnce()) -> f64 {
    let (worked, since) = (processor_seconds(process), Instant::now());
    act();
    (processor_seconds(process) - worked) / since.elapsed().as_secs_f64()
}

fn processor_seconds(process: u32) -> f64 {
    let text = std::fs::read_to_string(format!("/proc/{process}/stat")).unwrap();
    // The name in brackets may contain any character. User and system time are the 14th and the 15th field.
    let (_, fields) = text.rsplit_once(')').unwrap();
    let ticks: f64 =
        fields.split_whitespace().skip(11).take(2).map(|field| field.parse::<f64>().unwrap()).sum();
    ticks / TICKS_PER_SECOND
}

pub(crate) type Text = Arc<Mutex<String>>;

/// Reads a stream to its end on a separate thread, which holds the second reference to the text until the end.
pub(crate) fn collect(mut stream: impl Read + Send + 'static) -> Text {
    let text = Text::default();
    let collected = text.clone();
    std::thread::spawn(move || {
        let mut block = [0_u8; 4096];
        while let Ok(count @ 1..) = stream.read(&mut block) {
            lock(&collected).push_str(&String::from_utf8_lossy(&block[..count]));
        }
    });
    text
}

/// Waits until [`collect`] has read everything that a program wrote, which may be later than the program's end.
pub(crate) fn wait_for_all(text: &Text) -> String {
    wait_until("the end of the output", || Arc::strong_count(text) == 1);
    lock(text).clone()
}

pub(crate) fn lock(text: &Mutex<String>) -> MutexGuard<'_, String> {
    text.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Decodes an image of xwd (X11/XWDFile.h): big-endian numbers, colour cells, then rows of pixels.
fn decode_window_dump(bytes: &[u8]) -> Result<RgbaImage, String> {
    let field = |index: usize| {
        let bytes = bytes.get(4 * index..)?.first_chunk::<4>()?;
        Some(u32::from_be_bytes(*bytes))
    };
    let numbers: Vec<u32> = (0..20).map_while(field).collect();
    let [header, _, _, _, width, height, _, order, _, _, _, bits, stride, _, red, green, blue, _, _, cells] =
        numbers[..]
    else {
        return Err("xwd returned no image".to_owned());
    };
    if (order, bits, red, green, blue) != (0, 32, 0xff_0000, 0xff00, 0xff) {
        return Err("the X server's pixels are not BGRX".to_owned());
    }
    let pixels = bytes.get((header + 12 * cells) as usize..).unwrap_or_default();
    if pixels.len() < (stride * height) as usize {
        return Err("xwd returned a truncated image".to_owned());
    }
    Ok(RgbaImage::from_fn(width, height, |x, y| {
        let at = (y * stride + 4 * x) as usize;
        Rgba([pixels[at + 2], pixels[at + 1], pixels[at], 255])
    }))
}
