//! The decoding thread: keeps the ring of the callback filled, seeks, and goes from track to track.
//!
//! A seek makes a new segment. The old one goes on sounding until the new one has [`PREFILL`] seconds in its ring.
//! The frames of the last [`PREROLL`] seconds before the target go to the analysis alone, so that after a seek the
//! features and their history are those of an uninterrupted playback, except for what longer memories still hold.
//!
//! A track that follows another stays in its segment: its frames go into the same ring, through the same resampler if
//! the rate is the same. The list thread opens it while the one before plays. The analysis begins anew, so that the
//! features are those of the track alone, whatever came before. A skip by hand makes a new segment.
//!
//! Another output also makes a new segment, but the song does not wait for it: it runs on from where it was audible,
//! and the segment is due from the moment at which the output came. Whatever passes until its first frame is heard is
//! lost to the ear.

mod place;

use std::collections::VecDeque;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, TryRecvError};
use std::time::{Duration, Instant};

use super::analysis::AnalysisInput;
use super::filling::Filling;
use super::listing::{Request, SharedTroubles};
use crate::limits::LIMITS;
use crate::output::OutputCallbackLink;
use crate::resample::Resampler;
use crate::source::SourceError;
use crate::timeline::SharedTimeline;
use crate::track::{Found, Repeat, Track, Wanted};
use mariana_music::StereoFrame;
use place::Goal;

/// Depth of the ring, in seconds, or [`RING_BUFFERS`] buffers of the device if that is more.
const RING: f64 = 0.4;

/// See [`RING`].
const RING_BUFFERS: usize = 4;

/// How much of a segment must be ready before it is heard, in seconds: more than the analysis looks ahead.
const PREFILL: f64 = 0.15;

/// How much the analysis hears before a seek's target, in seconds: what a history spans, and the time in which
/// everything but the beat and the bass drive is forgotten. Near the song's start it is less, and the history before
/// it is silent.
const PREROLL: f64 = 13.0;

/// Frames that are analysed and resampled at a time.
const CHUNK: usize = 4096;

/// Time between two checks whether the ring has room.
const WAIT: Duration = Duration::from_millis(20);

/// If a wait of [`WAIT`] took longer than this, the process stood still.
const WAIT_MAX: Duration = Duration::from_millis(500);

/// Later than this in a track, in seconds, a step back leads to its own start.
const STEP_BACK_WITHIN: f64 = 3.0;

/// After this many tracks in a row without a frame, silence is played.
const EMPTY_TRACKS_MAX: u32 = 64;

/// What the window, the supervisor and the list thread ask for or deliver.
pub(crate) enum Command {
    /// Play on this output from `at` on.
    Output {
        /// The output.
        link: OutputCallbackLink,
        /// When it came.
        at: Instant,
    },
    /// Go to a time of the track, in seconds.
    SeekTo(f64),
    /// Go forward or back by seconds.
    SeekBy(f64),
    /// Go to the next track, or back.
    Skip {
        /// Whether it is the next.
        forward: bool,
    },
    /// Play these files instead of the list.
    Files(Vec<std::path::PathBuf>),
    /// Change the order and the repeating of tracks.
    Order(Repeat, bool),
    /// The list thread's answer to request `id`.
    Found {
        /// The request.
        id: u64,
        /// The answer.
        found: Found,
    },
    /// End the thread.
    Quit,
}

/// What comes after the track that is being decoded.
enum Next {
    Unasked,
    /// The list thread is looking for it, as this request.
    Asked(u64),
    Again,
    Track(Track),
    End,
}

/// A track, and the passage in which it is played.
struct Playing {
    passage: u64,
    track: Track,
}

/// The thread's state.
pub(crate) struct Decoding {
    current: Playing,
    /// Earlier tracks of the segment whose ends may still sound.
    before: VecDeque<Playing>,
    next: Next,
    /// A skip for which the list thread is searching.
    skipping: Option<u64>,
    /// Steps of further skips that were asked for meanwhile.
    steps: i32,
    /// Tracks without a frame, in a row.
    empty_tracks: u32,
    list: Sender<Request>,
    last_request: u64,
    last_passage: u64,
    timeline: SharedTimeline,
    analysis: SyncSender<AnalysisInput>,
    troubles: SharedTroubles,
    link: Option<OutputCallbackLink>,
    filling: Option<Filling>,
    last_id: u64,
    /// Grows with each seek and each skip.
    run: u64,
    /// When the first frame of the segment is due, if it has to meet a time.
    due: Option<Instant>,
    /// How many calls the output had made when the process last stood still.
    stood_still: Option<u64>,
    /// Where to start once there is an output, in seconds.
    start: f64,
    scratch: Vec<StereoFrame>,
}

enum Step {
    GoOn,
    Wait,
}

impl Decoding {
    pub(crate) fn new(
        first: Track,
        list: Sender<Request>,
        timeline: SharedTimeline,
        analysis: SyncSender<AnalysisInput>,
        troubles: SharedTroubles,
    ) -> Self {
        Self {
            current: Playing { passage: 0, track: first },
            before: VecDeque::new(),
            next: Next::Unasked,
            skipping: None,
            steps: 0,
            empty_tracks: 0,
            list,
            last_request: 0,
            last_passage: 0,
            timeline,
            analysis,
            troubles,
            link: None,
            filling: None,
            last_id: 0,
            run: 0,
            due: None,
            stood_still: None,
            start: 0.0,
            scratch: Vec::new(),
        }
    }

    /// Works until [`Command::Quit`] or until the player is gone.
    pub(crate) fn run(mut self, inbox: &Receiver<Command>) {
        let mut next = Step::Wait;
        loop {
            let waited = Instant::now();
            let first = match next {
                Step::GoOn => match inbox.try_recv() {
                    Ok(command) => Some(command),
                    Err(TryRecvError::Empty) => None,
                    Err(TryRecvError::Disconnected) => return,
                },
                Step::Wait => match inbox.recv_timeout(WAIT) {
                    Ok(command) => Some(command),
                    Err(RecvTimeoutError::Timeout) => None,
                    Err(RecvTimeoutError::Disconnected) => return,
                },
            };
            if waited.elapsed() > WAIT_MAX {
                self.stood_still = self.link.as_ref().map(|link| link.history.calls());
            }
            if first.is_some_and(|first| self.obey(first, inbox)) {
                return;
            }
            if let Some(link) = &mut self.link {
                link.clean_up();
            }
            self.let_go();
            next = self.fill();
        }
    }

    /// Carries out `first` and the commands waiting behind it, merging many seeks into one. True to end.
    fn obey(&mut self, first: Command, inbox: &Receiver<Command>) -> bool {
        let mut goal: Option<Goal> = None;
        for command in std::iter::once(first).chain(inbox.try_iter()) {
            match command {
                Command::Quit => return true,
                Command::SeekTo(time) => goal = Some(Goal::seek(time)),
                Command::SeekBy(seconds) => {
                    let from = goal.map_or_else(|| self.place().1, |goal| goal.time);
                    goal = Some(Goal::seek((from + seconds).max(0.0)));
                }
                Command::Output { link, at } => {
                    // A pending seek is done on the new output, and a further output does not change the place.
                    if goal.is_none() {
                        let (passage, on_course) = self.course(at);
                        self.go_back_to(passage);
                        goal = Some(on_course);
                    }
                    self.link = Some(link);
                    self.stood_still = None;
                }
                Command::Skip { forward: false }
                    if self.skipping.is_none()
                        && goal.map_or_else(|| self.place().1, |goal| goal.time) > STEP_BACK_WITHIN =>
                {
                    goal = Some(Goal::seek(0.0));
                }
                Command::Skip { forward } => self.steps += if forward { 1 } else { -1 },
                Command::Files(files) => {
                    (self.skipping, self.steps) = (self.request(Wanted::Files(files)), 0);
                }
                Command::Order(repeat, shuffled) => {
                    let current = self.current.track.info.entry;
                    let _ = self.list.send(Request::Order { repeat, shuffled, current });
                    self.ask(false);
                }
                Command::Found { id, found } => {
                    if self.take(id, found) {
                        goal = Some(Goal::seek(0.0));
                    }
                }
            }
        }
        if self.steps != 0 && self.skipping.is_none() {
            let steps = std::mem::take(&mut self.steps);
            let from = self.audible_entry();
            self.skipping = self.request(Wanted::Skip { from, steps });
        }
        if let Some(goal) = goal.filter(|goal| goal.time.is_finite()) {
            self.go_back_to_audible();
            self.begin(goal);
        }
        false
    }

    /// Takes an answer of the list thread. True if another track is to begin because of a skip.
    fn take(&mut self, id: u64, found: Found) -> bool {
        if self.skipping == Some(id) {
            self.skipping = None;
            match found {
                Found::Track(track) => self.replace(track),
                Found::Again => {}
                Found::End => {
                    self.troubles.tell("the list ends here; press L to repeat it".into());
                    return false;
                }
                // What is wrong has been reported already.
                Found::Nothing => return false,
            }
            return true;
        }
        if !matches!(self.next, Next::Asked(asked) if asked == id) {
            // The answer is no longer wanted.
            return false;
        }
        // The list had ended but goes on after all, because repeating was asked for.
        let ended = self.filling.as_ref().is_some_and(|filling| filling.finished);
        self.next = match found {
            Found::Track(track) if ended => {
                self.replace(track);
                return true;
            }
            Found::Again if ended => return true,
            Found::Track(track) => Next::Track(track),
            Found::Again => Next::Again,
            Found::End => Next::End,
            Found::Nothing => Next::Track(self.silence()),
        };
        false
    }

    fn silence(&self) -> Track {
        let info = &self.current.track.info;
        Track::silence(info.entry, info.count)
    }

    /// Replaces everything that is open by another track.
    fn replace(&mut self, track: Track) {
        self.before.clear();
        // The passage begins with the segment to come; until then nothing of it is audible.
        self.last_passage += 1;
        self.current = Playing { passage: self.last_passage, track };
        self.empty_tracks = 0;
        self.ask(false);
    }

    /// Asks the list thread for what follows the current track; `anew` if that track would have to be opened again to
    /// repeat.
    fn ask(&mut self, anew: bool) {
        let after = self.current.track.info.entry;
        self.next = self.request(Wanted::Following { after, anew }).map_or(Next::End, Next::Asked);
    }

    /// Asks the list thread; none if that has ended.
    fn request(&mut self, wanted: Wanted) -> Option<u64> {
        self.last_request += 1;
        let id = self.last_request;
        self.list.send(Request::Find { id, wanted }).ok().map(|()| id)
    }

    /// Starts a segment in the current track.
    fn begin(&mut self, goal: Goal) {
        let Goal { time, same_run, due } = goal;
        let target = time.max(0.0);
        self.start = target;
        self.run += u64::from(!same_run);
        self.due = due;
        let (_, place) = self.place();
        self.before.clear();
        let Some((rate, buffer_frames)) = self.link.as_ref().map(|link| (link.rate, link.buffer_frames))
        else {
            return;
        };
        if let Some(unheard) = self.filling.take().filter(|filling| filling.waiting.is_some()) {
            self.timeline.lock().discard(unheard.id);
        }
        let source = &self.current.track.source;
        let source_rate = source.sample_rate();
        let target = source.duration().map_or(target, |duration| target.min(duration));
        let resampler = match Resampler::new(source_rate, rate) {
            Ok(resampler) => resampler,
            Err(error) => return self.report(&error),
        };
        // If the target cannot be reached: stay, or begin anew.
        let reached = [target, place, 0.0].into_iter().find_map(|goal| match self.seek(goal) {
            Ok(reached) => Some((goal, reached)),
            Err(error) => {
                self.report(&*error);
                None
            }
        });
        let (target, reached) = reached.unwrap_or((target, target));
        let frame_at = |seconds: f64| (seconds * f64::from(source_rate)).round() as u64;
        // The exact time of the target's frame.
        let target = frame_at(target) as f64 / f64::from(source_rate);
        self.last_id += 1;
        self.last_passage += 1;
        (self.current.passage, self.start) = (self.last_passage, target);
        let info = self.current.track.info.clone();
        self.timeline.lock().begin(self.last_id, self.run, rate, self.last_passage, target, info);
        self.analyse_current(frame_at(reached));
        let ring_frames = ((RING * f64::from(rate)) as usize).max(RING_BUFFERS * buffer_frames);
        let skip = frame_at(target).saturating_sub(frame_at(reached));
        let mut filling = Filling::new(self.last_id, target, ring_frames, resampler, skip, reached == 0.0);
        if let Some(due) = self.due {
            filling.waiting = filling.waiting.take().map(|segment| segment.due_at(due));
        }
        self.filling = Some(filling);
        if matches!(self.next, Next::Unasked) {
            self.ask(false);
        }
    }

    fn seek(&mut self, goal: f64) -> Result<f64, SourceError> {
        self.current.track.source.seek((goal - PREROLL).max(0.0))
    }

    /// Does the next piece of work on the segment.
    fn fill(&mut self) -> Step {
        let (Some(link), Some(filling)) = (self.link.as_mut(), self.filling.as_mut()) else {
            return Step::Wait;
        };
        filling.push_ready();
        if filling.is_pushed() && filling.exhausted && !filling.finished {
            filling.finished = true;
            filling.end.store(filling.pushed, Ordering::Release);
            self.timeline.lock().finish(filling.id, filling.pushed);
        }
        let prefill = ((PREFILL * f64::from(link.rate)) as u64).min(filling.ring.buffer().capacity() as u64);
        // What is heard first must have its features, unless there is no room to wait for them.
        let is_full = !filling.is_pushed();
        let is_ready = filling.pushed >= prefill && (is_full || self.timeline.lock().has_begun(filling.id));
        if (is_ready || filling.finished)
            && let Some(segment) = filling.waiting.take()
        {
            filling.waiting = link.offer(segment).err();
        }
        if filling.finished || !filling.is_pushed() {
            return Step::Wait;
        }
        if filling.decoded.is_empty() { self.decode() } else { self.convert() }
    }

    fn decode(&mut self) -> Step {
        self.scratch.clear();
        let decoded = match self.current.track.source.next_block(&mut self.scratch) {
            Ok(count) => count,
            Err(error) => {
                self.report(&*error);
                0
            }
        };
        let Some(filling) = self.filling.as_mut() else { return Step::Wait };
        if decoded == 0 {
            return self.end_of_track();
        }
        filling.since_jump += self.scratch.len() as u64;
        filling.decoded.extend(self.scratch.drain(..));
        Step::GoOn
    }

    /// Analyses and resamples the next decoded frames.
    fn convert(&mut self) -> Step {
        let Some(filling) = self.filling.as_mut() else { return Step::Wait };
        let count = filling.decoded.len().min(CHUNK);
        let frames: Vec<StereoFrame> = filling.decoded.drain(..count).collect();
        if let Err(error) = filling.feed(&frames, &mut self.scratch) {
            self.report(&error);
        }
        self.analyse(AnalysisInput::Frames(frames));
        Step::GoOn
    }

    /// Goes on with what follows: the same track, another, or nothing.
    fn end_of_track(&mut self) -> Step {
        let Some(filling) = self.filling.as_mut() else { return Step::Wait };
        if filling.skip > 0 {
            // The track is shorter than was thought: the segment starts at its end.
            let rate = f64::from(self.current.track.source.sample_rate());
            filling.target = (filling.target - filling.skip as f64 / rate).max(0.0);
            filling.skip = 0;
            self.timeline.lock().set_start(self.current.passage, filling.target);
        }
        let empty = filling.from_start && filling.since_jump == 0;
        match std::mem::replace(&mut self.next, Next::Unasked) {
            Next::Unasked => {
                self.ask(false);
                Step::Wait
            }
            Next::Asked(id) => {
                self.next = Next::Asked(id);
                Step::Wait
            }
            Next::Again if empty => {
                self.ask(true);
                Step::Wait
            }
            Next::Again => self.begin_lap(),
            Next::Track(track) => {
                self.empty_tracks = if empty { self.empty_tracks + 1 } else { 0 };
                if self.empty_tracks > EMPTY_TRACKS_MAX {
                    self.troubles.tell("there is no sound in these tracks; choose others".into());
                    let silence = self.silence();
                    self.join(silence)
                } else {
                    self.join(track)
                }
            }
            Next::End => self.end(),
        }
    }

    /// Begins the current track anew, without a gap.
    fn begin_lap(&mut self) -> Step {
        if let Err(error) = self.current.track.source.seek(0.0) {
            self.report(&*error);
            self.ask(true);
            return Step::Wait;
        }
        self.next = Next::Again;
        let played = self.played();
        let Some(filling) = self.filling.as_mut() else { return Step::Wait };
        (filling.since_jump, filling.from_start) = (0, true);
        self.timeline.lock().begin_lap(filling.id, filling.next_time(), played);
        Step::GoOn
    }

    /// Goes on with `track`, which stands at its start, without a gap.
    fn join(&mut self, track: Track) -> Step {
        let played = self.played();
        let Some((filling, link)) = self.filling.as_mut().zip(self.link.as_ref()) else { return Step::Wait };
        let rate = track.source.sample_rate();
        if rate != filling.resampler.from_hz() {
            let changed = Resampler::new(rate, link.rate)
                .and_then(|resampler| filling.change_resampler(resampler, link.rate, &mut self.scratch));
            if let Err(error) = changed {
                self.report(&error);
            }
        }
        let Some(filling) = self.filling.as_mut() else { return Step::Wait };
        (filling.since_jump, filling.from_start) = (0, true);
        self.last_passage += 1;
        let (id, time, info) = (filling.id, filling.next_time(), track.info.clone());
        self.timeline.lock().begin_track(id, time, played, self.last_passage, info);
        let current = Playing { passage: self.last_passage, track };
        self.before.push_back(std::mem::replace(&mut self.current, current));
        self.analyse(AnalysisInput::Finish);
        self.analyse_current(0);
        // The next one is opened ahead.
        self.ask(false);
        Step::GoOn
    }

    /// Ends the segment: nothing follows.
    fn end(&mut self) -> Step {
        self.next = Next::End;
        let Some(filling) = self.filling.as_mut() else { return Step::Wait };
        filling.exhausted = true;
        if let Err(error) = filling.flush(&mut self.scratch) {
            self.report(&error);
        }
        self.analyse(AnalysisInput::Finish);
        Step::GoOn
    }

    /// Time of the segment that is certainly past, however late the picture is, in seconds.
    fn played(&self) -> f64 {
        let rate = self.link.as_ref().map_or(1, |link| link.rate);
        let audible = self.audible().map_or(0.0, |audible| audible.frame / f64::from(rate));
        audible - LIMITS.latency_ms_max / 1000.0
    }

    /// Tells the analysis that the current track begins, with frame `position`.
    fn analyse_current(&self, position: u64) {
        let Playing { passage, track } = &self.current;
        let (sample_rate, gain) = (track.source.sample_rate(), track.info.scene_gain);
        self.analyse(AnalysisInput::Begin { passage: *passage, sample_rate, position, gain });
    }

    fn analyse(&self, input: AnalysisInput) {
        // The analysis is always faster than the sound; if it should have failed, the song still plays.
        let _ = self.analysis.send(input);
    }

    fn report(&self, error: &dyn std::fmt::Display) {
        self.troubles.tell(error.to_string());
    }
}
