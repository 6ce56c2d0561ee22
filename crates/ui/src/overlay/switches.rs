//! The panels that the user has opened.

use mariana_commands::Panel;

/// Switches of the panels; all are off at first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PanelSwitches {
    help: bool,
    sliders: bool,
    corner: bool,
    open: Option<Panel>,
}

impl PanelSwitches {
    /// Shows or hides the table of keys.
    pub fn toggle_help(&mut self) {
        self.help = !self.help;
    }

    /// Shows or hides the parameters' sliders.
    pub fn toggle_sliders(&mut self) {
        self.sliders = !self.sliders;
    }

    /// Shows or hides the line about the scene.
    pub fn toggle_corner(&mut self) {
        self.corner = !self.corner;
    }

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

    /// The open panel.
    pub fn open(self) -> Option<Panel> {
        self.open
    }

    /// True if the table of keys is shown.
    pub fn help(self) -> bool {
        self.help
    }

    /// True if the sliders are shown.
    pub fn sliders(self) -> bool {
        self.sliders
    }

    /// True if the line about the scene is shown.
    pub fn corner(self) -> bool {
        self.corner
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_switch_moves_its_own_panel_and_back() {
        let state = |panels: PanelSwitches| [panels.help(), panels.sliders(), panels.corner()];
        let mut panels = PanelSwitches::default();
        assert_eq!(state(panels), [false; 3]);
        panels.toggle_help();
        assert_eq!(state(panels), [true, false, false]);
        panels.toggle_sliders();
        panels.toggle_help();
        assert_eq!(state(panels), [false, true, false]);
        panels.toggle_corner();
        panels.toggle_sliders();
        assert_eq!(state(panels), [false, false, true]);
    }

    #[test]
    fn esc_left_the_sliders_open_and_now_closes_the_topmost_panel_first() {
        let mut panels = PanelSwitches::default();
        panels.toggle(Panel::Tracks);
        panels.toggle(Panel::Sources);
        assert_eq!(panels.open(), Some(Panel::Sources));
        panels.toggle(Panel::Sources);
        assert_eq!(panels.open(), None);
        panels.toggle(Panel::Tracks);
        panels.toggle_help();
        panels.toggle_sliders();
        let mut state = || {
            let closed = panels.close(true);
            (closed, panels.help(), panels.open(), panels.sliders())
        };
        assert_eq!(state(), (true, false, Some(Panel::Tracks), true));
        assert_eq!(state(), (true, false, None, true));
        assert_eq!(state(), (true, false, None, false));
        assert_eq!(state(), (false, false, None, false));
        panels.toggle_sliders();
        assert!(!panels.close(false), "sliders of a scene without parameters are not seen");
    }
}
