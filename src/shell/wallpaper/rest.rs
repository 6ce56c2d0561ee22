//! Pauses the wallpaper: a thread asks the X server which windows cover the monitors, and reads the power source. On
//! Wayland, the compositor requests no frames for a covered surface.

use std::path::Path;
use std::time::{Duration, Instant};

use mariana_work::{Latest, Shared, looping};

use super::layers::OutputSurfaces;
use super::power;
#[cfg(all(unix, not(target_os = "macos")))]
use super::windows::Windows;
use crate::session::Waker;
#[cfg(any(test, all(unix, not(target_os = "macos"))))]
use crate::shell::monitors::{Rect, overlap};

const LOOK_PERIOD: Duration = Duration::from_millis(500);

/// Starts the checks. The wallpaper is on `output_surfaces`, or else in an X11 window. The result is true while the
/// wallpaper must pause, and always false if the thread cannot be started. Dropping it ends the thread.
pub(super) fn watch(output_surfaces: Option<OutputSurfaces>, waker: &Waker) -> Latest<bool> {
    let waker = waker.clone();
    let watch = move |shared: &Shared<bool>| {
        // Do not ask the X server of a Wayland session: it knows only some of the windows.
        #[cfg(all(unix, not(target_os = "macos")))]
        let windows = if output_surfaces.is_none() { Windows::connect() } else { None };
        let mut rested = false;
        while !shared.is_over() {
            #[cfg(all(unix, not(target_os = "macos")))]
            let is_covered =
                windows.as_ref().is_some_and(|windows| windows.cover_everything().unwrap_or(false));
            #[cfg(not(all(unix, not(target_os = "macos"))))]
            let is_covered = false;
            let is_unseen =
                output_surfaces.as_ref().is_some_and(|surfaces| surfaces.are_unseen(Instant::now()));
            // Leave out `is_unseen`: without requests from the compositor, the show stops drawing by itself.
            let ordered = is_covered || power::is_from_battery(Path::new(power::FOLDER));
            let rests = ordered || is_unseen;
            if std::mem::replace(&mut rested, rests) != rests {
                tracing::info!("the wallpaper {}", if rests { "pauses" } else { "continues" });
            }
            if std::mem::replace(&mut *shared.lock(), ordered) != ordered {
                waker.wake();
            }
            shared.rest(LOOK_PERIOD);
        }
    };
    let watching = looping("wallpaper", false, watch);
    let watching = watching.inspect_err(|error| {
        tracing::warn!(
            "cannot start the thread that watches for covering windows, so the wallpaper does not pause: {error}"
        );
    });
    watching.unwrap_or_default()
}

#[cfg(any(test, all(unix, not(target_os = "macos"))))]
/// True if every monitor is covered by a window.
pub(super) fn are_covered(monitors: &[Rect], windows: &[Rect]) -> bool {
    let is_covered = |monitor: &Rect| {
        let whole = [monitor.1.0, monitor.1.1].map(i64::from);
        windows.iter().any(|window| overlap(window, monitor) == whole)
    };
    !monitors.is_empty() && monitors.iter().all(is_covered)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wallpaper_is_covered_if_every_monitor_is() {
        let monitors = [((0, 0), (800, 600)), ((800, 0), (640, 480))];
        let full = ((0, 0), (800, 600));
        assert!(!are_covered(&monitors, &[full]));
        assert!(are_covered(&monitors, &[full, ((790, -20), (700, 520))]));
        assert!(!are_covered(&monitors, &[full, ((800, 0), (640, 479))]));
        assert!(are_covered(&monitors, &[((0, 0), (1440, 600))]));
        assert!(!are_covered(&[], &[full]));
    }
}
