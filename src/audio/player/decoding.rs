//! The decoding thread: keeps the ring of the callback filled, and seeks.
//!
//! A seek makes a new segment. The old one goes on sounding until the new one has [`PREFILL`] seconds in its ring.
//! The frames of the last [`PREROLL`] seconds before the target go to the analysis alone, so that after a seek the
//! features and their history are those of an uninterrupted playback, but for what longer memories still hold.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TryRecvError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use rtrb::Producer;

use super::analysis::AnalysisInput;
use crate::audio::output::{FeederLink, Segment};
use crate::audio::resample::Resampler;
use crate::audio::source::{FrameSource, SourceError};
use crate::audio::timeline::SharedTimeline;
use crate::dsp::StereoFrame;
use crate::limits::LIMITS;

/// Depth of the ring, in seconds, or [`RING_BUFFERS`] buffers of the device if that is more.
const RING: f64 = 0.4;

/// See [`RING`].
const RING_BUFFERS: usize = 4;

/// How much of a segment is there before it is heard, in seconds: more than the analysis looks ahead.
const PREFILL: f64 = 0.15;

/// What the analysis hears before a seek's target, in seconds: what a history spans, and the time in which all but the
/// beat and the bass drive forget. Near the song's start it is less, and the history is silent before it.
const PREROLL: f64 = 13.0;

/// Frames that are analysed and resampled at a time.
const CHUNK: usize = 4096;

/// Time between two looks whether the ring has room.
const WAIT: Duration = Duration::from_millis(20);

/// What the window and the supervisor ask for.
pub(crate) enum Command {
    /// Play on this output from now on.
    Output(FeederLink),
    /// Go to a time of the song, in seconds.
    SeekTo(f64),
    /// Go forward or back by seconds.
    SeekBy(f64),
    /// End the thread.
    Quit,
}

/// The segment that is being filled.
struct Filling {
    id: u64,
    /// Song time of its first frame, in seconds.
    target: f64,
    ring: Producer<StereoFrame>,
    end: Arc<AtomicU64>,
    /// The callback's half, until it is handed over.
    waiting: Option<Segment>,
    resampler: Resampler,
    /// Frames still to come before the target: for the analysis alone.
    skip: u64,
    /// Source frames since the target.
    fed: u64,
    /// Frames of the device put into the ring.
    pushed: u64,
    /// Decoded and not looked at yet.
    decoded: VecDeque<StereoFrame>,
    /// Resampled and not in the ring yet.
    ready: VecDeque<StereoFrame>,
    /// Source frames since the last jump within the source.
    since_jump: u64,
    /// Whether that jump went to the song's start.
    from_start: bool,
    /// The source has no more for this segment.
    exhausted: bool,
    /// All of it is in the ring.
    finished: bool,
}

/// The thread's state.
pub(crate) struct Decoding {
    source: Box<dyn FrameSource>,
    looping: bool,
    timeline: SharedTimeline,
    analysis: SyncSender<AnalysisInput>,
    error: Arc<Mutex<Option<String>>>,
    link: Option<FeederLink>,
    filling: Option<Filling>,
    last_id: u64,
    /// Where to start once there is an output, in seconds.
    start: f64,
    scratch: Vec<StereoFrame>,
}

enum Next {
    GoOn,
    Wait,
}

impl Decoding {
    pub(crate) fn new(
        source: Box<dyn FrameSource>,
        looping: bool,
        timeline: SharedTimeline,
        analysis: SyncSender<AnalysisInput>,
        error: Arc<Mutex<Option<String>>>,
    ) -> Self {
        let (link, filling) = (None, None);
        Self {
            source,
            looping,
            timeline,
            analysis,
            error,
            link,
            filling,
            last_id: 0,
            start: 0.0,
            scratch: Vec::new(),
        }
    }

    /// Works until [`Command::Quit`] or until the player is gone.
    pub(crate) fn run(mut self, inbox: &Receiver<Command>) {
        let mut next = Next::Wait;
        loop {
            let first = match next {
                Next::GoOn => match inbox.try_recv() {
                    Ok(command) => Some(command),
                    Err(TryRecvError::Empty) => None,
                    Err(TryRecvError::Disconnected) => return,
                },
                Next::Wait => match inbox.recv_timeout(WAIT) {
                    Ok(command) => Some(command),
                    Err(RecvTimeoutError::Timeout) => None,
                    Err(RecvTimeoutError::Disconnected) => return,
                },
            };
            if first.is_some_and(|first| self.obey(first, inbox)) {
                return;
            }
            if let Some(link) = &mut self.link {
                link.clean_up();
            }
            next = self.fill();
        }
    }

    /// Carries out `first` and what waits behind it, many seeks as one. True to end.
    fn obey(&mut self, first: Command, inbox: &Receiver<Command>) -> bool {
        let mut target = None;
        for command in std::iter::once(first).chain(inbox.try_iter()) {
            match command {
                Command::Quit => return true,
                Command::SeekTo(time) => target = Some(time),
                Command::SeekBy(seconds) => {
                    target = Some((target.unwrap_or_else(|| self.place()) + seconds).max(0.0));
                }
                Command::Output(link) => {
                    let place = target.unwrap_or_else(|| self.place());
                    self.link = Some(link);
                    target = Some(place);
                }
            }
        }
        if let Some(target) = target.filter(|target| target.is_finite()) {
            self.begin(target.max(0.0));
        }
        false
    }

    /// Where the song is: what is audible, or the target of a seek that is not heard yet. In seconds.
    fn place(&self) -> f64 {
        let (Some(link), Some(filling)) = (&self.link, &self.filling) else { return self.start };
        let audible = link.history.at(Instant::now()).filter(|audible| audible.segment == filling.id);
        let place = audible.and_then(|audible| self.timeline.lock().place(audible, 0.0));
        place.map_or(filling.target, |place| place.song_time)
    }

    /// Starts a segment at `target` seconds of the song.
    fn begin(&mut self, target: f64) {
        self.start = target;
        let place = self.place();
        let Some((rate, buffer_frames)) = self.link.as_ref().map(|link| (link.rate, link.buffer_frames))
        else {
            return;
        };
        if let Some(unheard) = self.filling.take().filter(|filling| filling.waiting.is_some()) {
            self.timeline.lock().discard(unheard.id);
        }
        let source_rate = self.source.sample_rate();
        let resampler = match Resampler::new(source_rate, rate) {
            Ok(resampler) => resampler,
            Err(error) => return self.report(&error),
        };
        let target = self.source.duration().map_or(target, |duration| target.min(duration));
        // If it cannot be reached: stay, or begin anew.
        let reached = [target, place, 0.0].into_iter().find_map(|goal| match self.seek(goal) {
            Ok(reached) => Some((goal, reached)),
            Err(error) => {
                self.report(&*error);
                None
            }
        });
        let (target, reached) = reached.unwrap_or((target, target));
        let frame_at = |seconds: f64| (seconds * f64::from(source_rate)).round() as u64;
        // The time of the frame that it will be.
        let target = frame_at(target) as f64 / f64::from(source_rate);
        self.last_id += 1;
        let id = self.last_id;
        let ring_frames = ((RING * f64::from(rate)) as usize).max(RING_BUFFERS * buffer_frames);
        let (ring, end, waiting) = Segment::new(id, ring_frames);
        self.timeline.lock().begin(id, rate, target);
        self.analyse(AnalysisInput::Begin { segment: id, position: frame_at(reached) });
        self.filling = Some(Filling {
            id,
            target,
            ring,
            end,
            waiting: Some(waiting),
            resampler,
            skip: frame_at(target).saturating_sub(frame_at(reached)),
            fed: 0,
            pushed: 0,
            decoded: VecDeque::new(),
            ready: VecDeque::new(),
            since_jump: 0,
            from_start: reached == 0.0,
            exhausted: false,
            finished: false,
        });
    }

    fn seek(&mut self, goal: f64) -> Result<f64, SourceError> {
        self.source.seek((goal - PREROLL).max(0.0))
    }

    /// Does the next piece of work on the segment.
    fn fill(&mut self) -> Next {
        let (Some(link), Some(filling)) = (self.link.as_mut(), self.filling.as_mut()) else {
            return Next::Wait;
        };
        filling.push_ready();
        if filling.ready.is_empty() && filling.exhausted && !filling.finished {
            filling.finished = true;
            filling.end.store(filling.pushed, Ordering::Release);
            self.timeline.lock().finish(filling.id, filling.pushed);
        }
        let prefill = ((PREFILL * f64::from(link.rate)) as u64).min(filling.ring.buffer().capacity() as u64);
        if (filling.pushed >= prefill || filling.finished)
            && let Some(segment) = filling.waiting.take()
        {
            filling.waiting = link.offer(segment).err();
        }
        if filling.finished || !filling.ready.is_empty() {
            return Next::Wait;
        }
        if filling.decoded.is_empty() {
            self.decode()
        } else {
            self.convert()
        }
        Next::GoOn
    }

    fn decode(&mut self) {
        self.scratch.clear();
        let decoded = match self.source.next_block(&mut self.scratch) {
            Ok(count) => count,
            Err(error) => {
                self.report(&*error);
                0
            }
        };
        let Some(filling) = self.filling.as_mut() else { return };
        if decoded == 0 {
            return self.end_of_song();
        }
        filling.since_jump += self.scratch.len() as u64;
        filling.decoded.extend(self.scratch.drain(..));
    }

    /// Analyses and resamples the next decoded frames.
    fn convert(&mut self) {
        let Some(filling) = self.filling.as_mut() else { return };
        let count = filling.decoded.len().min(CHUNK);
        let frames: Vec<StereoFrame> = filling.decoded.drain(..count).collect();
        let skipped = filling.skip.min(count as u64);
        filling.skip -= skipped;
        let audible = frames.get(skipped as usize..).unwrap_or_default();
        filling.fed += audible.len() as u64;
        self.scratch.clear();
        let resampled = filling.resampler.process(audible, &mut self.scratch);
        filling.ready.extend(self.scratch.drain(..));
        if let Err(error) = resampled {
            self.report(&error);
        }
        self.analyse(AnalysisInput::Frames(frames));
    }

    /// Begins anew if it loops (and the song is not empty), otherwise ends the segment.
    fn end_of_song(&mut self) {
        let Some(filling) = self.filling.as_mut() else { return };
        let source_rate = f64::from(self.source.sample_rate());
        if filling.skip > 0 {
            // The song is shorter than was thought: the segment starts at its end.
            filling.target = (filling.target - filling.skip as f64 / source_rate).max(0.0);
            filling.skip = 0;
            self.timeline.lock().set_start(filling.id, filling.target);
        }
        let empty = filling.from_start && filling.since_jump == 0;
        if self.looping && !empty {
            match self.source.seek(0.0) {
                Ok(_) => {
                    (filling.since_jump, filling.from_start) = (0, true);
                    let (id, lap_start) = (filling.id, filling.fed as f64 / source_rate);
                    let played = self.link.as_ref().and_then(|link| {
                        let audible =
                            link.history.at(Instant::now()).filter(|audible| audible.segment == id)?;
                        Some(audible.frame / f64::from(link.rate) - LIMITS.latency_ms_max / 1000.0)
                    });
                    self.timeline.lock().begin_lap(id, lap_start, played.unwrap_or(0.0));
                    return;
                }
                Err(error) => self.report(&*error),
            }
        }
        let Some(filling) = self.filling.as_mut() else { return };
        filling.exhausted = true;
        self.scratch.clear();
        let resampled = filling.resampler.finish(&mut self.scratch);
        filling.ready.extend(self.scratch.drain(..));
        if let Err(error) = resampled {
            self.report(&error);
        }
        self.analyse(AnalysisInput::Finish);
    }

    fn analyse(&self, input: AnalysisInput) {
        // The analysis is always faster than the sound; should it have failed, the song still plays.
        let _ = self.analysis.send(input);
    }

    fn report(&self, error: &dyn std::fmt::Display) {
        tracing::warn!("{error}");
        *self.error.lock().unwrap_or_else(PoisonError::into_inner) = Some(error.to_string());
    }
}

impl Filling {
    /// Moves into the ring what there is room for.
    fn push_ready(&mut self) {
        let (front, _) = self.ready.as_slices();
        let (pushed, _) = self.ring.push_partial_slice(front);
        let count = pushed.len();
        self.pushed += count as u64;
        self.ready.drain(..count);
    }
}
