//! The completion list.

use mariana_commands::input::{Key, Modifiers, NamedKey};
use mariana_editing::{Proposal, proposals};

use super::document::Document;
use super::object_previews::{ObjectPreview, ObjectPreviews};
use super::texts::Edit;

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Proposing {
    /// Byte offset of the typed name.
    pub from: usize,
    /// Candidates, best first.
    pub list: Vec<Proposal>,
    pub selected: usize,
    /// True after the user has moved the selection, so that Enter accepts a candidate.
    moved: bool,
}

impl Proposing {
    fn of_library(&self) -> Option<&str> {
        let one = self.list.get(self.selected)?;
        (one.about.is_function && !one.about.facts.is_empty()).then_some(one.name.as_str())
    }
}

pub(super) enum Choice {
    Other,
    Changed,
    Take(usize),
}

pub(crate) struct Proposals {
    pub(crate) shown: Option<Proposing>,
    object_previews: ObjectPreviews,
}

impl Proposals {
    /// Starts with a closed list. `wake` is called on another thread when a preview is finished.
    pub(super) fn new(wake: impl Fn() + Send + 'static) -> Self {
        Self { shown: None, object_previews: ObjectPreviews::new(wake) }
    }

    pub(crate) fn object_preview(&self) -> Option<&ObjectPreview> {
        self.object_previews.of(self.shown.as_ref()?.of_library()?)
    }

    pub(super) fn update(&mut self) -> bool {
        if let Some(name) = self.shown.as_ref().and_then(Proposing::of_library) {
            self.object_previews.request(name);
        }
        self.object_previews.update()
    }

    /// Finds candidates for the name at the cursor. If the user `asked`, works even before a letter is typed. Returns
    /// true if there are candidates.
    pub(super) fn propose(&mut self, document: &Document, asked: bool) -> bool {
        let (buffer, cursor) = (document.editing.buffer(), document.editing.cursor());
        let (range, list) = document.with_colors(|colors| proposals(buffer, colors, cursor, asked));
        let proposing = Proposing { from: range.start, list, selected: 0, moved: asked };
        self.shown = Some(proposing).filter(|proposing| !proposing.list.is_empty());
        self.shown.is_some()
    }

    pub(super) fn choose(&mut self, key: &Key, held: Modifiers) -> Choice {
        let Some(proposing) = &mut self.shown else { return Choice::Other };
        let (Key::Named(named), true) = (key, held.is_empty()) else { return Choice::Other };
        let count = proposing.list.len();
        match named {
            NamedKey::ArrowDown => proposing.selected = (proposing.selected + 1) % count,
            NamedKey::ArrowUp => proposing.selected = (proposing.selected + count - 1) % count,
            NamedKey::Tab => return Choice::Take(proposing.selected),
            NamedKey::Enter if proposing.moved => return Choice::Take(proposing.selected),
            NamedKey::Escape => {
                self.shown = None;
                return Choice::Changed;
            }
            _ => return Choice::Other,
        }
        proposing.moved = true;
        Choice::Changed
    }

    pub(super) fn accept(&mut self, number: usize) -> Option<Edit> {
        let Proposing { from, mut list, .. } = self.shown.take()?;
        let proposal = (number < list.len()).then(|| list.swap_remove(number))?;
        Some(Box::new(move |editing| {
            let cursor = editing.cursor();
            let mut text = proposal.name.into_bytes();
            let calls = editing.buffer().slice(cursor..cursor + 1) == b"(";
            if proposal.about.is_function && !calls {
                text.push(b'(');
            }
            editing.replace_part(from..cursor, &text)
        }))
    }
}
