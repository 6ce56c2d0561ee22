//! Kicks, snares and hats of generated drum tracks, alone and with music. The kits and timbres are not those from which
//! the classifiers were computed.

use mariana_music::{Alignment, Analyzer, Features, StereoFrame, TimedFeatures};

use super::played::{Kit, Mix, RATE, Struck, Timbre, f_of, matches, steady_noise, track};
use super::signals::{analyze_by, noise, signal};

type Read = fn(&Features) -> f32;

const READ: [(Struck, Read); 3] = [
    (Struck::Kick, |features| features.kick),
    (Struck::Snare, |features| features.snare),
    (Struck::Hat, |features| features.hat),
];

fn analyzed(rate: u32, frames: &[StereoFrame], alignment: Alignment) -> Vec<TimedFeatures> {
    analyze_by(Analyzer::new(rate, alignment), frames)
}

/// The times at which the envelope rises.
fn found(moments: &[TimedFeatures], read: Read) -> Vec<f64> {
    let mut found: Vec<f64> = Vec::new();
    for pair in moments.windows(2) {
        let [before, now] = [&pair[0], &pair[1]].map(|moment| read(&moment.features));
        let time = pair[1].time;
        // The strength may still rise in the two moments after a stroke.
        if now > before && found.last().is_none_or(|last| time - last > 0.05) {
            found.push(time);
        }
    }
    found
}

#[test]
fn strokes_of_other_kits_are_found() {
    let mut sums = [[0; 3]; 3];
    let levels = [None, Some(-12.0), Some(-6.0), Some(0.0)];
    for (n, kit) in Kit::HELD_OUT.into_iter().cycle().take(8).enumerate() {
        let mix = Mix {
            seed: 20_000 + n as u64,
            kit: Some(kit),
            timbre: Timbre::HELD_OUT[n % 3],
            music_db: levels[n % 4],
            seconds: 12.0,
        };
        let track = track(&mix);
        let moments = analyzed(RATE, &track.frames, Alignment::Trailing);
        for ((drum, read), sum) in READ.into_iter().zip(&mut sums) {
            let mut truth: Vec<f64> =
                track.strokes.iter().filter(|stroke| stroke.1 == drum).map(|stroke| stroke.0).collect();
            truth.sort_by(f64::total_cmp);
            let counts = matches(&found(&moments, read), &truth, 0.05);
            sum.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
        }
    }
    let [kick, snare, hat] = sums.map(f_of);
    assert!(
        kick > 0.85 && snare > 0.85 && hat > 0.75,
        "kick {kick:.3}, snare {snare:.3}, hat {hat:.3}: {sums:?}"
    );
}

#[test]
fn live_and_played_strokes_agree() {
    let mix = Mix { seed: 4, kit: Some(Kit::Rock), timbre: Timbre::Saw, music_db: Some(-6.0), seconds: 6.0 };
    let frames = track(&mix).frames;
    let [live, played] =
        [Alignment::Trailing, Alignment::Centred].map(|alignment| analyzed(RATE, &frames, alignment));
    // Centred windows show a stroke one hop earlier.
    for (read, until) in READ.map(|(_, read)| (read, 500)) {
        for (live, played) in live[20..until].iter().zip(&played[19..]) {
            assert_eq!(read(&live.features), read(&played.features), "at {} s", live.time);
        }
    }
}

#[test]
fn steady_sound_has_no_strokes() {
    for seed in 100..104 {
        let track = steady_noise(seed, 10.0);
        let moments = analyzed(RATE, &track.frames, Alignment::Trailing);
        for (drum, read) in READ {
            let strokes = found(&moments, read).into_iter().filter(|time| *time > 0.5).count();
            assert_eq!(strokes, 0, "{drum:?} in noise {seed}");
        }
    }
    let chord = signal(48_000, 6.0, |t| super::signals::chord(t, 0.4));
    let moments = analyzed(RATE, &chord, Alignment::Trailing);
    assert!(READ.into_iter().all(|(_, read)| found(&moments, read).iter().all(|time| *time < 0.5)));
}

#[test]
fn bad_sound_is_neutral() {
    let mut state = 3;
    for rate in [4_000, 8_000, 48_000] {
        let silent = [[f32::NAN; 2], [0.0; 2], [f32::NEG_INFINITY, f32::NAN]];
        for bad in silent {
            let moments = analyzed(rate, &vec![bad; rate as usize], Alignment::Trailing);
            assert!(
                moments.iter().all(|moment| moment.features == Features::SILENCE),
                "{bad:?} at {rate} Hz"
            );
        }
        let clipped = signal(rate, 2.0, |_| [9.0 * noise(&mut state), 0.0]);
        for moment in analyzed(rate, &clipped, Alignment::Centred) {
            let features = moment.features;
            let all = [features.kick, features.snare, features.hat];
            assert!(all.iter().all(|value| (0.0..=1.0).contains(value)), "{all:?} at {rate} Hz");
            assert!((-70.0..30.0).contains(&features.loudness_lufs), "{} LUFS", features.loudness_lufs);
        }
    }
}
