//! Tests of the table of keys.

use super::*;
use mariana_commands::input::{Key, NamedKey};

/// The row of the key that pauses.
pub(super) const PAUSE: &str = "pause or resume; with Shift, refine the paused picture";

fn shown(stage: &mut Stage, help: &HelpPanel) -> LaidOut {
    let content = || OverlayContent { help: Some(help), ..Default::default() };
    stage.frame(Vec::new(), content());
    stage.frame(Vec::new(), content())
}

#[test]
fn every_row_is_legible_and_reached_by_keys_in_every_window() {
    for screen in [Vec2::new(640.0, 360.0), SCREEN, Vec2::new(2560.0, 1440.0), Vec2::new(300.0, 200.0)] {
        let (mut stage, mut help) = (Stage::new(screen), HelpPanel::default());
        let rows: Vec<_> = help.found().into_iter().flat_map(|(_, rows)| rows).collect();
        for row in &rows {
            let laid_out = shown(&mut stage, &help);
            let (bounds, texts) = drawn(&laid_out);
            assert!(stage.screen.contains_rect(bounds), "{screen:?}: {bounds:?}");
            let at = place_of(&texts, row.help);
            assert!(at.height() > 12.0, "{screen:?}: {} is not seen: {at:?}", row.help);
            let _ = help.handle_key(&Key::Named(NamedKey::ArrowDown), false);
        }
        assert_eq!(help.selected, rows.len() - 1);
    }
}

#[test]
fn a_wide_window_has_two_columns_and_a_narrow_one_has_one() {
    let lefts = |screen: Vec2| {
        let laid_out = shown(&mut Stage::new(screen), &HelpPanel::default());
        let (_, texts) = drawn(&laid_out);
        ["Playing", "For developers"].map(|group| place_of(&texts, group).left())
    };
    let [first, last] = lefts(SCREEN);
    assert!(last > first + 300.0, "{first} {last}");
    // In a narrow window the last group is below, outside the visible part.
    let laid_out = shown(&mut Stage::new(Vec2::new(640.0, 360.0)), &HelpPanel::default());
    let all: Vec<_> = drawn(&laid_out).1.into_iter().map(|(text, _)| text).collect();
    assert!(all.contains(&"Playing".to_owned()), "{all:?}");
}

#[test]
fn a_click_on_a_row_does_what_the_row_says() {
    let help: &'static HelpPanel = Box::leak(Box::default());
    let content = || OverlayContent { help: Some(help), ..Default::default() };
    let mut stage = Stage::new(SCREEN);
    let (_, texts) = drawn(&shown(&mut stage, help));
    let at = place_of(&texts, PAUSE).center();
    let mut on_panels = acts(&mut stage, at, content).on_panels;
    let Some(PanelAct::Help(act)) = on_panels.pop() else { panic!("no act on the table") };
    let mut own = HelpPanel::default();
    let paused = own.pick(0);
    assert!(on_panels.is_empty() && act(&mut HelpPanel::default()) == paused);
}
