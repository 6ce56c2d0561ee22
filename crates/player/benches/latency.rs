//! Measures the delay of the image relative to the sound, on a separate PulseAudio server with a null sink. Needs
//! `pulseaudio` and `pactl`.
//!
//! ```text
//! cargo bench --bench latency              live and file
//! cargo bench --bench latency -- live      from a sample at the monitor to the first frame that shows it
//! cargo bench --bench latency -- file      the image's song time against the sound at the monitor
//! cargo bench --bench latency -- xruns 600 glitches in 600 s of playing and listening, two busy threads per processor
//! ```
//!
//! The times of the sound are the timestamps of separate streams, which are independent of Mariana. For `live`, a
//! separate stream plays bursts. For `file`, a separate stream finds the bursts in the monitor's recording. The times
//! of the image are measured in a loop of 60 frames per second that reads the features as the window does.

#![allow(clippy::expect_used, clippy::unwrap_used, missing_docs)]
#![cfg(target_os = "linux")]

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use cpal::traits::{DeviceTrait, HostTrait, StreamTrait};
use mariana_music::{Gain, StereoFrame};
use mariana_player::input::Live;
use mariana_player::playlist::Playlist;
use mariana_player::source::{FrameSource, SourceError};
use mariana_player::track::Track;
use mariana_player::{Player, PlayerOptions, Target};
use mariana_testing::process::wait_until;
use mariana_testing::sound_session::Session;

const RATE: u32 = 48_000;
const FRAME: Duration = Duration::from_nanos(16_666_667);
/// The number of bursts. The next two constants are the bursts' length and mean distance, in frames.
const BURSTS: usize = 150;
const BURST: u64 = 960;
const DISTANCE: u64 = 24_000;
const BUFFER: u32 = 256;

fn host() -> cpal::Host {
    let pulse =
        cpal::available_hosts().into_iter().find(|host| host.name() == "PulseAudio").expect("PulseAudio");
    cpal::host_from_id(pulse).expect("the server answers")
}

fn config() -> cpal::StreamConfig {
    cpal::StreamConfig { channels: 1, sample_rate: RATE, buffer_size: cpal::BufferSize::Fixed(BUFFER) }
}

/// Returns the start of burst `n`. Distances vary, so that bursts begin anywhere in buffers, hops and frames.
fn burst_start(n: u64) -> u64 {
    RATE as u64 + n * DISTANCE + n * 7919 % 4801
}

fn sample_at(frame: u64) -> f32 {
    let n = frame.saturating_sub(RATE as u64) / DISTANCE;
    let inside = |n: u64| (burst_start(n)..burst_start(n) + BURST).contains(&frame);
    if inside(n) || (n > 0 && inside(n - 1)) {
        let noise = (frame as u32).wrapping_mul(2_654_435_761) >> 8;
        0.8 * (noise as f32 / (1 << 23) as f32 - 1.0)
    } else {
        0.0
    }
}

fn play_bursts() -> (cpal::Stream, Receiver<Instant>) {
    let (heard, bursts) = channel();
    let (mut frame, mut n) = (0_u64, 0_u64);
    let callback = move |data: &mut [f32], info: &cpal::OutputCallbackInfo| {
        let now = Instant::now();
        let stamps = info.timestamp();
        let ahead = stamps.playback.checked_duration_since(stamps.callback).unwrap_or_default();
        for (index, sample) in data.iter_mut().enumerate() {
            *sample = sample_at(frame);
            if frame == burst_start(n) {
                let _ = heard.send(now + ahead + Duration::from_secs_f64(index as f64 / f64::from(RATE)));
                n += 1;
            }
            frame += 1;
        }
    };
    let device = host().default_output_device().expect("an output");
    let stream = device.build_output_stream(config(), callback, |_| {}, None).expect("an output stream");
    stream.play().expect("a running stream");
    (stream, bursts)
}

fn find_bursts() -> (cpal::Stream, Receiver<Instant>) {
    let (found, bursts) = channel();
    let mut quiet = 0_u64;
    let callback = move |data: &[f32], info: &cpal::InputCallbackInfo| {
        let now = Instant::now();
        let stamps = info.timestamp();
        let age = stamps.callback.checked_duration_since(stamps.capture).unwrap_or_default();
        for (index, sample) in data.iter().enumerate() {
            if sample.abs() > 0.01 {
                if quiet > BURST {
                    let _ = found.send(now - age + Duration::from_secs_f64(index as f64 / f64::from(RATE)));
                }
                quiet = 0;
            } else {
                quiet += 1;
            }
        }
    };
    let host = host();
    let device = host
        .input_devices()
        .expect("inputs")
        .find(|input| input.id().is_ok_and(|id| id.to_string().ends_with("viz.monitor")));
    let stream = device
        .expect("the monitor")
        .build_input_stream(config(), callback, |_| {}, None)
        .expect("an input stream");
    stream.play().expect("a running stream");
    (stream, bursts)
}

fn each_frame(mut look: impl FnMut(Instant) -> bool) {
    let mut due = Instant::now();
    loop {
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
        if !look(Instant::now()) {
            return;
        }
        due = (due + FRAME).max(Instant::now());
    }
}

fn report(what: &str, mut milliseconds: Vec<f64>) {
    assert!(milliseconds.len() > 10, "only {} bursts were found", milliseconds.len());
    milliseconds.sort_by(f64::total_cmp);
    let at = |part: f64| milliseconds[((milliseconds.len() - 1) as f64 * part).round() as usize];
    println!(
        "{what:<62} n {:>4}  least {:>6.1}  median {:>6.1}  p95 {:>6.1}  p99 {:>6.1}  most {:>6.1} ms",
        milliseconds.len(),
        at(0.0),
        at(0.5),
        at(0.95),
        at(0.99),
        at(1.0)
    );
}

fn milliseconds_after(later: Instant, sooner: Instant) -> f64 {
    if later >= sooner { (later - sooner).as_secs_f64() * 1e3 } else { -(sooner - later).as_secs_f64() * 1e3 }
}

fn live() {
    let _session = Session::with_server();
    let mut live = Live::start(Target::Monitor, Gain::Auto).expect("a live input");
    wait_until("the monitor", || live.status().device.is_some());
    let (_stream, bursts) = play_bursts();
    let (mut shown, mut heard) = (Vec::new(), Vec::new());
    let mut before = 0.0;
    each_frame(|now| {
        let volume = live.now(0.0).features.volume[0];
        if volume > before + 0.01 && shown.last().is_none_or(|last| now - *last > Duration::from_millis(250))
        {
            shown.push(now);
        }
        before = volume;
        heard.extend(bursts.try_iter());
        shown.len() < BURSTS
    });
    let late: Vec<f64> = heard
        .iter()
        .filter_map(|heard| {
            let near = |shown: &&Instant| milliseconds_after(**shown, *heard).abs() < 200.0;
            Some(milliseconds_after(*shown.iter().find(near)?, *heard))
        })
        .collect();
    report("live: from audible to the start of the first frame with it", late);
    println!("      {} frames lost", live.status().lost);
}

struct Song(u64);

impl FrameSource for Song {
    fn sample_rate(&self) -> u32 {
        RATE
    }

    fn duration(&self) -> Option<f64> {
        None
    }

    fn next_block(&mut self, out: &mut Vec<StereoFrame>) -> Result<usize, SourceError> {
        out.extend((self.0..self.0 + 1024).map(|frame| [sample_at(frame); 2]));
        self.0 += 1024;
        Ok(1024)
    }

    fn seek(&mut self, seconds: f64) -> Result<f64, SourceError> {
        self.0 = (seconds * f64::from(RATE)).round() as u64;
        Ok(seconds)
    }
}

fn play_song() -> Player {
    let list = Box::new(Playlist::default());
    Player::start(Track::alone(Box::new(Song(0))), list, PlayerOptions::default()).expect("a player")
}

fn file() {
    let _session = Session::with_server();
    let (_stream, bursts) = find_bursts();
    let mut player = play_song();
    let (mut pictures, mut heard): (Vec<(Instant, f64)>, Vec<Instant>) = (Vec::new(), Vec::new());
    each_frame(|now| {
        pictures.push((now, player.now(0.0).song_time));
        heard.extend(bursts.try_iter());
        heard.len() < BURSTS
    });
    let errors: Vec<f64> = heard
        .iter()
        .zip(0_u64..)
        .filter_map(|(heard, n)| {
            let after = pictures.iter().position(|(at, _)| at >= heard)?;
            let (at, song_time) = *pictures.get(after.checked_sub(1)?)?;
            let picture = song_time + (*heard - at).as_secs_f64();
            Some((picture - burst_start(n) as f64 / f64::from(RATE)) * 1e3)
        })
        .collect();
    report("file: how far the image is ahead of the sound at the monitor", errors.clone());
    report("file: absolute value of the same", errors.into_iter().map(f64::abs).collect());
    println!("      {} underruns", player.status().underruns);
}

fn xruns(seconds: u64) {
    let _session = Session::with_server();
    let mut player = play_song();
    let mut live = Live::start(Target::Monitor, Gain::Auto).expect("a live input");
    wait_until("the monitor", || live.status().device.is_some() && player.status().device.is_some());
    let stop = Arc::new(AtomicBool::new(false));
    let count = 2 * std::thread::available_parallelism().map_or(2, usize::from);
    let busy: Vec<_> = (0..count)
        .map(|_| {
            let stop = stop.clone();
            std::thread::spawn(move || while !stop.load(Ordering::Relaxed) {})
        })
        .collect();
    let (before, lost_before) = (player.status().underruns, live.status().lost);
    let start = Instant::now();
    each_frame(|_| {
        let _ = (player.now(0.0), live.now(0.0));
        start.elapsed() < Duration::from_secs(seconds)
    });
    stop.store(true, Ordering::Relaxed);
    busy.into_iter().for_each(|thread| thread.join().expect("a busy thread"));
    let status = player.status();
    println!(
        "xruns: {seconds} s, {count} busy threads: {} underruns, {} input frames lost",
        status.underruns - before,
        live.status().lost - lost_before
    );
}

fn main() {
    let arguments: Vec<String> =
        std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["live"] => live(),
        ["file"] => file(),
        ["xruns", seconds] => xruns(seconds.parse().expect("seconds")),
        [] => {
            live();
            file();
        }
        _ => panic!("live, file, or xruns SECONDS"),
    }
}
