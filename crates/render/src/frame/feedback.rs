//! The order in which the frames of feedback are drawn, so that a moment has one image, whenever drawing began.
//!
//! Frames of feedback have the numbers 0, 1, … at a fixed rate in the time of the song. An image shows the newest frame
//! before its moment. Each frame contains the previous one, so it depends on the first frame of its **history**. The
//! histories of a scene that remembers N frames begin, black, at the multiples of N. A frame belongs to the history
//! that is N to 2N frames old, which has forgotten its beginning. Shortly before that history becomes too old, the next
//! one fades in, so that no jump is visible even if a scene does not forget as fast as it should.
//!
//! A window and a video draw both histories side by side; a still draws the next one only if it is visible.

use mariana_field::limits::FEEDBACK_RATE;

/// The fraction of N frames during which the next history fades in.
const FADE: f32 = 0.25;
/// Moments of frames are computed from other numbers, such as the frames of a video, and may be slightly off.
const ROUNDING: f64 = 1e-3;

/// Returns the number of the newest frame before `time`, in seconds; `None` before the first frame.
pub fn newest_before(time: f64) -> Option<u64> {
    let frames = (time * f64::from(FEEDBACK_RATE) - ROUNDING).ceil();
    (frames >= 1.0).then(|| frames as u64 - 1)
}

/// Returns the moment of a frame in seconds.
pub fn moment_of(number: u64) -> f64 {
    number as f64 / f64::from(FEEDBACK_RATE)
}

/// A history: the number of its first frame, and the number of the frame to draw next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct History {
    begins: u64,
    next: u64,
}

/// The state of the histories of a scene.
#[derive(Debug, Clone)]
pub struct FeedbackOrder {
    frames: u64,
    slots: [Option<History>; 2],
}

/// A frame to draw.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FeedbackStep {
    /// Its number.
    pub number: u64,
    /// For each slot, `None` if its history does not draw the frame, and `Some(true)` if it begins with the frame.
    pub begins: [Option<bool>; 2],
}

/// The histories that an image shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShownHistories {
    /// The slot of the older history.
    pub older: usize,
    /// The slot of the next history and its fraction, if it is visible.
    pub younger: Option<(usize, f32)>,
}

impl FeedbackOrder {
    /// Creates the order of a scene that remembers `frames` frames.
    pub fn new(frames: u32) -> Self {
        Self { frames: u64::from(frames.max(1)), slots: [None; 2] }
    }

    /// Returns the next frame to draw before an image can show frame `newest`; `None` if all are drawn. `ahead` is true
    /// if images of later moments follow.
    pub fn next(&mut self, newest: u64, ahead: bool) -> Option<FeedbackStep> {
        let [older, younger] = self.begins(newest);
        let needs_younger = younger != older && (ahead || self.fraction(newest) > 0.0);
        let mut due = [None; 2];
        for begins in [Some(older), Some(younger).filter(|_| needs_younger)].into_iter().flatten() {
            let slot = self.slot(begins, newest);
            due[slot] = self.slots[slot].filter(|history| history.next <= newest);
        }
        let number = due.iter().flatten().map(|history| history.next).min()?;
        let due = due.map(|history| history.filter(|history| history.next == number));
        Some(FeedbackStep { number, begins: due.map(|due| due.map(|history| history.begins == number)) })
    }

    /// Notes that the frame of a step is drawn.
    pub fn record_drawn(&mut self, step: &FeedbackStep) {
        for (slot, _) in self.slots.iter_mut().zip(step.begins).filter(|(_, drawn)| drawn.is_some()) {
            slot.iter_mut().for_each(|history| history.next = step.number + 1);
        }
    }

    /// Leaves out the frames before `newest`, because a window cannot draw them in time.
    pub fn skip_to(&mut self, newest: u64) {
        for history in self.slots.iter_mut().flatten() {
            history.next = history.next.max(newest);
        }
    }

    /// Returns the number of frames that are missing in the older history.
    pub fn missing(&self, newest: u64) -> u64 {
        let [older, _] = self.begins(newest);
        let history = self.slots.iter().flatten().find(|history| history.begins == older);
        history.map_or(newest + 1 - older, |history| (newest + 1).saturating_sub(history.next))
    }

    /// Returns the histories that show frame `newest`; `None` before their first frame.
    pub fn shown(&self, newest: u64) -> Option<ShownHistories> {
        let [older, younger] = self.begins(newest);
        let slot = |begins: u64| {
            let is_drawn = |history: &History| history.begins == begins && history.next > begins;
            self.slots.iter().position(|history| history.as_ref().is_some_and(is_drawn))
        };
        let fraction = self.fraction(newest);
        let visible = slot(younger).filter(|_| younger != older && fraction > 0.0);
        Some(ShownHistories { older: slot(older)?, younger: visible.map(|slot| (slot, fraction)) })
    }

    /// The first frames of the histories of frame `newest`.
    fn begins(&self, newest: u64) -> [u64; 2] {
        let block = newest / self.frames;
        [block.saturating_sub(1) * self.frames, block * self.frames]
    }

    /// The fraction of the younger history.
    fn fraction(&self, newest: u64) -> f32 {
        let along = (newest % self.frames + 1) as f32 / self.frames as f32;
        ((along - (1.0 - FADE)) / FADE).clamp(0.0, 1.0)
    }

    /// Returns the slot of the history that begins with a frame. Begins it in the other history's place if it is
    /// missing, or if it is already beyond `newest`.
    fn slot(&mut self, begins: u64, newest: u64) -> usize {
        let known = |history: &Option<History>| history.is_some_and(|history| history.begins == begins);
        let others = self.begins(newest);
        let is_of_use =
            |history: &Option<History>| history.is_some_and(|history| others.contains(&history.begins));
        let slot =
            self.slots.iter().position(known).or(self.slots.iter().position(|history| !is_of_use(history)));
        let slot = slot.unwrap_or_default();
        let history = &mut self.slots[slot];
        if history.is_none_or(|history| history.begins != begins || history.next > newest + 1) {
            *history = Some(History { begins, next: begins });
        }
        slot
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The frames of each history, as a window would draw them.
    struct Drawn {
        order: FeedbackOrder,
        slots: [Vec<u64>; 2],
        steps: usize,
    }

    impl Drawn {
        fn new(frames: u32) -> Self {
            Self { order: FeedbackOrder::new(frames), slots: Default::default(), steps: 0 }
        }

        /// Returns the frames that the shown image depends on: of the older history, and of the visible younger one.
        fn show(&mut self, newest: u64, ahead: bool) -> (Vec<u64>, Option<(Vec<u64>, f32)>) {
            while let Some(step) = self.order.next(newest, ahead) {
                for (slot, begins) in self.slots.iter_mut().zip(step.begins) {
                    match begins {
                        None => {}
                        Some(true) => *slot = vec![step.number],
                        Some(false) => slot.push(step.number),
                    }
                }
                self.order.record_drawn(&step);
                self.steps += 1;
            }
            let shown = self.order.shown(newest).expect("a frame is drawn");
            let younger = shown.younger.map(|(slot, fraction)| (self.slots[slot].clone(), fraction));
            (self.slots[shown.older].clone(), younger)
        }
    }

    #[test]
    fn a_frame_depends_on_the_same_frames_whenever_drawing_began() {
        for frames in [1, 2, 5, 8] {
            for end in 0..40 {
                let still = Drawn::new(frames).show(end, false);
                assert!(still.0.windows(2).all(|two| two[1] == two[0] + 1) && still.0.last() == Some(&end));
                let age = still.0.len() as u64;
                assert!(end + 1 == age || (age > u64::from(frames) && age <= 2 * u64::from(frames)), "{age}");
                for (first, step) in [(0, 1), (end / 2, 1), (end % 3, 3), (39, 0)] {
                    let mut window = Drawn::new(frames);
                    (first..end).step_by(step.max(1)).for_each(|newest| drop(window.show(newest, true)));
                    if step == 0 {
                        window.show(first, true);
                    }
                    assert_eq!(
                        window.show(end, true),
                        still,
                        "{frames} frames at {end} from {first} by {step}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_window_draws_each_frame_at_most_once_per_history() {
        let mut window = Drawn::new(10);
        (0..100).for_each(|newest| drop(window.show(newest, true)));
        assert_eq!(window.steps, 100);
        let mut still = Drawn::new(10);
        still.show(95, false);
        assert_eq!(still.steps, 16);
    }

    #[test]
    fn the_next_history_fades_in_completely() {
        let order = FeedbackOrder::new(8);
        let fractions: Vec<f32> = (8..16).map(|newest| order.fraction(newest)).collect();
        assert_eq!(fractions, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 1.0]);
    }

    #[test]
    fn moments_have_the_frame_before_them_despite_rounding() {
        assert_eq!(
            [-1.0, 0.0, 1e-6, 0.001, 0.5 / 60.0].map(newest_before),
            [None, None, None, Some(0), Some(0)]
        );
        for number in 1..2000_u64 {
            assert_eq!(newest_before(moment_of(number)), Some(number - 1));
            assert_eq!(newest_before(number as f64 * (1.0 / 30.0)), Some(2 * number - 1));
            assert_eq!(newest_before(moment_of(number) + 1.0 / 144.0), Some(number));
        }
        assert_eq!(newest_before(f64::NAN), None);
    }

    #[test]
    fn skipped_frames_are_not_drawn() {
        let mut order = FeedbackOrder::new(10);
        order.next(25, true);
        assert_eq!(order.missing(25), 16);
        order.skip_to(25);
        assert_eq!(order.next(25, true).map(|step| step.number), Some(25));
        assert_eq!(order.missing(25), 1);
    }
}
