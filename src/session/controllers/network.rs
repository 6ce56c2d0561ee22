//! OSC, as the command line wants it: what is heard, what is answered, and what of the sound is sent.

use std::time::{Duration, Instant};

use crate::clock;
use crate::commands;
use crate::config::ControllerSettings;
use crate::session::waker::Waker;
use mariana_control::osc::{OscReceiver, OscSender, ReceiverState, Sample};
use mariana_control::{Board, InputQueue};
use mariana_field::graph::SoundInput;
use mariana_music::{Features, SongMoment};

/// See the module.
pub(super) struct Network {
    receiver: Option<OscReceiver>,
    sender: Option<OscSender>,
    /// Between two samples.
    interval: Duration,
    /// When the next sample is due.
    sample_due: Instant,
    /// What was told of the receiver, and of the sender.
    reported: (ReceiverState, bool),
    /// What went wrong at the start, until it is told.
    trouble: Option<String>,
}

impl Network {
    /// Starts what the settings ask for.
    pub(super) fn start(
        settings: &ControllerSettings,
        input_queue: &InputQueue,
        board: &Board,
        waker: &Waker,
    ) -> Self {
        let mut trouble = None;
        let mut no_thread = |error: std::io::Error| {
            trouble = Some(format!("OSC is neither heard nor sent: the system gives no thread ({error})"));
        };
        let wake = || {
            let waker = waker.clone();
            move || waker.wake()
        };
        let receiver = settings.osc.clone().and_then(|place| {
            let started = OscReceiver::start(
                place,
                commands::for_controllers(),
                input_queue.clone(),
                board.clone(),
                wake(),
            );
            started.map_err(&mut no_thread).ok()
        });
        let sender = settings.osc_send.clone().and_then(|place| {
            OscSender::start(place, settings.osc_rate, wake()).map_err(&mut no_thread).ok()
        });
        let interval = Duration::try_from_secs_f64(1.0 / settings.osc_rate).unwrap_or_default();
        let reported = (ReceiverState::default(), false);
        Self { receiver, sender, interval, sample_due: clock::now(), reported, trouble }
    }

    /// Whether anybody may ask how the show stands.
    pub(super) fn is_asked(&self) -> bool {
        self.receiver.is_some()
    }

    /// What is new: a sentence, and whether it is bad news.
    pub(super) fn news(&mut self) -> Option<(String, bool)> {
        if let Some(trouble) = self.trouble.take() {
            return Some((trouble, true));
        }
        if let Some(state) =
            self.receiver.as_ref().map(OscReceiver::state).filter(|now| *now != self.reported.0)
        {
            self.reported.0 = state;
            match &self.reported.0 {
                ReceiverState::Opening => {}
                ReceiverState::Open(address) => return Some((format!("OSC is heard on {address}"), false)),
                ReceiverState::Refused(why) => return Some((why.clone(), true)),
            }
        }
        let problem = self.sender.as_ref().and_then(OscSender::problem).filter(|_| !self.reported.1);
        self.reported.1 |= problem.is_some();
        problem.map(|problem| (problem, true))
    }

    /// How it stands with hearing, in words; none if it is not wanted.
    pub(super) fn state(&self) -> Option<String> {
        self.receiver.as_ref().map(|receiver| match receiver.state() {
            ReceiverState::Opening => "the port is being opened".to_owned(),
            ReceiverState::Open(address) => format!("heard on {address}"),
            ReceiverState::Refused(why) => why,
        })
    }

    /// When what is heard is wanted for those outside.
    pub(super) fn sample_due(&self) -> Option<Instant> {
        self.sender.as_ref().map(|_| self.sample_due)
    }

    /// What is heard now, for those outside.
    pub(super) fn note_sound(&mut self, features: &Features, song: &SongMoment, now: Instant) {
        let Some(sender) = self.sender.as_ref().filter(|_| now >= self.sample_due) else { return };
        self.sample_due = now + self.interval;
        sender.put(sample(features, song));
    }
}

/// The addresses of what is sent, in their order.
pub(super) fn sent_addresses() -> impl Iterator<Item = String> {
    sample(&Features::SILENCE, &SongMoment::UNKNOWN).into_iter().map(|(address, _)| address)
}

/// The numbers that scenes read, by their addresses; lists of numbers are one message each.
fn sample(features: &Features, song: &SongMoment) -> Sample {
    let mut sample = vec![
        ("/sound/bands".to_owned(), features.bands.to_vec()),
        ("/sound/chroma".to_owned(), song.chroma.to_vec()),
    ];
    let single = SoundInput::ALL.into_iter().map(SoundInput::name).filter(|name| !name.contains('('));
    let number = |name: &str| features.number(name).or_else(|| song.number(name));
    sample.extend(single.filter_map(|name| Some((format!("/sound/{name}"), vec![number(name)?]))));
    sample
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_that_scenes_read_is_sent_and_fits_one_packet() {
        let features = Features { bass: 0.5, ..Features::SILENCE };
        let sample = sample(&features, &SongMoment::UNKNOWN);
        let single = SoundInput::ALL.iter().filter(|input| !input.name().starts_with("chroma(")).count();
        assert_eq!(sample.len(), single + 2, "a number of the sound has no value here");
        assert!(sample.contains(&("/sound/bass".to_owned(), vec![0.5])));
        let bytes: usize = sample.iter().map(|(name, numbers)| name.len() + 16 + 5 * numbers.len()).sum();
        assert!(bytes < 1_400, "{bytes} bytes are more than a network passes on in one piece");
    }
}
