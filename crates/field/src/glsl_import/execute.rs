//! Statements. Memory holds the values of the path that is being executed. Where paths meet, the parts that differ
//! are selected by the condition that separated the paths.

use std::collections::{BTreeMap, BTreeSet};

use naga::{BinaryOperator, Block, Expression, Function, Statement, SwitchValue};

use super::Result;
use super::calls::{Argument, Executor, Pointer, Target};
use super::layout::{ExprId, Part};
use super::parse::range;
use crate::graph::{Node, NodeId, Op};
use crate::lang::{Diagnostic, Span};

/// Number of rounds after which a loop of a picture ends whose rounds nothing counts.
pub(super) const ROUNDS_WITHOUT_COUNT: usize = 256;

/// The paths that left a loop, a switch or a function, merged into one.
#[derive(Debug)]
pub(super) struct Exits {
    /// Length of the trail when the loop, switch or function began.
    pub mark: usize,
    /// The condition under which a path left; `None` if none did.
    pub mask: Option<NodeId>,
    /// The values that the paths left in memory.
    pub changed: BTreeMap<u32, Part>,
}

impl Exits {
    pub(super) fn new(mark: usize) -> Self {
        Self { mark, mask: None, changed: BTreeMap::new() }
    }
}

impl<'m> Executor<'m, '_> {
    /// True where two conditions hold.
    pub(super) fn and(&mut self, a: NodeId, b: NodeId) -> NodeId {
        match (a, b) {
            _ if a == self.zero || b == self.zero => self.zero,
            _ if a == self.one => b,
            _ if b == self.one => a,
            _ => self.graph.min(a, b),
        }
    }

    /// True where one of two conditions holds.
    pub(super) fn or(&mut self, a: NodeId, b: NodeId) -> NodeId {
        match (a, b) {
            _ if a == self.one || b == self.one => self.one,
            _ if a == self.zero => b,
            _ if b == self.zero => a,
            _ => self.graph.max(a, b),
        }
    }

    /// Adds the current path to `exits`. Slots from `end` on do not matter after the exit.
    fn leave(&mut self, mut exits: Exits, end: usize, live: NodeId) -> Result<Exits> {
        let changes = self.memory.changes(exits.mark);
        self.step(changes.len())?;
        let slots: BTreeSet<u32> = changes.keys().chain(exits.changed.keys()).copied().collect();
        for slot in slots.into_iter().filter(|slot| (*slot as usize) < end) {
            let mut part = self.memory.at(slot);
            if exits.mask.is_some() {
                let before = changes.get(&slot).copied().unwrap_or(part);
                let earlier = exits.changed.get(&slot).copied().unwrap_or(before);
                part = self.select(live, part, earlier)?;
            }
            exits.changed.insert(slot, part);
        }
        exits.mask = Some(exits.mask.map_or(live, |mask| self.or(mask, live)));
        Ok(exits)
    }

    /// Leaves the innermost loop or `switch` where the code is live.
    fn leave_target(&mut self) -> Result<()> {
        if let Some(mut target) = self.frame.targets.pop() {
            target.breaks = self.leave(target.breaks, usize::MAX, self.live)?;
            self.frame.targets.push(target);
        }
        Ok(())
    }

    /// Ends the current path with the function's result.
    pub(super) fn leave_function(&mut self, result: Vec<Part>) -> Result<()> {
        self.step(result.len())?;
        let live = self.and(self.frame.outer, self.live);
        if self.frame.returns.mask.is_none() {
            self.frame.result = result;
        } else {
            let earlier = std::mem::take(&mut self.frame.result);
            for (now, before) in result.into_iter().zip(earlier) {
                let part = self.select(live, now, before)?;
                self.frame.result.push(part);
            }
        }
        let exits = std::mem::replace(&mut self.frame.returns, Exits::new(0));
        self.frame.returns = self.leave(exits, self.frame.base, live)?;
        self.frame.counts.returns += 1;
        self.live = self.zero;
        Ok(())
    }

    pub(super) fn block(&mut self, block: &'m Block) -> Result<()> {
        for (statement, span) in block.span_iter() {
            if self.live == self.zero {
                break;
            }
            let place = match statement {
                Statement::Call { result, .. } if range(*span).is_empty() => {
                    result.map_or(Span::default(), |result| self.place(result))
                }
                _ => self.file.written.source_range(range(*span)),
            };
            self.at(place, |this| this.statement(statement))?;
        }
        Ok(())
    }

    fn statement(&mut self, statement: &'m Statement) -> Result<()> {
        self.step(1)?;
        match statement {
            Statement::Emit(emitted) => {
                for expression in emitted.clone() {
                    self.evaluate(expression)?;
                }
            }
            Statement::Block(block) => self.block(block)?,
            Statement::If { condition, accept, reject } => self.branch(*condition, accept, reject)?,
            Statement::Switch { selector, cases } => self.switch(*selector, cases)?,
            Statement::Loop { body, continuing, break_if } => self.repeat(body, continuing, *break_if)?,
            Statement::Break => {
                self.leave_target()?;
                self.frame.counts.breaks += 1;
                self.live = self.zero;
            }
            Statement::Continue => {
                let mut targets = std::mem::take(&mut self.frame.targets);
                if let Some(target) = targets.iter_mut().rfind(|target| target.is_loop) {
                    let exits = std::mem::replace(&mut target.continues, Exits::new(0));
                    target.continues = self.leave(exits, usize::MAX, self.live)?;
                }
                self.frame.targets = targets;
                self.frame.counts.continues += 1;
                self.live = self.zero;
            }
            Statement::Return { value } => {
                let result = match value {
                    Some(value) => self.parts_of(*value)?,
                    None => Vec::new(),
                };
                self.leave_function(result)?;
            }
            Statement::Store { pointer, value } => {
                let pointer = self.pointer_of(*pointer)?;
                let parts = self.parts_of(*value)?;
                self.store(&pointer, &parts)?;
            }
            Statement::Call { function, arguments, result } => {
                let mut given = Vec::with_capacity(arguments.len());
                for argument in arguments {
                    given.push(self.argument(*argument)?);
                }
                let parts = self.call(*function, given)?;
                if let Some(result) = result {
                    self.put(*result, Argument::Parts(parts));
                }
            }
            Statement::Kill if self.session.in_picture => {
                // The rest runs, but the pixel stays black.
                let called = self.open.iter().flat_map(|(_, conditions)| *conditions);
                let conditions: Vec<NodeId> = called.chain([self.frame.outer, self.live]).collect();
                let condition = conditions.into_iter().fold(self.one, |all, one| self.and(all, one));
                self.discarded = self.or(self.discarded, condition);
            }
            Statement::Kill => {
                return Err(Diagnostic::unsupported(self.here, "`discard` has no meaning in a shape")
                    .hint("return a large distance instead"));
            }
            _ => {
                return Err(Diagnostic::unsupported(self.here, "this statement has no meaning in a formula"));
            }
        }
        Ok(())
    }

    /// Writes to memory. A computed index writes to every element, where the index selects it.
    fn store(&mut self, pointer: &Pointer, parts: &[Part]) -> Result<()> {
        self.step(parts.len())?;
        let Some((&(index, count, stride), rest)) = pointer.indices.split_last() else {
            for (slot, part) in (pointer.start..).zip(parts) {
                self.memory.store_part(slot, *part);
            }
            return Ok(());
        };
        for element in 0..count {
            let number = self.graph.constant(element as f32);
            let chosen = self.graph.binary(Op::Equal, index, number);
            if chosen == self.zero {
                continue;
            }
            let start = pointer.start + element * stride;
            let element = Pointer { start, len: pointer.len, indices: rest.to_vec() };
            let before = self.load(&element)?;
            let pairs = parts.iter().zip(before);
            let now = pairs.map(|(part, before)| self.select(chosen, *part, before));
            let now = now.collect::<Result<Vec<_>>>()?;
            self.store(&element, &now)?;
        }
        Ok(())
    }

    /// Reads memory. A computed index selects between all elements; outside the array it reads the first one.
    pub(super) fn load(&mut self, pointer: &Pointer) -> Result<Vec<Part>> {
        self.step(pointer.len as usize)?;
        let Some((&(index, count, stride), rest)) = pointer.indices.split_last() else {
            let (start, len) = (pointer.start as usize, pointer.len as usize);
            return Ok(self.memory.read(start..start + len));
        };
        self.chosen(index, count, |this, element| {
            let start = pointer.start + element * stride;
            this.load(&Pointer { start, len: pointer.len, indices: rest.to_vec() })
        })
    }

    fn branch(&mut self, of: ExprId, accept: &'m Block, reject: &'m Block) -> Result<()> {
        let condition = self.node_of(of, 0)?;
        if let Some(value) = self.graph.as_constant(condition) {
            let breaks = |block: &Block| matches!(block.first(), Some(Statement::Break));
            let counts = (breaks(accept) || breaks(reject)) && !is_literal(self.frame.function, of);
            if let Some(target) = self.frame.targets.last_mut() {
                target.is_counted |= counts;
            }
            return self.block(if value == 0.0 { reject } else { accept });
        }
        let before = self.live;
        let otherwise = self.graph.not(condition);
        let (when, unless) = (self.and(before, condition), self.and(before, otherwise));
        if when == self.zero {
            return self.block(reject);
        }
        if unless == self.zero {
            return self.block(accept);
        }
        let mark = self.memory.mark();
        self.live = when;
        self.block(accept)?;
        let live_when = self.live;
        let changed = self.memory.rewind_changes(mark);
        self.live = unless;
        self.block(reject)?;
        let live_unless = self.live;
        if live_when == self.zero {
            return Ok(());
        }
        if live_unless == self.zero {
            self.memory.undo(mark);
            self.memory.apply(changed);
            self.live = live_when;
            return Ok(());
        }
        let others = self.memory.changes(mark);
        self.step(changed.len() + others.len())?;
        let slots: BTreeSet<u32> = changed.keys().chain(others.keys()).copied().collect();
        for slot in slots {
            let now = self.memory.at(slot);
            let base = others.get(&slot).copied().unwrap_or(now);
            let then = changed.get(&slot).copied().unwrap_or(base);
            let part = self.select(condition, then, now)?;
            self.memory.store_part(slot, part);
        }
        let all_live = live_when == when && live_unless == unless;
        self.live = if all_live { before } else { self.or(live_when, live_unless) };
        Ok(())
    }

    fn repeat(&mut self, body: &'m Block, continuing: &'m Block, break_if: Option<ExprId>) -> Result<()> {
        let (before, outer, returns) = (self.live, self.frame.outer, self.frame.counts.returns);
        self.frame.outer = self.and(outer, before);
        self.live = self.one;
        let mark = self.memory.mark();
        self.frame.targets.push(Target::new(true, mark));
        let mut rounds = 0;
        while self.live != self.zero {
            rounds += 1;
            let is_counted = self.frame.targets.last().is_none_or(|target| target.is_counted);
            if rounds > ROUNDS_WITHOUT_COUNT && !is_counted && self.session.in_picture {
                self.session.cuts_loops = true;
                self.leave_target()?;
                break;
            }
            if rounds > self.budget.rounds_max {
                let max = self.budget.rounds_max;
                let message = format!("this loop does not end after {max} rounds");
                return Err(Diagnostic::over_limit(self.here, message)
                    .hint("give it a constant number of rounds, as in `for (int i = 0; i < 8; i++)`"));
            }
            self.step(1)?;
            self.memory.compact(mark);
            let start = self.memory.mark();
            if let Some(target) = self.frame.targets.last_mut() {
                target.continues = Exits::new(start);
            }
            let (live, counts) = (self.live, self.frame.counts);
            self.block(body)?;
            let continues = self.frame.targets.last_mut();
            let continues =
                continues.map(|target| std::mem::replace(&mut target.continues, Exits::new(mark)));
            if let Some(continues) = continues {
                self.meet(continues)?;
            }
            let now = self.frame.counts;
            if (now.returns, now.breaks) == (counts.returns, counts.breaks) {
                self.live = live;
            }
            if self.live == self.zero {
                break;
            }
            self.block(continuing)?;
            if let Some(condition) = break_if {
                let ends = self.node_of(condition, 0)?;
                let live = self.live;
                self.live = self.and(live, ends);
                if self.live != self.zero {
                    self.leave_target()?;
                }
                let goes_on = self.graph.not(ends);
                self.live = self.and(live, goes_on);
            }
        }
        let Some(target) = self.frame.targets.pop() else { return Ok(()) };
        self.frame.outer = outer;
        self.memory.undo(mark);
        self.live = match target.breaks.mask {
            None => self.zero,
            Some(_) if self.frame.counts.returns == returns => before,
            Some(mask) => self.and(before, mask),
        };
        self.memory.apply(target.breaks.changed);
        Ok(())
    }

    /// Merges the paths of `exits` into the current path.
    fn meet(&mut self, exits: Exits) -> Result<()> {
        let Some(mask) = exits.mask else { return Ok(()) };
        if self.live == self.zero {
            self.memory.undo(exits.mark);
            self.memory.apply(exits.changed);
            self.live = mask;
            return Ok(());
        }
        let live = self.live;
        let mark = exits.mark;
        let all = self.leave(exits, usize::MAX, live)?;
        self.memory.undo(mark);
        self.live = all.mask.unwrap_or(live);
        self.memory.apply(all.changed);
        Ok(())
    }

    fn switch(&mut self, selector: ExprId, cases: &'m [naga::SwitchCase]) -> Result<()> {
        let (place, selector) = (self.place(selector), self.part(selector, 0)?);
        let (before, counts) = (self.live, self.frame.counts);
        let mark = self.memory.mark();
        // The conditions of the cases. The default case takes what no other case takes.
        let mut conditions = Vec::with_capacity(cases.len());
        let mut otherwise = self.one;
        for case in cases {
            let value = match case.value {
                SwitchValue::I32(value) => Part::Int(value),
                SwitchValue::U32(value) => Part::Uint(value),
                SwitchValue::Default => {
                    conditions.push(None);
                    continue;
                }
            };
            let equal = self.at(place, |this| {
                this.whole_binary(BinaryOperator::Equal, selector, value).and_then(|part| this.node(part))
            })?;
            let unequal = self.graph.not(equal);
            otherwise = self.and(otherwise, unequal);
            conditions.push(Some(equal));
        }
        self.frame.targets.push(Target::new(false, mark));
        let mut falling = Exits::new(mark);
        for (case, condition) in cases.iter().zip(conditions) {
            let condition = condition.unwrap_or(otherwise);
            self.live = self.and(before, condition);
            let fallen = std::mem::replace(&mut falling, Exits::new(mark));
            self.meet(fallen)?;
            if self.live == self.zero {
                continue;
            }
            self.block(&case.body)?;
            if self.live != self.zero {
                let live = self.live;
                if case.fall_through {
                    falling = self.leave(falling, usize::MAX, live)?;
                } else {
                    self.leave_target()?;
                }
            }
            self.memory.undo(mark);
        }
        let Some(target) = self.frame.targets.pop() else { return Ok(()) };
        self.memory.undo(mark);
        let now = self.frame.counts;
        self.live = match target.breaks.mask {
            None => self.zero,
            // Only these statements may leave a switch for a place after its end.
            Some(_) if (now.returns, now.continues) == (counts.returns, counts.continues) => before,
            Some(mask) => mask,
        };
        self.memory.apply(target.breaks.changed);
        Ok(())
    }

    /// `then` where the condition holds, else `otherwise`.
    pub(super) fn select(&mut self, condition: NodeId, then: Part, otherwise: Part) -> Result<Part> {
        if then == otherwise || matches!(otherwise, Part::Unset(_)) {
            return Ok(then);
        }
        if matches!(then, Part::Unset(_)) {
            return Ok(otherwise);
        }
        match self.graph.as_constant(condition) {
            Some(0.0) => return Ok(otherwise),
            Some(_) => return Ok(then),
            None => {}
        }
        let (a, b) = (self.node(then)?, self.node(otherwise)?);
        Ok(Part::Node(self.select_node(condition, a, b)))
    }

    /// Like [`Graph::select`](crate::graph::Graph::select). A choice of the smaller or larger of two values becomes a
    /// minimum or maximum, which the tree can prune.
    pub(super) fn select_node(&mut self, condition: NodeId, a: NodeId, b: NodeId) -> NodeId {
        match self.graph.node(condition) {
            Node::Unary(Op::Not, inner) => return self.select_node(inner, b, a),
            Node::Binary(Op::Less | Op::LessEqual, x, y) if (x, y) == (a, b) => return self.graph.min(a, b),
            Node::Binary(Op::Less | Op::LessEqual, x, y) if (x, y) == (b, a) => return self.graph.max(a, b),
            _ => {}
        }
        self.graph.select(condition, a, b)
    }
}

/// True for a condition such as `true`.
fn is_literal(function: &Function, of: ExprId) -> bool {
    match function.expressions.try_get(of) {
        Ok(Expression::Unary { expr, .. }) => is_literal(function, *expr),
        Ok(expression) => matches!(expression, Expression::Literal(_)),
        Err(_) => false,
    }
}
