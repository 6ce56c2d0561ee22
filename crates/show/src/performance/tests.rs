use proptest::prelude::*;

use super::*;
use crate::{parse, print, resolve};
use mariana_field::lang::TransitionStyle;
use mariana_music::SongStructure;

/// A frame: seconds since the previous frame, a possible scene change, and the values of a parameter, the camera's
/// yaw and the brightness.
type Picture = (f64, Option<u8>, f32, f32, f32);

fn pictures() -> impl Strategy<Value = Vec<Picture>> {
    let since = prop_oneof![0.001..0.04f64, 0.5..3.0f64];
    let bright = prop_oneof![Just(1.0), 0.0..=1.0f32];
    let one = (since, proptest::option::weighted(0.1, 0..3u8), -2.0..2.0f32, -90.0..90.0f32, bright);
    // Half of the generated frames have default values.
    let one = (one, any::<bool>()).prop_map(|((since, scene, knob, yaw, bright), still)| match still {
        true => (since, scene, 0.5, 0.0, 1.0),
        false => (since, scene, knob, yaw, bright),
    });
    proptest::collection::vec(one, 1..60)
}

proptest! {
    #[test]
    fn the_cue_list_of_a_performance_repeats_each_frame(pictures in pictures(), back in 0usize..60) {
        let mut performance = Performance::default();
        let (mut time, mut scene, mut start) = (0.0, "first", 0.0);
        let mut seen = Vec::new();
        let begun = 7.25;
        for (number, (since, change, knob, yaw, bright)) in pictures.into_iter().enumerate() {
            time += since;
            if number == back {
                // Go back to the middle: later frames are replaced.
                time *= 0.5;
                seen.retain(|(at, ..): &(f64, &str, f32, [f32; 3], f32)| *at < time);
                (scene, start) = ("again", time);
            }
            if let Some(change) = change {
                (scene, start) = (["first", "second", "third"][usize::from(change)], time);
            }
            let turns = [yaw, 0.0, 1.0];
            let picture = Finish { numbers: [bright, 0.0], is_shown: false };
            performance.record(begun + time, &OnStage {
                scene,
                camera: None,
                transition: TimedTransition::CUT,
                start: begun + start,
                params: vec![Turned { name: "knob", value: knob, own: 0.5, is_shown: false }],
                moves: &[],
                turns,
                picture,
                other: None,
            });
            seen.push((time, scene, knob, turns, bright));
        }
        let text = print(&performance.cue_list(), &[]);
        let cue_list = parse("performed.show", &text).cue_list;
        prop_assert!(cue_list.is_some(), "{text}");
        let (timeline, left_out) = resolve(&cue_list.unwrap_or_default(), &SongStructure::default(), &[], |_, _| None);
        prop_assert!(left_out.is_empty());
        let timeline = timeline.unwrap();
        for (time, scene, knob, turns, bright) in seen {
            let clip = timeline.at(begun + time).clip;
            prop_assert_eq!(clip.scene.as_str(), scene, "{}", text);
            let found = clip.moved("knob", begun + time).map_or(0.5, |moved| moved.value);
            prop_assert_eq!(found.to_bits(), knob.to_bits(), "{} at {}: {}", found, begun + time, text);
            prop_assert_eq!(clip.turns_at(begun + time), turns, "{}", text);
            let found = timeline.picture_at(begun + time).brightness;
            prop_assert_eq!(found.to_bits(), bright.to_bits(), "{} at {}: {}", found, begun + time, text);
        }
    }
}

/// The cue list must not start the new scene a millisecond early, while the previous frame is still displayed.
#[test]
fn a_frame_within_a_millisecond_before_a_step_back_keeps_its_scene() {
    keeps_both_scenes(&[
        (8.0, "orb", 8.0),
        (8.6262, "orb", 8.0),
        (9.5, "orb", 8.0),
        (8.6264, "city", 8.6264),
    ]);
}

#[test]
fn a_frame_within_a_millisecond_before_a_cut_keeps_its_scene() {
    keeps_both_scenes(&[(8.0, "orb", 8.0), (8.6262, "orb", 8.0), (8.6264, "city", 8.6264)]);
}

/// Checks that the recorded frames at 8.6262 s and 8.6264 s keep their scenes.
fn keeps_both_scenes(notes: &[(f64, &str, f64)]) {
    let mut performance = Performance::default();
    for &(time, scene, start) in notes {
        let picture = Finish::NOTHING;
        let transition = TimedTransition::CUT;
        performance.record(
            time,
            &OnStage {
                scene,
                camera: None,
                transition,
                start,
                params: Vec::new(),
                moves: &[],
                turns: UNTURNED,
                picture,
                other: None,
            },
        );
    }
    let text = print(&performance.cue_list(), &[]);
    let cue_list = parse("performed.show", &text).cue_list.unwrap();
    let timeline = resolve(&cue_list, &SongStructure::default(), &[], |_, _| None).0.unwrap();
    assert_eq!([8.6262, 8.6264].map(|time| timeline.at(time).clip.scene.as_str()), ["orb", "city"], "{text}");
}

#[test]
fn unchanged_parameters_are_not_written() {
    let mut performance = Performance::default();
    assert!(performance.is_empty());
    for frame in 0..100 {
        performance.record(
            f64::from(frame) / 60.0,
            &OnStage {
                scene: "orb",
                camera: Some("pole"),
                transition: TimedTransition::new(TransitionStyle::Melt, 2.0),
                start: 0.0,
                params: vec![Turned { name: "relief", value: 0.5, own: 0.5, is_shown: false }],
                moves: &[],
                turns: UNTURNED,
                picture: Finish::NOTHING,
                other: None,
            },
        );
    }
    assert_eq!(print(&performance.cue_list(), &[]), "at 0:00  orb  camera pole  melt over 2 s\n");
}

#[test]
fn an_animation_of_the_show_is_kept_until_a_user_changes_the_parameter() {
    let mut performance = Performance::default();
    let moves = [Move { param: "swell".to_owned(), start: 12.0, seconds: 8.0, from: 0.0, to: 1.0 }];
    for frame in 0..=160 {
        // Ten frames a second; a user takes over at 20 s.
        let time = 10.0 + f64::from(frame) / 10.0;
        let value = if time < 20.0 { 0.125 * (time - 12.0).clamp(0.0, 8.0) as f32 } else { 0.25 };
        performance.record(
            time,
            &OnStage {
                scene: "orb",
                camera: None,
                transition: TimedTransition::CUT,
                start: 10.0,
                params: vec![Turned { name: "swell", value, own: 0.5, is_shown: time < 20.0 }],
                moves: &moves,
                turns: UNTURNED,
                picture: Finish::NOTHING,
                other: None,
            },
        );
    }
    let wanted =
        "at 0:10  orb  cut\n  set swell = 0 -> 1 over 8 s after 2 s\n  set swell = 0.25 after 10 s\n";
    assert_eq!(print(&performance.cue_list(), &[]), wanted);
}

/// Records frame number `frame` of the scene orb at 60 frames a second, with `value` as the relief.
fn note_relief(performance: &mut Performance, frame: u32, value: f32) {
    performance.record(
        f64::from(frame) / 60.0,
        &OnStage {
            scene: "orb",
            camera: None,
            transition: TimedTransition::CUT,
            start: 0.0,
            params: vec![Turned { name: "relief", value, own: 0.5, is_shown: false }],
            moves: &[],
            turns: UNTURNED,
            picture: Finish::NOTHING,
            other: None,
        },
    );
}

#[test]
fn a_long_performance_continues_in_another_entry() {
    let mut performance = Performance::default();
    let frames = limits::STEPS_MAX as u32 + 5;
    for frame in 0..frames {
        note_relief(&mut performance, frame, frame as f32);
    }
    let text = print(&performance.cue_list(), &[]);
    let read = parse("long.show", &text);
    assert_eq!(
        read.cue_list.map(|cue_list| cue_list.entries.len()),
        Some(2),
        "{:?}",
        read.diagnostics.first()
    );
    assert!(!performance.is_full);
}

#[test]
fn long_animations_are_broken_into_lines() {
    let mut performance = Performance::default();
    // A smoothed controller at 60 frames a second.
    let value = |frame: u32| if frame < 30 { 0.5 } else { 1.0 - 0.5 * 0.93f32.powi(frame as i32 - 30) };
    for frame in 0..100 {
        note_relief(&mut performance, frame, value(frame));
    }
    let text = print(&performance.cue_list(), &[]);
    assert!(text.matches("->").count() >= 70, "{text}");
    assert!(text.lines().all(|line| line.len() <= 100), "{text}");
    // The text breaks the long animation into several lines, which give the same values.
    let cue_list = parse("performed.show", &text).cue_list.unwrap();
    let timeline = resolve(&cue_list, &SongStructure::default(), &[], |_, _| None).0.unwrap();
    for frame in 0..100 {
        let time = f64::from(frame) / 60.0;
        let relief = timeline.at(time).clip.moved("relief", time).unwrap();
        assert_eq!(relief.value, value(frame), "{text}");
    }
}

fn note_orb(performance: &mut Performance, time: f64, scene: &str, numbers: [f32; 2]) {
    let picture = Finish { numbers, is_shown: numbers == PLAIN_PICTURE };
    let start = if scene == "orb" { 0.0 } else { 7.0 };
    let (transition, params) = (TimedTransition::CUT, Vec::new());
    let seen = OnStage {
        scene,
        camera: None,
        transition,
        start,
        params,
        moves: &[],
        turns: UNTURNED,
        picture,
        other: None,
    };
    performance.record(time, &seen);
}

#[test]
fn a_frozen_frame_stays_across_scene_changes() {
    let mut performance = Performance::default();
    for frame in 0..=120 {
        note_orb(&mut performance, f64::from(frame) / 60.0, "orb", PLAIN_PICTURE);
    }
    let held = Finish { numbers: [1.0, 1.0], is_shown: false };
    let shown = performance.last.unwrap();
    assert_eq!(shown, 2.0);
    performance.record_picture(shown, &held);
    for frame in 121..=480 {
        performance.record_picture(f64::from(frame) / 60.0, &held);
    }
    // The scene has changed during the freeze. The frozen frame fades into the new scene.
    for frame in 0..=4u8 {
        let fraction = 1.0 - f32::from(frame) / 4.0;
        note_orb(&mut performance, 8.0 + f64::from(frame) / 64.0, "city", [1.0, fraction]);
    }
    let text = print(&performance.cue_list(), &[]);
    let wanted = "at 0:00  orb  cut\n  set picture freeze = 0 -> 0 over 2 s -> 1 over 0 s\n\
                  at 0:07  city  cut\n  set picture freeze = 1\n    -> 1 over 1 s -> 0.75 over 0.015625 s \
                  -> 0.5 over 0.015625 s -> 0.25 over 0.015625 s\n    -> 0 over 0.015625 s\n";
    assert_eq!(text, wanted);
    let cue_list = parse("performed.show", &text).cue_list.unwrap();
    let timeline = resolve(&cue_list, &SongStructure::default(), &[], |_, _| None).0.unwrap();
    let at = |time| timeline.picture_at(time).held.map(|held| (held.since, held.fraction));
    assert_eq!([1.5, 9.0].map(at), [None, None]);
    assert_eq!(
        [2.0, 6.5, 7.5, 8.0, 8.03125].map(at),
        [1.0, 1.0, 1.0, 1.0, 0.5].map(|fraction| Some((2.0, fraction)))
    );
}

#[test]
fn a_frame_frozen_during_a_fade_keeps_the_fraction_of_the_fading_frame() {
    let mut performance = Performance::default();
    note_orb(&mut performance, 1.0, "orb", PLAIN_PICTURE);
    performance.hold(&Finish { numbers: [1.0, 1.0], is_shown: false });
    for (time, fraction) in [(2.0, 1.0), (2.0625, 0.75), (2.125, 0.5)] {
        note_orb(&mut performance, time, "orb", [1.0, fraction]);
    }
    // The first frozen frame is still fading out when the second frame is frozen, at 2.125 s.
    performance.hold(&Finish { numbers: [1.0, 1.0], is_shown: false });
    note_orb(&mut performance, 3.0, "orb", [1.0, 1.0]);
    note_orb(&mut performance, 8.0, "orb", [1.0, 0.25]);
    performance.hold(&Finish { numbers: [1.0, 1.0], is_shown: false });
    let text = print(&performance.cue_list(), &[]);
    let cue_list = parse("performed.show", &text).cue_list.unwrap();
    let timeline = resolve(&cue_list, &SongStructure::default(), &[], |_, _| None).0.unwrap();
    let at = |time| -> Vec<(f64, f32)> {
        timeline.held_at(time).iter().map(|held| (held.since, held.fraction)).collect()
    };
    assert_eq!(at(2.0625), [(1.0, 0.75)], "{text}");
    assert_eq!(at(2.5), [(2.125, 1.0), (1.0, 0.5)], "{text}");
    assert_eq!(at(9.0), [(8.0, 1.0), (2.125, 0.25), (1.0, 0.5)], "{text}");
}

#[test]
fn only_a_transition_that_was_cut_off_is_unfinished() {
    let mut performance = Performance::default();
    for (time, scene, start, seconds) in
        [(1.0, "one", 1.0, 0.0), (3.0, "two", 2.0, 8.0), (7.0, "three", 6.0, 1.5), (9.0, "four", 7.5, 3.0)]
    {
        let transition = if seconds > 0.0 {
            TimedTransition::new(TransitionStyle::Fade, seconds)
        } else {
            TimedTransition::CUT
        };
        let picture = Finish::NOTHING;
        let params = Vec::new();
        performance.record(
            time,
            &OnStage {
                scene,
                camera: None,
                transition,
                start,
                params,
                moves: &[],
                turns: UNTURNED,
                picture,
                other: None,
            },
        );
    }
    let wanted = "at 0:01    one  cut\nat 0:02    two  fade over 8 s unfinished\nat 0:06    three  fade over 1.5 s\n\
                  at 0:07.5  four  fade over 3 s\n";
    assert_eq!(print(&performance.cue_list(), &[]), wanted);
}

#[test]
fn an_initially_dimmed_image_is_set_once() {
    let mut performance = Performance::default();
    for frame in 0..=60 {
        note_orb(&mut performance, f64::from(frame) / 60.0, "orb", [0.25, 0.0]);
    }
    note_orb(&mut performance, 7.5, "city", [0.25, 0.0]);
    let wanted = "at 0:00  orb  cut\n  set picture brightness = 0.25\nat 0:07  city  cut\n";
    assert_eq!(print(&performance.cue_list(), &[]), wanted);
}

/// A frame with decks: the scenes at both ends of the fader, the fader, and the values of a parameter of each.
type DeckPicture = ([&'static str; 2], f32, [f32; 2]);

fn note_decks(performance: &mut Performance, time: f64, start: f64, (scenes, fader, values): DeckPicture) {
    let [from, to] = scenes;
    let knob = |value| vec![Turned { name: "knob", value, own: 0.5, is_shown: false }];
    let shown = |is_shown: bool, value| if is_shown { knob(value) } else { Vec::new() };
    performance.record(
        time,
        &OnStage {
            scene: to,
            camera: None,
            transition: TimedTransition::by_fader(TransitionStyle::Melt),
            start,
            params: shown(fader > 0.0, values[1]),
            moves: &[],
            turns: UNTURNED,
            picture: Finish::NOTHING,
            other: Some(OtherDeck {
                scene: from.to_owned(),
                params: shown(fader < 1.0, values[0]),
                turns: UNTURNED,
                fader,
            }),
        },
    );
}

proptest! {
    #[test]
    fn the_cue_list_of_two_decks_repeats_each_frame(
        pictures in proptest::collection::vec((0.001..0.2f64, 0..40usize, -0.5..1.5f32, 0.0..1.0f32, 0.0..1.0f32), 1..80)
    ) {
        let mut performance = Performance::default();
        let (mut time, mut decks, mut start) = (3.0, ["orb", "city"], 3.0);
        let mut seen: Vec<(f64, DeckPicture)> = Vec::new();
        for (since, load, fader, one, other) in pictures {
            time += since;
            // A new scene is loaded into the deck that is less visible; the fader then leads to this deck.
            if let Some(scene) = ["gyroid", "heart", "tunnel"].get(load).filter(|scene| !decks.contains(scene)) {
                (decks, start) = ([decks[1], scene], time);
            }
            let picture = (decks, fader.clamp(0.0, 1.0), [one, other]);
            note_decks(&mut performance, time, start, picture);
            seen.push((time, picture));
        }
        let text = print(&performance.cue_list(), &[]);
        let cue_list = parse("performed.show", &text).cue_list.unwrap_or_default();
        let timeline = resolve(&cue_list, &SongStructure::default(), &[], |_, _| None).0.unwrap();
        for (time, (scenes, fader, values)) in seen {
            let moment = timeline.at(time);
            let value = |clip: &crate::Clip| clip.moved("knob", time).map_or(0.5, |moved| moved.value);
            let found = (moment.clip.scene.as_str(), value(moment.clip));
            match fader {
                0.0 => prop_assert_eq!((found, moment.leaving), ((scenes[0], values[0]), None), "{}", text),
                1.0 => prop_assert_eq!((found, moment.leaving), ((scenes[1], values[1]), None), "{}", text),
                _ => {
                    let (from, fraction) = moment.leaving.unwrap();
                    prop_assert_eq!(found, (scenes[1], values[1]), "{}", text);
                    prop_assert_eq!((from.scene.as_str(), value(from)), (scenes[0], values[0]), "{}", text);
                    prop_assert_eq!(fraction.to_bits(), fader.to_bits(), "{}", text);
                }
            }
        }
    }
}

#[test]
fn decks_are_written_as_a_transition_by_fader() {
    let mut performance = Performance::default();
    for (time, fader) in [(2.0, 0.0), (2.05, 0.25), (2.1, 1.0)] {
        note_decks(&mut performance, time, 2.0, (["orb", "city"], fader, [0.5, 0.5]));
    }
    let wanted = "at 0:02  orb  cut\nat 0:02  city  melt by fader\n\
                  \x20 set deck fader = 0 -> 0.25 over 0.05 s -> 1 over 0.05 s\n";
    assert_eq!(print(&performance.cue_list(), &[]), wanted);
}
