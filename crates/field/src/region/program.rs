//! A program: a list of steps, like a tape before register allocation. Pruning turns it into shorter programs.

pub(super) use crate::graph::Arg;
use crate::graph::{FrameInputs, Op, Operation, Properties};
use crate::limits::LIMITS;

/// Number of values before the first step of a distance: x, y, z and the penumbra.
pub(super) const INPUTS: usize = 4;

/// The smallest signalling NaN. No computation returns one.
const SIGNALLING: u32 = 0x7F80_0001;
/// Number of signalling NaNs of one sign.
const MARKS: usize = (1 << 22) - 1;
const _: () = assert!(LIMITS.graph_nodes_max < MARKS, "every number needs a mark");
/// The sign's bit of a number.
pub(super) const MARK_SIGN: u32 = 1 << 31;

/// Returns a mark: a number that each frame replaces by the value of the node at a position, with the mark's sign. No
/// simplification applies to a mark.
pub(super) fn mark(position: usize) -> f32 {
    f32::from_bits(SIGNALLING + position as u32)
}

/// Returns the position of a mark of either sign; `None` for other numbers.
#[inline]
pub(super) fn marked(number: f32) -> Option<usize> {
    let position = (number.to_bits() & !MARK_SIGN).wrapping_sub(SIGNALLING) as usize;
    (position < MARKS).then_some(position)
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Form {
    Values,
    NumberRight,
    NumberLeft,
}

/// An operator on one or two arguments, at least one of which is a value. The fields are flat so that loops over
/// steps rarely branch: a number or a missing argument is represented by a copy of the other value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step {
    pub(super) op: Op,
    pub(super) form: Form,
    pub(super) a: u32,
    pub(super) b: u32,
    pub(super) number: f32,
}

impl Step {
    fn new(op: Op, a: Arg, b: Arg) -> Option<Self> {
        Some(match (a, b) {
            (Arg::Value(a), _) if op.arity() == 1 => Self { op, form: Form::Values, a, b: a, number: 0.0 },
            (Arg::Value(a), Arg::Value(b)) => Self { op, form: Form::Values, a, b, number: 0.0 },
            (Arg::Value(a), Arg::Number(number)) => Self { op, form: Form::NumberRight, a, b: a, number },
            (Arg::Number(number), Arg::Value(b)) => Self { op, form: Form::NumberLeft, a: b, b, number },
            (Arg::Number(_), Arg::Number(_)) => return None,
        })
    }

    #[inline(always)]
    pub(super) fn first(&self) -> Arg {
        if self.form == Form::NumberLeft { Arg::Number(self.number) } else { Arg::Value(self.a) }
    }

    #[inline(always)]
    pub(super) fn operation(&self) -> Operation {
        Operation { op: self.op, a: self.first(), b: self.second() }
    }

    /// Returns the second argument. For a one-operand operator, it repeats the first argument.
    #[inline(always)]
    pub(super) fn second(&self) -> Arg {
        if self.form == Form::NumberRight { Arg::Number(self.number) } else { Arg::Value(self.b) }
    }
}

pub(super) const BOUND: usize = 0;
pub(super) const ESTIMATE: usize = 1;
pub(super) const OBJECT: usize = 2;

/// A list of steps, and their results. A step reads only earlier values. The results of a distance are bound, estimate
/// and object.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Program {
    pub(super) inputs: usize,
    /// Number of inputs that are in registers at the start. The other inputs are texture samples.
    pub(super) in_registers: usize,
    pub(super) steps: Vec<Step>,
    pub(super) roots: Vec<Arg>,
}

impl Default for Program {
    fn default() -> Self {
        Self { inputs: INPUTS, in_registers: INPUTS, steps: Vec::new(), roots: vec![Arg::Number(0.0); 3] }
    }
}

impl Program {
    /// Like [`Program::push`], but also simplifies 0 - (0 - x) to x. The program may then need one more register,
    /// because x stays in its register for longer.
    #[inline]
    pub(super) fn push_shorter(&mut self, op: Op, a: Arg, b: Arg, frame: &FrameInputs) -> Arg {
        if let (Op::Sub, Arg::Number(0.0), Arg::Value(value)) = (op, a, b)
            && let Some(Step { op: Op::Sub, form: Form::NumberLeft, b, number: 0.0, .. }) = self.step(value)
        {
            return Arg::Value(b);
        }
        self.push(op, a, b, frame)
    }

    /// Appends a step and returns its value. Applies simplifications that are exact in floating point. Simplifications
    /// never increase the number of registers, because known numbers take none.
    #[inline]
    pub(super) fn push(&mut self, op: Op, a: Arg, b: Arg, frame: &FrameInputs) -> Arg {
        use Arg::Number;
        let b = if op.arity() == 1 { Number(0.0) } else { b };
        match (op, a, b) {
            (_, Arg::Value(_), _) if op.arity() == 1 => {}
            // In all frames at once, the result is not a number. Its bounds do not depend on the operands.
            (_, Number(_), Number(_))
                if frame.ranges.is_some() && op.properties().has(Properties::READS_FRAME) =>
            {
                return self.push_step(Step { op, form: Form::Values, a: 0, b: 0, number: 0.0 });
            }
            (_, Number(a), Number(b)) => {
                let value = op.value(a, b, frame);
                return Number(if value.is_nan() { f32::NAN } else { value + 0.0 });
            }
            (Op::Add | Op::Sub, a, Number(0.0)) | (Op::Mul | Op::Div, a, Number(1.0)) => return a,
            (Op::Add, Number(0.0), b) | (Op::Mul, Number(1.0), b) => return b,
            (Op::SquareAdd, Number(0.0), b) => return b,
            (Op::OutsideAdd, Number(inside), b) if inside <= 0.0 => return b,
            (Op::Mask, Number(condition), b) if marked(condition).is_none() => {
                return if condition == 0.0 { Number(0.0) } else { b };
            }
            _ => {}
        }
        // A clause can have a number on either side. Put it on the right if the operator allows that.
        let (a, b) = match (a, b) {
            (Number(_), Arg::Value(_)) if op.properties().has(Properties::COMMUTATIVE) => (b, a),
            both => both,
        };
        match Step::new(op, a, b) {
            Some(step) => self.push_step(step),
            None => Number(f32::NAN),
        }
    }

    #[inline(always)]
    pub(super) fn push_step(&mut self, step: Step) -> Arg {
        self.steps.push(step);
        Arg::Value((self.inputs + self.steps.len() - 1) as u32)
    }

    /// Returns a hash of the program. Different programs have equal hashes with a probability of one in 2^64.
    pub(super) fn hash(&self) -> u64 {
        const FACTORS: [u64; 3] = [0x9E37_79B9_7F4A_7C15, 0xBF58_476D_1CE4_E5B9, 0x94D0_49BB_1331_11EB];
        // Mix words outside of the chain, so that the chain has one product per step.
        let mix = |hash: u64, first: u64, second: u64| {
            let words = first.wrapping_mul(FACTORS[0]) ^ second.wrapping_mul(FACTORS[1]).rotate_left(32);
            (hash ^ words).wrapping_mul(FACTORS[2]).rotate_left(23)
        };
        let with_step = |hash: u64, step: &Step| {
            let number = u64::from(step.number.to_bits()) << 32;
            let operator = u64::from(step.op.number()) | (step.form as u64) << 8;
            mix(hash, u64::from(step.a) | u64::from(step.b) << 32, number | operator)
        };
        // Use four chains: in a single chain the CPU would wait for each product.
        let (fours, rest) = self.steps.as_chunks::<4>();
        let mut chains = [0, 1, 2, 3];
        for four in fours {
            for (chain, step) in chains.iter_mut().zip(four) {
                *chain = with_step(*chain, step);
            }
        }
        let joined = chains.into_iter().fold(self.steps.len() as u64, |hash, chain| mix(hash, chain, 0));
        let steps = rest.iter().fold(joined, with_step);
        let hash = self.roots.iter().fold(steps, |hash, root| match root {
            Arg::Value(value) => mix(hash, u64::from(*value), 1),
            Arg::Number(number) => mix(hash, u64::from(number.to_bits()), 2),
        });
        // Use the upper bits, which are mixed best.
        hash ^ hash >> 29
    }

    #[inline]
    pub(super) fn step(&self, value: u32) -> Option<Step> {
        self.steps.get((value as usize).checked_sub(self.inputs)?).copied()
    }

    #[inline(always)]
    pub(super) fn op(&self, value: u32) -> Option<Op> {
        Some(self.steps.get((value as usize).checked_sub(self.inputs)?)?.op)
    }

    pub(super) fn values(&self) -> usize {
        self.inputs + self.steps.len()
    }
}

#[derive(Debug, Clone, Default)]
pub(super) struct Structure {
    /// For minima and maxima, the value whose bounds decide which operands are dropped. If only an outer minimum reads
    /// it, the outer one's bounds decide, so that nested minima are pruned like a single one.
    pub(super) outermost: Vec<u32>,
    /// True if the step may become a constant or one of its arguments in some cell.
    pub(super) may_settle: Vec<bool>,
    /// True if the value may be tiny in most of space, because it is an exponential or a multiple or a sum of some.
    pub(super) may_vanish: Vec<bool>,
    /// For each value, the number of steps that only this value needs, including its own step.
    weight: Vec<u16>,
    uses: Vec<u8>,
    reader: Vec<u32>,
}

impl Structure {
    /// True if little is saved when a step is replaced by one of its operands. `dropped` is the other operand. False
    /// for sums of outside distances: many small savings add up along their chains.
    pub(super) fn saves_little(&self, step: &Step, dropped: Arg) -> bool {
        let most = match step.op {
            Op::OutsideAdd | Op::Mask => return false,
            Op::Min | Op::Max => 2,
            _ => 1,
        };
        let saved = match dropped {
            Arg::Value(value) if step.op.arity() == 2 => self.weight[value as usize].saturating_add(1),
            _ => 1,
        };
        saved <= most
    }

    pub(super) fn analyse(&mut self, program: &Program) {
        let count = program.values();
        refill(&mut self.uses, count, 0u8);
        refill(&mut self.reader, count, u32::MAX);
        refill(&mut self.may_settle, count, false);
        refill(&mut self.may_vanish, count, false);
        for (index, step) in program.steps.iter().enumerate() {
            let at = program.inputs + index;
            let (a, b) = (step.a as usize, step.b as usize);
            self.may_settle[at] = settles(step.op) | self.may_settle[a] | self.may_settle[b];
            self.may_vanish[at] = match step.op {
                Op::Exp | Op::Exp2 | Op::Pow => true,
                Op::Add | Op::Sub | Op::Mul | Op::Neg => self.may_vanish[a] | self.may_vanish[b],
                Op::Div => self.may_vanish[a],
                _ => false,
            };
            // A step that reads a value twice counts as one reader.
            self.uses[a] = self.uses[a].saturating_add(1);
            self.uses[b] = self.uses[b].saturating_add(u8::from(a != b));
            self.reader[a] = at as u32;
            self.reader[b] = at as u32;
        }
        for root in &program.roots {
            if let Arg::Value(value) = root {
                self.uses[*value as usize] = u8::MAX;
            }
        }
        refill(&mut self.weight, count, 0u16);
        for (index, step) in program.steps.iter().enumerate() {
            let own =
                |value: u32| if self.uses[value as usize] == 1 { self.weight[value as usize] } else { 0 };
            let second = if step.a == step.b { 0 } else { own(step.b) };
            let steps = own(step.a).saturating_add(second).saturating_add(1);
            self.weight[program.inputs + index] = steps;
        }
        self.outermost.clear();
        self.outermost.extend(0..count as u32);
        for (index, step) in program.steps.iter().enumerate().rev() {
            let at = program.inputs + index;
            if !matches!(step.op, Op::Min | Op::Max) || self.uses[at] != 1 {
                continue;
            }
            let reader = self.reader[at] as usize;
            if program.steps.get(reader - program.inputs).is_some_and(|reader| reader.op == step.op) {
                self.outermost[at] = self.outermost[reader];
            }
        }
    }
}

pub(super) fn refill<T: Clone>(list: &mut Vec<T>, count: usize, element: T) {
    list.clear();
    list.resize(count, element);
}

/// True if an operator can be constant in a cell although its operands are not.
fn settles(op: Op) -> bool {
    use Op::{Ceil, Floor, Fract, Hash, Mask, Max, Min, Mod, OutsideAdd, Round, Sign, Trunc};
    let properties = op.properties();
    matches!(op, Floor | Ceil | Round | Trunc | Sign | Fract | Mod | Min | Max | Mask | OutsideAdd | Hash)
        || properties.has(Properties::TRUTH)
        || properties.has(Properties::READS_FRAME)
}
