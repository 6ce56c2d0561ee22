//! Measures the director on real songs: `cargo run --release -p mariana-show --example director_figures -- SCENES SONGS
//! WORDS` prints a table. `SCENES` is a folder of scenes, such as `assets/scenes`. `SONGS` is a folder of files
//! `NAME.json`, which `mariana analyze SONG --structure --json` prints. `WORDS` is a file with a line `SET NAME
//! WORD...` for each song; the words are those of [`WORDS`], and should be chosen before seeing the show.
//!
//! The column `a minute` counts the changes of scene and camera; `close` is the largest number of changes in a minute
//! that are at no border of a section and at no drop. `moods` is the fraction of the moods that fit the words, of those
//! that fit the words or are against them, weighted by the time. `scenes` is the fraction of the time in which the
//! scene fits: at least one mood fits a word, and no mood is against a word. The songs of a set play one after the
//! other, as in a playlist.

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::path::Path;

use mariana_field::lang::{compile, no_includes};
use mariana_music::SongStructure;
use mariana_show::{SceneCard, Show};

/// A word for a song, the moods that fit it, and the moods that are against it.
struct Word(&'static str, &'static [&'static str], &'static [&'static str]);

const WORDS: [Word; 6] = [
    Word("calm", &["calm", "soft", "mist", "love", "space"], &["drive", "flight", "wild", "play"]),
    Word("dark", &["night", "cold", "cave", "space"], &["day", "play", "love"]),
    Word("driving", &["drive", "flight", "wild"], &["calm", "soft"]),
    Word("bright", &["day", "play", "warm"], &["night", "cold", "cave"]),
    Word("playful", &["play", "warm", "day"], &["night", "cold", "cave"]),
    Word("warm", &["warm", "soft", "love", "wood"], &["cold"]),
];

/// A change this close to a border or a drop is there because of it, in seconds. Blends begin before a border.
const NEAR: f64 = 8.1;

/// Returns how many moods fit the words, and how many are against them.
fn counts(moods: &[String], words: &[&str]) -> [f64; 2] {
    let of_song = || WORDS.iter().filter(|word| words.contains(&word.0));
    let has = |list: &[&str], mood: &String| list.contains(&mood.as_str());
    let fitting = moods.iter().filter(|mood| of_song().any(|word| has(word.1, mood)));
    let against = moods.iter().filter(|mood| of_song().any(|word| has(word.2, mood)));
    [fitting.count() as f64, against.count() as f64]
}

fn scenes_in(folder: &Path) -> Result<BTreeMap<String, SceneCard>, Box<dyn Error>> {
    let mut scenes = BTreeMap::new();
    for file in std::fs::read_dir(folder)? {
        let path = file?.path();
        let Some(name) = path.file_stem().and_then(|name| name.to_str()) else { continue };
        if path.extension().is_some_and(|extension| extension == "scene") {
            let compiled = compile(name, &std::fs::read_to_string(&path)?, &mut no_includes);
            let scene = compiled.scene.ok_or_else(|| format!("the scene {name} has mistakes"))?;
            scenes.insert(name.to_owned(), SceneCard::of(name, scene));
        }
    }
    Ok(scenes)
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scenes, songs, words] = &arguments[..] else { return Err("give SCENES SONGS WORDS".into()) };
    let scenes = scenes_in(Path::new(scenes))?;
    let mut sums: BTreeMap<String, [f64; 5]> = BTreeMap::new();
    let mut seen: BTreeMap<String, Vec<String>> = BTreeMap::new();
    println!("a minute  close  moods  scenes  song");
    for line in std::fs::read_to_string(words)?.lines() {
        let mut parts = line.split_whitespace();
        let (Some(set), Some(name)) = (parts.next(), parts.next()) else { continue };
        let words: Vec<&str> = parts.collect();
        let text = std::fs::read_to_string(Path::new(songs).join(format!("{name}.json")))?;
        let song: SongStructure = serde_json::from_str(&text)?;
        let recent = seen.entry(set.to_owned()).or_default();
        let cards = scenes.values().cloned().collect();
        let show = Show::directed(&song, cards, recent).ok_or("there is no scene")?;
        let clips = show.clips();
        recent.extend(clips.iter().map(|clip| clip.scene.clone()));
        recent.dedup();
        let reasons: Vec<f64> =
            song.sections.iter().map(|section| section.start).chain(song.drops.iter().copied()).collect();
        let has_reason =
            |start: f64| reasons.iter().any(|reason| (start - 0.1..start + NEAR).contains(reason));
        let free: Vec<f64> =
            clips.iter().skip(1).map(|clip| clip.start).filter(|start| !has_reason(*start)).collect();
        let within = |from: &f64| free.iter().filter(|start| (*from..from + 60.0).contains(*start)).count();
        let close = free.iter().map(within).max().unwrap_or(0);
        let mut seconds_of: BTreeMap<&str, f64> = BTreeMap::new();
        for (index, clip) in clips.iter().enumerate() {
            let end = clips.get(index + 1).map_or(song.seconds, |next| next.start);
            *seconds_of.entry(clip.scene.as_str()).or_default() += end - clip.start.max(0.0);
        }
        let (mut fitting, mut against, mut fitted) = (0.0, 0.0, 0.0);
        for (scene, seconds) in &seconds_of {
            let moods = scenes.get(*scene).map_or(&[][..], |card| &card.about.moods);
            let [fit, not] = counts(moods, &words);
            fitting += seconds * fit;
            against += seconds * not;
            fitted += if fit > 0.0 && not == 0.0 { *seconds } else { 0.0 };
        }
        let rate = 60.0 * (clips.len() - 1) as f64 / song.seconds;
        let (fitting, fitted) = (fitting / (fitting + against).max(1.0), fitted / song.seconds);
        let shown: Vec<String> =
            seconds_of.iter().map(|(scene, seconds)| format!("{scene} {seconds:.0}")).collect();
        println!(
            "{rate:8.1} {close:6} {fitting:6.2} {fitted:7.2}  {set} {name}: {}; {}",
            words.join(" "),
            shown.join(", ")
        );
        let sum = sums.entry(set.to_owned()).or_default();
        let is_usual = if (1.0..=4.0).contains(&rate) { 1.0 } else { 0.0 };
        sum.iter_mut().zip([1.0, rate, fitting, fitted, is_usual]).for_each(|(sum, value)| *sum += value);
    }
    for (set, [count, rate, fitting, fitted, usual]) in sums {
        let shown = seen.get(&set).map_or(0, |seen| seen.iter().collect::<BTreeSet<_>>().len());
        println!(
            "== {set}: {count} songs with {shown} scenes; mean changes a minute {:.2}, {usual} songs between 1 and 4; mean fit of \
             moods {:.2}, of scenes {:.2}",
            rate / count,
            fitting / count,
            fitted / count
        );
    }
    Ok(())
}
