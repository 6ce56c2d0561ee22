//! Tests of the panel that makes videos, and of the marks on the seek bar.

use egui::accesskit::{Action as Asked, Role};
use egui::pos2;

use super::*;
use crate::video_panel::VideoPanel;
use crate::video_panel::tests::rows;
use mariana_commands::{Edge, JobAction, Mark, VideoChoice, VideoEdit};

fn panel(jobs: u64) -> VideoPanel {
    let mut panel = VideoPanel::default();
    panel.update(rows(jobs));
    panel
}

fn clicked(stage: &mut Stage, content: impl Fn() -> Content, words: &str) -> Vec<Command> {
    (0..3).for_each(|_| drop(stage.frame(vec![], content())));
    let (_, texts) = drawn(&stage.frame(vec![], content()));
    commands(stage, place_of(&texts, words).center(), content)
}

#[test]
fn every_button_of_the_panel_sends_its_command() {
    let content = open(OpenPanel::Video(panel(1)));
    let choose = |what, option| VideoEdit::Choose { what, option };
    for screen in [SCREEN, Vec2::new(640.0, 360.0)] {
        for (words, edit) in [
            ("pause", VideoEdit::Job { id: 1, action: JobAction::Pause }),
            ("story", choose(VideoChoice::Place, 2)),
            ("end here", choose(VideoChoice::Marks, 1)),
            ("make the video", VideoEdit::Make),
        ] {
            let sent = clicked(&mut Stage::new(screen), content, words);
            assert_eq!(sent, [Command::Video(edit)], "{words} in {screen:?}");
        }
    }
}

#[test]
fn a_long_queue_leaves_the_button_in_the_window_and_everything_has_a_name() {
    let panel = OpenPanel::Video(panel(30));
    let now = playing();
    for screen in [SCREEN, Vec2::new(640.0, 360.0), Vec2::new(300.0, 200.0)] {
        let mut stage = Stage::new(screen);
        stage.panels.context.enable_accesskit();
        let content = || OverlayContent { panel: Some(&panel), bar: Some(bar(&now)), ..Default::default() };
        (0..3).for_each(|_| drop(stage.frame(vec![], content())));
        let laid_out = stage.frame(vec![], content());
        let (bounds, texts) = drawn(&laid_out);
        assert!(stage.screen.expand(1.0).contains_rect(bounds), "{bounds:?} in {screen:?}");
        assert!(stage.screen.contains_rect(place_of(&texts, "make the video")), "{screen:?}");
        let nodes = laid_out.output.platform_output.accesskit_update.unwrap().nodes;
        let controls = nodes.iter().map(|(_, node)| node).filter(|node| {
            node.role() != Role::ScrollBar
                && (node.supports_action(Asked::Click) || node.supports_action(Asked::Focus))
        });
        let nameless: Vec<_> = controls.filter(|node| node.label().is_none_or(str::is_empty)).collect();
        assert!(nameless.is_empty(), "{nameless:#?}");
    }
}

#[test]
fn a_mark_is_dragged_to_a_border_and_the_song_does_not_move() {
    let now: &'static NowPlaying = Box::leak(Box::new(NowPlaying { duration: Some(100.0), ..playing() }));
    let mut stage = Stage::new(SCREEN);
    let panels = PanelSwitches { open: Some(Panel::Video), ..Default::default() };
    let content = |marks: Option<[f64; 2]>| OverlayContent {
        bar: Some(Bar { marks, panels, ..bar(now) }),
        ..Default::default()
    };
    (0..3).for_each(|_| drop(stage.frame(vec![], content(None))));
    // The rail is as wide as the bar without its padding, under the line with the title.
    let panel = stage.frame(vec![], content(None)).panels[0];
    let at = |fraction: f32| {
        let rail = panel.shrink2(style::PADDING);
        pos2(rail.left() + fraction * rail.width(), rail.top() + 19.0 + 3.0 + 13.0)
    };
    let button = |fraction: f32, pressed| Event::PointerButton {
        pos: at(fraction),
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    let mut sent = Vec::new();
    for events in [
        vec![Event::PointerMoved(at(0.002))],
        vec![button(0.002, true)],
        vec![Event::PointerMoved(at(0.2))],
        vec![Event::PointerMoved(at(0.3))],
        vec![button(0.3, false)],
    ] {
        sent.extend(stage.frame(events, content(None)).acts.commands);
    }
    let Some(Command::Mark(Mark { edge: Edge::Start, at: Some(time) })) = sent.last() else {
        panic!("{sent:?}");
    };
    assert!((time - 30.0).abs() < 1.0, "{time}");
    assert!(sent.iter().all(|event| matches!(event, Command::Mark(_))), "{sent:?}");
}
