//! Text search in the editor.

use std::ops::Range;

use mariana_editing::{Editing, find};

#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub(crate) struct Find {
    pub query: String,
    /// True while keys are typed into the search line.
    pub typing: bool,
}

#[derive(Default)]
pub(crate) struct Finding {
    pub(crate) line: Option<Find>,
}

impl Finding {
    pub(super) fn begin(&mut self, selected: &[u8]) {
        let before = self.line.take().map(|find| find.query).unwrap_or_default();
        let selected = std::str::from_utf8(selected).ok();
        let selected = selected.filter(|text| !text.is_empty() && !text.contains('\n'));
        self.line = Some(Find { query: selected.map_or(before, str::to_owned), typing: true });
    }

    pub(super) fn typed(&mut self) -> Option<&mut String> {
        self.line.as_mut().filter(|find| find.typing).map(|find| &mut find.query)
    }

    /// Finds the next or previous match. Returns a message if there is no match, and `None` without a search text.
    pub(super) fn next(&self, editing: &Editing, forward: bool) -> Option<Result<Range<usize>, String>> {
        let query = self.line.as_ref().map(|find| &find.query).filter(|query| !query.is_empty())?;
        let selection = editing.selection();
        let from = if forward { selection.end } else { selection.start };
        let place = find(editing.buffer().bytes(), query, from, forward);
        Some(place.ok_or_else(|| format!("no match for \u{2018}{query}\u{2019}")))
    }
}
