//! A screen reader for tests: reads and operates a program's controls over D-Bus.

use std::path::Path;
use std::process::{Command, Stdio};

use super::process::{Process, session_environment, wait_until};
use super::session_bus::{SessionBus, send};

/// Paths of the accessibility bus launcher in different distributions.
const LAUNCHERS: [&str; 3] = [
    "/usr/libexec/at-spi-bus-launcher",
    "/usr/lib/at-spi-bus-launcher",
    "/usr/lib/at-spi2-core/at-spi-bus-launcher",
];
/// The accessibility object whose children are the running programs.
const ROOT: &str = "/org/a11y/atspi/accessible/root";
const ACCESSIBLE: &str = "org.a11y.atspi.Accessible";
const VALUE: &str = "org.a11y.atspi.Value";

/// A screen reader on a session bus. Dropping it ends the accessibility bus.
pub struct ScreenReader<'b> {
    bus: &'b SessionBus,
    address: String,
    _launcher: Process,
}

/// A control of a program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Control {
    program: String,
    object: String,
    /// The accessible name.
    pub name: String,
    /// The role: a number from AT-SPI's list of roles.
    pub role: u32,
}

/// Button, in AT-SPI's list of roles.
pub const BUTTON: u32 = 43;
/// Toggle button, in AT-SPI's list of roles.
pub const TOGGLE: u32 = 62;
/// Label, in AT-SPI's list of roles.
pub const LABEL: u32 = 29;
/// Slider, in AT-SPI's list of roles.
pub const SLIDER: u32 = 51;

impl<'b> ScreenReader<'b> {
    /// Starts the accessibility bus of the session.
    pub fn start(bus: &'b SessionBus) -> Self {
        let launcher = LAUNCHERS.into_iter().find(|path| Path::new(path).exists()).unwrap_or(LAUNCHERS[0]);
        let mut command = Command::new(launcher);
        command
            .arg("--launch-immediately")
            .envs(session_environment(bus.folder()))
            .env("DBUS_SESSION_BUS_ADDRESS", bus.address())
            .env("XDG_DATA_DIRS", "/usr/local/share:/usr/share")
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        let launcher = Process::start_group(&mut command, "at-spi2-core");
        let mut address = String::new();
        wait_until("the accessibility bus", || {
            let asked = bus.send("org.a11y.Bus", "/org/a11y/bus", &["org.a11y.Bus.GetAddress"]);
            asked.is_ok_and(|reply| {
                reply.trim().clone_into(&mut address);
                true
            })
        });
        Self { bus, address, _launcher: launcher }
    }

    /// Tells all programs that a screen reader is running (if `on` is true) or has stopped.
    pub fn listen(&self, on: bool) {
        let set = ["org.freedesktop.DBus.Properties.Set", "string:org.a11y.Status", "string:IsEnabled"];
        let value = format!("variant:boolean:{on}");
        let reported = self.bus.send("org.a11y.Bus", "/org/a11y/bus", &[&set[..], &[&value]].concat());
        reported.unwrap_or_else(|error| panic!("{error}"));
    }

    /// Returns all controls of all programs.
    pub fn controls(&self) -> Vec<Control> {
        let (mut found, mut next) =
            (Vec::new(), vec![("org.a11y.atspi.Registry".to_owned(), ROOT.to_owned())]);
        while let Some((program, object)) = next.pop() {
            // Treat a control that is gone as a control without children.
            let method = format!("{ACCESSIBLE}.GetChildren");
            let reply = self.send(&program, &object, &[&method]).unwrap_or_default();
            let mut words = reply.split_whitespace().peekable();
            while let Some(word) = words.next() {
                if word.starts_with(':')
                    && let Some(object) = words.next_if(|object| object.starts_with('/'))
                {
                    next.push((word.to_owned(), object.to_owned()));
                    found.extend(self.control(word, object));
                }
            }
        }
        found
    }

    /// True if a toggle button is on.
    pub fn is_on(&self, control: &Control) -> bool {
        /// Number of the bit for "pressed" in the first word of AT-SPI's states.
        const PRESSED: u32 = 20;
        let reply = self.send(&control.program, &control.object, &[&format!("{ACCESSIBLE}.GetState")]);
        let reply = reply.unwrap_or_else(|error| panic!("{control:?}: {error}"));
        let words = reply.split(|c: char| !c.is_ascii_digit()).filter_map(|word| word.parse().ok());
        // The reply begins with 32, the width of the words.
        let states: Vec<u32> = words.collect();
        states.iter().any(|word| word & (1 << PRESSED) != 0 && *word != 32)
    }

    /// Presses a button.
    pub fn press(&self, control: &Control) {
        let pressed =
            self.send(&control.program, &control.object, &["org.a11y.atspi.Action.DoAction", "int32:0"]);
        pressed.unwrap_or_else(|error| panic!("{control:?}: {error}"));
    }

    /// Returns the value of a slider as text.
    pub fn value(&self, control: &Control) -> String {
        let reply = self.property(&control.program, &control.object, VALUE, "CurrentValue");
        reply.unwrap_or_else(|error| panic!("{control:?}: {error}"))
    }

    /// Moves a slider.
    pub fn set_value(&self, control: &Control, value: f64) {
        let set = ["org.freedesktop.DBus.Properties.Set", &format!("string:{VALUE}"), "string:CurrentValue"];
        let value = format!("variant:double:{value}");
        let moved = self.send(&control.program, &control.object, &[&set[..], &[&value]].concat());
        moved.unwrap_or_else(|error| panic!("{control:?}: {error}"));
    }

    fn control(&self, program: &str, object: &str) -> Option<Control> {
        let name = self.property(program, object, ACCESSIBLE, "Name").ok()?;
        let role = self.send(program, object, &[&format!("{ACCESSIBLE}.GetRole")]).ok()?;
        let role = role.trim().strip_prefix("uint32")?.trim().parse().ok()?;
        Some(Control { program: program.to_owned(), object: object.to_owned(), name, role })
    }

    fn property(&self, program: &str, object: &str, interface: &str, name: &str) -> Result<String, String> {
        let (interface, name) = (format!("string:{interface}"), format!("string:{name}"));
        let reply =
            self.send(program, object, &["org.freedesktop.DBus.Properties.Get", &interface, &name])?;
        let value = reply.trim();
        let value = value.strip_prefix("variant").map_or(value, str::trim);
        Ok(value.strip_prefix("double").map_or(value, str::trim).to_owned())
    }

    fn send(&self, to: &str, object: &str, arguments: &[&str]) -> Result<String, String> {
        send(self.bus.folder(), &self.address, to, object, arguments)
    }
}
