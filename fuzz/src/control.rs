//! What comes from outside while a show runs: packets of OSC, and the bytes of MIDI devices.

use mariana_control::deed::{Deed, DeedRow, Given, Takes};
use mariana_control::limits::LIMITS;
use mariana_control::midi::{Clock, Device, Said};
use mariana_control::osc::{Asked, Pattern, messages, understand};
use mariana_control::{Amount, ParamWish, midi::Message};

/// An action of each kind.
pub(crate) const DEEDS: &[DeedRow] = &[
    DeedRow { name: "next", takes: Takes::Press, meaning: "" },
    DeedRow { name: "pause", takes: Takes::Switch, meaning: "" },
    DeedRow { name: "volume", takes: Takes::Level, meaning: "" },
    DeedRow { name: "tempo", takes: Takes::Number, meaning: "" },
    DeedRow { name: "scene", takes: Takes::Choice, meaning: "" },
];

/// A packet of OSC: taken apart, understood, and its patterns compared with addresses.
pub(crate) fn osc(data: &[u8]) {
    let (found, _) = messages(data);
    assert!(found.len() <= LIMITS.osc_elements_max, "{} messages", found.len());
    for (message, _) in &found {
        assert!(message.args.len() <= LIMITS.osc_arguments_max);
        if let Some(pattern) = Pattern::read(&message.addr) {
            // What matches nothing shorter may match itself, and never takes long.
            let _ = (pattern.matches("/param/size"), pattern.matches(&message.addr), pattern.matches(""));
        }
        match understand(message, DEEDS) {
            Ok(Asked::Turn(wish)) => check_turn(&wish),
            Ok(Asked::Act(deed)) => check_act(&deed),
            Ok(Asked::Tell(_) | Asked::Nothing) | Err(_) => {}
        }
    }
}

/// A turn has numbers and a name within limits.
pub(crate) fn check_turn(wish: &ParamWish) {
    let (Amount::Value(to) | Amount::Share(to)) = wish.to;
    assert!(to.is_finite() && wish.seconds.is_finite(), "{wish:?}");
    assert!(wish.name.len() <= LIMITS.name_bytes_max, "{wish:?}");
}

/// An action stands in the table, with a number or a name within limits.
pub(crate) fn check_act(deed: &Deed) {
    assert!(DEEDS.iter().any(|row| row.name == deed.name), "{deed:?}");
    match &deed.given {
        Given::Number(number) => assert!(number.is_finite(), "{deed:?}"),
        Given::Text(text) => assert!(text.len() <= LIMITS.name_bytes_max, "{deed:?}"),
        Given::Nothing => {}
    }
}

/// What a MIDI device says, in pieces of any size, and the clock in it.
pub(crate) fn midi(data: &[u8]) {
    let said = |pieces: &mut dyn Iterator<Item = &[u8]>| {
        let (mut device, mut said) = (Device::default(), Vec::new());
        pieces.for_each(|piece| device.hear(piece, |one| said.push(one)));
        said
    };
    let whole = said(&mut std::iter::once(data));
    assert!(whole.len() <= 2 * data.len(), "{} from {} bytes", whole.len(), data.len());
    assert_eq!(whole, said(&mut data.chunks(3)), "it matters how the bytes are cut");
    let mut clock = Clock::default();
    for (number, one) in whole.iter().enumerate() {
        match one {
            Said::Moved(_, value, _) => assert!((0.0..=1.0).contains(value), "{one:?}"),
            Said::Time(message) => {
                clock.take(*message, 0.02 * number as f64);
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
