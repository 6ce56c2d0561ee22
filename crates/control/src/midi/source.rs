//! The controls of a MIDI device, and their text form in files.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::encoding::Encoding;

/// A control on a device. Channels count from 0 here and from 1 in the text form.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum Source {
    /// A key or pad.
    Note {
        /// 0..=15.
        channel: u8,
        /// 0..=127.
        key: u8,
    },
    /// A knob or fader with 128 steps.
    Control {
        /// 0..=15.
        channel: u8,
        /// 0..=127.
        number: u8,
    },
    /// A knob or fader with 16384 steps, sent as two controllers: `number` and `number + 32`.
    FineControl {
        /// 0..=15.
        channel: u8,
        /// 0..=31.
        number: u8,
    },
    /// An endless knob that sends its steps as data increments and decrements (controllers 96 and 97).
    Increment {
        /// 0..=15.
        channel: u8,
    },
    /// The pitch bend wheel.
    Bend {
        /// 0..=15.
        channel: u8,
    },
    /// The program changes of a channel.
    Program {
        /// 0..=15.
        channel: u8,
    },
    /// The pressure on the keys of a channel.
    Pressure {
        /// 0..=15.
        channel: u8,
    },
}

impl Source {
    /// True if the control is pressed rather than turned.
    pub fn is_pressed(self) -> bool {
        matches!(self, Self::Note { .. } | Self::Program { .. })
    }
}

impl Display for Source {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let (what, channel) = match *self {
            Self::Note { channel, key } => (format!("note {key}"), channel),
            Self::Control { channel, number } => (format!("cc {number}"), channel),
            Self::FineControl { channel, number } => (format!("fine cc {number}"), channel),
            Self::Increment { channel } => ("increment".to_owned(), channel),
            Self::Bend { channel } => ("bend".to_owned(), channel),
            Self::Program { channel } => ("program".to_owned(), channel),
            Self::Pressure { channel } => ("pressure".to_owned(), channel),
        };
        write!(f, "{what} on channel {}", channel + 1)
    }
}

/// The error for a text that is not the name of a control.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "'{0}' is not a MIDI control; write it as 'cc 7 on channel 1', 'fine cc 7 ...', 'increment ...', 'note 36 ...', 'bend ...', 'program ...' or 'pressure ...'"
)]
pub struct NoSource(String);

impl FromStr for Source {
    type Err = NoSource;

    fn from_str(text: &str) -> Result<Self, NoSource> {
        let wrong = || NoSource(text.chars().take(60).collect());
        let (what, channel) = text.split_once(" on channel ").ok_or_else(wrong)?;
        let number = |text: &str, most: u8| {
            text.trim().parse::<u8>().ok().filter(|number| *number <= most).ok_or_else(wrong)
        };
        let channel = number(channel, 16)?.checked_sub(1).ok_or_else(wrong)?;
        let (kind, at) = match what.trim().rsplit_once(' ') {
            Some((kind, at)) => (kind.trim(), Some(at)),
            None => (what.trim(), None),
        };
        match (kind, at) {
            ("note", Some(key)) => Ok(Self::Note { channel, key: number(key, 127)? }),
            ("cc", Some(at)) => Ok(Self::Control { channel, number: number(at, 127)? }),
            ("fine cc", Some(at)) => Ok(Self::FineControl { channel, number: number(at, 31)? }),
            ("increment", None) => Ok(Self::Increment { channel }),
            ("bend", None) => Ok(Self::Bend { channel }),
            ("program", None) => Ok(Self::Program { channel }),
            ("pressure", None) => Ok(Self::Pressure { channel }),
            _ => Err(wrong()),
        }
    }
}

impl From<Source> for String {
    fn from(source: Source) -> Self {
        source.to_string()
    }
}

impl TryFrom<String> for Source {
    type Error = NoSource;

    fn try_from(text: String) -> Result<Self, NoSource> {
        text.parse()
    }
}

/// The movement of a control since the last frame.
#[derive(Debug, Clone, PartialEq)]
pub struct KnobMove {
    /// The device's name.
    pub device: Arc<str>,
    /// The control.
    pub source: Source,
    /// The current value, 0..1.
    pub value: f32,
    /// The smallest and the largest value since the last frame.
    pub way: [f32; 2],
    /// The number of presses. A key or pad counts when it is pressed, a knob or button when it rises past the middle.
    pub presses: u32,
    /// The steps since the last frame, read in each of [`Encoding::OF_STEPS`].
    pub steps: [i32; 3],
    /// The encoding of steps if the control is known to be an encoder.
    pub encoding: Option<Encoding>,
}

impl KnobMove {
    /// Returns a movement with a single value.
    pub fn to(device: Arc<str>, source: Source, value: f32, is_press: bool) -> Self {
        let sent = (127.0 * value).round() as u8;
        let steps = Encoding::OF_STEPS.map(|encoding| encoding.steps(sent));
        let presses = u32::from(is_press);
        Self { device, source, value, way: [value; 2], presses, steps, encoding: None }
    }

    /// Returns the steps since the last frame in this encoding; 0 for [`Encoding::Absolute`].
    pub fn steps(&self, encoding: Encoding) -> i32 {
        let mut all = Encoding::OF_STEPS.into_iter().zip(self.steps);
        all.find(|(one, _)| *one == encoding).map_or(0, |(_, steps)| steps)
    }

    /// Merges a later movement of the same control.
    pub(crate) fn merge(&mut self, later: &Self) {
        let ([least, most], [low, high]) = (self.way, later.way);
        (self.value, self.way) = (later.value, [least.min(low), most.max(high)]);
        self.presses = self.presses.saturating_add(later.presses);
        for (steps, more) in self.steps.iter_mut().zip(later.steps) {
            *steps = steps.saturating_add(more);
        }
        self.encoding = later.encoding;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_are_read_back() {
        let channel = 15;
        for source in [
            Source::Note { channel, key: 127 },
            Source::Control { channel: 0, number: 0 },
            Source::FineControl { channel, number: 31 },
            Source::Increment { channel },
            Source::Bend { channel },
            Source::Program { channel },
            Source::Pressure { channel },
        ] {
            assert_eq!(source.to_string().parse(), Ok(source));
        }
        assert_eq!(Source::Control { channel: 0, number: 7 }.to_string(), "cc 7 on channel 1");
    }

    #[test]
    fn texts_that_name_no_control_are_refused() {
        for text in [
            "",
            "cc 7",
            "cc 7 on channel 0",
            "cc 7 on channel 17",
            "cc 128 on channel 1",
            "fine cc 32 on channel 1",
            "bend 3 on channel 1",
            "increment 96 on channel 1",
            "cc on channel 1",
            "knob 3 on channel 1",
        ] {
            assert!(text.parse::<Source>().is_err(), "{text}");
        }
    }
}
