//! Tests of beat prediction and onsets with known rhythms.

use crate::rhythm::{Pattern, RATE, clicks, drums, f_measure, play};
use crate::signals::{analyze, noise, signal};
use mariana_music::{Alignment, Analyzer, FeatureTrack, StereoFrame};

/// The length of each rhythm in seconds. Beats are evaluated from [`SETTLED`] on.
const SECONDS: f64 = 16.0;
const SETTLED: f64 = 5.0;

fn track_of(frames: &[StereoFrame], alignment: Alignment) -> FeatureTrack {
    let mut analyzer = Analyzer::new(RATE, alignment);
    let mut track = FeatureTrack::new(SECONDS + 1.0);
    analyzer.push(frames, &mut |moment| track.push(moment));
    analyzer.finish(&mut |moment| track.push(moment));
    track
}

fn beats_of(track: &FeatureTrack) -> Vec<f64> {
    const FPS: f64 = 240.0;
    let mut beats = Vec::new();
    let mut last = track.at(0.0);
    for frame in 1..(SECONDS * FPS) as u32 {
        let time = f64::from(frame) / FPS;
        let now = track.at(time);
        if last.tempo > 0.0 && now.tempo > 0.0 && now.phase < last.phase - 0.5 {
            let step = now.phase + 1.0 - last.phase;
            beats.push(time - f64::from(now.phase / step) / FPS);
        }
        last = now;
    }
    beats
}

fn measure(pattern: &Pattern, (from, to): (f64, f64), alignment: Alignment) -> (f64, f32) {
    let (frames, truth) = play(pattern, SECONDS, |t| from + (to - from) * t / SECONDS);
    let track = track_of(&frames, alignment);
    (f_measure(&beats_of(&track), &truth, SETTLED, SECONDS - 0.2), track.at(SECONDS - 1.0).tempo)
}

fn require(pattern: &Pattern, tempo: (f64, f64), alignment: Alignment) {
    let (f, found) = measure(pattern, tempo, alignment);
    assert!(f >= 0.98, "{} at {tempo:?}, {alignment:?}: F = {f:.3}, reported {found:.0} bpm", pattern.name);
    let end = tempo.0 + (tempo.1 - tempo.0) * (SECONDS - 1.0) / SECONDS;
    let off = f64::from(found) / end - 1.0;
    assert!(off.abs() < 0.04, "{} at {end:.0} bpm is reported as {found:.1}", pattern.name);
}

/// Requires the beats, their halves or every second beat. Drums this slow or fast are also felt at double or half the
/// tempo.
fn require_pulse(pattern: &Pattern, tempo: f64, alignment: Alignment) {
    let (frames, beats) = play(pattern, SECONDS, |_| tempo);
    let found = beats_of(&track_of(&frames, alignment));
    let halves = beats.windows(2).flat_map(|pair| [pair[0], 0.5 * (pair[0] + pair[1])]);
    let levels: [Vec<f64>; 4] = [
        halves.collect(),
        beats.iter().copied().step_by(2).collect(),
        beats.iter().copied().skip(1).step_by(2).collect(),
        beats,
    ];
    let best =
        levels.map(|truth| f_measure(&found, &truth, SETTLED, SECONDS - 0.2)).into_iter().fold(0.0, f64::max);
    assert!(best >= 0.85, "{} at {tempo}, {alignment:?}: F = {best:.3}", pattern.name);
}

#[test]
fn clicks_are_predicted_from_60_to_200() {
    for tempo in [60.0, 85.0, 110.0, 150.0, 200.0] {
        require(&clicks(), (tempo, tempo), Alignment::Centred);
    }
}

#[test]
fn drums_are_predicted_from_60_to_200() {
    for (number, pattern) in drums(0.5).iter().enumerate() {
        let alignment = if number % 2 == 0 { Alignment::Centred } else { Alignment::Trailing };
        for tempo in [97.0, 134.0, 174.0] {
            require(pattern, (tempo, tempo), alignment);
        }
        for tempo in [60.0, 200.0] {
            require_pulse(pattern, tempo, alignment);
        }
    }
}

#[test]
fn swing_does_not_change_the_tempo() {
    for pattern in drums(0.667) {
        for tempo in [66.0, 120.0, 160.0] {
            require(&pattern, (tempo, tempo), Alignment::Centred);
        }
        require_pulse(&pattern, 184.0, Alignment::Centred);
    }
}

#[test]
fn ramps_are_followed() {
    for pattern in [clicks()].into_iter().chain(drums(0.5)) {
        for tempo in [(90.0, 130.0), (150.0, 110.0)] {
            require(&pattern, tempo, Alignment::Centred);
        }
    }
}

#[test]
fn each_onset_sets_beat_and_decays() {
    let (frames, truth) = play(&clicks(), SECONDS, |_| 90.0);
    for (alignment, late) in [(Alignment::Centred, 0.015), (Alignment::Trailing, 0.03)] {
        let track = track_of(&frames, alignment);
        for click in truth.iter().filter(|time| (1.0..SECONDS - 1.0).contains(*time)) {
            let peak = (0..60).map(|ms| track.at(click + f64::from(ms) / 1000.0).beat).fold(0.0, f32::max);
            assert!(peak > 0.9, "{peak} at the click of {click} s");
            let (early, after) = (track.at(click - 0.03).beat, track.at(click + late + 0.15).beat);
            assert!(
                early < 0.1 && (0.25..0.5).contains(&after),
                "{early} before and {after} after {click} s"
            );
        }
    }
}

#[test]
fn silence_and_steady_sound_have_no_beat_and_the_end_of_a_rhythm_is_noticed() {
    let (mut frames, _) = play(&clicks(), SECONDS, |_| 120.0);
    frames[6 * RATE as usize..].fill([0.0; 2]);
    let track = track_of(&frames, Alignment::Centred);
    assert!((track.at(5.9).tempo - 120.0).abs() < 2.0);
    let end = track.at(SECONDS - 1.0);
    assert_eq!((end.tempo, end.phase, end.beat), (0.0, 0.0, 0.0));

    let tone: Vec<StereoFrame> =
        (0..SECONDS as usize * RATE as usize).map(|n| [(n as f32 * 0.03).sin() * 0.3; 2]).collect();
    let track = track_of(&tone, Alignment::Centred);
    assert!((20..150).all(|tenth| track.at(f64::from(tenth) / 10.0).tempo == 0.0));
}

fn onsets_of(frames: &[StereoFrame]) -> Vec<f64> {
    let begins = |moment: &&mariana_music::TimedFeatures| moment.features.beat == 1.0;
    analyze(RATE, frames).iter().filter(begins).map(|moment| moment.time).collect()
}

fn click_at(t: f64, gap: f64) -> f64 {
    let since = t % gap;
    (std::f64::consts::TAU * 1_500.0 * since).sin() * (-since / 0.004).exp()
}

fn organ(t: f64, lowest_hz: f64) -> f64 {
    let partial =
        |hz: f64, number: u32| (std::f64::consts::TAU * hz * f64::from(number) * t).sin() / f64::from(number);
    let tones = [1.0, 1.2599, 1.4983].map(|ratio| lowest_hz * ratio);
    tones.iter().map(|hz| (1..=8).map(|number| partial(*hz, number)).sum::<f64>()).sum::<f64>() / 4.0
}

#[test]
fn a_click_under_a_loud_chord_is_an_onset() {
    for lowest_hz in [110.0, 220.0] {
        let frames = signal(RATE, 12.0, |t| {
            // The click is 12 dB below the chord, whose level is 0.52.
            let click = if t < 2.0 { 0.0 } else { 0.13 * click_at(t, 0.5) };
            [0.4 * organ(t, lowest_hz) + click; 2]
        });
        let onsets = onsets_of(&frames);
        let clicks = (5..23).map(|half| f64::from(half) / 2.0);
        let heard = |click: &f64| onsets.iter().any(|onset| (onset - click).abs() < 0.03);
        let missed: Vec<f64> = clicks.filter(|click| !heard(click)).collect();
        assert!(missed.len() <= 1, "over {lowest_hz} Hz the clicks at {missed:?} are missed");
        let false_ones = onsets.iter().filter(|onset| (1.0..1.9).contains(*onset)).count();
        assert_eq!(false_ones, 0, "in the chord alone, over {lowest_hz} Hz");
    }
}

/// A kick without a click, a snare, and a bass note.
#[test]
fn low_sounds_under_a_loud_chord_are_onsets() {
    const GAP: f64 = 0.45;
    let mut state = 9;
    let sine = |hz: f64, t: f64| (std::f64::consts::TAU * hz * t).sin();
    let mut stroke = |name: &str, number: usize, t: f64| {
        let rise = |seconds: f64| (t / seconds).min(1.0);
        match name {
            "kick" => sine(50.0, t) * (-t / 0.08).exp() * rise(0.002),
            "snare" => 0.5 * sine(190.0, t) * (-t / 0.06).exp() + 0.6 * noise(&mut state) * (-t / 0.07).exp(),
            _ => {
                let hz = [55.0, 73.4, 61.7, 98.0, 82.4][number % 5];
                let fall = ((0.4 - t) / 0.02).clamp(0.0, 1.0);
                (sine(hz, t) + 0.4 * sine(2.0 * hz, t)) * (-t / 0.4).exp() * rise(0.008) * fall
            }
        }
    };
    for (name, least) in [("kick", 0.9), ("snare", 0.9), ("bass", 0.8)] {
        for decibels in [-6.0, -12.0] {
            // The chord's peak is about 0.8.
            let loud = 0.8 * f64::powf(10.0, decibels / 20.0);
            let frames = signal(RATE, 16.0, |t| {
                let number = (t / GAP) as usize;
                let struck = if t < 3.0 { 0.0 } else { loud * stroke(name, number, t - GAP * number as f64) };
                [0.3 * organ(t, 110.0) + struck; 2]
            });
            let truth: Vec<f64> = (7..35).map(|number| GAP * f64::from(number)).collect();
            let f = f_measure(&onsets_of(&frames), &truth, 3.0, 15.5);
            assert!(f >= least, "{name} at {decibels} dB: F = {f:.2}");
        }
    }
}

#[test]
fn clicks_in_quick_succession_are_separate_onsets() {
    for gap in [0.06, 0.08, 0.1] {
        let onsets = onsets_of(&signal(RATE, 6.0, |t| [0.4 * click_at(t, gap); 2]));
        let expected = 4.0 / gap;
        let found = onsets.iter().filter(|onset| (1.0..5.0).contains(*onset)).count() as f64;
        assert!((found / expected - 1.0).abs() < 0.05, "{found} of {expected} clicks {gap} s apart");
    }
}

#[test]
fn steady_noise_and_vibrato_have_no_onsets() {
    let mut state = 7;
    let (mut slow, mut slower) = (0.0, 0.0);
    let mut colour = |number: usize| {
        let white = noise(&mut state);
        slow += 0.1 * (white - slow);
        slower += 0.005 * (white - slower);
        [0.3 * white, 0.8 * slow, 3.0 * slower][number]
    };
    let mut sounds: Vec<(&str, Vec<StereoFrame>)> = ["white", "dull", "brown"]
        .into_iter()
        .enumerate()
        .map(|(number, name)| (name, signal(RATE, 20.0, |_| [colour(number); 2])))
        .collect();
    let vibrato = |t: f64| {
        // The pitch changes 6 times a second by half a semitone.
        let turns = 440.0 * t
            + 440.0 * 0.03 / (std::f64::consts::TAU * 6.0) * (std::f64::consts::TAU * 6.0 * t).sin();
        (1..=6).map(|n| (std::f64::consts::TAU * turns * f64::from(n)).sin() / f64::from(n)).sum::<f64>()
    };
    sounds.push(("vibrato", signal(RATE, 20.0, |t| [0.3 * vibrato(t); 2])));
    for (name, frames) in sounds {
        let moments = analyze(RATE, &frames);
        let later = || moments.iter().filter(|moment| (1.0..19.9).contains(&moment.time));
        let onsets: Vec<f64> =
            later().filter(|moment| moment.features.beat == 1.0).map(|moment| moment.time).collect();
        assert!(onsets.is_empty(), "{name} has onsets at {onsets:?}");
        assert!(later().all(|moment| moment.features.tempo == 0.0), "{name} has a tempo");
    }
}

/// Noise in syllables of random length, as in speech, and random drops, as in rain.
#[test]
fn irregular_sounds_have_hardly_a_tempo() {
    let (mut state, mut seed, mut begins, mut length) = (3, 5, 0.0, 0.2);
    let syllables = signal(RATE, 40.0, |t| {
        if t >= begins + length {
            (begins, length) = (t, 0.22 + 0.13 * noise(&mut seed));
        }
        [0.4 * (std::f64::consts::PI * (t - begins) / length).sin() * noise(&mut state); 2]
    });
    let (mut drop, mut loud) = (0.0, 0.0);
    let rain = signal(RATE, 40.0, |t| {
        if noise(&mut seed) > 1.0 - 2.0 * 15.0 / f64::from(RATE) {
            (drop, loud) = (t, 0.3 + 0.2 * noise(&mut seed));
        }
        [loud * (-(t - drop) / 0.003).exp() * noise(&mut state); 2]
    });
    for (name, frames) in [("syllables", syllables), ("rain", rain)] {
        let mut moments = Vec::new();
        Analyzer::new(RATE, Alignment::Trailing)
            .push(&frames, &mut |moment| moments.push(moment.features.tempo));
        let reported = moments.iter().filter(|tempo| **tempo > 0.0).count();
        assert!(reported * 20 < moments.len(), "{name}: {reported} of {} moments", moments.len());
    }
}
