//! Finds loops in an unrolled expression, so that compiled GLSL has a loop instead of a copy for each round.
//!
//! The scene language and GLSL functions are lowered round by round. In the order of their creation, the nodes of a
//! round are followed by equal nodes of the next round, whose operands are shifted by the same number of places. The
//! search finds such runs for any text, without help from the language. Rounds are as long as the distance between two
//! places whose next operators are the same, so few lengths are tried.
//!
//! **Early ends.** With `break` or `while`, a condition chooses between the old and the new content of each variable.
//! Once the condition is true, it stays true. If no variable changes from then on, the loop ends when the condition
//! becomes true, and the choices inside the loop are removed.

use std::cell::Cell;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap, HashMap};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::ops::Range;

use crate::graph::{FrameInputs, Graph, Node, NodeId, Op, Properties};

/// Shorter runs stay unrolled: the loop must save this number of nodes.
const SAVED_MIN: usize = 48;
/// Longest list of nodes that is searched.
const NODES_MAX: usize = 1 << 18;
/// The number of operators by which places are compared to find the lengths of rounds.
const WINDOW: usize = 8;
/// The number of lengths that are tried.
const LENGTHS_MAX: usize = 64;
/// The number of nodes that are read to find the starts of all loops.
const READ_MAX: usize = 1 << 26;
/// The most numbers of a loop in lists, which are arrays in shaders.
const LISTED_MAX: usize = 4096;
/// Whole numbers up to this size and their sums are exact.
const WHOLE_MAX: f32 = (1 << 20) as f32;

/// The source of an operand in a round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Source {
    /// The value at this offset in the same round.
    Here(usize),
    /// The value at this offset in the round before.
    Before(usize),
    /// A value from before the loop, the same in all rounds.
    Fixed(NodeId),
    /// A number, the same in all rounds.
    Known(f32),
    /// The whole number `first + step * round`.
    Counted { first: f32, step: f32 },
    /// The number of the round in this one of [`Rounds::lists`].
    Listed(usize),
}

/// How a round computes a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Formula {
    /// The second operand repeats the first one for a one-operand operator.
    Operation(Op, [Source; 2]),
    /// The value equals another one.
    Copy(Source),
}

/// A value of each round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step {
    /// The node in the first round.
    pub(super) id: NodeId,
    /// The node in the last round, which nodes after the loop read.
    pub(super) last: NodeId,
    /// The node in the round before the first one, which gives the first value.
    pub(super) before: NodeId,
    pub(super) formula: Formula,
    /// True if the loop has a statement for the value.
    pub(super) is_computed: bool,
    /// True if the next round or a node after the loop reads the value.
    pub(super) is_kept: bool,
}

/// A loop.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Rounds {
    /// Places of its nodes in [`Unrolled::order`].
    pub(super) places: Range<usize>,
    pub(super) count: usize,
    /// The values of a round, in the order of their computation.
    pub(super) steps: Vec<Step>,
    /// Numbers that differ from round to round, each list with a number for each round.
    pub(super) lists: Vec<Vec<f32>>,
    /// True if the loop ends when the last value of a round is not 0.
    pub(super) ends_early: bool,
}

/// The nodes of an expression in the order of their creation.
pub(super) struct Unrolled<'a> {
    graph: &'a Graph,
    /// All nodes except constants and inputs.
    pub(super) order: Vec<NodeId>,
    /// Places in `order`, by the nodes' positions in the graph.
    places: Vec<Option<usize>>,
    /// For each node, the index of its last reader in `order`; for results, the length of `order`.
    last_reader: Vec<usize>,
    /// True for nodes that are always 0 or 1: truths, and the least and greatest of truths.
    truths: Vec<bool>,
    /// The number of nodes that may still be read to find the starts of loops.
    unread: Cell<usize>,
}

/// Places `first..end` whose nodes do the same as the nodes that are `length` places later.
#[derive(Debug, Clone, Copy)]
struct Repetition {
    first: usize,
    end: usize,
    length: usize,
}

impl Repetition {
    /// The number of whole rounds from a place on.
    fn rounds_from(&self, start: usize) -> usize {
        (self.end + self.length).saturating_sub(start) / self.length
    }

    fn saves(&self) -> usize {
        self.rounds_from(self.first.max(self.length)).saturating_sub(1) * self.length
    }

    /// All nodes of the run.
    fn places(&self) -> Range<usize> {
        self.first..self.end + self.length
    }

    /// The part of the run in a range of places, if it is long enough for a loop.
    fn within(&self, places: Range<usize>) -> Option<Self> {
        let (first, end) = (self.first.max(places.start), (self.end + self.length).min(places.end));
        let part = Self { first, end: end.checked_sub(self.length)?, length: self.length };
        (part.first < part.end && part.saves() >= SAVED_MIN).then_some(part)
    }

    /// Places at which the loop may start: a round precedes it.
    fn starts(&self) -> Range<usize> {
        let first = self.first.max(self.length);
        first..first + self.length + 1
    }
}

impl<'a> Unrolled<'a> {
    /// `needed` holds the nodes that `roots` need, in any order.
    pub(super) fn new(graph: &'a Graph, needed: &[NodeId], roots: &[NodeId]) -> Self {
        let computed = |id: &NodeId| !matches!(graph.node(*id), Node::Constant(_) | Node::Input(_));
        let mut order: Vec<NodeId> = needed.iter().copied().filter(computed).collect();
        order.sort_unstable();
        let mut unrolled = Self {
            graph,
            places: vec![None; graph.len()],
            last_reader: (0..order.len()).collect(),
            truths: vec![false; order.len()],
            order,
            unread: Cell::new(READ_MAX),
        };
        for (place, id) in unrolled.order.iter().enumerate() {
            unrolled.places[id.index()] = Some(place);
        }
        for place in 0..unrolled.order.len() {
            unrolled.truths[place] = match graph.node(unrolled.order[place]) {
                Node::Binary(Op::Min | Op::Max, a, b) => unrolled.is_truth(a) && unrolled.is_truth(b),
                Node::Unary(op, _) | Node::Binary(op, ..) => op.properties().has(Properties::TRUTH),
                _ => false,
            };
            for operand in graph.node(unrolled.order[place]).operands() {
                if let Some(of) = unrolled.place(operand) {
                    unrolled.last_reader[of] = place;
                }
            }
        }
        for root in roots {
            if let Some(place) = unrolled.place(*root) {
                unrolled.last_reader[place] = unrolled.order.len();
            }
        }
        unrolled
    }

    fn place(&self, id: NodeId) -> Option<usize> {
        self.places.get(id.index()).copied().flatten()
    }

    /// Returns the loops, in order. If runs overlap, the run that saves most nodes becomes a loop.
    pub(super) fn loops(&self) -> Vec<Rounds> {
        let ranked = |run: Repetition| (run.saves(), Reverse(run.length), Reverse(run.first), run.end);
        let mut runs: BinaryHeap<_> = self.runs().into_iter().map(ranked).collect();
        let mut found: BTreeMap<usize, Rounds> = BTreeMap::new();
        while let Some((_, Reverse(length), Reverse(first), end)) = runs.pop() {
            let run = Repetition { first, end, length };
            let places = run.places();
            let before = found.range(..places.end).next_back().map(|(_, rounds)| rounds.places.clone());
            if let Some(other) = before.filter(|other| other.end > places.start) {
                let rest = [places.start..other.start.max(places.start), other.end..places.end];
                runs.extend(rest.into_iter().filter_map(|part| run.within(part)).map(ranked));
            } else if let Some(rounds) = self.with_early_end(run).or_else(|| self.without_early_end(run)) {
                found.insert(rounds.places.start, rounds);
            }
        }
        found.into_values().collect()
    }

    /// Returns the longest runs of each likely length of rounds that are long enough for a loop.
    fn runs(&self) -> Vec<Repetition> {
        let mut runs = Vec::new();
        for length in self.lengths() {
            let mut first = 0;
            for place in 0..=self.order.len() - length {
                if place + length < self.order.len() && self.repeats(place, length) {
                    continue;
                }
                let run = Repetition { first, end: place, length };
                runs.extend(Some(run).filter(|run| run.first < run.end && run.saves() >= SAVED_MIN));
                first = place + 1;
            }
        }
        runs
    }

    /// Returns likely lengths of rounds: distances between the nearest places whose next operators are the same.
    fn lengths(&self) -> Vec<usize> {
        if self.order.len() > NODES_MAX {
            return Vec::new();
        }
        let is_number = |id: NodeId| self.graph.as_constant(id).is_some();
        let signs = self.order.iter().map(|id| match self.graph.node(*id) {
            Node::Unary(op, _) => (Some(op), false, false),
            Node::Binary(op, a, b) => (Some(op), is_number(a), is_number(b)),
            _ => (None, false, false),
        });
        let signs: Vec<_> = signs.collect();
        let mut latest = HashMap::new();
        let mut weights: HashMap<usize, usize> = HashMap::new();
        for (place, window) in signs.windows(WINDOW).enumerate() {
            let mut hasher = DefaultHasher::new();
            window.hash(&mut hasher);
            if let Some(before) = latest.insert(hasher.finish(), place) {
                *weights.entry(place - before).or_default() += place - before;
            }
        }
        let mut ranked: Vec<_> = weights.into_iter().filter(|(length, _)| *length > 1).collect();
        ranked.sort_unstable_by_key(|(length, weight)| (Reverse(*weight), *length));
        ranked.into_iter().take(LENGTHS_MAX).map(|(length, _)| length).collect()
    }

    /// True if the node that is `length` places later does the same.
    fn repeats(&self, place: usize, length: usize) -> bool {
        let [here, later] = [place, place + length].map(|place| self.graph.node(self.order[place]));
        match (here, later) {
            (Node::Unary(op, a), Node::Unary(other, b)) => op == other && self.is_shifted(a, b, length),
            (Node::Binary(op, a, b), Node::Binary(other, c, d)) => {
                op == other && self.is_shifted(a, c, length) && self.is_shifted(b, d, length)
            }
            _ => false,
        }
    }

    fn is_shifted(&self, here: NodeId, later: NodeId, length: usize) -> bool {
        let is_number = |id: NodeId| self.graph.as_constant(id).is_some();
        let shifted = self.place(here).map(|place| place + length);
        here == later
            || is_number(here) && is_number(later)
            || shifted.is_some() && shifted == self.place(later)
    }

    /// Returns the loop of a run whose rounds begin at `start`. The round before `start` stays outside.
    fn rounds(&self, run: Repetition, start: usize) -> Option<Rounds> {
        let (length, count) = (run.length, run.rounds_from(start));
        let places = start..start + count * length;
        if count < 2 || (count - 1) * length < SAVED_MIN {
            return None;
        }
        let last = places.end - length;
        let mut lists = Vec::new();
        let step = |offset: usize| {
            self.unread.set(self.unread.get().checked_sub(count)?);
            let id = self.order[start + offset];
            let (op, is_unary) = match self.graph.node(id) {
                Node::Unary(op, _) => (op, true),
                Node::Binary(op, ..) => (op, false),
                _ => return None,
            };
            let first = self.source(start, offset, 0, length, count, &mut lists)?;
            let second =
                if is_unary { first } else { self.source(start, offset, 1, length, count, &mut lists)? };
            Some(Step {
                id,
                last: self.order[last + offset],
                before: self.order[start + offset - length],
                formula: Formula::Operation(op, [first, second]),
                is_computed: true,
                is_kept: self.last_reader[last + offset] >= places.end,
            })
        };
        let steps: Option<Vec<Step>> = (0..length).map(step).collect();
        // Nodes after the loop can only read the last round.
        let is_hidden = |place: usize| self.last_reader[place] < places.end;
        let steps = steps?;
        (start..last).all(is_hidden).then_some(Rounds { steps, lists, places, count, ends_early: false })
    }

    /// Returns the source of an operand if all rounds have the same one. The round before the loop may read other
    /// values from the round before itself.
    fn source(
        &self,
        start: usize,
        offset: usize,
        operand: usize,
        length: usize,
        count: usize,
        lists: &mut Vec<Vec<f32>>,
    ) -> Option<Source> {
        let node = |round: usize| {
            // Round 0 precedes the loop.
            self.graph.node(self.order[start - length + round * length + offset]).operands().nth(operand)
        };
        let (first, second) = (node(1)?, node(2)?);
        let number = |round: usize| self.graph.as_constant(node(round)?);
        if let Some(value) = number(1) {
            if (0..=count).all(|round| node(round) == Some(first)) {
                return Some(Source::Known(value));
            }
            let step = number(2)? - value;
            let counts = |round: usize| number(round) == Some(value + step * (round as f32 - 1.0));
            let is_whole = |value: f32| value.trunc() == value && value.abs() < WHOLE_MAX;
            if (1..=count).all(counts) && is_whole(value) && is_whole(step) {
                return Some(Source::Counted { first: value, step });
            }
            let list = (1..=count).map(number).collect::<Option<Vec<f32>>>()?;
            let known = lists.iter().position(|known| *known == list);
            if known.is_none() && (lists.len() + 1) * count > LISTED_MAX {
                return None;
            }
            return Some(Source::Listed(known.unwrap_or_else(|| {
                lists.push(list);
                lists.len() - 1
            })));
        }
        if first == second {
            let is_before = self.place(first).is_none_or(|place| place < start);
            let is_fixed = is_before && (0..=count).all(|round| node(round) == Some(first));
            return is_fixed.then_some(Source::Fixed(first));
        }
        let place = self.place(first)?;
        let shifts = |round: usize| {
            node(round).and_then(|id| self.place(id)) == (place + round * length).checked_sub(length)
        };
        if !(1..=count).all(shifts) {
            return None;
        }
        match place.checked_sub(start) {
            Some(offset) => shifts(0).then_some(Source::Here(offset)),
            None => Some(Source::Before((place + length).checked_sub(start)?)),
        }
    }

    /// True if a node is always 0 or 1.
    fn is_truth(&self, id: NodeId) -> bool {
        let known = |value| value == 0.0 || value == 1.0;
        self.place(id)
            .map_or_else(|| self.graph.as_constant(id).is_some_and(known), |place| self.truths[place])
    }

    fn without_early_end(&self, run: Repetition) -> Option<Rounds> {
        let mut rounds = run.starts().find_map(|start| self.rounds(run, start))?;
        rounds.keep_what_is_read();
        Some(rounds)
    }

    /// Returns the loop of a run that ends by a condition. Its rounds start after the condition.
    fn with_early_end(&self, run: Repetition) -> Option<Rounds> {
        let follows_condition = |start: &usize| {
            let before = self.order[start - 1];
            matches!(self.graph.node(before), Node::Binary(Op::Max, ..)) && self.is_truth(before)
        };
        run.starts().filter(follows_condition).find_map(|start| {
            let rounds = self.rounds(run, start)?;
            let ended = rounds.settled(self.graph, 1.0);
            let mut rounds = rounds.simplified(self.graph);
            rounds.keep_what_is_read();
            let mut steps = rounds.steps.iter().zip(&ended);
            steps.all(|(step, ended)| !step.is_kept || ended.stays).then_some(rounds)
        })
    }
}

/// Knowledge about a value in a round, if the loop is known to have ended or not.
#[derive(Debug, Clone, Copy)]
struct Settled {
    /// An equal value or number, if one is known.
    is: Option<Source>,
    /// True if the value does not change from the round before.
    stays: bool,
}

impl Rounds {
    /// The offset of the condition that ends a loop.
    fn condition(&self) -> usize {
        self.steps.len().saturating_sub(1)
    }

    /// Replaces a source by an equal one, if the loop has ended (1) or not (0) before this round.
    fn resolved(&self, source: Source, settled: &[Settled], ended: f32) -> Source {
        match source {
            Source::Here(offset) => settled.get(offset).and_then(|known| known.is).unwrap_or(source),
            Source::Before(offset) if offset == self.condition() => Source::Known(ended),
            _ => source,
        }
    }

    /// Finds an equal value or number for each value of a round.
    fn settled(&self, graph: &Graph, ended: f32) -> Vec<Settled> {
        let mut settled: Vec<Settled> = Vec::with_capacity(self.steps.len());
        for (offset, step) in self.steps.iter().enumerate() {
            let Formula::Operation(op, operands) = step.formula else { break };
            let [a, b] = operands.map(|source| self.resolved(source, &settled, ended));
            let is_truth = |source: Source| self.is_truth(graph, source);
            let is = match (op, a, b) {
                (_, Source::Known(a), Source::Known(b)) if !op.properties().has(Properties::READS_FRAME) => {
                    Some(Source::Known(op.value(a, b, &FrameInputs::default())))
                }
                (Op::Mask, Source::Known(condition), b) => {
                    Some(if condition == 0.0 { Source::Known(0.0) } else { b })
                }
                (Op::Add, Source::Known(0.0), other) | (Op::Add | Op::Sub, other, Source::Known(0.0)) => {
                    Some(other)
                }
                (Op::Min | Op::Max, Source::Known(known), other)
                | (Op::Min | Op::Max, other, Source::Known(known))
                    if is_truth(Source::Known(known)) && is_truth(other) =>
                {
                    // One truth decides: 0 a minimum, 1 a maximum.
                    let decides = (known == 1.0) == (op == Op::Max);
                    Some(if decides { Source::Known(f32::from(op == Op::Max)) } else { other })
                }
                _ => None,
            };
            let operand_stays = |source: &Source| match source {
                Source::Here(of) => settled.get(*of).is_some_and(|of| of.stays),
                Source::Fixed(_) | Source::Known(_) => true,
                Source::Before(_) | Source::Counted { .. } | Source::Listed(_) => false,
            };
            let is_itself = is == Some(Source::Before(offset));
            let is_condition = offset == self.condition() && is == Some(Source::Known(ended));
            let stays = is_itself || is_condition || operands.iter().all(operand_stays);
            settled.push(Settled { is, stays });
        }
        settled
    }

    /// True if a value is always 0 or 1.
    fn is_truth(&self, graph: &Graph, source: Source) -> bool {
        let gives_truth = |op: Op| op.properties().has(Properties::TRUTH);
        match source {
            Source::Known(number) => number == 0.0 || number == 1.0,
            Source::Before(offset) if offset == self.condition() => true,
            Source::Here(offset) => match self.steps.get(offset).map(|step| step.formula) {
                Some(Formula::Operation(Op::Min | Op::Max, operands)) => {
                    operands.iter().all(|operand| self.is_truth(graph, *operand))
                }
                Some(Formula::Operation(op, _)) => gives_truth(op),
                _ => false,
            },
            Source::Fixed(id) => match graph.node(id) {
                Node::Unary(op, _) | Node::Binary(op, ..) => gives_truth(op),
                _ => false,
            },
            Source::Before(_) | Source::Counted { .. } | Source::Listed(_) => false,
        }
    }

    /// Returns a loop that tests its end before each round. Within a round, the loop has not ended.
    fn simplified(&self, graph: &Graph) -> Self {
        let settled = self.settled(graph, 0.0);
        let mut simpler = Self { ends_early: true, ..self.clone() };
        for (step, known) in simpler.steps.iter_mut().zip(&settled) {
            step.formula = match (step.formula, known.is) {
                (_, Some(source)) => Formula::Copy(source),
                (Formula::Operation(op, operands), None) => {
                    Formula::Operation(op, operands.map(|source| self.resolved(source, &settled, 0.0)))
                }
                (copy, None) => copy,
            };
        }
        simpler
    }

    /// Marks the values that the loop computes, and those that it keeps for the next round.
    fn keep_what_is_read(&mut self) {
        let condition = self.condition();
        for (offset, step) in self.steps.iter_mut().enumerate() {
            step.is_kept |= self.ends_early && offset == condition;
            step.is_computed = false;
        }
        let mut open: Vec<usize> =
            (0..self.steps.len()).filter(|offset| self.steps[*offset].is_kept).collect();
        while let Some(offset) = open.pop() {
            if std::mem::replace(&mut self.steps[offset].is_computed, true) {
                continue;
            }
            let sources = match self.steps[offset].formula {
                Formula::Operation(_, operands) => operands,
                Formula::Copy(source) => [source; 2],
            };
            for source in sources {
                match source {
                    Source::Here(of) => open.push(of),
                    Source::Before(of) => {
                        self.steps[of].is_kept = true;
                        open.push(of);
                    }
                    _ => {}
                }
            }
        }
    }
}
