//! The graph as Graphviz text.

use std::fmt::Write as _;

use super::node::{Node, NodeId};
use super::{Graph, GraphError};

impl Graph {
    /// Returns a Graphviz `digraph` of the nodes that `root` needs: a box per node, edges from operands to users.
    ///
    /// # Errors
    /// [`GraphError::TooManyNodes`] if the graph has reached its limit.
    pub fn to_dot(&self, root: NodeId) -> Result<String, GraphError> {
        let mut text = String::from("digraph expression {\n  node [shape=box];\n");
        for id in self.order(&[root])?.nodes {
            let node = self.node(id);
            // Writing to a String cannot fail.
            let _ = match node {
                Node::Constant(value) => writeln!(text, "  n{} [label=\"{value:?}\"];", id.0),
                Node::Input(input) => writeln!(text, "  n{} [label=\"{input}\"];", id.0),
                Node::Unary(op, _) | Node::Binary(op, _, _) => {
                    writeln!(text, "  n{} [label=\"{}\"];", id.0, op.name())
                }
                Node::Texture { texture, channel, .. } => {
                    let channel = ["red", "green", "blue", "alpha"][usize::from(channel & 3)];
                    writeln!(text, "  n{} [label=\"TEXTURE {texture} {channel}\"];", id.0)
                }
            };
            for (place, operand) in node.operands().enumerate() {
                let name = ["a", "b"][place];
                let _ = writeln!(text, "  n{} -> n{} [label=\"{name}\"];", operand.0, id.0);
            }
        }
        text.push_str("}\n");
        Ok(text)
    }
}
