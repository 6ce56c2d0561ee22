//! The picture as the desktop's ground: below every window, on every monitor, for nobody's hands. And in the window that a
//! screen saver gives.
//!
//! **It rests where nobody sees it,** and where it would empty a battery: a thread of its own asks the X server which
//! windows cover monitors, and the system where its power comes from.

mod power;
#[cfg(all(unix, not(target_os = "macos")))]
mod windows;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::monitors::{Monitor, MonitorWatch};
use super::window_thread::Waker;
use crate::placement::{Area, Map};

/// Frame cap where none is given, in frames per second.
pub(super) const FPS: f64 = 30.0;

/// Left and top edge, width and height in pixels of the desktop.
pub(super) type Rect = ((i32, i32), (u32, u32));

/// The least rectangle with all monitors in it; none without one.
pub(super) fn around(monitors: &[Monitor]) -> Option<Rect> {
    let left = monitors.iter().map(|monitor| monitor.place.0).min()?;
    let top = monitors.iter().map(|monitor| monitor.place.1).min()?;
    let end = |from: i32, length: u32| i64::from(from) + i64::from(length);
    let right = monitors.iter().map(|monitor| end(monitor.place.0, monitor.size.0)).max()?;
    let bottom = monitors.iter().map(|monitor| end(monitor.place.1, monitor.size.1)).max()?;
    let length = |from: i32, to: i64| u32::try_from(to - i64::from(from)).unwrap_or(1).max(1);
    Some(((left, top), (length(left, right), length(top, bottom))))
}

/// See the module.
pub(super) struct Wallpaper {
    monitors: MonitorWatch,
    rests: Arc<AtomicBool>,
}

/// A part of the wallpaper's window, and the part of the picture that fills it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Panel {
    /// Where it is in the window, as shares of it.
    pub(super) area: Area,
    /// From places in the area to places in the picture.
    pub(super) map: Map,
    /// The part of the picture that shows.
    pub(super) part: Area,
}

impl Wallpaper {
    /// Looks at monitors, windows and power from now on.
    pub(super) fn start(waker: &Waker) -> Self {
        let mut monitors = MonitorWatch::default();
        let (of_monitors, of_windows) = (waker.clone(), waker.clone());
        monitors.begin(move || of_monitors.wake());
        let rests = Arc::new(AtomicBool::new(false));
        let told = Arc::downgrade(&rests);
        let watch = move || {
            let mut looks = Looks::new();
            while let Some(rests) = told.upgrade() {
                let rest = looks.at_rest();
                if rests.swap(rest, Ordering::Relaxed) != rest {
                    tracing::info!("the wallpaper {}", if rest { "rests" } else { "goes on" });
                    of_windows.wake();
                }
                drop(rests);
                std::thread::sleep(LOOK_PERIOD);
            }
        };
        if let Err(error) = std::thread::Builder::new().name("wallpaper".into()).spawn(watch) {
            tracing::warn!("the wallpaper never rests: {error}");
        }
        Self { monitors, rests }
    }

    /// Whether nobody sees it, or it should spare a battery.
    pub(super) fn rests(&self) -> bool {
        self.rests.load(Ordering::Relaxed)
    }

    /// Where its window belongs, once that is known.
    pub(super) fn place(&self) -> Option<Rect> {
        around(&self.monitors.known()?)
    }

    /// The size that the picture is drawn for: that of the largest monitor.
    pub(super) fn screen(&self) -> Option<(u32, u32)> {
        let pixels = |size: (u32, u32)| u64::from(size.0) * u64::from(size.1);
        self.monitors.known()?.iter().map(|monitor| monitor.size).max_by_key(|size| pixels(*size))
    }

    /// What shows of a picture of `shape` pixels on each monitor.
    pub(super) fn panels(&self, shape: (u32, u32)) -> Vec<Panel> {
        panels(&self.monitors.known().unwrap_or_default(), shape)
    }
}

/// How often windows and power are looked at.
const LOOK_PERIOD: std::time::Duration = std::time::Duration::from_millis(500);

/// What decides whether it rests.
struct Looks {
    #[cfg(all(unix, not(target_os = "macos")))]
    windows: Option<windows::Windows>,
}

impl Looks {
    fn new() -> Self {
        Self {
            #[cfg(all(unix, not(target_os = "macos")))]
            windows: windows::Windows::connect(),
        }
    }

    fn at_rest(&mut self) -> bool {
        #[cfg(all(unix, not(target_os = "macos")))]
        let covered = self.windows.as_ref().is_some_and(windows::Windows::cover_everything);
        #[cfg(not(all(unix, not(target_os = "macos"))))]
        let covered = false;
        covered || power::is_from_battery(std::path::Path::new(power::FOLDER))
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
        // The picture fills the monitor, and loses what sticks out.
        let scale = (across / f64::from(shape.0.max(1))).max(down / f64::from(shape.1.max(1)));
        let share = |side: f64, of: u32| (side / (f64::from(of.max(1)) * scale)).min(1.0);
        let (w, h) = (share(across, shape.0), share(down, shape.1));
        let (x, y) = (0.5 - 0.5 * w, 0.5 - 0.5 * h);
        Panel { area, map: [[w, 0.0, x], [0.0, h, y], [0.0, 0.0, 1.0]], part: [x, y, x + w, y + h] }
    };
    monitors.iter().map(panel).collect()
}

/// Whether each of these monitors is covered by one of these windows.
fn are_covered(monitors: &[Rect], windows: &[Rect]) -> bool {
    let end = |from: i32, length: u32| i64::from(from) + i64::from(length);
    let covers = |(window, size): &Rect, (monitor, extent): &Rect| {
        window.0 <= monitor.0
            && window.1 <= monitor.1
            && end(window.0, size.0) >= end(monitor.0, extent.0)
            && end(window.1, size.1) >= end(monitor.1, extent.1)
    };
    !monitors.is_empty()
        && monitors.iter().all(|monitor| windows.iter().any(|window| covers(window, monitor)))
}

/// A window of another program: its number, and its size in pixels.
type OtherWindow = (u32, (u32, u32));

/// The window that a screen saver's program is to draw into, if there is one.
///
/// # Errors
/// The variable names no window.
pub(super) fn of_screen_saver() -> Result<Option<OtherWindow>, String> {
    const NAME: &str = "XSCREENSAVER_WINDOW";
    let Ok(text) = std::env::var(NAME) else { return Ok(None) };
    let refused = || format!("the variable {NAME} is '{text}', which is no window: unset it");
    let number = window_number(&text).ok_or_else(refused)?;
    #[cfg(all(unix, not(target_os = "macos")))]
    return windows::size_of(number).map(|size| Some((number, size))).ok_or_else(refused);
    #[cfg(not(all(unix, not(target_os = "macos"))))]
    return Err(format!("the window {number} is one of X11, which this system has not: unset {NAME}"));
}

/// A number as X11's tools write it: `0x1a2b` or `6699`.
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
    fn each_monitor_shows_the_middle_of_the_picture_and_is_filled() {
        let both = [monitor((0, 100), (800, 400)), monitor((800, 0), (200, 400))];
        assert_eq!(around(&both), Some(((0, 0), (1000, 500))));
        let [wide, tall] = panels(&both, (800, 400))[..] else { panic!("a panel for each monitor") };
        assert_eq!((wide.area, wide.part), ([0.0, 0.2, 0.8, 1.0], [0.0, 0.0, 1.0, 1.0]));
        assert_eq!((tall.area, tall.part), ([0.8, 0.0, 1.0, 0.8], [0.375, 0.0, 0.625, 1.0]));
        assert_eq!(crate::placement::led(&tall.map, [1.0, 0.5]), Some([0.625, 0.5]));
        assert!(panels(&[], (8, 4)).is_empty() && around(&[]).is_none());
    }

    #[test]
    fn it_is_covered_when_every_monitor_is() {
        let monitors = [((0, 0), (800, 600)), ((800, 0), (640, 480))];
        let full = ((0, 0), (800, 600));
        assert!(!are_covered(&monitors, &[full]));
        assert!(are_covered(&monitors, &[full, ((790, -20), (700, 520))]));
        assert!(!are_covered(&monitors, &[full, ((800, 0), (640, 479))]));
        assert!(are_covered(&monitors, &[((0, 0), (1440, 600))]));
        assert!(!are_covered(&[], &[full]));
    }

    #[test]
    fn a_screen_saver_s_window_is_a_number() {
        assert_eq!(["0x1A2b", "6699", " 12 "].map(window_number), [Some(0x1a2b), Some(6699), Some(12)]);
        assert_eq!(["", "0", "0x", "window", "-3", "0x1ffffffff"].map(window_number), [None; 6]);
    }
}
