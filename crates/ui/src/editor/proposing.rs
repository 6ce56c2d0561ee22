//! What may be written at the cursor, as it is proposed while one types.

use mariana_commands::input::{Key, Modifiers, NamedKey};
use mariana_editing::{Proposal, proposals};

use super::{Editor, Portrait};

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

impl Editor {
    /// Looks after the picture of the proposal that is selected.
    pub(super) fn want_portrait(&mut self) {
        let selected = self.proposing.as_ref().and_then(Proposing::of_library);
        if let Some(name) = selected.map(str::to_owned) {
            self.portraits.want(&name);
        }
        self.revision += u64::from(self.portraits.update());
    }

    /// The picture of the proposal that is selected, if it is there.
    pub(crate) fn portrait(&self) -> Option<&Portrait> {
        self.portraits.of(self.proposing.as_ref()?.of_library()?)
    }

    /// Looks what may be written at the cursor; what is `asked` for is told even if nothing was typed.
    pub(super) fn propose(&mut self, asked: bool) {
        self.proposing = None;
        let Some(document) = self.document().filter(|document| document.is_open()) else { return };
        let (buffer, cursor) = (document.editing.buffer(), document.editing.cursor());
        let (range, list) = document.with_colors(|colors| proposals(buffer, colors, cursor, asked));
        self.revision += 1;
        if list.is_empty() {
            if asked {
                self.say("no name of the language or of this text begins so");
            }
            return;
        }
        self.proposing = Some(Proposing { from: range.start, list, selected: 0, moved: asked });
    }

    /// Goes through the proposals by keys. Returns whether the key was meant for them.
    pub(super) fn choose_proposal(&mut self, key: &Key, held: Modifiers) -> bool {
        let Some(proposing) = &mut self.proposing else { return false };
        let (Key::Named(named), true) = (key, held.is_empty()) else { return false };
        let count = proposing.list.len();
        match named {
            NamedKey::ArrowDown => proposing.selected = (proposing.selected + 1) % count,
            NamedKey::ArrowUp => proposing.selected = (proposing.selected + count - 1) % count,
            NamedKey::Tab => {
                let selected = proposing.selected;
                self.take_proposal(selected);
                return true;
            }
            NamedKey::Enter if proposing.moved => {
                let selected = proposing.selected;
                self.take_proposal(selected);
                return true;
            }
            NamedKey::Escape => {
                self.proposing = None;
                self.revision += 1;
                return true;
            }
            _ => return false,
        }
        proposing.moved = true;
        self.revision += 1;
        true
    }

    /// Writes a proposal in the place of the name.
    pub(super) fn take_proposal(&mut self, number: usize) {
        let Some(proposing) = self.proposing.take() else { return };
        let Some(proposal) = proposing.list.get(number) else { return };
        let mut text = proposal.name.clone().into_bytes();
        self.edit(|editing| {
            let cursor = editing.cursor();
            let calls = editing.buffer().slice(cursor..cursor + 1) == b"(";
            if proposal.about.is_function && !calls {
                text.push(b'(');
            }
            editing.replace_part(proposing.from..cursor, &text)
        });
    }
}
