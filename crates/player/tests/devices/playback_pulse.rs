//! Tests of playback through a real stream. A separate PulseAudio server has a null sink, whose recording is compared
//! with the played song. The tests need `pulseaudio` and `parec`.

#![allow(clippy::expect_used)]

use std::time::{Duration, Instant};

use mariana_music::StereoFrame;
use mariana_player::devices::list_devices;
use mariana_player::source::{FrameSource, SourceError};
use mariana_player::track::{Found, Repeat, Track, TrackList, Wanted};
use mariana_player::{Player, PlayerOptions, PlayerStatus};
use mariana_testing::sound_server::SINK_RATE as RATE;
use mariana_testing::sound_session::Session;

struct Songs(Vec<Song>);

impl Songs {
    fn track(&self, entry: u64) -> Option<Track> {
        let mut track = Track::alone(Box::new(self.0.get(entry as usize)?.clone()));
        std::sync::Arc::make_mut(&mut track.info).entry = entry as usize;
        Some(track.with_id(entry))
    }
}

impl TrackList for Songs {
    fn find(&mut self, wanted: &Wanted, _: &mut dyn FnMut(String)) -> Found {
        match *wanted {
            Wanted::Following { after, .. } => self.track(after + 1).map_or(Found::End, Found::Track),
            _ => Found::Nothing,
        }
    }

    fn set_order(&mut self, _: Repeat, _: bool, _: u64) {}
}

/// A sound without repetition: noise on the left, a rising tone on the right.
#[derive(Clone)]
struct Song {
    frames: Vec<StereoFrame>,
    rate: u32,
    next: usize,
}

impl Song {
    fn new(seconds: f64, rate: u32) -> Self {
        let mut state = 1_u32;
        let mut smooth = 0.0_f32;
        let frames = (0..(seconds * f64::from(rate)) as usize)
            .map(|n| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let noise = (state >> 8) as f32 / (1 << 23) as f32 - 1.0;
                // Keep the noise below a few kilohertz, so that a resampler does not change it.
                smooth += 0.2 * (noise - smooth);
                let t = n as f64 / f64::from(rate);
                let tone = (std::f64::consts::TAU * (200.0 * t + 100.0 * t * t)).sin();
                [0.8 * smooth, 0.4 * tone as f32]
            })
            .collect();
        Self { frames, rate, next: 0 }
    }
}

impl FrameSource for Song {
    fn sample_rate(&self) -> u32 {
        self.rate
    }

    fn duration(&self) -> Option<f64> {
        Some(self.frames.len() as f64 / f64::from(self.rate))
    }

    fn next_block(&mut self, out: &mut Vec<StereoFrame>) -> Result<usize, SourceError> {
        let end = (self.next + 1000).min(self.frames.len());
        out.extend_from_slice(&self.frames[self.next..end]);
        let count = end - self.next;
        self.next = end;
        Ok(count)
    }

    fn seek(&mut self, seconds: f64) -> Result<f64, SourceError> {
        self.next = ((seconds * f64::from(self.rate)).round() as usize).min(self.frames.len());
        Ok(self.next as f64 / f64::from(self.rate))
    }
}

/// Returns the position in `recorded` at which `wanted` begins: the shift with the smallest left-channel difference.
fn align(recorded: &[StereoFrame], wanted: &[StereoFrame], from: usize, length: usize) -> isize {
    let stretch = &wanted[from..from + length];
    let (mut best, mut least) = (0, f32::INFINITY);
    for shift in 0..recorded.len() - length {
        let mut difference = 0.0;
        for (a, b) in recorded[shift..].iter().zip(stretch) {
            difference += (a[0] - b[0]).powi(2);
            if difference >= least {
                break;
            }
        }
        if difference < least {
            (best, least) = (shift, difference);
        }
    }
    best as isize - from as isize
}

fn compare(a: impl Iterator<Item = f32> + Clone, b: impl Iterator<Item = f32> + Clone) -> (f64, f64) {
    let dot =
        |x: &mut dyn Iterator<Item = (f32, f32)>| x.map(|(x, y)| f64::from(x) * f64::from(y)).sum::<f64>();
    let ab = dot(&mut a.clone().zip(b.clone()));
    let aa = dot(&mut a.clone().zip(a));
    let bb = dot(&mut b.clone().zip(b));
    (ab / (aa * bb).sqrt(), 10.0 * (aa / bb).log10())
}

fn play_parts(parts: Vec<Song>) -> Player {
    let list = Songs(parts);
    let first = list.track(0).expect("a part");
    Player::start(first, Box::new(list), PlayerOptions::default()).expect("a player")
}

fn wait_for(player: &mut Player, what: &str, done: impl Fn(&PlayerStatus) -> bool) -> PlayerStatus {
    let start = Instant::now();
    loop {
        let status = player.status();
        if done(&status) {
            return status;
        }
        assert!(start.elapsed() < Duration::from_secs(240), "no {what}: {status:?}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Attempts at a recording without a dropout. On a machine without free time, the sound server itself drops sound. A
/// player that drops sound does so in each attempt.
const ATTEMPTS: usize = 3;

fn played_is_recorded(rate: u32, parts: usize) {
    // If the rates are equal, the recording must equal the song created at the sink's rate.
    let wanted = if rate == RATE { Song::new(4.0, RATE).frames } else { resampled(rate) };
    let mut dropouts = Vec::new();
    for _ in 0..ATTEMPTS {
        match equals(&play_and_record(rate, parts), &wanted) {
            Ok(()) => return,
            Err(dropout) => dropouts.push(dropout),
        }
    }
    panic!("each recording has a dropout: {dropouts:?}");
}

fn play_and_record(rate: u32, parts: usize) -> Vec<StereoFrame> {
    let session = Session::with_server();
    let recorder = session.record();
    let song = Song::new(4.0, rate);
    let cuts: Vec<usize> = (0..=parts).map(|part| song.frames.len() * part / parts).collect();
    let part = |ends: &[usize]| Song { frames: song.frames[ends[0]..ends[1]].to_vec(), rate, next: 0 };
    let mut player = play_parts(cuts.windows(2).map(part).collect());
    let status = wait_for(&mut player, "the end", |status| status.ended);
    std::thread::sleep(Duration::from_millis(200));
    let recorded = recorder.finish();
    assert_eq!((status.silent, status.underruns), (None, 0));
    assert!((status.position - 4.0 / parts as f64).abs() < 1e-4, "{}", status.position);
    recorded
}

/// Compares a recording with the sound that was played, in short pieces, so that a dropout is noticed. The error names
/// the first piece that differs.
fn equals(recorded: &[StereoFrame], wanted: &[StereoFrame]) -> Result<(), String> {
    let shift = align(recorded, wanted, 24_000, 1_000);
    let range = 480..wanted.len();
    let from = (range.start as isize + shift) as usize;
    let heard = recorded.get(from..from + range.len()).ok_or("the recording is too short")?;
    for channel in 0..2 {
        for (n, (heard, wanted)) in heard.chunks(4_800).zip(wanted[range.clone()].chunks(4_800)).enumerate() {
            let pick = |frame: &StereoFrame| frame[channel];
            let (correlation, level) = compare(heard.iter().map(pick), wanted.iter().map(pick));
            if correlation.is_nan() || correlation <= 0.999 || level.abs() >= 0.1 {
                return Err(format!("channel {channel}, piece {n}: correlation {correlation}, {level} dB"));
            }
        }
    }
    let loudest = |frames: &[StereoFrame]| {
        frames.iter().flatten().fold(0.0_f32, |loudest, sample| loudest.max(sample.abs()))
    };
    let start = (shift.max(0)) as usize;
    assert!(loudest(&recorded[..start]) < 1e-3);
    assert!(loudest(&recorded[start + wanted.len() + 480..]) < 1e-3);
    Ok(())
}

fn resampled(rate: u32) -> Vec<StereoFrame> {
    let mut resampler = mariana_player::resample::Resampler::new(rate, RATE).expect("usual rates");
    let mut frames = Vec::new();
    resampler.process(&Song::new(4.0, rate).frames, &mut frames).expect("converted frames");
    resampler.finish(&mut frames).expect("converted frames");
    frames
}

#[test]
fn the_sink_plays_the_source() {
    played_is_recorded(RATE, 1);
}

#[test]
fn tracks_are_joined_without_a_gap() {
    played_is_recorded(RATE, 7);
    played_is_recorded(44_100, 7);
}

#[test]
fn another_rate_is_converted() {
    played_is_recorded(44_100, 1);
}

#[test]
fn the_clock_follows_the_sound() {
    let _session = Session::with_server();
    let mut player = play_parts(vec![Song::new(60.0, RATE)]);
    wait_for(&mut player, "the sound", |status| status.position > 1.0);
    let begin = Instant::now();
    let mut last = 0.0;
    // Returns a lower and an upper bound of how far the song is ahead of the passed time. There are two bounds because
    // this thread may be interrupted between two clock reads.
    let mut ahead = || {
        let before = begin.elapsed().as_secs_f64();
        let now = player.now(0.0).song_time;
        assert!(now >= last, "the clock stepped back");
        last = now;
        (now - begin.elapsed().as_secs_f64(), now - before)
    };
    let (from_least, from_most) = ahead();
    let mut worst = 0.0_f64;
    while begin.elapsed() < Duration::from_secs(3) {
        let (least, most) = ahead();
        worst = worst.max(least - from_most).max(from_least - most);
        std::thread::sleep(Duration::from_millis(4));
    }
    assert!(worst < 0.03, "{worst} s from an even pace");
    let status = player.status();
    assert_eq!((status.silent, status.underruns), (None, 0));
    assert!(player.now(0.0).features.volume[0] > 0.0);
}

#[test]
fn without_a_server_the_song_runs_on_the_silent_clock() {
    let _session = Session::without_server();
    let mut player = play_parts(vec![Song::new(60.0, RATE)]);
    let status = wait_for(&mut player, "the silent clock", |status| status.position > 0.05);
    assert!(status.silent.is_some(), "{status:?}");
    let (begin, from) = (Instant::now(), player.status().position);
    std::thread::sleep(Duration::from_secs(1));
    let drift = player.status().position - from - begin.elapsed().as_secs_f64();
    assert!(drift.abs() < 0.06, "off by {drift} s");
}

#[test]
fn a_server_that_dies_leaves_the_song_running() {
    let mut session = Session::with_server();
    let mut player = play_parts(vec![Song::new(60.0, RATE)]);
    let before = wait_for(&mut player, "the sound", |status| status.position > 1.0);
    assert_eq!(before.silent, None);
    session.kill_server();
    let killed = Instant::now();
    let status = wait_for(&mut player, "the fall back", |status| status.silent.is_some());
    assert!(killed.elapsed() < Duration::from_secs(3));
    let from = status.position;
    assert!(from >= before.position && from < before.position + 1.0, "from {} to {from}", before.position);
    let after = wait_for(&mut player, "progress", |status| status.position > from + 0.5);
    assert!(after.position < from + 3.0);
    let begin = Instant::now();
    drop(player);
    assert!(begin.elapsed() < Duration::from_secs(2), "{:?} until the player ended", begin.elapsed());
}

#[test]
fn the_list_names_the_sink_and_its_monitor() {
    let _session = Session::with_server();
    let report = list_devices();
    let pulse = report.hosts.first().expect("a host");
    assert_eq!(pulse.problem, None);
    let sink = pulse.outputs.iter().find(|output| output.id.ends_with("viz")).expect("the sink");
    assert!(sink.default);
    assert_eq!(sink.usual.format, "f32");
    assert!(pulse.inputs.iter().any(|input| input.id.ends_with("viz.monitor")));
    assert!(report.to_string().contains(&sink.id));
}
