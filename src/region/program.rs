//! A list of steps: what a tape is before it has slots. Pruning makes shorter ones of it.

use crate::graph::{FrameInputs, Op, Properties};

/// Values that are there before the first step: x, y, z and the penumbra.
pub(super) const INPUTS: usize = 4;
/// The number of the last of them.
pub(super) const PENUMBRA: u32 = 3;

/// What a step reads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Arg {
    /// The value with this number: an input of the point below [`INPUTS`], else a step.
    Value(u32),
    /// A number that is the same wherever the program runs.
    Number(f32),
}

/// An operator on two arguments; the second is 0 where the operator has one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step {
    pub(super) op: Op,
    pub(super) a: Arg,
    pub(super) b: Arg,
}

/// What a program gives.
pub(super) const BOUND: usize = 0;
pub(super) const ESTIMATE: usize = 1;
pub(super) const OBJECT: usize = 2;

/// Steps, each reading only what stands before it, and what they give: bound, estimate and object.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Program {
    pub(super) steps: Vec<Step>,
    pub(super) roots: [Arg; 3],
}

impl Default for Program {
    fn default() -> Self {
        Self { steps: Vec::new(), roots: [Arg::Number(0.0); 3] }
    }
}

impl Program {
    /// Appends a step and says where its value is found. What is exact in floating point is done at once.
    #[inline]
    pub(super) fn push(&mut self, op: Op, a: Arg, b: Arg, frame: &FrameInputs) -> Arg {
        use Arg::Number;
        let b = if op.arity() == 1 { Number(0.0) } else { b };
        match (op, a, b) {
            (_, Number(a), Number(b)) => {
                let value = op.value(a, b, frame);
                return Number(if value.is_nan() { f32::NAN } else { value + 0.0 });
            }
            (Op::Add | Op::Sub, a, Number(0.0)) | (Op::Mul | Op::Div, a, Number(1.0)) => return a,
            (Op::Add, Number(0.0), b) | (Op::Mul, Number(1.0), b) => return b,
            (Op::Sub, Number(0.0), Arg::Value(value)) => {
                // 0 - (0 - x) is x.
                if let Some(Step { op: Op::Sub, a: Number(0.0), b }) = self.step(value) {
                    return b;
                }
            }
            (Op::Mask, Number(condition), b) => return if condition == 0.0 { Number(0.0) } else { b },
            _ => {}
        }
        // The forms of a clause take a number on either side; one on the right is common.
        let (a, b) = match (a, b) {
            (Number(_), Arg::Value(_)) if op.properties().has(Properties::COMMUTATIVE) => (b, a),
            both => both,
        };
        self.steps.push(Step { op, a, b });
        Arg::Value((INPUTS + self.steps.len() - 1) as u32)
    }

    /// A number that programs share with no others, but for one in 2^64.
    pub(super) fn hash(&self) -> u64 {
        let mix = |hash: u64, word: u64| (hash ^ word).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(23);
        let word = |arg: Arg| match arg {
            Arg::Value(value) => u64::from(value),
            Arg::Number(number) => u64::from(number.to_bits()) | 1 << 32,
        };
        let steps = self.steps.iter().fold(0, |hash, step| {
            mix(mix(hash, word(step.a) | u64::from(step.op.number()) << 40), word(step.b))
        });
        let hash = self.roots.iter().fold(steps, |hash, root| mix(hash, word(*root)));
        // The upper bits are the well mixed ones.
        hash ^ hash >> 29
    }

    /// The step that gives a value; none for an input.
    fn step(&self, value: u32) -> Option<Step> {
        self.steps.get((value as usize).checked_sub(INPUTS)?).copied()
    }

    /// Values there are: the inputs and those of the steps.
    pub(super) fn values(&self) -> usize {
        INPUTS + self.steps.len()
    }
}

/// For each step of a program what pruning asks again and again.
#[derive(Debug, Clone, Default)]
pub(super) struct Structure {
    /// For minima and maxima: the value whose bounds decide which operands count. A minimum that only another minimum
    /// reads has that one's, so that nested minima are pruned as one of many operands.
    pub(super) outermost: Vec<u32>,
    /// Whether the step may be a constant somewhere, or one of its arguments.
    pub(super) may_settle: Vec<bool>,
}

impl Structure {
    /// Looks at a program.
    pub(super) fn of(program: &Program) -> Self {
        let count = program.values();
        let mut uses = vec![0u8; count];
        let mut reader = vec![u32::MAX; count];
        let mut may_settle = vec![false; count];
        for (index, step) in program.steps.iter().enumerate() {
            let at = INPUTS + index;
            may_settle[at] = settles(step.op);
            for arg in [step.a, step.b] {
                if let Arg::Value(value) = arg {
                    let value = value as usize;
                    uses[value] = uses[value].saturating_add(1);
                    reader[value] = at as u32;
                    may_settle[at] |= may_settle[value];
                }
            }
        }
        for root in program.roots {
            if let Arg::Value(value) = root {
                uses[value as usize] = u8::MAX;
            }
        }
        let mut outermost: Vec<u32> = (0..count as u32).collect();
        for (index, step) in program.steps.iter().enumerate().rev() {
            let at = INPUTS + index;
            if !matches!(step.op, Op::Min | Op::Max) || uses[at] != 1 {
                continue;
            }
            let reader = reader[at] as usize;
            if program.steps.get(reader - INPUTS).is_some_and(|reader| reader.op == step.op) {
                outermost[at] = outermost[reader];
            }
        }
        Self { outermost, may_settle }
    }
}

/// Whether an operator can be one number all over a cell without its operands being so.
fn settles(op: Op) -> bool {
    use Op::{Ceil, Floor, Fract, Mask, Max, Min, Mod, Round, Sign, Trunc};
    let steps = matches!(op, Floor | Ceil | Round | Trunc | Sign | Fract | Mod);
    let choices = matches!(op, Min | Max | Mask);
    steps
        || choices
        || op.properties().has(Properties::TRUTH)
        || op.properties().has(Properties::READS_FRAME)
        || op == Op::Hash
}
