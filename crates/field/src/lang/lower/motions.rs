//! Lowers numbers with inertia: `follow`, `spring` and `since`.

use super::super::builtin::{BuiltinRow, uses};
use super::super::diagnostic::Diagnostic;
use super::super::value::{Value, Vector};
use super::builtins::sizes_fit;
use super::call::Call;
use super::lowering::Lowering;
use crate::graph::{Interval, Motion, MotionKind, NodeId, Op};
use crate::limits::MOTION_SECONDS;

pub(super) struct MotionCall<'o, 'l> {
    pub outer: &'o mut Lowering<'l>,
    pub row: &'static BuiltinRow,
    pub kind: MotionKind,
    pub call: Call,
}

impl MotionCall<'_, '_> {
    /// Returns the number, or a vector of them.
    pub(super) fn value(mut self) -> Value {
        self.outer.used(uses::FRAME, self.row.name, self.call.span);
        let count = self.outer.arguments.len() - self.call.mark;
        let vectors: Option<Vec<Vector>> = (0..count).map(|index| self.argument(index)).collect();
        let Some(vectors) = vectors else { return Value::Unknown };
        let len = vectors.iter().map(|vector| vector.len()).max().unwrap_or(1);
        if !sizes_fit(&vectors) || (self.kind == MotionKind::Since && len > 1) {
            let message = format!("`{}` needs one number, or vectors of the same size", self.row.name);
            let hint = format!("it is declared as `{}`", self.row.signature());
            return self.outer.reports.add(Diagnostic::new(self.call.span, message).hint(hint));
        }
        let moving = (0..len).map(|index| {
            let given: Vec<NodeId> = vectors.iter().map(|vector| vector.part(index)).collect();
            self.moving(&given)
        });
        let moving: Option<Vec<NodeId>> = moving.collect();
        moving.map_or(Value::Unknown, |parts| Value::of(&parts))
    }

    /// Returns an argument, which must be known for earlier moments.
    fn argument(&mut self, index: usize) -> Option<Vector> {
        let place = self.outer.argument_span(self.call, index);
        let value = self.outer.arguments.get(self.call.mark + index).copied().unwrap_or(Value::Unknown);
        let vector = match value {
            Value::Bool(event) if self.kind == MotionKind::Since => Vector::scalar(event),
            value => self.outer.number(value, place, || format!("`{}`", self.row.name))?,
        };
        let graph = &self.outer.graph;
        if let Some(what) = vector.parts().iter().find_map(|part| graph.not_remembered(*part)) {
            let message = format!("`{}` remembers numbers of the sound, not {what}", self.row.name);
            let hint = "it takes numbers, levels and parts of the sound, the time and parameters: `band(i)` \
                        instead of `spectrum(u)`";
            return self.outer.reports.refuse(Diagnostic::new(place, message).hint(hint));
        }
        Some(vector)
    }

    /// Returns the number that moves by these operands; missing ones have their defaults.
    fn moving(&mut self, given: &[NodeId]) -> Option<NodeId> {
        let goal = *given.first()?;
        if self.outer.known(goal).is_some() && self.kind != MotionKind::Since {
            return Some(goal);
        }
        let bounds = self.outer.graph.bounds(goal, [Interval::ANY; 6], &self.outer.any_frame());
        let graph = &mut self.outer.graph;
        let a = given.get(1).copied().unwrap_or(goal);
        let b = given.get(2).copied().unwrap_or_else(|| match self.kind {
            // The least damping without an overshoot.
            MotionKind::Spring => graph.add(Op::Sqrt.of(a), Op::Sqrt.of(a)),
            MotionKind::Follow | MotionKind::Since => a,
        });
        let width = bounds.hi - bounds.lo;
        let range = match self.kind {
            MotionKind::Follow => bounds,
            // It overshoots by at most the width of its goal's range.
            MotionKind::Spring => Interval { lo: bounds.lo - width, hi: bounds.hi + width },
            MotionKind::Since => Interval { lo: 0.0, hi: MOTION_SECONDS },
        };
        let value = graph.motion(Motion { kind: self.kind, operands: [goal, a, b], range });
        let max = self.outer.limits.scene_motions_max;
        if graph.motions().len() > max {
            let message = format!("the scene has more than {max} numbers with inertia");
            let hint = "let several things follow the same number";
            return self.outer.reports.refuse(Diagnostic::over_limit(self.call.span, message).hint(hint));
        }
        Some(value)
    }
}
