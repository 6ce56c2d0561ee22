//! Measures beat tracking on real songs: `cargo run --release -p mariana-music --example beat_figures -- BEATS SONG...`
//! prints a table. The songs are files that `ffmpeg` can read. For each song `NAME.*`, the folder `BEATS` has a file
//! `NAME.beats` with the time of one true beat in seconds on each line. Songs without such a file are skipped. If there
//! is a file `NAME.second` from a second judge, the means are also printed for the songs on which both judges agree.
//!
//! If there is a file `NAME.onsets` with the times of onsets, the F-measure of the onsets is printed.
//!
//! The column `heard` is for live input and `whole` for an analysis of the whole song. F is the F-measure with a
//! tolerance of ±70 ms. AMLt is the fraction of beats whose position and distance from the previous beat are right
//! within 17.5 %; double tempo, half tempo and the off-beat also count as right (Davies, Degara and Plumbley 2009). The
//! first 5 s and the time after the last true beat do not count. The kinds of a result: `right` (F of 0.7 and more),
//! `double`, `half`, `off-beat`, `none` (hardly a beat found), `other`. `lock` is the time of the first of four
//! consecutive right beats in live input. `jumps` counts how often per minute the tempo changes by more than 8 %. The
//! last column is the time that the analysis of the whole song took, in seconds.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use mariana_music::{Alignment, Analyzer, SongListener, StereoFrame, TimedFeatures};

const RATE: u32 = 44_100;
const SETTLED: f64 = 5.0;
const TOLERANCE: f64 = 0.07;
const FRACTION: f64 = 0.175;
const JUMP: f64 = 0.08;
/// Two judges agree if the F-measure of their beats is at least this.
const AGREED: f64 = 0.7;

fn decoded(song: &Path) -> Result<Vec<StereoFrame>, Box<dyn Error>> {
    let output = Command::new("ffmpeg")
        .args(["-nostdin", "-v", "error", "-protocol_whitelist", "file"])
        .args(["-format_whitelist", "aac,aiff,caf,flac,matroska,mov,mp3,ogg,wav", "-i"])
        .arg(song)
        .args(["-f", "f32le", "-ac", "2", "-ar", "44100", "-"])
        .output()?;
    let sample = |four: &[u8; 4]| f32::from_le_bytes(*four);
    let samples: Vec<f32> = output.stdout.as_chunks::<4>().0.iter().map(sample).collect();
    Ok(samples.as_chunks::<2>().0.to_vec())
}

fn followed(frames: &[StereoFrame], alignment: Alignment) -> (Vec<f64>, f64) {
    let mut beats = Vec::new();
    let mut last = (0.0, 0.0, 0.0);
    let (mut jumps, mut kept) = (0, 0.0);
    let mut take = |moment: &TimedFeatures| {
        let (phase, tempo) = (f64::from(moment.features.phase), f64::from(moment.features.tempo));
        let (last_time, last_phase, last_tempo) = last;
        if tempo > 0.0 && last_tempo > 0.0 && phase < last_phase - 0.5 {
            let step = phase + 1.0 - last_phase;
            beats.push(moment.time - (moment.time - last_time) * phase / step);
        }
        if tempo > 0.0 {
            if kept > 0.0 && (tempo / kept - 1.0_f64).abs() > JUMP {
                jumps += 1;
                kept = tempo;
            }
            // A slow change is not a jump.
            kept = if kept > 0.0 { kept + 0.01 * (tempo - kept) } else { tempo };
        }
        last = (moment.time, phase, tempo);
    };
    let mut analyzer = Analyzer::new(RATE, alignment);
    analyzer.push(frames, &mut take);
    analyzer.finish(&mut take);
    let minutes = frames.len() as f64 / f64::from(RATE) / 60.0;
    (beats, f64::from(jumps) / minutes)
}

fn whole(frames: &[StereoFrame]) -> Vec<f64> {
    let mut listener = SongListener::new(RATE);
    listener.push(frames);
    listener.finish().beats.iter().map(|beat| beat.time).collect()
}

fn f_measure(found: &[f64], truth: &[f64]) -> f64 {
    let (mut hits, mut next) = (0, 0);
    for time in truth {
        while found.get(next).is_some_and(|found| *found < time - TOLERANCE) {
            next += 1;
        }
        if found.get(next).is_some_and(|found| *found <= time + TOLERANCE) {
            hits += 1;
            next += 1;
        }
    }
    2.0 * f64::from(hits) / (found.len() + truth.len()).max(1) as f64
}

fn nearest(truth: &[f64], time: f64) -> Option<usize> {
    let after = truth.partition_point(|beat| *beat < time);
    [after.checked_sub(1), Some(after)]
        .into_iter()
        .flatten()
        .filter(|index| *index < truth.len())
        .min_by(|a, b| (truth[*a] - time).abs().total_cmp(&(truth[*b] - time).abs()))
}

fn followed_rightly(found: &[f64], truth: &[f64]) -> f64 {
    let right = found.windows(2).filter(|pair| {
        let Some(index) = nearest(truth, pair[1]).filter(|index| *index > 0) else { return false };
        let Some(before) = nearest(truth, pair[0]) else { return false };
        let period = truth[index] - truth[index - 1];
        before + 1 == index
            && (pair[1] - truth[index]).abs() < FRACTION * period
            && (pair[0] - truth[before]).abs() < FRACTION * period
            && ((pair[1] - pair[0]) / period - 1.0).abs() < FRACTION
    });
    right.count() as f64 / (found.len().max(truth.len()).max(2) - 1) as f64
}

fn amlt(found: &[f64], truth: &[f64]) -> f64 {
    let halves = between(truth);
    let mut double: Vec<f64> = truth.iter().chain(&halves).copied().collect();
    double.sort_by(f64::total_cmp);
    let (odd, even) = (halved(truth, 0), halved(truth, 1));
    [truth, &halves, &double, &odd, &even]
        .iter()
        .map(|truth| followed_rightly(found, truth))
        .fold(0.0, f64::max)
}

fn lock(found: &[f64], truth: &[f64]) -> Option<f64> {
    let right =
        |time: &f64| nearest(truth, *time).is_some_and(|index| (truth[index] - time).abs() <= TOLERANCE);
    found.windows(4).find(|four| four.iter().all(right)).and_then(|four| four.first()).copied()
}

fn tempo(beats: &[f64]) -> f64 {
    let mut periods: Vec<f64> = beats.windows(2).map(|pair| pair[1] - pair[0]).collect();
    periods.sort_by(f64::total_cmp);
    periods.get(periods.len() / 2).map_or(0.0, |period| 60.0 / period)
}

/// Returns every second beat, from the first or the second.
fn halved(beats: &[f64], first: usize) -> Vec<f64> {
    beats.iter().copied().skip(first).step_by(2).collect()
}

fn between(beats: &[f64]) -> Vec<f64> {
    beats.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0).collect()
}

fn kind(found: &[f64], truth: &[f64]) -> &'static str {
    const RIGHT: f64 = 0.7;
    if found.len() * 4 < truth.len() {
        return "none";
    }
    let double: Vec<f64> = {
        let mut double: Vec<f64> = truth.iter().copied().chain(between(truth)).collect();
        double.sort_by(f64::total_cmp);
        double
    };
    let right = |truth: &[f64]| f_measure(found, truth) >= RIGHT;
    if right(truth) {
        "right"
    } else if right(&double) {
        "double"
    } else if right(&halved(truth, 0)) || right(&halved(truth, 1)) {
        "half"
    } else if right(&between(truth)) {
        "off-beat"
    } else {
        "other"
    }
}

const KINDS: [&str; 6] = ["right", "double", "half", "off-beat", "none", "other"];

struct Row {
    /// F and AMLt of live input, then of the whole song.
    figures: [f64; 4],
    kinds: [&'static str; 2],
    jumps: f64,
    lock: f64,
    /// True if both judges agree on the beats.
    agreed: bool,
}

fn row(name: &str, frames: &[StereoFrame], truth: &[f64], second: &[f64]) -> Row {
    let end = truth.last().map_or(0.0, |last| last + TOLERANCE);
    let settled = |beats: &[f64]| {
        beats.iter().copied().filter(|beat| (SETTLED..end).contains(beat)).collect::<Vec<_>>()
    };
    let (heard, jumps) = followed(frames, Alignment::Trailing);
    let started = Instant::now();
    let whole = whole(frames);
    let seconds = started.elapsed().as_secs_f64();
    let counted = settled(truth);
    let lock = lock(&heard, truth).unwrap_or(frames.len() as f64 / f64::from(RATE));
    let agreement = f_measure(&settled(second), &counted);
    let agreed = agreement >= AGREED;
    let of = |beats: &[f64]| {
        let beats = settled(beats);
        (f_measure(&beats, &counted), amlt(&beats, &counted), kind(&beats, &counted))
    };
    let [(heard_f, heard_a, heard_kind), (whole_f, whole_a, whole_kind)] = [of(&heard), of(&whole)];
    println!(
        "{name:32} {} heard {heard_f:.2} {heard_a:.2} {heard_kind:8} whole {whole_f:.2} {whole_a:.2} {whole_kind:8} \
         jumps {jumps:4.1} lock {lock:5.1} s  bpm {:5.1} heard {:5.1} whole {:5.1}  judges {agreement:.2}  {seconds:.2} s",
        if agreed { '*' } else { ' ' },
        tempo(truth),
        tempo(&heard),
        tempo(&whole),
    );
    let figures = [heard_f, heard_a, whole_f, whole_a];
    Row { figures, kinds: [heard_kind, whole_kind], jumps, lock, agreed }
}

fn means(name: &str, rows: &[&Row]) {
    let mean =
        |of: &dyn Fn(&Row) -> f64| rows.iter().map(|row| of(row)).sum::<f64>() / rows.len().max(1) as f64;
    let [heard_f, heard_a, whole_f, whole_a] = std::array::from_fn(|column| mean(&|row| row.figures[column]));
    let mut locks: Vec<f64> = rows.iter().map(|row| row.lock).collect();
    locks.sort_by(f64::total_cmp);
    println!(
        "== {name}, {} songs: heard F {heard_f:.3} AMLt {heard_a:.3}, whole F {whole_f:.3} AMLt {whole_a:.3}, \
         {:.1} jumps a minute, lock {:.1} s in the median",
        rows.len(),
        mean(&|row| row.jumps),
        locks.get(locks.len() / 2).copied().unwrap_or_default(),
    );
    for (index, what) in ["heard", "whole"].into_iter().enumerate() {
        let count = |kind: &str| rows.iter().filter(|row| row.kinds[index] == kind).count();
        let counts: Vec<String> = KINDS.iter().map(|kind| format!("{kind} {}", count(kind))).collect();
        println!("   {what}: {}", counts.join(", "));
    }
}

/// Returns the times of the onsets.
fn onsets(frames: &[StereoFrame]) -> Vec<f64> {
    let mut onsets = Vec::new();
    let mut take = |moment: &TimedFeatures| {
        if moment.features.beat == 1.0 {
            onsets.push(moment.time);
        }
    };
    Analyzer::new(RATE, Alignment::Trailing).push(frames, &mut take);
    onsets
}

fn times(path: &Path) -> Option<Vec<f64>> {
    let text = std::fs::read_to_string(path).ok()?;
    Some(text.lines().filter_map(|line| line.trim().parse().ok()).collect())
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let Some(references) = arguments.next() else {
        return Err("name a folder of beat files, and songs".into());
    };
    let mut rows = Vec::new();
    for song in arguments {
        let name = song.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if let Some(truth) = times(&references.join(format!("{name}.onsets"))) {
            let found = onsets(&decoded(&song)?);
            println!(
                "{name:32} onsets F {:.2}, {} found, {} true",
                f_measure(&found, &truth),
                found.len(),
                truth.len()
            );
        }
        let Some(truth) = times(&references.join(format!("{name}.beats"))) else { continue };
        let second = times(&references.join(format!("{name}.second"))).unwrap_or_default();
        rows.push(row(&name, &decoded(&song)?, &truth, &second));
    }
    means("all", &rows.iter().collect::<Vec<_>>());
    means("judges agree", &rows.iter().filter(|row| row.agreed).collect::<Vec<_>>());
    Ok(())
}
