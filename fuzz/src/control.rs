//! Input from controllers: OSC packets and the bytes of MIDI devices.

use mariana_control::action::{Action, ActionRow, ActionValue, ValueType};
use mariana_control::limits;
use mariana_control::midi::{Device, MidiClock, Said};
use mariana_control::osc::{Asked, Pattern, messages, understand};
use mariana_control::{Amount, ParamChange, midi::Message};

/// One action of each kind.
pub(crate) const ACTIONS: &[ActionRow] = &[
    ActionRow { name: "next", takes: ValueType::Press, meaning: "" },
    ActionRow { name: "pause", takes: ValueType::Switch, meaning: "" },
    ActionRow { name: "volume", takes: ValueType::Level, meaning: "" },
    ActionRow { name: "tempo", takes: ValueType::Number, meaning: "" },
    ActionRow { name: "scene", takes: ValueType::Choice, meaning: "" },
];

/// Parses an OSC packet and matches its address patterns with some addresses.
pub(crate) fn osc(data: &[u8]) {
    let (found, _) = messages(data);
    assert!(found.len() <= limits::OSC_ELEMENTS_MAX, "{} messages", found.len());
    for (message, _) in &found {
        assert!(message.args.len() <= limits::OSC_ARGUMENTS_MAX);
        if let Some(pattern) = Pattern::read(&message.addr) {
            // Matching must not panic and must be fast.
            let _ = (pattern.matches("/param/size"), pattern.matches(&message.addr), pattern.matches(""));
        }
        match understand(message, ACTIONS) {
            Ok(Asked::Turn(change)) => check_turn(&change),
            Ok(Asked::Act(action)) => check_act(&action),
            Ok(Asked::Tell(_) | Asked::Nothing) | Err(_) => {}
        }
    }
}

pub(crate) fn check_turn(change: &ParamChange) {
    let (Amount::Value(to) | Amount::Fraction(to)) = change.to;
    assert!(to.is_finite() && change.seconds.is_finite(), "{change:?}");
    assert!(change.name.len() <= limits::NAME_BYTES_MAX, "{change:?}");
}

pub(crate) fn check_act(action: &Action) {
    assert!(ACTIONS.iter().any(|row| row.name == action.name), "{action:?}");
    match &action.given {
        ActionValue::Number(number) => assert!(number.is_finite(), "{action:?}"),
        ActionValue::Text(text) => assert!(text.len() <= limits::NAME_BYTES_MAX, "{action:?}"),
        ActionValue::Nothing => {}
    }
}

/// Parses MIDI bytes in pieces of any size, and follows the MIDI clock.
pub(crate) fn midi(data: &[u8]) {
    let said = |pieces: &mut dyn Iterator<Item = &[u8]>| {
        let (mut device, mut said) = (Device::new("fuzz".into()), Vec::new());
        pieces.for_each(|piece| device.parse(piece, |one| said.push(one)));
        said
    };
    let whole = said(&mut std::iter::once(data));
    assert!(whole.len() <= 2 * data.len(), "{} from {} bytes", whole.len(), data.len());
    assert_eq!(whole, said(&mut data.chunks(3)), "the result depends on how the bytes are split");
    let mut clock = MidiClock::default();
    for (number, one) in whole.iter().enumerate() {
        match one {
            Said::Moved(moved) => assert!((0.0..=1.0).contains(&moved.value), "{one:?}"),
            Said::Time(message) => {
                clock.process(*message, 0.02 * number as f64);
                let may = |message: &Message| !matches!(message, Message::Position(place) if *place > 0x3fff);
                assert!(may(message), "{message:?}");
            }
        }
        if let Some(reading) = clock.reading() {
            assert!(reading.tempo.is_finite(), "{reading:?}");
            let phase = reading.phase_at(0.02 * number as f64).map_or(0.0, |(phase, _)| phase);
            assert!((0.0..=1.0).contains(&phase), "{phase} of {reading:?}");
        }
    }
}
