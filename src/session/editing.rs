//! The editor of the scene's text: opening, closing, input and commands.

use super::{Interface, Session};
use crate::clock;
use crate::commands::{Command, Panel};
use crate::input::Input;
use crate::ui::editor::Editor;

impl Session {
    /// Gives the key focus to an open editor that does not have it. Returns `true` if the focus has changed.
    pub(super) fn gives_focus_to_editor(&mut self) -> bool {
        let waits = self.interface.is_edited() && !self.interface.editor_has_focus();
        if waits {
            self.write_text(true);
        }
        waits
    }

    pub(super) fn write_text(&mut self, open: bool) {
        if open && self.interface.ui_state.editor.is_none() {
            let Interface { drafts, folders, waker, .. } = &self.interface;
            match Editor::start(drafts.clone(), folders, waker.waking()) {
                Ok(editor) => self.interface.ui_state.editor = Some(editor),
                Err(error) => self.playback.reports.answer(format!("cannot open the editor: {error}")),
            }
        }
        self.playback.scene.preparation.library.is_written = open;
        self.screen.allow_composing(open);
        let Some(editor) = &mut self.interface.ui_state.editor else { return };
        editor.set_focus(open);
        if !open {
            editor.close_probed();
        }
        let wanted = &self.playback.scene.preparation.library.wanted;
        let is_unsaved = self.surprises.is_unsaved(wanted);
        if open && !is_unsaved {
            editor.show_scene(wanted);
        }
        self.follow_editor();
        if open && is_unsaved {
            self.keep_surprise();
        }
        if let Some(editor) = &mut self.interface.ui_state.editor {
            editor.await_scene(self.surprises.keeping.is_some());
        }
    }

    /// Takes input for the editor. Returns `true` if the text consumed the input.
    pub(super) fn pass_to_editor(&mut self, input: &Input) -> bool {
        if !self.interface.is_edited() {
            return false;
        }
        let (held, begun) = (self.interface.input.held, clock::now());
        let Some(editor) = &mut self.interface.ui_state.editor else { return false };
        let taken = match input {
            // The overlay handles clicks on the editor before this function is called.
            Input::PointerButton { pressed: true, .. } => {
                editor.set_focus(false);
                false
            }
            Input::Composing(letters) if editor.has_focus() => {
                editor.set_preedit(letters);
                true
            }
            Input::Text(text) if editor.has_focus() => {
                editor.type_text(text);
                true
            }
            Input::Key(press) if editor.has_focus() => editor.handle_key(press, held),
            _ => return false,
        };
        self.follow_editor();
        self.interface.typing_times.taken += clock::since(begun);
        taken
    }

    pub(super) fn update_editor(&mut self) {
        let open = self.interface.is_edited();
        let Some(editor) = &mut self.interface.ui_state.editor else { return };
        editor.await_scene(self.surprises.keeping.is_some());
        editor.update();
        if editor.tells_mistakes() {
            self.interface.typing_times.drafted = None;
        }
        let wanted = &self.playback.scene.preparation.library.wanted;
        if open && !self.surprises.is_unsaved(wanted) {
            editor.show_scene(wanted);
        }
        self.follow_editor();
    }

    /// Opens the editor, which writes the binding of a parameter into the text.
    pub(super) fn write_binding(&mut self, name: &str) {
        let sliders = self.playback.scene.parameters_in_hand().sliders();
        let slider = sliders.iter().rfind(|slider| slider.name == name);
        let Some(bound) = slider.and_then(|slider| slider.bound.clone()) else {
            return self.playback.reports.answer(format!("{name} follows no sound: bind it first"));
        };
        if self.interface.ui_state.panels.open != Some(Panel::Editor) {
            self.toggle_panel(Panel::Editor);
        }
        if let Some(editor) = &mut self.interface.ui_state.editor {
            editor.write_binding(name, &bound.binding);
        }
        self.follow_editor();
    }

    pub(super) fn follow_editor(&mut self) {
        let Some(editor) = &mut self.interface.ui_state.editor else { return };
        let commands = editor.drain_commands();
        // Load the text only once for all these keys.
        let (reloads, others): (Vec<_>, Vec<_>) =
            commands.into_iter().partition(|command| *command == Command::ReloadScene);
        if !reloads.is_empty() {
            self.interface.typing_times.record_key(self.playback.scene.scenes.shown_id(), clock::now());
        }
        self.carry_out_all(reloads.into_iter().next());
        let is_open = self.interface.is_edited();
        self.carry_out_all(
            others.into_iter().filter(|command| is_open || *command != Command::TogglePanel(Panel::Editor)),
        );
    }
}

impl Interface {
    pub(super) fn editor_has_focus(&self) -> bool {
        self.is_edited() && self.ui_state.editor.as_ref().is_some_and(Editor::has_focus)
    }

    pub(super) fn is_edited(&self) -> bool {
        self.ui_state.panels.open == Some(Panel::Editor)
    }
}
