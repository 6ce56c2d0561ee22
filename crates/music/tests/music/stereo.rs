//! Tests of the stereo image with known positions and correlations.

use std::f64::consts::TAU;

use mariana_music::{BAND_COUNT, Features};

use super::signals::{analyze, nearest, noise, signal};

/// Returns the features two seconds into a signal.
fn settled(mut sample: impl FnMut(f64) -> [f64; 2]) -> Features {
    nearest(&analyze(48_000, &signal(48_000, 3.0, &mut sample)), 2.0)
}

/// Bands whose level is above -60 dB.
fn sounding(features: &Features) -> impl Iterator<Item = usize> {
    (0..BAND_COUNT).filter(|band| features.band_levels_db[*band] > -60.0)
}

#[test]
fn a_panned_tone_has_its_pan_and_no_width() {
    for hz in [50.0, 300.0, 1_000.0, 3_000.0, 9_000.0] {
        for [left, right] in [[1.0, 0.0], [0.9, 0.2], [0.5, 0.5], [0.3, 0.7], [0.0, 0.6]] {
            let features = settled(|t| [left, right].map(|gain| 0.5 * gain * (TAU * hz * t).sin()));
            let expected = (right * right - left * left) / (right * right + left * left);
            assert!(sounding(&features).count() > 0);
            for band in sounding(&features) {
                let (pan, width) = (f64::from(features.pan[band]), features.width[band]);
                assert!((pan - expected).abs() < 1e-3, "{hz} Hz, {left} and {right}: pan {pan}");
                assert!(width < 2e-3, "{hz} Hz, {left} and {right}: width {width}");
            }
        }
    }
}

#[test]
fn tones_of_different_bands_have_different_pans() {
    let tone = |hz: f64, t: f64| 0.3 * (TAU * hz * t).sin();
    let features = settled(|t| [tone(80.0, t), tone(4_000.0, t)]);
    let loudest = |bands: std::ops::Range<usize>| {
        bands.max_by(|a, b| features.bands[*a].total_cmp(&features.bands[*b])).unwrap()
    };
    let pan = |band: usize| features.pan[band];
    let (low, high) = (pan(loudest(0..16)), pan(loudest(16..32)));
    assert!(low < -0.99 && high > 0.99, "{low} and {high}");
}

#[test]
fn noise_is_as_wide_as_its_channels_are_independent() {
    let mut state = 5;
    let mut mean = |mix: fn(f64, f64) -> [f64; 2]| {
        let frames = signal(48_000, 6.0, |_| mix(0.3 * noise(&mut state), 0.3 * noise(&mut state)));
        let moments = analyze(48_000, &frames);
        let late: Vec<Features> = moments.iter().skip(100).map(|moment| moment.features).collect();
        let late = &late[..late.len() - 100];
        let of_band = |band: usize| late.iter().map(|f| f.width[band]).sum::<f32>() / late.len() as f32;
        let pan = late.iter().flat_map(|f| f.pan).fold(0.0_f32, |a, b| a.max(b.abs()));
        ((4..BAND_COUNT).map(of_band).collect::<Vec<_>>(), pan)
    };
    let (independent, _) = mean(|a, b| [a, b]);
    assert!(independent.iter().all(|width| *width > 0.75), "{independent:?}");
    assert!(independent[12..].iter().all(|width| *width > 0.9), "{independent:?}");
    // The correlation is 1 / √2.
    let (half, _) = mean(|a, b| [a + b, b * std::f64::consts::SQRT_2]);
    assert!(half[12..].iter().all(|width| (0.22..0.36).contains(width)), "{half:?}");
    let (mono, pan) = mean(|a, _| [a, a]);
    assert!(mono.iter().all(|width| *width < 1e-4) && pan < 1e-4, "{mono:?}, {pan}");
    let (opposite, pan) = mean(|a, _| [a, -a]);
    assert!(opposite.iter().all(|width| *width > 0.999) && pan < 1e-4, "{opposite:?}, {pan}");
}

#[test]
fn pan_and_width_fall_to_zero_after_the_sound() {
    let mut state = 9;
    let frames = signal(48_000, 6.0, |t| {
        if t < 1.0 { [0.1 * noise(&mut state), 0.3 * noise(&mut state)] } else { [0.0; 2] }
    });
    let moments = analyze(48_000, &frames);
    let before = nearest(&moments, 0.9);
    assert!(before.pan[20] > 0.5 && before.width[20] > 0.3, "{before:?}");
    let after = nearest(&moments, 5.9);
    assert!(after.pan.iter().chain(&after.width).all(|value| value.abs() < 1e-3), "{after:?}");
}
