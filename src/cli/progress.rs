//! Progress of a job: a bar on a terminal, otherwise a line every ten seconds.

use std::fmt;
use std::io::Write;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::export::print::print_message;
use crate::ui::overlay::clock_time;

const LINE_PERIOD: Duration = Duration::from_secs(10);

const BAR: &str = "{bar:32} {percent:>3} %  {msg} {pos} of {len}, {rate} a second, {left} left";
/// The bar's template while the number of frames is unknown.
const COUNT: &str = "{msg} {pos}, {rate} a second";

pub(super) enum Progress {
    Bar(ProgressBar),
    Lines { noun: &'static str, since: Option<Since> },
    Quiet,
}

pub(super) struct Since {
    begun: Instant,
    /// Frames done at the start.
    done: u64,
    reported: Instant,
}

impl Progress {
    /// Begins to count frames, or whatever `noun` names.
    pub(super) fn begin(quiet: bool, noun: &'static str) -> Self {
        let target = ProgressDrawTarget::stderr();
        match (quiet, target.is_hidden()) {
            (true, _) => Self::Quiet,
            (false, true) => Self::Lines { noun, since: None },
            (false, false) => {
                let bar =
                    ProgressBar::with_draw_target(None, target).with_style(style(COUNT)).with_message(noun);
                Self::Bar(bar)
            }
        }
    }

    /// Shows that `done` frames are finished. `of` is the total number of frames, if known.
    pub(super) fn reach(&mut self, done: u64, of: Option<u64>) {
        match self {
            Self::Quiet => {}
            Self::Bar(bar) => {
                if let (Some(of), None) = (of, bar.length()) {
                    bar.set_length(of);
                    bar.set_style(style(BAR));
                }
                bar.set_position(done);
            }
            Self::Lines { noun, since } => {
                // Start the clock at the first call, because shaders are compiled before that.
                let now = Instant::now();
                let since = since.get_or_insert(Since { begun: now, done, reported: now });
                if since.reported.elapsed() >= LINE_PERIOD {
                    since.reported = now;
                    let rate = (done - since.done) as f64 / since.begun.elapsed().as_secs_f64();
                    print_message(&line(noun, done, of, rate));
                }
            }
        }
    }

    /// Ends the line of the bar. Must also be called after an error.
    pub(super) fn end(&self) {
        if let Self::Bar(bar) = self {
            bar.abandon();
            // A closed terminal is no error.
            let _ = writeln!(std::io::stderr());
        }
    }
}

/// Returns a line of progress; `rate` is in frames per second.
fn line(noun: &str, done: u64, of: Option<u64>, rate: f64) -> String {
    match of.filter(|of| *of > 0) {
        Some(of) => format!(
            "{noun} {done} of {of}, {} %, {rate:.1} a second, {} left",
            100 * done / of,
            clock_time((of.saturating_sub(done) as f64 / rate.max(1e-3)).round())
        ),
        None => format!("{noun} {done}, {rate:.1} a second"),
    }
}

fn style(template: &str) -> ProgressStyle {
    let rate = |state: &ProgressState, to: &mut dyn fmt::Write| {
        let _ = write!(to, "{:.1}", state.per_sec());
    };
    let left = |state: &ProgressState, to: &mut dyn fmt::Write| {
        let _ = to.write_str(&clock_time(state.eta().as_secs_f64().round()));
    };
    // The templates are constants, and a test checks them.
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    style.with_key("rate", rate).with_key("left", left).progress_chars("=> ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_shows_percent_rate_and_time_left() {
        assert_eq!(line("frame", 120, Some(900), 12.0), "frame 120 of 900, 13 %, 12.0 a second, 1:05 left");
        assert_eq!(line("frame", 5, None, 0.5), "frame 5, 0.5 a second");
        assert_eq!(line("frame", 1, Some(8000), 1.0), "frame 1 of 8000, 0 %, 1.0 a second, 2:13:19 left");
    }

    #[test]
    fn the_bars_have_no_mistakes() {
        for template in [BAR, COUNT] {
            assert!(ProgressStyle::with_template(template).is_ok(), "{template}");
        }
    }
}
