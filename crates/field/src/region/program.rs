//! A list of steps: what a tape is before it has registers. Pruning makes shorter ones of it.

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

/// Which of a step's arguments is its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Form {
    /// None: both are values.
    Values,
    /// The second.
    NumberRight,
    /// The first.
    NumberLeft,
}

/// An operator on one or two arguments of which one is a value at least. Flat, so that loops over steps rarely branch: in
/// the place of what is no value or not there stands the other value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step {
    pub(super) op: Op,
    pub(super) form: Form,
    pub(super) a: u32,
    pub(super) b: u32,
    pub(super) number: f32,
}

impl Step {
    /// None if both arguments are numbers.
    fn new(op: Op, a: Arg, b: Arg) -> Option<Self> {
        Some(match (a, b) {
            (Arg::Value(a), _) if op.arity() == 1 => Self { op, form: Form::Values, a, b: a, number: 0.0 },
            (Arg::Value(a), Arg::Value(b)) => Self { op, form: Form::Values, a, b, number: 0.0 },
            (Arg::Value(a), Arg::Number(number)) => Self { op, form: Form::NumberRight, a, b: a, number },
            (Arg::Number(number), Arg::Value(b)) => Self { op, form: Form::NumberLeft, a: b, b, number },
            (Arg::Number(_), Arg::Number(_)) => return None,
        })
    }

    /// The first argument.
    #[inline(always)]
    pub(super) fn first(&self) -> Arg {
        if self.form == Form::NumberLeft { Arg::Number(self.number) } else { Arg::Value(self.a) }
    }

    /// The second argument; that of an operator that has one is the same as the first.
    #[inline(always)]
    pub(super) fn second(&self) -> Arg {
        if self.form == Form::NumberRight { Arg::Number(self.number) } else { Arg::Value(self.b) }
    }
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
            // Of one operand.
            (_, Arg::Value(_), _) if op.arity() == 1 => {}
            (_, Number(a), Number(b)) => {
                let value = op.value(a, b, frame);
                return Number(if value.is_nan() { f32::NAN } else { value + 0.0 });
            }
            (Op::Add | Op::Sub, a, Number(0.0)) | (Op::Mul | Op::Div, a, Number(1.0)) => return a,
            (Op::Add, Number(0.0), b) | (Op::Mul, Number(1.0), b) => return b,
            (Op::Sub, Number(0.0), Arg::Value(value)) => {
                // 0 - (0 - x) is x.
                if let Some(Step { op: Op::Sub, form: Form::NumberLeft, b, number: 0.0, .. }) =
                    self.step(value)
                {
                    return Arg::Value(b);
                }
            }
            (Op::SquareAdd, Number(0.0), b) => return b,
            (Op::OutsideAdd, Number(inside), b) if inside <= 0.0 => return b,
            (Op::Mask, Number(condition), b) => return if condition == 0.0 { Number(0.0) } else { b },
            _ => {}
        }
        // The forms of a clause take a number on either side; one on the right is common.
        let (a, b) = match (a, b) {
            (Number(_), Arg::Value(_)) if op.properties().has(Properties::COMMUTATIVE) => (b, a),
            both => both,
        };
        match Step::new(op, a, b) {
            Some(step) => self.push_step(step),
            None => Number(f32::NAN),
        }
    }

    /// Appends a step as it is.
    #[inline(always)]
    pub(super) fn push_step(&mut self, step: Step) -> Arg {
        self.steps.push(step);
        Arg::Value((INPUTS + self.steps.len() - 1) as u32)
    }

    /// A number that programs share with no others, but for one in 2^64.
    pub(super) fn hash(&self) -> u64 {
        const FACTORS: [u64; 3] = [0x9E37_79B9_7F4A_7C15, 0xBF58_476D_1CE4_E5B9, 0x94D0_49BB_1331_11EB];
        // Both words are mixed beside the chain, which has one product for a step.
        let mix = |hash: u64, first: u64, second: u64| {
            let words = first.wrapping_mul(FACTORS[0]) ^ second.wrapping_mul(FACTORS[1]).rotate_left(32);
            (hash ^ words).wrapping_mul(FACTORS[2]).rotate_left(23)
        };
        let steps = self.steps.iter().fold(0, |hash, step| {
            let number = u64::from(step.number.to_bits()) << 32;
            let operator = u64::from(step.op.number()) | (step.form as u64) << 8;
            mix(hash, u64::from(step.a) | u64::from(step.b) << 32, number | operator)
        });
        let hash = self.roots.iter().fold(steps, |hash, root| match root {
            Arg::Value(value) => mix(hash, u64::from(*value), 1),
            Arg::Number(number) => mix(hash, u64::from(number.to_bits()), 2),
        });
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
    /// By value: how many steps read it, and the last that does.
    uses: Vec<u8>,
    reader: Vec<u32>,
}

impl Structure {
    /// Looks at a program.
    pub(super) fn look_at(&mut self, program: &Program) {
        let count = program.values();
        refill(&mut self.uses, count, 0u8);
        refill(&mut self.reader, count, u32::MAX);
        refill(&mut self.may_settle, count, false);
        for (index, step) in program.steps.iter().enumerate() {
            let at = INPUTS + index;
            let (a, b) = (step.a as usize, step.b as usize);
            self.may_settle[at] = settles(step.op) | self.may_settle[a] | self.may_settle[b];
            // Where both are the same value, minima and maxima have no second reader.
            self.uses[a] = self.uses[a].saturating_add(1);
            self.uses[b] = self.uses[b].saturating_add(u8::from(a != b));
            self.reader[a] = at as u32;
            self.reader[b] = at as u32;
        }
        for root in program.roots {
            if let Arg::Value(value) = root {
                self.uses[value as usize] = u8::MAX;
            }
        }
        self.outermost.clear();
        self.outermost.extend(0..count as u32);
        for (index, step) in program.steps.iter().enumerate().rev() {
            let at = INPUTS + index;
            if !matches!(step.op, Op::Min | Op::Max) || self.uses[at] != 1 {
                continue;
            }
            let reader = self.reader[at] as usize;
            if program.steps.get(reader - INPUTS).is_some_and(|reader| reader.op == step.op) {
                self.outermost[at] = self.outermost[reader];
            }
        }
    }
}

/// Makes a list of so many equal elements, in the memory it has.
pub(super) fn refill<T: Clone>(list: &mut Vec<T>, count: usize, element: T) {
    list.clear();
    list.resize(count, element);
}

/// Whether an operator can be one number all over a cell without its operands being so.
fn settles(op: Op) -> bool {
    use Op::{Ceil, Floor, Fract, Mask, Max, Min, Mod, OutsideAdd, Round, Sign, Trunc};
    let steps = matches!(op, Floor | Ceil | Round | Trunc | Sign | Fract | Mod);
    let choices = matches!(op, Min | Max | Mask | OutsideAdd);
    steps
        || choices
        || op.properties().has(Properties::TRUTH)
        || op.properties().has(Properties::READS_FRAME)
        || matches!(op, Op::Hash)
}
