//! Maps the values of a scene's expressions back to its text.
//!
//! Lowering records the start of each expression in a list of notes, in the order in which it visits them. The origin
//! of a value is the range of notes that were recorded while the value was computed. The use of a named value records a
//! reference to that value's range. The library's texts record no notes, because the call counts as their origin.

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::OnceLock;

use super::source::{Sources, Span};
use crate::graph::NodeId;

/// Maximum number of notes, and of values (8 MiB in total). For values beyond it, only the object is known.
const NOTES_MAX: usize = 1 << 18;

/// A location in the text: the number of the file among the scene's files, and the byte offset in this file.
pub type TextPlace = (usize, usize);

/// A range of notes; `to` is exclusive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(super) struct Stretch {
    from: u32,
    to: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Note {
    /// An expression or a block begins at this offset.
    Begins(u32),
    /// The text of these notes also belongs to the value.
    Uses(Stretch),
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Made {
    node: NodeId,
    span: Span,
    by: Stretch,
}

/// Maps nodes of a scene's graph to the text that they come from.
#[derive(Debug, Clone, Default)]
pub struct Origins {
    notes: Vec<Note>,
    made: Vec<Made>,
    /// The values sorted by node. Values of the same node keep the order in which they were recorded. The index is built
    /// on first use, because few edits need it and building it takes a tenth of the time to compile a text to a tape.
    by_node: OnceLock<Vec<Made>>,
    /// For each block of each object: the notes of its text without the shape, and of its whole text.
    objects: Vec<Vec<(Stretch, Stretch)>>,
    materials: Vec<Vec<Stretch>>,
    files: Vec<(u32, u32)>,
}

impl Origins {
    pub(super) fn mark(&self) -> u32 {
        self.notes.len() as u32
    }

    pub(super) fn since(&self, from: u32) -> Stretch {
        Stretch { from, to: self.mark() }
    }

    #[inline]
    pub(super) fn begins(&mut self, span: Span) {
        if self.notes.len() < NOTES_MAX {
            self.notes.push(Note::Begins(span.start));
        }
    }

    #[inline]
    pub(super) fn uses(&mut self, by: Stretch) {
        if by.from < by.to && self.notes.len() < NOTES_MAX {
            self.notes.push(Note::Uses(by));
        }
    }

    /// Records the head of a block: its field names and the values that it uses. [`NOTES_MAX`] does not apply here.
    pub(super) fn head(&mut self, begins: impl Iterator<Item = Span>, uses: &[Stretch]) -> Stretch {
        let from = self.mark();
        self.notes.extend(begins.map(|span| Note::Begins(span.start)));
        self.notes.extend(uses.iter().map(|by| Note::Uses(*by)));
        self.since(from)
    }

    /// Records that a node is the value of an expression. The expression's notes begin at the mark `from`.
    #[inline]
    pub(super) fn makes(&mut self, node: NodeId, span: Span, from: u32) {
        if self.made.len() < NOTES_MAX {
            let by = self.since(from);
            self.made.push(Made { node, span, by });
        }
    }

    pub(super) fn of_object(&mut self, object: usize, head: Stretch, whole: Stretch) {
        push_at(&mut self.objects, object, (head, whole));
    }

    pub(super) fn of_material(&mut self, material: usize, block: Stretch) {
        push_at(&mut self.materials, material, block);
    }

    pub(super) fn of_mixture(&mut self, material: usize, parts: [usize; 2]) {
        for part in parts {
            for block in self.materials.get(part).cloned().unwrap_or_default() {
                self.of_material(material, block);
            }
        }
    }

    pub(super) fn finish(&mut self, sources: &Sources) {
        self.files = sources.extents().collect();
    }

    fn made_of(&self, node: NodeId) -> &[Made] {
        let by_node = self.by_node.get_or_init(|| {
            let mut made = self.made.clone();
            made.sort_by_key(|made| made.node);
            made
        });
        let from = by_node.partition_point(|made| made.node < node);
        let to = by_node.partition_point(|made| made.node <= node);
        by_node.get(from..to).unwrap_or(&[])
    }

    /// True if a node is the value of an expression of the text.
    pub fn knows(&self, node: NodeId) -> bool {
        !self.made_of(node).is_empty()
    }

    /// Returns the file and the byte range of the innermost expression whose value is this node.
    pub fn written_at(&self, node: NodeId) -> Option<(usize, Range<usize>)> {
        let span = self.made_of(node).first()?.span;
        let (file, start) = self.place(span.start)?;
        Some((file, start..start + (span.end - span.start) as usize))
    }

    /// Returns the locations in the text that contribute to a surface, sorted and without duplicates. The surface
    /// belongs to an object with a material. `path` leads from the object's shape to the node that is the shape's value
    /// at the surface. If no node of the path is known, the result is the whole text of the object.
    pub fn places(&self, object: usize, material: usize, path: &[NodeId]) -> Vec<TextPlace> {
        let mut open: Vec<Stretch> = Vec::new();
        let mut starts = BTreeSet::new();
        let known: Vec<&[Made]> = path.iter().map(|node| self.made_of(*node)).collect();
        let last = known.iter().rposition(|made| !made.is_empty());
        let known = last.map_or(&[][..], |last| &known[..=last]);
        starts.extend(known.iter().copied().flatten().map(|made| made.span.start));
        open.extend(known.last().copied().into_iter().flatten().map(|made| made.by));
        for (head, whole) in self.objects.get(object).into_iter().flatten() {
            open.push(if last.is_some() { *head } else { *whole });
        }
        open.extend(self.materials.get(material).into_iter().flatten());
        let mut seen = BTreeSet::new();
        while let Some(stretch) = open.pop() {
            if !seen.insert(stretch) {
                continue;
            }
            let notes = self.notes.get(stretch.from as usize..stretch.to as usize).unwrap_or(&[]);
            for note in notes {
                match note {
                    Note::Begins(start) => {
                        starts.insert(*start);
                    }
                    Note::Uses(stretch) => open.push(*stretch),
                }
            }
        }
        starts.into_iter().filter_map(|start| self.place(start)).collect()
    }

    /// Converts an offset over all files to a file and a byte.
    pub fn place(&self, offset: u32) -> Option<TextPlace> {
        let file = self.files.partition_point(|(base, _)| *base <= offset).checked_sub(1)?;
        let (base, length) = self.files.get(file)?;
        Some((file, (offset - base).min(*length) as usize))
    }
}

fn push_at<T>(lists: &mut Vec<Vec<T>>, index: usize, one: T) {
    lists.resize_with(lists.len().max(index + 1), Vec::new);
    lists[index].push(one);
}

#[cfg(test)]
mod tests;
