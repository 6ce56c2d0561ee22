//! The panels that the user has opened.

use mariana_commands::Panel;

/// Switches of the panels; all are off at first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct PanelSwitches {
    /// True if the table of keys is shown.
    pub help: bool,
    /// True if the sliders are shown.
    pub sliders: bool,
    /// True if the line about the scene is shown.
    pub corner: bool,
    /// The open panel.
    pub open: Option<Panel>,
}

impl PanelSwitches {
    /// Opens a panel and closes any other panel. If the panel is open already, closes it.
    pub fn toggle(&mut self, panel: Panel) {
        self.open = if self.open == Some(panel) { None } else { Some(panel) };
    }

    /// Closes the topmost of the table of keys, the open panel and the sliders, which `has_sliders` says are visible.
    /// Returns false if all are closed.
    pub fn close(&mut self, has_sliders: bool) -> bool {
        std::mem::take(&mut self.help)
            || self.open.take().is_some()
            || std::mem::take(&mut self.sliders) && has_sliders
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn esc_left_the_sliders_open_and_now_closes_the_topmost_panel_first() {
        let mut panels = PanelSwitches::default();
        panels.toggle(Panel::Tracks);
        panels.toggle(Panel::Sources);
        assert_eq!(panels.open, Some(Panel::Sources));
        panels.toggle(Panel::Sources);
        assert_eq!(panels.open, None);
        panels.toggle(Panel::Tracks);
        panels.help = true;
        panels.sliders = true;
        let mut state = || {
            let closed = panels.close(true);
            (closed, panels.help, panels.open, panels.sliders)
        };
        assert_eq!(state(), (true, false, Some(Panel::Tracks), true));
        assert_eq!(state(), (true, false, None, true));
        assert_eq!(state(), (true, false, None, false));
        assert_eq!(state(), (false, false, None, false));
        panels.sliders = true;
        assert!(!panels.close(false), "sliders of a scene without parameters are not seen");
    }
}
