//! Counts the flashes of a video, frame by frame.

use super::fields;
use super::grid::luminance;
use super::swing::{Change, DEFINED, LightSwing, RedSwing, Times};
use mariana_render::flash::{CELLS, Grid};

/// Flashes that cover at most this fraction of a field of view do not count.
const AREA: f64 = 0.25;

/// The largest number of flashes found within one second.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Flashes {
    /// Flashes of luminance.
    pub general: usize,
    /// Flashes to or from a saturated red.
    pub red: usize,
}

struct Cell {
    light: LightSwing,
    light_changes: Times,
    red: RedSwing,
    red_changes: Times,
}

/// A flash counter that is fed frame by frame.
pub(crate) struct Analyser {
    cells: Vec<Cell>,
    worst: Flashes,
}

impl Default for Analyser {
    fn default() -> Self {
        let cell = || Cell {
            light: LightSwing::NEW,
            light_changes: Times::NEW,
            red: RedSwing::NEW,
            red_changes: Times::NEW,
        };
        Self { cells: (0..CELLS).map(|_| cell()).collect(), worst: Flashes::default() }
    }
}

impl Analyser {
    /// Adds the frame that is shown at `time` seconds. Times must increase from frame to frame.
    pub(crate) fn add(&mut self, time: f64, frame: &Grid) {
        for (cell, color) in self.cells.iter_mut().zip(frame.colors()) {
            let changes = [
                (cell.light.step(luminance(*color), &DEFINED), &mut cell.light_changes),
                (cell.red.step(*color, &DEFINED), &mut cell.red_changes),
            ];
            for (change, times) in changes {
                times.forget(time);
                if change.is_some() {
                    times.note(time);
                }
            }
        }
        let more = |mut worst: usize, changes: fn(&Cell) -> (Option<Change>, &Times)| {
            for change in [Change::Up, Change::Down] {
                let flashes = |cell: usize| {
                    let (last, times) = self.cells.get(cell).map(changes)?;
                    (last == Some(change) && times.are_fresh(time)).then(|| times.count(time, 0.0) / 2)
                };
                while fields::largest_fraction(|cell| flashes(cell) > Some(worst)) > AREA {
                    worst += 1;
                }
            }
            worst
        };
        self.worst = Flashes {
            general: more(self.worst.general, |cell| (cell.light.last(), &cell.light_changes)),
            red: more(self.worst.red, |cell| (cell.red.last(), &cell.red_changes)),
        };
    }

    /// The flashes of the worst second so far.
    pub(crate) fn worst(&self) -> Flashes {
        self.worst
    }
}
