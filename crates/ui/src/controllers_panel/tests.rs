//! Tests of keys in the panel, and of the texts of its rows.

use super::*;

use mariana_commands as commands;
use mariana_control::ChangedBy;
use mariana_control::action::{ActionRow, ValueType};
use mariana_control::midi::Source;
use mariana_remote::RemoteState;

fn slider() -> Slider {
    Slider {
        name: "size".into(),
        value: 1.0,
        min: 0.0,
        max: 4.0,
        default: 1.0,
        changed_by: ChangedBy::Midi,
        bound: None,
    }
}

fn size() -> Target {
    Target::Param { scene: "orb".to_owned(), name: "size".to_owned() }
}

fn knob(target: Target) -> Mapping {
    Mapping::learned("desk", Source::Control { channel: 0, number: 7 }, target)
}

fn panel(mappings: &[Mapping], learning: Option<&Target>) -> ControllersPanel {
    let midi = MidiState { devices: vec!["pads".to_owned()], is_known: true, ..MidiState::default() };
    let mut panel = ControllersPanel::default();
    panel.update(&ControllersState {
        scene: "orb".to_owned(),
        sliders: &[slider()],
        osc: None,
        phone: None,
        midi: Some(midi),
        clock: true,
        clock_tempo: None,
        counts: (7, 2),
        mappings,
        learning,
    });
    panel
}

fn key(named: NamedKey) -> Key {
    Key::Named(named)
}

#[test]
fn every_target_has_a_row_with_its_mappings_below() {
    let other = Target::Param { scene: "city".to_owned(), name: "fog".to_owned() };
    let panel = panel(&[knob(size()), knob(other)], None);
    let place = panel
        .rows
        .iter()
        .position(|row| matches!(row, ControllerRow::Target { target, .. } if *target == size()));
    let below = &panel.rows[place.unwrap() + 1];
    assert!(
        matches!(below, ControllerRow::Knob { words, stands: Some(0.25), .. }
            if words == "cc 7 on channel 1 of desk (not connected)"),
        "{below:?}"
    );
    let targets = panel.rows.iter().filter(|row| matches!(row, ControllerRow::Target { .. })).count();
    // One parameter, two rows for scenes, and a row for each number.
    let rows_of = |row: &ActionRow| match row.takes {
        ValueType::Index(most) => usize::from(most),
        ValueType::Choice => 2,
        _ => 1,
    };
    assert_eq!(targets, 1 + commands::for_controllers().iter().map(rows_of).sum::<usize>());
    let last = panel.rows.last();
    assert!(
        matches!(last, Some(ControllerRow::Knob { words, .. }) if words.starts_with("fog in city")),
        "{last:?}"
    );
    let counts = "7 messages received, 2 of them ignored";
    assert!(panel.rows.iter().any(|row| matches!(row, ControllerRow::Words { text, .. } if text == counts)));
}

#[test]
fn an_endless_knob_can_be_made_absolute() {
    let endless = Mapping { encoding: Some(Encoding::Offset), ..knob(size()) };
    assert_eq!(MappingField::PickUp.words(&endless), "endless");
    let absolute = Mapping { encoding: Some(Encoding::Absolute), ..knob(size()) };
    assert_eq!(MappingField::PickUp.words(&absolute), "picks up");
    let request = MappingField::PickUp.request(&endless, None);
    assert_eq!(request, Some(Command::EditMappings(KnobEdit::Change(endless, absolute))));
}

#[test]
fn keys_learn_change_and_forget() {
    let mut panel = panel(&[knob(size())], None);
    assert_eq!(
        panel.handle_key(&key(NamedKey::Enter)),
        Some(vec![Command::EditMappings(KnobEdit::Clock(false))])
    );
    panel.handle_key(&key(NamedKey::ArrowDown));
    assert_eq!(panel.handle_key(&key(NamedKey::Enter)).unwrap().pop(), Some(Command::Learn(size())));
    panel.handle_key(&key(NamedKey::ArrowDown));
    let mut after = knob(size());
    after.range = [0.25, 1.0];
    assert_eq!(
        panel.handle_key(&key(NamedKey::Enter)).unwrap().pop(),
        Some(Command::EditMappings(KnobEdit::Change(knob(size()), after)))
    );
    panel.handle_key(&key(NamedKey::ArrowRight));
    panel.handle_key(&key(NamedKey::ArrowRight));
    let mut after = knob(size());
    after.range = [1.0, 0.0];
    assert_eq!(
        panel.handle_key(&key(NamedKey::Enter)).unwrap().pop(),
        Some(Command::EditMappings(KnobEdit::Change(knob(size()), after)))
    );
    assert_eq!(
        panel.handle_key(&key(NamedKey::Delete)).unwrap().pop(),
        Some(Command::EditMappings(KnobEdit::Remove(knob(size()))))
    );
    assert_eq!(panel.handle_key(&Key::Character("n".into())), None, "letters belong to the show");
    for _ in 0..100 {
        panel.handle_key(&key(NamedKey::ArrowDown));
    }
    assert!(panel.selected < panel.rows.len());
    for _ in 0..100 {
        panel.handle_key(&key(NamedKey::ArrowUp));
    }
    assert!(matches!(panel.rows[panel.selected], ControllerRow::Clock(true)));
}

#[test]
fn a_row_that_moves_stays_selected() {
    let mut panel = panel(&[], None);
    let next = Target::Action { name: "next".to_owned(), value: None };
    while !matches!(&panel.rows[panel.selected], ControllerRow::Target { target, .. } if *target == next) {
        panel.handle_key(&key(NamedKey::ArrowDown));
    }
    panel.update(&ControllersState {
        scene: "city".to_owned(),
        sliders: &[],
        osc: None,
        phone: None,
        midi: Some(MidiState { is_known: true, ..MidiState::default() }),
        clock: true,
        clock_tempo: None,
        counts: (0, 0),
        mappings: &[],
        learning: None,
    });
    assert_eq!(panel.handle_key(&key(NamedKey::Enter)).unwrap().pop(), Some(Command::Learn(next)));
}

#[test]
fn every_field_shows_its_value_and_cycles() {
    let mut mapping = knob(size());
    for field in [MappingField::Curve, MappingField::Smoothing, MappingField::PickUp] {
        let first = field.words(&mapping);
        let mut seen = Vec::new();
        loop {
            seen.push(field.words(&mapping));
            let Some(Command::EditMappings(KnobEdit::Change(_, after))) = field.request(&mapping, None)
            else {
                panic!()
            };
            mapping = after;
            if field.words(&mapping) == first {
                break;
            }
            assert!(!seen.contains(&field.words(&mapping)), "{field:?}");
        }
        assert!(seen.len() > 1, "{field:?}");
    }
    assert_eq!(MappingField::To.request(&mapping, None), None, "the present value is unknown");
    assert_eq!(MappingField::To.words(&mapping), "to 100 %");
}

#[test]
fn a_target_that_is_being_learned_asks_for_a_control() {
    let panel = panel(&[], Some(&size()));
    let row = panel.rows.iter().find(|row| matches!(row, ControllerRow::Target { learns: true, .. }));
    assert!(
        matches!(row, Some(ControllerRow::Target { about, .. }) if about.contains("move a knob")),
        "{row:?}"
    );
}

#[test]
fn the_connection_code_comes_first_and_a_failed_server_shows_the_reason() {
    let panel_of = |state| {
        let mut panel = ControllersPanel::default();
        panel.update(&ControllersState {
            scene: "orb".to_owned(),
            sliders: &[slider()],
            osc: None,
            phone: Some(PhoneFacts { state, phones: 2 }),
            midi: None,
            clock: false,
            clock_tempo: None,
            counts: (0, 0),
            mappings: &[],
            learning: None,
        });
        panel
    };
    let url = "http://192.168.0.7:8080/x/".to_owned();
    let pairing_address = PairingAddress { code: mariana_remote::Code::of(&url), url, is_local: false };
    let panel = panel_of(RemoteState::Open(Arc::new(pairing_address.clone())));
    let Some(ControllerRow::Phone { pairing_address: shown, about }) = panel.rows.first() else {
        panic!("{:?}", panel.rows.first())
    };
    assert_eq!((&**shown, &**about), (&pairing_address, "2 phones are connected."));
    assert!(panel.selected > 0, "the code cannot be selected");
    let panel = panel_of(RemoteState::Refused("why".to_owned()));
    assert!(panel.rows.contains(&ControllerRow::Words { text: "Phone: why".to_owned(), is_bad: true }));
    assert!(!panel.rows.iter().any(|row| matches!(row, ControllerRow::Phone { .. })));
}
