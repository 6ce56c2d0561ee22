//! The loudness of a track over its length, for the seek bar. A separate thread of the lowest priority opens the track
//! again and decodes it as fast as possible, from the first request until another track is requested.

use std::collections::VecDeque;
use std::io;
use std::sync::{Arc, OnceLock};

use crate::source::FrameSource;
use crate::track::{Content, TrackInfo};
use crate::{limits, lower_priority};
use mariana_work::{Latest, Shared, latest};

const PARTS: usize = 600;

const PARTS_A_TIME: usize = 6;

/// The exponent from amplitude to loudness: 10 dB more make a sound twice as loud (Stevens 1955, in sones).
const LOUDNESS_POWER: f32 = 0.6;

const SHAPES_KEPT: usize = 16;

/// The loudness of the parts of a track that are measured already.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LoudnessShape {
    /// The number of parts of equal length.
    pub parts: usize,
    /// The loudness of the measured parts from the start: 0 is silence, 1 the loudest part so far.
    pub levels: Vec<f32>,
}

/// The thread that measures shapes, which the first request starts; `None` if it cannot be started.
#[derive(Default)]
pub(super) struct Shapes(OnceLock<Option<Latest<State>>>);

#[derive(Default)]
struct State {
    /// The track to measure next.
    wanted: Option<Arc<TrackInfo>>,
    /// The last requested track.
    last: Option<u64>,
    known: VecDeque<(u64, Arc<LoudnessShape>)>,
}

impl State {
    fn of(&self, id: u64) -> Option<Arc<LoudnessShape>> {
        self.known.iter().find(|(known, _)| *known == id).map(|(_, shape)| shape.clone())
    }

    fn publish(&mut self, id: u64, shape: LoudnessShape) {
        self.known.retain(|(other, _)| *other != id);
        if self.known.len() == SHAPES_KEPT {
            self.known.pop_front();
        }
        self.known.push_back((id, Arc::new(shape)));
    }
}

impl Shapes {
    /// Returns the measured part of the shape of `track`. The rest is measured in the background.
    pub(super) fn of(&self, track: &Arc<TrackInfo>) -> Option<Arc<LoudnessShape>> {
        let start = || latest("shape", State::default(), |state| state.wanted.take(), open_and_measure);
        let refused = |error: &io::Error| tracing::debug!("no thread for shapes: {error}");
        let thread = self.0.get_or_init(|| start().inspect_err(refused).ok()).as_ref()?;
        let mut state = thread.lock();
        let known = state.of(track.id);
        let whole = known.as_ref().is_some_and(|shape| shape.levels.len() == shape.parts);
        if !whole && state.last.replace(track.id) != Some(track.id) {
            state.wanted = Some(track.clone());
            drop(state);
            thread.change(|_| ());
        }
        known
    }
}

fn open_and_measure(track: Arc<TrackInfo>, shared: &Shared<State>) {
    lower_priority(19);
    match track.content.as_ref().map(Content::open) {
        Some(Ok(mut source)) => drop(measure(track.id, &mut *source, shared)),
        // Errors of the track are only logged here, because the player also reports them.
        Some(Err(error)) => tracing::debug!("no shape: {error}"),
        None => {}
    }
}

/// Decodes the track and publishes its shape. Stops with `None` when another track is requested, or if the
/// track is too long or its duration is unknown.
fn measure(track: u64, source: &mut dyn FrameSource, shared: &Shared<State>) -> Option<()> {
    let duration = source.duration().filter(|duration| *duration <= limits::SHAPE_SECONDS_MAX)?;
    let mut sums = Sums::new(duration * f64::from(source.sample_rate()))?;
    let (mut block, mut reported) = (Vec::new(), 0);
    let publish = |sums: &Sums| shared.lock().publish(track, sums.shape());
    loop {
        if shared.is_over() || shared.lock().wanted.is_some() {
            return None;
        }
        block.clear();
        match source.next_block(&mut block) {
            Ok(1..) => block.iter().for_each(|frame| sums.push(*frame)),
            // If a track breaks off, the remaining parts count as silent, as in playback.
            Ok(0) | Err(_) => break,
        }
        if sums.squares.len() == sums.parts {
            break;
        }
        if sums.squares.len() >= reported + PARTS_A_TIME {
            reported = sums.squares.len();
            publish(&sums);
        }
    }
    sums.squares.resize(sums.parts, 0.0);
    publish(&sums);
    Some(())
}

struct Sums {
    parts: usize,
    frames_per_part: f64,
    squares: Vec<f32>,
    frames: u64,
    sum: f64,
    count: u32,
}

impl Sums {
    fn new(frames: f64) -> Option<Self> {
        let parts = (frames as usize).min(PARTS);
        let frames_per_part = frames / parts as f64;
        (parts > 0).then(|| Self {
            parts,
            frames_per_part,
            squares: Vec::new(),
            frames: 0,
            sum: 0.0,
            count: 0,
        })
    }

    fn push(&mut self, [left, right]: [f32; 2]) {
        // A track may be longer than its stated duration.
        if self.squares.len() == self.parts {
            return;
        }
        self.sum += f64::from(left * left + right * right) / 2.0;
        self.count += 1;
        self.frames += 1;
        if self.frames as f64 >= (self.squares.len() + 1) as f64 * self.frames_per_part {
            self.squares.push((self.sum / f64::from(self.count)) as f32);
            (self.sum, self.count) = (0.0, 0);
        }
    }

    fn shape(&self) -> LoudnessShape {
        let loudest = self.squares.iter().copied().fold(0.0, f32::max);
        // The exponent is halved for the square of the amplitude.
        let level =
            |square: &f32| if loudest > 0.0 { (square / loudest).powf(LOUDNESS_POWER / 2.0) } else { 0.0 };
        LoudnessShape { parts: self.parts, levels: self.squares.iter().map(level).collect() }
    }
}

#[cfg(test)]
#[path = "shape_tests.rs"]
mod tests;
