//! Three numbers that belong together: a colour that is picked, and a position that is dragged in the picture. While that
//! is done they are inputs of the frame, as a number is that is turned ([`super::turning`]).

use mariana_editing::{Triple, TripleKind, triples};

use super::{Document, Editor};

impl Document {
    /// The `vec3`s of a line that are written in numbers, and where the line begins.
    pub(crate) fn triples(&self, line: usize) -> (Vec<Triple>, usize) {
        let buffer = self.editing.buffer();
        (self.with_colors(|colors| triples(buffer, colors, line)), buffer.line_start(line))
    }

    /// The one in which a place is.
    fn triple_at(&self, at: usize) -> Option<(Triple, usize)> {
        let (triples, start) = self.triples(self.editing.buffer().line_of(at));
        let inside = at.checked_sub(start)?;
        let triple = triples.into_iter().find(|one| (one.range.start..=one.range.end).contains(&inside))?;
        Some((triple, start))
    }
}

impl Editor {
    /// Opens what picks the colour at a place.
    pub(super) fn pick_color(&mut self, at: usize) {
        self.let_go();
        self.set_focus(true);
        self.close_small();
        let found = self.document().and_then(|document| document.triple_at(at));
        let Some((triple, start)) = found.filter(|(triple, _)| triple.kind == TripleKind::Color) else {
            return;
        };
        if self.document().is_some_and(|document| !document.is_open()) {
            // It says why not.
            self.edit(|_| Ok(()));
            return;
        }
        self.with_text(|document| document.editing.go_to(start + triple.range.start, false));
        self.picked = Some(start + triple.range.start);
    }

    /// Closes it. Whether it was open.
    pub(super) fn close_picker(&mut self) -> bool {
        let was = self.picked.take().is_some();
        if was && self.turns_three() {
            self.let_go();
        }
        self.revision += u64::from(was);
        was
    }

    /// Gives the colour that is picked other numbers.
    pub(super) fn set_color(&mut self, color: [f64; 3]) {
        let Some(at) = self.picked else { return };
        if self.turns_three() || self.take_three(at) {
            self.turn_three(color.map(|part| part.max(0.0)));
        }
    }

    /// Moves the position at the cursor.
    pub(super) fn move_place(&mut self, way: [f64; 3]) {
        if !self.turns_three() {
            let cursor = self.document().map(|document| document.editing.cursor());
            if !cursor.is_some_and(|cursor| self.take_three(cursor)) {
                return;
            }
        }
        let sign = self.place_in_text().map_or(1.0, |(_, sign)| sign);
        let Some(before) = self.turn.as_ref().map(super::turning::Turn::exact) else { return };
        self.turn_three(std::array::from_fn(|axis| before[axis] + sign * way[axis]));
    }

    /// Takes the three numbers at a place.
    fn take_three(&mut self, at: usize) -> bool {
        let found = self.document().and_then(|document| document.triple_at(at));
        found.is_some_and(|(triple, start)| self.take_numbers(triple.numbers.into(), start))
    }
}

/// What the overlay shows.
impl Editor {
    /// Where the colour stands that is picked, and its numbers.
    pub(crate) fn picked_color(&self) -> Option<(usize, [f64; 3])> {
        let at = self.picked?;
        let (triple, _) = self.document()?.triple_at(at)?;
        Some((at, triple.values()))
    }

    /// The position at the cursor as it is in the text, and whether the scene has it there (1) or on the other side of
    /// the origin (-1).
    fn place_in_text(&self) -> Option<([f64; 3], f64)> {
        let document = self.document().filter(|document| document.is_open())?;
        let (triple, _) = document.triple_at(document.editing.cursor())?;
        match triple.kind {
            TripleKind::Place { turned } => Some((triple.values(), if turned { -1.0 } else { 1.0 })),
            TripleKind::Color | TripleKind::Other => None,
        }
    }

    /// The position at the cursor, in the scene.
    pub(crate) fn place(&self) -> Option<[f64; 3]> {
        let (values, sign) = self.place_in_text().filter(|_| self.picked.is_none())?;
        Some(values.map(|value| sign * value))
    }
}
