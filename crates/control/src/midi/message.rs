//! Parser of MIDI bytes (MIDI 1.0, "Detailed Specification" 4.2).

use super::source::Source;

/// A supported message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Message {
    /// A control sent a value: 0..=16383 of the pitch bend wheel, where 8192 is at rest, and 0..=127 of other controls.
    /// A key sends its velocity, 0 when it is released; a program change sends the program's number.
    Moved(Source, u16),
    /// A clock message, 24 per beat.
    Clock,
    /// The song starts from its beginning at the next clock message.
    Start,
    /// The song continues from its current position at the next clock message.
    Continue,
    /// The song stops.
    Stop,
    /// The song position, in sixteenth notes from the beginning.
    Position(u16),
}

const SONG_POSITION: u8 = 0xf2;

/// A parser for MIDI bytes in pieces of any size. The parser handles running status and real-time bytes inside other
/// messages. The parser skips system-exclusive messages.
#[derive(Debug, Clone, Default)]
pub struct Parser {
    /// The status byte in force. Without one, data bytes are ignored.
    status: Option<u8>,
    data: [u8; 2],
    held: usize,
}

impl Parser {
    /// Takes the next byte. Returns the message that this byte completes, if any.
    pub fn push(&mut self, byte: u8) -> Option<Message> {
        match byte {
            // Real-time bytes do not affect the message around them.
            0xf8 => Some(Message::Clock),
            0xfa => Some(Message::Start),
            0xfb => Some(Message::Continue),
            0xfc => Some(Message::Stop),
            0xf9 | 0xfd..=0xff => None,
            0x80..=0xf7 => {
                (self.held, self.status) = (0, Some(byte));
                None
            }
            0..=0x7f => self.push_data(byte),
        }
    }

    fn push_data(&mut self, byte: u8) -> Option<Message> {
        let status = self.status?;
        let count = match status {
            0xc0..=0xdf => 1,
            0x80..=0xef | SONG_POSITION => 2,
            _ => return None,
        };
        if let Some(place) = self.data.get_mut(self.held) {
            *place = byte;
        }
        self.held += 1;
        if self.held < count {
            return None;
        }
        self.held = 0;
        // After any other message, the next one may follow without a status byte.
        self.status = self.status.filter(|status| *status != SONG_POSITION);
        message(status, self.data)
    }
}

fn message(status: u8, [first, second]: [u8; 2]) -> Option<Message> {
    let channel = status & 0xf;
    let wide = u16::from(second) << 7 | u16::from(first);
    let (source, value) = match status {
        0x80..=0x8f => (Source::Note { channel, key: first }, 0),
        0x90..=0x9f => (Source::Note { channel, key: first }, u16::from(second)),
        0xb0..=0xbf => (Source::Control { channel, number: first }, u16::from(second)),
        0xc0..=0xcf => (Source::Program { channel }, u16::from(first)),
        0xd0..=0xdf => (Source::Pressure { channel }, u16::from(first)),
        0xe0..=0xef => (Source::Bend { channel }, wide),
        SONG_POSITION => return Some(Message::Position(wide)),
        // Polyphonic key pressure is not supported.
        _ => return None,
    };
    Some(Message::Moved(source, value))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn parsed(bytes: &[u8]) -> Vec<Message> {
        let mut parser = Parser::default();
        bytes.iter().filter_map(|byte| parser.push(*byte)).collect()
    }

    fn control(number: u8, value: u16) -> Message {
        Message::Moved(Source::Control { channel: 2, number }, value)
    }

    #[test]
    fn every_kind_of_message_is_read() {
        assert_eq!(
            parsed(&[
                0x95, 60, 100, 0x85, 60, 64, 0xb2, 7, 127, 0xe0, 0, 64, 0xc3, 9, 0xd1, 55, 0xa0, 60, 5, 0xf8,
                0xfa, 0xfb, 0xfc, 0xf2, 1, 2,
            ]),
            [
                Message::Moved(Source::Note { channel: 5, key: 60 }, 100),
                Message::Moved(Source::Note { channel: 5, key: 60 }, 0),
                control(7, 127),
                Message::Moved(Source::Bend { channel: 0 }, 8192),
                Message::Moved(Source::Program { channel: 3 }, 9),
                Message::Moved(Source::Pressure { channel: 1 }, 55),
                Message::Clock,
                Message::Start,
                Message::Continue,
                Message::Stop,
                Message::Position(257),
            ]
        );
    }

    #[test]
    fn running_status_and_clocks_inside_messages_are_handled() {
        assert_eq!(parsed(&[0xb2, 7, 1, 7, 2, 10, 3]), [control(7, 1), control(7, 2), control(10, 3)]);
        assert_eq!(parsed(&[0xb2, 7, 0xf8, 1]), [Message::Clock, control(7, 1)]);
        // A song position ends running status. Data bytes after a song position are ignored.
        assert_eq!(parsed(&[0xb2, 7, 1, 0xf2, 0, 0, 7, 2]), [control(7, 1), Message::Position(0)]);
    }

    #[test]
    fn data_without_status_and_incomplete_messages_are_ignored() {
        assert_eq!(parsed(&[1, 2, 3, 0xb2, 7, 0xb2, 8, 9]), [control(8, 9)]);
        assert_eq!(parsed(&[0xb2, 7]), []);
        assert_eq!(parsed(&[0xf4, 1, 0xf5, 2, 0xf6, 0xf1, 3, 0xf3, 4]), []);
    }

    #[test]
    fn system_exclusive_messages_are_skipped_but_not_clocks_inside_them() {
        let mut parser = Parser::default();
        assert_eq!(parser.push(0xf0), None);
        for number in 0..1_000_000_u32 {
            let expected = (number % 1_000 == 0).then_some(Message::Clock);
            assert_eq!(expected.and_then(|_| parser.push(0xf8)), expected);
            assert_eq!(parser.push((number % 128) as u8), None);
        }
        assert_eq!(std::mem::size_of::<Parser>(), std::mem::size_of_val(&parser), "the parser must not grow");
        let after: Vec<_> = [0xf7, 0xb2, 7, 1].into_iter().filter_map(|byte| parser.push(byte)).collect();
        assert_eq!(after, [control(7, 1)]);
        // A new status byte ends an unterminated message.
        assert_eq!(parsed(&[0xf0, 1, 2, 0xb2, 7, 1]), [control(7, 1)]);
    }

    fn written(messages: &[Message], running: bool) -> Vec<u8> {
        let (mut bytes, mut last) = (Vec::new(), None);
        for message in messages {
            let (status, data): (u8, Vec<u8>) = match *message {
                Message::Moved(Source::Note { channel, key }, value) => {
                    (0x90 | channel, vec![key, value as u8])
                }
                Message::Moved(Source::Control { channel, number }, value) => {
                    (0xb0 | channel, vec![number, value as u8])
                }
                Message::Moved(Source::Bend { channel }, value) => {
                    (0xe0 | channel, vec![(value & 0x7f) as u8, (value >> 7) as u8])
                }
                Message::Moved(Source::Program { channel }, value) => (0xc0 | channel, vec![value as u8]),
                Message::Moved(Source::Pressure { channel }, value) => (0xd0 | channel, vec![value as u8]),
                Message::Moved(other, _) => panic!("no message moves {other}"),
                Message::Clock => (0xf8, vec![]),
                Message::Start => (0xfa, vec![]),
                Message::Continue => (0xfb, vec![]),
                Message::Stop => (0xfc, vec![]),
                Message::Position(place) => (0xf2, vec![(place & 0x7f) as u8, (place >> 7) as u8]),
            };
            if !running || last != Some(status) {
                bytes.push(status);
            }
            if status < 0xf8 {
                last = (status < 0xf0).then_some(status);
            }
            bytes.extend(data);
        }
        bytes
    }

    fn any_message() -> impl Strategy<Value = Message> {
        let (channel, seven, value) = (0_u8..16, 0_u8..128, 0_u16..128);
        prop_oneof![
            (channel.clone(), seven.clone(), value.clone())
                .prop_map(|(channel, key, value)| Message::Moved(Source::Note { channel, key }, value)),
            (channel.clone(), seven, value.clone()).prop_map(|(channel, number, value)| Message::Moved(
                Source::Control { channel, number },
                value
            )),
            (channel.clone(), 0_u16..16_384)
                .prop_map(|(channel, value)| Message::Moved(Source::Bend { channel }, value)),
            (channel.clone(), value.clone())
                .prop_map(|(channel, value)| Message::Moved(Source::Program { channel }, value)),
            (channel, value).prop_map(|(channel, value)| Message::Moved(Source::Pressure { channel }, value)),
            Just(Message::Clock),
            Just(Message::Start),
            Just(Message::Stop),
            Just(Message::Continue),
            (0_u16..16_384).prop_map(Message::Position),
        ]
    }

    proptest! {
        #[test]
        fn written_messages_are_read_back(
            messages in proptest::collection::vec(any_message(), 0..40),
            running in any::<bool>(),
            clocks in proptest::collection::vec(0_usize..120, 0..8),
        ) {
            let mut bytes = written(&messages, running);
            prop_assert_eq!(&parsed(&bytes), &messages);
            for place in clocks {
                bytes.insert(place.min(bytes.len()), 0xfe);
            }
            prop_assert_eq!(&parsed(&bytes), &messages);
        }

        #[test]
        fn any_bytes_give_messages_within_their_ranges(
            bytes in proptest::collection::vec(any::<u8>(), 0..600),
        ) {
            for message in parsed(&bytes) {
                let is_sound = match message {
                    Message::Moved(
                        Source::Note { channel, key: number } | Source::Control { channel, number },
                        value,
                    ) => channel < 16 && number < 128 && value < 128,
                    Message::Moved(Source::Bend { channel }, value) => channel < 16 && value < 16_384,
                    Message::Moved(Source::Program { channel } | Source::Pressure { channel }, value) => {
                        channel < 16 && value < 128
                    }
                    Message::Moved(..) => false,
                    Message::Position(place) => place < 16_384,
                    Message::Clock | Message::Start | Message::Stop | Message::Continue => true,
                };
                prop_assert!(is_sound, "{message:?}");
            }
        }
    }
}
