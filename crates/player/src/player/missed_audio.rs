//! Detection of missed audio: parts of the song that were not heard because of device changes.
//!
//! The song does not wait for devices. The segment for the next output, or for the silent clock, is due at the moment
//! at which the output opened. The output's callback drops late frames, so that the sound after a fault matches the
//! image. So the part of the song between the last frame of one device and the first frame of the next device,
//! including the time on the silent clock, was not heard. This part is reported once sound is audible again. Frames in
//! the buffer of a lost device count as heard, because their fate is unknown.
//!
//! If a device merely resumes late, no frame is lost. [`Clock`](crate::clock::Clock) then runs a fifth slower (or
//! faster) until it agrees with the sound. `cargo bench --bench device_faults` counts clock steps in 200 faults.

use std::fmt;
use std::sync::Arc;

use crate::clock::{Audible, SpanHistory};

/// The shortest gap that is reported, in seconds.
const REPORTED_FROM: f64 = 0.05;

/// Missed parts of the song. The [`Display`](fmt::Display) text describes the last missed part.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MissedAudio {
    /// The number of missed parts.
    pub count: u64,
    /// The duration of the last missed part, in seconds.
    pub seconds: f64,
    /// The output that ended the last missed part.
    pub after: SilenceEnd,
}

/// The output that ended a silent part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SilenceEnd {
    /// A different device.
    #[default]
    AnotherDevice,
    /// The same device, which had failed or stopped requesting samples.
    SameDevice,
}

impl fmt::Display for MissedAudio {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let decimals = if self.seconds < 1.0 { 2 } else { 1 };
        let why = match self.after {
            SilenceEnd::AnotherDevice => "the sound device changed",
            SilenceEnd::SameDevice => "the sound device had stopped and was opened again",
        };
        write!(f, "{:.decimals$} s of the song were not heard: {why}", self.seconds)
    }
}

#[derive(Default)]
pub(super) struct MissedAudioWatch {
    history: Option<Arc<SpanHistory>>,
    /// Seconds of the song since the last sound; `None` before the first sound.
    pending: Option<f64>,
    device: Option<String>,
    pub(super) reported: MissedAudio,
}

impl MissedAudioWatch {
    /// `carry` maps a frame of an earlier segment to a later segment, unless a seek or another track separates the two.
    pub(super) fn update(
        &mut self,
        history: &Arc<SpanHistory>,
        carry: impl FnOnce(Audible, u64) -> Option<f64>,
    ) {
        if self.history.as_ref().is_some_and(|before| Arc::ptr_eq(before, history)) {
            return;
        }
        if let Some(before) = self.history.replace(history.clone()) {
            let gap = before.end().zip(history.first()).and_then(|(end, first)| {
                Some((first.frame - carry(end, first.segment)?) / f64::from(history.rate()))
            });
            let gap = gap.map_or(0.0, |seconds| seconds.max(0.0));
            let silent = if before.device().is_none() { before.moved() } else { 0.0 };
            let heard_before = self.pending.is_some() || before.device().is_some();
            self.pending = heard_before.then(|| self.pending.unwrap_or(0.0) + silent + gap);
        }
        let Some(device) = history.device() else { return };
        let before = self.device.replace(device.to_owned());
        if let Some(seconds) = self.pending.replace(0.0).filter(|seconds| *seconds >= REPORTED_FROM) {
            let after =
                if before == self.device { SilenceEnd::SameDevice } else { SilenceEnd::AnotherDevice };
            self.reported = MissedAudio { count: self.reported.count + 1, seconds, after };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clock::{Span, SpanWriter};

    fn output(segment: u64, frame: u64, frames: u32, moving: bool) -> (SpanWriter, Arc<SpanHistory>) {
        let (mut writer, history) = SpanHistory::new(1000);
        writer.push(Span { start_ns: 0, segment, frame, frames, moving });
        (writer, history)
    }

    fn together(from: Audible, _: u64) -> Option<f64> {
        Some(from.frame)
    }

    #[test]
    fn missed_audio_is_reported_once_there_is_sound_again() {
        let mut watch = MissedAudioWatch::default();
        let (_first, first) = output(1, 0, 2000, true);
        let (_silent, silent) = output(2, 2100, 1000, true);
        let (_second, second) = output(3, 3300, 2000, true);
        first.set_device("speakers");
        second.set_device("headphones");
        watch.update(&first, together);
        watch.update(&silent, together);
        assert_eq!(watch.reported.count, 0);
        watch.update(&second, together);
        watch.update(&second, together);
        assert_eq!(watch.reported.count, 1);
        assert_eq!(watch.reported.to_string(), "1.3 s of the song were not heard: the sound device changed");
        // A change without a gap, during a pause or with a seek loses no frame.
        let (_third, third) = output(4, 5320, 500, false);
        let (_fourth, fourth) = output(5, 5320, 500, true);
        let (_fifth, fifth) = output(6, 90_000, 500, true);
        [&third, &fourth, &fifth].iter().for_each(|history| history.set_device("headphones"));
        watch.update(&third, together);
        watch.update(&fourth, together);
        watch.update(&fifth, |_, _| None);
        assert_eq!(watch.reported.count, 1);
    }

    #[test]
    fn a_song_that_begins_without_a_device_misses_nothing() {
        let mut watch = MissedAudioWatch::default();
        let (_silent, silent) = output(1, 0, 1000, true);
        let (_first, first) = output(2, 1500, 1000, true);
        first.set_device("speakers");
        watch.update(&silent, together);
        watch.update(&first, together);
        assert_eq!(watch.reported, MissedAudio::default());
    }

    #[test]
    fn a_stopped_device_is_reported_as_stopped() {
        let mut watch = MissedAudioWatch::default();
        let (_first, first) = output(1, 0, 2000, true);
        let (_silent, silent) = output(2, 2000, 3200, true);
        let (_second, second) = output(3, 5200, 2000, true);
        first.set_device("speakers");
        second.set_device("speakers");
        watch.update(&first, together);
        watch.update(&silent, together);
        watch.update(&second, together);
        assert_eq!(
            watch.reported.to_string(),
            "3.2 s of the song were not heard: the sound device had stopped and was opened again"
        );
    }
}
