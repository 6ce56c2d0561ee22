//! The monitors of the desktop: their names and places, and when one is pulled out or plugged in.
//!
//! X11 is asked on a thread of its own, again and again: window managers and drivers tell of some changes and not of
//! others. What it calls monitors (RandR 1.5) may also be halves of a screen that the user has divided.

use std::sync::{Arc, Mutex, PoisonError};

pub use crate::monitor::Monitor;
pub(crate) use crate::monitor::{named, names};

/// Left and top edge, width and height in pixels of the desktop.
pub(crate) type Rect = ((i32, i32), (u32, u32));

/// The least rectangle with all monitors in it; none without one.
pub(crate) fn around(monitors: &[Monitor]) -> Option<Rect> {
    let left = monitors.iter().map(|monitor| monitor.place.0).min()?;
    let top = monitors.iter().map(|monitor| monitor.place.1).min()?;
    let end = |from: i32, length: u32| i64::from(from) + i64::from(length);
    let right = monitors.iter().map(|monitor| end(monitor.place.0, monitor.size.0)).max()?;
    let bottom = monitors.iter().map(|monitor| end(monitor.place.1, monitor.size.1)).max()?;
    let length = |from: i32, to: i64| u32::try_from(to - i64::from(from)).unwrap_or(1).max(1);
    Some(((left, top), (length(left, right), length(top, bottom))))
}

/// What is known of the monitors.
#[derive(Default)]
pub(crate) struct MonitorWatch {
    known: Arc<Mutex<Option<Vec<Monitor>>>>,
    begun: bool,
}

impl MonitorWatch {
    /// Looks at them from now on; `wake` is called on another thread when they have changed.
    pub(crate) fn begin(&mut self, wake: impl Fn() + Send + 'static) {
        if !std::mem::replace(&mut self.begun, true) {
            let known = Arc::downgrade(&self.known);
            #[cfg(all(unix, not(target_os = "macos")))]
            let watch = move || x11::watch(&known, &wake);
            #[cfg(not(all(unix, not(target_os = "macos"))))]
            let watch = move || drop((known, wake));
            if let Err(error) = std::thread::Builder::new().name("monitors".into()).spawn(watch) {
                tracing::warn!("monitors are not looked at: {error}");
            }
        }
    }

    /// These are there, and nobody needs to look.
    pub(crate) fn note(&mut self, monitors: Vec<Monitor>) {
        self.begun = true;
        // A thread that has begun ends with what it would tell.
        self.known = Arc::new(Mutex::new(Some(monitors)));
    }

    /// All that are there, from the left to the right; none before they are known.
    pub(crate) fn known(&self) -> Option<Vec<Monitor>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// All that are there now, from the left to the right. Waits for the X server.
///
/// # Errors
/// There is none, or it knows no monitors.
#[cfg(all(unix, not(target_os = "macos")))]
pub fn present() -> Result<Vec<Monitor>, String> {
    x11::present()
}

/// Not available on this system yet.
///
/// # Errors
/// Always.
#[cfg(not(all(unix, not(target_os = "macos"))))]
pub fn present() -> Result<Vec<Monitor>, String> {
    Err("this system's monitors cannot be told apart yet".to_owned())
}

#[cfg(all(unix, not(target_os = "macos")))]
mod x11 {
    use std::error::Error;
    use std::sync::{Mutex, PoisonError, Weak};
    use std::time::Duration;

    use x11rb::connection::Connection;
    use x11rb::protocol::randr::ConnectionExt as _;
    use x11rb::protocol::xproto::{ConnectionExt as _, Window};
    use x11rb::rust_connection::RustConnection;

    use super::Monitor;

    /// How often it is asked.
    const PERIOD: Duration = Duration::from_millis(500);

    fn connect() -> Result<(RustConnection, Window), Box<dyn Error>> {
        let (connection, screen) = x11rb::connect(None)?;
        let root = connection.setup().roots.get(screen).ok_or("the X server has no screen")?.root;
        connection.randr_query_version(1, 5)?.reply()?;
        Ok((connection, root))
    }

    fn monitors(connection: &RustConnection, root: Window) -> Result<Vec<Monitor>, Box<dyn Error>> {
        let mut found = Vec::new();
        for monitor in connection.randr_get_monitors(root, true)?.reply()?.monitors {
            let name = connection.get_atom_name(monitor.name)?.reply()?.name;
            found.push(Monitor {
                name: String::from_utf8_lossy(&name).into_owned(),
                place: (monitor.x.into(), monitor.y.into()),
                size: (monitor.width.into(), monitor.height.into()),
            });
        }
        found.sort_by_key(|monitor| monitor.place);
        Ok(found)
    }

    pub(crate) fn present() -> Result<Vec<Monitor>, String> {
        let found = connect().and_then(|(connection, root)| monitors(&connection, root));
        found.map_err(|error| format!("monitors are known on X11 only, and the X server says: {error}"))
    }

    /// Looks until nobody wants to know.
    pub(crate) fn watch(known: &Weak<Mutex<Option<Vec<Monitor>>>>, wake: &dyn Fn()) {
        let (connection, root) = match connect() {
            Ok(connected) => connected,
            Err(error) => return tracing::info!("monitors are not looked at: {error}"),
        };
        while let Some(known) = known.upgrade() {
            let found = match monitors(&connection, root) {
                Ok(found) => found,
                Err(error) => return tracing::info!("monitors are no longer looked at: {error}"),
            };
            let before = known.lock().unwrap_or_else(PoisonError::into_inner).replace(found.clone());
            if before.as_ref() != Some(&found) {
                tracing::info!("monitors: {}", super::names(&found));
                wake();
            }
            drop(known);
            std::thread::sleep(PERIOD);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn monitors_are_found_by_name_or_else_by_number() {
        let monitor = |name: &str, x| Monitor { name: name.into(), place: (x, 0), size: (640, 360) };
        let both = [monitor("eDP-1", 0), monitor("2", 640), monitor("HDMI-1", 1280)];
        let found = |text: &str| named(&both, text).map(|monitor| &*monitor.name);
        assert_eq!(
            [found("hdmi-1"), found("1"), found("3")],
            [Some("HDMI-1"), Some("eDP-1"), Some("HDMI-1")]
        );
        assert_eq!(found("2"), Some("2"), "a name goes before a number");
        assert_eq!([found("0"), found("4"), found("-1"), found("")], [None; 4]);
        assert_eq!(names(&both[..1]), "eDP-1 (640x360)");
        assert_eq!(names(&[]), "none");
    }
}
