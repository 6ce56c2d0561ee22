//! Conversion of packet time stamps to frames. "Raw" frames include the encoder delay. They are counted from the first
//! frame of the first packet.

use symphonia::core::units::TimeBase;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Clock {
    /// Seconds per tick, as a fraction.
    numer: u32,
    denom: u32,
    /// The first packet's time stamp, in ticks.
    first: Option<i64>,
    /// If the codec has a grid, every packet begins at a multiple of this many raw frames.
    grid: Option<u32>,
}

impl Clock {
    pub(super) fn new(time_base: Option<TimeBase>, grid: Option<u32>) -> Self {
        let (numer, denom) = time_base.map_or((0, 1), |base| (base.numer.get(), base.denom.get()));
        Self { numer, denom, first: None, grid }
    }

    pub(super) fn begin(&mut self, ticks: i64) {
        self.first.get_or_insert(ticks);
    }

    pub(super) fn is_exact(&self, rate: u32) -> bool {
        u64::from(self.numer) * u64::from(rate) == u64::from(self.denom)
    }

    pub(super) fn is_usable(&self, rate: u32) -> bool {
        self.is_exact(rate) || (self.numer > 0 && self.grid.is_some())
    }

    /// Returns the first raw frame of a packet with this time stamp. If ticks are coarser than frames (Matroska counts
    /// milliseconds), the codec's grid corrects the frame.
    pub(super) fn raw_frame(&self, ticks: i64, rate: u32) -> Option<i64> {
        let frames = self.frames(ticks.checked_sub(self.first?)?, rate)?;
        if self.is_exact(rate) {
            return Some(frames.round() as i64);
        }
        let grid = f64::from(self.grid?);
        Some((frames / grid).round() as i64 * i64::from(self.grid?))
    }

    pub(super) fn frames(&self, ticks: i64, rate: u32) -> Option<f64> {
        let frames = i128::from(ticks) * i128::from(self.numer) * i128::from(rate);
        (self.numer > 0).then(|| frames as f64 / f64::from(self.denom))
    }

    /// Returns a time stamp at or before frame `raw`; with a coarse clock, a grid step and two ticks earlier.
    pub(super) fn ticks_before(&self, raw: i64, rate: u32) -> Option<i64> {
        let exact = self.is_exact(rate);
        let raw = if exact { raw } else { raw.checked_sub(i64::from(self.grid?))? };
        let per_frame = i128::from(self.numer) * i128::from(rate);
        let ticks = (i128::from(raw) * i128::from(self.denom)).checked_div_euclid(per_frame)?;
        let ticks = i64::try_from(ticks).ok()?.checked_add(self.first?)?;
        Some(if exact { ticks } else { ticks.saturating_sub(2) })
    }

    /// The number of frames before time zero, if the first packet is earlier than time zero.
    pub(super) fn lead_in(&self, rate: u32) -> u64 {
        let first = self.first.unwrap_or(0);
        if first >= 0 {
            return 0;
        }
        self.frames(first, rate).map_or(0, |frames| (-frames).round() as u64)
    }

    pub(super) fn first(&self) -> i64 {
        self.first.unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clock(numer: u32, denom: u32, grid: Option<u32>, first: i64) -> Clock {
        let mut clock = Clock::new(TimeBase::try_new(numer, denom), grid);
        clock.begin(first);
        clock
    }

    #[test]
    fn a_clock_of_frames_is_exact_both_ways() {
        let clock = clock(1, 44_100, None, -1105);
        assert!(clock.is_exact(44_100));
        assert_eq!(clock.lead_in(44_100), 1105);
        for raw in [0, 1, 1105, 12_345_678] {
            let ticks = clock.ticks_before(raw, 44_100).unwrap();
            assert_eq!(clock.raw_frame(ticks, 44_100), Some(raw));
        }
    }

    #[test]
    fn the_grid_corrects_a_clock_of_milliseconds() {
        let clock = clock(1, 1000, Some(1024), -23);
        assert!(!clock.is_exact(44_100) && clock.is_usable(44_100));
        for packet in 0..100_000i64 {
            let seconds = packet as f64 * 1024.0 / 44_100.0;
            for rounding in [0.0, 0.5, 0.99] {
                let ticks = (seconds * 1000.0 + rounding).floor() as i64 - 23;
                assert_eq!(clock.raw_frame(ticks, 44_100), Some(packet * 1024));
            }
        }
        let ticks = clock.ticks_before(441_000, 44_100).unwrap();
        assert!(clock.raw_frame(ticks, 44_100).unwrap() <= 441_000);
    }

    #[test]
    fn an_unusable_clock_is_reported() {
        let clock = Clock::new(None, Some(1024));
        assert!(!clock.is_usable(44_100));
        assert_eq!((clock.raw_frame(5, 44_100), clock.ticks_before(5, 44_100)), (None, None));
        assert!(!super::Clock::new(TimeBase::try_new(1, 1000), None).is_usable(44_100));
    }
}
