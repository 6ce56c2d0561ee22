//! The monitors of the desktop.

use std::fmt;

/// A monitor.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Monitor {
    /// The desktop's name for the monitor, such as "HDMI-1".
    pub name: String,
    /// Position of the monitor's upper left corner on the desktop, in pixels to the right and down.
    pub place: (i32, i32),
    /// Width and height in pixels.
    pub size: (u32, u32),
}

impl fmt::Display for Monitor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (width, height) = self.size;
        write!(f, "{} ({width}x{height})", self.name)
    }
}

/// Returns the monitor with the name `text`. If no monitor has this name, `text` is a monitor's number, from 1.
pub fn named<'a>(monitors: &'a [Monitor], text: &str) -> Option<&'a Monitor> {
    let by_name = monitors.iter().find(|monitor| monitor.name.eq_ignore_ascii_case(text));
    by_name.or_else(|| monitors.get(text.parse::<usize>().ok()?.checked_sub(1)?))
}

/// Lists all monitors for use in a sentence.
pub fn names(monitors: &[Monitor]) -> String {
    let names: Vec<String> = monitors.iter().map(Monitor::to_string).collect();
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}
