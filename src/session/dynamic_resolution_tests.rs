use super::*;

const FPS: f64 = 60.0;

struct Window {
    dynamic_resolution: DynamicResolution,
    now: Instant,
    start: Instant,
    changes: Vec<(f64, usize)>,
}

impl Window {
    fn new() -> Self {
        let now = Instant::now();
        Self {
            dynamic_resolution: DynamicResolution::new(QualityChoice::Auto, FPS),
            now,
            start: now,
            changes: Vec::new(),
        }
    }

    fn seconds(&self) -> f64 {
        self.now.duration_since(self.start).as_secs_f64()
    }

    fn show(&mut self, seconds: f64, mut cost: impl FnMut(usize, Level) -> f64) -> &mut Self {
        let end = self.now + Duration::from_secs_f64(seconds);
        for frame in 0.. {
            if self.now >= end {
                break;
            }
            let took = cost(frame, self.dynamic_resolution.level());
            self.now += Duration::from_secs_f64(took.max(1.0 / FPS));
            let before = self.dynamic_resolution.level;
            self.dynamic_resolution.record(self.now, Duration::from_secs_f64(took));
            if self.dynamic_resolution.level != before {
                self.changes.push((self.seconds(), self.dynamic_resolution.level));
            }
        }
        self
    }

    fn changes_after(&self, seconds: f64) -> usize {
        self.changes.iter().filter(|(time, _)| *time > seconds).count()
    }
}

/// The cost in seconds of a scene: `best` at the best level, plus `fixed` at every level.
fn scene(best: f64, fixed: f64) -> impl Fn(usize, Level) -> f64 {
    move |_, level| fixed + best * level.scale.powi(2) * (0.6 + 0.4 * f64::from(level.quality))
}

fn noise(frame: usize) -> f64 {
    f64::from((frame as u32).wrapping_mul(2_654_435_761) >> 8) / f64::from(1_u32 << 23) - 1.0
}

#[test]
fn a_light_load_gets_the_best_level_and_fixed_qualities_do_not_change() {
    let mut window = Window::new();
    window.show(60.0, scene(0.012, 0.001));
    assert_eq!(window.changes, []);
    for (choice, scale) in [
        (QualityChoice::Best, 1.0),
        (QualityChoice::High, 0.84),
        (QualityChoice::Medium, 0.64),
        (QualityChoice::Low, 0.46),
    ] {
        let mut dynamic_resolution = DynamicResolution::new(choice, FPS);
        for frame in 0..600 {
            dynamic_resolution
                .record(window.now + Duration::from_millis(20 * frame), Duration::from_millis(500));
        }
        assert_eq!(dynamic_resolution.level().scale, scale, "{choice:?}");
    }
}

#[test]
fn a_software_renderer_begins_with_the_fewest_pixels_and_finds_its_level_at_once() {
    for best in [0.002, 0.02, 0.05, 0.1, 2.0] {
        let mut window = Window::new();
        window.dynamic_resolution = DynamicResolution::beginning_small(QualityChoice::Auto, FPS);
        assert_eq!(window.dynamic_resolution.level, LEVELS.len() - 1);
        // The first frame also compiles and creates targets, so its cost is ignored.
        let load = scene(best, 0.0);
        window.show(1.0, |frame, level| if frame == 0 { 0.5 } else { load(frame, level) });
        let (found, reported) = (&window.dynamic_resolution, format!("{best} s: {:?}", window.changes));
        let room = |level: usize| found.time_at(level) - load(0, level_at(level));
        assert!(room(found.level) > 0.0 || found.level == LEVELS.len() - 1, "{reported}");
        assert!(found.level < 2 || room(found.level - 2) < 0.3 * found.interval, "{reported}");
        assert!(window.changes.len() <= 1, "{reported}");
    }
    let chosen = DynamicResolution::beginning_small(QualityChoice::High, FPS);
    assert_eq!(chosen.level, HIGH);
}

#[test]
fn every_constant_load_settles_within_its_frame_time() {
    for best in [0.017, 0.02, 0.025, 0.04, 0.06, 0.1, 0.3, 1.0] {
        for fixed in [0.0, 0.002, 0.006] {
            for noisy in [0.0, 0.15] {
                let load = scene(best, fixed);
                let mut window = Window::new();
                window.show(240.0, |frame, level| load(frame, level) * (1.0 + noisy * noise(frame)));
                let reported = format!("{best} s, {fixed} s fixed, noise {noisy}: {:?}", window.changes);
                let level = window.dynamic_resolution.level;
                let cost = load(0, window.dynamic_resolution.level());
                assert!(
                    cost <= window.dynamic_resolution.time_at(level) || level == LEVELS.len() - 1,
                    "{reported}"
                );
                assert!(window.changes_after(60.0) <= 2, "{reported}");
                assert!(window.changes.len() <= 8, "{reported}");
                // The level is not much lower than necessary.
                let better = level_at(level.saturating_sub(3));
                assert!(
                    level == 0 || load(0, better) > 0.72 * window.dynamic_resolution.interval,
                    "{reported}"
                );
            }
        }
    }
}

#[test]
fn the_level_drops_at_once_under_load_and_recovers_slowly() {
    let mut window = Window::new();
    window.show(20.0, scene(0.008, 0.001)).show(20.0, scene(0.05, 0.001));
    let (first, _) = window.changes[0];
    assert!((20.0..20.5).contains(&first), "{:?}", window.changes);
    let under_load = window.changes.len();
    assert!(under_load <= 3, "{:?}", window.changes);
    window.show(60.0, scene(0.008, 0.001));
    assert_eq!(window.dynamic_resolution.level, 0, "{:?}", window.changes);
    for pair in window.changes[under_load..].windows(2) {
        assert!(pair[1].1 + 1 == pair[0].1 && pair[1].0 - pair[0].0 > 1.5, "{:?}", window.changes);
    }
}

#[test]
fn single_slow_frames_change_nothing() {
    let mut window = Window::new();
    let quiet = scene(0.01, 0.001);
    window.show(60.0, |frame, level| if frame % 40 == 7 { 0.4 } else { quiet(frame, level) });
    assert_eq!(window.changes, []);
    let heavy = scene(0.04, 0.001);
    window.show(30.0, &heavy);
    let settled = window.changes.len();
    window.show(60.0, |frame, level| if frame % 100 == 7 { 0.3 } else { heavy(frame, level) });
    assert_eq!(window.changes.len(), settled, "{:?}", window.changes);
}

#[test]
fn an_intermittent_load_does_not_make_the_level_oscillate() {
    for period in [0.5, 2.0, 7.0, 20.0] {
        let mut window = Window::new();
        let (calm, wild) = (scene(0.012, 0.001), scene(0.024, 0.001));
        let mut time = 0.0;
        window.show(400.0, |frame, level| {
            let cost = if (time / period) % 1.0 < 0.5 { calm(frame, level) } else { wild(frame, level) };
            time += cost.max(1.0 / FPS);
            cost
        });
        // The last three minutes have less than one change in ten seconds.
        let late = window.changes_after(220.0);
        assert!(late <= 18, "period {period}: {late} changes, {:?}", window.changes);
    }
}

#[test]
fn the_level_returns_soon_if_pixels_are_not_the_bottleneck() {
    let mut window = Window::new();
    window.show(300.0, |_, _| 0.03);
    let away: f64 = window.changes.chunks(2).map(|pair| pair.last().unwrap().0 - pair[0].0).sum();
    assert_eq!(window.dynamic_resolution.level, 0);
    assert!(away < 5.0 && window.changes.len() <= 12, "{:?}", window.changes);
}

#[test]
fn a_pause_is_ignored_and_a_slow_processor_gets_a_moving_show() {
    let mut window = Window::new();
    window.show(10.0, scene(0.35, 0.004));
    let cost = scene(0.35, 0.004)(0, window.dynamic_resolution.level());
    assert!(cost < 1.0 / FPS_USABLE, "{cost} s");
    assert!(window.changes[0].0 < 3.0, "{:?}", window.changes);
    let before = window.dynamic_resolution.level;
    window.now += Duration::from_secs(3600);
    window.dynamic_resolution.record(window.now, Duration::from_secs(1));
    assert_eq!(window.dynamic_resolution.level, before);
}

#[test]
fn short_sides_are_not_reduced() {
    let least = LEVELS.last().unwrap();
    assert_eq!(least.size_in((1, 16_384)), (1, 4096));
    assert_eq!(least.size_in((0, 40)), (1, 16));
    assert_eq!(LEVELS[0].size_in((1280, 720)), (1280, 720));
    for pair in LEVELS.windows(2) {
        let ratio = pair[1].cost() / pair[0].cost();
        assert!((0.7..0.88).contains(&ratio), "{pair:?}: {ratio}");
    }
}

#[test]
fn a_lack_of_memory_shrinks_stills_too() {
    let mut controller = DynamicResolution::beginning_small(QualityChoice::Auto, FPS);
    assert_eq!(controller.still_level().scale, 1.0);
    assert!(controller.make_smaller(), "stills had all pixels");
    assert_eq!(controller.still_level().scale, controller.level().scale);
    assert!(!controller.make_smaller(), "there is no smaller level");
}
