use super::*;
use crate::resolve::testing::song;
use crate::scene_card::Rise;
use crate::timeline::TimedTransition;
use crate::{parse, print, resolve};
use mariana_field::lang::About;
use mariana_music::{Mode, Section, SectionSound, SongBeat, Tonality};
use proptest::prelude::*;

fn card(scene: &str, energy: (f32, f32), moods: &str, cameras: &[&str]) -> SceneCard {
    let moods = moods.split(' ').map(str::to_owned).collect();
    SceneCard {
        scene: scene.to_owned(),
        about: About { energy, moods, ..About::default() },
        cameras: cameras.iter().map(|name| (*name).to_owned()).collect(),
        params: Vec::new(),
        rise: None,
    }
}

fn cards() -> Vec<SceneCard> {
    vec![
        card("lake", (0.0, 0.3), "calm wet", &[]),
        card("wood", (0.1, 0.4), "calm dry", &[]),
        card("street", (0.35, 0.6), "busy", &["above"]),
        card("fire", (0.7, 1.0), "hot", &["near", "far"]),
        card("storm", (0.8, 1.0), "wet", &[]),
    ]
}

#[test]
fn a_show_follows_the_song() {
    let cue_list = direct(&song(), &cards(), &[], 7);
    let text = print(&cue_list, &[]);
    let (timeline, left_out) = resolve(&cue_list, &song(), &[], |_, _| None);
    let timeline = timeline.unwrap();
    assert!(left_out.is_empty(), "{text}");
    let on = |time: f64| timeline.at(time).clip.scene.as_str();
    // The song is calm, then medium, and loud from the drop on. The repeated calm section gets its scene again.
    assert!(["lake", "wood"].contains(&on(1.0)), "{text}");
    assert_eq!(on(20.0), "street", "{text}");
    assert!(["fire", "storm"].contains(&on(33.0)), "{text}");
    assert_eq!(on(1.0), on(60.0), "{text}");
    let transition = |time: f64| timeline.at(time).clip;
    assert_eq!(
        (transition(33.0).start, transition(33.0).transition.kind.style()),
        (32.5, TransitionStyle::Cut),
        "{text}"
    );
    // Only the drop gets a cut, and the camera springs back.
    let cuts: Vec<&str> = text.lines().filter(|line| line.ends_with(" cut")).collect();
    assert!(cuts.len() == 1 && cuts[0].starts_with("at drop 1 "), "{text}");
    assert_eq!(text.matches("set camera zoom = 0.85 -> 1 over 1 bar\n").count(), 1, "{text}");
    // Scenes do not change during the build.
    assert!(timeline.clips().iter().all(|clip| clip.start < 24.5 || clip.start >= 32.5), "{text}");
    // A blend is half complete when the section starts.
    let flowing = timeline.clips().iter().filter(|clip| {
        matches!(clip.transition.kind.style(), TransitionStyle::Melt | TransitionStyle::Portal)
    });
    for clip in flowing.filter(|clip| clip.start > 0.0) {
        let middle = clip.start + 0.5 * clip.transition.seconds;
        assert!([16.5, 32.5, 48.5].iter().any(|border| (middle - border).abs() < 1e-6), "{text}");
    }
}

/// Returns a song at 120 beats a minute with a section of `bars` bars for each of these energies and sounds.
fn song_of(bars: usize, sections: &[(f32, SectionSound)]) -> SongStructure {
    let mut song = song();
    let beat = |index: usize| SongBeat {
        time: 0.5 + 0.5 * index as f64,
        of_bar: (index % 4) as u8 + 1,
        tempo: 120.0,
    };
    song.beats = (0..4 * bars * sections.len()).map(beat).collect();
    song.seconds = 0.5 + 2.0 * (bars * sections.len()) as f64;
    let border = |index: usize| if index == 0 { 0.0 } else { 0.5 + 2.0 * (bars * index) as f64 };
    song.sections = sections
        .iter()
        .zip(0u8..)
        .map(|((energy, _), index)| Section {
            start: border(usize::from(index)),
            end: border(usize::from(index) + 1),
            letter: char::from(b'A' + index).to_string(),
            energy: *energy,
        })
        .collect();
    song.sounds = sections.iter().map(|(_, sound)| *sound).collect();
    (song.builds, song.drops) = (Vec::new(), Vec::new());
    song
}

const SPARSE: SectionSound = SectionSound { onsets: 0.8, brightness: 0.3, percussive: 0.02 };
const DENSE: SectionSound = SectionSound { onsets: 6.0, brightness: 0.35, percussive: 0.08 };

#[test]
fn each_camera_is_shown_once_before_the_scene_changes() {
    let cards = vec![
        card("fire", (0.0, 1.0), "hot", &["near", "far"]),
        card("lake", (0.0, 1.0), "wet", &["near", "far"]),
    ];
    let song = song_of(90, &[(0.5, SectionSound::default())]);
    let cue_list = direct(&song, &cards, &[], 1);
    let timeline = resolve(&cue_list, &song, &[], |_, _| None).0.unwrap();
    let seen: Vec<_> = timeline.clips().iter().map(|clip| (&*clip.scene, clip.camera.as_deref())).collect();
    let of = |scene| [(scene, None), (scene, Some("near")), (scene, Some("far"))];
    let (first, second) = if seen[0].0 == "fire" { ("fire", "lake") } else { ("lake", "fire") };
    let wanted = [of(first), of(second)].concat();
    assert!(seen.len() >= 5 && wanted.starts_with(&seen), "{}", print(&cue_list, &[]));
    let fades = timeline.clips().iter().filter(|clip| clip.camera.is_some());
    assert!(
        fades.into_iter().all(|clip| clip.transition == TimedTransition::new(TransitionStyle::Fade, 4.0))
    );
}

#[test]
fn moods_follow_density_tempo_and_mode() {
    let cards = [
        card("race", (0.0, 1.0), "drive", &[]),
        card("garden", (0.0, 1.0), "calm", &[]),
        card("meadow", (0.0, 1.0), "day", &[]),
        card("crypt", (0.0, 1.0), "night", &[]),
    ];
    let only = |names: [&str; 2]| -> Vec<SceneCard> {
        cards.iter().filter(|card| names.contains(&card.scene.as_str())).cloned().collect()
    };
    for seed in 0..20 {
        let first =
            |song: &SongStructure, names| direct(song, &only(names), &[], seed).entries[0].scene.clone();
        let sparse = song_of(8, &[(0.5, SPARSE)]);
        let mut dense = song_of(8, &[(0.5, DENSE)]);
        assert_eq!(first(&sparse, ["race", "garden"]), "garden");
        assert_eq!(first(&dense, ["race", "garden"]), "race");
        for (mode, scene) in [(Mode::Major, "meadow"), (Mode::Minor, "crypt")] {
            dense.key = Some(Tonality { root: 0, mode });
            assert_eq!(first(&dense, ["meadow", "crypt"]), scene);
        }
    }
}

#[test]
fn a_calm_song_without_contrast_holds_its_scenes_longer() {
    let cards: Vec<SceneCard> = (0..9).map(|n| card(&format!("scene{n}"), (0.0, 1.0), "any", &[])).collect();
    let changes = |song: &SongStructure| direct(song, &cards, &[], 1).entries.len() - 1;
    let minutes = |song: &SongStructure| song.seconds / 60.0;
    let even = song_of(120, &[(0.9, SPARSE)]);
    let uneven = song_of(30, &[(0.5, SPARSE), (0.95, DENSE), (0.5, SPARSE), (0.95, DENSE)]);
    let lively = changes(&uneven) as f64 / minutes(&uneven);
    let calm = changes(&even) as f64 / minutes(&even);
    assert!(calm >= 1.0 && lively >= 1.2 * calm && lively <= 4.0, "{calm} {lively}");
}

#[test]
fn a_parameter_rises_during_a_build_and_falls_back() {
    let rise = Rise { param: "swell".to_owned(), from: 0.5, to: 1.3 };
    let mut cards: Vec<SceneCard> =
        ["one", "two", "three"].map(|scene| card(scene, (0.0, 1.0), "any", &[])).to_vec();
    let moved = |cards: &[SceneCard], time: f64| {
        let timeline = resolve(&direct(&song(), cards, &[], 3), &song(), &[], |_, _| None).0.unwrap();
        let clip = timeline.clips().iter().rfind(|clip| clip.start < 32.4).unwrap();
        let param = &clip.moves.first()?.param;
        Some((param.clone(), clip.moved(param, time)?.value))
    };
    // Without such a parameter, the camera comes nearer.
    let zoom = |value: f32| Some(("camera zoom".to_owned(), value));
    assert_eq!(
        [24.4, 28.5, 32.5, 34.5].map(|time| moved(&cards, time)),
        [zoom(1.0), zoom(0.925), zoom(0.85), zoom(1.0)]
    );
    cards.iter_mut().for_each(|card| card.rise = Some(rise.clone()));
    let swell = |value: f32| Some(("swell".to_owned(), value));
    let wanted = [swell(0.5), swell(0.9), swell(1.3), swell(0.5)];
    assert_eq!([24.4, 28.5, 32.5, 34.5].map(|time| moved(&cards, time)), wanted);
}

#[test]
fn lessons_and_signs_are_shown_only_if_there_are_no_others() {
    let lesson = || card("first", (0.0, 1.0), "lesson", &[]);
    let sign = || card("name", (0.0, 1.0), "night, sign", &[]);
    let names =
        |cards: Vec<SceneCard>| for_shows(cards).into_iter().map(|card| card.scene).collect::<Vec<_>>();
    assert_eq!(names(vec![lesson(), sign(), card("one", (0.9, 1.0), "any", &[])]), ["one"]);
    assert_eq!(names(vec![lesson(), sign()]), ["first", "name"]);
}

#[test]
fn another_seed_makes_another_show_and_the_same_seed_the_same() {
    let cards: Vec<SceneCard> = (0..9).map(|n| card(&format!("scene{n}"), (0.0, 1.0), "any", &[])).collect();
    let show = |seed| print(&direct(&song(), &cards, &[], seed), &[]);
    assert_eq!(show(3), show(3));
    assert!((0..9).any(|seed| show(seed) != show(3)));
}

#[test]
fn the_songs_of_an_album_do_not_show_the_same_scenes_again_and_again() {
    let cards: Vec<SceneCard> = (0..12).map(|n| card(&format!("scene{n}"), (0.0, 1.0), "any", &[])).collect();
    let mut recent: Vec<String> = Vec::new();
    for seed in 0..12 {
        let last: Vec<String> = recent.clone();
        let show = direct(&song(), &cards, &recent, seed);
        let shown: Vec<&String> = show.entries.iter().map(|entry| &entry.scene).collect();
        let count = shown.iter().collect::<std::collections::BTreeSet<_>>().len();
        // While enough other scenes are left, no scene of the previous song returns.
        let previous = last.iter().rev().take(cards.len() - count);
        assert!(previous.clone().all(|scene| !shown.contains(&scene)), "{shown:?} after {last:?}");
        recent.extend(shown.into_iter().cloned());
        recent.dedup();
    }
}

#[test]
fn a_song_without_structure_has_a_show_of_one_scene() {
    let cue_list = direct(&SongStructure::default(), &cards(), &[], 5);
    assert_eq!(cue_list.entries.len(), 1);
    assert!(direct(&song(), &[], &[], 5).entries.is_empty());
}

proptest! {
    /// For any song, the timeline has every entry, scenes have a minimum time, and parsing the printed text gives the
    /// same timeline.
    #[test]
    fn a_show_holds_for_any_song(
        lengths in proptest::collection::vec((1usize..40, 0.0f32..=1.0, 0u8..4), 1..8), seed: u64, drop in 0usize..8,
        build in 1usize..12, bar in 0.8f64..6.0, sounds in proptest::collection::vec((0.0f32..12.0, 0.0f32..1.0, 0.0f32..1.0), 0..8),
    ) {
        let bars: usize = lengths.iter().map(|(bars, ..)| bars).sum();
        let mut song = song();
        song.beats = (0..4 * bars).map(|index| SongBeat {
            time: 0.5 + 0.25 * bar * index as f64, of_bar: (index % 4) as u8 + 1, tempo: 150.0,
        }).collect();
        song.seconds = 0.5 + bar * bars as f64;
        let mut start = 0;
        song.sections = lengths.iter().map(|(bars, energy, letter)| {
            let section = Section {
                start: if start == 0 { 0.0 } else { 0.5 + bar * start as f64 },
                end: 0.5 + bar * (start + bars) as f64,
                letter: char::from(b'A' + letter).to_string(),
                energy: *energy,
            };
            start += bars;
            section
        }).collect();
        song.sounds = sounds.iter().map(|(onsets, brightness, percussive)| SectionSound {
            onsets: *onsets, brightness: *brightness, percussive: *percussive,
        }).collect();
        song.drops = song.sections.get(drop).map(|section| section.start).into_iter().filter(|time| *time > 0.0).collect();
        song.builds = song.drops.iter().map(|drop| mariana_music::Stretch {
            start: (drop - bar * build as f64).max(0.0), end: *drop,
        }).collect();
        let cue_list = direct(&song, &cards(), &[], seed);
        let text = print(&cue_list, &[]);
        let (timeline, left_out) = resolve(&cue_list, &song, &[], |_, _| None);
        let timeline = timeline.unwrap();
        prop_assert!(left_out.is_empty(), "{}\n{:?}", text, left_out);
        prop_assert_eq!(timeline.clips().len(), cue_list.entries.len());
        let mut scenes: Vec<(f64, &str)> = timeline.clips().iter().map(|clip| (clip.start, clip.scene.as_str())).collect();
        scenes.dedup_by_key(|(_, scene)| *scene);
        for pair in scenes.windows(2) {
            let is_drop = song.drops.iter().any(|drop| (pair[1].0 - drop).abs() < 1e-6 || (pair[0].0 - drop).abs() < 1e-6);
            prop_assert!(is_drop || pair[1].0 - pair[0].0 > 3.0, "{}", text);
        }
        // At most four changes in a minute are at no border of a section and at no drop.
        let reasons: Vec<f64> = song.sections.iter().map(|section| section.start).chain(song.drops.iter().copied()).collect();
        let has_reason = |clip: &&crate::Clip| {
            let middle = clip.start + 0.5 * clip.transition.seconds;
            reasons.iter().any(|reason| (clip.start - reason).abs() < 1e-6 || (middle - reason).abs() < 1e-6)
        };
        let free: Vec<f64> = timeline.clips().iter().filter(|clip| !has_reason(clip)).map(|clip| clip.start).collect();
        for from in &free {
            let within = free.iter().filter(|start| (*from..from + 60.0).contains(*start)).count();
            prop_assert!(within <= 4, "{within} changes from {from} s on\n{text}");
        }
        // Only drops get cuts.
        for clip in timeline.clips().iter().skip(1).filter(|clip| clip.transition.kind == TransitionKind::Cut) {
            prop_assert!(song.drops.iter().any(|drop| (clip.start - drop).abs() < 1e-6), "{}", text);
        }
        let again = parse("test.show", &text).cue_list.unwrap();
        prop_assert_eq!(resolve(&again, &song, &[], |_, _| None).0, Some(timeline), "{}", text);
    }
}
