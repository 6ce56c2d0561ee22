//! Prints the beats of raw 32-bit float stereo at 48 kHz from standard input:
//! `ffmpeg -i song.flac -f f32le -ac 2 -ar 48000 - | cargo run -p mariana-music --example beats`.

use std::io::Read;

use mariana_music::{Alignment, Analyzer, StereoFrame};

fn main() -> std::io::Result<()> {
    let mut bytes = Vec::new();
    std::io::stdin().read_to_end(&mut bytes)?;
    let sample = |four: &[u8; 4]| f32::from_le_bytes(*four);
    let samples: Vec<f32> = bytes.as_chunks::<4>().0.iter().map(sample).collect();
    let frames: Vec<StereoFrame> = samples.as_chunks::<2>().0.to_vec();
    let mut last = 0.0;
    let mut tell = |moment: &mariana_music::TimedFeatures| {
        let features = moment.features;
        if features.tempo > 0.0 && features.phase < last {
            println!("{:8.3} s   {:5.1} beats per minute", moment.time, features.tempo);
        }
        last = features.phase;
    };
    let mut analyzer = Analyzer::new(48_000, Alignment::Centred);
    analyzer.push(&frames, &mut tell);
    analyzer.finish(&mut tell);
    Ok(())
}
