//! Measures the analysis of generated songs: `cargo run --release -p mariana-music --example song_figures` prints a
//! table of all styles, tempos, forms and keys. (The tests check a few of these songs.)

#[allow(dead_code)]
#[path = "../tests/music/events.rs"]
mod events;
#[path = "../tests/music/forms.rs"]
mod forms;
#[allow(dead_code)]
#[path = "../tests/music/songs.rs"]
mod songs;

use forms::{Form, club_song};
use mariana_music::{Mode, SongStructure, Tonality};
use songs::{
    Part, Song, Style, Swell, Truth, Voice, bars_heard, beats_heard, borders, breaks, chords, club,
    f_measure, false_returns, labels, pop, structure,
};

const RATE: u32 = 48_000;

fn heard(song: &Song) -> (SongStructure, Truth) {
    let (frames, truth) = song.play(RATE);
    (structure(RATE, &frames), truth)
}

fn major(root: u8) -> Tonality {
    Tonality { root, mode: Mode::Major }
}

fn rhythm_row(name: &str, song: &Song, sums: &mut Vec<[f64; 4]>) {
    let (found, truth) = heard(song);
    let beats: Vec<f64> = found.beats.iter().map(|beat| beat.time).collect();
    let downbeats: Vec<f64> = found.downbeats().collect();
    let row = [
        f_measure(&beats, &truth.beats, 0.07),
        f_measure(&downbeats, &truth.downbeats, 0.07),
        f_measure(&borders(&found), &truth.borders, 0.5),
        labels(&found, &truth),
    ];
    let [b, d, s, l] = row;
    let letters: Vec<&str> = found.sections.iter().map(|section| section.letter.as_str()).collect();
    println!(
        "{name:32} beats {b:.2} downbeats {d:.2} borders {s:.2} labels {l:.2}  {:6.1} bpm {:?} {} drops {:?}",
        found.tempo.unwrap_or(0.0),
        found.meter,
        letters.join(" "),
        found.drops,
    );
    sums.push(row);
}

fn means(name: &str, rows: &[[f64; 4]]) {
    let mean = |column: usize| rows.iter().map(|row| row[column]).sum::<f64>() / rows.len().max(1) as f64;
    println!(
        "== {name}: mean F of {} songs: beats {:.3}, downbeats {:.3}, borders {:.3}, labels {:.3}",
        rows.len(),
        mean(0),
        mean(1),
        mean(2),
        mean(3)
    );
}

fn live_bars() {
    let (mut all, mut songs) = ([0.0; 2], 0);
    for style in Style::ALL {
        let (mut sums, mut count) = ([0.0; 2], 0);
        for tempo in [72.0, 83.0, 96.0, 104.0, 118.0, 128.0, 140.0, 160.0] {
            if matches!(style, Style::SixEight | Style::HalfTime) && tempo > 120.0 {
                continue;
            }
            for mode in [Mode::Major, Mode::Minor] {
                let key = Tonality { root: count as u8 % 12, mode };
                let (frames, truth) = Song::new(style, tempo, key, pop(mode)).play(RATE);
                let mut beats = beats_heard(RATE, &frames);
                beats.retain(|(time, _)| *time > 10.0);
                let [reported, right] = bars_heard(&beats, &truth);
                // Weight each song by the fraction of beats with a known bar position.
                sums = [sums[0] + reported, sums[1] + reported * right];
                count += 1;
            }
        }
        let (reported, right) = (sums[0] / f64::from(count), sums[1] / sums[0].max(1e-9));
        println!(
            "{style:?}: {count} songs, a bar is reported for {reported:.2} of the beats, and right for {right:.2} of those"
        );
        all.iter_mut().zip(sums).for_each(|(all, sum)| *all += sum);
        songs += count;
    }
    let (reported, right) = (all[0] / f64::from(songs), all[1] / all[0].max(1e-9));
    println!(
        "== live bars: {songs} songs, bars known at {reported:.2} of the beats after 10 s, {right:.2} of those bars right"
    );
}

fn drops() {
    for (name, form) in [("clubs", club(Mode::Minor)), ("breaks", breaks(Mode::Minor))] {
        let (mut hits, mut all, mut false_ones) = (0, 0, 0);
        for style in [Style::FourOnTheFloor, Style::Syncopated, Style::Rock, Style::HalfTime] {
            for (number, tempo) in [100.0, 110.0, 124.0, 128.0, 140.0, 150.0, 174.0].into_iter().enumerate() {
                let key = Tonality { root: number as u8 % 6 * 2, mode: Mode::Minor };
                let song = Song::new(style, tempo, key, form.clone());
                let (found, truth) = heard(&song);
                let is_hit = |drop: &&f64| found.drops.iter().any(|f| (f - **drop).abs() < 0.5);
                let hit = truth.drops.iter().filter(is_hit).count();
                (hits, all) = (hits + hit, all + truth.drops.len());
                false_ones += found.drops.len() - hit;
                if hit < truth.drops.len() {
                    println!("{name}, {style:?} {tempo}: drops {:?} for {:?}", found.drops, truth.drops);
                }
            }
        }
        println!("== drops in {name}: {hits} of {all}, {false_ones} false");
    }
    let mut sums = [0; 3];
    for number in 0..15 {
        let style = [Style::FourOnTheFloor, Style::HalfTime, Style::Syncopated, Style::Rock][number % 4];
        let form = [Form::Aaba, Form::VerseChorus, Form::Rondo, Form::Twice, Form::Through][number % 5];
        for song in [club_song(style, 201 + number as u32), form.song(style, 241 + number as u32)] {
            let (found, truth) = heard(&song);
            let is_hit = |drop: &&f64| found.drops.iter().any(|f| (f - **drop).abs() < 0.5);
            let hits = truth.drops.iter().filter(is_hit).count();
            sums = [sums[0] + hits, sums[1] + truth.drops.len(), sums[2] + found.drops.len() - hits];
        }
    }
    println!(
        "== drops in 15 other clubs and 15 songs without drops: {} of {}, {} false",
        sums[0], sums[1], sums[2]
    );
    for swell in Swell::ALL {
        let (mut songs, mut drops) = (0, 0);
        for tempo in [60.0, 70.0, 80.0, 92.0] {
            for style in [Style::Ballad, Style::SixEight, Style::Rock] {
                let song = Song::new(style, tempo, major(7), swell.ballad(Mode::Major));
                (songs, drops) = (songs + 1, drops + heard(&song).0.drops.len());
            }
        }
        println!("== drops in {songs} ballads, {swell:?}: {drops}");
    }
}

fn rhythm() {
    let mut rows = Vec::new();
    for (number, style) in Style::ALL.into_iter().enumerate() {
        for tempo in [60.0, 83.0, 104.0, 128.0, 160.0, 200.0] {
            // Above 120 beats per minute, listeners would count the beats of these styles differently.
            if matches!(style, Style::SixEight | Style::HalfTime) && tempo > 120.0 {
                continue;
            }
            let mut song = Song::new(style, tempo, major(number as u8), pop(Mode::Major));
            song.seed = tempo as u32;
            rhythm_row(&format!("{style:?} {tempo}"), &song, &mut rows);
        }
    }
    for style in [Style::Rock, Style::FourOnTheFloor, Style::Jazz] {
        for (swing, tempo) in
            [(0.667, (90.0, 90.0)), (0.6, (140.0, 140.0)), (0.5, (90.0, 130.0)), (0.5, (150.0, 110.0))]
        {
            let song = Song { swing, tempo, ..Song::new(style, 100.0, major(5), pop(Mode::Major)) };
            rhythm_row(&format!("{style:?} {tempo:?} swing {swing}"), &song, &mut rows);
        }
    }
    means("rhythm", &rows);
}

fn alone() {
    for alone in ["timbre", "harmony"] {
        let mut rows = Vec::new();
        for tempo in [90.0, 120.0, 140.0] {
            for mode in [Mode::Major, Mode::Minor] {
                let part = |letter: char, bars, number| Part {
                    letter,
                    bars,
                    chords: chords(mode, if alone == "harmony" { number } else { 0 }),
                    drums: true,
                    bass: true,
                    voice: [Voice::Organ, Voice::Bright, Voice::Soft]
                        [if alone == "timbre" { number } else { 0 }],
                    arpeggio: true,
                    loud: 0.8,
                    ..Part::default()
                };
                let form = vec![
                    part('A', 8, 0),
                    part('B', 8, 1),
                    part('A', 8, 0),
                    part('B', 8, 1),
                    part('C', 8, 2),
                    part('B', 16, 1),
                ];
                let song = Song::new(Style::Rock, tempo, Tonality { root: 2, mode }, form);
                rhythm_row(&format!("{alone} alone {tempo} {mode:?}"), &song, &mut rows);
            }
        }
        means(alone, &rows);
    }
}

/// Songs of each form. The constants of the analysis were chosen with the first four styles and seeds.
fn forms() {
    let tuned = [Style::Rock, Style::FourOnTheFloor, Style::Ballad, Style::Waltz];
    let others = [Style::Syncopated, Style::HalfTime, Style::Jazz, Style::SixEight];
    for (name, styles, first) in [("tuned", tuned, 1), ("others", others, 101)] {
        for form in Form::ALL {
            let mut sums = [0.0; 2];
            let (mut sections, mut letters, mut wrong) = (0, 0, 0);
            for (number, style) in (first..).zip(styles) {
                let (found, truth) = heard(&form.song(style, number));
                sums[0] += f_measure(&borders(&found), &truth.changes(), 0.5);
                sums[1] += labels(&found, &truth);
                sections += found.sections.len();
                let mut all: Vec<&str> = found.sections.iter().map(|s| s.letter.as_str()).collect();
                all.sort_unstable();
                all.dedup();
                letters += all.len();
                wrong += false_returns(&found, &truth);
            }
            let [borders, labels] = sums.map(|sum| sum / styles.len() as f64);
            println!(
                "== {name}, {form:?}: borders {borders:.3}, labels {labels:.3}, {letters} letters of {sections} sections, {wrong} false returns"
            );
        }
    }
}

fn keys() {
    let mut right = 0;
    for mode in [Mode::Major, Mode::Minor] {
        for root in 0..12 {
            let key = Tonality { root, mode };
            let mut song = Song::new(Style::Rock, 112.0, key, pop(mode));
            song.cents = f64::from(root) * 6.0 - 30.0;
            let (found, _) = heard(&song);
            let hit = found.key == Some(key);
            right += u32::from(hit);
            if !hit {
                println!("{key:?} was detected as {:?}, tuned to {:.1}", found.key, found.tuning_hz);
            }
        }
    }
    println!("== keys: {right} of 24");
}

fn main() {
    let which = std::env::args().nth(1).unwrap_or_default();
    let figures: [(&str, fn()); 6] = [
        ("rhythm", rhythm),
        ("alone", alone),
        ("forms", forms),
        ("drops", drops),
        ("live", live_bars),
        ("keys", keys),
    ];
    for (name, print) in figures {
        if which.is_empty() || which == name {
            print();
        }
    }
}
