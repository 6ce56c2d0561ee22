//! Tests of numbers with inertia: `follow`, `spring` and `since`.

use super::{broken, scene};
use crate::graph::{Interval, MotionKind};
use crate::limits::MOTION_SECONDS;

#[test]
fn motions_have_the_range_of_their_goal() {
    for (text, kind, range) in [
        ("follow(bass, 0.1)", MotionKind::Follow, [0.0, 1.0]),
        ("follow(2 * bass - 1, 0.1, 2)", MotionKind::Follow, [-1.0, 1.0]),
        ("spring(drums.kick + t * 0, 80)", MotionKind::Spring, [-1.0, 2.0]),
        ("spring(band(floor(mod(t, 8))), 80, 4)", MotionKind::Spring, [-1.0, 2.0]),
        ("since(beat > 0.5 && bass < 0.4)", MotionKind::Since, [0.0, MOTION_SECONDS]),
    ] {
        let scene = scene(&format!("length(p) - {text}"));
        let [motion] = scene.graph.motions() else { panic!("{text}: {:?}", scene.graph.motions()) };
        assert_eq!((motion.kind, motion.range), (kind, Interval { lo: range[0], hi: range[1] }), "{text}");
    }
    let scene_of = |text: &str| scene(&format!("length(p - vec3({text}, 0))"));
    assert_eq!(scene_of("follow(volume, 0.1)").graph.motions().len(), 2, "one for each channel");
    assert_eq!(scene_of("follow(vec2(bass), 0.1)").graph.motions().len(), 1, "equal ones are one");
    assert!(scene_of("spring(vec2(3), 4)").graph.motions().is_empty(), "a constant does not move");
    assert!(scene("length(p) - follow(energy, 1)").graph.reads_song());
}

#[test]
fn motions_of_what_is_not_remembered_are_refused() {
    for (text, part) in [
        ("follow(x, 0.1)", "remembers numbers of the sound, not the point"),
        ("follow(bass, y)", "not the point"),
        ("spring(spectrum(0.5), 9)", "not spectrum"),
        ("follow(mouse.x, 0.1)", "not "),
        ("since(length(n) > 0.3)", ""),
        ("since(volume)", "needs one number"),
        ("follow(volume, vec3(1))", "vectors of the same size"),
        ("follow(bass > 0.5, 1)", "works on numbers and vectors"),
        ("follow(bass)", "`follow`"),
        ("sum(for i in 0..65: follow(bass, 1 + i))", "more than 64 numbers with inertia"),
    ] {
        let report = broken(&format!("length(p) - {text}")).render(false);
        assert!(report.contains(part), "{text}: {report}");
    }
    let own = scene("fn spring(a) = a\nlength(p) - spring(x)");
    assert!(own.graph.motions().is_empty(), "a scene's own function hides them");
}
