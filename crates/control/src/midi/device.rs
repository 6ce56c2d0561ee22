//! A MIDI device: converts its bytes to knob movements.

use std::sync::Arc;

use super::encoding::{Encoding, Evidence};
use super::message::{Message, Parser};
use super::source::{KnobMove, Source};

const CHANNELS: usize = 16;
/// Controllers `n` below this may have 14 bits: then controller `n + 32` sends the low 7 bits.
const FINE: usize = 32;
/// The controllers by which an encoder sends steps, one for each way. Their value has no meaning.
pub(super) const INCREMENT: u8 = 96;
pub(super) const DECREMENT: u8 = 97;

/// The state of a device, kept from one byte to the next.
#[derive(Debug, Clone)]
pub struct Device {
    name: Arc<str>,
    parser: Parser,
    channels: [Channel; CHANNELS],
}

#[derive(Debug, Clone, Copy)]
struct Channel {
    /// The last value of each controller number, for detecting presses and 14-bit controllers.
    values: [u8; 128],
    /// For each controller number, the evidence that an encoder sends it.
    evidence: [Evidence; 128],
    last: Option<u8>,
    /// True for controllers `n` that have sent messages for `n` and `n + 32` in succession, and so have 14 bits.
    is_fine: [bool; FINE],
}

/// A parsed event of a device.
#[derive(Debug, Clone, PartialEq)]
pub enum Said {
    /// A control moved.
    Moved(KnobMove),
    /// A message of the device's clock.
    Time(Message),
}

impl Device {
    /// Starts listening to the device with this name.
    pub fn new(name: Arc<str>) -> Self {
        let evidence = [Evidence::default(); 128];
        let channel = Channel { values: [0; 128], evidence, last: None, is_fine: [false; FINE] };
        Self { name, parser: Parser::default(), channels: [channel; CHANNELS] }
    }

    /// Parses bytes and passes the events to `tell`.
    pub fn parse(&mut self, bytes: &[u8], mut tell: impl FnMut(Said)) {
        for byte in bytes {
            if let Some(message) = self.parser.push(*byte) {
                self.handle_message(message, &mut tell);
            }
        }
    }

    fn handle_message(&mut self, message: Message, tell: &mut impl FnMut(Said)) {
        let Message::Moved(source, sent) = message else { return tell(Said::Time(message)) };
        let (value, is_press) = match source {
            Source::Control { channel, number } => {
                return self.handle_control(channel, number, sent as u8, tell);
            }
            Source::Bend { .. } => (fraction_of_bend(sent), false),
            Source::Note { .. } => (fraction(sent), sent > 0),
            _ => (fraction(sent), source.is_pressed()),
        };
        tell(Said::Moved(KnobMove::to(self.name.clone(), source, value, is_press)));
    }

    fn handle_control(&mut self, channel: u8, number: u8, value: u8, tell: &mut impl FnMut(Said)) {
        let Some(state) = self.channels.get_mut(usize::from(channel)) else { return };
        let place = usize::from(number);
        let known = state.values.get_mut(place).zip(state.evidence.get_mut(place));
        let Some((known, evidence)) = known else { return };
        let before = std::mem::replace(known, value);
        let encoding = evidence.add(value, before);
        let last = state.last.replace(number);
        // A 14-bit controller sends its high bits with the coarse number and its low bits with the fine number.
        let fine = match number {
            0..32 => Some((number, number + 32)),
            32..64 => Some((number - 32, number - 32)),
            _ => None,
        };
        let fine = fine.and_then(|(coarse, other)| {
            let is_fine = state.is_fine.get_mut(usize::from(coarse))?;
            *is_fine |= last == Some(other);
            is_fine.then_some(coarse)
        });
        let moved = |source, value, is_press| KnobMove::to(self.name.clone(), source, value, is_press);
        let is_press = before < 64 && value >= 64;
        // The high bits of a 14-bit controller repeat their value as an encoder does.
        let encoding = encoding.filter(|_| fine.is_none());
        let control = Source::Control { channel, number };
        tell(Said::Moved(KnobMove { encoding, ..moved(control, fraction(value.into()), is_press) }));
        if let Some(coarse) = fine {
            let of = |number: u8| state.values.get(usize::from(number)).copied().unwrap_or_default();
            let value = f32::from(u16::from(of(coarse)) << 7 | u16::from(of(coarse + 32))) / 16_383.0;
            tell(Said::Moved(moved(Source::FineControl { channel, number: coarse }, value, false)));
        }
        // A knob that sends its position does not repeat it.
        if [INCREMENT, DECREMENT].contains(&number) && value == before {
            let step = fraction(if number == INCREMENT { 1 } else { 127 });
            let encoding = Some(Encoding::Complement);
            let source = Source::Increment { channel };
            tell(Said::Moved(KnobMove { encoding, ..moved(source, step, false) }));
        }
    }
}

fn fraction(value: u16) -> f32 {
    f32::from(value) / 127.0
}

/// Returns a wheel position as 0..1. The rest position is exactly 0.5.
fn fraction_of_bend(value: u16) -> f32 {
    let way = f32::from(value) - 8_192.0;
    0.5 + 0.5 * way / if way < 0.0 { 8_192.0 } else { 8_191.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(bytes: &[u8]) -> Vec<Said> {
        let (mut device, mut said) = (Device::new("desk".into()), Vec::new());
        device.parse(bytes, |one| said.push(one));
        said
    }

    fn moved(bytes: &[u8]) -> Vec<(String, f32, bool)> {
        let moved = said(bytes).into_iter().filter_map(|said| match said {
            Said::Moved(moved) => Some((moved.source.to_string(), moved.value, moved.presses > 0)),
            Said::Time(_) => None,
        });
        moved.collect()
    }

    #[test]
    fn keys_wheels_and_programs_move() {
        let at = |what: &str, value, is_press| (what.to_owned(), value, is_press);
        assert_eq!(
            moved(&[0x99, 36, 127, 36, 0, 0xe0, 0, 64, 0, 0, 127, 127, 0xc0, 127, 0xd0, 127]),
            [
                at("note 36 on channel 10", 1.0, true),
                at("note 36 on channel 10", 0.0, false),
                at("bend on channel 1", 0.5, false),
                at("bend on channel 1", 0.0, false),
                at("bend on channel 1", 1.0, false),
                at("program on channel 1", 1.0, true),
                at("pressure on channel 1", 1.0, false),
            ]
        );
        assert_eq!(said(&[0xf8]), [Said::Time(Message::Clock)]);
    }

    #[test]
    fn a_button_is_pressed_when_it_rises_past_the_middle() {
        let presses: Vec<bool> =
            moved(&[0xb0, 20, 127, 20, 100, 20, 0, 20, 63, 20, 64]).into_iter().map(|m| m.2).collect();
        assert_eq!(presses, [true, false, false, false, true]);
    }

    #[test]
    fn two_consecutive_numbers_are_one_fine_knob() {
        let fine = |bytes: &[u8]| -> Vec<f32> {
            moved(bytes).into_iter().filter(|m| m.0.starts_with("fine")).map(|m| m.1).collect()
        };
        assert_eq!(fine(&[0xb0, 7, 127, 39, 127]), [1.0]);
        assert_eq!(fine(&[0xb0, 39, 127, 7, 127]), [1.0]);
        // Once a controller is known to have 14 bits, messages for either of its numbers move the control.
        let (up, down) = (f32::from(64_u16 << 7) / 16_383.0, f32::from(64_u16 << 7 | 1) / 16_383.0);
        assert_eq!(fine(&[0xb0, 7, 64, 39, 0, 39, 1])[..], [up, down]);
        // Two separate knobs, with another message in between.
        assert_eq!(fine(&[0xb0, 7, 64, 8, 3, 39, 0]), []);
        assert_eq!(fine(&[0xb0, 70, 64, 102, 0]), []);
    }

    #[test]
    fn repeated_data_increments_are_steps() {
        let steps = |bytes: &[u8]| -> Vec<i32> {
            let moved = said(bytes).into_iter().filter_map(|said| match said {
                Said::Moved(KnobMove { source: Source::Increment { .. }, encoding, steps, .. }) => {
                    assert_eq!(encoding, Some(Encoding::Complement));
                    Some(steps[1])
                }
                _ => None,
            });
            moved.collect()
        };
        assert_eq!(steps(&[0xb0, 96, 127, 96, 127, 97, 127, 97, 127, 97, 127]), [1, -1, -1]);
        // A knob with the number of data increments, and a button.
        assert_eq!(steps(&[0xb0, 96, 60, 96, 61, 96, 62, 97, 127, 97, 0, 97, 127]), []);
    }

    #[test]
    fn the_high_bits_of_a_fine_knob_are_no_encoder() {
        // The high bits are 63 and 65, and the low bits change.
        let bits = |high: u8| (0..9).flat_map(move |low| [7, high, 39, low]);
        let bytes: Vec<u8> = std::iter::once(0xb0).chain(bits(63)).chain(bits(65)).collect();
        let is_encoder = |one: Said| matches!(one, Said::Moved(KnobMove { encoding: Some(_), .. }));
        assert!(!said(&bytes).into_iter().any(is_encoder));
        let coarse: Vec<u8> =
            std::iter::once(0xb0).chain([7, 63].repeat(3)).chain([7, 65].repeat(3)).collect();
        assert!(said(&coarse).into_iter().any(is_encoder), "without low bits the knob is an encoder");
    }
}
