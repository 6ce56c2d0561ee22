//! What keys and the pointer do to the text.

use mariana_commands::Command;
use mariana_commands::input::{Key, KeyPress, Modifiers, NamedKey};
use mariana_editing::{Move, Refused, find};

use super::keys::{action_of, way_of};
use super::{CLOSE, EditAction, Editor, EditorEvent, Find, Owner, Question};

/// Most letters that are shown while they are put together.
const PREEDIT_MAX: usize = 64;

/// What a scene's text says that cannot be changed.
const READ_ONLY: &str =
    "this scene comes with Mariana: Ctrl+S copies it to your folder, and there it can be changed";

impl Editor {
    /// Takes a key that was pressed while these are held. Returns whether it was meant for the editor.
    pub fn take_key(&mut self, press: &KeyPress, held: Modifiers) -> bool {
        if press.repeat && self.ignores_repeats {
            return true;
        }
        self.ignores_repeats &= press.repeat;
        if self.find.as_ref().is_some_and(|find| find.typing) && self.type_query(press, held) {
            return true;
        }
        if self.choose_proposal(&press.key, held) {
            return true;
        }
        if let Some(action) = action_of(&press.key, press.latin, held) {
            self.act_with(action, held.shift_key());
            return true;
        }
        let select = held.shift_key();
        let plain = !held.intersects(Modifiers::CONTROL | Modifiers::ALT | Modifiers::SUPER);
        if let Some(way) = way_of(&press.key, held, self.rows)
            && !held.alt_key()
        {
            self.proposing = None;
            return self.with_text(|document| document.editing.go(way, select));
        }
        let word = held.control_key();
        match &press.key {
            Key::Named(NamedKey::Enter) if plain => return self.edit(|editing| editing.insert_line()),
            Key::Named(NamedKey::Backspace) => {
                let way = if word { Move::WordLeft } else { Move::Left };
                let was = self.proposing.is_some();
                let taken = self.edit(|editing| {
                    editing.delete(way);
                    Ok(())
                });
                if was {
                    self.propose(false);
                }
                return taken;
            }
            Key::Named(NamedKey::Delete) => {
                let way = if word { Move::WordRight } else { Move::Right };
                return self.edit(|editing| {
                    editing.delete(way);
                    Ok(())
                });
            }
            Key::Named(NamedKey::Tab) if plain => {
                return self.edit(|editing| {
                    let several = editing.selected().contains(&b'\n');
                    match (several, select) {
                        (false, false) => editing.insert(b"  ")?,
                        (_, shift) => editing.indent(!shift),
                    }
                    Ok(())
                });
            }
            _ => {}
        }
        // With AltGr, some systems hold Ctrl and Alt.
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
            // F11 and keys for media are the show's, as are those that only change others.
            None => matches!(press.key, Key::Character(_)),
        }
    }

    /// Shows letters at the cursor that are being put together and are not typed yet.
    pub fn set_preedit(&mut self, letters: &str) {
        self.preedit = letters.chars().filter(|letter| !letter.is_control()).take(PREEDIT_MAX).collect();
        self.revision += 1;
    }

    /// Puts in letters that were typed.
    pub fn type_text(&mut self, text: &str) {
        self.preedit.clear();
        if let Some(find) = self.find.as_mut().filter(|find| find.typing) {
            find.query.push_str(text);
            self.revision += 1;
            return;
        }
        self.edit(|editing| editing.insert(text.as_bytes()));
        self.propose(false);
    }

    /// Puts in a text that was copied.
    pub(super) fn put_in(&mut self, text: &[u8]) {
        if let Some(find) = self.find.as_mut().filter(|find| find.typing) {
            find.query.extend(String::from_utf8_lossy(text).lines().next());
            self.revision += 1;
            return;
        }
        self.edit(|editing| {
            editing.insert(text)?;
            editing.settle();
            Ok(())
        });
    }

    /// Does what was asked for.
    pub fn obey(&mut self, request: EditorEvent) {
        match request {
            EditorEvent::Press { at, clicks, select } => {
                self.set_focus(true);
                self.ignores_repeats = false;
                self.close_small();
                self.with_text(|document| match clicks {
                    0 | 1 => document.editing.go_to(at, select),
                    2 => document.editing.select_word(at),
                    _ => {
                        let line = document.editing.buffer().line_of(at);
                        document.editing.select_line(line);
                    }
                });
            }
            EditorEvent::DragTo(at) => {
                self.with_text(|document| document.editing.go_to(at, true));
            }
            EditorEvent::Grab(at) => self.grab(at),
            EditorEvent::Turn { points, speed } => self.turn(f64::from(points), speed),
            EditorEvent::LetGo => self.let_go(),
            EditorEvent::PickColor(at) => self.pick_color(at),
            EditorEvent::ClosePicker => {
                self.close_picker();
            }
            EditorEvent::SetColor(color) => self.set_color(color),
            EditorEvent::MovePlace(way) => self.move_place(way),
            EditorEvent::Scroll { lines, columns } => self.scroll(lines, columns),
            EditorEvent::Drawn { rows, columns } => {
                let is_first = self.rows != rows || self.columns != columns;
                (self.rows, self.columns) = (rows, columns);
                if is_first {
                    self.revision += 1;
                    self.reveal();
                }
            }
            EditorEvent::Act(command) => self.act_with(command, false),
            EditorEvent::ShowText(number) => self.show_text(number),
            EditorEvent::GoToProbed => self.go_to_probed(),
            EditorEvent::CloseProbed => {
                self.close_probed();
            }
            EditorEvent::GoTo { text, byte } => {
                self.set_focus(true);
                self.go_to_place(text, byte..byte);
            }
            EditorEvent::Take(number) => self.take_proposal(number),
            EditorEvent::Answer { first } => self.take_answer(first),
        }
    }

    fn act_with(&mut self, action: EditAction, shift: bool) {
        if action != EditAction::Propose {
            self.proposing = None;
        }
        match action {
            EditAction::Save => self.save(),
            EditAction::Undo => self.step(|editing| editing.undo(), "there is nothing to take back"),
            EditAction::Redo => self.step(|editing| editing.redo(), "there is nothing to do again"),
            EditAction::Copy => self.copy(),
            EditAction::Cut => {
                self.copy();
                self.edit(|editing| {
                    if !editing.selection().is_empty() {
                        editing.delete(Move::Right);
                    }
                    Ok(())
                });
            }
            EditAction::Paste => self.clipboard.paste(),
            EditAction::SelectAll => {
                self.with_text(|document| document.editing.select(0..document.editing.buffer().len()));
            }
            EditAction::Find => self.begin_find(),
            EditAction::FindNext { forward } => self.find_next(forward),
            EditAction::ToggleComment => {
                self.edit(|editing| {
                    editing.toggle_comment();
                    Ok(())
                });
            }
            EditAction::Propose => self.propose(true),
            EditAction::MakeParam => self.make_param(),
            EditAction::TurnNumber { up } => self.turn_by_key(up, shift),
            EditAction::Answer { first } => self.take_answer(first),
            EditAction::New => self.begin_scene(),
            EditAction::NextText => self.next_text(),
            EditAction::NextMistake => self.next_mistake(),
            EditAction::Light => self.toggle_light(),
            EditAction::Profile => self.toggle_profile(),
            EditAction::Leave => {
                let small = self.close_picker() || self.close_probed() || self.find.is_some();
                self.close_small();
                self.answer = None;
                if !small {
                    self.commands.push(CLOSE);
                }
            }
        }
        self.revision += 1;
    }

    /// Closes what belongs to the moment: the line for finding, and proposals.
    pub(super) fn close_small(&mut self) {
        self.find = None;
        self.proposing = None;
        self.close_picker();
        self.revision += 1;
    }

    /// Does something to the text that shows, without changing it, and brings the cursor into sight.
    pub(super) fn with_text(&mut self, act: impl FnOnce(&mut super::Document)) -> bool {
        if let Some(document) = self.document_mut() {
            act(document);
        }
        self.reveal();
        self.revision += 1;
        true
    }

    /// Changes the text that shows, if it can be changed.
    pub(super) fn edit(
        &mut self,
        change: impl FnOnce(&mut mariana_editing::Editing) -> Result<(), Refused>,
    ) -> bool {
        let Some(document) = self.documents.get_mut(self.shown) else { return true };
        if !document.is_open() {
            let words = match (&document.owner, &document.disk) {
                (Owner::Shipped(_), _) => READ_ONLY,
                (_, None) => "the file is still being read",
                _ => "the file cannot be read, so it is not changed",
            };
            self.say(words);
            return true;
        }
        let changed = change(&mut document.editing);
        self.proposing = None;
        self.note_change();
        self.reveal();
        if let Err(refused) = changed {
            self.say(refused.to_string());
        }
        true
    }

    fn step(&mut self, step: impl FnOnce(&mut mariana_editing::Editing) -> bool, nothing: &str) {
        let mut done = false;
        self.edit(|editing| {
            done = step(editing);
            Ok(())
        });
        if !done && self.answer.is_none() {
            self.say(nothing);
        }
    }

    fn copy(&mut self) {
        let Some(document) = self.document() else { return };
        let selected = document.editing.selected();
        if selected.is_empty() {
            return self.say("select something to copy it");
        }
        // Programs exchange text.
        let text = String::from_utf8_lossy(selected).into_owned();
        self.clipboard.copy(text);
    }

    fn begin_find(&mut self) {
        let selected =
            self.document().map(|document| document.editing.selected().to_vec()).unwrap_or_default();
        let before = self.find.take().map(|find| find.query).unwrap_or_default();
        let selected =
            String::from_utf8(selected).ok().filter(|text| !text.is_empty() && !text.contains('\n'));
        self.find = Some(Find { query: selected.unwrap_or(before), typing: true });
    }

    /// Types into the line for finding. Returns whether the key was meant for it.
    fn type_query(&mut self, press: &KeyPress, held: Modifiers) -> bool {
        let Some(find) = &mut self.find else { return false };
        match &press.key {
            Key::Named(NamedKey::Enter) => {
                self.find_next(!held.shift_key());
                return true;
            }
            Key::Named(NamedKey::Backspace) => {
                find.query.pop();
            }
            Key::Named(NamedKey::ArrowUp | NamedKey::ArrowDown) => {
                find.typing = false;
                return false;
            }
            _ => return false,
        }
        self.revision += 1;
        true
    }

    fn find_next(&mut self, forward: bool) {
        let query = self.find.as_ref().map(|find| find.query.clone()).unwrap_or_default();
        if query.is_empty() {
            return self.begin_find();
        }
        let Some(document) = self.document() else { return };
        let (text, selection) = (document.editing.buffer().bytes(), document.editing.selection());
        let from = if forward { selection.end } else { selection.start };
        match find(text, &query, from, forward) {
            Some(range) => {
                self.answer = None;
                self.with_text(|document| document.editing.select(range));
            }
            None => self.say(format!("\u{2018}{query}\u{2019} stands nowhere in this text")),
        }
    }

    fn next_mistake(&mut self) {
        let Some(document) = self.document() else { return };
        let cursor = document.editing.cursor();
        let all: Vec<_> = document.mistakes().collect();
        let next = all.iter().find(|one| one.range.start > cursor).or(all.first()).cloned();
        match next {
            Some(one) => {
                self.with_text(|document| document.editing.go_to(one.range.start, false));
            }
            None => {
                let others = self.findings.as_ref().and_then(|found| found.mistakes.first());
                match others.map(|one| one.text) {
                    Some(text) => self.show_text(text),
                    None => self.say("there is no mistake"),
                }
            }
        }
    }

    fn next_text(&mut self) {
        let tabs = self.tabs();
        let at = tabs.iter().position(|tab| tab.shows).unwrap_or(0);
        if tabs.len() < 2 {
            return self.say("this scene includes no other text");
        }
        self.show_text((at + 1) % tabs.len());
    }

    /// Shows one of the scene's texts by its number.
    pub(super) fn show_text(&mut self, number: usize) {
        let file = self.findings.as_ref().and_then(|found| found.texts.get(number)).cloned();
        if let Some(file) = file {
            self.close_small();
            self.shown = self.open(&file);
            if let Some(found) = self.findings.clone() {
                self.take_findings(found);
            }
        }
    }

    /// Does what was answered to the question about the text.
    fn take_answer(&mut self, first: bool) {
        let Some(question) = self.document_mut().and_then(|document| document.question.take()) else {
            return;
        };
        match (question, first) {
            (Question::Kept(kept), true) => {
                self.edit(|editing| editing.replace_all(&kept.text));
            }
            (Question::Kept(_), false) => self.forget_kept(),
            (Question::Conflict(_) | Question::Gone, true) => self.overwrite(),
            (Question::Conflict(theirs), false) => self.take_theirs(theirs),
            (Question::Gone, false) => {}
        }
        self.revision += 1;
    }

    fn scroll(&mut self, lines: f32, columns: f32) {
        let rows = self.rows as f32;
        let Some(document) = self.document_mut() else { return };
        let last = (document.editing.buffer().line_count() as f32 - 0.5 * rows).max(0.0);
        let (top, left) = document.view;
        document.view = ((top + lines).clamp(0.0, last), (left + columns).clamp(0.0, 1e6));
        self.revision += 1;
    }

    /// Brings the cursor into sight.
    pub(super) fn reveal(&mut self) {
        let (rows, columns) = (self.rows.max(3) as f32, self.columns.max(8) as f32);
        let Some(document) = self.document_mut() else { return };
        let buffer = document.editing.buffer();
        let line = buffer.line_of(document.editing.cursor());
        let inside = document.editing.cursor() - buffer.line_start(line);
        let column = mariana_editing::column_of(buffer.line(line), inside) as f32;
        let (mut top, mut left) = document.view;
        let line = line as f32;
        top = top.min(line - 1.0).max(line + 3.0 - rows).max(0.0);
        let fits = column + 4.0 <= columns;
        left = if fits { 0.0 } else { left.min(column - 4.0).max(column + 4.0 - columns) };
        document.view = (top, left);
    }

    /// Passes a change of the text on: to the loader, and to be kept.
    pub(super) fn note_change(&mut self) {
        let drafts = self.drafts.clone();
        let reads = !self.turn_is_live();
        let Some(document) = self.documents.get_mut(self.shown) else { return };
        if document.noted == document.editing.version() {
            return;
        }
        document.noted = document.editing.version();
        if let Some(line) = document.editing.take_changed_line() {
            document.forget_colors(line);
        }
        self.revision += 1;
        let Some(file) = document.file().map(std::path::Path::to_owned) else { return };
        let dirty = document.is_dirty();
        self.clerk.keep(&file, dirty.then(|| document.bytes()));
        if reads {
            let version = if dirty { drafts.set(&file, document.bytes()) } else { drafts.remove(&file) };
            document.note_sent(version);
            self.commands.push(Command::ReloadScene);
        }
    }
}
