//! Tests of the sounds that move sliders, and of the snapshots, with the pointer.

use super::*;
use crate::overlay::content::SnapshotRow;
use egui::accesskit::{NodeId, TreeUpdate};
use mariana_commands::Bind;
use mariana_control::{Bound, Curve, SoundBinding};

/// The middle of the control with this name for screen readers.
fn place(update: &TreeUpdate, name: &str) -> Option<Pos2> {
    let by_name = |(_, node): &&(NodeId, egui::accesskit::Node)| node.label() == Some(name);
    let bounds = update.nodes.iter().find(by_name)?.1.bounds()?;
    Some(Pos2::new((0.5 * (bounds.x0 + bounds.x1)) as f32, (0.5 * (bounds.y0 + bounds.y1)) as f32))
}

struct Desk {
    stage: Stage,
    sliders: Vec<Slider>,
    snapshots: SnapshotRow,
}

impl Desk {
    fn new(screen: Vec2) -> Self {
        let stage = Stage::new(screen);
        stage.panels.context.enable_accesskit();
        let mut desk = Self { stage, sliders: sliders(2), snapshots: SnapshotRow::default() };
        desk.frame(Vec::new());
        desk
    }

    fn frame(&mut self, events: Vec<Event>) -> LaidOut {
        let snapshots = self.snapshots;
        let content = OverlayContent { params: Some(&self.sliders), snapshots, ..Default::default() };
        self.stage.frame(events, content)
    }

    /// Clicks the control with this name for screen readers.
    fn click(&mut self, name: &str) -> Vec<Command> {
        self.frame(Vec::new());
        let update = self.frame(Vec::new()).output.platform_output.accesskit_update.unwrap();
        let at = place(&update, name).unwrap_or_else(|| panic!("no control '{name}'"));
        assert!(self.stage.screen.contains(at), "'{name}' is outside the window");
        self.stage.seconds += 2.0;
        click_at(at).into_iter().flat_map(|events| self.frame(events).acts.commands).collect()
    }
}

fn bind(binding: Option<SoundBinding>) -> Vec<Command> {
    vec![Command::Bind(Bind { name: "knob 1".to_owned(), binding })]
}

#[test]
fn two_clicks_bind_a_slider_and_more_clicks_shape_the_binding() {
    for screen in [SCREEN, Vec2::new(640.0, 360.0)] {
        let mut desk = Desk::new(screen);
        assert_eq!(desk.click("bind knob 1 to a sound"), []);
        let binding = SoundBinding {
            input: "bass".to_owned(),
            low: 0.0,
            high: 4.0,
            curve: Curve::Linear,
            smoothing: 0.0,
            release: None,
        };
        assert_eq!(desk.click("bind knob 1 to bass"), bind(Some(binding.clone())));
        desk.sliders[1].bound = Some(Bound { binding: binding.clone(), is_active: true });
        desk.sliders[1].changed_by = ChangedBy::Sound;
        let texts = drawn(&desk.frame(Vec::new())).1;
        assert!(place_of(&texts, "bass").area() > 50.0, "the row does not name its sound");
        let root = SoundBinding { curve: Curve::Root, ..binding.clone() };
        assert_eq!(desk.click("curve of knob 1: root"), bind(Some(root)));
        let soft = SoundBinding { smoothing: 0.3, ..binding.clone() };
        assert_eq!(desk.click("knob 1 rises: 0.3 s"), bind(Some(soft)));
        let envelope = SoundBinding { release: Some(1.0), ..binding.clone() };
        assert_eq!(desk.click("knob 1 falls: 1 s"), bind(Some(envelope.clone())));
        desk.sliders[1].bound = Some(Bound { binding: envelope, is_active: true });
        assert_eq!(desk.click("knob 1 falls: at once"), bind(Some(binding.clone())));
        desk.sliders[1].bound = Some(Bound { binding: binding.clone(), is_active: true });
        assert_eq!(desk.click("knob 1 falls: at once"), [], "the time is chosen already");
        let write = [Command::WriteBinding("knob 1".to_owned())];
        assert_eq!(desk.click("write the binding of knob 1 into the scene"), write);
        // The middle of the rail.
        let low = SoundBinding { low: 2.0, ..binding.clone() };
        assert_eq!(desk.click("low of knob 1"), bind(Some(low)));
        assert_eq!(desk.click("end the binding of knob 1"), bind(None));
    }
}

#[test]
fn the_list_of_sounds_has_all_sounds_on_request() {
    let mut desk = Desk::new(SCREEN);
    desk.click("bind knob 0 to a sound");
    assert_eq!(desk.click("more sounds for knob 0"), []);
    let Command::Bind(Bind { binding: Some(binding), .. }) = desk.click("bind knob 0 to loudness").remove(0)
    else {
        panic!("no binding")
    };
    assert_eq!(binding.input, "loudness");
}

#[test]
fn a_wave_has_a_shape_and_a_length() {
    let mut desk = Desk::new(SCREEN);
    desk.click("bind knob 0 to a sound");
    let bound = |events: Vec<Command>| match events.as_slice() {
        [Command::Bind(Bind { binding: Some(binding), .. })] => binding.clone(),
        other => panic!("no binding: {other:?}"),
    };
    let binding = bound(desk.click("move knob 0 in a wave: triangle"));
    assert_eq!(binding.input, "triangle_4");
    desk.sliders[0].bound = Some(Bound { binding, is_active: true });
    desk.sliders[0].changed_by = ChangedBy::Sound;
    let longer = bound(desk.click("wave of knob 0: 16 beats"));
    assert_eq!(longer.input, "triangle_16");
    desk.sliders[0].bound = Some(Bound { binding: longer, is_active: true });
    assert_eq!(bound(desk.click("move knob 0 in a wave: random")).input, "random_16");
}

#[test]
fn the_row_of_snapshots_takes_and_recalls() {
    let mut desk = Desk::new(Vec2::new(640.0, 360.0));
    let command = |command| vec![command];
    assert_eq!(desk.click("take snapshot 8 (Shift+8)"), command(Command::Snapshot(8)));
    desk.snapshots.taken[1] = true;
    assert_eq!(desk.click("recall snapshot 2 (Shift+2)"), command(Command::Snapshot(2)));
    let again = "let the next snapshot be taken again instead of recalled (F2)";
    assert_eq!(desk.click(again), command(Command::TakeNext(Switch::Toggle)));
    assert_eq!(desk.click("recall snapshots over 8 beats"), command(Command::MorphBeats(8.0)));
    assert_eq!(desk.click("recall snapshots at once"), command(Command::MorphBeats(0.0)));
    let write = "write the snapshots as a show file with an entry for each";
    assert_eq!(desk.click(write), command(Command::WriteSnapshots));
}

#[test]
fn the_rows_of_snapshots_had_no_names_and_their_buttons_no_tooltips() {
    let mut desk = Desk::new(SCREEN);
    let laid_out = desk.frame(Vec::new());
    let texts = drawn(&laid_out).1;
    for words in ["snapshots of the sliders", "time to recall one, in beats", "take again"] {
        assert!(place_of(&texts, words).height() > 5.0, "{words}");
    }
    // egui shows a tooltip once the pointer rests.
    let update = laid_out.output.platform_output.accesskit_update.unwrap();
    let at = place(&update, "take snapshot 8 (Shift+8)").unwrap();
    desk.frame(vec![Event::PointerMoved(at)]);
    desk.stage.seconds += 2.0;
    desk.frame(Vec::new());
    let texts = drawn(&desk.frame(Vec::new())).1;
    assert!(place_of(&texts, "take snapshot 8 (Shift+8)").height() > 5.0);
}
