//! A MIDI device: converts its bytes to knob movements.

use super::message::{Message, Parser};
use super::source::Source;

const CHANNELS: usize = 16;
/// Controllers `n` below this may have 14 bits: then controller `n + 32` sends the low 7 bits.
const FINE: usize = 32;

/// The state of a device, kept from one byte to the next.
#[derive(Debug, Clone)]
pub struct Device {
    parser: Parser,
    channels: [Channel; CHANNELS],
}

#[derive(Debug, Clone, Copy)]
struct Channel {
    /// The last value of each controller number, for detecting presses and 14-bit controllers.
    values: [u8; 128],
    last: Option<u8>,
    /// True for controllers `n` that have sent messages for `n` and `n + 32` in succession, and so have 14 bits.
    is_fine: [bool; FINE],
}

/// A parsed event of a device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Said {
    /// A control moved to a value, 0..1. The flag is true if the movement is a press.
    Moved(Source, f32, bool),
    /// A message of the device's clock.
    Time(Message),
}

impl Default for Device {
    fn default() -> Self {
        let channel = Channel { values: [0; 128], last: None, is_fine: [false; FINE] };
        Self { parser: Parser::default(), channels: [channel; CHANNELS] }
    }
}

impl Device {
    /// Parses bytes and passes the events to `tell`.
    pub fn hear(&mut self, bytes: &[u8], mut tell: impl FnMut(Said)) {
        for byte in bytes {
            if let Some(message) = self.parser.push(*byte) {
                self.take(message, &mut tell);
            }
        }
    }

    fn take(&mut self, message: Message, tell: &mut impl FnMut(Said)) {
        match message {
            Message::Note { channel, key, velocity } => {
                tell(Said::Moved(Source::Note { channel, key }, fraction(velocity), velocity > 0));
            }
            Message::Control { channel, number, value } => self.take_control(channel, number, value, tell),
            Message::Bend { channel, value } => {
                tell(Said::Moved(Source::Bend { channel }, fraction_of_bend(value), false));
            }
            Message::Program { channel, number } => {
                tell(Said::Moved(Source::Program { channel }, fraction(number), true));
            }
            Message::Pressure { channel, value } => {
                tell(Said::Moved(Source::Pressure { channel }, fraction(value), false));
            }
            time @ (Message::Clock
            | Message::Start
            | Message::Continue
            | Message::Stop
            | Message::Position(_)) => tell(Said::Time(time)),
        }
    }

    fn take_control(&mut self, channel: u8, number: u8, value: u8, tell: &mut impl FnMut(Said)) {
        let Some(state) = self.channels.get_mut(usize::from(channel)) else { return };
        let before = state.values.get_mut(usize::from(number)).map(|known| std::mem::replace(known, value));
        let is_press = before.is_some_and(|before| before < 64) && value >= 64;
        tell(Said::Moved(Source::Control { channel, number }, fraction(value), is_press));
        let last = state.last.replace(number);
        // A 14-bit controller sends its high bits with the coarse number and its low bits with the fine number.
        let (coarse, other) = match number {
            0..32 => (number, number + 32),
            32..64 => (number - 32, number - 32),
            _ => return,
        };
        let Some(is_fine) = state.is_fine.get_mut(usize::from(coarse)) else { return };
        *is_fine |= last == Some(other);
        if *is_fine {
            let of = |number: u8| state.values.get(usize::from(number)).copied().unwrap_or_default();
            let value = f32::from(u16::from(of(coarse)) << 7 | u16::from(of(coarse + 32))) / 16_383.0;
            tell(Said::Moved(Source::FineControl { channel, number: coarse }, value, false));
        }
    }
}

fn fraction(value: u8) -> f32 {
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
        let (mut device, mut said) = (Device::default(), Vec::new());
        device.hear(bytes, |one| said.push(one));
        said
    }

    fn moved(bytes: &[u8]) -> Vec<(String, f32, bool)> {
        let moved = said(bytes).into_iter().filter_map(|said| match said {
            Said::Moved(source, value, is_press) => Some((source.to_string(), value, is_press)),
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
}
