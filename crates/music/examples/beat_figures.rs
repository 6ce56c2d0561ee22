//! Measures beat tracking on real songs: `cargo run --release -p mariana-music --example beat_figures -- SONGS BEATS`
//! prints a table. `SONGS` is a folder of songs that `ffmpeg` can read. For each song `NAME.*`, the folder `BEATS` has
//! a file `NAME.beats` with the time of one true beat in seconds on each line. Songs without such a file are skipped.
//!
//! The column `heard` is for live input, `played` for a file during playback, and `whole` for an analysis of the whole
//! song. F is the F-measure with a tolerance of ±70 ms. AMLt is the fraction of beats whose position and distance from
//! the previous beat are right within 17.5 %; double tempo, half tempo and the off-beat also count as right (Davies,
//! Degara and Plumbley 2009). The first 5 s do not count. `lock` is the time of the first of four consecutive right
//! beats in live input. `jumps` counts how often per minute the tempo changes by more than 8 %.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;

use mariana_music::{Alignment, Analyzer, SongListener, StereoFrame, TimedFeatures};

const RATE: u32 = 48_000;
const SETTLED: f64 = 5.0;
const TOLERANCE: f64 = 0.07;
const FRACTION: f64 = 0.175;
const JUMP: f64 = 0.08;

fn decoded(song: &Path) -> Result<Vec<StereoFrame>, Box<dyn Error>> {
    let output = Command::new("ffmpeg")
        .args(["-nostdin", "-v", "error", "-protocol_whitelist", "file"])
        .args(["-format_whitelist", "aac,aiff,caf,flac,matroska,mov,mp3,ogg,wav", "-i"])
        .arg(song)
        .args(["-f", "f32le", "-ac", "2", "-ar", "48000", "-"])
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
    let halves: Vec<f64> = truth.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0).collect();
    let mut double: Vec<f64> = truth.iter().chain(&halves).copied().collect();
    double.sort_by(f64::total_cmp);
    let odd: Vec<f64> = truth.iter().copied().step_by(2).collect();
    let even: Vec<f64> = truth.iter().copied().skip(1).step_by(2).collect();
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

/// The columns: F and AMLt of `heard`, `played` and `whole`, then `jumps` and `lock`.
struct Row([f64; 8]);

fn row(name: &str, frames: &[StereoFrame], truth: &[f64]) -> Row {
    let settled = |beats: &[f64]| beats[beats.partition_point(|beat| *beat < SETTLED)..].to_vec();
    let (heard, jumps) = followed(frames, Alignment::Trailing);
    let (played, _) = followed(frames, Alignment::Centred);
    let whole = whole(frames);
    let counted = settled(truth);
    let lock = lock(&heard, truth).unwrap_or(frames.len() as f64 / f64::from(RATE));
    let mut figures = [0.0; 8];
    for (index, beats) in [&heard, &played, &whole].into_iter().enumerate() {
        let beats = settled(beats);
        figures[2 * index] = f_measure(&beats, &counted);
        figures[2 * index + 1] = amlt(&beats, &counted);
    }
    (figures[6], figures[7]) = (jumps, lock);
    let [heard_f, heard_a, played_f, played_a, whole_f, whole_a, ..] = figures;
    println!(
        "{name:44} heard {heard_f:.2} {heard_a:.2}  played {played_f:.2} {played_a:.2}  whole {whole_f:.2} {whole_a:.2}  \
         jumps {jumps:4.1}  lock {lock:5.1} s  bpm {:5.1} heard {:5.1} whole {:5.1}",
        tempo(truth),
        tempo(&heard),
        tempo(&whole),
    );
    Row(figures)
}

fn means(name: &str, rows: &[&Row]) {
    let mean = |column: usize| rows.iter().map(|row| row.0[column]).sum::<f64>() / rows.len().max(1) as f64;
    let mut locks: Vec<f64> = rows.iter().map(|row| row.0[7]).collect();
    locks.sort_by(f64::total_cmp);
    println!(
        "== {name}, {} songs: heard F {:.3} AMLt {:.3}, played F {:.3} AMLt {:.3}, whole F {:.3} AMLt {:.3}, \
         {:.1} jumps a minute, lock {:.1} s in the median",
        rows.len(),
        mean(0),
        mean(1),
        mean(2),
        mean(3),
        mean(4),
        mean(5),
        mean(6),
        locks.get(locks.len() / 2).copied().unwrap_or_default(),
    );
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let (Some(songs), Some(references)) = (arguments.next(), arguments.next()) else {
        return Err("name a folder of songs and a folder of beat files".into());
    };
    let mut songs: Vec<PathBuf> =
        std::fs::read_dir(songs)?.filter_map(|entry| entry.ok().map(|entry| entry.path())).collect();
    songs.sort();
    let mut rows = Vec::new();
    for song in songs {
        let name = song.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let Ok(text) = std::fs::read_to_string(references.join(format!("{name}.beats"))) else { continue };
        let truth: Vec<f64> = text.lines().filter_map(|line| line.trim().parse().ok()).collect();
        rows.push(row(&name, &decoded(&song)?, &truth));
    }
    let half = |which: usize| rows.iter().skip(which).step_by(2).collect::<Vec<_>>();
    means("one half", &half(0));
    means("other half", &half(1));
    means("all", &rows.iter().collect::<Vec<_>>());
    Ok(())
}
