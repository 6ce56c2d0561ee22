//! Tap tempo, which overrides the detected tempo.

use super::features::Features;

/// The pause after which a tap starts a new series, in seconds.
const PAUSE: f64 = 2.5;

/// The maximum number of taps in the fit.
const TAPS_MAX: usize = 8;

/// If a tap is off the beat by more than this fraction of a beat, this tap and the previous one set a new tempo.
const OFF: f64 = 0.35;

/// The shortest beat, in seconds. Two taps that are closer than this count as one tap.
const PERIOD_MIN: f64 = 0.15;

/// Tempo and phase from taps. Times are song times in seconds.
#[derive(Clone, Debug, Default)]
pub struct TapTempo {
    taps: Vec<f64>,
    /// The time and duration of a beat, as set by [`TapTempo::set`].
    given: Option<(f64, f64)>,
}

impl TapTempo {
    /// Adds a tap. The second tap sets a tempo, and further taps refine this tempo. A single tap after a pause returns
    /// to the detected tempo. Times that are not finite are ignored.
    pub fn tap(&mut self, time: f64) {
        if !time.is_finite() {
            return;
        }
        if let Some(last) = self.taps.last().copied() {
            let since = time - last;
            if (0.0..PERIOD_MIN).contains(&since) {
                return;
            }
            if !(0.0..PAUSE).contains(&since) {
                self.taps.clear();
            } else if self.fit().is_some_and(|(_, period)| (since / period - 1.0).abs() > OFF) {
                self.taps.drain(..self.taps.len() - 1);
            }
        }
        if self.taps.len() == TAPS_MAX {
            self.taps.remove(0);
        }
        self.taps.push(time);
        if let (Some((origin, _)), [only]) = (&mut self.given, &self.taps[..]) {
            *origin = *only;
        }
    }

    /// Sets the tempo in beats per minute at `time`. The phase continues, or starts at `time` if the phase is unknown.
    /// Afterwards a single tap sets the phase, and two or more taps set another tempo. Tempos outside
    /// [`TapTempo::TEMPOS`] are ignored.
    pub fn set(&mut self, tempo: f64, time: f64) {
        if !Self::TEMPOS.contains(&tempo) || !time.is_finite() {
            return;
        }
        let (period, phase) = (60.0 / tempo, self.at(time).map_or(0.0, |(_, phase)| f64::from(phase)));
        self.taps.clear();
        self.given = Some((time - phase * period, period));
    }

    /// The tempos that can be set, in beats per minute.
    pub const TEMPOS: std::ops::RangeInclusive<f64> = 10.0..=400.0;

    /// Returns the tempo in beats per minute and the phase, 0 up to 1, at `time`. Returns `None` without two taps or a
    /// set tempo.
    pub fn at(&self, time: f64) -> Option<(f32, f32)> {
        let (origin, period) = self.fit()?;
        let phase = ((time - origin) / period).rem_euclid(1.0) as f32;
        Some(((60.0 / period) as f32, if phase < 1.0 { phase } else { 0.0 }))
    }

    /// Replaces the detected tempo and phase at `time` by the tapped tempo and phase.
    pub fn apply(&self, time: f64, features: &mut Features) {
        if let Some(tapped) = self.at(time) {
            (features.tempo, features.phase) = tapped;
        }
    }

    /// Returns the time and duration of a beat, from the least-squares line through the taps.
    fn fit(&self) -> Option<(f64, f64)> {
        let count = self.taps.len();
        if count < 2 {
            return self.given;
        }
        let middle = (count - 1) as f64 / 2.0;
        let mean = self.taps.iter().sum::<f64>() / count as f64;
        let numbered =
            self.taps.iter().enumerate().map(|(number, time)| (number as f64 - middle, time - mean));
        let (products, squares) =
            numbered.fold((0.0, 0.0), |(products, squares), (x, y)| (products + x * y, squares + x * x));
        let period = products / squares;
        Some((mean - middle * period, period))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tapped(times: &[f64]) -> TapTempo {
        let mut taps = TapTempo::default();
        times.iter().for_each(|time| taps.tap(*time));
        taps
    }

    #[test]
    fn unsteady_taps_give_the_tempo_and_the_phase_of_their_line() {
        // Taps at 120 beats per minute from 10 s on, each 20 ms early or late.
        let times: Vec<f64> =
            (0..8).map(|n| 10.0 + 0.5 * f64::from(n) + if n % 2 == 0 { 0.02 } else { -0.02 }).collect();
        let (tempo, phase) = tapped(&times).at(14.25).unwrap();
        assert!((tempo - 120.0).abs() < 2.0, "{tempo}");
        assert!((phase - 0.5).abs() < 0.04, "{phase}");
    }

    #[test]
    fn two_taps_set_the_tempo_and_a_single_one_releases_it() {
        assert_eq!(tapped(&[]).at(0.0), None);
        assert_eq!(tapped(&[1.0]).at(2.0), None);
        assert_eq!(tapped(&[1.0, 1.5]).at(2.25), Some((120.0, 0.5)));
        assert_eq!(tapped(&[1.0, 1.5, 9.0]).at(10.0), None);
        // A seek back also starts a new series of taps.
        assert_eq!(tapped(&[5.0, 5.5, 1.0]).at(2.0), None);
        assert_eq!(tapped(&[1.0, f64::NAN, 1.05, 1.5]).at(1.5), Some((120.0, 0.0)));
    }

    #[test]
    fn a_new_tempo_is_followed_from_its_second_tap() {
        let (tempo, _) = tapped(&[0.0, 0.5, 1.0, 1.5, 2.5, 3.5]).at(4.0).unwrap();
        assert!((tempo - 60.0).abs() < 1e-4, "{tempo}");
    }

    #[test]
    fn a_set_tempo_keeps_the_phase_and_taps_move_it() {
        let mut taps = tapped(&[0.0, 0.5]);
        taps.set(60.0, 0.75);
        assert_eq!((taps.at(0.75), taps.at(1.25)), (Some((60.0, 0.5)), Some((60.0, 0.0))));
        taps.tap(10.25);
        assert_eq!(taps.at(10.5), Some((60.0, 0.25)), "one tap sets the phase");
        taps.tap(10.75);
        assert_eq!(taps.at(10.75), Some((120.0, 0.0)), "two taps set a tempo");
        let before = taps.clone();
        for (tempo, time) in [(0.0, 1.0), (f64::NAN, 1.0), (1e9, 1.0), (120.0, f64::NAN)] {
            taps.set(tempo, time);
            assert_eq!(taps.at(11.0), before.at(11.0), "{tempo} at {time}");
        }
    }

    #[test]
    fn taps_override_the_detected_tempo() {
        let mut features = Features { tempo: 90.0, phase: 0.3, beat: 0.7, ..Features::SILENCE };
        tapped(&[0.0, 0.5]).apply(1.125, &mut features);
        assert_eq!((features.tempo, features.phase, features.beat), (120.0, 0.25, 0.7));
    }
}
