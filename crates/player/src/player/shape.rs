//! How loud a track is from its start to its end, for a bar that shows where one is in it.
//!
//! The track is opened once more and decoded as fast as may be, on a thread of its own with the lowest priority. That
//! thread starts when somebody asks for the first time, and leaves a track as soon as another is asked for.

use std::collections::VecDeque;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::limits::LIMITS;
use crate::source::FrameSource;
use crate::track::TrackInfo;
use crate::worker::Worker;

/// Parts of a track, of equal length, that are told apart.
const PARTS: usize = 600;

/// Parts between two messages.
const PARTS_A_TIME: usize = 6;

/// Loudness grows with this power of the amplitude: 10 dB more are twice as loud (Stevens 1955, in sones).
const LOUDNESS_POWER: f32 = 0.6;

/// Shapes of earlier tracks that are kept.
const SHAPES_KEPT: usize = 16;

/// How loud the parts of a track are, as far as is known yet.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LoudnessShape {
    /// Grows while more of the track becomes known.
    pub revision: u64,
    /// Into how many parts of equal length the track is divided.
    pub parts: usize,
    /// The loudness of the first parts, those that are known: 0 is silence and 1 the loudest one known.
    pub levels: Vec<f32>,
}

/// The shapes of tracks that were asked for.
#[derive(Default)]
pub(super) struct Shapes {
    shared: SharedShapes,
    thread: Mutex<Option<ShapeThread>>,
}

struct ShapeThread {
    wanted: Sender<Arc<TrackInfo>>,
    /// The track that was asked for last.
    last: u64,
    _worker: Worker,
}

/// The id of a track, and its shape; the newest last.
type KnownShapes = VecDeque<(u64, Arc<LoudnessShape>)>;

#[derive(Clone, Default)]
struct SharedShapes(Arc<Mutex<KnownShapes>>);

impl SharedShapes {
    fn lock(&self) -> MutexGuard<'_, KnownShapes> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn of(&self, id: u64) -> Option<Arc<LoudnessShape>> {
        self.lock().iter().find(|(known, _)| *known == id).map(|(_, shape)| shape.clone())
    }

    fn tell(&self, id: u64, shape: LoudnessShape) {
        let mut known = self.lock();
        known.retain(|(other, _)| *other != id);
        if known.len() == SHAPES_KEPT {
            known.pop_front();
        }
        known.push_back((id, Arc::new(shape)));
    }
}

impl Shapes {
    /// What is known of the shape of `track`; if that is not all, more will be known soon.
    pub(super) fn of(&self, track: &Arc<TrackInfo>) -> Option<Arc<LoudnessShape>> {
        let mut thread = self.thread.lock().unwrap_or_else(PoisonError::into_inner);
        let known = self.shared.of(track.id);
        let whole = known.as_ref().is_some_and(|shape| shape.levels.len() == shape.parts);
        if whole || thread.as_ref().is_some_and(|thread| thread.last == track.id) {
            return known;
        }
        if thread.is_none() {
            let (wanted, inbox) = channel();
            let shared = self.shared.clone();
            match Worker::spawn("shape", move || run(&inbox, &shared)) {
                Ok(worker) => *thread = Some(ShapeThread { wanted, last: track.id, _worker: worker }),
                // There is no shape, then.
                Err(error) => tracing::debug!("no thread for shapes: {error}"),
            }
        }
        if let Some(thread) = &mut *thread {
            thread.last = track.id;
            let _ = thread.wanted.send(track.clone());
        }
        known
    }

    #[cfg(test)]
    pub(super) fn is_idle(&self) -> bool {
        self.thread.lock().unwrap_or_else(PoisonError::into_inner).is_none()
    }
}

/// Works until nobody can ask any more.
fn run(inbox: &Receiver<Arc<TrackInfo>>, shared: &SharedShapes) {
    #[cfg(target_os = "linux")]
    if let Err(error) = rustix::process::setpriority_process(None, 19) {
        tracing::debug!("the thread for shapes keeps its priority: {error}");
    }
    let mut next = inbox.recv().ok();
    while let Some(track) = next.take() {
        // Only the newest counts.
        let track = inbox.try_iter().last().unwrap_or(track);
        match track.reopen.open().transpose() {
            Ok(Some(mut source)) => next = measure(&track, &mut *source, inbox, shared),
            Ok(None) => {}
            // The player tells what is wrong with a track.
            Err(error) => tracing::debug!("no shape: {error}"),
        }
        if next.is_none() {
            next = inbox.recv().ok();
        }
    }
}

/// Decodes the track and tells its shape. Returns the track that was asked for meanwhile.
fn measure(
    track: &TrackInfo,
    source: &mut dyn FrameSource,
    inbox: &Receiver<Arc<TrackInfo>>,
    shared: &SharedShapes,
) -> Option<Arc<TrackInfo>> {
    let duration = source.duration().filter(|duration| *duration <= LIMITS.shape_seconds_max)?;
    let mut sums = Sums::new(duration * f64::from(source.sample_rate()))?;
    let (mut block, mut reported, mut revision) = (Vec::new(), 0, 0);
    let mut tell = |sums: &Sums| {
        revision += 1;
        shared.tell(track.id, LoudnessShape { revision, ..sums.shape() });
    };
    loop {
        match inbox.try_recv() {
            Ok(next) if next.id != track.id => return Some(next),
            Err(TryRecvError::Disconnected) => return None,
            _ => {}
        }
        block.clear();
        match source.next_block(&mut block) {
            Ok(1..) => block.iter().for_each(|frame| sums.push(*frame)),
            // A track that breaks off is silent from there on, as it is when it plays.
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
    None
}

/// The power of the parts of a track.
struct Sums {
    parts: usize,
    frames_per_part: f64,
    /// The mean square of each part that is over.
    squares: Vec<f32>,
    frames: u64,
    sum: f64,
    /// Frames that are in `sum`.
    count: u32,
}

impl Sums {
    /// For a track of so many frames; none if there are none.
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
        // A track may be longer than it says.
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
        // Of the square of the amplitude half the power.
        let level =
            |square: &f32| if loudest > 0.0 { (square / loudest).powf(LOUDNESS_POWER / 2.0) } else { 0.0 };
        LoudnessShape { revision: 0, parts: self.parts, levels: self.squares.iter().map(level).collect() }
    }
}

#[cfg(test)]
#[path = "shape_tests.rs"]
mod tests;
