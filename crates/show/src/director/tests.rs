use super::*;
use crate::resolve::testing::song;
use crate::timeline::TimedTransition;
use crate::{parse, print, resolve};
use proptest::prelude::*;

fn card(scene: &str, energy: (f32, f32), moods: &str, cameras: &[&str]) -> SceneCard {
    let moods = moods.split(' ').map(str::to_owned).collect();
    SceneCard {
        scene: scene.to_owned(),
        about: About { energy, moods, ..About::default() },
        cameras: cameras.iter().map(|name| (*name).to_owned()).collect(),
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
    let cue_list = direct(&song(), &cards(), 7);
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

#[test]
fn loud_music_is_cut_between_cameras() {
    let cards = vec![
        card("fire", (0.7, 1.0), "hot", &["near", "far"]),
        card("lake", (0.0, 0.3), "calm", &["near"]),
        card("street", (0.4, 0.6), "busy", &[]),
    ];
    let timeline = resolve(&direct(&song(), &cards, 1), &song(), &[], |_, _| None).0.unwrap();
    let of = |range: std::ops::Range<f64>| {
        let mut cameras: Vec<_> = timeline
            .clips()
            .iter()
            .filter(|clip| range.contains(&clip.start))
            .map(|clip| clip.camera.clone())
            .collect();
        cameras.sort();
        cameras.dedup();
        cameras.len()
    };
    assert_eq!(of(32.0..48.0), 3);
    assert_eq!(of(0.0..14.0), 1);
}

#[test]
fn calm_music_fades_from_camera_to_camera() {
    let cards = vec![
        card("fire", (0.7, 1.0), "hot", &["near", "far"]),
        card("lake", (0.0, 0.3), "calm", &["near", "far"]),
    ];
    let mut song = song();
    let [calm, .., loud] = &mut song.sections[..] else { panic!() };
    (calm.end, loud.start, loud.energy) = (40.5, 40.5, 0.9);
    song.sections = vec![calm.clone(), loud.clone()];
    (song.builds, song.drops) = (Vec::new(), Vec::new());
    let cue_list = direct(&song, &cards, 1);
    let timeline = resolve(&cue_list, &song, &[], |_, _| None).0.unwrap();
    let calm: Vec<_> = timeline.clips().iter().filter(|clip| clip.scene == "lake").collect();
    let starts: Vec<f64> = calm.iter().map(|clip| clip.start).collect();
    assert_eq!(starts, [0.0, 10.5, 22.5], "{}", print(&cue_list, &[]));
    assert!(
        calm[1..].iter().all(|clip| clip.transition == TimedTransition::new(TransitionStyle::Fade, 4.0)),
        "{calm:?}"
    );
    assert!(calm[0].camera != calm[1].camera && calm[1].camera != calm[2].camera, "{calm:?}");
}

#[test]
fn another_seed_makes_another_show_and_the_same_seed_the_same() {
    let cards: Vec<SceneCard> = (0..9).map(|n| card(&format!("scene{n}"), (0.0, 1.0), "any", &[])).collect();
    let show = |seed| print(&direct(&song(), &cards, seed), &[]);
    assert_eq!(show(3), show(3));
    assert!((0..9).any(|seed| show(seed) != show(3)));
}

#[test]
fn a_song_without_structure_has_a_show_of_one_scene() {
    let cue_list = direct(&SongStructure::default(), &cards(), 5);
    assert_eq!(cue_list.entries.len(), 1);
    assert!(direct(&song(), &[], 5).entries.is_empty());
}

proptest! {
    /// For any song, the timeline has every entry, scenes have a minimum time, and parsing the printed text gives the
    /// same timeline.
    #[test]
    fn a_show_holds_for_any_song(
        lengths in proptest::collection::vec((1usize..40, 0.0f32..=1.0, 0u8..4), 1..8), seed: u64, drop in 0usize..8,
        build in 1usize..12,
    ) {
        let bars: usize = lengths.iter().map(|(bars, ..)| bars).sum();
        let mut song = song();
        song.beats = (0..4 * bars).map(|index| mariana_music::SongBeat {
            time: 0.5 + 0.4 * index as f64, of_bar: (index % 4) as u8 + 1, tempo: 150.0,
        }).collect();
        song.seconds = 0.5 + 1.6 * bars as f64;
        let mut start = 0;
        song.sections = lengths.iter().map(|(bars, energy, letter)| {
            let section = mariana_music::Section {
                start: if start == 0 { 0.0 } else { 0.5 + 1.6 * start as f64 },
                end: 0.5 + 1.6 * (start + bars) as f64,
                letter: char::from(b'A' + letter).to_string(),
                energy: *energy,
            };
            start += bars;
            section
        }).collect();
        song.drops = song.sections.get(drop).map(|section| section.start).into_iter().filter(|time| *time > 0.0).collect();
        song.builds = song.drops.iter().map(|drop| mariana_music::Stretch {
            start: (drop - 1.6 * build as f64).max(0.0), end: *drop,
        }).collect();
        let cue_list = direct(&song, &cards(), seed);
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
        let again = parse("test.show", &text).cue_list.unwrap();
        prop_assert_eq!(resolve(&again, &song, &[], |_, _| None).0, Some(timeline), "{}", text);
    }
}
