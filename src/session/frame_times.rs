//! Frame times, for the log.

use std::time::Duration;

const KEPT: usize = 4096;

#[derive(Debug, Default)]
pub(crate) struct FrameTimes {
    /// The last times in milliseconds; a ring buffer once the list is full.
    last: Vec<f32>,
    count: usize,
}

impl FrameTimes {
    pub(crate) fn record(&mut self, time: Duration) {
        let milliseconds = time.as_secs_f32() * 1000.0;
        let at = self.count % KEPT;
        match self.last.get_mut(at) {
            Some(oldest) => *oldest = milliseconds,
            None => self.last.push(milliseconds),
        }
        self.count += 1;
    }
}

impl std::fmt::Display for FrameTimes {
    /// Writes the number of frames, and then the median, the 99th percentile and the maximum of the last times.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut sorted = self.last.clone();
        sorted.sort_by(f32::total_cmp);
        let (Some(median), Some(longest)) = (sorted.get(sorted.len() / 2), sorted.last()) else {
            return f.write_str("no frames");
        };
        let within = sorted.get((sorted.len() * 99).div_ceil(100) - 1).unwrap_or(longest);
        let (count, last) = (self.count, self.last.len());
        write!(f, "{count} frames; the last {last}: median {median:.1} ms, 99 % within {within:.1} ms, ")?;
        write!(f, "longest {longest:.1} ms")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_frames_are_summarized() {
        let mut times = FrameTimes::default();
        assert_eq!(times.to_string(), "no frames");
        times.record(Duration::from_millis(900));
        for n in 0..KEPT as u64 {
            times.record(Duration::from_millis(n % 3));
        }
        assert_eq!(
            times.to_string(),
            "4097 frames; the last 4096: median 1.0 ms, 99 % within 2.0 ms, longest 2.0 ms"
        );
    }
}
