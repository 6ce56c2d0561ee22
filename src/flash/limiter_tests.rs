use super::*;
use crate::flash::{Analyser, Flashes};

const WHITE: [f32; 3] = [1.0; 3];
const BLACK: [f32; 3] = [0.0; 3];
const RED: [f32; 3] = [1.0, 0.0, 0.0];

fn everywhere(_: usize) -> bool {
    true
}

fn small(cell: usize) -> bool {
    cell % COLUMNS < 6 && cell / COLUMNS < 6
}

/// A picture as the limiter shows it: `color` in the cells that are `lit`, black elsewhere.
struct Show {
    limiter: Limiter,
    analyser: Analyser,
    time: f64,
    /// Number of frames that were changed.
    touched: usize,
}

impl Show {
    fn new() -> Self {
        Self { limiter: Limiter::default(), analyser: Analyser::default(), time: 0.0, touched: 0 }
    }

    /// Shows a frame and returns the luminance of its first cell.
    fn frame(&mut self, seconds: f64, color: [f32; 3], lit: fn(usize) -> bool) -> f32 {
        let frame = Grid::new((0..CELLS).map(|cell| if lit(cell) { color } else { BLACK }));
        self.time += seconds;
        let corrections = self.limiter.limit(seconds, &frame);
        self.touched += usize::from(corrections.is_some());
        let shown = match corrections {
            None => frame,
            Some(corrections) => {
                Grid::new(frame.colors().iter().zip(corrections).map(|(color, correction)| {
                    let grey = luminance(*color);
                    color.map(|value| (value + correction.grey * (grey - value)) * correction.gain)
                }))
            }
        };
        self.analyser.note(self.time, &shown);
        luminance(shown.colors()[0])
    }

    /// Shows a strobe and returns the luminances of the first cell.
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
        assert!(show.touched > 0, "{hz} Hz at {fps} fps goes untouched");
    }
}

#[test]
fn bursts_that_begin_and_end_have_no_more_either() {
    let mut random = 7_u32;
    for _ in 0..4 {
        let mut show = Show::new();
        for _ in 0..600 {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let (bits, seconds) = (random >> 16, f64::from(random >> 28) / 400.0 + 0.004);
            // Ten seconds of arbitrary levels, some held for long.
            let level = if show.time % 3.0 < 1.6 { (bits & 7) as f32 / 7.0 } else { 0.5 };
            show.frame(seconds, [level; 3], everywhere);
        }
        assert!(show.worst().general <= 3, "{:?}", show.worst());
    }
}

#[test]
fn light_that_comes_back_while_flashes_are_remembered_is_none() {
    for hold in 35..65 {
        let mut show = Show::new();
        // The flashes are at the end of a part of the memory.
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
    // From cyan to red: far enough as they come, but not as they are shown, because of the limited light.
    show.frame(0.02, [0.0, 1.0, 1.0], everywhere);
    show.frame(0.02, [1.0, 0.15, 0.05], everywhere);
    // Four flashes of red end more than a second later, and they all begin later than that change.
    show.frame(0.3, BLACK, everywhere);
    for _ in 0..4 {
        show.frame(0.12, RED, everywhere);
        show.frame(0.12, BLACK, everywhere);
    }
    assert!(show.worst().red <= 3, "{:?}", show.worst());
}

#[test]
fn what_is_slow_or_small_or_seldom_passes_untouched() {
    /// The name, the flashes per second, both colours, and which cells are lit.
    type Case = (&'static str, f64, [[f32; 3]; 2], fn(usize) -> bool);
    let cases: [Case; 6] = [
        ("three flashes a second", 3.0, [WHITE, BLACK], everywhere),
        ("three red flashes a second", 3.0, [RED, BLACK], everywhere),
        ("one a second", 1.0, [BLACK, WHITE], everywhere),
        ("a faint flicker", 15.0, [[0.4; 3], [0.49; 3]], everywhere),
        ("a flicker of what is bright", 15.0, [[0.81; 3], WHITE], everywhere),
        ("a small lamp", 10.0, [WHITE, BLACK], small),
    ];
    for (name, hz, colors, lit) in cases {
        for fps in [30.0, 60.0] {
            let mut show = Show::new();
            show.strobe((hz, fps, 3.0), colors, lit);
            assert_eq!(show.touched, 0, "{name} at {fps} fps");
        }
    }
    // A swell, and a step that stays.
    let mut show = Show::new();
    for frame in 0..600 {
        let time = frame as f32 / 60.0;
        let level = if time < 8.0 { 0.5 - 0.5 * (time * 6.0).cos() } else { 1.0 };
        show.frame(1.0 / 60.0, [level; 3], everywhere);
    }
    assert_eq!(show.touched, 0);
}

#[test]
fn three_hertz_pass_though_frames_come_at_uneven_times() {
    let mut show = Show::new();
    for frame in 0..600_u32 {
        // A few milliseconds early or late; the flash follows the frames.
        let jitter = f64::from(frame * 7 % 5) / 1000.0 - f64::from((frame + 599) * 7 % 5) / 1000.0;
        let color = if frame % 20 < 3 { WHITE } else { BLACK };
        show.frame(1.0 / 60.0 + jitter, color, everywhere);
    }
    assert_eq!(show.touched, 0);
}

#[test]
fn three_hertz_at_a_rate_of_frames_that_is_no_multiple_are_put_off_by_a_frame_now_and_then() {
    for colors in [[WHITE, BLACK], [RED, BLACK]] {
        let mut show = Show::new();
        show.strobe((3.0, 60.0 / 1.001, 20.0), colors, everywhere);
        // Each of the few flashes that begin a frame early loses that frame.
        assert!((1..=12).contains(&show.touched), "{} frames are changed", show.touched);
        assert!(show.worst().general <= 3 && show.worst().red <= 3, "{:?}", show.worst());
    }
}

#[test]
fn the_fourth_flash_itself_is_dimmed_and_the_picture_neither_pumps_nor_jumps() {
    let mut show = Show::new();
    // Off, on, off, on: three frames each. The fourth flash begins at frame 21.
    let seen = show.strobe((10.0, 60.0, 4.0), [[0.2; 3], WHITE], everywhere);
    assert_eq!(seen[15..18], [1.0; 3]);
    for (frame, light) in seen.iter().enumerate().skip(18) {
        assert!((0.199..0.271).contains(light), "frame {frame} has {light}");
    }
    // The strobe ends: no jump.
    let mut last = *seen.last().unwrap();
    for frame in 0..240 {
        let light = show.frame(1.0 / 60.0, WHITE, everywhere);
        assert!(light >= last - 1e-6 && light - last <= 0.075, "frame {frame}: from {last} to {light}");
        last = light;
    }
    assert_eq!(last, 1.0, "it never lets go");
    show.touched = 0;
    show.strobe((2.0, 60.0, 2.0), [WHITE, BLACK], everywhere);
    assert_eq!(show.touched, 0);
}

#[test]
fn a_limited_cell_leaves_the_others_alone() {
    fn half(cell: usize) -> bool {
        cell % COLUMNS < COLUMNS / 2
    }
    let mut limiter = Limiter::default();
    let mut limited = 0;
    for frame in 0..180 {
        let flash = if frame % 6 < 3 { WHITE } else { BLACK };
        let grid = Grid::new((0..CELLS).map(|cell| if half(cell) { flash } else { [0.5; 3] }));
        let Some(corrections) = limiter.limit(1.0 / 60.0, &grid) else { continue };
        for (cell, correction) in corrections.iter().enumerate() {
            assert!(half(cell) || *correction == Correction::NONE, "cell {cell}: {correction:?}");
        }
        limited += 1;
    }
    assert!(limited > 60);
}

#[test]
fn a_light_that_fades_over_the_picture_is_limited_without_an_edge() {
    let mut limiter = Limiter::default();
    let lamp = |cell: usize| 0.5 * (-((cell % COLUMNS) as f32 / 14.0)).exp();
    let mut limited = 0;
    for frame in 0..180 {
        let on = if frame % 6 < 3 { 1.0 } else { 0.0 };
        let lights: Vec<f32> = (0..CELLS).map(|cell| 0.1 + on * lamp(cell)).collect();
        let grid = Grid::new(lights.iter().map(|light| [*light; 3]));
        let Some(corrections) = limiter.limit(1.0 / 60.0, &grid) else { continue };
        limited += 1;
        let shown: Vec<f32> = lights.iter().zip(corrections).map(|(light, c)| light * c.gain).collect();
        for row in shown.chunks(COLUMNS) {
            for pair in row.windows(2) {
                assert!((pair[0] - pair[1]).abs() < 0.02, "frame {frame}: {row:?}");
            }
        }
    }
    assert!(limited > 60);
}

#[test]
fn centres_keep_the_means_of_cells_as_far_as_gains_go() {
    let mut limiter = Limiter::default();
    let gain = |cell: usize| {
        0.5 + 0.2 * ((cell % COLUMNS) as f32 * 0.9).sin() * ((cell / COLUMNS) as f32 * 0.7).cos()
    };
    for (cell, correction) in limiter.corrections.iter_mut().enumerate() {
        *correction = Correction { gain: gain(cell), grey: 0.0, limited: cell % 7 != 0, level: false };
    }
    limiter.make_centres();
    for cell in (0..CELLS).filter(|cell| cell % 7 != 0) {
        // Its mean, from many points in it.
        let (mut sum, side) = (0.0, 16);
        for point in 0..side * side {
            let place = |at: usize| (at as f32 + 0.5) / side as f32 - 0.5;
            let (x, y) = (place(point % side), place(point / side));
            let (to_x, to_y) = (x.signum() as isize, y.signum() as isize);
            let at = |step| {
                let other = limiter.corrections[neighbour(cell, step)];
                if other.limited { other.gain } else { limiter.corrections[cell].gain }
            };
            let mix = |a: f32, b: f32, share: f32| a + share * (b - a);
            let near = mix(at((0, 0)), at((to_x, 0)), x.abs());
            let far = mix(at((0, to_y)), at((to_x, to_y)), x.abs());
            sum += mix(near, far, y.abs());
        }
        let mean = sum / (side * side) as f32;
        assert!((mean - gain(cell)).abs() < 0.012, "cell {cell}: {mean}, not {}", gain(cell));
    }
}

#[test]
fn no_frame_times_and_no_colours_break_it() {
    let mut limiter = Limiter::default();
    for seconds in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-9, 1e9] {
        for color in [f32::NAN, f32::INFINITY, -1.0, 1e9] {
            for frame in 0..12 {
                let grid = Grid::new(std::iter::repeat_n([color * (frame % 2) as f32; 3], CELLS));
                let corrections = limiter.limit(seconds, &grid).unwrap_or_default();
                assert!(corrections.iter().all(|correction| (0.0..=1.0).contains(&correction.gain)));
            }
        }
    }
}
