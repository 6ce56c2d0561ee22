//! The last times of frames or of keys, for the log.

use std::collections::VecDeque;
use std::time::Duration;

const KEPT: usize = 4096;

#[derive(Debug, Default)]
pub(crate) struct Times {
    /// The last times in milliseconds.
    last: VecDeque<f32>,
    count: usize,
}

impl Times {
    pub(crate) fn record(&mut self, time: Duration) {
        if self.last.len() == KEPT {
            self.last.pop_front();
        }
        self.last.push_back(time.as_secs_f32() * 1000.0);
        self.count += 1;
    }
}

impl std::fmt::Display for Times {
    /// Writes the number of times, and then the median, the 99th percentile and the maximum of the last times.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut sorted = Vec::from(self.last.clone());
        sorted.sort_by(f32::total_cmp);
        let (Some(median), Some(longest)) = (sorted.get(sorted.len() / 2), sorted.last()) else {
            return f.write_str("none");
        };
        let within = sorted.get((sorted.len() * 99).div_ceil(100) - 1).unwrap_or(longest);
        let (count, last) = (self.count, self.last.len());
        write!(f, "{count} times; the last {last}: median {median:.1} ms, 99 % within {within:.1} ms, ")?;
        write!(f, "longest {longest:.1} ms")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_times_are_summarized() {
        let mut times = Times::default();
        assert_eq!(times.to_string(), "none");
        times.record(Duration::from_millis(900));
        for n in 0..KEPT as u64 {
            times.record(Duration::from_millis(n % 3));
        }
        assert_eq!(
            times.to_string(),
            "4097 times; the last 4096: median 1.0 ms, 99 % within 2.0 ms, longest 2.0 ms"
        );
    }
}
