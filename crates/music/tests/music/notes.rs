//! Notes, chords and melodies of generated tracks. The timbres are not those on which the constants were chosen.

use mariana_music::{Alignment, Analyzer, Features, NOTE_COUNT, StereoFrame, TimedFeatures};

use super::played::{Kit, Mix, Played, RATE, Timbre, Track, f_of, track};
use super::signals::{analyze_by, noise, signal};

/// Notes at or above this level count as found.
const SOUNDS: f32 = 0.5;

fn sounding(notes: &[Played], time: f64) -> impl Iterator<Item = usize> {
    notes.iter().filter(move |note| (note.from + 0.03..note.to).contains(&time)).map(|note| note.semitone)
}

/// Hits, found and true notes over all moments; right and all moments with a chord; right and all moments of the
/// melody, and the same for moments at which the melody is certain.
#[derive(Debug, Default)]
struct Figures {
    notes: [usize; 3],
    chords: [usize; 2],
    melody: [usize; 2],
    certain: [usize; 2],
}

fn measure(moments: &[TimedFeatures], track: &Track, figures: &mut Figures) {
    for moment in moments {
        let (time, features) = (moment.time, moment.features);
        let mut truth = [false; NOTE_COUNT];
        sounding(&track.notes, time).for_each(|note| truth[note] = true);
        for (level, is_true) in features.notes.iter().zip(truth) {
            let found = *level >= SOUNDS;
            figures.notes[0] += usize::from(found && is_true);
            figures.notes[1] += usize::from(found);
            figures.notes[2] += usize::from(is_true);
        }
        let chord = track.chords.iter().rfind(|chord| chord.0 <= time);
        if let Some((start, root, minor)) = chord
            && time - start > 0.3
            && time < track.chords.last().map_or(0.0, |last| last.0)
        {
            let is_right = features.chord_certainty > 0.0
                && features.chord_root as usize == *root
                && (features.chord_minor == 1.0) == *minor;
            figures.chords[0] += usize::from(is_right);
            figures.chords[1] += 1;
        }
        if let Some(semitone) = sounding(&track.melody, time).next() {
            let is_right = (features.melody - semitone as f32).abs() < 0.5;
            figures.melody[0] += usize::from(is_right);
            figures.melody[1] += 1;
            if features.melody_certainty > 0.5 {
                figures.certain[0] += usize::from(is_right);
                figures.certain[1] += 1;
            }
        }
    }
}

fn figures(timbres: &[Timbre], kits: &[Option<Kit>], first_seed: u64, count: usize) -> Figures {
    let mut figures = Figures::default();
    for n in 0..count {
        let mix = Mix {
            seed: first_seed + n as u64,
            kit: kits[n % kits.len()],
            timbre: timbres[n / kits.len() % timbres.len()],
            music_db: Some(0.0),
            seconds: 12.0,
        };
        let track = track(&mix);
        let moments = analyze_by(Analyzer::new(RATE, Alignment::Centred), &track.frames);
        measure(&moments, &track, &mut figures);
    }
    figures
}

fn share([right, all]: [usize; 2]) -> f64 {
    right as f64 / all.max(1) as f64
}

#[test]
fn notes_of_other_timbres_are_found() {
    let found = figures(&Timbre::HELD_OUT, &[None], 31_000, 6);
    assert!(f_of(found.notes) > 0.75, "{} {found:?}", f_of(found.notes));
    assert!(share(found.chords) > 0.8 && share(found.melody) > 0.8, "{found:?}");
    let with_drums = figures(&Timbre::HELD_OUT, &[Some(Kit::Rock)], 31_000, 3);
    assert!(f_of(with_drums.notes) > 0.6, "{} {with_drums:?}", f_of(with_drums.notes));
}

#[test]
fn silence_and_noise_have_no_chord_and_no_certain_melody() {
    for frames in [vec![[0.0; 2]; 96_000], vec![[f32::NAN; 2]; 96_000]] {
        let moments = analyze_by(Analyzer::new(RATE, Alignment::Trailing), &frames);
        assert!(moments.iter().all(|moment| moment.features.notes == [0.0; NOTE_COUNT]));
        assert!(moments.iter().all(|moment| moment.features.melody_certainty == 0.0));
    }
}

/// A tone is tonal, a train of clicks is percussive, noise is neither.
#[test]
fn tones_and_strokes_are_apart() {
    let mut state = 5;
    let tone = signal(RATE, 4.0, |t| super::signals::chord(t, 0.4));
    let clicks = signal(RATE, 4.0, |t| [if (t * 4.0).fract() < 0.0005 { 0.9 } else { 0.0 }; 2]);
    let hiss = signal(RATE, 4.0, |_| [0.3 * noise(&mut state); 2]);
    let mean = |frames: &[StereoFrame]| {
        let moments = analyze_by(Analyzer::new(RATE, Alignment::Trailing), frames);
        let later = &moments[100..];
        let of = |read: fn(&Features) -> f32| {
            later.iter().map(|moment| read(&moment.features)).fold(0.0_f32, f32::max)
        };
        let [tonal, percussive] = [of(|features| features.tonal), of(|features| features.percussive)];
        (tonal, percussive)
    };
    let (tonal, percussive) = mean(&tone);
    assert!(tonal > 0.6 && percussive < 0.1, "tone: {tonal} {percussive}");
    let (tonal, percussive) = mean(&clicks);
    assert!(tonal < 0.1 && percussive > 0.4, "clicks: {tonal} {percussive}");
    let (tonal, percussive) = mean(&hiss);
    assert!(tonal < 0.4 && percussive < 0.4, "noise: {tonal} {percussive}");
}

/// With `MARIANA_FIGURES` set, prints the figures of all timbres, which takes a minute.
#[test]
fn notes_and_chords_of_a_new_timbre_are_found() {
    if std::env::var_os("MARIANA_FIGURES").is_none() {
        let found = figures(&[Timbre::HELD_OUT[0]], &[None], 50_000, 2);
        assert!(f_of(found.notes) > 0.7 && share(found.chords) > 0.7, "{:?} {:?}", found.notes, found.chords);
        return;
    }
    for (name, timbres, seed) in [("tuning", Timbre::TUNED, 40_000), ("held out", Timbre::HELD_OUT, 50_000)] {
        for timbre in timbres {
            for kit in [None, Some(Kit::Rock)] {
                let found = figures(&[timbre], &[kit], seed, 8);
                let [hits, all, truth] = found.notes;
                println!(
                    "{name} {timbre:?} {kit:?}: notes F {:.3} P {:.3} R {:.3}, chords {:.3}, melody {:.3}, if certain {:.3} of {:.3}",
                    f_of(found.notes),
                    share([hits, all]),
                    share([hits, truth]),
                    share(found.chords),
                    share(found.melody),
                    share(found.certain),
                    share([found.certain[1], found.melody[1]]),
                );
            }
        }
    }
}
