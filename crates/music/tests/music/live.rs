//! Tests of what is heard in live input, with generated songs. The example `live_figures` measures more songs.

use std::f64::consts::{PI, TAU};

use mariana_music::{Alignment, Analyzer, LiveSong, Mode, StereoFrame, Tonality};

use crate::forms::club_song;
use crate::signals::{noise, signal};
use crate::songs::{Song, Style, Swell, Truth, club, pop};

/// Half the usual sample rate, for speed.
const RATE: u32 = 24_000;

type Heard = Vec<(f64, LiveSong)>;

fn listen(frames: &[StereoFrame], alignment: Alignment) -> Heard {
    let mut heard = Vec::new();
    Analyzer::new(RATE, alignment)
        .push(frames, &mut |moment| heard.push((moment.time, moment.features.live)));
    heard
}

fn played(song: &Song) -> (Heard, Truth) {
    let (frames, truth) = song.play(RATE);
    (listen(&frames, Alignment::Trailing), truth)
}

fn drops(heard: &Heard) -> Vec<f64> {
    heard.windows(2).filter(|pair| pair[1].1.drop > pair[0].1.drop).map(|pair| pair[1].0).collect()
}

fn at(heard: &Heard, time: f64) -> LiveSong {
    heard[heard.partition_point(|(t, _)| *t < time)].1
}

fn minor(root: u8) -> Tonality {
    Tonality { root, mode: Mode::Minor }
}

#[test]
fn all_24_keys_are_heard() {
    let mut right = 0;
    for mode in [Mode::Major, Mode::Minor] {
        for root in 0..12 {
            let key = Tonality { root, mode };
            let form = pop(mode).drain(1..3).collect();
            let (heard, _) = played(&Song::new(Style::Rock, 112.0, key, form));
            assert_eq!(at(&heard, 8.0).key, None, "too early to know");
            right += usize::from(at(&heard, 32.0).key == Some(key));
        }
    }
    assert!(right >= 23, "{right} of 24");
}

#[test]
fn chroma_is_the_sounding_chord() {
    let chord = |t: f64| [261.6, 329.6, 392.0].map(|hz| 0.2 * (TAU * hz * t).sin()).iter().sum::<f64>();
    let heard = listen(&signal(RATE, 3.0, |t| [chord(t); 2]), Alignment::Trailing);
    let LiveSong { chroma, key, .. } = at(&heard, 2.9);
    for (class, level) in chroma.iter().enumerate() {
        let sounds = [0, 4, 7].contains(&class);
        assert!(if sounds { *level > 0.7 } else { *level < 0.2 }, "{class}: {level}");
    }
    assert_eq!(key, None);
}

#[test]
fn builds_rise_and_drops_follow() {
    let (heard, truth) = played(&Song::new(Style::FourOnTheFloor, 128.0, minor(4), club(Mode::Minor)));
    let found = drops(&heard);
    assert_eq!(found.len(), truth.drops.len(), "{found:?}, not {:?}", truth.drops);
    for (drop, truly) in found.iter().zip(&truth.drops) {
        assert!((0.0..0.5).contains(&(drop - truly)), "{drop} is not {truly}");
        let [early, late] = [12.0, 1.0].map(|before| at(&heard, truly - before).build);
        assert!(early < 0.4 && late > 0.9, "{early} to {late}");
        // Two bars last 3.75 s.
        let [begun, half, over] = [0.05, 1.9, 3.9].map(|after| at(&heard, drop + after));
        assert!(begun.drop > 0.9 && (0.4..0.6).contains(&half.drop) && over.drop == 0.0);
        assert!(half.build < 0.05, "{}", half.build);
    }
}

#[test]
fn drops_follow_breaks_and_pauses() {
    let (mut hits, mut all, mut count) = (0, 0, 0);
    for (style, seed) in [(Style::FourOnTheFloor, 701), (Style::Rock, 702), (Style::Syncopated, 703)] {
        let (heard, truth) = played(&club_song(style, seed));
        let found = drops(&heard);
        let truly = truth.drops_and_returns();
        let is_found = |truly: &&f64| found.iter().any(|drop| (-0.1..1.5).contains(&(drop - **truly)));
        hits += truly.iter().filter(is_found).count();
        (all, count) = (all + truly.len(), count + found.len());
    }
    assert!(hits >= 4 * all / 5 && count == hits, "{hits} of {all}, {count} reported");
}

#[test]
fn ballads_have_no_drops_and_no_builds() {
    for (number, swell) in Swell::ALL.into_iter().enumerate() {
        let (style, tempo) = [(Style::Ballad, 70.0), (Style::Rock, 88.0)][number % 2];
        let (heard, _) = played(&Song::new(style, tempo, minor(9), swell.ballad(Mode::Minor)));
        assert_eq!(drops(&heard), [0.0; 0], "{swell:?}");
        let build = heard.iter().map(|(_, song)| song.build).fold(0.0, f32::max);
        assert!(build < 0.3, "{swell:?}: {build}");
    }
}

#[test]
fn nothing_is_heard_in_noise_speech_and_silence() {
    let (mut state, mut seed) = (4, 11);
    let gusts = signal(RATE, 60.0, |t| [0.3 * noise(&mut state) * (0.6 - 0.4 * (0.4 * t).cos()); 2]);
    let (mut begins, mut length, mut loud) = (0.0, 0.0, 0.0);
    let speech = signal(RATE, 60.0, |t| {
        if t >= begins + length {
            let pauses = noise(&mut seed) > 0.7;
            (begins, length) = (t, if pauses { 0.8 } else { 0.2 + 0.08 * noise(&mut seed) });
            loud = if pauses { 0.0 } else { 0.4 };
        }
        let voice = (TAU * 120.0 * t).sin() + 0.5 * (TAU * 240.0 * t).sin() + noise(&mut seed);
        [0.3 * loud * (PI * (t - begins) / length).sin() * voice; 2]
    });
    let silence = vec![[0.0; 2]; 20 * RATE as usize];
    for (name, frames) in [("gusts", gusts), ("speech", speech), ("silence", silence)] {
        let (mut sum, mut count) = (0.0, 0.0);
        for (time, song) in listen(&frames, Alignment::Trailing) {
            let LiveSong { chroma, key, build, drop, .. } = song;
            assert_eq!((key, build, drop), (None, 0.0, 0.0), "{name} at {time}");
            sum += chroma.iter().sum::<f32>();
            count += 1.0;
        }
        // Speech has pitches.
        let most = if name == "speech" { 12.0 } else { 2.0 };
        assert!(sum < most * count, "{name}: {}", sum / count);
    }
}

#[test]
fn novelty_rises_at_new_sections() {
    let (heard, truth) = played(&Song::new(Style::Rock, 120.0, minor(2), pop(Mode::Minor)));
    for border in truth.changes().into_iter().filter(|border| *border > 12.0) {
        let after = |from: f64, to: f64| {
            let values = heard.iter().filter(|(t, _)| (border + from..border + to).contains(t));
            values.map(|(_, song)| song.novelty).fold(0.0, f32::max)
        };
        assert!(after(0.0, 5.0) > 0.8, "{} at {border}", after(0.0, 5.0));
        assert!(after(0.0, 5.0) > 1.5 * after(-1.0, 0.0), "{} at {border}", after(-1.0, 0.0));
    }
}

#[test]
fn files_have_no_live_song() {
    let (frames, _) = Song::new(Style::Rock, 120.0, minor(2), pop(Mode::Minor)).play(RATE);
    let frames = &frames[..30 * RATE as usize];
    assert!(listen(frames, Alignment::Centred).iter().all(|(_, song)| *song == LiveSong::UNKNOWN));
}
