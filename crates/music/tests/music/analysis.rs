//! Tests of the analysis with signals whose features are known from theory.

// Tests fail by a panic, and `expect` panics.
#![allow(clippy::expect_used)]

use std::f64::consts::TAU;

use crate::signals::{analyze, cents, leveled, nearest, noise, signal};
use assert_no_alloc::assert_no_alloc;
use mariana_music::limits as music_limits;
use mariana_music::{
    Alignment, Analyzer, BAND_COUNT, FeatureTrack, Features, Gain, LEVEL_FLOOR_DB, StereoFrame,
    TimedFeatures, band_edge,
};
use proptest::prelude::*;

/// Aborts a debug build's test run when [`assert_no_alloc`] finds an allocation.
#[cfg(debug_assertions)]
#[global_allocator]
static ALLOCATOR: assert_no_alloc::AllocDisabler = assert_no_alloc::AllocDisabler;

fn total_db(features: &Features) -> f64 {
    let power: f64 = features.band_levels_db.iter().map(|&db| 10_f64.powf(f64::from(db) / 10.0)).sum();
    10.0 * power.log10()
}

fn loudest_band(features: &Features) -> usize {
    (0..BAND_COUNT)
        .max_by(|&a, &b| features.band_levels_db[a].total_cmp(&features.band_levels_db[b]))
        .expect("there is at least one band")
}

#[test]
fn sine_has_its_level_at_every_frequency() {
    for rate in [44_100, 48_000, 96_000] {
        for step in 0..60 {
            let hz = 60.0 * (12_000.0_f64 / 60.0).powf(f64::from(step) / 59.0);
            let frames = signal(rate, 0.2, |t| [0.5 * (TAU * hz * t).sin(); 2]);
            let level = total_db(&nearest(&analyze(rate, &frames), 0.1));
            assert!((level + 6.02).abs() < 0.1, "{hz:.1} Hz at {rate} Hz: {level:.3} dB instead of -6.02");
        }
    }
}

#[test]
fn sine_in_the_middle_of_a_band_fills_that_band() {
    // Above 500 Hz a band is wide enough for the window's main lobe.
    for band in (0..BAND_COUNT).filter(|&band| band_edge(band) > 500.0) {
        let hz = (band_edge(band) * band_edge(band + 1)).sqrt();
        let frames = signal(48_000, 0.5, |t| [(TAU * hz * t).sin(); 2]);
        let features = nearest(&analyze(48_000, &frames), 0.25);
        let level = features.band_levels_db[band];
        assert!(level.abs() < 0.1, "band {band}, {hz:.0} Hz: {level:.3} dB instead of 0");
        assert!(
            features.band_levels_db[(band + 3).min(31)] < -60.0 || band > 28,
            "{:?}",
            features.band_levels_db
        );
    }
}

#[test]
fn a_tone_is_in_the_same_band_at_every_rate() {
    for rate in [
        4_000, 5_512, 8_000, 11_025, 16_000, 22_050, 32_000, 33_941, 33_942, 44_100, 48_000, 64_000, 67_882,
        88_200, 96_000, 176_400, 192_000, 352_800, 384_000, 768_000,
    ] {
        let hz = (band_edge(18) * band_edge(19)).sqrt();
        let features = nearest(&analyze(rate, &signal(rate, 0.4, |t| [(TAU * hz * t).sin(); 2])), 0.2);
        assert_eq!(loudest_band(&features), 18, "{hz:.0} Hz at {rate} Hz: {:?}", features.band_levels_db);
        assert!((total_db(&features)).abs() < 0.1, "{rate} Hz: {:.3} dB", total_db(&features));
        for band in (0..BAND_COUNT).filter(|&band| band_edge(band) > f64::from(rate) / 2.0) {
            assert_eq!(features.band_levels_db[band], LEVEL_FLOOR_DB, "band {band} at {rate} Hz");
        }
        let hop = Analyzer::new(rate, Alignment::Centred).hop() as f64 / f64::from(rate);
        assert!((0.0075..0.0152).contains(&hop), "hop of {hop} s at {rate} Hz");
    }
}

#[test]
fn rates_beyond_the_limits_are_clamped() {
    for (asked, taken) in [
        (0, music_limits::SAMPLE_RATE_MIN),
        (music_limits::SAMPLE_RATE_MIN - 1, music_limits::SAMPLE_RATE_MIN),
        (music_limits::SAMPLE_RATE_MAX + 1, music_limits::SAMPLE_RATE_MAX),
        (u32::MAX, music_limits::SAMPLE_RATE_MAX),
    ] {
        assert_eq!(Analyzer::new(asked, Alignment::Centred).sample_rate(), taken);
    }
}

#[test]
fn white_noise_has_power_in_proportion_to_bandwidth() {
    let mut state = 1;
    let frames = signal(48_000, 20.0, |_| [0.5 * noise(&mut state), 0.5 * noise(&mut state)]);
    let moments = analyze(48_000, &frames);
    // Uniform noise with a peak of 0.5 has a mean square of 0.25/3 from 0 to 24 kHz; a full-scale sine has 1/2.
    for band in 0..BAND_COUNT {
        let bandwidth = (band_edge(band + 1) - band_edge(band)) / 24_000.0;
        let expected = 10.0 * (2.0 * 0.25 / 3.0 * bandwidth).log10();
        let power: f64 =
            moments.iter().map(|m| 10_f64.powf(f64::from(m.features.band_levels_db[band]) / 10.0)).sum();
        let level = 10.0 * (power / moments.len() as f64).log10();
        // The estimate of a narrow band scatters: 20 s contain 2·B·T = 260 independent values at 6.5 Hz, so ±0.4 dB.
        let tolerance = if band < 8 { 1.2 } else { 0.4 };
        assert!((level - expected).abs() < tolerance, "band {band}: {level:.2} dB instead of {expected:.2}");
    }
}

#[test]
fn left_and_right_are_separate_and_opposite_phase_counts() {
    let tone = |t: f64| 0.5 * (TAU * 1000.0 * t).sin();
    let measure = |sides: [f64; 2]| {
        nearest(&analyze(48_000, &signal(48_000, 3.0, |t| sides.map(|side| side * tone(t)))), 2.5)
    };
    let (left, right) = (measure([1.0, 0.0]), measure([0.0, 1.0]));
    let full = 0.5 * std::f32::consts::FRAC_2_PI;
    assert!((left.volume[0] - full).abs() < 1e-3 && left.volume[1] == 0.0, "{:?}", left.volume);
    assert!((right.volume[1] - full).abs() < 1e-3 && right.volume[0] == 0.0, "{:?}", right.volume);
    assert!((total_db(&left) + 9.03).abs() < 0.1, "left alone: {:.2} dB", total_db(&left));
    assert!((total_db(&right) + 9.03).abs() < 0.1, "right alone: {:.2} dB", total_db(&right));

    let (same, opposite) = (measure([1.0, 1.0]), measure([1.0, -1.0]));
    assert!((total_db(&same) + 6.02).abs() < 0.1, "same phase: {:.2} dB", total_db(&same));
    assert!((total_db(&opposite) + 6.02).abs() < 0.1, "opposite phase: {:.2} dB", total_db(&opposite));
    assert_eq!(same.volume, opposite.volume);
}

#[test]
fn constant_magnitude_reads_exactly_its_volume() {
    let mut sign = 1.0;
    let frames = signal(44_100, 5.0, |_| {
        sign = -sign;
        [0.25 * sign, 0.75]
    });
    assert_eq!(nearest(&analyze(44_100, &frames), 4.5).volume, [0.25, 0.75]);
}

#[test]
fn volume_falls_by_its_release_after_the_sound() {
    let frames = signal(48_000, 2.0, |t| if t < 1.0 { [1.0; 2] } else { [0.0; 2] });
    let moments = analyze(48_000, &frames);
    let (early, late) = (&moments[100], &moments[114]);
    let seconds = late.time - early.time;
    let expected = (-seconds / 0.150).exp() as f32;
    let measured = late.features.volume[0] / early.features.volume[0];
    assert!((measured - expected).abs() < 1e-4, "{measured} instead of {expected} after {seconds} s");
}

#[test]
fn loud_music_moves_the_bars_between_a_third_and_nine_tenths() {
    // Four sines in each band, with equal power per band (pink) and the total level of -14 LUFS music: -13.3 dB.
    let amplitude = (10_f64.powf(-1.33) / (4.0 * BAND_COUNT as f64)).sqrt();
    let mut state = 7;
    let tones: Vec<(f64, f64)> = (0..4 * BAND_COUNT)
        .map(|n| {
            let (low, high) = (band_edge(n / 4), band_edge(n / 4 + 1));
            (low * (high / low).powf((n % 4) as f64 / 4.0 + 0.125), TAU * noise(&mut state))
        })
        .collect();
    let frames = signal(48_000, 3.0, |t| {
        [tones.iter().map(|(hz, phase)| amplitude * (TAU * hz * t + phase).sin()).sum(); 2]
    });
    let moments = analyze(48_000, &frames);
    let steady = &moments[40..moments.len() - 20];
    for band in 0..BAND_COUNT {
        let mean = steady.iter().map(|m| m.features.bands[band]).sum::<f32>() / steady.len() as f32;
        assert!((0.5..0.75).contains(&mean), "band {band} has a mean height of {mean:.2}");
    }
}

#[test]
fn a_tone_has_its_frequency() {
    for rate in [44_100, 48_000] {
        let mut hz = 55.0;
        while hz < 8_000.0 {
            let frames = signal(rate, 0.4, |t| [0.3 * (TAU * hz * t + 1.0).sin(); 2]);
            let found = f64::from(nearest(&analyze(rate, &frames), 0.2).peak_hz);
            let most = if hz < 440.0 { 5.0 } else { 1.0 };
            assert!(
                cents(found, hz).abs() < most,
                "{hz:.2} Hz at {rate} Hz: {found:.3} Hz, {:.2} cents",
                cents(found, hz)
            );
            hz *= 1.037;
        }
    }
}

#[test]
fn pink_noise_has_the_same_power_in_every_band() {
    // Voss's algorithm: the sum of noises, each of which changes half as often as the previous one (McCartney's tree).
    // The spectrum falls by 3 dB per octave, within 0.5 dB.
    let (mut state, mut rows, mut number) = (5, [0.0; 18], 0_u32);
    let frames = signal(48_000, 40.0, |_| {
        number = number.wrapping_add(1);
        if let Some(row) = rows.get_mut(number.trailing_zeros() as usize) {
            *row = noise(&mut state);
        }
        [0.05 * (rows.iter().sum::<f64>() + noise(&mut state)); 2]
    });
    let moments = analyze(48_000, &frames);
    let level = |band: usize| {
        let power: f64 =
            moments.iter().map(|m| 10_f64.powf(f64::from(m.features.band_levels_db[band]) / 10.0)).sum();
        10.0 * (power / moments.len() as f64).log10()
    };
    // The lowest bands scatter by 0.3 dB in 40 s; above 8 kHz this noise is not pink.
    let levels: Vec<f64> = (2..28).map(level).collect();
    let mean = levels.iter().sum::<f64>() / levels.len() as f64;
    assert!(levels.iter().all(|level| (level - mean).abs() < 1.0), "{levels:.2?} around {mean:.2}");
}

#[test]
fn mid_and_side_are_separate() {
    let tone = |t: f64| 0.5 * (TAU * 1000.0 * t).sin();
    let measure = |sides: [f64; 2]| {
        let features =
            nearest(&analyze(48_000, &signal(48_000, 3.0, |t| sides.map(|side| side * tone(t)))), 2.5);
        [features.volume_mid, features.volume_side]
    };
    let full = 0.5 * std::f32::consts::FRAC_2_PI;
    for (sides, [mid, side]) in
        [([1.0, 1.0], [full, 0.0]), ([1.0, -1.0], [0.0, full]), ([1.0, 0.0], [0.5 * full, 0.5 * full])]
    {
        let [found_mid, found_side] = measure(sides);
        assert!(
            (found_mid - mid).abs() < 1e-3 && (found_side - side).abs() < 1e-3,
            "{sides:?}: {found_mid} {found_side}"
        );
    }
}

#[test]
fn silence_reads_the_floor_and_nothing_moves() {
    let moments = analyze(48_000, &signal(48_000, 1.0, |_| [0.0; 2]));
    assert!(moments.len() > 90);
    assert!(moments.iter().all(|moment| moment.features == Features::SILENCE));
}

#[test]
fn constant_offset_is_silent_in_every_band() {
    let features = nearest(&analyze(48_000, &signal(48_000, 1.0, |_| [0.5; 2])), 0.5);
    assert!(features.band_levels_db.iter().all(|&level| level < -100.0), "{:?}", features.band_levels_db);
}

#[test]
fn moments_cover_the_stream_from_start_to_end() {
    for count in [0, 1, 511, 512, 513, 2048, 4096, 48_000] {
        let frames = vec![[0.1; 2]; count];
        let moments = analyze(48_000, &frames);
        let times: Vec<f64> = (0..moments.len()).map(|n| n as f64 * 512.0 / 48_000.0).collect();
        assert_eq!(moments.iter().map(|moment| moment.time).collect::<Vec<_>>(), times);
        let expected = if count == 0 { 0 } else { count.div_ceil(512) + 1 };
        assert_eq!(moments.len(), expected, "moments of {count} frames");
    }
}

#[test]
fn a_click_peaks_at_its_time() {
    for rate in [8_000, 44_100, 48_000, 192_000] {
        let mut frames = vec![[0.0; 2]; 2 * rate as usize];
        frames[rate as usize] = [1.0, 1.0];
        let moments = analyze(rate, &frames);
        let hop = Analyzer::new(rate, Alignment::Centred).hop() as f64 / f64::from(rate);
        let peak = |value: &dyn Fn(&Features) -> f32| {
            moments
                .iter()
                .max_by(|a, b| value(&a.features).total_cmp(&value(&b.features)))
                .expect("there are moments")
                .time
        };
        let volume = peak(&|features| features.volume[0]);
        let level = peak(&|features| features.band_levels_db[15]);
        assert!((volume - 1.0).abs() < hop + 1e-9, "volume peaks at {volume} s at {rate} Hz");
        assert!((level - 1.0).abs() < hop + 1e-9, "level peaks at {level} s at {rate} Hz");
    }
}

#[test]
fn the_window_is_centred_to_the_frame() {
    // A click exactly on a moment has the same weight in the moments before and after the click.
    let click = 20;
    let mut frames = vec![[0.0; 2]; 40 * 512];
    frames[click * 512] = [1.0; 2];
    let moments = analyze(48_000, &frames);
    for distance in 1..4 {
        let before = moments[click - distance].features.band_levels_db;
        let after = moments[click + distance].features.band_levels_db;
        for (a, b) in before.iter().zip(after) {
            assert!((a - b).abs() < 2e-3, "{a} and {b} dB, {distance} hops from the click");
        }
        assert!(before[0] > -75.0, "{before:?}, {distance} hops from the click");
    }
}

#[test]
fn a_trailing_window_ends_at_its_moment() {
    let mut analyzer = Analyzer::new(48_000, Alignment::Trailing);
    assert_eq!(analyzer.lookahead(), 0);
    let mut moments = Vec::new();
    let mut frames = vec![[0.0; 2]; 5 * 512];
    frames.extend([[0.5; 2]; 512]);
    analyzer.push(&frames, &mut |moment| moments.push(moment.clone()));
    // There is one moment per hop, including a moment at 0. Only the last moment includes the sound: there is no delay.
    let times: Vec<f64> = (0..=6).map(|n| f64::from(n * 512) / 48_000.0).collect();
    assert_eq!(moments.iter().map(|moment| moment.time).collect::<Vec<_>>(), times);
    assert_eq!(moments[5].features, Features::SILENCE);
    assert!(moments[6].features.volume[0] > 0.1, "{:?}", moments[6].features);
}

#[test]
fn before_and_after_the_stream_there_is_silence() {
    let mut state = 9;
    let frames = signal(48_000, 0.31, |_| [noise(&mut state), noise(&mut state)]);
    let mut padded = frames.clone();
    padded.resize(frames.len() + 10_000, [0.0; 2]);
    let moments = analyze(48_000, &frames);
    assert_eq!(moments, analyze(48_000, &padded)[..moments.len()]);

    // The analyzer keeps no state after the end or a restart.
    let mut analyzer = Analyzer::with_gain(48_000, Alignment::Centred, Gain::Off);
    analyzer.push(&padded, &mut |_| ());
    analyzer.finish(&mut |_| ());
    for leave_in_the_middle in [false, true] {
        if leave_in_the_middle {
            analyzer.push(&frames[..9_001], &mut |_| ());
            analyzer.restart(0);
        }
        let mut again = Vec::new();
        analyzer.push(&frames, &mut |moment| again.push(moment.clone()));
        analyzer.finish(&mut |moment| again.push(moment.clone()));
        assert_eq!(again, moments);
    }
}

#[test]
fn samples_that_are_not_finite_are_silent() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let moments = analyze(48_000, &[[bad; 2]; 10_000]);
        assert!(moments.iter().all(|moment| moment.features == Features::SILENCE), "{bad}");
    }
}

#[test]
fn analysis_after_a_seek_converges_to_the_uninterrupted_one() {
    let mut state = 3;
    let frames = signal(44_100, 6.0, |_| [noise(&mut state), 0.3 * noise(&mut state)]);
    let whole = analyze(44_100, &frames);
    let start = 100_003;
    let mut analyzer = Analyzer::with_gain(44_100, Alignment::Centred, Gain::Off);
    let mut later = Vec::new();
    analyzer.push(&frames[..30_000], &mut |_| ());
    analyzer.restart(start as u64);
    analyzer.push(&frames[start..], &mut |moment| later.push(moment.clone()));
    let first = start.div_ceil(512);
    assert_eq!(later[0].time, (first * 512) as f64 / 44_100.0);
    for (index, moment) in later.iter().enumerate() {
        let other = &whole[first + index];
        assert_eq!(moment.time, other.time);
        if index >= 9 {
            // The long window is completely after the restart, so the levels are equal, bit for bit.
            assert_eq!(moment.features.band_levels_db, other.features.band_levels_db);
        }
        if moment.time - later[0].time > 1.0 {
            for (a, b) in moment.features.volume.iter().zip(other.features.volume) {
                assert!((a - b).abs() < 1e-3, "{a} and {b} at {} s", moment.time);
            }
        }
    }
}

#[test]
fn a_restart_at_an_absurd_position_works() {
    let mut analyzer = Analyzer::with_gain(48_000, Alignment::Centred, Gain::Off);
    analyzer.restart(u64::MAX);
    let mut times = Vec::new();
    analyzer.push(&[[0.5; 2]; 10_000], &mut |moment| times.push(moment.time));
    analyzer.finish(&mut |moment| times.push(moment.time));
    assert_eq!(times.len(), 21);
    assert!(times.iter().all(|time| time.is_finite()));
}

#[test]
fn features_are_one_function_of_time_at_every_frame_rate() {
    let frames = signal(48_000, 3.0, |t| [(TAU * 300.0 * t).sin() * (3.0 * t).sin().abs(), 0.2]);
    let mut track = FeatureTrack::default();
    analyze(48_000, &frames).iter().for_each(|moment| track.push(moment));
    // At the same time, all frame rates read the same features.
    for second_part in 0..90 {
        let time = f64::from(second_part) / 30.0;
        let expected = track.at(time);
        for fps in [60_u32, 144, 240] {
            let time = f64::from(second_part * fps) / 30.0 / f64::from(fps);
            let shown = track.at(time);
            for (a, b) in shown.bands.iter().zip(expected.bands) {
                assert!((a - b).abs() < 1e-6, "{a} and {b} at {time} s, {fps} fps");
            }
        }
    }
    // Features are continuous: in a twentieth of a hop, a bar moves by at most a twentieth of its range.
    let mut last = track.at(0.0);
    for step in 1..5000 {
        let now = track.at(f64::from(step) * 0.0005);
        assert!(now.bands.iter().zip(last.bands).all(|(a, b)| (a - b).abs() < 0.05), "jump at step {step}");
        last = now;
    }
}

#[test]
fn analysis_allocates_nothing_after_setup() {
    let frames = signal(48_000, 1.0, |t| [(TAU * 300.0 * t).sin(), 0.2]);
    let mut analyzer = Analyzer::with_gain(48_000, Alignment::Centred, Gain::Off);
    let mut track = FeatureTrack::new(0.5);
    let shown = assert_no_alloc(|| {
        analyzer.push(&frames, &mut |moment| track.push(moment));
        analyzer.finish(&mut |moment| track.push(moment));
        analyzer.restart(77);
        track.at(0.9)
    });
    assert!(shown.volume[0] > 0.5, "{:?}", shown.volume);
}

/// Samples that a broken decoder might produce.
fn any_sample() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => -1.0_f32..1.0,
        1 => any::<f32>(),
        1 => prop::sample::select(vec![f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, 1e-40, -0.0]),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn block_sizes_do_not_matter(
        seed in any::<u64>(),
        length in 0_usize..20_000,
        blocks in prop::collection::vec(0_usize..6_000, 1..40),
        rate in prop::sample::select(vec![8_000_u32, 44_100, 48_000, 96_000]),
    ) {
        let mut state = seed;
        let frames: Vec<StereoFrame> =
            (0..length).map(|_| [noise(&mut state) as f32, noise(&mut state) as f32]).collect();
        let mut analyzer = Analyzer::with_gain(rate, Alignment::Centred, Gain::Off);
        let mut pieces = Vec::new();
        let mut rest = &frames[..];
        for block in blocks {
            let (now, later) = rest.split_at(block.min(rest.len()));
            analyzer.push(now, &mut |moment| pieces.push(moment.clone()));
            rest = later;
        }
        for frame in rest {
            analyzer.push(std::slice::from_ref(frame), &mut |moment| pieces.push(moment.clone()));
        }
        analyzer.finish(&mut |moment| pieces.push(moment.clone()));
        prop_assert_eq!(pieces, analyze(rate, &frames));
    }

    #[test]
    fn every_feature_is_finite_and_in_range(
        frames in prop::collection::vec((any_sample(), any_sample()), 0..6_000),
    ) {
        let frames: Vec<StereoFrame> = frames.into_iter().map(|(left, right)| [left, right]).collect();
        for TimedFeatures { features, spectrum, wave, .. } in leveled(&frames) {
            let units = [features.bass, features.mid, features.treble, features.beat, features.phase];
            prop_assert!(units.iter().all(|v| (0.0..=1.0).contains(v)), "{features:?}");
            let others = [features.tempo, features.bass_drive, features.gain_db, features.level_db, features.peak_hz];
            prop_assert!(others.iter().all(|v| v.is_finite()), "{features:?}");
            prop_assert!(spectrum.iter().all(|v| (0.0..=1.0).contains(v)));
            prop_assert!(wave.iter().all(|v| (-8.0..=8.0).contains(v)));
            prop_assert!(features.volume.iter().all(|v| (0.0..=8.0).contains(v)), "{:?}", features.volume);
            prop_assert!(features.bands.iter().all(|v| (0.0..=1.0).contains(v)), "{:?}", features.bands);
            prop_assert!(features.pan.iter().all(|v| (-1.0..=1.0).contains(v)), "{:?}", features.pan);
            prop_assert!(features.width.iter().all(|v| (0.0..=1.0).contains(v)), "{:?}", features.width);
            prop_assert!(
                features.band_levels_db.iter().all(|v| (LEVEL_FLOOR_DB..=30.0).contains(v)),
                "{:?}", features.band_levels_db
            );
        }
    }
}
