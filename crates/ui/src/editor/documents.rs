//! The open texts of the editor, the visible text, and its scroll position.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use mariana_scenes::{Findings, SceneSource};

use super::document::Document;
use super::wrapping::{RowPosition, Wrapping, row_of};

pub(super) struct Documents {
    all: Vec<Document>,
    shown: usize,
    /// Number of visible lines. The next field is the number of visible columns.
    pub(super) rows: usize,
    columns: usize,
    /// Cursor and scroll position to set when the file of the visible text has been read.
    pub(super) carried: Option<(usize, RowPosition)>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Tab {
    pub name: String,
    pub shows: bool,
    pub wrong: bool,
    pub dirty: bool,
}

impl Documents {
    pub(super) fn new() -> Self {
        Self { all: Vec::new(), shown: 0, rows: 20, columns: 60, carried: None }
    }

    pub(super) fn shown(&self) -> Option<&Document> {
        self.all.get(self.shown)
    }

    pub(super) fn shown_mut(&mut self) -> Option<&mut Document> {
        self.all.get_mut(self.shown)
    }

    pub(super) fn of(&self, file: &Path) -> Option<&Document> {
        self.all.iter().find(|document| document.file() == Some(file))
    }

    pub(super) fn of_mut(&mut self, file: &Path) -> Option<&mut Document> {
        self.all.iter_mut().find(|document| document.file() == Some(file))
    }

    pub(super) fn unsaved(&self) -> impl Iterator<Item = &Document> {
        self.all.iter().filter(|document| document.is_dirty())
    }

    /// Shows a text. Returns true if its file must be read first.
    pub(super) fn show(&mut self, source: &SceneSource) -> bool {
        let known = self.all.iter().position(|document| document.source == *source);
        self.shown = known.unwrap_or(self.all.len());
        if known.is_none() {
            self.all.push(Document::of(source));
        }
        known.is_none() && source.file().is_some()
    }

    pub(super) fn show_findings(&mut self, findings: &Arc<Findings>) {
        for (number, file) in findings.texts.iter().enumerate() {
            if let Some(document) = self.of_mut(file) {
                document.show_findings(findings, number);
            }
        }
        if findings.texts.is_empty()
            && let Some(document) = self.shown_mut()
        {
            document.show_findings(findings, 0);
        }
    }

    /// The tabs: one for each text of the scene, or only one while the scene's files are unknown.
    pub(super) fn tabs(&self, findings: Option<&Findings>) -> Vec<Tab> {
        let tab = |number: usize, file: &Path, open: Option<&Document>| Tab {
            name: match open {
                Some(open) => open.name(),
                None => file.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            },
            shows: self.shown().zip(open).is_some_and(|(shown, open)| std::ptr::eq(shown, open)),
            wrong: match open {
                Some(open) => open.mistakes().next().is_some(),
                None => findings.iter().flat_map(|found| &found.mistakes).any(|one| one.text == number),
            },
            dirty: open.is_some_and(Document::is_dirty),
        };
        match findings.map_or(&[][..], |found| &found.texts) {
            [] => Vec::from_iter(self.shown().map(|document| tab(0, Path::new(""), Some(document)))),
            texts => (0..).zip(texts).map(|(number, file)| tab(number, file, self.of(file))).collect(),
        }
    }

    /// Sets the numbers of visible lines and columns. Returns true if a number has changed.
    pub(super) fn resize(&mut self, rows: usize, columns: usize) -> bool {
        let is_new = (self.rows, self.columns) != (rows, columns);
        (self.rows, self.columns) = (rows, columns);
        is_new
    }

    /// Scrolls by rows. The last row stays in the upper half.
    pub(super) fn scroll(&mut self, by: f32) {
        let (rows, wrapping) = (self.rows as f32, Wrapping::new(self.columns));
        let Some(document) = self.shown_mut() else { return };
        let buffer = document.editing.buffer();
        let end = (buffer.line_count() as f32, 0.0);
        let behind = wrapping.moved(buffer, wrapping.moved(buffer, end, f32::MAX), 1.0 - 0.5 * rows);
        let wanted = wrapping.moved(buffer, document.view, by);
        document.view = if wanted > behind { behind } else { wanted };
    }

    /// Scrolls as little as possible, so that a row and its neighbours are visible.
    pub(super) fn reveal_row(&mut self, row: RowPosition) {
        let (rows, wrapping) = (self.rows.max(3) as f32, Wrapping::new(self.columns));
        let Some(document) = self.shown_mut() else { return };
        let moved = |by: f32| wrapping.moved(document.editing.buffer(), row, by);
        let (highest, lowest) = (moved(-1.0), moved(3.0 - rows));
        let view = if document.view > highest { highest } else { document.view };
        document.view = if view < lowest { lowest } else { view };
    }

    pub(super) fn reveal(&mut self) {
        let wrapping = Wrapping::new(self.columns);
        let Some(document) = self.shown_mut() else { return };
        let buffer = document.editing.buffer();
        let line = buffer.line_of(document.editing.cursor());
        let inside = document.editing.cursor() - buffer.line_start(line);
        let column = mariana_editing::column_of(buffer.line(line), inside);
        let row = row_of(&wrapping.starts(buffer.line(line)), column);
        self.reveal_row((line as f32, row as f32));
    }

    /// Moves the cursor to `range` of the visible text. Positions in `range` refer to the version that was last loaded.
    pub(super) fn select_loaded(&mut self, range: Range<usize>) {
        if let Some(document) = self.shown_mut()
            && let Some(now) = document.place_as_shown(range)
        {
            document.editing.move_to(now.start, false);
        }
        self.reveal();
    }
}
