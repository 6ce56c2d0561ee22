//! OSC, as set on the command line: receives and answers messages, and sends sound values.

use std::time::{Duration, Instant};

use crate::clock;
use crate::commands;
use crate::config::ControllerSettings;
use crate::frame::levels_of;
use crate::session::waker::Waker;
use mariana_control::osc::{OscReceiver, OscSender, ReceiverState, Sample};
use mariana_control::{Board, InputQueue};
use mariana_field::graph::{LevelList, SoundInput};
use mariana_music::{Features, SongMoment};

pub(crate) struct Network {
    pub(super) receiver: Option<OscReceiver>,
    sender: Option<OscSender>,
    interval: Duration,
    sample_due: Instant,
    /// The last reported state of the receiver, and `true` once a problem of the sender was reported.
    reported: (ReceiverState, bool),
}

impl Network {
    pub(super) fn start(
        settings: &ControllerSettings,
        input: &InputQueue,
        board: &Board,
        waker: &Waker,
        news: &mut Vec<(String, bool)>,
    ) -> Self {
        let mut no_thread = |error: std::io::Error| {
            let words = format!("cannot receive or send OSC: the system cannot start a thread ({error})");
            news.push((words, true));
        };
        let receiver = settings.osc.clone().and_then(|place| {
            let started = OscReceiver::start(
                place,
                commands::for_controllers(),
                input.clone(),
                board.clone(),
                waker.waking(),
            );
            started.map_err(&mut no_thread).ok()
        });
        let sender = settings.osc_send.clone().and_then(|place| {
            OscSender::start(place, settings.osc_rate, waker.waking()).map_err(&mut no_thread).ok()
        });
        let interval = Duration::try_from_secs_f64(1.0 / settings.osc_rate).unwrap_or_default();
        let reported = (ReceiverState::default(), false);
        Self { receiver, sender, interval, sample_due: clock::now(), reported }
    }

    /// The next message; `true` for bad news.
    pub(super) fn news(&mut self) -> Option<(String, bool)> {
        if let Some(state) =
            self.receiver.as_ref().map(OscReceiver::state).filter(|now| *now != self.reported.0)
        {
            self.reported.0 = state;
            match &self.reported.0 {
                ReceiverState::Opening => {}
                ReceiverState::Open(address) => return Some((format!("receiving OSC on {address}"), false)),
                ReceiverState::Refused(why) => return Some((why.clone(), true)),
            }
        }
        let problem = self.sender.as_ref().and_then(OscSender::problem).filter(|_| !self.reported.1);
        self.reported.1 |= problem.is_some();
        problem.map(|problem| (problem, true))
    }

    pub(super) fn state(&self) -> Option<String> {
        self.receiver.as_ref().map(|receiver| match receiver.state() {
            ReceiverState::Opening => "opening the port".to_owned(),
            ReceiverState::Open(address) => format!("receiving on {address}"),
            ReceiverState::Refused(why) => why,
        })
    }

    pub(super) fn sample_due(&self) -> Option<Instant> {
        self.sender.as_ref().map(|_| self.sample_due)
    }

    pub(crate) fn publish_sound(&mut self, features: &Features, song: &SongMoment, now: Instant) {
        let Some(sender) = self.sender.as_ref().filter(|_| now >= self.sample_due) else { return };
        self.sample_due = now + self.interval;
        sender.put(sample(features, song));
    }
}

/// The OSC addresses of the messages that the program sends.
pub fn sent_addresses() -> impl Iterator<Item = String> {
    sample(&Features::SILENCE, &SongMoment::UNKNOWN).into_iter().map(|(address, _)| address)
}

/// Returns the sound values that scenes read, each with its OSC address. A list of numbers is one message.
fn sample(features: &Features, song: &SongMoment) -> Sample {
    let list = |list: LevelList| (list.name(), levels_of(list, features, song).to_vec());
    let number = |name: &str| features.number(name).or_else(|| song.number(name));
    let single = SoundInput::ALL.into_iter().map(SoundInput::name);
    let single = single.filter_map(|name| Some((name, vec![number(name)?])));
    let values = LevelList::ALL.into_iter().map(list).chain(single);
    values.map(|(name, values)| (format!("/sound/{name}"), values)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sound_value_is_sent() {
        let features = Features { bass: 0.5, ..Features::SILENCE };
        let sample = sample(&features, &SongMoment::UNKNOWN);
        let values = SoundInput::ALL.len() + LevelList::ALL.len();
        assert_eq!(sample.len(), values, "a sound value is missing in the sample");
        assert!(sample.contains(&("/sound/bass".to_owned(), vec![0.5])));
    }
}
