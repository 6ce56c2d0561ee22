//! MIDI clock: 24 messages in each beat, from which tempo, phase and the place in the bar follow.

use std::collections::VecDeque;

use super::message::Message;

/// Clocks in a beat.
const PER_BEAT: u64 = 24;
/// Clocks in a sixteenth, in which song positions are counted.
const PER_SIXTEENTH: u64 = 6;
/// Beats in a bar: MIDI clock says nothing of time signatures.
const BEATS_IN_BAR: u64 = 4;
/// Clocks that the line is laid through: two beats.
const FITTED_MAX: usize = 48;
/// Clocks that are needed for a tempo.
const FITTED_MIN: usize = 6;
/// After a pause of so many seconds the clock begins anew: less than 5 beats a minute.
const PAUSE: f64 = 0.5;
/// A clock that is so far from where the line has it, in seconds, belongs to another tempo.
const OFF: f64 = 0.006;

/// Follows the clock of one device. Times are in seconds of any steady clock.
#[derive(Debug, Clone, Default)]
pub struct Clock {
    /// Numbers and times of the last clocks.
    clocks: VecDeque<(u64, f64)>,
    /// Number of the next clock.
    count: u64,
    /// The place in the song of the clock with this number, in clocks; none before a start.
    place: Option<(u64, u64)>,
    /// Where the song stands while it does not run.
    stands_at: Option<u64>,
    /// How many clocks in a row were off.
    off: usize,
}

/// What the clock says, for as long as nothing newer is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockReading {
    /// Beats per minute.
    pub tempo: f64,
    /// The time of a beat, in seconds.
    origin: f64,
    /// The beat at that time, counted from the start of the song.
    beat: f64,
    /// Whether the song stands still.
    stands: bool,
    /// Whether it is known where in the song this is.
    pub knows_bar: bool,
    /// The last clock, in seconds.
    last: f64,
}

impl Clock {
    /// Takes a message that came at `time`. Messages of other kinds are passed over.
    pub fn take(&mut self, message: Message, time: f64) {
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
            // One that is late is chance, three are another tempo.
            self.clocks.drain(..self.clocks.len().saturating_sub(3));
            self.off = 0;
        }
        if self.clocks.len() == FITTED_MAX {
            self.clocks.pop_front();
        }
        self.clocks.push_back((self.count, time));
        self.count += 1;
    }

    /// What is known now; none without a few clocks.
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

    /// The place in the song of a clock, in clocks.
    fn place_of(&self, number: u64) -> Option<u64> {
        let (of, place) = self.place?;
        Some((place + number).saturating_sub(of))
    }

    /// The time of clock 0 and the time between two, by the least-squares line through the last ones.
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
    /// The beat at `time`, counted from the song's start; none if the clock is gone.
    pub fn beat_at(&self, time: f64) -> Option<f64> {
        if time - self.last > PAUSE {
            return None;
        }
        let since = if self.stands { 0.0 } else { (time - self.origin) * self.tempo / 60.0 };
        Some((self.beat + since).max(0.0))
    }

    /// The position between two beats, 0 up to 1, and which beat of its bar it is, from 0; the way through the bar is both
    /// together.
    pub fn phase_at(&self, time: f64) -> Option<(f32, u32)> {
        let beat = self.beat_at(time)?;
        let phase = beat.fract() as f32;
        let number = (beat as u64 % BEATS_IN_BAR) as u32;
        Some((if phase < 1.0 { phase } else { 0.0 }, number))
    }

    /// Beats in a bar.
    pub const BEATS: u32 = BEATS_IN_BAR as u32;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A clock at a tempo from `start` on, with so many clocks, each a little off; returns the time of the next one.
    fn run(clock: &mut Clock, tempo: f64, start: f64, count: u32) -> f64 {
        let period = 60.0 / tempo / 24.0;
        for number in 0..count {
            let off = [0.0, 0.0004, -0.0006, 0.0002, -0.0001][number as usize % 5];
            clock.take(Message::Clock, start + f64::from(number) * period + off);
        }
        start + f64::from(count) * period
    }

    #[test]
    fn tempo_phase_and_bar_follow_the_clock() {
        let mut clock = Clock::default();
        clock.take(Message::Start, 9.9);
        run(&mut clock, 120.0, 10.0, 24 * 5 + 1);
        let reading = clock.reading().unwrap();
        assert!((reading.tempo - 120.0).abs() < 0.1, "{}", reading.tempo);
        // Five beats have gone: it is the second one of the second bar.
        let (phase, number) = reading.phase_at(12.5 + 0.125).unwrap();
        assert!((phase - 0.25).abs() < 0.01 && number == 1 && reading.knows_bar, "{phase} {number}");
        assert_eq!(reading.phase_at(20.0), None, "the clock is gone");
    }

    #[test]
    fn without_a_start_there_is_a_tempo_and_no_bar() {
        let mut clock = Clock::default();
        run(&mut clock, 90.0, 0.0, 5);
        assert_eq!(clock.reading(), None, "too few");
        run(&mut clock, 90.0, 5.0 * 60.0 / 90.0 / 24.0, 40);
        let reading = clock.reading().unwrap();
        assert!((reading.tempo - 90.0).abs() < 0.2 && !reading.knows_bar);
    }

    #[test]
    fn a_song_stands_where_it_stopped_and_goes_on_from_there_or_from_elsewhere() {
        let mut clock = Clock::default();
        clock.take(Message::Start, 0.0);
        let next = run(&mut clock, 120.0, 0.0, 24 * 2 + 13);
        clock.take(Message::Stop, next);
        let next = run(&mut clock, 120.0, next, 48);
        let beat = clock.reading().unwrap().beat_at(next).unwrap();
        assert!((beat - 2.5).abs() < 1e-9, "{beat}");
        clock.take(Message::Continue, next);
        let next = run(&mut clock, 120.0, next, 25);
        let beat = clock.reading().unwrap().beat_at(next - 0.5 / 24.0).unwrap();
        assert!((beat - 3.5).abs() < 0.01, "{beat}");
        // A position of 16 sixteenths is the second bar's start.
        clock.take(Message::Stop, next);
        clock.take(Message::Position(16), next);
        clock.take(Message::Continue, next);
        clock.take(Message::Clock, next);
        let (phase, number) = clock.reading().unwrap().phase_at(next + 0.01).unwrap();
        assert!(phase < 0.05 && number == 0, "{phase} {number}");
    }

    #[test]
    fn another_tempo_is_taken_up_within_a_beat_and_one_late_clock_is_none() {
        let mut clock = Clock::default();
        let next = run(&mut clock, 120.0, 0.0, 96);
        clock.take(Message::Clock, next + 0.009);
        let next = run(&mut clock, 120.0, next + 60.0 / 120.0 / 24.0, 23);
        assert!((clock.reading().unwrap().tempo - 120.0).abs() < 0.5);
        run(&mut clock, 150.0, next, 24);
        let tempo = clock.reading().unwrap().tempo;
        assert!((tempo - 150.0).abs() < 1.0, "{tempo}");
    }

    #[test]
    fn times_that_step_back_or_stand_make_no_tempo() {
        let mut clock = Clock::default();
        for _ in 0..100 {
            clock.take(Message::Clock, 1.0);
        }
        assert_eq!(clock.reading(), None);
        clock.take(Message::Clock, f64::NAN);
        clock.take(Message::Clock, -5.0);
        assert_eq!(clock.reading(), None);
    }
}
