//! Tests of the controls with a screen reader and with keys.

use egui::accesskit::{Action as Asked, Node, Role, Toggled};
use egui::{Event, Key};

use super::super::panels::pressed;
use super::*;
use crate::settings_panel::tests::panel;
use mariana_player::track::Repeat;

fn assisted_stage() -> Stage {
    let stage = Stage::new(SCREEN);
    stage.panels.context.enable_accesskit();
    stage
}

/// The controls after some frames, because egui learns sizes in the first frame.
fn controls<'a>(stage: &mut Stage, content: impl Fn() -> OverlayContent<'a>) -> Vec<Node> {
    stage.frame(vec![], content());
    stage.frame(vec![], content());
    let laid_out = stage.frame(vec![], content());
    let reported = laid_out.output.platform_output.accesskit_update.expect("no tree of controls");
    reported.nodes.into_iter().map(|(_, node)| node).collect()
}

fn press(key: Key) -> Vec<Event> {
    pressed(key, Modifiers::NONE).to_vec()
}

#[test]
fn toggles_exposed_no_state_to_screen_readers() {
    let states = |playing: &NowPlaying, change: fn(&mut Bar<'_>)| -> Vec<Option<Toggled>> {
        let content = || {
            let mut bar = bar(playing);
            change(&mut bar);
            OverlayContent { bar: Some(bar), ..Default::default() }
        };
        let nodes = controls(&mut assisted_stage(), content);
        let state = |begin: &&str| {
            let named = |node: &&Node| node.label().is_some_and(|name| name.starts_with(*begin));
            nodes.iter().find(named).unwrap_or_else(|| panic!("no {begin}")).toggled()
        };
        let switches = [
            "pause",
            "play tracks in random order",
            "repeat all tracks",
            "mute",
            "enter or leave full screen",
            "show or hide the keys",
            "the scene's sliders",
            "settings",
        ];
        switches.iter().map(state).collect()
    };
    let off = NowPlaying { repeat: Repeat::Off, ..playing() };
    assert_eq!(states(&off, |_| ()), [Some(Toggled::False); 8]);
    let now = NowPlaying { paused: true, shuffled: true, repeat: Repeat::One, muted: true, ..playing() };
    let all_on = |bar: &mut Bar<'_>| {
        bar.fullscreen = true;
        bar.panels =
            PanelSwitches { help: true, sliders: true, open: Some(Panel::Settings), ..Default::default() };
    };
    assert_eq!(states(&now, all_on), [Some(Toggled::True); 8]);
}

#[test]
fn settings_and_sliders_had_controls_without_a_name() {
    let rows = OpenPanel::Settings(panel(&Choices::default(), Some("tv")));
    let turned = sliders(2);
    let mut stage = assisted_stage();
    let mut nodes = controls(&mut stage, || OverlayContent { panel: Some(&rows), ..Default::default() });
    assert!(nodes.iter().filter(|node| node.toggled().is_some()).count() > 5, "the settings are not there");
    for _ in 0..3 {
        let content = OverlayContent { params: Some(&turned), ..Default::default() };
        let reported = stage.frame(vec![], content).output.platform_output.accesskit_update.unwrap();
        nodes.extend(reported.nodes.into_iter().map(|(_, node)| node));
    }
    let is_control = |node: &&Node| {
        let acts = node.supports_action(Asked::Click) || node.supports_action(Asked::Focus);
        acts && node.role() != Role::ScrollBar
    };
    let nameless: Vec<_> =
        nodes.iter().filter(is_control).filter(|node| node.label().is_none_or(str::is_empty)).collect();
    assert!(nameless.is_empty(), "{nameless:#?}");
}

#[test]
fn every_panel_is_reached_by_tab_and_names_its_controls() {
    use crate::controllers_panel::ControllersPanel;
    use crate::scene_browser::SceneBrowser;
    let (help, settings) = (HelpPanel::default(), OpenPanel::Settings(panel(&Choices::default(), None)));
    let scenes = ["a", "b"].map(|name| SceneSource::Shipped(name.into())).to_vec();
    let scenes = OpenPanel::Scenes(SceneBrowser::new(scenes, None, Default::default()));
    let controllers = OpenPanel::Controllers(ControllersPanel::default());
    let panels: [(&str, OverlayContent<'_>); 4] = [
        ("mute or unmute", OverlayContent { help: Some(&help), ..Default::default() }),
        ("Advanced", OverlayContent { panel: Some(&settings), ..Default::default() }),
        ("mark b", OverlayContent { panel: Some(&scenes), ..Default::default() }),
        ("close the controllers", OverlayContent { panel: Some(&controllers), ..Default::default() }),
    ];
    for (wanted, content) in panels {
        let copy = || OverlayContent { help: content.help, panel: content.panel, ..Default::default() };
        let mut stage = assisted_stage();
        let nodes = controls(&mut stage, copy);
        let nameless = |node: &&Node| {
            let acts = node.supports_action(Asked::Click) && node.role() != Role::ScrollBar;
            acts && node.label().is_none_or(str::is_empty)
        };
        assert_eq!(nodes.iter().find(nameless), None, "{wanted}");
        let is_wanted = |node: &Node| node.label().is_some_and(|label| label.starts_with(wanted));
        let mut met = false;
        for _ in 0..80 {
            let laid_out = stage.frame(press(Key::Tab), copy());
            let update = laid_out.output.platform_output.accesskit_update.expect("no tree of controls");
            let focused = update.nodes.iter().find(|(id, _)| *id == update.focus);
            met |= focused.is_some_and(|(_, node)| is_wanted(node));
        }
        assert!(met, "Tab does not reach {wanted}");
    }
}

#[test]
fn tab_did_not_reach_the_bar() {
    let now = playing();
    let content = || OverlayContent { bar: Some(bar(&now)), ..Default::default() };
    let mut stage = Stage::new(SCREEN);
    let focused = |stage: &Stage| stage.panels.context.memory(|memory| memory.focused());
    stage.frame(vec![], OverlayContent::default());
    assert_eq!(focused(&stage), None, "keys belong to the show");
    stage.panels.wants_focus = true;
    while stage.panels.wants_focus {
        stage.frame(vec![], content());
    }
    // The first control is the seek bar, so arrow keys seek.
    assert!(focused(&stage).is_some());
    stage.frame(vec![], content());
    assert_eq!(stage.frame(press(Key::ArrowRight), content()).acts.commands, [Command::SeekTo(55.0)]);
    assert_eq!(stage.frame(press(Key::ArrowLeft), content()).acts.commands, [Command::SeekTo(45.0)]);
    let mut asked = Vec::new();
    for _ in 0..20 {
        stage.frame(press(Key::Tab), content());
        asked.extend(stage.frame(press(Key::Enter), content()).acts.commands);
    }
    for command in [
        Command::Pause(Switch::Toggle),
        Command::Shuffle(Switch::Toggle),
        Command::TogglePanel(Panel::Scenes),
    ] {
        assert!(asked.contains(&command.clone()), "no way to {command:?} in {asked:?}");
    }
    stage.frame(press(Key::Escape), content());
    assert_eq!(focused(&stage), None, "keys belong to the show again");
}

#[test]
fn in_a_small_window_a_button_lay_on_the_volume_and_the_time_was_missing() {
    let now = NowPlaying { position: 83.0, duration: Some(4_225.0), ..playing() };
    for pixels in [[480.0, 270.0], [480.0, 400.0], [640.0, 360.0], [800.0, 450.0], [1280.0, 720.0]] {
        let pixels = Vec2::from(pixels);
        let mut stage = Stage::new(pixels / style::zoom(pixels));
        stage.panels.context.enable_accesskit();
        let content = || OverlayContent { bar: Some(bar(&now)), ..Default::default() };
        let nodes = controls(&mut stage, content);
        let laid_out = stage.frame(vec![], content());
        let is_control = |node: &&Node| matches!(node.role(), Role::Button | Role::Slider);
        let places = nodes.iter().filter(is_control).map(|node| {
            let place = node.bounds().expect("a control without a place");
            let corner = |x, y| Pos2::new(x as f32, y as f32);
            (node.label(), Rect::from_min_max(corner(place.x0, place.y0), corner(place.x1, place.y1)))
        });
        let mut places: Vec<(Option<&str>, Rect)> = places.collect();
        let (_, texts) = drawn(&laid_out);
        places.push((Some("times"), place_of(&texts, "1:23 / 1:10:25")));
        for (index, (name, place)) in places.iter().enumerate() {
            assert!(laid_out.panels[0].contains_rect(*place), "{pixels}: {name:?} is outside");
            let covered = places[..index].iter().find(|(_, other)| other.shrink(0.5).intersects(*place));
            assert_eq!(covered, None, "{pixels}: {name:?} overlaps another control");
        }
        for kept in ["pause", "show or hide the keys", "all scenes", "settings", "track list"] {
            let is_kept = |(name, _): &(Option<&str>, Rect)| name.is_some_and(|name| name.starts_with(kept));
            assert!(places.iter().any(is_kept), "{pixels}: no {kept}");
        }
    }
}
