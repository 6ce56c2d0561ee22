//! Computes the numbers with inertia of a frame from the sound of the last seconds.

use std::collections::BTreeSet;

use super::Hoisted;
use crate::graph::{FrameInputs, Graph, Input, Motion, MotionState, NodeId, Op, SoundInput};

/// The motions of a scene, in the order of their numbers. A motion reads only motions before it.
#[derive(Debug, Clone, Default)]
pub struct Motions {
    /// Each motion with its operands.
    steps: Vec<(Motion, Hoisted)>,
    /// The numbers of the sound that they read.
    pub sounds: Vec<SoundInput>,
    /// True if they read levels, such as `band(3)`.
    pub read_levels: bool,
    /// True if they read parts of the song.
    pub read_parts: bool,
}

/// Motions on their way from the first known moment to the frame.
#[derive(Debug)]
pub struct Moving<'m> {
    motions: &'m Motions,
    /// The state of each motion; `None` before the first known moment.
    states: Vec<Option<MotionState>>,
}

impl Motions {
    pub(crate) fn of(graph: &Graph) -> Self {
        let motions = graph.motions();
        let roots: Vec<NodeId> = motions.iter().flat_map(|motion| motion.operands).collect();
        let used = graph.inputs_used(&roots);
        let sounds: BTreeSet<SoundInput> = used
            .inputs
            .iter()
            .filter_map(|input| if let Input::Sound(sound) = input { Some(*sound) } else { None })
            .collect();
        let step = |motion: &Motion| (*motion, Hoisted::of(graph, &motion.operands));
        Self {
            steps: motions.iter().map(step).collect(),
            sounds: sounds.into_iter().collect(),
            read_levels: used.inputs.iter().any(|input| matches!(input, Input::Level(_)))
                || used.tables.iter().any(|table| table.level_list().is_some()),
            read_parts: used.tables.contains(&Op::Part),
        }
    }

    /// True if the scene has no numbers with inertia.
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// Begins before the first known moment.
    pub fn begin(&self) -> Moving<'_> {
        Moving { motions: self, states: vec![None; self.steps.len()] }
    }
}

impl Moving<'_> {
    /// Advances by `seconds` to a moment, and writes the values into its inputs.
    pub fn step(&mut self, at: &mut FrameInputs, seconds: f32) {
        at.motions.resize(self.motions.steps.len(), 0.0);
        let steps = self.motions.steps.iter().zip(&mut self.states);
        for (number, ((motion, operands), state)) in steps.enumerate() {
            let values = operands.values(at);
            let Some(values) = values.first_chunk() else { return };
            let next = match state {
                Some(state) => motion.step(*state, *values, seconds),
                None => motion.begin(*values),
            };
            at.motions[number] = next.value;
            *state = Some(next);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::graph::{FrameInputs, Input, Point, SoundInput, SoundInputs};
    use crate::world::{Alignment, BlendKind, World};

    /// The inputs of a frame after a second in which the bass rises from 0 to 1.
    fn after_a_second(world: &World) -> FrameInputs {
        let (mut moving, mut at) = (world.frame_tape.motions.begin(), FrameInputs::default());
        for step in 0..=50 {
            let bass = (step as f32 / 10.0).min(1.0);
            at.sound = SoundInputs::with(&[(SoundInput::Bass, bass), (SoundInput::Kick, bass)]);
            moving.step(&mut at, 0.02);
        }
        at.hoisted = world.hoisted.values(&at);
        at
    }

    const SLOW: &str = "let slow = follow(bass, 0.5)\nobject ball { shape = length(p) - 1 - slow }";
    const TWICE: &str =
        "object ball { shape = length(p) - 1 - follow(follow(bass, 0.5), 0.5) - 0.1 * since(kick > 0.3) }";

    #[test]
    fn a_motion_may_follow_a_motion_and_shaders_see_only_hoisted_numbers() {
        let [slow, twice] = [SLOW, TWICE].map(|text| World::parse("test", text).unwrap());
        let radius = |world: &World| {
            let inputs = after_a_second(world);
            let value = world.graph.evaluate(&[world.roots.distance[1]], &Point::default(), &inputs)[0];
            (-value - 1.0, inputs.motions)
        };
        let (reached, motions) = radius(&slow);
        assert!((0.8..0.9).contains(&reached) && motions == [reached], "{reached} {motions:?}");
        let (_, motions) = radius(&twice);
        let [once, again, since] = motions[..] else { panic!("{motions:?}") };
        assert!(again < once - 0.2 && (since - 0.93).abs() < 0.03, "{motions:?}");
        for world in [&slow, &twice] {
            let used = world.graph.inputs_used(&world.roots.all().collect::<Vec<_>>()).inputs;
            assert!(
                !used.iter().any(|input| matches!(input, Input::Motion(_) | Input::Sound(_))),
                "{used:?}"
            );
            let bounds = world.bounds.expect("the range of a motion is known");
            assert!(bounds.high[0] < 2.7, "{bounds:?}");
        }
    }

    #[test]
    fn a_blend_has_the_motions_of_both_scenes() {
        let [from, to] = [SLOW, TWICE].map(|text| World::parse("test", text).unwrap());
        let blend = World::blend(&from, &to, BlendKind::Melt, &Alignment::NONE, 0.5).unwrap();
        let [first, second] = [&from, &to].map(|world| after_a_second(world).motions);
        let mut both = after_a_second(&blend).motions;
        let mut wanted = [first, second].concat();
        both.sort_by(f32::total_cmp);
        wanted.sort_by(f32::total_cmp);
        both.dedup();
        wanted.dedup();
        assert_eq!(both, wanted);
    }
}
