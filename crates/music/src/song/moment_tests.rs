//! Tests of moments, with hand-made and with arbitrary structures.

use proptest::prelude::*;

use super::super::{Meter, Mode, PitchFractions, Section, SongBeat, SongStructure, Stretch, Tonality};
use super::SongMoment;
use crate::features::Features;
use crate::live::LiveSong;

/// A song in 4/4 at 120 beats per minute. The first bar begins at 1 s. At 17 s section B begins with a drop.
fn song() -> SongStructure {
    let section = |start, end, letter: &str| Section { start, end, letter: letter.into(), energy: 0.5 };
    let chroma = |index: usize| {
        let mut fractions = [0.0; 12];
        (fractions[0], fractions[7]) = if index.is_multiple_of(2) { (0.8, 0.2) } else { (0.2, 0.8) };
        PitchFractions { start: 0.5 * index as f64, fractions }
    };
    SongStructure {
        seconds: 32.0,
        tempo: Some(120.0),
        meter: Some(Meter::FourFour),
        beats: (0..60)
            .map(|index| SongBeat {
                time: 1.0 + 0.5 * f64::from(index),
                of_bar: (index % 4) as u8 + 1,
                tempo: 120.0,
            })
            .collect(),
        sections: vec![section(0.0, 17.0, "A"), section(17.0, 32.0, "B")],
        energy_step: 0.25,
        energy: (0..128).map(|step| step as f32 / 127.0).collect(),
        builds: vec![Stretch { start: 9.0, end: 17.0 }],
        drops: vec![17.0],
        key: Some(Tonality { root: 9, mode: Mode::Minor }),
        chroma: (0..64).map(chroma).collect(),
        ..SongStructure::default()
    }
}

#[test]
fn tempo_and_phase_match_the_bar() {
    let song = song();
    for time in [0.2, 1.0, 1.1, 7.85, 30.9, 31.8] {
        let mut features = Features { tempo: 60.0, phase: 0.3, ..Features::SILENCE };
        features.follow_song(&song, time);
        let of_bar = song.moment(time).bar * 4.0;
        assert!(
            close(features.tempo, 120.0) && close(features.phase, of_bar.fract()),
            "at {time} s: {features:?}"
        );
    }
    let mut features = Features { tempo: 60.0, phase: 0.3, ..Features::SILENCE };
    features.follow_song(&SongStructure::default(), 1.0);
    features.follow_song(&song, f64::NAN);
    assert_eq!((features.tempo, features.phase), (60.0, 0.3));
}

fn close(a: f32, b: f32) -> bool {
    (a - b).abs() < 1e-5
}

#[test]
fn bars_continue_before_the_first_and_after_the_last_beat() {
    let song = song();
    let reported = |time: f64| {
        let moment = song.moment(time);
        (moment.bar, moment.beat_in_bar)
    };
    for (time, bar, beat) in [
        (1.0, 0.0, 1.0),
        (1.25, 0.125, 1.0),
        (1.5, 0.25, 2.0),
        (2.75, 0.875, 4.0),
        (3.0, 0.0, 1.0),
        // These times are in the bar before the first beat.
        (0.75, 0.875, 4.0),
        (0.0, 0.5, 3.0),
        (30.75, 0.875, 4.0),
        (31.25, 0.125, 1.0),
    ] {
        let found = reported(time);
        assert!(close(found.0, bar) && found.1 == beat, "{time} s: {found:?}, not {bar}, {beat}");
    }
}

#[test]
fn sections_builds_and_drops_have_their_positions() {
    let song = song();
    for (time, section, phase, build, drop) in [
        (0.0, 1.0, 0.0, 0.0, 0.0),
        (8.5, 1.0, 0.5, 0.0, 0.0),
        (13.0, 1.0, 13.0 / 17.0, 0.5, 0.0),
        (16.999_999, 1.0, 1.0, 1.0, 0.0),
        (17.0, 2.0, 0.0, 0.0, 1.0),
        // Two bars are 4 s.
        (19.0, 2.0, 2.0 / 15.0, 0.0, 0.5),
        (21.0, 2.0, 4.0 / 15.0, 0.0, 0.0),
        (99.0, 2.0, 1.0, 0.0, 0.0),
    ] {
        let moment = song.moment(time);
        assert_eq!(moment.section, section, "{time} s");
        for (found, wanted) in [(moment.section_phase, phase), (moment.build, build), (moment.drop, drop)] {
            assert!(close(found, wanted), "{time} s: {moment:?}");
        }
    }
}

#[test]
fn the_next_beat_bar_section_and_drop_are_known() {
    let song = song();
    for (time, beat, bar, section, drop) in [
        (0.0, 0.5, 1.0, 17.0, 17.0),
        (0.75, 0.25, 0.25, 16.25, 16.25),
        (1.0, 0.5, 2.0, 16.0, 16.0),
        (16.75, 0.25, 0.25, 0.25, 0.25),
        (17.0, 0.5, 2.0, 1_000.0, 1_000.0),
        (18.25, 0.25, 0.75, 1_000.0, 1_000.0),
        // These times are after the last beat, at 30.5 s, which is the fourth of its bar.
        (30.75, 0.25, 0.25, 1_000.0, 1_000.0),
        (31.25, 0.25, 1.75, 1_000.0, 1_000.0),
    ] {
        let moment = song.moment(time);
        let found = [moment.to_beat, moment.to_bar, moment.to_section, moment.to_drop];
        let near = found.iter().zip([beat, bar, section, drop]).all(|(a, b)| close(*a, b));
        assert!(near, "{time} s: {found:?}, not {beat}, {bar}, {section}, {drop}");
    }
    // A bar that ends early ends at the next downbeat.
    let mut broken = song.clone();
    broken.beats.iter_mut().skip(6).for_each(|beat| beat.of_bar = (beat.of_bar + 1) % 4 + 1);
    assert!(close(broken.moment(3.25).to_bar, 0.75));
}

#[test]
fn energy_chroma_and_progress_have_no_steps() {
    let song = song();
    let mut before = song.moment(0.0);
    for step in 1..3200 {
        let moment = song.moment(f64::from(step) / 100.0);
        let changes = before.chroma.iter().zip(moment.chroma).map(|(a, b)| (a - b).abs());
        assert!(changes.fold(0.0, f32::max) < 0.03, "chroma at {step}");
        assert!((moment.energy - before.energy).abs() < 1e-3, "energy at {step}");
        assert!((moment.progress - before.progress).abs() < 1e-3, "progress at {step}");
        before = moment;
    }
    // The middles of the first two beats.
    assert_eq!((song.moment(0.25).chroma[0], song.moment(0.25).chroma[7]), (1.0, 0.25));
    assert_eq!((song.moment(0.75).chroma[0], song.moment(0.75).chroma[7]), (0.25, 1.0));
    assert!(close(song.moment(16.0).progress, 0.5) && close(song.moment(16.0).energy, 63.5 / 127.0));
    assert_eq!((song.moment(5.0).key, song.moment(5.0).minor), (9.0, 1.0));
}

#[test]
fn unknown_values_are_zero_and_unknown_times_are_far() {
    assert_eq!(SongStructure::default().moment(3.0), SongMoment::UNKNOWN);
    assert_eq!(song().moment(f64::NAN), SongMoment::UNKNOWN);
    assert_eq!(SongMoment::default(), SongMoment::UNKNOWN);
    let no_beat = SongStructure { meter: None, beats: Vec::new(), tempo: None, ..song() };
    let moment = no_beat.moment(18.0);
    assert_eq!((moment.bar, moment.beat_in_bar, moment.drop), (0.0, 0.0, 0.75));
    assert_eq!((moment.to_beat, moment.to_bar), (1_000.0, 1_000.0));
}

#[test]
fn numbers_have_names() {
    let moment = song().moment(19.3);
    assert_eq!(moment.number("section_phase"), Some(moment.section_phase));
    assert_eq!(moment.number("to_bar"), Some(moment.to_bar));
    for name in ["chroma", "volume.x", ""] {
        assert_eq!(moment.number(name), None, "{name}");
    }
}

fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        -5.0..400.0_f64,
        any::<f64>(),
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(f64::NEG_INFINITY),
        Just(0.0)
    ]
}

fn any_fraction() -> impl Strategy<Value = f32> {
    prop_oneof![0.0..1.0_f32, any::<f32>(), Just(f32::NAN)]
}

prop_compose! {
    fn any_song()(
        seconds in any_number(),
        tempo in proptest::option::of(any_fraction()),
        meter in prop_oneof![Just(None), Just(Some(Meter::FourFour)), Just(Some(Meter::ThreeFour)), Just(Some(Meter::SixEight))],
        beats in prop::collection::vec((any_number(), any::<u8>(), any_fraction()), 0..20),
        sections in prop::collection::vec((any_number(), any_number(), "[A-Z]{0,3}|[a-zé]"), 0..6),
        energy_step in any_number(),
        energy in prop::collection::vec(any_fraction(), 0..20),
        builds in prop::collection::vec((any_number(), any_number()), 0..4),
        drops in prop::collection::vec(any_number(), 0..4),
        root in proptest::option::of(any::<u8>()),
        chroma in prop::collection::vec((any_number(), prop::array::uniform12(any_fraction())), 0..8),
    ) -> SongStructure {
        SongStructure {
            seconds,
            tempo,
            meter,
            beats: beats.into_iter().map(|(time, of_bar, tempo)| SongBeat { time, of_bar, tempo }).collect(),
            sections: sections
                .into_iter()
                .map(|(start, end, letter)| Section { start, end, letter, energy: 0.0 })
                .collect(),
            energy_step,
            energy,
            builds: builds.into_iter().map(|(start, end)| Stretch { start, end }).collect(),
            drops,
            key: root.map(|root| Tonality { root, mode: Mode::Minor }),
            chroma: chroma.into_iter().map(|(start, fractions)| PitchFractions { start, fractions }).collect(),
            ..SongStructure::default()
        }
    }
}

proptest! {
    #[test]
    fn any_structure_and_time_give_values_in_range(song in any_song(), time in any_number()) {
        let moment = song.moment(time);
        let SongMoment { bar, beat_in_bar, section, section_phase, energy, build, drop, key, minor, progress, chroma, to_beat, to_bar, to_section, to_drop, line, word, line_phase } = moment;
        prop_assert!((0.0..1.0).contains(&bar), "{:?}", moment);
        for value in [section_phase, energy, build, drop, minor, progress].into_iter().chain(chroma) {
            prop_assert!((0.0..=1.0).contains(&value), "{:?}", moment);
        }
        prop_assert!((0.0..=4.0).contains(&beat_in_bar) && (0.0..=26.0).contains(&section), "{:?}", moment);
        prop_assert!((0.0..=11.0).contains(&key), "{:?}", moment);
        for value in [to_beat, to_bar, to_section, to_drop] {
            prop_assert!((0.0..=1_000.0).contains(&value), "{:?}", moment);
        }
        prop_assert_eq!([line, word, line_phase], [0.0; 3], "lyrics are no part of the structure");
        prop_assert_eq!(song.moment(time), moment);
    }
}

#[test]
fn live_bars_are_reported_while_certain() {
    let heard = |bar_beat, bar_beats, phase| {
        let features = Features { bar_beat, bar_beats, phase, tempo: 120.0, ..Features::SILENCE };
        let moment = SongMoment::of_live(0.4, &features);
        assert_eq!((moment.energy, moment.section, moment.progress), (0.4, 0.0, 0.0));
        assert_eq!((moment.to_beat, moment.to_section), (0.5 * (1.0 - phase), 1_000.0));
        (moment.bar, moment.beat_in_bar)
    };
    assert_eq!(heard(1.0, 4.0, 0.0), (0.0, 1.0));
    assert_eq!(heard(3.0, 4.0, 0.5), (0.625, 3.0));
    assert_eq!(heard(0.0, 0.0, 0.5), (0.0, 0.0));
    assert!(heard(4.0, 4.0, 1.0).0 < 1.0);
}

#[test]
fn live_harmony_builds_and_drops_are_reported() {
    let key = Some(Tonality { root: 9, mode: Mode::Minor });
    let live = LiveSong { chroma: [0.25; 12], key, build: 0.5, drop: 0.75, novelty: 3.0 };
    let moment = SongMoment::of_live(0.4, &Features { live, ..Features::SILENCE });
    assert_eq!((moment.key, moment.minor, moment.build, moment.drop), (9.0, 1.0, 0.5, 0.75));
    assert_eq!(moment.chroma, live.chroma);
    let nothing = SongMoment::of_live(0.0, &Features::SILENCE);
    assert_eq!(nothing, SongMoment::UNKNOWN);
}
