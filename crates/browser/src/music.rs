//! Analyzes generated samples.

use std::f32::consts::TAU;

use crate::expect;
use mariana_music::{Alignment, Analyzer, SongListener, StereoFrame, TimedFeatures};

const RATE: u32 = 48_000;

/// Twelve seconds of a low tone with two clicks per second.
fn ticking() -> Vec<StereoFrame> {
    let sample = |i: u32| {
        let (tone, since_click) = ((TAU * 110.0 * i as f32 / RATE as f32).sin(), i % (RATE / 2));
        let click = if since_click < 480 { (-(since_click as f32) / 80.0).exp() } else { 0.0 };
        [0.2 * tone + 0.7 * click; 2]
    };
    (0..12 * RATE).map(sample).collect()
}

fn moments(frames: &[StereoFrame], block: usize) -> Vec<TimedFeatures> {
    let mut all = Vec::new();
    let mut analyzer = Analyzer::new(RATE, Alignment::Centred);
    for frames in frames.chunks(block) {
        analyzer.push(frames, &mut |moment| all.push(moment.clone()));
    }
    analyzer.finish(&mut |moment| all.push(moment.clone()));
    all
}

pub(crate) fn check() -> Result<(), u32> {
    let frames = ticking();
    let all = moments(&frames, 512);
    let late = &all.get(all.len() * 5 / 6).ok_or(line!())?.features;
    expect((late.tempo - 120.0).abs() < 1.0, line!())?;
    expect(late.bass > late.treble && late.volume_mid > 0.05 && late.volume_side == 0.0, line!())?;
    // The features depend on the samples alone, not on how they arrive.
    let again = moments(&frames, 4801);
    expect(all.len() == again.len(), line!())?;
    expect(all.iter().zip(&again).all(|(one, other)| one.features.bands == other.features.bands), line!())?;

    let mut listener = SongListener::new(RATE);
    listener.push(&frames);
    expect(listener.finish().beats.len() >= 20, line!())
}
