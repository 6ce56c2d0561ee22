//! Tests of the controllers panel with the pointer.

use egui::Event;

use super::*;
use crate::controllers_panel::{ControllersPanel, ControllersState};
use mariana_control::midi::{Mapping, MidiState, Source, Target};
use mariana_settings::KnobEdit;

fn size() -> Target {
    Target::Param { scene: "orb".to_owned(), name: "size".to_owned() }
}

fn knob() -> Mapping {
    Mapping::learned("desk", Source::Control { channel: 0, number: 7 }, size())
}

fn panel() -> ControllersPanel {
    let slider = Slider {
        name: "size".into(),
        value: 1.0,
        min: 0.0,
        max: 4.0,
        default: 1.0,
        changed_by: ChangedBy::Midi,
        bound: None,
    };
    let mut panel = ControllersPanel::default();
    panel.update(&ControllersState {
        scene: "orb".to_owned(),
        sliders: &[slider],
        osc: Some("heard on 127.0.0.1:9000".to_owned()),
        phone: None,
        midi: Some(MidiState { devices: vec!["desk".to_owned()], is_known: true, ..MidiState::default() }),
        clock: true,
        clock_tempo: None,
        counts: (0, 0),
        mappings: &[knob()],
        learning: None,
    });
    panel
}

#[test]
fn a_click_on_the_name_of_a_slider_learns_a_control_and_the_last_controller_is_shown() {
    let mut stage = Stage::new(SCREEN);
    let mut sliders = sliders(2);
    sliders[1].changed_by = ChangedBy::Midi;
    let content = OverlayContent { params: Some(&sliders), learning: Some("knob 0"), ..Default::default() };
    let texts = drawn(&stage.frame(Vec::new(), content)).1;
    for words in ["MIDI", "move a knob"] {
        assert!(place_of(&texts, words).area() > 50.0, "{words} does not show");
    }
    let place = place_of(&texts, "knob 1").center();
    let mut done = Vec::new();
    for pressed in [None, Some(true), Some(false)] {
        let events = match pressed {
            None => vec![Event::PointerMoved(place)],
            Some(pressed) => vec![Event::PointerButton {
                pos: place,
                button: PointerButton::Primary,
                pressed,
                modifiers: Modifiers::NONE,
            }],
        };
        let content = OverlayContent { params: Some(&sliders), ..Default::default() };
        let laid_out = stage.frame(events, content);
        done.extend(laid_out.acts.commands);
    }
    assert_eq!(done, [Command::LearnParameter("knob 1".to_owned())]);
}

#[test]
fn the_pointer_learns_changes_and_removes_mappings() {
    let content = open(OpenPanel::Controllers(panel()));
    let mut stage = Stage::new(SCREEN);
    stage.frame(Vec::new(), content());
    let laid_out = stage.frame(Vec::new(), content());
    let texts = drawn(&laid_out).1;
    assert!(stage.screen.contains_rect(laid_out.panels[0]));
    let mut inverted = knob();
    inverted.invert();
    let mut narrow = knob();
    narrow.range = [0.25, 1.0];
    for (words, wanted) in [
        ("size", Command::Learn(size())),
        ("invert", Command::EditMappings(KnobEdit::Change(knob(), inverted))),
        ("from 0 %", Command::EditMappings(KnobEdit::Change(knob(), narrow))),
        ("forget", Command::EditMappings(KnobEdit::Remove(knob()))),
        ("MIDI clock sets the tempo", Command::EditMappings(KnobEdit::Clock(false))),
    ] {
        let place = place_of(&texts, words).center();
        assert_eq!(commands(&mut stage, place, content), [wanted], "{words}");
        stage.seconds += 2.0;
    }
}

#[test]
fn the_controllers_panel_fits_every_window() {
    let content = open(OpenPanel::Controllers(panel()));
    for screen in [SCREEN, Vec2::new(640.0, 360.0), Vec2::new(320.0, 180.0), Vec2::new(60.0, 40.0)] {
        let mut stage = Stage::new(screen);
        let laid_out = stage.frame(Vec::new(), content());
        assert!(screen.y < 100.0 || stage.screen.contains_rect(laid_out.panels[0]), "{screen:?}");
    }
}

#[test]
fn the_code_of_the_address_is_drawn_in_whole_pixels_at_any_scale() {
    for scale in [1.0, 1.5, 2.0] {
        let context = egui::Context::default();
        context.set_pixels_per_point(scale);
        let url = "http://192.168.100.100:65535/0123456789abcdefghjkmnpqrs/".to_owned();
        let pairing_address =
            mariana_remote::PairingAddress { code: mariana_remote::Code::of(&url), url, is_local: false };
        let input = egui::RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, egui::vec2(640.0, 360.0))),
            ..Default::default()
        };
        // A new scale applies from the second frame.
        let mut shapes = Vec::new();
        for _ in 0..2 {
            let mut output = context.run_ui(input.clone(), |ui| {
                super::super::pairing_address::show(ui, &pairing_address, "about");
            });
            output.textures_delta.clear();
            shapes = output.shapes;
        }
        let mesh = shapes.iter().find_map(|shape| match &shape.shape {
            egui::Shape::Mesh(mesh) => Some(mesh.clone()),
            _ => None,
        });
        let mesh = mesh.unwrap();
        let squares = pairing_address.code.dark().count() + 1;
        assert_eq!(mesh.vertices.len(), 4 * squares);
        for vertex in &mesh.vertices {
            for at in [vertex.pos.x * scale, vertex.pos.y * scale] {
                assert!((at - at.round()).abs() < 1e-2, "{at} is between pixels at {scale}");
            }
        }
        let side = scale * (mesh.vertices[3].pos - mesh.vertices[0].pos).x;
        let count = (pairing_address.code.side + 2 * mariana_remote::Code::EDGE) as f32;
        assert!(side / count >= 3.0, "squares of {} pixels are too small for a camera", side / count);
    }
}
