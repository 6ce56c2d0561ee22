//! Tests of the decoding thread with simulated callbacks, and of the player on the silent clock.

use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Sender, sync_channel};
use std::time::Duration;

use super::analysis::AnalysisInput;
use super::*;
use crate::clock::SpanHistory;
use crate::output::OutputCallback;
use crate::source::{FrameSource, SourceError};
use crate::track::{Found, Wanted};
use mariana_music::StereoFrame;

pub(super) const RATE: u32 = 48_000;

/// A song whose samples encode their index exactly: `(first + index) / 2^24`.
#[derive(Clone)]
pub(super) struct Ramp {
    pub(super) first: usize,
    pub(super) rate: u32,
    pub(super) frames: usize,
    pub(super) next: usize,
    pub(super) block: usize,
    pub(super) broken_at: usize,
    pub(super) seek_limit: f64,
}

impl Ramp {
    pub(super) fn new(frames: usize) -> Self {
        Self {
            first: 0,
            rate: RATE,
            frames,
            next: 0,
            block: 1152,
            broken_at: usize::MAX,
            seek_limit: f64::INFINITY,
        }
    }
}

impl FrameSource for Ramp {
    fn sample_rate(&self) -> u32 {
        self.rate
    }

    fn duration(&self) -> Option<f64> {
        None
    }

    fn next_block(&mut self, out: &mut Vec<StereoFrame>) -> Result<usize, SourceError> {
        if self.next >= self.broken_at {
            return Err("the song is damaged".into());
        }
        let end = (self.next + self.block).min(self.frames);
        let count = end - self.next;
        out.extend((self.next..end).map(|n| [(self.first + n) as f32 / (1 << 24) as f32; 2]));
        self.next = end;
        Ok(count)
    }

    fn seek(&mut self, seconds: f64) -> Result<f64, SourceError> {
        if seconds > self.seek_limit {
            return Err("the song cannot seek".into());
        }
        self.next = ((seconds * f64::from(self.rate)).round() as usize).min(self.frames);
        Ok(self.next as f64 / f64::from(self.rate))
    }
}

/// A list of songs. A song without frames represents a file that cannot be opened.
pub(super) struct Ramps {
    pub(super) songs: Vec<Ramp>,
    pub(super) repeat: Repeat,
    pub(super) delay: Duration,
    pub(super) gone: Arc<AtomicBool>,
}

impl Ramps {
    pub(super) fn new(songs: Vec<Ramp>, repeat: Repeat) -> Self {
        Self { songs, repeat, delay: Duration::ZERO, gone: Arc::default() }
    }

    pub(super) fn track(&self, entry: usize) -> Track {
        let mut track = Track::alone(Box::new(self.songs[entry].clone()));
        let info = Arc::make_mut(&mut track.info);
        (info.id, info.entry, info.count) = (entry as u64, entry, self.songs.len());
        track
    }
}

impl TrackList for Ramps {
    fn find(&mut self, wanted: &Wanted, tell: &mut dyn FnMut(String)) -> Found {
        std::thread::sleep(self.delay);
        let count = self.songs.len();
        let (mut entry, open) = match *wanted {
            Wanted::Following { anew: false, .. } if self.repeat == Repeat::One || count == 1 => {
                return if self.repeat == Repeat::Off { Found::End } else { Found::Again };
            }
            Wanted::Following { after, anew } => (after as usize + 1, (!anew).then_some(after as usize)),
            Wanted::Skip { from, steps } => ((from as i32 + steps).rem_euclid(count as i32) as usize, None),
            _ => (0, None),
        };
        for _ in 0..count {
            if entry >= count && self.repeat == Repeat::Off {
                return Found::End;
            }
            entry %= count;
            if open == Some(entry) {
                return Found::Again;
            }
            if self.songs[entry].frames > 0 && !self.gone.load(Ordering::Relaxed) {
                return Found::Track(self.track(entry));
            }
            tell(format!("song {entry} is gone"));
            entry += 1;
        }
        Found::Nothing
    }

    fn set_order(&mut self, repeat: Repeat, _: bool, _: u64) {
        self.repeat = repeat;
    }
}

pub(super) fn repeat_of(looping: bool) -> Repeat {
    if looping { Repeat::All } else { Repeat::Off }
}

pub(super) struct Stepped {
    pub(super) output_callback: OutputCallback,
    pub(super) history: Arc<SpanHistory>,
    pub(super) commands: Sender<Command>,
    pub(super) audible_segments: SharedAudibleSegments,
    pub(super) track_errors: SharedTrackErrors,
    pub(super) worker: Background,
    pub(super) now: Instant,
}

#[derive(Clone, Copy)]
pub(super) struct Heard {
    pub(super) index: Option<f64>,
    pub(super) reported_index: f64,
    pub(super) entry: usize,
    pub(super) lap: u32,
    pub(super) segment: u64,
}

impl Stepped {
    pub(super) fn new(source: Ramp, looping: bool) -> Self {
        Self::of(Ramps::new(vec![source], repeat_of(looping)), RATE)
    }

    pub(super) fn of(list: Ramps, rate: u32) -> Self {
        let audible_segments = SharedAudibleSegments::default();
        let track_errors = SharedTrackErrors::default();
        let (to_analysis, inbox) = sync_channel(1);
        // No analysis runs in these tests, so the analysis input is discarded.
        std::thread::spawn(move || inbox.into_iter().for_each(|_: AnalysisInput| {}));
        let (commands, inbox) = channel();
        let (to_list, requests) = channel();
        let work = Decoding::new(
            list.track(0),
            to_list,
            audible_segments.clone(),
            to_analysis,
            track_errors.clone(),
        );
        let (answers, reported) = (commands.clone(), track_errors.clone());
        std::thread::spawn(move || listing::run(Box::new(list), &requests, &answers, &reported));
        let worker = Background::start("decoding", move || work.run(&inbox)).expect("a thread");
        let controls = Arc::new(Controls::new(1.0, false));
        let (output_callback, link) = OutputCallback::new(rate, 480, controls);
        let history = link.history.clone();
        let now = Instant::now();
        commands.send(Command::Output { link, at: now }).expect("the thread runs");
        Self { output_callback, history, commands, audible_segments, track_errors, worker, now }
    }

    pub(super) fn send(&self, command: Command) {
        self.commands.send(command).expect("the thread runs");
    }

    pub(super) fn play(&mut self, frames: usize) -> Vec<Heard> {
        let mut heard: Vec<Heard> = Vec::new();
        let mut before = f64::NAN;
        let audible_segments = self.audible_segments.clone();
        for _ in 0..frames / 480 {
            wait_until_idle(&self.commands);
            let rate = f64::from(self.history.rate());
            let mut data = [0.0_f32; 960];
            self.output_callback.fill(&mut data, 2, self.now, Some(Duration::ZERO));
            let audible_segments = audible_segments.lock();
            for (n, pair) in data.chunks_exact(2).enumerate() {
                let value = f64::from(pair[0]) * f64::from(1 << 24);
                // Use a time that is half a frame late, so that rounding of the time does not matter.
                let moment = self.now + Duration::from_nanos(((n as f64 + 0.5) * 1e9 / rate) as u64);
                let audible = self.history.at(moment);
                if let Some((audible, place)) =
                    audible.and_then(|a| Some((a, audible_segments.place(a, 0.0)?)))
                {
                    let index = (value == before + 1.0).then_some(value);
                    let reported_index = place.song_time * rate - 0.5;
                    let entry =
                        audible_segments.place(audible, 0.0).map_or(usize::MAX, |place| place.track.entry);
                    heard.push(Heard {
                        index,
                        reported_index,
                        entry,
                        lap: place.lap,
                        segment: audible.segment,
                    });
                }
                before = value;
            }
            drop(audible_segments);
            self.now += Duration::from_secs_f64(480.0 / rate);
            std::thread::sleep(Duration::from_millis(2));
        }
        heard
    }

    pub(super) fn samples(&mut self, frames: usize) -> Vec<f32> {
        let mut samples = Vec::new();
        while samples.len() < frames {
            wait_until_idle(&self.commands);
            let mut data = [0.0_f32; 960];
            self.output_callback.fill(&mut data, 2, self.now, Some(Duration::ZERO));
            let left = data.iter().step_by(2).skip_while(|sample| samples.is_empty() && **sample == 0.0);
            samples.extend(left.collect::<Vec<_>>());
            self.now += Duration::from_millis(10);
            std::thread::sleep(Duration::from_millis(2));
        }
        samples.truncate(frames);
        samples
    }

    pub(super) fn change_device(&mut self, rate: u32) {
        let (output_callback, link) = OutputCallback::new(rate, 480, Arc::new(Controls::new(1.0, false)));
        self.history = link.history.clone();
        self.output_callback = output_callback;
        self.send(Command::Output { link, at: self.now });
        // Late frames are dropped, so the simulated time waits for the thread.
        wait_until_idle(&self.commands);
        assert!(self.output_callback.is_offered(), "no frames are decoded for the device");
    }

    pub(super) fn begin(&mut self) {
        let start = Instant::now();
        while self.play(480).is_empty() {
            assert!(start.elapsed() < Duration::from_secs(5), "no segment is audible");
        }
    }
}

impl Drop for Stepped {
    fn drop(&mut self) {
        let _ = self.commands.send(Command::Quit);
        assert!(self.worker.finish(Duration::from_secs(5)) || std::thread::panicking());
    }
}

/// Waits until the decoding thread has obeyed all commands and filled its ring, however slow the machine is.
pub(super) fn wait_until_idle(commands: &Sender<Command>) {
    let (answer, answers) = channel();
    commands.send(Command::AnswerWhenIdle(answer)).expect("the thread runs");
    answers.recv_timeout(Duration::from_secs(60)).expect("the thread becomes idle");
}

fn assert_reported(heard: &[Heard], least_part: f64) {
    let clear: Vec<_> = heard.iter().filter_map(|heard| Some((heard.index?, heard.reported_index))).collect();
    assert!(
        clear.len() as f64 >= least_part * heard.len() as f64,
        "{} of {} are clear",
        clear.len(),
        heard.len()
    );
    for (index, reported) in clear {
        assert!((index - reported).abs() < 0.01, "heard frame {index}, reported {reported}");
    }
}

#[test]
fn loops_are_gapless_and_reported() {
    let song = 10_007;
    let mut stepped = Stepped::new(Ramp::new(song), true);
    stepped.begin();
    let heard = stepped.play(60_000);
    assert_reported(&heard, 0.99);
    let last = heard.last().expect("frames");
    assert!(last.lap >= 5 && last.segment == 1);
    // No frame is missing or repeated in any lap or at the start of a lap.
    for pair in heard.windows(2) {
        let [before, after] = [pair[0].reported_index, pair[1].reported_index];
        assert!((after - before - 1.0).abs() < 0.01 || (before - after - song as f64 + 1.0).abs() < 0.01);
    }
}

#[test]
fn many_seeks_end_at_the_last_target() {
    let mut stepped = Stepped::new(Ramp::new(9_000_000), true);
    stepped.begin();
    let mut target = 0.0;
    for n in 0..300_u32 {
        target = f64::from(n * 7919 % 1800) / 10.0 + 0.0123;
        stepped.send(Command::SeekTo(target));
        if n % 3 == 0 {
            assert_reported(&stepped.play(480 * (n % 7) as usize), 0.0);
        }
    }
    stepped.send(Command::SeekBy(0.5));
    let heard = stepped.play(9600 * 4);
    assert_reported(&heard, 0.7);
    let last = heard.last().expect("frames");
    let first = heard.iter().find(|heard| heard.segment == last.segment).expect("frames");
    assert!((first.reported_index / f64::from(RATE) - (target + 0.5)).abs() < 2.0 / f64::from(RATE));
}

#[test]
fn the_end_comes_after_the_last_frame_and_a_seek_resumes() {
    let song = 30_000;
    let mut stepped = Stepped::new(Ramp::new(song), false);
    let mut heard = Vec::new();
    let ended = |stepped: &Stepped| {
        stepped.history.at(stepped.now).is_some_and(|a| stepped.audible_segments.lock().is_end(a))
    };
    let start = Instant::now();
    while !ended(&stepped) && start.elapsed() < Duration::from_secs(60) {
        heard.extend(stepped.play(480));
    }
    assert!(ended(&stepped));
    let last = heard.iter().rev().find_map(|heard| heard.index);
    assert_eq!(last, Some(song as f64 - 1.0));
    stepped.send(Command::SeekTo(0.1));
    let heard = stepped.play(9600);
    assert_reported(&heard, 0.3);
    assert!(!ended(&stepped));
    stepped.send(Command::SeekTo(99.0));
    let last = stepped.play(9600).pop().expect("frames");
    assert!((last.reported_index + 0.5 - song as f64).abs() < 0.01, "{}", last.reported_index);
    assert!(ended(&stepped));
}

#[test]
fn an_empty_song_ends_at_once_and_is_silence_when_it_loops() {
    let mut once = Stepped::new(Ramp::new(0), false);
    once.begin();
    let audible = once.history.at(once.now).expect("a span");
    assert!(once.audible_segments.lock().is_end(audible));
    let mut looping = Stepped::new(Ramp::new(0), true);
    looping.begin();
    let heard = looping.play(9_600);
    assert!(heard.iter().all(|heard| heard.index.is_none()));
    let last = heard.last().expect("frames").reported_index;
    assert!(last > 9_000.0, "the show stops at frame {last}");
}

#[test]
fn damage_is_reported_and_ends_the_song() {
    let mut stepped = Stepped::new(Ramp { broken_at: 11_520, ..Ramp::new(90_000) }, false);
    stepped.begin();
    let heard = stepped.play(14_400);
    assert_eq!(heard.iter().rev().find_map(|heard| heard.index), Some(11_519.0));
    assert_eq!(stepped.track_errors.get().last.as_deref(), Some("the song is damaged"));
}

#[test]
fn a_failed_seek_is_reported_and_the_song_continues() {
    let mut stepped = Stepped::new(Ramp { seek_limit: 2.0, ..Ramp::new(900_000) }, true);
    stepped.begin();
    stepped.send(Command::SeekTo(2.5));
    assert_reported(&stepped.play(9600), 0.8);
    stepped.send(Command::SeekTo(18.0));
    let heard = stepped.play(9600);
    assert_reported(&heard, 0.8);
    assert_eq!(stepped.track_errors.get().last.as_deref(), Some("the song cannot seek"));
    let last = heard.last().expect("frames").reported_index / f64::from(RATE);
    assert!((2.0..4.0).contains(&last), "{last} s");
}

pub(super) fn wait_for(player: &mut Player, what: &str, mut done: impl FnMut(&mut Player) -> bool) {
    let start = Instant::now();
    while !done(player) {
        assert!(start.elapsed() < Duration::from_secs(5), "{what}: {:?}", player.status());
        std::thread::sleep(Duration::from_millis(2));
    }
}

pub(super) fn silent(looping: bool) -> PlayerOptions {
    PlayerOptions { repeat: repeat_of(looping), output: None, ..PlayerOptions::default() }
}

fn play(song: Ramp, options: PlayerOptions) -> Player {
    let list = Ramps::new(vec![song], options.repeat);
    Player::start(list.track(0), Box::new(list), options).expect("a player")
}

fn start(frames: usize, options: PlayerOptions) -> Player {
    let mut player = play(Ramp::new(frames), options);
    wait_for(&mut player, "the first callback", |player| {
        player.supervisor.status().note.is_some_and(|history| history.calls() > 2)
    });
    player
}

#[test]
fn the_silent_clock_runs_in_real_time_and_says_so() {
    let mut player = start(9_000_000, silent(true));
    wait_for(&mut player, "it moves", |player| player.status().position > 0.0);
    let (begin, from) = (Instant::now(), player.status().position);
    let mut last = from;
    while begin.elapsed() < Duration::from_millis(1500) {
        let position = player.status().position;
        assert!(position >= last, "the clock stepped back");
        last = position;
        std::thread::sleep(Duration::from_millis(3));
    }
    let drift = (last - from) - begin.elapsed().as_secs_f64();
    assert!(drift.abs() < 0.06, "off by {drift} s");
    let status = player.status();
    assert!(status.silent.is_some() && !status.ended);
}

#[test]
fn the_position_stops_in_a_pause_except_for_seeks() {
    let mut player = start(9_000_000, silent(true));
    wait_for(&mut player, "it moves", |player| player.now(0.0).song_time > 0.05);
    player.set_paused(true);
    std::thread::sleep(Duration::from_millis(60));
    let stands = player.now(0.0);
    std::thread::sleep(Duration::from_millis(60));
    assert_eq!(player.now(0.0).song_time, stands.song_time);
    player.seek_to(100.0);
    wait_for(&mut player, "the seek", |player| player.now(0.0).song_time == 100.0);
    assert!(player.now(0.0).segment > stands.segment);
    // The features match the position: the volume is the ramp's level at this position.
    wait_for(&mut player, "the features", |player| player.now(0.0).features.volume[0] > 0.0);
    player.seek_by(-30.0);
    wait_for(&mut player, "the step back", |player| player.status().position == 70.0);
    player.set_paused(false);
    wait_for(&mut player, "the song continues", |player| player.status().position > 70.02);
}

#[test]
fn the_shift_delays_or_advances_the_moment() {
    let mut player = start(9_000_000, silent(true));
    wait_for(&mut player, "it moves", |player| player.now(0.0).song_time > 0.4);
    let now = player.now(0.0).song_time;
    let (late, early) = (player.now(0.25).song_time, player.now(-0.2).song_time);
    assert!((now - late - 0.25).abs() < 0.05, "{late} at {now}");
    assert!((early - now - 0.2).abs() < 0.05, "{early} at {now}");
}

#[test]
fn without_repeat_the_song_ends() {
    let mut player = start(12_000, silent(false));
    wait_for(&mut player, "the end", |player| player.status().ended);
    let status = player.status();
    assert!((status.position - 0.25).abs() < 1e-9, "{}", status.position);
    assert_eq!(status.underruns, 0);
}

#[test]
fn volume_and_mute_are_kept_in_range() {
    let mut player = start(12_000, silent(true));
    player.change_volume(-0.25);
    assert_eq!(player.status().volume, 0.75);
    player.change_volume(9.0);
    assert_eq!(player.status().volume, 1.0);
    player.toggle_mute();
    assert!(player.status().muted);
}

#[test]
fn an_unknown_device_is_named_and_the_song_runs_without_sound() {
    let options =
        PlayerOptions { output: Some(Target::Named("no such box".into())), ..PlayerOptions::default() };
    let mut player = start(9_000_000, options);
    wait_for(&mut player, "it moves", |player| player.status().position > 0.1);
    let reason = player.status().silent.expect("a reason for silence");
    assert!(reason.contains("no such box") && reason.contains("mariana devices"), "{reason}");
}

#[test]
fn the_player_stops_promptly() {
    let player = start(9_000_000, silent(true));
    let begin = Instant::now();
    drop(player);
    assert!(begin.elapsed() < Duration::from_millis(900), "{:?}", begin.elapsed());
}
