//! The order in which a graph's nodes are evaluated, and the inputs that they read.

use std::collections::BTreeSet;

use super::Graph;
use super::node::{Input, Node, NodeId};
use super::op::{Op, Properties};

/// The inputs, tables and textures that an expression reads.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct InputsUsed {
    /// The inputs.
    pub inputs: BTreeSet<Input>,
    /// Operators that read the frame's tables.
    pub tables: BTreeSet<Op>,
    /// Numbers of the scene's textures.
    pub textures: BTreeSet<u16>,
}

/// Marks a node on the stack whose operands are already in the order.
const OPERANDS_DONE: u32 = 1 << 31;

impl Graph {
    /// Returns all nodes that `roots` need, in an order in which operands precede their users. Each node occurs once.
    ///
    /// The inputs of the point come first. Then the tree is walked from the first root to the last, operands before
    /// users. Of two operands, the one that keeps more values at once comes first (Sethi and Ullman 1970, treating the
    /// graph as if it were a tree). If both keep equally many, the left one comes first.
    ///
    /// Two other orders are used if fewer values are then kept at once. More than two roots may be walked from the last
    /// to the first: the distance to shining objects, which is the last root of their light, ends the use of many
    /// values. And nodes may keep the order of their creation: a walk follows one of the values that a loop carries
    /// through all rounds, and keeps what the other ones need of each round.
    pub fn order(&self, roots: &[NodeId]) -> Vec<NodeId> {
        let Some(last) = roots.iter().max() else { return Vec::new() };
        let needs = needs(&self.nodes[..=last.index()]);
        let given = self.walk(roots.iter(), &needs);
        let mut created = given.clone();
        created.sort_unstable_by_key(|id| (self.nodes[id.index()].place_of_point(), *id));
        let backwards = (roots.len() > 2).then(|| self.walk(roots.iter().rev(), &needs));
        let orders = [given].into_iter().chain(backwards).chain([created]);
        orders.min_by_key(|nodes| self.most_kept(nodes, roots)).unwrap_or_default()
    }

    fn walk<'a>(&self, roots: impl Iterator<Item = &'a NodeId>, needs: &[u8]) -> Vec<NodeId> {
        let mut seen = vec![false; needs.len()];
        let mut nodes = Vec::with_capacity(needs.len().min(1 << 16));
        let mut inputs = [None; Input::OF_POINT.len()];
        let mut stack: Vec<u32> = Vec::with_capacity(64);
        for root in roots {
            stack.push(root.0);
            while let Some(entry) = stack.pop() {
                if entry & OPERANDS_DONE != 0 {
                    nodes.push(NodeId(entry & !OPERANDS_DONE));
                    continue;
                }
                let index = entry as usize;
                if std::mem::replace(&mut seen[index], true) {
                    continue;
                }
                match self.nodes[index] {
                    Node::Constant(_) => nodes.push(NodeId(entry)),
                    Node::Input(input) => match input.of_point() {
                        Some(place) => inputs[place] = Some(NodeId(entry)),
                        None => nodes.push(NodeId(entry)),
                    },
                    Node::Unary(_, a) => stack.extend([entry | OPERANDS_DONE, a.0]),
                    Node::Binary(_, a, b) | Node::Texture { u: a, v: b, .. } => {
                        let (first, second) =
                            if needs[b.index()] > needs[a.index()] { (b, a) } else { (a, b) };
                        stack.extend([entry | OPERANDS_DONE, second.0, first.0]);
                    }
                }
            }
        }
        nodes.splice(0..0, inputs.into_iter().flatten());
        nodes
    }

    /// Returns how many values are kept at the same time if the nodes are computed in this order.
    fn most_kept(&self, order: &[NodeId], roots: &[NodeId]) -> usize {
        let takes_register = |id: NodeId| match self.nodes[id.index()] {
            Node::Constant(_) => false,
            Node::Input(input) => input.of_point().is_some(),
            _ => true,
        };
        let mut is_kept = vec![false; roots.iter().max().map_or(0, |last| last.index() + 1)];
        let (mut kept, mut most) = (0_usize, 0);
        let keep = |id: NodeId, kept: &mut usize, is_kept: &mut Vec<bool>| {
            *kept += usize::from(takes_register(id) && !std::mem::replace(&mut is_kept[id.index()], true));
        };
        for root in roots {
            keep(*root, &mut kept, &mut is_kept);
        }
        for id in order.iter().rev() {
            most = most.max(kept);
            kept -= usize::from(std::mem::replace(&mut is_kept[id.index()], false));
            for operand in self.nodes[id.index()].operands() {
                keep(operand, &mut kept, &mut is_kept);
            }
        }
        most
    }

    /// Returns the inputs, tables and textures that the roots read.
    pub fn inputs_used(&self, roots: &[NodeId]) -> InputsUsed {
        let mut used = InputsUsed::default();
        let count = roots.iter().max().map_or(0, |last| last.index() + 1);
        let mut is_needed = vec![false; count];
        for root in roots {
            is_needed[root.index()] = true;
        }
        // Users follow their operands, so every user of a node has been visited before the node.
        for index in (0..count).rev() {
            if !is_needed[index] {
                continue;
            }
            let node = self.nodes[index];
            for operand in node.operands() {
                is_needed[operand.index()] = true;
            }
            match node {
                Node::Input(input) => {
                    used.inputs.insert(input);
                    // A motion reads the inputs of its operands, which precede it.
                    if let Input::Motion(number) = input {
                        let operands = self.motions.get(usize::from(number)).map(|motion| motion.operands);
                        operands.iter().flatten().for_each(|operand| is_needed[operand.index()] = true);
                    }
                }
                Node::Unary(op, _) | Node::Binary(op, _, _)
                    if op.properties().has(Properties::READS_FRAME) =>
                {
                    used.tables.insert(op);
                }
                Node::Texture { texture, .. } => {
                    used.textures.insert(texture);
                }
                _ => {}
            }
        }
        used
    }
}

/// Returns, for each node, how many values its computation keeps at the same time if no value is shared.
fn needs(nodes: &[Node]) -> Vec<u8> {
    let mut needs: Vec<u8> = Vec::with_capacity(nodes.len());
    for node in nodes {
        let need = match node {
            Node::Constant(_) | Node::Input(_) => 0,
            Node::Unary(_, a) => needs[a.index()].max(1),
            Node::Binary(_, a, b) | Node::Texture { u: a, v: b, .. } => {
                let (a, b) = (needs[a.index()], needs[b.index()]);
                if a == b { a.saturating_add(1) } else { a.max(b) }
            }
        };
        needs.push(need);
    }
    needs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_walk_begins_with_the_root_that_ends_the_use_of_most_values() {
        let mut graph = Graph::new();
        let x = graph.input(Input::X);
        let shapes: Vec<NodeId> = (1..=6)
            .map(|number| {
                let factor = graph.constant(number as f32);
                let product = graph.mul(x, factor);
                graph.unary(Op::Sin, product)
            })
            .collect();
        let weights: Vec<NodeId> = shapes.iter().map(|shape| graph.unary(Op::Exp, *shape)).collect();
        let lights: Vec<NodeId> = [Op::Add, Op::Sub, Op::Max]
            .into_iter()
            .map(|op| weights.iter().copied().reduce(|a, b| graph.binary(op, a, b)).unwrap())
            .collect();
        let nearest = shapes.iter().copied().reduce(|a, b| graph.min(a, b)).unwrap();
        let roots = [lights[0], lights[1], lights[2], nearest];
        let order = graph.order(&roots);
        let place = |id: NodeId| order.iter().position(|other| *other == id).unwrap();
        assert!(place(nearest) < place(weights[1]), "the shapes are kept until all weights are known");
        let given = graph.walk(roots.iter(), &needs(&graph.nodes));
        assert!(graph.most_kept(&order, &roots) < graph.most_kept(&given, &roots));
    }
}
