use super::super::{Analyser, Flashes};
use super::*;

const WHITE: [f32; 3] = [1.0; 3];
const BLACK: [f32; 3] = [0.0; 3];
const RED: [f32; 3] = [1.0, 0.0, 0.0];

fn everywhere(_: usize) -> bool {
    true
}

fn small(cell: usize) -> bool {
    cell % COLUMNS < 6 && cell / COLUMNS < 6
}

fn shown_of(frame: &Grid, corrections: &[Correction]) -> Grid {
    Grid::new(frame.colors().iter().zip(corrections).map(|(color, correction)| correction.apply(*color)))
}

/// Feeds the limiter with frames: `color` in the `lit` cells, black elsewhere. Analyses the displayed frames.
struct Show {
    limiter: Limiter,
    analyser: Analyser,
    time: f64,
    touched: usize,
}

impl Show {
    fn new() -> Self {
        Self { limiter: Limiter::default(), analyser: Analyser::default(), time: 0.0, touched: 0 }
    }

    fn frame(&mut self, seconds: f64, color: [f32; 3], lit: fn(usize) -> bool) -> f32 {
        let frame = Grid::new((0..CELLS).map(|cell| if lit(cell) { color } else { BLACK }));
        self.time += seconds;
        let corrections = self.limiter.limit(seconds, &frame);
        self.touched += usize::from(corrections.iter().any(Correction::limits));
        let shown = shown_of(&frame, corrections);
        self.limiter.record_shown(&shown);
        self.analyser.add(self.time, &shown);
        luminance(shown.colors()[0])
    }

    fn strobe(
        &mut self,
        (hz, fps, seconds): (f64, f64, f64),
        colors: [[f32; 3]; 2],
        lit: fn(usize) -> bool,
    ) -> Vec<f32> {
        let frames = 0..(fps * seconds) as usize;
        let color = |frame: usize| colors[usize::from((frame as f64 / fps * hz + 1e-9).fract() >= 0.5)];
        frames.map(|frame| self.frame(1.0 / fps, color(frame), lit)).collect()
    }

    fn worst(&self) -> Flashes {
        self.analyser.worst()
    }
}

#[test]
fn no_strobe_has_more_than_three_flashes_a_second() {
    let colors =
        [(WHITE, BLACK), (BLACK, WHITE), (WHITE, [0.3; 3]), (RED, BLACK), (RED, WHITE), (RED, [0.2126; 3])];
    let rates =
        [(3.7, 24.0), (4.0, 30.0), (7.3, 30.0), (5.0, 60.0), (12.0, 60.0), (30.0, 60.0), (20.0, 144.0)];
    for ((on, off), (hz, fps)) in colors.into_iter().flat_map(|colors| rates.map(|rate| (colors, rate))) {
        let mut show = Show::new();
        show.strobe((hz, fps, 3.0), [on, off], everywhere);
        let worst = show.worst();
        assert!(worst.general <= 3 && worst.red <= 3, "{on:?} {off:?} {hz} Hz, {fps} fps: {worst:?}");
        assert!(show.touched > 0, "no frame is limited at {hz} Hz and {fps} fps");
    }
}

#[test]
fn bursts_have_at_most_three_flashes_a_second() {
    let mut random = 7_u32;
    for _ in 0..4 {
        let mut show = Show::new();
        for _ in 0..600 {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let (bits, seconds) = (random >> 16, f64::from(random >> 28) / 400.0 + 0.004);
            let level = if show.time % 3.0 < 1.6 { (bits & 7) as f32 / 7.0 } else { 0.5 };
            show.frame(seconds, [level; 3], everywhere);
        }
        assert!(show.worst().general <= 3, "{:?}", show.worst());
    }
}

#[test]
fn light_that_returns_after_flashes_is_no_flash() {
    for hold in 35..65 {
        let mut show = Show::new();
        for frame in 0..35 {
            let flashes = frame > 26 && frame % 2 == 1;
            show.frame(1.0 / 60.0, if flashes { WHITE } else { BLACK }, everywhere);
        }
        for frame in 0..hold + 4 {
            let dips = frame >= hold && (frame - hold) % 2 == 0;
            show.frame(1.0 / 60.0, if dips { BLACK } else { WHITE }, everywhere);
        }
        assert!(show.worst().general <= 3, "after {hold} frames: {:?}", show.worst());
    }
}

#[test]
fn a_change_to_red_that_is_too_dim_to_count_does_not_hide_a_later_one() {
    let mut show = Show::new();
    show.strobe((10.0, 60.0, 0.8), [WHITE, BLACK], everywhere);
    // The input changes enough from cyan to red. The displayed frame does not, because its luminance is limited.
    show.frame(0.02, [0.0, 1.0, 1.0], everywhere);
    show.frame(0.02, [1.0, 0.15, 0.05], everywhere);
    show.frame(0.3, BLACK, everywhere);
    for _ in 0..4 {
        show.frame(0.12, RED, everywhere);
        show.frame(0.12, BLACK, everywhere);
    }
    assert!(show.worst().red <= 3, "{:?}", show.worst());
}

#[test]
fn slow_small_and_rare_changes_pass_unchanged() {
    /// A name, flashes per second, two colours, and the lit cells.
    type Case = (&'static str, f64, [[f32; 3]; 2], fn(usize) -> bool);
    let cases: [Case; 6] = [
        ("three flashes a second", 3.0, [WHITE, BLACK], everywhere),
        ("three red flashes a second", 3.0, [RED, BLACK], everywhere),
        ("one a second", 1.0, [BLACK, WHITE], everywhere),
        ("a faint flicker", 15.0, [[0.4; 3], [0.49; 3]], everywhere),
        ("a bright flicker", 15.0, [[0.81; 3], WHITE], everywhere),
        ("a small lamp", 10.0, [WHITE, BLACK], small),
    ];
    for (name, hz, colors, lit) in cases {
        for fps in [30.0, 60.0] {
            let mut show = Show::new();
            show.strobe((hz, fps, 3.0), colors, lit);
            assert_eq!(show.touched, 0, "{name} at {fps} fps");
        }
    }
    let mut show = Show::new();
    for frame in 0..600 {
        let time = frame as f32 / 60.0;
        let level = if time < 8.0 { 0.5 - 0.5 * (time * 6.0).cos() } else { 1.0 };
        show.frame(1.0 / 60.0, [level; 3], everywhere);
    }
    assert_eq!(show.touched, 0);
}

#[test]
fn three_hertz_pass_at_uneven_frame_times() {
    let mut show = Show::new();
    for frame in 0..600_u32 {
        // Frames are a few milliseconds early or late. Flashes are a fixed number of frames apart.
        let jitter = f64::from(frame * 7 % 5) / 1000.0 - f64::from((frame + 599) * 7 % 5) / 1000.0;
        let color = if frame % 20 < 3 { WHITE } else { BLACK };
        show.frame(1.0 / 60.0 + jitter, color, everywhere);
    }
    assert_eq!(show.touched, 0);
}

#[test]
fn three_hertz_at_a_frame_rate_that_is_no_multiple_are_sometimes_delayed_by_a_frame() {
    for colors in [[WHITE, BLACK], [RED, BLACK]] {
        let mut show = Show::new();
        show.strobe((3.0, 60.0 / 1.001, 20.0), colors, everywhere);
        assert!((1..=12).contains(&show.touched), "{} frames changed", show.touched);
        assert!(show.worst().general <= 3 && show.worst().red <= 3, "{:?}", show.worst());
    }
}

#[test]
fn the_fourth_flash_is_dimmed_without_pumping_or_jumps() {
    let mut show = Show::new();
    // Off, on, off, on: three frames each. The fourth flash begins at frame 21.
    let seen = show.strobe((10.0, 60.0, 4.0), [[0.2; 3], WHITE], everywhere);
    assert_eq!(seen[15..18], [1.0; 3]);
    for (frame, light) in seen.iter().enumerate().skip(18) {
        assert!((0.199..0.271).contains(light), "frame {frame} has {light}");
    }
    let mut last = *seen.last().unwrap();
    for frame in 0..240 {
        let light = show.frame(1.0 / 60.0, WHITE, everywhere);
        assert!(light >= last - 1e-6 && light - last <= 0.075, "frame {frame}: from {last} to {light}");
        last = light;
    }
    assert_eq!(last, 1.0, "the limit is never released");
    show.touched = 0;
    show.strobe((2.0, 60.0, 2.0), [WHITE, BLACK], everywhere);
    assert_eq!(show.touched, 0);
}

/// Shows three seconds at 60 Hz, with a flash every six frames. Returns the number of limited frames.
fn flashing(cell_of: impl Fn(usize, bool) -> [f32; 3], mut look: impl FnMut(&Grid, &[Correction])) -> usize {
    let mut limiter = Limiter::default();
    let mut limited = 0;
    for frame in 0..180 {
        let grid = Grid::new((0..CELLS).map(|cell| cell_of(cell, frame % 6 < 3)));
        let corrections = limiter.limit(1.0 / 60.0, &grid).to_vec();
        let shown = shown_of(&grid, &corrections);
        limiter.record_shown(&shown);
        if corrections.iter().any(Correction::limits) {
            limited += 1;
            look(&shown, &corrections);
        }
    }
    limited
}

#[test]
fn cells_far_from_a_flash_do_not_change() {
    let half = |cell: usize| cell % COLUMNS < COLUMNS / 2;
    let color = |cell: usize, on: bool| {
        if !half(cell) {
            [0.5; 3]
        } else if on {
            WHITE
        } else {
            BLACK
        }
    };
    let limited = flashing(color, |_, corrections| {
        for (cell, correction) in corrections.iter().enumerate() {
            let far = cell % COLUMNS >= COLUMNS / 2 + REACH;
            assert!(!far || *correction == Correction::NONE, "cell {cell}: {correction:?}");
        }
    });
    assert!(limited > 60);
}

/// Regression: unlimited neighbours of a limited cell kept all their light, and the edge between them flickered.
#[test]
fn a_flash_beside_steady_light_was_limited_with_an_edge_that_flickers() {
    let half = |cell: usize| cell % COLUMNS < COLUMNS / 2;
    let color = |cell: usize, on: bool| if half(cell) && !on { BLACK } else { WHITE };
    let mut last: Option<Vec<f32>> = None;
    let mut frames = 0;
    let limited = flashing(color, |shown, _| {
        let lights: Vec<f32> = shown.colors().iter().map(|color| luminance(*color)).collect();
        frames += 1;
        for row in lights.chunks(COLUMNS) {
            let beyond = row.get(COLUMNS / 2..).unwrap();
            for pair in beyond.windows(2) {
                assert!((pair[1] - pair[0]).abs() < 0.45, "frame {frames}: {row:?}");
            }
        }
        if let Some(last) = last.replace(lights.clone()).filter(|_| frames > 12) {
            for (cell, (before, now)) in last.iter().zip(&lights).enumerate().filter(|(cell, _)| !half(*cell))
            {
                assert!((before - now).abs() < 0.02, "frame {frames}, cell {cell}: {before}, then {now}");
            }
        }
    });
    assert!(limited > 60);
}

#[test]
fn a_gradient_is_limited_without_an_edge() {
    let lamp = |cell: usize| 0.5 * (-((cell % COLUMNS) as f32 / 14.0)).exp();
    let color = |cell: usize, on: bool| [0.1 + if on { lamp(cell) } else { 0.0 }; 3];
    let limited = flashing(color, |shown, _| {
        let lights: Vec<f32> = shown.colors().iter().map(|color| luminance(*color)).collect();
        for row in lights.chunks(COLUMNS) {
            for pair in row.windows(2) {
                assert!((pair[0] - pair[1]).abs() < 0.03, "{row:?}");
            }
        }
    });
    assert!(limited > 60);
}

#[test]
fn every_frame_time_and_colour_is_accepted() {
    let mut limiter = Limiter::default();
    for seconds in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-9, 1e9] {
        for color in [f32::NAN, f32::INFINITY, -1.0, 1e9] {
            for frame in 0..12 {
                let grid = Grid::new(std::iter::repeat_n([color * (frame % 2) as f32; 3], CELLS));
                let shown = shown_of(&grid, limiter.limit(seconds, &grid));
                assert!(shown.colors().iter().flatten().all(|value| (0.0..=1.0).contains(value)));
                limiter.record_shown(&shown);
            }
        }
    }
}
