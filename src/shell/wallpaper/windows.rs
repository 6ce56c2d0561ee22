//! Finds windows that cover monitors, from the properties that window managers set (EWMH).

use std::error::Error;

use x11rb::protocol::xproto::{Atom, AtomEnum, ConnectionExt as _, Window};
use x11rb::rust_connection::RustConnection;

use super::rest::are_covered;
use crate::shell::monitors::{Rect, overlap, x11};

x11rb::atom_manager! {
    Names: NamesCookie {
        _NET_CLIENT_LIST,
        _NET_CURRENT_DESKTOP,
        _NET_WM_DESKTOP,
        _NET_WM_STATE,
        _NET_WM_STATE_HIDDEN,
        _NET_WM_STATE_FULLSCREEN,
        _NET_WM_STATE_MAXIMIZED_HORZ,
        _NET_WM_STATE_MAXIMIZED_VERT,
        _NET_WM_WINDOW_TYPE,
        _NET_WM_WINDOW_TYPE_DESKTOP,
    }
}

/// The number for windows on all desktops.
const EVERYWHERE: u32 = u32::MAX;
const WINDOWS_MAX: u32 = 4_096;
/// A maximised window may leave this fraction of a monitor for bars.
const BARS: f64 = 0.2;

pub(super) struct Windows {
    connection: RustConnection,
    root: Window,
    names: Names,
}

impl Windows {
    pub(super) fn connect() -> Option<Self> {
        let connect = || -> Result<Self, Box<dyn Error>> {
            let (connection, root) = x11::connect()?;
            let names = Names::new(&connection)?.reply()?;
            Ok(Self { connection, root, names })
        };
        connect().inspect_err(|error| tracing::info!("windows are not watched: {error}")).ok()
    }

    pub(super) fn cover_everything(&self) -> Result<bool, Box<dyn Error>> {
        let monitors = x11::monitors(&self.connection, self.root)?;
        let monitors: Vec<Rect> = monitors.iter().map(|monitor| (monitor.place, monitor.size)).collect();
        let present = self.numbers(self.root, self.names._NET_CURRENT_DESKTOP, AtomEnum::CARDINAL)?;
        let mut covering = Vec::new();
        for window in self.numbers(self.root, self.names._NET_CLIENT_LIST, AtomEnum::WINDOW)? {
            // A window may be closed between two requests.
            if let Ok(Some(rect)) = self.covering(window, present.first().copied(), &monitors) {
                covering.push(rect);
            }
        }
        Ok(are_covered(&monitors, &covering))
    }

    /// Returns the rectangle that a window covers; `None` if it is hidden, on another desktop, or the desktop itself.
    fn covering(
        &self,
        window: Window,
        present: Option<u32>,
        monitors: &[Rect],
    ) -> Result<Option<Rect>, Box<dyn Error>> {
        let names = &self.names;
        let state = self.numbers(window, names._NET_WM_STATE, AtomEnum::ATOM)?;
        let kind = self.numbers(window, names._NET_WM_WINDOW_TYPE, AtomEnum::ATOM)?;
        let desktop = self.numbers(window, names._NET_WM_DESKTOP, AtomEnum::CARDINAL)?.first().copied();
        let is = |name: Atom| state.contains(&name);
        let elsewhere = desktop.is_some_and(|at| at != EVERYWHERE && Some(at) != present);
        if kind.contains(&names._NET_WM_WINDOW_TYPE_DESKTOP) || is(names._NET_WM_STATE_HIDDEN) || elsewhere {
            return Ok(None);
        }
        let size = self.connection.get_geometry(window)?.reply()?;
        let place = self.connection.translate_coordinates(window, self.root, 0, 0)?.reply()?;
        let rect: Rect = ((place.dst_x.into(), place.dst_y.into()), (size.width.into(), size.height.into()));
        let maximised = is(names._NET_WM_STATE_MAXIMIZED_HORZ) && is(names._NET_WM_STATE_MAXIMIZED_VERT);
        // A maximised window leaves room only for bars, so its whole monitor counts as covered.
        let own = monitors.iter().find(|monitor| maximised && fills(&rect, monitor));
        Ok(Some(own.copied().unwrap_or(rect)))
    }

    /// Returns the values of a property; empty if the window does not have this property.
    fn numbers(&self, window: Window, name: Atom, kind: AtomEnum) -> Result<Vec<u32>, Box<dyn Error>> {
        let reply = self.connection.get_property(false, window, name, kind, 0, WINDOWS_MAX)?.reply()?;
        Ok(reply.value32().map(Iterator::collect).unwrap_or_default())
    }
}

fn fills(window: &Rect, monitor: &Rect) -> bool {
    let [across, down] = overlap(window, monitor);
    let least = |side: u32| (1.0 - BARS) * f64::from(side);
    across as f64 >= least(monitor.1.0) && down as f64 >= least(monitor.1.1)
}

/// Returns the size of a window in pixels; `None` if the window does not exist.
pub(super) fn size_of(window: Window) -> Option<(u32, u32)> {
    let (connection, _) = x11rb::connect(None).ok()?;
    let found = connection.get_geometry(window).ok()?.reply().ok()?;
    Some((found.width.into(), found.height.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_maximised_window_next_to_a_bar_covers_the_monitor() {
        let monitor = ((100, 0), (1000, 800));
        assert!(fills(&((100, 30), (1000, 770)), &monitor));
        assert!(fills(&((100, 0), (900, 800)), &monitor));
        assert!(!fills(&((100, 30), (500, 770)), &monitor));
        assert!(!fills(&((1100, 0), (1000, 800)), &monitor));
    }
}
