//! Tests of the changes of a cell.

use crate::witness::swing::*;
use mariana_render::flash::rules::CAUTIOUS;

fn light_changes(lights: &[f32]) -> usize {
    let mut swing = LightSwing::NEW;
    lights.iter().filter(|light| swing.step(**light, &DEFINED).is_some()).count()
}

fn red_changes(colors: &[[f32; 3]]) -> usize {
    let mut swing = RedSwing::NEW;
    colors.iter().filter(|color| swing.step(**color, &DEFINED).is_some()).count()
}

#[test]
fn changes_of_light_count_from_a_tenth_on_and_below_four_fifths() {
    assert_eq!(light_changes(&[0.0, 1.0, 0.0, 1.0]), 3);
    assert_eq!(light_changes(&[0.3, 0.39, 0.3, 0.39]), 0);
    assert_eq!(light_changes(&[0.3, 0.41, 0.3]), 2);
    assert_eq!(light_changes(&[0.82, 1.0, 0.82]), 0, "the darker state is bright");
    assert_eq!(light_changes(&[0.7, 1.0, 0.7]), 2);
    let ramp = (0..200).map(|i| if i < 100 { i as f32 / 100.0 } else { 2.0 - i as f32 / 100.0 });
    assert_eq!(light_changes(&ramp.collect::<Vec<_>>()), 2);
    assert_eq!(light_changes(&[0.0, 0.5, 0.45, 0.55, 0.5, 0.6, 0.0]), 2);
}

#[test]
fn a_borderline_change_may_count_later() {
    let mut swing = LightSwing::NEW;
    swing.step(0.2, &CAUTIOUS);
    assert_eq!(swing.step(0.297, &CAUTIOUS), Some(Change::Up));
    assert!(swing.may_count_only_at(0.3, &CAUTIOUS) && !swing.may_count_only_at(0.29, &CAUTIOUS));
    assert_eq!(swing.step(0.31, &CAUTIOUS), None);
    assert!(!swing.may_count_only_at(0.32, &CAUTIOUS), "the change has counted");
    assert_eq!(swing.step(0.213, &CAUTIOUS), Some(Change::Down));
    assert!(swing.may_count_only_at(0.209, &CAUTIOUS) && !swing.may_count_only_at(0.23, &CAUTIOUS));
}

#[test]
fn changes_to_and_from_saturated_red_count() {
    let (red, black, white, green) = ([1.0, 0.0, 0.0], [0.0; 3], [1.0; 3], [0.0, 1.0, 0.0]);
    for other in [black, white, green] {
        assert_eq!(red_changes(&[red, other, red]), 2, "{other:?}");
    }
    assert_eq!(red_changes(&[white, black, white, green, white]), 0);
    assert_eq!(red_changes(&[[0.5, 0.2, 0.2], black, [0.5, 0.2, 0.2]]), 0, "the red is not saturated");
    assert_eq!(red_changes(&[[0.005, 0.0, 0.0], black, [0.005, 0.0, 0.0]]), 0);
    assert_eq!(red_changes(&[red, [0.9, 0.1, 0.0], red]), 0);
}

#[test]
fn a_change_to_a_borderline_red_may_count_later() {
    let (hardly, red, black) = ([0.8, 0.1, 0.1], [1.0, 0.0, 0.0], [0.0; 3]);
    for (color, may) in [(hardly, true), (red, false)] {
        let mut swing = RedSwing::NEW;
        swing.step([0.0, 0.0, 1.0], &CAUTIOUS);
        assert_eq!(swing.step(color, &CAUTIOUS), Some(Change::Up));
        assert_eq!(swing.may_count_only_at(red, &CAUTIOUS), may);
        assert!(!swing.may_count_only_at(black, &CAUTIOUS));
    }
}

#[test]
fn changes_older_than_a_second_are_forgotten() {
    let mut times = Times::NEW;
    for i in 0..30 {
        times.note(f64::from(i) / 30.0);
    }
    assert_eq!(times.count(29.0 / 30.0, 0.0), 30);
    times.note(1.0);
    assert_eq!((times.count(1.0, 0.0), times.count(1.0, 0.1)), (30, 27));
}
