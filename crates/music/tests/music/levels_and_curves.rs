//! Tests of the features for scenes: levels with automatic gain, and the curves of a moment.

#![allow(clippy::expect_used)]

use std::f64::consts::TAU;

use crate::signals::{analyze, analyze_by, cents, chord, leveled, nearest, noise, signal};
use mariana_music::{
    Alignment, Analyzer, FeatureTrack, Gain, HISTORY_POINTS, HISTORY_SECONDS, SPECTRUM_POINTS, StereoFrame,
    Tables, WAVEFORM_POINTS, spectrum_hz,
};

#[test]
fn the_gain_has_settled_two_seconds_after_a_step_of_30_db() {
    let (loud, quiet) = (0.316, 0.01);
    for (first, second) in [(loud, quiet), (quiet, loud)] {
        let frames = signal(48_000, 16.0, |t| chord(t, if t < 8.0 { first } else { second }));
        let moments = leveled(&frames);
        let (before, settled, late) =
            (nearest(&moments, 7.9), nearest(&moments, 10.0), nearest(&moments, 15.0));
        assert!((settled.gain_db - late.gain_db).abs() < 0.5, "{} and {} dB", settled.gain_db, late.gain_db);
        // A difference of 30 dB becomes 10 dB for scenes.
        let change = (late.gain_db - before.gain_db).abs();
        assert!((19.0..=20.5).contains(&change), "the gain changed by {change} dB");
        for (a, b) in settled.bands.iter().zip(late.bands) {
            assert!((a - b).abs() < 0.02, "a band at {a} two seconds after the step, at {b} later");
        }
        let apart = (before.level_db - late.level_db).abs();
        assert!((apart - 30.0).abs() < 0.1, "{apart} dB");
    }
}

#[test]
fn the_gain_does_not_pump_or_raise_noise_and_can_be_off() {
    // A kick each second on a quiet chord. The gain of the quiet passage alone would be 10 dB or more.
    let beat = signal(48_000, 10.0, |t| chord(t, 0.02 + 0.05 * (-8.0 * t.fract()).exp()));
    let gains: Vec<f32> =
        leveled(&beat).iter().filter(|m| (3.0..9.5).contains(&m.time)).map(|m| m.features.gain_db).collect();
    let (least, most) =
        gains.iter().fold((f32::INFINITY, 0.0_f32), |(a, b), gain| (a.min(*gain), b.max(*gain)));
    assert!(least > 3.0 && most - least < 0.5, "{least} to {most} dB");

    let mut state = 3;
    let room = signal(48_000, 5.0, |_| [0.002 * noise(&mut state), 0.002 * noise(&mut state)]);
    assert!(leveled(&room).iter().all(|moment| moment.features.gain_db == 0.0));

    let music = signal(48_000, 5.0, |t| chord(t, 0.3));
    assert!(
        leveled(&music).iter().skip(40).all(|moment| moment.features.gain_db == 0.0),
        "published music needs no gain"
    );
    assert!(analyze(48_000, &beat).iter().all(|moment| moment.features.gain_db == 0.0), "the gain is off");
}

#[test]
fn bass_mid_and_treble_have_their_ranges_and_the_drive_follows_the_bass() {
    let heard = |hz: f64| {
        let features =
            nearest(&analyze(48_000, &signal(48_000, 30.0, |t| [0.5 * (TAU * hz * t).sin(); 2])), 28.0);
        ([features.bass, features.mid, features.treble], features.bass_drive)
    };
    for (hz, range) in [(70.0, 0), (600.0, 1), (6_000.0, 2)] {
        let (values, drive) = heard(hz);
        for (index, value) in values.iter().enumerate() {
            let floor = 3.0 * values[(index + 1) % 3].max(values[(index + 2) % 3]);
            assert_eq!(*value > floor, index == range, "{hz} Hz: {values:?}");
        }
        // In steady state, the drive is four seconds times the bass.
        assert!((drive - 4.0 * values[0]).abs() < 0.02, "{hz} Hz: {drive} from {values:?}");
    }
}

fn track_of(analyzer: Analyzer, frames: &[StereoFrame]) -> FeatureTrack {
    let mut track = FeatureTrack::new(30.0);
    analyze_by(analyzer, frames).iter().for_each(|moment| track.push(moment));
    track
}

#[test]
fn the_spectrum_shows_the_tone_and_the_history_its_past() {
    // A tone that jumps up an octave each second.
    let hz = |t: f64| 55.0 * t.floor().exp2().min(64.0);
    let frames = signal(48_000, 9.0, |t| [0.5 * (TAU * hz(t) * t).sin(); 2]);
    let track = track_of(Analyzer::with_gain(48_000, Alignment::Centred, Gain::Off), &frames);
    let peak = |values: &[f32]| {
        let best =
            (0..values.len()).max_by(|&a, &b| values[a].total_cmp(&values[b])).expect("there are values");
        spectrum_hz(best as f64 / (values.len() - 1) as f64)
    };
    let Tables { spectrum: Some(spectrum), history: Some(history), history_offset, history_span, .. } =
        track.sound_at(6.8).tables
    else {
        panic!("tables are missing")
    };
    assert_eq!(spectrum.len(), SPECTRUM_POINTS);
    assert!(cents(peak(&spectrum), hz(6.8)).abs() < 40.0, "{} Hz", peak(&spectrum));
    // The tone has -6 dB, which is above the scale from -84 to -12 dB.
    assert!(spectrum.iter().all(|height| (0.0..=1.0).contains(height)) && spectrum.contains(&1.0));
    let (rows, rest) = history.as_chunks::<HISTORY_POINTS>();
    assert!(rest.is_empty());
    for age in [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0] {
        let row = f64::from(history_offset) + age / HISTORY_SECONDS * f64::from(history_span);
        let found = peak(&rows[row.round() as usize]);
        assert!(cents(found, hz(6.8 - age)).abs() < 200.0, "{found} Hz, {age} s ago");
    }
    // Before the song there is silence.
    let row = f64::from(history_offset) + 0.75 * f64::from(history_span);
    assert!(rows[row.round() as usize].iter().all(|height| *height == 0.0));
    // At the moment of a row, age 0 is at this row. A hop later, age 0 is a quarter of a row towards newer rows.
    let moment = |number: f64| number * 512.0 / 48_000.0;
    let on_row = track.sound_at(moment(560.0)).tables;
    let (groups, _) = on_row.spectrum.as_deref().expect("a spectrum").as_chunks::<4>();
    let columns: Vec<f32> = groups.iter().map(|group| group.iter().sum::<f32>() / 4.0).collect();
    assert_eq!(on_row.history_offset, 2.0);
    assert_eq!(on_row.history.expect("a history")[2 * HISTORY_POINTS..3 * HISTORY_POINTS], columns);
    let later = track.sound_at(moment(561.0)).tables.history_offset;
    assert!((later - 1.75).abs() < 1e-3, "{later}");
    // Rows keep their values as they move on, so that the image does not flicker.
    let later = track.sound_at(6.8 + 4.0 * 512.0 / 48_000.0).tables;
    let later = later.history.expect("a history");
    assert_eq!(
        later[3 * HISTORY_POINTS..5 * HISTORY_POINTS],
        history[2 * HISTORY_POINTS..4 * HISTORY_POINTS]
    );
}

#[test]
fn the_waveform_is_the_samples_around_the_moment_or_before_it() {
    // A slow ramp identifies each sample.
    let frames = signal(48_000, 3.0, |t| [t / 4.0, t / 4.0]);
    for (alignment, behind) in [(Alignment::Centred, 0.5), (Alignment::Trailing, 0.0)] {
        let track = track_of(Analyzer::with_gain(48_000, alignment, Gain::Off), &frames);
        for time in [1.0, 1.2345, 2.0, 2.1] {
            let waveform = track.sound_at(time).tables.waveform.expect("a waveform");
            assert_eq!(waveform.len(), WAVEFORM_POINTS);
            let step = 4.0 / 48_000.0;
            for (index, value) in waveform.iter().enumerate() {
                let place = (index as f64 + 0.5) - WAVEFORM_POINTS as f64 * (1.0 - behind);
                let expected = (time + place * step) / 4.0;
                assert!(
                    (f64::from(*value) - expected).abs() < 2.0 * step / 4.0,
                    "{index} at {time} s: {value}, not {expected}"
                );
            }
        }
    }
}

#[test]
fn the_history_is_complete_after_a_seek_with_preroll() {
    let mut state = 4;
    let frames = signal(48_000, 30.0, |t| {
        let loud = 0.2 + 0.1 * (3.0 * t).sin();
        [loud * noise(&mut state), loud * noise(&mut state)]
    });
    let whole = track_of(Analyzer::new(48_000, Alignment::Centred), &frames);
    let (target, preroll) = (25.0, 13.0);
    let start = ((target - preroll) * 48_000.0) as usize + 77;
    let mut analyzer = Analyzer::new(48_000, Alignment::Centred);
    analyzer.restart(start as u64);
    let sought = track_of(analyzer, &frames[start..]);
    let (a, b) = (whole.sound_at(target).tables, sought.sound_at(target).tables);
    assert_eq!((a.history_offset, a.history_span), (b.history_offset, b.history_span));
    assert_eq!(a.waveform, b.waveform);
    let (a, b) = (a.history.expect("a history"), b.history.expect("a history"));
    let worst = a.iter().zip(b.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(worst < 1e-3, "{worst}");
}

#[test]
fn brightness_follows_the_frequency_of_the_sound() {
    let of = |hz: f64| {
        nearest(&analyze(48_000, &signal(48_000, 2.0, |t| [0.5 * (TAU * hz * t).sin(); 2])), 1.5).brightness
    };
    let (low, middle, high) = (of(60.0), of(800.0), of(8_000.0));
    assert!(low < 0.25 && (0.3..0.75).contains(&middle) && high > 0.75, "{low} {middle} {high}");
    let silence = analyze(48_000, &signal(48_000, 1.0, |_| [0.0; 2]));
    assert_eq!(nearest(&silence, 0.5).brightness, 0.0);
}
