//! Tests of long lines in the editor.

use super::*;
use mariana_commands::input::Modifiers as Held;
use mariana_commands::input::{Key, KeyPress, NamedKey};
use tempfile::TempDir;

struct Writing {
    editor: Editor,
    stage: Stage,
    folder: TempDir,
}

impl Writing {
    fn of(text: &str, screen: Vec2) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("own.scene");
        fs::write(&file, text).unwrap();
        let mut editor = Editor::start(Drafts::default(), &Folders::within(folder.path()), || {}).unwrap();
        editor.show_scene(&SceneSource::File(file));
        editor.set_focus(true);
        wait_until("the text", || {
            editor.update();
            editor.document().is_some_and(|document| document.disk.is_some())
        });
        let mut writing = Self { editor, stage: Stage::new(screen), folder };
        writing.frame(vec![]);
        writing
    }

    fn frame(&mut self, events: Vec<Event>) -> LaidOut {
        let content = OverlayContent { editor: Some(&self.editor), ..Default::default() };
        let mut laid_out = self.stage.frame(events, content);
        for act in std::mem::take(&mut laid_out.acts.on_panels) {
            let PanelAct::Editor(act) = act else { panic!("an act on another panel") };
            act(&mut self.editor);
        }
        laid_out
    }

    fn press(&mut self, key: NamedKey) {
        let press = KeyPress { key: Key::Named(key), latin: None, text: None, repeat: false };
        assert!(self.editor.handle_key(&press, Held::empty()), "{key:?}");
        self.frame(vec![]);
    }

    /// The area of the text cursor, and the area of the editor.
    fn caret(&mut self) -> (Rect, Rect) {
        let laid_out = self.frame(vec![]);
        (laid_out.output.platform_output.ime.expect("no text cursor").cursor_rect, laid_out.panels[0])
    }

    fn cursor(&self) -> usize {
        self.editor.document().unwrap().editing.cursor()
    }
}

#[test]
fn a_line_of_ten_thousand_letters_is_broken_into_rows_and_followed() {
    let line = "length(p) + ".repeat(850);
    for screen in [SCREEN, Vec2::new(640.0, 360.0)] {
        let mut writing = Writing::of(&format!("{line}\nobject\n"), screen);
        let laid_out = writing.frame(vec![]);
        let (_, texts) = drawn(&laid_out);
        let rows: Vec<_> = texts.iter().filter(|(text, _)| text.contains("length(p)")).collect();
        assert!(rows.len() > 5, "{screen:?}: {texts:?}");
        assert!(texts.len() < 400, "{} texts are laid out", texts.len());
        let panel = laid_out.panels[0];
        assert!(rows.iter().all(|(_, at)| panel.contains_rect(*at)), "{screen:?}: {rows:?} in {panel:?}");
        for key in [NamedKey::End, NamedKey::Home, NamedKey::ArrowDown, NamedKey::ArrowUp] {
            writing.press(key);
            let (caret, panel) = writing.caret();
            assert!(panel.contains_rect(caret) && caret.height() > 5.0, "{screen:?}: {key:?}: {caret:?}");
        }
    }
}

#[test]
fn a_question_is_whole_in_a_narrow_window() {
    for screen in [Vec2::new(620.0, 400.0), Vec2::new(300.0, 300.0), SCREEN] {
        let mut writing = Writing::of("object ball { shape = sphere(p, 1) }\n", screen);
        writing.editor.type_text("a");
        fs::write(writing.folder.path().join("own.scene"), "object other { shape = sphere(p, 2) }\n")
            .unwrap();
        wait_until("the question", || {
            writing.editor.update();
            writing.editor.document().is_some_and(|document| document.question.is_some())
        });
        let laid_out = writing.frame(vec![]);
        let (_, texts) = drawn(&laid_out);
        let sentence = place_of(&texts, "Another program has changed this file.");
        let buttons = ["keep my text", "load the new one"].map(|words| place_of(&texts, words));
        let panel = laid_out.panels[0];
        assert!(panel.contains_rect(sentence), "{screen:?}: {sentence:?} in {panel:?}");
        for button in buttons {
            assert!(panel.contains_rect(button) && !button.intersects(sentence), "{screen:?}: {texts:?}");
        }
    }
}

#[test]
fn a_click_in_a_lower_row_goes_to_the_letter_under_the_pointer() {
    let line = "length(p) + ".repeat(40);
    let mut writing = Writing::of(&line, SCREEN);
    let (first, panel) = writing.caret();
    writing.press(NamedKey::End);
    let (last, _) = writing.caret();
    let rows = ((last.top() - first.top()) / first.height()).round();
    assert!(rows >= 3.0, "{first:?} {last:?}");
    let mut before = 0;
    for row in 0..=rows as usize {
        let at = Pos2::new(first.left() + 1.0, first.center().y + row as f32 * first.height());
        writing.stage.seconds += 2.0;
        for events in click_at(at) {
            writing.frame(events);
        }
        let (caret, _) = writing.caret();
        assert!((caret.center().y - at.y).abs() < 0.6 * first.height(), "row {row}: {caret:?}");
        let begins_word = row == 0 || line.as_bytes()[writing.cursor() - 1] == b' ';
        assert!(caret.left() == first.left() && begins_word, "row {row}: {}", writing.cursor());
        assert!(row == 0 || writing.cursor() > before, "row {row}");
        before = writing.cursor();
    }
    // A selection over two rows has a part in each.
    writing.editor.press(before - 12, 1, false);
    writing.editor.drag_to(before + 12);
    let laid_out = writing.frame(vec![]);
    let selected = laid_out.output.shapes.iter().filter_map(|clipped| match &clipped.shape {
        Shape::Rect(rect) if (rect.rect.height() - first.height()).abs() < 0.5 => Some(rect.rect),
        _ => None,
    });
    let tops: std::collections::BTreeSet<i32> = selected
        .filter(|rect| panel.contains_rect(*rect) && rect.width() > 20.0)
        .map(|rect| rect.top() as i32)
        .collect();
    assert!(tops.len() >= 2, "{tops:?}");
}
