//! Handling of keys and pointer events in the text.

use mariana_commands::input::{Key, KeyPress, Modifiers, NamedKey};
use mariana_commands::{Command, Panel};
use mariana_editing::{Editing, Move, Refused};

use super::focus::Early;
use super::keys::{action_of, way_of};
use super::params::new_param;
use super::proposing::Choice;
use super::turning::key_turn;
use super::{Document, EditAction, Editor, Question};
use crate::clipboard::Order;

pub(super) const CLOSE: Command = Command::TogglePanel(Panel::Editor);

impl Editor {
    /// Handles a key press while the modifiers `held` are held. Returns true if the editor used the key.
    pub fn handle_key(&mut self, press: &KeyPress, held: Modifiers) -> bool {
        use NamedKey::{Backspace, Delete, Enter, Tab};
        self.revision += 1;
        let action = action_of(&press.key, press.latin, held);
        // Esc still closes an editor whose file is not read in time.
        if is_loading(self) && (action != Some(EditAction::Leave) || !self.focus.early.is_empty()) {
            let is_used = press.text.is_some()
                || action.is_some()
                || way_of(&press.key, held, 1).is_some()
                || matches!(press.key, Key::Character(_) | Key::Named(Enter | Backspace | Delete | Tab));
            if is_used {
                self.focus.early.push(Early::Key(press.clone(), held));
            }
            return is_used;
        }
        self.focus.ignores_repeats &= press.repeat;
        if self.focus.ignores_repeats || self.handle_query_key(&press.key, held) {
            return true;
        }
        match self.proposals.choose(&press.key, held) {
            Choice::Take(number) => {
                self.accept_proposal(number);
                return true;
            }
            Choice::Changed => return true,
            Choice::Other => {}
        }
        if let Some(action) = action {
            self.act_with(action, held.contains(Modifiers::SHIFT));
            return true;
        }
        if let Some(way) = way_of(&press.key, held, self.texts.documents.rows)
            && !held.contains(Modifiers::ALT)
        {
            self.proposals.shown = None;
            return self
                .with_text(|document| document.editing.move_cursor(way, held.contains(Modifiers::SHIFT)));
        }
        let plain = !held.intersects(Modifiers::CONTROL | Modifiers::ALT | Modifiers::SUPER);
        if self.handle_editing_key(&press.key, held, plain) {
            return true;
        }
        // For AltGr, some systems report Ctrl and Alt.
        let types = plain || held.contains(Modifiers::CONTROL | Modifiers::ALT);
        match press
            .text
            .as_deref()
            .filter(|text| types && !text.is_empty() && !text.contains(char::is_control))
        {
            Some(text) => {
                self.type_text(text);
                true
            }
            // Keys without text, such as F11, media keys and modifiers, belong to the show.
            None => matches!(press.key, Key::Character(_)),
        }
    }

    /// Handles a key of the search line while it is typed.
    fn handle_query_key(&mut self, key: &Key, held: Modifiers) -> bool {
        let Some(find) = self.finding.line.as_mut().filter(|find| find.typing) else { return false };
        match key {
            Key::Named(NamedKey::Enter) => self.find_next(!held.contains(Modifiers::SHIFT)),
            Key::Named(NamedKey::Backspace) => _ = find.query.pop(),
            Key::Named(NamedKey::ArrowUp | NamedKey::ArrowDown) => {
                find.typing = false;
                return false;
            }
            _ => return false,
        }
        true
    }

    /// Handles keys that edit but type no letter. `plain` is true if no modifier except Shift is held.
    fn handle_editing_key(&mut self, key: &Key, held: Modifiers, plain: bool) -> bool {
        let (select, word) = (held.contains(Modifiers::SHIFT), held.contains(Modifiers::CONTROL));
        match key {
            Key::Named(NamedKey::Enter) if plain => self.edit(|editing| editing.insert_line()),
            Key::Named(NamedKey::Backspace) => {
                let was = self.proposals.shown.is_some();
                self.change(|editing| editing.delete(if word { Move::WordLeft } else { Move::Left }));
                if was {
                    self.propose(false);
                }
            }
            Key::Named(NamedKey::Delete) => {
                self.change(|editing| editing.delete(if word { Move::WordRight } else { Move::Right }));
            }
            Key::Named(NamedKey::Tab) if plain => self.edit(|editing| {
                let several = editing.selected().contains(&b'\n');
                match (several, select) {
                    (false, false) => editing.insert(b"  ")?,
                    (_, shift) => editing.indent(!shift),
                }
                Ok(())
            }),
            _ => return false,
        }
        true
    }

    /// Shows text that an input method is composing at the cursor.
    pub fn set_preedit(&mut self, letters: &str) {
        self.focus.preedit = letters.replace(char::is_control, "");
        self.revision += 1;
    }

    /// Inserts typed text.
    pub fn type_text(&mut self, text: &str) {
        self.focus.preedit.clear();
        if is_loading(self) {
            return self.focus.early.push(Early::Text(text.to_owned()));
        }
        if let Some(query) = self.finding.typed() {
            query.push_str(text);
            self.revision += 1;
            return;
        }
        self.edit(|editing| editing.insert(text.as_bytes()));
        self.propose(false);
    }

    /// Inserts pasted text as a separate undo step.
    pub(super) fn put_in(&mut self, text: &[u8]) {
        if let Some(query) = self.finding.typed() {
            query.extend(String::from_utf8_lossy(text).lines().next());
            self.revision += 1;
            return;
        }
        self.edit(|editing| {
            editing.insert(text)?;
            editing.settle();
            Ok(())
        });
    }
}

/// True while typed text has no place yet, because its file is being read or copied.
fn is_loading(editor: &Editor) -> bool {
    editor.focus.awaits_scene || editor.texts.are_loading()
}

/// Handles the keys that arrived while the text was being read.
pub(super) fn replay_early_keys(editor: &mut Editor) {
    if is_loading(editor) {
        return;
    }
    for input in std::mem::take(&mut editor.focus.early) {
        match input {
            Early::Key(press, held) => drop(editor.handle_key(&press, held)),
            Early::Text(text) => editor.type_text(&text),
        }
    }
}

impl Editor {
    /// Scrolls the text by rows, positive downwards.
    pub(crate) fn scroll(&mut self, rows: f32) {
        self.texts.documents.scroll(rows);
    }

    /// Records how many rows are visible, and how many columns each row has.
    pub(crate) fn record_drawn(&mut self, rows: usize, columns: usize) {
        let view = |editor: &Self| editor.texts.documents.shown().map(|document| document.view);
        let before = view(self);
        let is_resized = self.texts.documents.resize(rows, columns);
        if is_resized {
            self.texts.documents.reveal();
        }
        // The text may have become shorter since the last scrolling.
        self.texts.documents.scroll(0.0);
        if is_resized || view(self) != before {
            self.revision += 1;
        }
    }

    /// Handles a press of the pointer at an offset: 2 `clicks` select the word, 3 the line.
    pub(crate) fn press(&mut self, at: usize, clicks: u8, select: bool) {
        self.set_focus(true);
        self.focus.ignores_repeats = false;
        self.close_small();
        self.with_text(|document| match clicks {
            0 | 1 => document.editing.move_to(at, select),
            2 => document.editing.select_word(at),
            _ => {
                let line = document.editing.buffer().line_of(at);
                document.editing.select_line(line);
            }
        });
    }

    pub(crate) fn drag_to(&mut self, at: usize) {
        self.with_text(|document| document.editing.move_to(at, true));
    }

    /// Carries out the action of a button.
    pub(crate) fn act(&mut self, action: EditAction) {
        self.act_with(action, false);
    }

    fn act_with(&mut self, action: EditAction, shift: bool) {
        if action != EditAction::Propose {
            self.proposals.shown = None;
        }
        match action {
            EditAction::Save => {
                let saved = self.texts.save();
                self.show_refusal(saved);
            }
            EditAction::Undo => self.step(Editing::undo, "nothing to undo"),
            EditAction::Redo => self.step(Editing::redo, "nothing to redo"),
            EditAction::Copy => self.copy(),
            EditAction::Cut => {
                self.copy();
                self.change(|editing| {
                    if !editing.selection().is_empty() {
                        editing.delete(Move::Right);
                    }
                });
            }
            EditAction::Paste => {
                self.clipboard.send(Order::Paste);
            }
            EditAction::SelectAll => {
                self.with_text(|document| document.editing.select(0..document.editing.buffer().len()));
            }
            EditAction::Find => self.begin_find(),
            EditAction::FindNext { forward } => self.find_next(forward),
            EditAction::ToggleComment => self.change(Editing::toggle_comment),
            EditAction::Format => {
                let mut is_correct = true;
                self.edit(|editing| {
                    is_correct = editing.format()?;
                    Ok(())
                });
                if !is_correct {
                    self.show_notice("correct the mistakes first: a text with mistakes is not formatted");
                }
            }
            EditAction::Propose => self.propose(true),
            EditAction::MakeParam => self.make_param(),
            EditAction::TurnNumber { up } => self.turn_by_key(up, shift),
            EditAction::Answer { first } => self.apply_answer(first),
            EditAction::New => {
                let begun = self.texts.begin_scene();
                self.show_refusal(begun);
            }
            EditAction::NextText => match self.texts.next_number() {
                Some(number) => self.show_text(number),
                None => self.show_notice("this scene includes no other file"),
            },
            EditAction::NextMistake => match self.texts.next_mistake() {
                Ok(one) => {
                    self.with_text(|document| document.editing.move_to(one.range.start, false));
                }
                Err(Some(text)) => self.show_text(text),
                Err(None) => self.show_notice("no mistakes"),
            },
            EditAction::Light => {
                let words = self.picture.toggle_light();
                self.show_notice(words);
            }
            EditAction::Profile => self.picture.profiles = !self.picture.profiles,
            EditAction::Leave => self.leave(),
        }
    }

    fn leave(&mut self) {
        let small = self.held_numbers.close_picker(&mut self.texts)
            || self.close_probed()
            || self.finding.line.is_some()
            || std::mem::take(&mut self.picture.profiles);
        self.close_small();
        self.notice.clear();
        if !small {
            self.texts.outbox.commands.push(CLOSE);
        }
    }

    pub(super) fn with_text(&mut self, act: impl FnOnce(&mut Document)) -> bool {
        if let Some(document) = self.texts.documents.shown_mut() {
            act(document);
        }
        self.texts.documents.reveal();
        true
    }

    pub(super) fn edit(&mut self, change: impl FnOnce(&mut Editing) -> Result<(), Refused>) {
        let done = self.texts.edit(change);
        self.proposals.shown = None;
        self.show_refusal(done);
        self.revision += 1;
    }

    /// Edits the text in a way that cannot make it too long.
    fn change(&mut self, change: impl FnOnce(&mut Editing)) {
        self.edit(|editing| {
            change(editing);
            Ok(())
        });
    }

    fn step(&mut self, step: impl FnOnce(&mut Editing) -> bool, nothing: &str) {
        let mut done = false;
        self.change(|editing| done = step(editing));
        if !done && self.notice.words().is_none() {
            self.show_notice(nothing);
        }
    }

    fn copy(&mut self) {
        let Some(document) = self.document() else { return };
        let selected = document.editing.selected();
        if selected.is_empty() {
            return self.show_notice("select some text first");
        }
        // The clipboard takes valid UTF-8 only.
        let text = String::from_utf8_lossy(selected).into_owned();
        self.clipboard.send(Order::Copy(text));
    }

    fn begin_find(&mut self) {
        let selected = self.texts.documents.shown().map(|document| document.editing.selected());
        self.finding.begin(selected.unwrap_or_default());
    }

    fn find_next(&mut self, forward: bool) {
        let Some(document) = self.texts.documents.shown() else { return };
        match self.finding.next(&document.editing, forward) {
            Some(Ok(range)) => {
                self.notice.clear();
                self.with_text(|document| document.editing.select(range));
            }
            Some(Err(words)) => self.show_notice(words),
            None => self.begin_find(),
        }
    }

    pub(crate) fn show_text(&mut self, number: usize) {
        if let Some(text) = self.texts.source_of(number) {
            self.close_small();
            self.texts.show(&text);
        }
    }

    pub(crate) fn apply_answer(&mut self, first: bool) {
        let document = self.texts.documents.shown_mut();
        let Some(question) = document.and_then(|document| document.question.take()) else { return };
        match (question, first) {
            (Question::Kept(kept), true) => self.edit(|editing| editing.replace_all(&kept.text)),
            (Question::Kept(_), false) => self.texts.forget_kept(),
            (Question::Conflict(_) | Question::Gone, true) => self.texts.overwrite(),
            (Question::Conflict(theirs), false) => match self.texts.adopt_theirs(theirs) {
                Ok(()) => self.show_notice("loaded the other program's text; Ctrl+Z brings yours back"),
                Err(refused) => self.show_notice(refused.to_string()),
            },
            (Question::Gone, false) => {}
        }
    }

    fn turn_by_key(&mut self, up: bool, fine: bool) {
        let Some(document) = self.document() else { return };
        if let Err(words) = document.check_open() {
            return self.show_notice(words);
        }
        match key_turn(document, up, fine) {
            Some(edit) => self.edit(edit),
            None => self.show_notice("put the cursor on a number first"),
        }
    }

    fn make_param(&mut self) {
        let Some(document) = self.document() else { return };
        match new_param(document) {
            Ok((name, edit)) => {
                self.edit(edit);
                if self.notice.words().is_none() {
                    let how = "close the editor and press Tab to see its slider";
                    self.show_notice(format!("{name} is now a parameter: {how}"));
                }
            }
            Err(words) => self.show_notice(words),
        }
    }

    /// Opens the completion list. If the user `asked` for the list, it opens even before a letter is typed, and a
    /// message says if no name fits.
    fn propose(&mut self, asked: bool) {
        self.proposals.shown = None;
        let Some(document) = self.texts.documents.shown().filter(|document| document.is_open()) else {
            return;
        };
        let found = self.proposals.propose(document, asked);
        if asked && !found {
            self.show_notice("no name contains these letters");
        }
    }

    pub(crate) fn accept_proposal(&mut self, number: usize) {
        if let Some(write) = self.proposals.accept(number) {
            self.edit(write);
        }
    }
}
