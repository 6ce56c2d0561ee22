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

    /// Closes the open panel, or else the table of keys. Returns false if both are closed.
    pub fn close(&mut self) -> bool {
        let closed = self.open.take().is_some();
        closed || std::mem::take(&mut self.help)
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
    fn one_panel_at_a_time_is_open_and_closing_takes_them_in_turn() {
        let mut panels = PanelSwitches::default();
        panels.toggle(Panel::Tracks);
        panels.toggle(Panel::Sources);
        assert_eq!(panels.open(), Some(Panel::Sources));
        panels.toggle(Panel::Sources);
        assert_eq!(panels.open(), None);
        panels.toggle(Panel::Tracks);
        panels.toggle_help();
        assert_eq!([panels.close(), panels.close(), panels.close()], [true, true, false]);
        assert_eq!((panels.open(), panels.help()), (None, false));
    }
}
