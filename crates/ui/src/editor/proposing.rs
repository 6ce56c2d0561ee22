//! What may be written at the cursor, as it is proposed while one types.

use mariana_commands::input::{Key, Modifiers, NamedKey};
use mariana_editing::{Editing, Proposal, Refused, proposals};

use super::document::Document;
use super::object_previews::{ObjectPreview, ObjectPreviews};

/// Proposals for the name at the cursor.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Proposing {
    /// Where the name begins.
    pub from: usize,
    /// What may be written, best first.
    pub list: Vec<Proposal>,
    /// The one that is selected.
    pub selected: usize,
    /// Whether the user has gone through them, so that Enter takes one.
    moved: bool,
}

impl Proposing {
    /// The name of the selected one, if the language itself has it.
    fn of_library(&self) -> Option<&str> {
        let one = self.list.get(self.selected)?;
        (one.about.is_function && !one.about.facts.is_empty()).then_some(one.name.as_str())
    }
}

/// What a key means for the proposals.
pub(super) enum Choice {
    /// Nothing.
    Other,
    /// Another one is selected, or they have gone.
    Changed,
    /// To take one.
    Take(usize),
}

/// See the module.
pub(crate) struct Proposals {
    proposing: Option<Proposing>,
    object_previews: ObjectPreviews,
}

impl Proposals {
    /// None. `wake` is called on another thread when there is a new small picture.
    pub(super) fn new(wake: impl Fn() + Send + 'static) -> Self {
        Self { proposing: None, object_previews: ObjectPreviews::new(wake) }
    }

    /// Those that show.
    pub(crate) fn shown(&self) -> Option<&Proposing> {
        self.proposing.as_ref()
    }

    /// The picture of the one that is selected, if it is there.
    pub(crate) fn object_preview(&self) -> Option<&ObjectPreview> {
        self.object_previews.of(self.proposing.as_ref()?.of_library()?)
    }

    pub(super) fn close(&mut self) {
        self.proposing = None;
    }

    /// Looks after the picture of the one that is selected. Returns whether pictures came.
    pub(super) fn update(&mut self) -> bool {
        if let Some(name) = self.proposing.as_ref().and_then(Proposing::of_library) {
            self.object_previews.want(name);
        }
        self.object_previews.update()
    }

    /// Looks what may be written at the cursor; what is `asked` for is told even if nothing was typed. Returns whether
    /// there is something.
    pub(super) fn propose(&mut self, document: &Document, asked: bool) -> bool {
        let (buffer, cursor) = (document.editing.buffer(), document.editing.cursor());
        let (range, list) = document.with_colors(|colors| proposals(buffer, colors, cursor, asked));
        let proposing = Proposing { from: range.start, list, selected: 0, moved: asked };
        self.proposing = Some(proposing).filter(|proposing| !proposing.list.is_empty());
        self.proposing.is_some()
    }

    /// Goes through the proposals by keys.
    pub(super) fn choose(&mut self, key: &Key, held: Modifiers) -> Choice {
        let Some(proposing) = &mut self.proposing else { return Choice::Other };
        let (Key::Named(named), true) = (key, held.is_empty()) else { return Choice::Other };
        let count = proposing.list.len();
        match named {
            NamedKey::ArrowDown => proposing.selected = (proposing.selected + 1) % count,
            NamedKey::ArrowUp => proposing.selected = (proposing.selected + count - 1) % count,
            NamedKey::Tab => return Choice::Take(proposing.selected),
            NamedKey::Enter if proposing.moved => return Choice::Take(proposing.selected),
            NamedKey::Escape => {
                self.proposing = None;
                return Choice::Changed;
            }
            _ => return Choice::Other,
        }
        proposing.moved = true;
        Choice::Changed
    }

    /// Takes one: what writes it in the place of the name.
    pub(super) fn take(
        &mut self,
        number: usize,
    ) -> Option<impl FnOnce(&mut Editing) -> Result<(), Refused> + use<>> {
        let Proposing { from, mut list, .. } = self.proposing.take()?;
        let proposal = (number < list.len()).then(|| list.swap_remove(number))?;
        Some(move |editing: &mut Editing| {
            let cursor = editing.cursor();
            let mut text = proposal.name.into_bytes();
            let calls = editing.buffer().slice(cursor..cursor + 1) == b"(";
            if proposal.about.is_function && !calls {
                text.push(b'(');
            }
            editing.replace_part(from..cursor, &text)
        })
    }
}
