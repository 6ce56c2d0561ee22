//! Tests of the structure of generated songs and of other sounds. The example `song_figures` measures more songs.

use crate::forms::{Form, club_song};
use crate::signals::noise;
use crate::songs::{
    Kind, Part, Song, Style, Swell, Truth, Voice, bars_heard, beats_heard, borders, breaks, chords, club,
    f_measure, false_returns, labels, pop, structure,
};
use mariana_music::{Alignment, Analyzer, Meter, Mode, SongListener, SongStructure, StereoFrame, Tonality};

/// Half the usual sample rate, for speed.
const RATE: u32 = 24_000;

fn heard(song: &Song) -> (SongStructure, Truth) {
    let (frames, truth) = song.play(RATE);
    (structure(RATE, &frames), truth)
}

fn require_sense(structure: &SongStructure) {
    assert!(structure.beats.windows(2).all(|pair| pair[0].time < pair[1].time));
    let beats_per_bar = structure.meter.map_or(0, Meter::beats);
    assert!(structure.beats.iter().all(|beat| {
        (1..=beats_per_bar).contains(&usize::from(beat.of_bar))
            && (0.0..=structure.seconds).contains(&beat.time)
            && beat.tempo.is_finite()
    }));
    assert_eq!(structure.beats.is_empty(), structure.tempo.is_none() && structure.meter.is_none());
    let ends = |starts: Vec<(f64, f64)>| {
        assert!(starts.windows(2).all(|pair| pair[0].1 == pair[1].0), "{starts:?} have gaps");
        assert!(starts.first().is_none_or(|(start, _)| *start == 0.0));
        assert!(starts.last().is_none_or(|(_, end)| *end == structure.seconds));
    };
    ends(structure.sections.iter().map(|section| (section.start, section.end)).collect());
    ends(structure.chords.iter().map(|chord| (chord.start, chord.end)).collect());
    assert!(structure.energy.iter().all(|energy| (0.0..=1.0).contains(energy)));
    assert!(structure.sections.iter().all(|section| (0.0..=1.0).contains(&section.energy)));
}

#[test]
fn beats_bars_sections_and_key_of_songs_are_found() {
    let of = |style, tempo, root, mode| Song::new(style, tempo, Tonality { root, mode }, pop(mode));
    let swung = Song { swing: 0.667, ..of(Style::Jazz, 132.0, 7, Mode::Major) };
    let faster = Song { tempo: (92.0, 128.0), cents: 30.0, ..of(Style::Rock, 92.0, 4, Mode::Minor) };
    let songs = [
        of(Style::Syncopated, 104.0, 0, Mode::Minor),
        of(Style::Waltz, 128.0, 10, Mode::Major),
        swung,
        faster,
    ];
    for song in songs {
        let (found, truth) = heard(&song);
        require_sense(&found);
        let beats: Vec<f64> = found.beats.iter().map(|beat| beat.time).collect();
        let downbeats: Vec<f64> = found.downbeats().collect();
        let figures = [
            f_measure(&beats, &truth.beats, 0.07),
            f_measure(&downbeats, &truth.downbeats, 0.07),
            f_measure(&borders(&found), &truth.borders, 0.5),
            labels(&found, &truth),
        ];
        let what =
            format!("{:?} at {:?}: {figures:?}, sections {:?}", song.style, song.tempo, found.sections);
        assert!(figures.iter().zip([0.95, 0.9, 0.9, 0.9]).all(|(figure, least)| *figure >= least), "{what}");
        assert_eq!((found.meter, found.key), (Some(song.style.meter()), Some(song.key)), "{what}");
        assert!(found.drops.is_empty(), "{what}");
    }
}

/// Its bars were numbered from the second one on.
#[test]
fn the_first_beat_of_a_song_without_a_lead_in_was_lost() {
    for (style, tempo) in [(Style::Rock, 112.5), (Style::FourOnTheFloor, 128.0), (Style::Syncopated, 97.0)] {
        let key = Tonality { root: 0, mode: Mode::Minor };
        let (frames, truth) = Song::new(style, tempo, key, pop(key.mode)[1..5].to_vec()).play(RATE);
        let start = (truth.downbeats[0] * f64::from(RATE)).round() as usize;
        let found = structure(RATE, &frames[start..]);
        let first = found.beats[0];
        assert!(first.time < 0.05 && first.of_bar == 1, "{style:?} at {tempo}: {first:?}");
    }
}

/// Their eighths were taken for beats.
#[test]
fn slow_songs_are_not_told_at_twice_their_tempo() {
    let key = Tonality { root: 9, mode: Mode::Minor };
    for (style, tempo) in [(Style::Rock, 72.0), (Style::Ballad, 66.0), (Style::Syncopated, 84.0)] {
        let song = Song::new(style, tempo, key, pop(key.mode)[..4].to_vec());
        let (found, truth) = heard(&song);
        let beats: Vec<f64> = found.beats.iter().map(|beat| beat.time).collect();
        let figure = f_measure(&beats, &truth.beats, 0.07);
        assert!(figure > 0.9, "{style:?} at {tempo}: {figure}, told {:?}", found.tempo);
    }
}

#[test]
fn two_dotted_beats_are_six_eight() {
    let key = Tonality { root: 2, mode: Mode::Major };
    let (found, truth) = heard(&Song::new(Style::SixEight, 96.0, key, pop(Mode::Major)));
    assert_eq!(found.meter, Some(Meter::SixEight));
    let downbeats: Vec<f64> = found.downbeats().collect();
    assert!(f_measure(&downbeats, &truth.downbeats, 0.07) > 0.9);
}

#[test]
fn harmony_alone_and_timbre_alone_make_sections() {
    for by_harmony in [true, false] {
        let part = |letter, bars, number| Part {
            letter,
            bars,
            chords: chords(Mode::Minor, if by_harmony { number } else { 0 }),
            drums: true,
            bass: true,
            voice: if by_harmony { Voice::Organ } else { [Voice::Organ, Voice::Bright][number] },
            arpeggio: true,
            loud: 0.8,
            ..Part::default()
        };
        let form = vec![part('A', 8, 0), part('B', 8, 1), part('A', 8, 0), part('B', 16, 1)];
        let (found, truth) =
            heard(&Song::new(Style::Rock, 120.0, Tonality { root: 9, mode: Mode::Minor }, form));
        let f = f_measure(&borders(&found), &truth.borders, 0.5);
        assert!(f >= 0.8, "by harmony: {by_harmony}, F = {f:.2}, {:?}", found.sections);
    }
}

/// Sections return with other notes, other instruments or in another key, and keep their letter.
#[test]
fn returning_sections_have_their_letter() {
    for (form, style, seed) in [
        (Form::Aaba, Style::Rock, 1),
        (Form::VerseChorus, Style::FourOnTheFloor, 2),
        (Form::Rondo, Style::Waltz, 4),
        (Form::Pedals, Style::Rock, 1),
        (Form::Twice, Style::FourOnTheFloor, 2),
    ] {
        let (found, truth) = heard(&form.song(style, seed));
        let figures = [f_measure(&borders(&found), &truth.changes(), 0.5), labels(&found, &truth)];
        assert!(figures.iter().all(|figure| *figure >= 0.9), "{form:?}: {figures:?}, {:?}", found.sections);
    }
}

#[test]
fn nothing_returns_in_a_through_composed_song() {
    for (form, style, seed) in [(Form::Through, Style::Rock, 1), (Form::ThroughPlain, Style::Rock, 1)] {
        let (found, truth) = heard(&form.song(style, seed));
        assert!(found.sections.len() > 4, "{:?}", found.sections);
        assert_eq!(false_returns(&found, &truth), 0, "{form:?}: {:?}", found.sections);
    }
}

#[test]
fn builds_and_breaks_lead_to_drops() {
    let key = Tonality { root: 4, mode: Mode::Minor };
    for (form, builds) in [(club(Mode::Minor), 2), (breaks(Mode::Minor), 1)] {
        let (found, truth) = heard(&Song::new(Style::FourOnTheFloor, 128.0, key, form));
        assert_eq!(found.drops.len(), truth.drops.len(), "{:?}, not {:?}", found.drops, truth.drops);
        for (drop, truly) in found.drops.iter().zip(&truth.drops) {
            assert!((drop - truly).abs() < 0.1, "{drop} is not {truly}");
        }
        let leads =
            |drop: &&f64| found.builds.iter().any(|build| build.end == **drop && build.start < **drop - 5.0);
        assert_eq!(found.drops.iter().filter(leads).count(), builds, "{:?}", found.builds);
    }
}

/// A break without drums and bass is followed by a drop only if it ends with a build or a pause.
#[test]
fn drops_follow_builds_and_pauses_but_not_breaks() {
    let (mut hits, mut all, mut found) = (0, 0, 0);
    for (style, seed) in [(Style::FourOnTheFloor, 1), (Style::Rock, 6), (Style::Syncopated, 8)] {
        let (song, truth) = heard(&club_song(style, seed));
        let is_found = |drop: &&f64| song.drops.iter().any(|found| (found - **drop).abs() < 0.1);
        hits += truth.drops.iter().filter(is_found).count();
        (all, found) = (all + truth.drops.len(), found + song.drops.len());
    }
    assert_eq!((hits, found), (all, all));
}

/// Instruments that enter one by one at the start, and a rise to a section that is no louder, are no builds.
#[test]
fn a_rise_without_arrival_is_no_build() {
    let key = Tonality { root: 4, mode: Mode::Minor };
    let club = club(Mode::Minor);
    let [_, build, drop, rest, ..] = club.as_slice() else { panic!("the form has seven parts") };
    let calm = Part { drums: true, bass: true, loud: 0.4, ..rest.clone() };
    let drop = Part { kind: Kind::Plain, ..drop.clone() };
    let form = vec![build.clone(), calm.clone(), drop, calm.clone(), build.clone(), calm];
    let (found, _) = heard(&Song::new(Style::FourOnTheFloor, 120.0, key, form));
    assert!(found.builds.is_empty() && found.drops.is_empty(), "{:?}, {:?}", found.builds, found.drops);
}

#[test]
fn ballads_have_no_drops() {
    let key = Tonality { root: 4, mode: Mode::Major };
    for swell in Swell::ALL {
        for tempo in [70.0, 84.0] {
            let (found, _) = heard(&Song::new(Style::Ballad, tempo, key, swell.ballad(Mode::Major)));
            assert!(found.drops.is_empty(), "{swell:?} at {tempo}: {:?}", found.drops);
        }
    }
}

/// A chorus, or the first verse after an intro, is much louder than the bars before it and brings drums and bass.
#[test]
fn an_entry_of_the_band_is_no_drop() {
    let key = Tonality { root: 2, mode: Mode::Minor };
    let club = club(Mode::Minor);
    let [_, _, chorus, verse, ..] = club.as_slice() else { panic!("the form has seven parts") };
    let chorus = Part { kind: Kind::Plain, bars: 8, ..chorus.clone() };
    for style in [Style::Rock, Style::Syncopated] {
        let form = vec![verse.clone(), chorus.clone(), verse.clone(), chorus.clone()];
        let (found, _) = heard(&Song::new(style, 112.0, key, form));
        assert!(found.drops.is_empty(), "{style:?}: {:?}", found.drops);
    }
}

#[test]
fn music_after_silence_is_no_drop() {
    let key = Tonality { root: 9, mode: Mode::Minor };
    let form = club(Mode::Minor).split_off(5);
    let (mut frames, _) = Song::new(Style::FourOnTheFloor, 124.0, key, form).play(RATE);
    let again = frames.clone();
    frames.resize(frames.len() + 20 * RATE as usize, [0.0; 2]);
    frames.extend(again);
    let found = structure(RATE, &frames);
    assert!(found.drops.is_empty() && found.sections.len() > 3, "{:?}", found.drops);
}

/// Live bar tracking needs some bars before it is certain, and is then nearly always right.
#[test]
fn live_bars_are_right_once_reported() {
    for (style, tempo) in [(Style::Ballad, 83.0), (Style::FourOnTheFloor, 128.0), (Style::Waltz, 104.0)] {
        let key = Tonality { root: 9, mode: Mode::Minor };
        let (frames, truth) = Song::new(style, tempo, key, pop(Mode::Minor)).play(RATE);
        let beats = beats_heard(RATE, &frames);
        let [reported, right] = bars_heard(&beats, &truth);
        assert!(reported > 0.5 && right > 0.9, "{style:?}: {reported:.2} reported, {right:.2} right");
        let played = Analyzer::new(RATE, Alignment::Centred);
        assert!(reported_of_bars(played, &frames) == 0, "files have no live bars");
    }
}

/// Equal clicks have no bars, and noise has no beats.
#[test]
fn no_bars_are_reported_without_bars() {
    let rate = f64::from(RATE);
    let clicks: Vec<StereoFrame> = (0..RATE * 60)
        .map(|n| {
            let since = f64::from(n % (RATE / 2)) / rate;
            [(0.6 * (std::f64::consts::TAU * 900.0 * since).sin() * (-since / 0.01).exp()) as f32; 2]
        })
        .collect();
    let mut state = 3;
    let hiss: Vec<StereoFrame> = (0..RATE * 60).map(|_| [0.3 * noise(&mut state) as f32; 2]).collect();
    for frames in [clicks, hiss] {
        assert_eq!(reported_of_bars(Analyzer::new(RATE, Alignment::Trailing), &frames), 0);
    }
}

fn reported_of_bars(mut analyzer: Analyzer, frames: &[StereoFrame]) -> usize {
    let mut reported = 0;
    analyzer.push(frames, &mut |moment| reported += usize::from(moment.features.bar_beat > 0.0));
    reported
}

#[test]
fn block_sizes_do_not_matter() {
    let key = Tonality { root: 0, mode: Mode::Major };
    let mut form = pop(Mode::Major);
    form.truncate(2);
    let (frames, _) = Song::new(Style::Rock, 120.0, key, form).play(RATE);
    let whole = structure(RATE, &frames);
    let mut listener = SongListener::new(RATE);
    frames.chunks(997).for_each(|block| listener.push(block));
    assert!(listener.finish() == whole);
}

#[test]
fn other_sounds_have_a_sensible_structure_or_none() {
    let of = |seconds: f64, sample: &mut dyn FnMut(f64) -> f64| {
        let count = (seconds * f64::from(RATE)) as usize;
        let frames: Vec<StereoFrame> =
            (0..count).map(|n| [sample(n as f64 / f64::from(RATE)) as f32; 2]).collect();
        let found = structure(RATE, &frames);
        require_sense(&found);
        found
    };
    let tone = |hz: f64, t: f64| (std::f64::consts::TAU * hz * t).sin();
    let nothing = structure(RATE, &[]);
    require_sense(&nothing);
    assert!(nothing.silent && nothing.sections.is_empty());
    let silence = of(20.0, &mut |_| 0.0);
    assert!(silence.silent && silence.beats.is_empty() && silence.key.is_none());
    let note = of(60.0, &mut |t| 0.3 * tone(220.0, t));
    assert!(note.beats.is_empty() && note.key.is_none() && note.sections.len() == 1, "{:?}", note.sections);
    let mut state = 1;
    let hiss = of(40.0, &mut |_| 0.3 * noise(&mut state));
    assert_eq!((hiss.key, hiss.beats.len(), hiss.sections.len()), (None, 0, 1));
    // Stereo noise has random spectral peaks, which are no harmony.
    let stereo: Vec<StereoFrame> =
        (0..RATE * 120).map(|_| [0; 2].map(|_| 0.3 * noise(&mut state) as f32)).collect();
    let wide = structure(RATE, &stereo);
    assert_eq!((wide.key, wide.beats.len(), wide.sections.len()), (None, 0, 1), "{:?}", wide.sections);
    // Both tones hold one note. The first has overtones, the second has vibrato.
    let rich = of(120.0, &mut |t| (1..8).map(|k| 0.1 / f64::from(k) * tone(110.0 * f64::from(k), t)).sum());
    assert!(rich.key.is_none() && rich.sections.len() == 1, "{:?}, {:?}", rich.key, rich.sections);
    let waver = of(120.0, &mut |t| 0.3 * (std::f64::consts::TAU * 330.0 * t + 3.0 * tone(5.5, t)).sin());
    assert!(waver.beats.is_empty() && waver.sections.len() == 1, "{:?}", waver.tempo);
    // Noise in syllables of random length, as in speech, with pauses.
    let (mut begins, mut length, mut loud, mut seed) = (0.0, 0.2, 0.0, 5);
    let speech = of(90.0, &mut |t| {
        if t >= begins + length {
            begins = t;
            length = 0.19 + 0.1 * noise(&mut seed);
            let pauses = noise(&mut seed) > 0.8;
            length += if pauses { 0.6 + 0.3 * noise(&mut seed) } else { 0.0 };
            loud = if pauses { 0.0 } else { 0.35 + 0.15 * noise(&mut seed) };
        }
        loud * (std::f64::consts::PI * (t - begins) / length).sin() * noise(&mut state)
    });
    assert_eq!((speech.key, speech.beats.len()), (None, 0), "{:?}", speech.tempo);
    // Chords that swell without onsets.
    let swell = of(60.0, &mut |t| {
        let root = 220.0 * [1.0, 1.335, 1.498, 1.0][(t / 7.3) as usize % 4];
        let loud = 0.2 * (1.0 - (std::f64::consts::TAU * t / 7.3).cos());
        loud * (tone(root, t) + tone(1.26 * root, t) + tone(1.498 * root, t)) / 3.0
    });
    assert!(swell.beats.is_empty() && swell.drops.is_empty(), "{:?}", swell.tempo);
    let short = of(2.0, &mut |t| 0.5 * tone(440.0, t));
    assert_eq!(short.sections.len(), 1);
    let bad = of(5.0, &mut |t| if t < 2.0 { f64::NAN } else { f64::INFINITY });
    assert!(bad.silent);
}

/// By EBU Tech 3341, a sine of 1 kHz at -23 dBFS in both channels has -23 LUFS, and gating excludes quiet parts.
#[test]
fn loudness_follows_ebu_r128() {
    let rate = 48_000;
    let sines = |parts: &[(f64, f64)]| {
        let mut frames: Vec<StereoFrame> = Vec::new();
        for (seconds, level) in parts {
            let amplitude = 10_f64.powf(level / 20.0);
            frames.extend((0..(seconds * f64::from(rate)) as usize).map(|n| {
                [(amplitude * (std::f64::consts::TAU * 1000.0 * n as f64 / f64::from(rate)).sin()) as f32; 2]
            }));
        }
        structure(rate, &frames).loudness
    };
    let is = |found: Option<f32>, truly: f32| found.is_some_and(|found| (found - truly).abs() < 0.1);
    for (parts, truly) in [
        (&[(20.0, -23.0)][..], -23.0),
        (&[(20.0, -33.0)], -33.0),
        (&[(10.0, -36.0), (60.0, -23.0), (10.0, -36.0)], -23.0),
        (&[(10.0, -72.0), (10.0, -36.0), (60.0, -23.0), (10.0, -36.0), (10.0, -72.0)], -23.0),
    ] {
        let found = sines(parts);
        assert!(is(found, truly), "{parts:?}: {found:?}");
    }
    assert_eq!(sines(&[(0.3, -23.0)]), None, "shorter than a block");
    assert_eq!(sines(&[(5.0, -90.0)]), None, "below the gate");
    let bad = vec![[f32::NAN, f32::INFINITY]; 96_000];
    assert_eq!(structure(rate, &bad).loudness, None);
}
