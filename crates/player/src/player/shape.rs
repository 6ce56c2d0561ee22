//! The loudness of a track over its length, for the seek bar. A separate thread of the lowest priority opens the track
//! again and decodes it as fast as possible, from the first request until another track is requested.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};

use crate::source::FrameSource;
use crate::track::TrackInfo;
use crate::{limits, lower_priority};
use mariana_work::{Latest, Shared, latest, lock};

const PARTS: usize = 600;

const PARTS_A_TIME: usize = 6;

/// The exponent from amplitude to loudness: 10 dB more make a sound twice as loud (Stevens 1955, in sones).
const LOUDNESS_POWER: f32 = 0.6;

const SHAPES_KEPT: usize = 16;

/// The loudness of the parts of a track that are measured already.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LoudnessShape {
    /// A number that grows while more of the track is measured.
    pub revision: u64,
    /// The number of parts of equal length.
    pub parts: usize,
    /// The loudness of the measured parts from the start: 0 is silence, 1 the loudest part so far.
    pub levels: Vec<f32>,
}

#[derive(Default)]
pub(super) struct Shapes {
    shared: SharedShapes,
    thread: Mutex<Option<ShapeThread>>,
}

struct ShapeThread {
    wanted: Latest<Wanted>,
    last: u64,
}

/// The track to measure next.
type Wanted = Option<Arc<TrackInfo>>;

type KnownShapes = VecDeque<(u64, Arc<LoudnessShape>)>;

#[derive(Clone, Default)]
struct SharedShapes(Arc<Mutex<KnownShapes>>);

impl SharedShapes {
    fn of(&self, id: u64) -> Option<Arc<LoudnessShape>> {
        lock(&self.0).iter().find(|(known, _)| *known == id).map(|(_, shape)| shape.clone())
    }

    fn publish(&self, id: u64, shape: LoudnessShape) {
        let mut known = lock(&self.0);
        known.retain(|(other, _)| *other != id);
        if known.len() == SHAPES_KEPT {
            known.pop_front();
        }
        known.push_back((id, Arc::new(shape)));
    }
}

impl Shapes {
    /// Returns the measured part of the shape of `track`. The rest is measured in the background.
    pub(super) fn of(&self, track: &Arc<TrackInfo>) -> Option<Arc<LoudnessShape>> {
        let mut thread = lock(&self.thread);
        let known = self.shared.of(track.id);
        let whole = known.as_ref().is_some_and(|shape| shape.levels.len() == shape.parts);
        if whole || thread.as_ref().is_some_and(|thread| thread.last == track.id) {
            return known;
        }
        if thread.is_none() {
            let shared = self.shared.clone();
            let measure = move |track: Arc<TrackInfo>, wanted: &_| open_and_measure(&track, wanted, &shared);
            match latest("shape", None, Wanted::take, measure) {
                Ok(wanted) => *thread = Some(ShapeThread { wanted, last: track.id }),
                Err(error) => tracing::debug!("no thread for shapes: {error}"),
            }
        }
        if let Some(thread) = &mut *thread {
            thread.last = track.id;
            thread.wanted.change(|wanted| *wanted = Some(track.clone()));
        }
        known
    }

    #[cfg(test)]
    pub(super) fn is_idle(&self) -> bool {
        lock(&self.thread).is_none()
    }
}

fn open_and_measure(track: &TrackInfo, wanted: &Shared<Wanted>, shared: &SharedShapes) {
    lower_priority(19);
    match track.reopen.open().transpose() {
        Ok(Some(mut source)) => drop(measure(track, &mut *source, wanted, shared)),
        Ok(None) => {}
        // Errors of the track are only logged here, because the player also reports them.
        Err(error) => tracing::debug!("no shape: {error}"),
    }
}

/// Decodes the track and publishes its shape. Stops with `None` when another track is requested, or if the
/// track is too long or its duration is unknown.
fn measure(
    track: &TrackInfo,
    source: &mut dyn FrameSource,
    wanted: &Shared<Wanted>,
    shared: &SharedShapes,
) -> Option<()> {
    let duration = source.duration().filter(|duration| *duration <= limits::SHAPE_SECONDS_MAX)?;
    let mut sums = Sums::new(duration * f64::from(source.sample_rate()))?;
    let (mut block, mut reported, mut revision) = (Vec::new(), 0, 0);
    let mut tell = |sums: &Sums| {
        revision += 1;
        shared.publish(track.id, LoudnessShape { revision, ..sums.shape() });
    };
    loop {
        if wanted.is_over() || wanted.lock().is_some() {
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
            tell(&sums);
        }
    }
    sums.squares.resize(sums.parts, 0.0);
    tell(&sums);
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
        LoudnessShape { revision: 0, parts: self.parts, levels: self.squares.iter().map(level).collect() }
    }
}

#[cfg(test)]
#[path = "shape_tests.rs"]
mod tests;
