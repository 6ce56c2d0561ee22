//! MIDI clock, 24 messages a beat, converted to tempo, phase and position in the bar.

use std::collections::VecDeque;

use super::message::Message;

const PER_BEAT: u64 = 24;
/// Clock messages per sixteenth note, the unit of song positions.
const PER_SIXTEENTH: u64 = 6;
/// Beats per bar. MIDI clock carries no time signature.
const BEATS_IN_BAR: u64 = 4;
/// The number of clock messages in the least-squares fit: two beats.
const FITTED_MAX: usize = 48;
/// The number of clock messages needed for a tempo.
const FITTED_MIN: usize = 6;
/// The clock restarts after this many seconds without a message. At 5 beats a minute, messages are this far apart.
const PAUSE: f64 = 0.5;
/// A clock message further from the fitted line than this, in seconds, may belong to a new tempo.
const OFF: f64 = 0.006;

/// Follows the MIDI clock of one device. Times are in seconds since any fixed moment.
#[derive(Debug, Clone, Default)]
pub struct MidiClock {
    /// Numbers and times of the last clock messages.
    clocks: VecDeque<(u64, f64)>,
    count: u64,
    /// The number of a clock message and the song position at it, in clock messages; `None` before the song starts.
    place: Option<(u64, u64)>,
    /// The song position while the song is stopped, in clock messages.
    stands_at: Option<u64>,
    /// The number of consecutive clock messages that deviate from the fitted line.
    off: usize,
}

/// The tempo and song position, extrapolated from the last clock messages.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockReading {
    /// Beats per minute.
    pub tempo: f64,
    /// The time at which the song is at `beat`, in seconds.
    origin: f64,
    /// The song position at `origin`, in beats from the start of the song.
    beat: f64,
    /// True if the song is stopped.
    stands: bool,
    /// True if the position in the song is known.
    pub knows_bar: bool,
    /// The time of the last clock message, in seconds.
    last: f64,
}

impl MidiClock {
    /// Processes a message that arrived at `time`. Other kinds of messages are ignored.
    pub fn process(&mut self, message: Message, time: f64) {
        match message {
            Message::Clock => self.tick(time),
            Message::Start => {
                (self.place, self.stands_at) = (Some((self.count, 0)), None);
            }
            Message::Continue => {
                let at = self.stands_at.take().or_else(|| self.place_of(self.count)).unwrap_or(0);
                self.place = Some((self.count, at));
            }
            Message::Stop => {
                self.stands_at = Some(self.place_of(self.count.saturating_sub(1)).unwrap_or(0));
            }
            Message::Position(sixteenths) => {
                let at = u64::from(sixteenths) * PER_SIXTEENTH;
                match self.stands_at.is_some() || self.place.is_none() {
                    true => self.stands_at = Some(at),
                    false => self.place = Some((self.count, at)),
                }
            }
            _ => {}
        }
    }

    fn tick(&mut self, time: f64) {
        if !time.is_finite() {
            return;
        }
        if self.clocks.back().is_some_and(|(_, last)| !(0.0..PAUSE).contains(&(time - last))) {
            self.clocks.clear();
        }
        let is_off = self
            .line()
            .is_some_and(|(origin, period)| (time - (origin + self.count as f64 * period)).abs() > OFF);
        self.off = if is_off { self.off + 1 } else { 0 };
        if self.off >= 3 {
            // One late message is jitter; three in a row are a new tempo.
            self.clocks.drain(..self.clocks.len().saturating_sub(3));
            self.off = 0;
        }
        if self.clocks.len() == FITTED_MAX {
            self.clocks.pop_front();
        }
        self.clocks.push_back((self.count, time));
        self.count += 1;
    }

    /// Returns the current reading; `None` until enough clock messages have arrived.
    pub fn reading(&self) -> Option<ClockReading> {
        let (origin, period) = self.line()?;
        let (number, last) = *self.clocks.back()?;
        let place = self.stands_at.or_else(|| self.place_of(number)).unwrap_or(number);
        Some(ClockReading {
            tempo: 60.0 / (period * PER_BEAT as f64),
            origin: origin + number as f64 * period,
            beat: place as f64 / PER_BEAT as f64,
            stands: self.stands_at.is_some(),
            knows_bar: self.place.is_some() || self.stands_at.is_some(),
            last,
        })
    }

    /// Returns the song position at a clock message, in clock messages.
    fn place_of(&self, number: u64) -> Option<u64> {
        let (of, place) = self.place?;
        Some((place + number).saturating_sub(of))
    }

    /// Fits a least-squares line to the last clock messages. Returns the time of message 0 and the time per message.
    fn line(&self) -> Option<(f64, f64)> {
        if self.clocks.len() < FITTED_MIN {
            return None;
        }
        let count = self.clocks.len() as f64;
        let sum = |of: &dyn Fn(&(u64, f64)) -> f64| self.clocks.iter().map(of).sum::<f64>();
        let (x, y) = (sum(&|clock| clock.0 as f64) / count, sum(&|clock| clock.1) / count);
        let products = sum(&|clock| (clock.0 as f64 - x) * (clock.1 - y));
        let squares = sum(&|clock| (clock.0 as f64 - x).powi(2));
        let period = products / squares;
        (period > 0.0).then_some((y - x * period, period))
    }
}

impl ClockReading {
    /// Returns the song position at `time` in beats, or `None` if clock messages no longer arrive.
    pub fn beat_at(&self, time: f64) -> Option<f64> {
        if time - self.last > PAUSE {
            return None;
        }
        let since = if self.stands { 0.0 } else { (time - self.origin) * self.tempo / 60.0 };
        Some((self.beat + since).max(0.0))
    }

    /// Returns the phase between two beats, 0..1, and the index of the beat in the bar.
    pub fn phase_at(&self, time: f64) -> Option<(f32, u32)> {
        let beat = self.beat_at(time)?;
        let phase = beat.fract() as f32;
        let number = (beat as u64 % BEATS_IN_BAR) as u32;
        Some((if phase < 1.0 { phase } else { 0.0 }, number))
    }

    /// Beats per bar.
    pub const BEATS: u32 = BEATS_IN_BAR as u32;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(clock: &mut MidiClock, tempo: f64, start: f64, count: u32) -> f64 {
        let period = 60.0 / tempo / 24.0;
        for number in 0..count {
            let off = [0.0, 0.0004, -0.0006, 0.0002, -0.0001][number as usize % 5];
            clock.process(Message::Clock, start + f64::from(number) * period + off);
        }
        start + f64::from(count) * period
    }

    #[test]
    fn tempo_phase_and_bar_follow_the_clock() {
        let mut clock = MidiClock::default();
        clock.process(Message::Start, 9.9);
        run(&mut clock, 120.0, 10.0, 24 * 5 + 1);
        let reading = clock.reading().unwrap();
        assert!((reading.tempo - 120.0).abs() < 0.1, "{}", reading.tempo);
        // After five beats, the song is at the second beat of the second bar.
        let (phase, number) = reading.phase_at(12.5 + 0.125).unwrap();
        assert!((phase - 0.25).abs() < 0.01 && number == 1 && reading.knows_bar, "{phase} {number}");
        assert_eq!(reading.phase_at(20.0), None, "the clock has stopped");
    }

    #[test]
    fn without_a_start_there_is_a_tempo_and_no_bar() {
        let mut clock = MidiClock::default();
        run(&mut clock, 90.0, 0.0, 5);
        assert_eq!(clock.reading(), None, "too few clock messages");
        run(&mut clock, 90.0, 5.0 * 60.0 / 90.0 / 24.0, 40);
        let reading = clock.reading().unwrap();
        assert!((reading.tempo - 90.0).abs() < 0.2 && !reading.knows_bar);
    }

    #[test]
    fn a_stopped_song_continues_from_its_position_or_a_new_one() {
        let mut clock = MidiClock::default();
        clock.process(Message::Start, 0.0);
        let next = run(&mut clock, 120.0, 0.0, 24 * 2 + 13);
        clock.process(Message::Stop, next);
        let next = run(&mut clock, 120.0, next, 48);
        let beat = clock.reading().unwrap().beat_at(next).unwrap();
        assert!((beat - 2.5).abs() < 1e-9, "{beat}");
        clock.process(Message::Continue, next);
        let next = run(&mut clock, 120.0, next, 25);
        let beat = clock.reading().unwrap().beat_at(next - 0.5 / 24.0).unwrap();
        assert!((beat - 3.5).abs() < 0.01, "{beat}");
        // 16 sixteenths are one bar: the position is the start of the second bar.
        clock.process(Message::Stop, next);
        clock.process(Message::Position(16), next);
        clock.process(Message::Continue, next);
        clock.process(Message::Clock, next);
        let (phase, number) = clock.reading().unwrap().phase_at(next + 0.01).unwrap();
        assert!(phase < 0.05 && number == 0, "{phase} {number}");
    }

    #[test]
    fn a_new_tempo_is_followed_within_a_beat_and_a_late_clock_ignored() {
        let mut clock = MidiClock::default();
        let next = run(&mut clock, 120.0, 0.0, 96);
        clock.process(Message::Clock, next + 0.009);
        let next = run(&mut clock, 120.0, next + 60.0 / 120.0 / 24.0, 23);
        assert!((clock.reading().unwrap().tempo - 120.0).abs() < 0.5);
        run(&mut clock, 150.0, next, 24);
        let tempo = clock.reading().unwrap().tempo;
        assert!((tempo - 150.0).abs() < 1.0, "{tempo}");
    }

    #[test]
    fn repeated_or_decreasing_times_give_no_tempo() {
        let mut clock = MidiClock::default();
        for _ in 0..100 {
            clock.process(Message::Clock, 1.0);
        }
        assert_eq!(clock.reading(), None);
        clock.process(Message::Clock, f64::NAN);
        clock.process(Message::Clock, -5.0);
        assert_eq!(clock.reading(), None);
    }
}
