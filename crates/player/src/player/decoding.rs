//! The decoding thread keeps the callback's ring filled, seeks, and moves from track to track.
//!
//! - A seek makes a new segment. The old segment sounds until the new segment has `PREFILL` seconds in its ring. The
//!   frames of the last [`PREROLL`] seconds before the target go only to the analysis. So features and their history
//!   equal those of uninterrupted playback, except for features with a longer memory.
//! - A following track stays in the segment and, at the same sample rate, in the same resampler. The analysis restarts,
//!   so that the features depend only on this track. A skip by the user makes a new segment.
//! - A new output also makes a new segment, but the song does not wait for it. The segment is due at the moment at
//!   which the output opened, so the part of the song before the segment's first audible frame is missed.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender};
use std::time::{Duration, Instant};

use mariana_music::StereoFrame;

use super::analysis::AnalysisInput;
use super::listing::{Request, SharedTrackErrors};
use crate::audible_segments::SharedAudibleSegments;
use crate::listed::{Edit, Edited};
use crate::output::OutputCallbackLink;
use crate::resample::Resampler;
use crate::source::SourceError;
use crate::track::{Found, Repeat, Track};
use passages::{Goal, Place};
use segment::CurrentSegment;
use track_queue::TrackQueue;

mod passages;
mod segment;
mod track_queue;

/// Seconds that the analysis processes before a seek's target. They fill the history. Only the beat and the bass drive
/// have a longer memory. Near the song's start there are fewer seconds.
const PREROLL: f64 = 13.0;

const CHUNK: usize = 4096;

const WAIT: Duration = Duration::from_millis(20);

/// If a wait for [`WAIT`] takes longer than this, the process was suspended.
const WAIT_MAX: Duration = Duration::from_millis(500);

/// If the position is later than this, in seconds, a skip back returns to the start of the same track.
const STEP_BACK_WITHIN: f64 = 3.0;

pub(crate) struct Decoding {
    queue: TrackQueue,
    segment: CurrentSegment,
    analysis: SyncSender<AnalysisInput>,
    track_errors: SharedTrackErrors,
    scratch: Vec<StereoFrame>,
    #[cfg(test)]
    waiting_for_idle: Vec<Sender<()>>,
}

impl Decoding {
    pub(crate) fn new(
        first: Track,
        list: Sender<Request>,
        audible_segments: SharedAudibleSegments,
        analysis: SyncSender<AnalysisInput>,
        track_errors: SharedTrackErrors,
    ) -> Self {
        Self {
            queue: TrackQueue::new(first, list, track_errors.clone()),
            segment: CurrentSegment::new(audible_segments),
            analysis,
            track_errors,
            scratch: Vec::new(),
            #[cfg(test)]
            waiting_for_idle: Vec::new(),
        }
    }

    pub(crate) fn run(mut self, inbox: &Receiver<Command>) {
        let mut wait = WAIT;
        loop {
            let waited = Instant::now();
            let first = match inbox.recv_timeout(wait) {
                Ok(command) => Some(command),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => return,
            };
            if waited.elapsed() > WAIT_MAX {
                self.segment.record_standstill();
            }
            if first.is_some_and(|first| self.obey(first, inbox)) {
                return;
            }
            self.segment.clean_up();
            self.let_go();
            wait = self.fill();
            self.segment.audible_segments.lock().next = self.queue.opened_ahead().cloned();
            #[cfg(test)]
            if wait == WAIT {
                for waiting in self.waiting_for_idle.drain(..) {
                    let _ = waiting.send(());
                }
            }
        }
    }

    /// Executes `first` and all waiting commands, merging seeks into one. Returns true on [`Command::Quit`].
    fn obey(&mut self, first: Command, inbox: &Receiver<Command>) -> bool {
        let mut goal: Option<Goal> = None;
        for command in std::iter::once(first).chain(inbox.try_iter()) {
            let place = self.place();
            let time = goal.map_or(place.time, |goal| goal.time);
            match command {
                Command::Quit => return true,
                #[cfg(test)]
                Command::AnswerWhenIdle(answer) => self.waiting_for_idle.push(answer),
                Command::SeekTo(target) => goal = Some(Goal::seek(target)),
                Command::SeekBy(seconds) => goal = Some(Goal::seek((time + seconds).max(0.0))),
                Command::Output { link, at } => {
                    // If a seek is pending, the new output starts at its target. A second output changes nothing.
                    if goal.is_none() {
                        let (passage, on_course) = self.segment.course(at, self.queue.passages.earliest());
                        self.queue.return_to(passage);
                        goal = Some(on_course);
                    }
                    self.segment.set_output(link);
                }
                Command::Skip { forward: false }
                    if self.queue.skipping.is_none() && time > STEP_BACK_WITHIN =>
                {
                    goal = Some(Goal::seek(0.0));
                }
                Command::Skip { forward } => self.queue.skip(forward),
                Command::Files(files) => self.queue.request_files(files, place.passage),
                Command::Order(repeat, shuffled) => self.queue.set_order(repeat, shuffled),
                Command::PlayEntry(entry) => self.queue.request_entry(entry),
                Command::Edit(edit) => self.queue.edit(edit, place.passage),
                Command::Edited(edited) => {
                    if self.queue.apply_edit(edited, place.passage, self.segment.is_finished())
                        && goal.is_none()
                    {
                        goal = Some(Goal::seek(place.time));
                    }
                }
                Command::Found { id, found } => {
                    if self.queue.receive(id, found, self.segment.is_finished()) {
                        goal = Some(Goal::seek(0.0));
                    }
                }
            }
        }
        let audible = self.place().passage;
        self.queue.request_skips(audible);
        if let Some(goal) = goal.filter(|goal| goal.time.is_finite()) {
            self.queue.return_to(audible);
            self.begin(goal);
        }
        false
    }

    /// The audible position, or the target of a seek that is not audible yet.
    fn place(&self) -> Place {
        self.segment.place(self.queue.passages.earliest())
    }

    fn let_go(&mut self) {
        if self.queue.passages.has_earlier() {
            let audible = self.place().passage;
            self.queue.passages.forget_before(audible);
        }
    }

    fn begin(&mut self, goal: Goal) {
        self.segment.aim(goal);
        let place = self.place().time;
        self.queue.passages.forget_earlier();
        let Some(rate) = self.segment.output_rate() else { return };
        self.segment.abandon();
        let source = self.queue.passages.source();
        let source_rate = source.sample_rate();
        let target = goal.time.max(0.0);
        let target = source.duration().map_or(target, |duration| target.min(duration));
        let resampler = match Resampler::new(source_rate, rate) {
            Ok(resampler) => resampler,
            Err(error) => return self.report(&error),
        };
        // If the target cannot be reached, try the old position, then the start of the track.
        let reached = [target, place, 0.0].into_iter().find_map(|goal| match self.seek(goal) {
            Ok(reached) => Some((goal, reached)),
            Err(error) => {
                self.report(&*error);
                None
            }
        });
        let (target, reached) = reached.unwrap_or((target, target));
        let frame_at = |seconds: f64| (seconds * f64::from(source_rate)).round() as u64;
        self.queue.passages.begin_anew();
        let passages = &self.queue.passages;
        let start = frame_at(target) as f64 / f64::from(source_rate);
        let skip = frame_at(target).saturating_sub(frame_at(reached));
        let info = passages.track().info.clone();
        self.segment.begin(passages.current(), info, start, resampler, skip, reached == 0.0);
        self.analyse_current(frame_at(reached));
        self.queue.request_ahead();
    }

    fn seek(&mut self, goal: f64) -> Result<f64, SourceError> {
        self.queue.passages.source().seek((goal - PREROLL).max(0.0))
    }

    /// Makes one step towards a full ring, and returns the time to wait for a command before the next step.
    fn fill(&mut self) -> Duration {
        if !self.segment.push() {
            return WAIT;
        }
        let has_decoded = self.segment.filling.as_mut().is_some_and(|filling| !filling.decoded.is_empty());
        if has_decoded { self.convert() } else { self.decode() }
    }

    fn decode(&mut self) -> Duration {
        self.scratch.clear();
        let decoded = match self.queue.passages.source().next_block(&mut self.scratch) {
            Ok(count) => count,
            Err(error) => {
                self.report(&*error);
                0
            }
        };
        if decoded == 0 {
            return self.end_of_track();
        }
        let Some(filling) = self.segment.filling.as_mut() else { return WAIT };
        filling.since_jump += self.scratch.len() as u64;
        filling.decoded.extend(self.scratch.drain(..));
        Duration::ZERO
    }

    fn convert(&mut self) -> Duration {
        let Some(filling) = self.segment.filling.as_mut() else { return WAIT };
        let count = filling.decoded.len().min(CHUNK);
        let frames: Vec<StereoFrame> = filling.decoded.drain(..count).collect();
        if let Err(error) = filling.feed(&frames) {
            self.report(&error);
        }
        self.analyse(AnalysisInput::Frames(frames));
        Duration::ZERO
    }

    fn end_of_track(&mut self) -> Duration {
        let (passage, rate) = (self.queue.passages.current(), self.queue.passages.source().sample_rate());
        self.segment.start_at_end(passage, rate);
        let Some(filling) = self.segment.filling.as_mut() else { return WAIT };
        let empty = filling.from_start && filling.since_jump == 0;
        match self.queue.following(empty) {
            None => return WAIT,
            Some(Found::Again) => self.segment.begin_lap(None),
            Some(Found::Track(track)) => self.join(track),
            Some(Found::End | Found::Nothing) => self.end(),
        }
        Duration::ZERO
    }

    fn join(&mut self, track: Track) {
        if let Err(error) = self.segment.set_source_rate(track.source.sample_rate()) {
            self.report(&error);
        }
        let info = track.info.clone();
        self.queue.passages.follow_with(track);
        self.segment.begin_lap(Some((self.queue.passages.current(), info)));
        self.analyse(AnalysisInput::Finish);
        self.analyse_current(0);
        self.queue.request_ahead();
    }

    fn end(&mut self) {
        let Some(filling) = self.segment.filling.as_mut() else { return };
        filling.exhausted = true;
        if let Err(error) = filling.flush() {
            self.report(&error);
        }
        self.analyse(AnalysisInput::Finish);
    }

    fn analyse_current(&self, position: u64) {
        let passages = &self.queue.passages;
        let (sample_rate, gain) = (passages.track().source.sample_rate(), passages.track().info.scene_gain);
        self.analyse(AnalysisInput::Begin { passage: passages.current(), sample_rate, position, gain });
    }

    fn analyse(&self, input: AnalysisInput) {
        // The analysis is faster than the sound, so this call blocks only briefly. If the analysis thread has ended,
        // the song still plays.
        let _ = self.analysis.send(input);
    }

    fn report(&self, error: &dyn std::fmt::Display) {
        self.track_errors.report(error.to_string());
    }
}

// Commands to the decoding thread.

pub(crate) enum Command {
    /// Plays on this output from the moment `at` on.
    Output {
        link: OutputCallbackLink,
        at: Instant,
    },
    /// Seeks to a time of the track, in seconds.
    SeekTo(f64),
    /// Seeks by seconds, forward or back.
    SeekBy(f64),
    Skip {
        forward: bool,
    },
    Files(Vec<PathBuf>),
    PlayEntry(usize),
    Edit(Edit),
    Edited(Edited),
    Order(Repeat, bool),
    Found {
        id: u64,
        found: Found,
    },
    /// Answers when the thread begins to wait, because its ring is full or the song has ended.
    #[cfg(test)]
    AnswerWhenIdle(std::sync::mpsc::Sender<()>),
    Quit,
}
