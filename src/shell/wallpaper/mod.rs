//! The desktop's wallpaper: the frame below all windows, on all monitors, without input. A screen saver uses the same
//! code to draw in its window.
//!
//! On X11 the wallpaper is a window, on Wayland a surface on each output ([`layers`]). The wallpaper pauses while
//! windows cover it or the computer runs on battery ([`rest`]).

#[cfg(all(unix, not(target_os = "macos")))]
mod layers;
#[cfg(not(all(unix, not(target_os = "macos"))))]
#[path = "no_layers.rs"]
mod layers;
mod power;
mod rest;
mod wall;
#[cfg(all(unix, not(target_os = "macos")))]
mod windows;

pub(crate) use layers::{Layers, OutputSurfaces, is_wayland};
pub(crate) use wall::Wall;

use mariana_work::Latest;

use crate::placement::Area;
use crate::session::Waker;
use crate::session::lay::Panel;
use crate::shell::monitors::{Monitor, MonitorWatch, Rect, around};

/// Default frame cap, in frames per second.
pub(crate) const FPS: f64 = 30.0;

pub(crate) struct Wallpaper {
    /// Unknown on Wayland.
    monitors: MonitorWatch,
    is_paused: Latest<bool>,
}

impl Wallpaper {
    /// Starts to watch monitors, windows and power. On Wayland the compositor reports monitors and visibility.
    pub(crate) fn start(output_surfaces: Option<OutputSurfaces>, waker: &Waker) -> Self {
        let is_paused = rest::watch(output_surfaces.clone(), waker);
        let mut monitors = MonitorWatch::default();
        if output_surfaces.is_none() {
            monitors.begin(waker.waking());
        }
        Self { monitors, is_paused }
    }

    /// True if the wallpaper is paused: covered, or on battery.
    pub(crate) fn is_paused(&self) -> bool {
        *self.is_paused.lock()
    }

    pub(crate) fn place(&self) -> Option<Rect> {
        around(&self.monitors.known()?)
    }

    /// Returns the size of the largest monitor.
    pub(crate) fn screen(&self) -> Option<(u32, u32)> {
        let pixels = |size: &(u32, u32)| u64::from(size.0) * u64::from(size.1);
        self.monitors.known()?.iter().map(|monitor| monitor.size).max_by_key(pixels)
    }

    /// Returns the part of a frame of `shape` pixels that each monitor shows.
    pub(crate) fn panels(&self, shape: (u32, u32)) -> Vec<Panel> {
        panels(&self.monitors.known().unwrap_or_default(), shape)
    }
}

fn panels(monitors: &[Monitor], shape: (u32, u32)) -> Vec<Panel> {
    let Some(((left, top), (width, height))) = around(monitors) else { return Vec::new() };
    let [width, height] = [width, height].map(f64::from);
    let panel = |monitor: &Monitor| {
        let x = f64::from(monitor.place.0 - left) / width;
        let y = f64::from(monitor.place.1 - top) / height;
        let [across, down] = [monitor.size.0, monitor.size.1].map(f64::from);
        let area = [x, y, x + across / width, y + down / height];
        filling(shape, monitor.size, area)
    };
    monitors.iter().map(panel).collect()
}

/// Fills `area` of a monitor's window of `size` pixels with a frame of `shape` pixels, cropped to its aspect ratio.
pub(crate) fn filling(shape: (u32, u32), size: (u32, u32), area: Area) -> Panel {
    let [across, down] = [size.0, size.1].map(f64::from);
    let scale = (across / f64::from(shape.0.max(1))).max(down / f64::from(shape.1.max(1)));
    let fraction = |side: f64, of: u32| (side / (f64::from(of.max(1)) * scale)).min(1.0);
    let (w, h) = (fraction(across, shape.0), fraction(down, shape.1));
    let (x, y) = (0.5 - 0.5 * w, 0.5 - 0.5 * h);
    Panel { area, map: [[w, 0.0, x], [0.0, h, y], [0.0, 0.0, 1.0]], part: [x, y, x + w, y + h] }
}

/// Another program's window: X11 id and size in pixels.
type OtherWindow = (u32, (u32, u32));

/// Returns the window into which a screen saver must draw, if the environment variable for this window is set.
pub(crate) fn of_screen_saver() -> Result<Option<OtherWindow>, String> {
    const NAME: &str = "XSCREENSAVER_WINDOW";
    let Ok(text) = std::env::var(NAME) else { return Ok(None) };
    let refused = || format!("the variable {NAME} is '{text}', but there is no such window: unset it");
    let number = window_number(&text).ok_or_else(refused)?;
    #[cfg(all(unix, not(target_os = "macos")))]
    return windows::size_of(number).map(|size| Some((number, size))).ok_or_else(refused);
    #[cfg(not(all(unix, not(target_os = "macos"))))]
    return Err(format!(
        "the variable {NAME} names the window {number} of X11, which this system does not have: unset it"
    ));
}

/// Parses a window id in the form of X11's tools: `0x1a2b` or `6699`.
fn window_number(text: &str) -> Option<u32> {
    let text = text.trim();
    match text.strip_prefix("0x").or(text.strip_prefix("0X")) {
        Some(digits) => u32::from_str_radix(digits, 16).ok(),
        None => text.parse().ok(),
    }
    .filter(|number| *number > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn monitor(place: (i32, i32), size: (u32, u32)) -> Monitor {
        Monitor { name: format!("{place:?}"), place, size }
    }

    #[test]
    fn each_monitor_is_filled_with_the_middle_of_the_frame() {
        let both = [monitor((0, 100), (800, 400)), monitor((800, 0), (200, 400))];
        assert_eq!(around(&both), Some(((0, 0), (1000, 500))));
        let [wide, tall] = panels(&both, (800, 400))[..] else {
            panic!("there is not one panel for each monitor")
        };
        assert_eq!((wide.area, wide.part), ([0.0, 0.2, 0.8, 1.0], [0.0, 0.0, 1.0, 1.0]));
        assert_eq!((tall.area, tall.part), ([0.8, 0.0, 1.0, 0.8], [0.375, 0.0, 0.625, 1.0]));
        assert_eq!(crate::placement::led(&tall.map, [1.0, 0.5]), Some([0.625, 0.5]));
        assert!(panels(&[], (8, 4)).is_empty() && around(&[]).is_none());
    }

    #[test]
    fn a_screen_saver_s_window_is_a_number() {
        assert_eq!(["0x1A2b", "6699", " 12 "].map(window_number), [Some(0x1a2b), Some(6699), Some(12)]);
        assert_eq!(["", "0", "0x", "window", "-3", "0x1ffffffff"].map(window_number), [None; 6]);
    }
}
