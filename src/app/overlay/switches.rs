//! Which panels of the overlay the user has turned on.

/// At first there is none: the picture is what the window is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PanelSwitches {
    help: bool,
    sliders: bool,
    corner: bool,
}

impl PanelSwitches {
    /// Shows the keys or hides them.
    pub fn toggle_help(&mut self) {
        self.help = !self.help;
    }

    /// Shows the sliders of the parameters or hides them.
    pub fn toggle_sliders(&mut self) {
        self.sliders = !self.sliders;
    }

    /// Shows the line about the scene or hides it.
    pub fn toggle_corner(&mut self) {
        self.corner = !self.corner;
    }

    /// Whether the keys are shown.
    pub fn help(self) -> bool {
        self.help
    }

    /// Whether the sliders of the parameters are shown.
    pub fn sliders(self) -> bool {
        self.sliders
    }

    /// Whether the line about the scene is shown.
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
}
