//! Three numbers of a text that belong together: a colour that is picked, and a position that is dragged in the picture.
//! While that is done they are inputs of the frame, as a number is that is turned ([`super::turning`]).

use mariana_editing::{Triple, TripleKind, triples};

use super::document::Document;

impl Document {
    /// The `vec3`s of a line that are written in numbers, and where the line begins.
    pub(crate) fn triples(&self, line: usize) -> (Vec<Triple>, usize) {
        let buffer = self.editing.buffer();
        (self.with_colors(|colors| triples(buffer, colors, line)), buffer.line_start(line))
    }

    /// The one in which a place is.
    pub(super) fn triple_at(&self, at: usize) -> Option<(Triple, usize)> {
        let (triples, start) = self.triples(self.editing.buffer().line_of(at));
        let inside = at.checked_sub(start)?;
        let triple = triples.into_iter().find(|one| (one.range.start..=one.range.end).contains(&inside))?;
        Some((triple, start))
    }

    /// The colour in which a place is.
    pub(super) fn color_at(&self, at: usize) -> Option<(Triple, usize)> {
        self.triple_at(at).filter(|(triple, _)| triple.kind == TripleKind::Color)
    }

    /// The position at the cursor as it is in the text, and whether the scene has it there (1) or on the other side of
    /// the origin (-1).
    pub(super) fn place_at_cursor(&self) -> Option<([f64; 3], f64)> {
        let (triple, _) = self.triple_at(self.editing.cursor()).filter(|_| self.is_open())?;
        match triple.kind {
            TripleKind::Place { turned } => Some((triple.values(), if turned { -1.0 } else { 1.0 })),
            TripleKind::Color | TripleKind::Other => None,
        }
    }
}
