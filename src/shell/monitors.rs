//! The desktop's monitors: names, positions, sizes, and their changes. On X11 a thread polls them, because window
//! managers and drivers do not report all changes. X11's monitors (RandR 1.5) may be parts of a screen.

use mariana_work::{Latest, Shared, looping};

pub use crate::monitor::Monitor;
pub(crate) use crate::monitor::{named, names};

/// Position and size of a rectangle on the desktop, in pixels.
pub(crate) type Rect = ((i32, i32), (u32, u32));

/// Returns the bounding rectangle of all monitors; `None` without monitors.
pub(crate) fn around(monitors: &[Monitor]) -> Option<Rect> {
    let left = monitors.iter().map(|monitor| monitor.place.0).min()?;
    let top = monitors.iter().map(|monitor| monitor.place.1).min()?;
    let end = |from: i32, length: u32| i64::from(from) + i64::from(length);
    let right = monitors.iter().map(|monitor| end(monitor.place.0, monitor.size.0)).max()?;
    let bottom = monitors.iter().map(|monitor| end(monitor.place.1, monitor.size.1)).max()?;
    let length = |from: i32, to: i64| u32::try_from(to - i64::from(from)).unwrap_or(1).max(1);
    Some(((left, top), (length(left, right), length(top, bottom))))
}

/// Returns width and height of the common part of two rectangles; negative if they are apart.
pub(crate) fn overlap(a: &Rect, b: &Rect) -> [i64; 2] {
    let common = |from: i32, length: u32, of: i32, most: u32| {
        let (from, of) = (i64::from(from), i64::from(of));
        (from + i64::from(length)).min(of + i64::from(most)) - from.max(of)
    };
    [common(a.0.0, a.1.0, b.0.0, b.1.0), common(a.0.1, a.1.1, b.0.1, b.1.1)]
}

/// All monitors from left to right; `None` while they are unknown.
type Known = Option<Vec<Monitor>>;

/// The known monitors, and the thread that polls them; `None` at first.
#[derive(Default)]
pub(crate) struct MonitorWatch(Option<Latest<Known>>);

impl MonitorWatch {
    /// Starts to poll the monitors. Calls `wake` on another thread after each change.
    pub(crate) fn begin(&mut self, wake: impl Fn() + Send + 'static) {
        if self.0.is_none() {
            #[cfg(all(unix, not(target_os = "macos")))]
            let watch = move |known: &Shared<Known>| x11::watch(known, &wake);
            #[cfg(not(all(unix, not(target_os = "macos"))))]
            let watch = move |_: &Shared<Known>| drop(wake);
            let watching = looping("monitors", None, watch);
            let watching = watching.inspect_err(|error| tracing::warn!("cannot watch the monitors: {error}"));
            self.0 = watching.ok();
        }
    }

    /// Sets the monitors on a window system that reports them, which makes polling unnecessary.
    pub(crate) fn set(&mut self, monitors: Vec<Monitor>) {
        let known = Latest::<Known>::default();
        *known.lock() = Some(monitors);
        // Dropping the old value ends the thread that polls, if there is one.
        self.0 = Some(known);
    }

    /// Returns all monitors from left to right; `None` while they are unknown.
    pub(crate) fn known(&self) -> Option<Vec<Monitor>> {
        self.0.as_ref()?.lock().clone()
    }
}

/// Asks the X server for all monitors, from left to right. May block.
///
/// # Errors
/// Fails if there is no X server, or it does not report monitors.
pub fn present() -> Result<Vec<Monitor>, String> {
    #[cfg(all(unix, not(target_os = "macos")))]
    let found = x11::connect()
        .and_then(|(connection, root)| x11::monitors(&connection, root))
        .map_err(|error| format!("monitors can be listed on X11 only, and the X server reports: {error}"));
    #[cfg(not(all(unix, not(target_os = "macos"))))]
    let found = Err("monitors cannot be listed on this system".to_owned());
    found
}

#[cfg(all(unix, not(target_os = "macos")))]
pub(crate) mod x11 {
    use std::error::Error;
    use std::time::Duration;

    use mariana_work::Shared;
    use x11rb::connection::Connection;
    use x11rb::protocol::randr::ConnectionExt as _;
    use x11rb::protocol::xproto::{ConnectionExt as _, Window};
    use x11rb::rust_connection::RustConnection;

    use super::{Known, Monitor};

    const PERIOD: Duration = Duration::from_millis(500);

    pub(crate) fn connect() -> Result<(RustConnection, Window), Box<dyn Error>> {
        if std::env::var_os("DISPLAY").is_none_or(|display| display.is_empty()) {
            return Err("there is no display, because DISPLAY is not set".into());
        }
        let (connection, screen) = x11rb::connect(None)?;
        let root = connection.setup().roots.get(screen).ok_or("the X server has no screen")?.root;
        connection.randr_query_version(1, 5)?.reply()?;
        Ok((connection, root))
    }

    pub(crate) fn monitors(
        connection: &RustConnection,
        root: Window,
    ) -> Result<Vec<Monitor>, Box<dyn Error>> {
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

    /// Polls until the [`super::MonitorWatch`] is dropped.
    pub(super) fn watch(known: &Shared<Known>, wake: &dyn Fn()) {
        let (connection, root) = match connect() {
            Ok(connected) => connected,
            Err(error) => return tracing::info!("monitors are not watched: {error}"),
        };
        while !known.is_over() {
            let found = match monitors(&connection, root) {
                Ok(found) => found,
                Err(error) => return tracing::info!("monitors are no longer watched: {error}"),
            };
            let before = known.lock().replace(found.clone());
            if before.as_ref() != Some(&found) {
                tracing::info!("monitors: {}", super::names(&found));
                wake();
            }
            known.rest(PERIOD);
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
        assert_eq!(found("2"), Some("2"), "a name has priority over a number");
        assert_eq!([found("0"), found("4"), found("-1"), found("")], [None; 4]);
        assert_eq!(names(&both[..1]), "eDP-1 (640x360)");
        assert_eq!(names(&[]), "none");
    }
}
