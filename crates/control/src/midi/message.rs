//! Parser of MIDI bytes (MIDI 1.0, "Detailed Specification" 4.2).

/// A supported message. Channels count from 0, as in the bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Message {
    /// A key is pressed, or released if the velocity is 0.
    Note {
        /// 0..=15.
        channel: u8,
        /// 0..=127; 60 is middle C.
        key: u8,
        /// 0..=127.
        velocity: u8,
    },
    /// A knob, fader or pedal.
    Control {
        /// 0..=15.
        channel: u8,
        /// 0..=127.
        number: u8,
        /// 0..=127.
        value: u8,
    },
    /// The pitch bend wheel.
    Bend {
        /// 0..=15.
        channel: u8,
        /// 0..=16383; 8192 at rest.
        value: u16,
    },
    /// A program change.
    Program {
        /// 0..=15.
        channel: u8,
        /// 0..=127.
        number: u8,
    },
    /// The pressure on the keys of a channel.
    Pressure {
        /// 0..=15.
        channel: u8,
        /// 0..=127.
        value: u8,
    },
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

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Expects {
    /// No status byte is in force, so data bytes are ignored.
    #[default]
    Nothing,
    /// Collects `count` data bytes of `status`. If `runs` is true, another message may follow without a status byte.
    Data { status: u8, count: usize, runs: bool },
}

/// A parser for MIDI bytes in pieces of any size. The parser handles running status and real-time bytes inside other
/// messages. The parser skips system-exclusive messages.
#[derive(Debug, Clone, Default)]
pub struct Parser {
    expects: Expects,
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
                self.held = 0;
                self.expects = expects(byte);
                None
            }
            0..=0x7f => self.push_data(byte),
        }
    }

    fn push_data(&mut self, byte: u8) -> Option<Message> {
        let Expects::Data { status, count, runs } = self.expects else { return None };
        if let Some(place) = self.data.get_mut(self.held) {
            *place = byte;
        }
        self.held += 1;
        if self.held < count {
            return None;
        }
        self.held = 0;
        if !runs {
            self.expects = Expects::Nothing;
        }
        message(status, self.data)
    }
}

fn expects(status: u8) -> Expects {
    match status {
        0xc0..=0xdf => Expects::Data { status, count: 1, runs: true },
        0x80..=0xef => Expects::Data { status, count: 2, runs: true },
        0xf2 => Expects::Data { status, count: 2, runs: false },
        _ => Expects::Nothing,
    }
}

fn message(status: u8, [first, second]: [u8; 2]) -> Option<Message> {
    let channel = status & 0xf;
    let wide = u16::from(second) << 7 | u16::from(first);
    match status {
        0x80..=0x8f => Some(Message::Note { channel, key: first, velocity: 0 }),
        0x90..=0x9f => Some(Message::Note { channel, key: first, velocity: second }),
        0xb0..=0xbf => Some(Message::Control { channel, number: first, value: second }),
        0xc0..=0xcf => Some(Message::Program { channel, number: first }),
        0xd0..=0xdf => Some(Message::Pressure { channel, value: first }),
        0xe0..=0xef => Some(Message::Bend { channel, value: wide }),
        0xf2 => Some(Message::Position(wide)),
        // Polyphonic key pressure is not supported.
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn parsed(bytes: &[u8]) -> Vec<Message> {
        let mut parser = Parser::default();
        bytes.iter().filter_map(|byte| parser.push(*byte)).collect()
    }

    fn control(number: u8, value: u8) -> Message {
        Message::Control { channel: 2, number, value }
    }

    #[test]
    fn every_kind_of_message_is_read() {
        assert_eq!(
            parsed(&[
                0x95, 60, 100, 0x85, 60, 64, 0xb2, 7, 127, 0xe0, 0, 64, 0xc3, 9, 0xd1, 55, 0xa0, 60, 5, 0xf8,
                0xfa, 0xfb, 0xfc, 0xf2, 1, 2,
            ]),
            [
                Message::Note { channel: 5, key: 60, velocity: 100 },
                Message::Note { channel: 5, key: 60, velocity: 0 },
                control(7, 127),
                Message::Bend { channel: 0, value: 8192 },
                Message::Program { channel: 3, number: 9 },
                Message::Pressure { channel: 1, value: 55 },
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
                Message::Note { channel, key, velocity } => (0x90 | channel, vec![key, velocity]),
                Message::Control { channel, number, value } => (0xb0 | channel, vec![number, value]),
                Message::Bend { channel, value } => {
                    (0xe0 | channel, vec![(value & 0x7f) as u8, (value >> 7) as u8])
                }
                Message::Program { channel, number } => (0xc0 | channel, vec![number]),
                Message::Pressure { channel, value } => (0xd0 | channel, vec![value]),
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
        let (channel, seven) = (0_u8..16, 0_u8..128);
        prop_oneof![
            (channel.clone(), seven.clone(), seven.clone())
                .prop_map(|(channel, key, velocity)| Message::Note { channel, key, velocity }),
            (channel.clone(), seven.clone(), seven.clone())
                .prop_map(|(channel, number, value)| Message::Control { channel, number, value }),
            (channel.clone(), 0_u16..16_384).prop_map(|(channel, value)| Message::Bend { channel, value }),
            (channel.clone(), seven.clone())
                .prop_map(|(channel, number)| Message::Program { channel, number }),
            (channel, seven).prop_map(|(channel, value)| Message::Pressure { channel, value }),
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
                    Message::Note { channel, key: a, velocity: b }
                    | Message::Control { channel, number: a, value: b } => channel < 16 && a < 128 && b < 128,
                    Message::Bend { channel, value } => channel < 16 && value < 16_384,
                    Message::Program { channel, number: a } | Message::Pressure { channel, value: a } => {
                        channel < 16 && a < 128
                    }
                    Message::Position(place) => place < 16_384,
                    Message::Clock | Message::Start | Message::Stop | Message::Continue => true,
                };
                prop_assert!(is_sound, "{message:?}");
            }
        }
    }
}
