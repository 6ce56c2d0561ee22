//! Builds tapes from graphs: orders the nodes and assigns registers.

use super::{Clause, Instruction, Operand, TableEntry, Tape};
use crate::graph::{Graph, Node, NodeId};

pub(super) fn build(graph: &Graph, roots: &[NodeId]) -> Tape {
    let order = graph.order(roots);
    let nodes = roots.iter().max().map_or(0, |last| last.index() + 1);
    let mut last_reader = vec![None; nodes];
    for &id in &order {
        graph.node(id).operands().for_each(|operand| last_reader[operand.index()] = Some(id));
    }
    // Roots keep their registers.
    roots.iter().for_each(|root| last_reader[root.index()] = None);
    let mut allocator =
        Allocator { graph, tape: Tape::default(), last_reader, places: vec![None; nodes], free: Vec::new() };
    order.into_iter().for_each(|id| allocator.define(id));
    let outputs = roots.iter().map(|root| allocator.operand(*root)).collect();
    Tape { outputs, ..allocator.tape }
}

struct Allocator<'a> {
    graph: &'a Graph,
    tape: Tape,
    /// The last node that reads each node; `None` for roots.
    last_reader: Vec<Option<NodeId>>,
    places: Vec<Option<Operand>>,
    free: Vec<u32>,
}

impl Allocator<'_> {
    /// Returns where a value is. Entries of the table are created when they are first read.
    fn operand(&mut self, id: NodeId) -> Operand {
        if let Some(known) = self.places[id.index()] {
            return known;
        }
        let entry = Operand::Immediate(self.tape.table.len() as u32);
        self.tape.table.push(match self.graph.node(id) {
            Node::Input(input) => TableEntry::Input(input),
            node => TableEntry::Constant(node.as_constant().unwrap_or(0.0)),
        });
        self.places[id.index()] = Some(entry);
        entry
    }

    fn allocate(&mut self) -> u32 {
        self.free.pop().unwrap_or_else(|| {
            self.tape.registers += 1;
            self.tape.registers as u32 - 1
        })
    }

    fn define(&mut self, id: NodeId) {
        let node = self.graph.node(id);
        let instruction = match node {
            Node::Constant(_) => return,
            Node::Input(input) => match input.of_point() {
                Some(place) => Instruction::Input(place as u8),
                None => return,
            },
            Node::Unary(op, _) | Node::Binary(op, ..) => Instruction::Operator(op),
            Node::Texture { texture, channel, .. } => Instruction::Texture { texture, channel },
        };
        let mut read = node.operands().map(|operand| self.operand(operand));
        let (first, second) = (read.next(), read.next());
        for operand in node.operands() {
            if let Some(Operand::Register(register)) = self.places[operand.index()]
                && self.last_reader[operand.index()] == Some(id)
            {
                self.places[operand.index()] = None;
                self.free.push(register);
            }
        }
        let output = self.allocate();
        let own = Operand::Register(output);
        let first = first.unwrap_or(own);
        self.places[id.index()] = Some(own);
        self.tape.clauses.push(Clause { instruction, output, operands: [first, second.unwrap_or(first)] });
    }
}
