//! Numbers with inertia: each follows another number of the frame through time. A motion keeps no state between frames:
//! its value is computed from the sound of the last seconds ([`Motions`](crate::world::Motions)), so that a moment looks
//! the same however it was reached.

use super::frame_inputs::OwnRanges;
use super::interval::Interval;
use super::node::{Input, Node, NodeId};
use super::op::Properties;
use super::{Graph, Op};
use crate::limits::MOTION_SECONDS;

/// The way in which a number moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotionKind {
    /// Approaches its goal exponentially.
    Follow,
    /// Is pulled to its goal by a damped spring.
    Spring,
    /// Counts the seconds since an event began.
    Since,
}

/// A number with inertia.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// The way in which it moves.
    pub kind: MotionKind,
    /// The goal, then the time constants of rise and fall in seconds, or the stiffness in 1/s² and the damping in 1/s.
    /// For [`MotionKind::Since`], the first operand is above 0.5 during the event.
    pub operands: [NodeId; 3],
    /// Bounds of the value for any sound.
    pub range: Interval,
}

/// The state of a motion at a moment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MotionState {
    pub value: f32,
    speed: f32,
    goal: f32,
}

/// Shortest time constant, in seconds.
const SECONDS_MIN: f32 = 1e-3;
/// Greatest stiffness and damping of a spring.
const STIFFNESS_MAX: f32 = 4000.0;
const DAMPING_MAX: f32 = 1000.0;

struct Spring {
    stiffness: f32,
    damping: f32,
}

impl Spring {
    /// Returns the place and the speed `seconds` later, relative to a goal that stays: the damped oscillator's solution.
    fn after(&self, place: f32, speed: f32, seconds: f32) -> (f32, f32) {
        let half = 0.5 * self.damping;
        let square = half * half - self.stiffness;
        let angle = square.abs().sqrt();
        let (even, odd) = match angle * seconds {
            turn if turn < 1e-3 => (1.0, seconds),
            turn if square < 0.0 => (turn.cos(), turn.sin() / angle),
            turn => (turn.cosh(), turn.sinh() / angle),
        };
        let left = (-half * seconds).exp();
        let pull = self.stiffness * place + half * speed;
        (left * (place * even + (speed + half * place) * odd), left * (speed * even - pull * odd))
    }
}

impl Motion {
    /// Returns the state at the first known moment, at which the operands have these values.
    pub(crate) fn begin(&self, [goal, ..]: [f32; 3]) -> MotionState {
        let value = if self.kind == MotionKind::Since { MOTION_SECONDS } else { goal };
        MotionState { value: self.within(value, self.within(0.0, 0.0)), speed: 0.0, goal }
    }

    /// Returns the state `seconds` later, when the operands have these values.
    pub(crate) fn step(&self, state: MotionState, [goal, a, b]: [f32; 3], seconds: f32) -> MotionState {
        let MotionState { value, speed, .. } = state;
        let (value, speed) = match self.kind {
            MotionKind::Follow => {
                let over = if goal > value { a } else { b };
                let part = 1.0 - (-seconds / over.max(SECONDS_MIN)).exp();
                (value + (goal - value) * part, 0.0)
            }
            MotionKind::Spring => {
                let spring =
                    Spring { stiffness: a.clamp(0.0, STIFFNESS_MAX), damping: b.clamp(0.0, DAMPING_MAX) };
                let (away, speed) = spring.after(value - goal, speed, seconds);
                (goal + away, speed)
            }
            MotionKind::Since if goal > 0.5 && state.goal <= 0.5 => {
                // The moment between the two steps at which the event began.
                (seconds * ((goal - 0.5) / (goal - state.goal)).clamp(0.0, 1.0), 0.0)
            }
            MotionKind::Since => (value + seconds, 0.0),
        };
        let speed = if speed.is_finite() { speed } else { 0.0 };
        MotionState { value: self.within(value, state.value), speed, goal }
    }

    fn within(&self, value: f32, otherwise: f32) -> f32 {
        // Not `clamp`, because the ends of an unknown range are NaN.
        if value.is_finite() { value.max(self.range.lo).min(self.range.hi) } else { otherwise }
    }
}

impl Graph {
    /// Returns the value of a motion. Equal motions are stored once.
    pub fn motion(&mut self, motion: Motion) -> NodeId {
        let alike = |known: &Motion| (known.kind, known.operands) == (motion.kind, motion.operands);
        let number = self.motions.iter().position(alike).unwrap_or_else(|| {
            self.motions.push(motion);
            self.motions.len() - 1
        });
        self.input(Input::Motion(number as u16))
    }

    /// Returns the motions; `Input::Motion(i)` is the value of the i-th.
    pub fn motions(&self) -> &[Motion] {
        &self.motions
    }

    /// Returns the ranges of the motions and of these parameters, each with its least and greatest value.
    pub fn ranges(&self, params: impl IntoIterator<Item = (f32, f32)>) -> OwnRanges {
        OwnRanges {
            params: params.into_iter().map(|(low, high)| Interval::new(low, high)).collect(),
            motions: self.motions.iter().map(|motion| motion.range).collect(),
        }
    }

    /// Returns the name of the first input, curve or texture that a value reads and that is not known for earlier moments.
    /// Known are the time, the numbers of the sound, parameters and motions.
    pub(crate) fn not_remembered(&self, root: NodeId) -> Option<String> {
        self.order(&[root]).into_iter().find_map(|id| match self.node(id) {
            Node::Input(
                Input::T | Input::Sound(_) | Input::Level(_) | Input::Param(_) | Input::Motion(_),
            ) => None,
            Node::Input(input) if input.of_point().is_some() => Some("the point".to_owned()),
            Node::Input(input) => Some(input.to_string().to_lowercase()),
            Node::Unary(op, _) | Node::Binary(op, _, _) => {
                let is_number = op.level_list().is_some() || op == Op::Part;
                let is_read = op.properties().has(Properties::READS_FRAME) && !is_number;
                is_read.then(|| op.name().to_lowercase())
            }
            Node::Texture { .. } => Some("a texture".to_owned()),
            Node::Constant(_) => None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The values at steps of 20 ms while the goal is `goal(time)`.
    fn run(kind: MotionKind, [a, b]: [f32; 2], goal: impl Fn(f32) -> f32) -> Vec<f32> {
        let motion = Motion { kind, operands: [NodeId::default(); 3], range: Interval { lo: -6.0, hi: 6.0 } };
        let mut state = motion.begin([goal(0.0), a, b]);
        let steps = (1..100).map(|step| {
            state = motion.step(state, [goal(0.02 * step as f32), a, b], 0.02);
            state.value
        });
        steps.collect()
    }

    #[test]
    fn following_takes_the_time_constants_of_rise_and_fall() {
        let values = run(MotionKind::Follow, [0.1, 0.5], |time| if time < 0.99 { 1.0 } else { 0.0 });
        assert_eq!(values[0], 1.0, "it begins at its goal");
        let up = run(MotionKind::Follow, [0.1, 0.5], |time| if time > 0.0 { 1.0 } else { 0.0 });
        assert!((up[4] - (1.0 - (-1.0_f32).exp())).abs() < 1e-4, "{}", up[4]);
        let down = values[49 + 24];
        assert!((down - (-1.0_f32).exp()).abs() < 0.02, "{down}");
    }

    #[test]
    fn a_spring_overshoots_and_settles_and_a_damped_one_does_not_overshoot() {
        let jump = |time: f32| if time > 0.0 { 1.0 } else { 0.0 };
        let loose = run(MotionKind::Spring, [120.0, 6.0], jump);
        let most = loose.iter().copied().fold(0.0, f32::max);
        assert!(most > 1.2 && (loose[98] - 1.0).abs() < 0.02, "{most} {}", loose[98]);
        let damped = run(MotionKind::Spring, [120.0, 2.0 * 120.0_f32.sqrt()], jump);
        assert!(damped.iter().all(|value| *value < 1.001) && damped[98] > 0.99);
        let hard = run(MotionKind::Spring, [f32::INFINITY, f32::NAN], jump);
        assert!(hard.iter().all(|value| value.is_finite() && value.abs() <= 6.0), "{hard:?}");
    }

    #[test]
    fn a_goal_without_a_range_or_a_value_moves_nothing_out_of_bounds() {
        let operands = [NodeId::default(); 3];
        for kind in [MotionKind::Follow, MotionKind::Spring, MotionKind::Since] {
            for range in [Interval::ANY, Interval::ALL, Interval { lo: -1.0, hi: 1.0 }] {
                let motion = Motion { kind, operands, range };
                let mut state = motion.begin([f32::NAN; 3]);
                for goal in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, 0.25] {
                    for numbers in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e30] {
                        state = motion.step(state, [goal, numbers, numbers], 0.02);
                        assert!(state.value.is_finite(), "{kind:?} {range:?} {goal} {numbers}: {state:?}");
                        assert!(range.is_any() || range.contains(state.value), "{range:?}: {state:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_time_since_an_event_counts_from_the_middle_of_its_rise() {
        let values = run(MotionKind::Since, [0.0; 2], |time| if time < 0.39 { 0.0 } else { 1.0 });
        assert_eq!(values[0], MOTION_SECONDS, "no event is known");
        assert!((values[19] - 0.01).abs() < 1e-6 && (values[29] - 0.21).abs() < 1e-5, "{values:?}");
    }
}
