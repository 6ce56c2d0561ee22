//! Conversion between bars, beats and seconds.

use mariana_music::SongStructure;

/// Length of a bar in a song without beats, in seconds: four beats at 120 a minute.
const BAR_WITHOUT_BEATS: f64 = 2.0;

/// The bar lines of a song.
#[derive(Debug, Clone, PartialEq)]
pub struct BarLines {
    /// Start of each bar in seconds, ascending. The list has at least one entry.
    starts: Vec<f64>,
    /// Length in seconds of the bars before the first entry of `starts` and after the last entry.
    usual: f64,
    beats: f64,
}

impl BarLines {
    /// Returns the bar lines of `song`. Without beats, bars take two seconds, and bar 1 starts with the song.
    pub fn of(song: &SongStructure) -> Self {
        let starts: Vec<f64> = song.downbeats().collect();
        let mut lengths: Vec<f64> = starts.windows(2).map(|pair| pair[1] - pair[0]).collect();
        lengths.sort_by(f64::total_cmp);
        let usual = lengths.get(lengths.len() / 2).copied().filter(|length| *length > 0.0);
        let beats = song.meter.map_or(4.0, |meter| meter.beats() as f64);
        match usual {
            Some(usual) => Self { starts, usual, beats },
            None => Self { starts: vec![0.0], usual: BAR_WITHOUT_BEATS, beats },
        }
    }

    /// Returns the start of `bar` in seconds. Bar 1 is the first whole bar, and 1.5 is the middle of that bar.
    pub fn time_of(&self, bar: f64) -> f64 {
        let at = bar - 1.0;
        let last = self.starts.len() - 1;
        let whole = (at.floor().max(0.0) as usize).min(last);
        let start = self.starts.get(whole).copied().unwrap_or(0.0);
        let length = match self.starts.get(whole + 1) {
            Some(next) if at >= 0.0 => next - start,
            _ => self.usual,
        };
        start + (at - whole as f64) * length
    }

    /// Returns the bar number at `time` seconds, with the position within the bar as a fraction.
    pub fn bar_at(&self, time: f64) -> f64 {
        let whole = self.starts.partition_point(|start| *start <= time).saturating_sub(1);
        let start = self.starts.get(whole).copied().unwrap_or(0.0);
        let length = match self.starts.get(whole + 1) {
            Some(next) if time >= start => next - start,
            _ => self.usual,
        };
        1.0 + whole as f64 + (time - start) / length
    }

    /// Returns the number of beats in a bar.
    pub fn beats(&self) -> f64 {
        self.beats
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::resolve::testing::song;

    #[test]
    fn bars_and_seconds_convert_both_ways() {
        let lines = BarLines::of(&song());
        assert_eq!((lines.time_of(1.0), lines.time_of(3.0), lines.time_of(2.5)), (0.5, 4.5, 3.5));
        // These times are before the first and after the last bar line.
        assert_eq!(lines.time_of(0.75), 0.0);
        assert_eq!(lines.time_of(1001.0), 2000.5);
        for time in [-3.0, 0.0, 0.5, 1.7, 2.5, 63.9, 64.5, 1e4] {
            assert!((lines.time_of(lines.bar_at(time)) - time).abs() < 1e-9, "{time}");
        }
        let none = BarLines::of(&SongStructure::default());
        assert_eq!((none.time_of(1.0), none.time_of(2.0), none.bar_at(5.0)), (0.0, 2.0, 3.5));
    }
}
