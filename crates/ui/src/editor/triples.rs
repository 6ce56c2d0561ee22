//! Triples of numbers in an open text: colours to pick, and positions to drag in the frame. While the user changes a
//! triple, its numbers are frame inputs, like a turned number ([`super::turning`]).

use mariana_editing::{Triple, TripleKind, triples};

use super::document::Document;

impl Document {
    /// Returns the `vec3` calls in `line` whose arguments are number literals, and the byte offset of the line's start.
    pub(crate) fn triples(&self, line: usize) -> (Vec<Triple>, usize) {
        let buffer = self.editing.buffer();
        (self.with_colors(|colors| triples(buffer, colors, line)), buffer.line_start(line))
    }

    /// Returns the triple that contains byte `at`, and the byte offset of the triple's line.
    pub(super) fn triple_at(&self, at: usize) -> Option<(Triple, usize)> {
        let (triples, start) = self.triples(self.editing.buffer().line_of(at));
        let inside = at.checked_sub(start)?;
        let triple = triples.into_iter().find(|one| (one.range.start..=one.range.end).contains(&inside))?;
        Some((triple, start))
    }

    pub(super) fn color_at(&self, at: usize) -> Option<(Triple, usize)> {
        self.triple_at(at).filter(|(triple, _)| triple.kind == TripleKind::Color)
    }

    /// Returns the position written at the cursor, and its sign in the scene: -1 if the scene negates it, otherwise 1.
    pub(super) fn place_at_cursor(&self) -> Option<([f64; 3], f64)> {
        let (triple, _) = self.triple_at(self.editing.cursor()).filter(|_| self.is_open())?;
        match triple.kind {
            TripleKind::Place { turned } => Some((triple.values(), if turned { -1.0 } else { 1.0 })),
            TripleKind::Color | TripleKind::Other => None,
        }
    }
}
