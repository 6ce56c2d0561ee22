//! Counts the flashes of a video, frame by frame.

use mariana_render::flash::CELLS;

use super::fields::{self, Grid, luminance};
use super::swing::{Change, DEFINED, LightSwing, RedSwing, Times};

/// Flashes that cover at most this fraction of a field of view do not count.
const AREA: f64 = 0.25;

/// The largest number of flashes found within one second.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Flashes {
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
pub struct Analyser {
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
    pub fn add(&mut self, time: f64, frame: &Grid) {
        for (cell, color) in self.cells.iter_mut().zip(frame.colors()) {
            let changes = [
                (cell.light.step(luminance(*color), &DEFINED), &mut cell.light_changes),
                (cell.red.step(*color, &DEFINED), &mut cell.red_changes),
            ];
            for (change, times) in changes {
                times.forget(time);
                if change.is_some() {
                    times.add(time);
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
            general: more(self.worst.general, |cell| (cell.light.last, &cell.light_changes)),
            red: more(self.worst.red, |cell| (cell.red.last(), &cell.red_changes)),
        };
    }

    /// The flashes of the worst second so far.
    pub fn worst(&self) -> Flashes {
        self.worst
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_render::flash::{COLUMNS, ROWS};

    fn flashes(hz: f64, fps: u32, on: [f32; 3], off: [f32; 3], lit: fn(usize) -> bool) -> Flashes {
        let mut analyser = Analyser::default();
        for frame in 0..4 * fps {
            let time = f64::from(frame) / f64::from(fps);
            let color = if (time * hz + 1e-9).fract() < 0.5 { on } else { off };
            analyser.add(time, &Grid::new((0..CELLS).map(|cell| if lit(cell) { color } else { off })));
        }
        analyser.worst()
    }

    #[test]
    fn a_strobe_has_one_flash_per_period() {
        for (hz, fps) in [(1.0, 30), (3.0, 30), (4.0, 60), (10.0, 60), (30.0, 60), (5.0, 1000)] {
            let seen = flashes(hz, fps, [1.0; 3], [0.0; 3], |_| true);
            assert_eq!(seen, Flashes { general: hz as usize, red: 0 }, "{hz} Hz at {fps} fps");
        }
    }

    #[test]
    fn red_and_luminance_count_separately() {
        let (red, black) = ([1.0, 0.0, 0.0], [0.0; 3]);
        assert_eq!(flashes(6.0, 60, red, black, |_| true), Flashes { general: 6, red: 6 });
        // Both colours have the same luminance, so these are red flashes only.
        assert_eq!(flashes(6.0, 60, red, [0.2126; 3], |_| true), Flashes { general: 0, red: 6 });
        assert_eq!(flashes(6.0, 60, [0.4, 0.0, 0.0], black, |_| true), Flashes { general: 0, red: 6 });
    }

    #[test]
    fn places_that_light_up_in_turn_do_not_flash_together() {
        // Bolts of four rows, at a row that depends on the frame.
        let flashes = |row: fn(usize) -> usize| {
            let mut analyser = Analyser::default();
            for frame in 0..120 {
                let lit = |cell: usize| (cell / COLUMNS % 12).wrapping_sub(row(frame)) < 4;
                let color = |cell| if lit(cell) { [1.0; 3] } else { [0.0; 3] };
                analyser.add(frame as f64 / 30.0, &Grid::new((0..CELLS).map(color)));
            }
            analyser.worst().general
        };
        assert_eq!(flashes(|frame| (frame % 14).min(14 - frame % 14)), 0, "up and down twice a second");
        assert!(flashes(|frame| frame / 3 % 2 * 7) > 3, "it jumps between two places");
    }

    #[test]
    fn small_flashes_do_not_count() {
        let (on, off) = ([1.0; 3], [0.0; 3]);
        let quarter = |cell: usize| cell % COLUMNS < COLUMNS / 6 && cell / COLUMNS < ROWS / 6;
        let more = |cell: usize| cell % COLUMNS < COLUMNS / 6 + 1 && cell / COLUMNS < ROWS / 6;
        assert_eq!(flashes(8.0, 60, on, off, quarter).general, 0);
        assert_eq!(flashes(8.0, 60, on, off, more).general, 8);
    }
}
