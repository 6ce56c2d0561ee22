//! What moves each shipped scene: measured, and compared with the entry `follows` of the scene's `about` block.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::sync::Arc;

use crate::support::test_renderer::TestRenderer;
use image::RgbaImage;
use mariana_music::{Features, HISTORY_POINTS, SPECTRUM_POINTS, Sound, Tables, WAVEFORM_POINTS};

const SIZE: (u32, u32) = (48, 27);
const TIMES: [f64; 2] = [3.0, 17.0];
/// The number of bands that count as bass.
const LOW_BANDS: usize = 10;
/// The level of all sounds that a measurement does not change.
const REST: f32 = 0.3;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Onsets,
    Bass,
    Level,
    Tones,
}

impl Kind {
    const ALL: [(Self, &str); 4] =
        [(Self::Onsets, "onsets"), (Self::Bass, "bass"), (Self::Level, "level"), (Self::Tones, "tones")];
}

/// A sound in which one kind has this level, 0..1, and all other kinds rest.
fn sound(kind: Kind, level: f32) -> Sound {
    let of = |one: Kind| if one == kind { level } else { REST };
    let (onsets, bass, high, tones) = (of(Kind::Onsets), of(Kind::Bass), of(Kind::Level), of(Kind::Tones));
    let drums = Features {
        beat: onsets,
        kick: onsets,
        snare: onsets,
        hat: onsets,
        percussive: onsets,
        ..Features::SILENCE
    };
    let volumes =
        Features { volume: [0.4 * high; 2], volume_mid: 0.4 * high, volume_side: 0.1 * high, ..drums };
    let features = Features {
        bass,
        bass_drive: 2.0 * bass,
        mid: high,
        treble: high,
        bands: std::array::from_fn(|band| if band < LOW_BANDS { bass } else { high }),
        tonal: tones,
        notes: std::array::from_fn(|note| if note % 12 < 7 && note % 3 == 0 { tones } else { 0.0 }),
        melody_certainty: tones,
        chord_certainty: tones,
        ..volumes
    };
    let curve = |points: usize, of: &dyn Fn(f32) -> f32| -> Option<Arc<[f32]>> {
        Some((0..points).map(|point| of(point as f32 / points as f32)).collect())
    };
    let height = |u: f32| if u < LOW_BANDS as f32 / 32.0 { bass } else { high };
    let tables = Tables {
        spectrum: curve(SPECTRUM_POINTS, &height),
        waveform: curve(WAVEFORM_POINTS, &|u| high * (40.0 * u).sin()),
        history: curve(240 * HISTORY_POINTS, &|u| height((240.0 * u).fract())),
        history_offset: 1.0,
        history_span: 234.0,
    };
    let mut sound = Sound { features, tables, ..Sound::default() };
    sound.song.chroma = std::array::from_fn(|class| if class % 4 == 0 { tones } else { 0.0 });
    sound
}

/// The mean difference of two pictures, 0..1.
fn difference(a: &RgbaImage, b: &RgbaImage) -> f64 {
    let sum: u64 = a.as_raw().iter().zip(b.as_raw()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    sum as f64 / (255.0 * a.as_raw().len() as f64)
}

/// Fails unless the scene's `follows` names the sounds that move it most. `MARIANA_FIGURES=1` prints how much each sound
/// moves it.
pub(super) fn check_follows(name: &str, renderer: &mut TestRenderer) {
    let moved = Kind::ALL.map(|(kind, _)| {
        let mut moves = |time| {
            let [low, high] = [0.0, 1.0].map(|level| renderer.picture(time, sound(kind, level), SIZE));
            difference(&low, &high)
        };
        TIMES.map(&mut moves).iter().sum::<f64>() / TIMES.len() as f64
    });
    let most = moved.iter().fold(0.0_f64, |most, value| most.max(*value));
    let follows = &renderer.world().scene.about.follows;
    if std::env::var_os("MARIANA_FIGURES").is_some() {
        println!("{name}: {}", moved.map(|value| format!("{:.1} %", 100.0 * value)).join(", "));
    }
    for ((_, word), value) in Kind::ALL.into_iter().zip(moved) {
        let says = follows.iter().any(|follows| follows == word);
        // Between the two limits, a scene may say it or not.
        assert!(
            if says { value >= 0.35 * most } else { value <= 0.65 * most },
            "correct the entry `follows` of {name}: {word} moves it by {:.1} % of {:.1} %",
            100.0 * value,
            100.0 * most
        );
    }
}
