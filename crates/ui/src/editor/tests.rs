//! Tests of the editor without a window: keys, files, and a loader called directly.

mod picture;

use std::fs;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use mariana_commands::input::{Key, KeyPress, Modifiers, NamedKey};
use tempfile::TempDir;

use super::acting::CLOSE;
use super::*;
use mariana_commands::TurnedNumbers;
use mariana_files::documents::OnDisk;
use mariana_scenes::{Findings, NumberEdits, TextureCache};
use mariana_testing::process::WAIT_LIMIT;

const BALL: &str = "let r = 0.5\nobject ball { shape = length(p) - r }\n";

struct TestEditor {
    folder: TempDir,
    editor: Editor,
    drafts: Drafts,
    woken: Receiver<()>,
    edits: NumberEdits,
    commands: Vec<Command>,
}

impl TestEditor {
    fn new(text: &[u8]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("main.scene"), text).unwrap();
        Self::in_folder(folder)
    }

    fn in_folder(folder: TempDir) -> Self {
        let (wake, woken) = channel();
        let drafts = Drafts::default();
        let editor = Editor::start(drafts.clone(), &Folders::within(folder.path()), move || {
            wake.send(()).unwrap_or_default()
        })
        .unwrap();
        let mut setup =
            Self { folder, editor, drafts, woken, edits: NumberEdits::default(), commands: Vec::new() };
        setup.editor.set_focus(true);
        setup.editor.focus.ignores_repeats = false;
        let source = setup.source();
        setup.editor.show_scene(&source);
        setup.wait("the text", |editor| editor.document().is_some_and(|document| document.disk.is_some()));
        setup
    }

    fn file(&self) -> PathBuf {
        self.folder.path().join("main.scene")
    }

    fn source(&self) -> SceneSource {
        SceneSource::File(self.file())
    }

    #[track_caller]
    fn wait(&mut self, what: &str, is_there: impl Fn(&Editor) -> bool) {
        let start = Instant::now();
        loop {
            self.editor.update();
            self.commands.extend(self.editor.drain_commands());
            if is_there(&self.editor) {
                return;
            }
            assert!(start.elapsed() < WAIT_LIMIT, "{what} did not come");
            let _ = self.woken.recv_timeout(Duration::from_millis(50));
        }
    }

    fn commands(&mut self) -> Vec<Command> {
        self.commands.extend(self.editor.drain_commands());
        std::mem::take(&mut self.commands)
    }

    fn reloads(&mut self) -> usize {
        self.commands().into_iter().filter(|command| *command == Command::ReloadScene).count()
    }

    fn load(&mut self) -> bool {
        let (source, texts) = (self.source(), self.drafts.texts());
        let (result, _) = source.ready_with(&mut TextureCache::default(), &mut self.edits, &texts);
        self.drafts.publish(Findings::of(&source, &texts, &result));
        self.editor.update();
        result.is_ok()
    }

    fn key(&mut self, key: Key, held: Modifiers) -> bool {
        let text = match &key {
            Key::Character(text) => Some(text.clone()),
            _ => None,
        };
        self.editor.handle_key(&KeyPress { key, latin: None, text, repeat: false }, held)
    }

    fn ctrl(&mut self, letter: &str) {
        assert!(self.key(Key::Character(letter.into()), Modifiers::CONTROL));
    }

    fn named(&mut self, named: NamedKey) -> bool {
        self.key(Key::Named(named), Modifiers::empty())
    }

    fn type_text(&mut self, text: &str) {
        for letter in text.chars() {
            match letter {
                '\n' => self.named(NamedKey::Enter),
                letter => self.key(Key::Character(letter.to_string()), Modifiers::empty()),
            };
        }
    }

    fn text(&self) -> String {
        String::from_utf8_lossy(self.editor.document().unwrap().editing.buffer().bytes()).into_owned()
    }

    fn said(&self) -> &str {
        self.editor.notice.words().unwrap_or_default()
    }

    fn go_to(&mut self, part: &str) {
        let bytes = self.editor.document().unwrap().editing.buffer().bytes();
        let at = bytes.windows(part.len()).position(|bytes| bytes == part.as_bytes()).unwrap();
        self.editor.press(at, 1, false);
    }

    fn picked_color(&self) -> Option<(usize, [f64; 3])> {
        self.editor.held_numbers.picked_color(self.editor.document()?)
    }

    fn place(&self) -> Option<[f64; 3]> {
        self.editor.held_numbers.place(self.editor.document()?)
    }

    fn asked(&self) -> Option<&Question> {
        self.editor.document().unwrap().question.as_ref()
    }
}

#[test]
fn a_key_formats_the_text_if_it_has_no_mistakes() {
    let mut setup = TestEditor::new(b"let  a=1");
    setup.ctrl("r");
    assert_eq!(setup.text(), "let a = 1\n");
    setup.type_text("let = ");
    setup.ctrl("r");
    assert!(setup.said().contains("correct the mistakes"), "{}", setup.said());
    assert_eq!(setup.text(), "let = let a = 1\n");
}

#[test]
fn every_edit_goes_to_the_loader_and_undoing_all_removes_the_draft() {
    let mut setup = TestEditor::new(BALL.as_bytes());
    assert!(setup.load());
    setup.go_to("0.5");
    setup.type_text("1 + ");
    assert_eq!((setup.text(), setup.reloads()), (BALL.replace("0.5", "1 + 0.5"), 4));
    assert!(setup.load() && setup.editor.texts.tabs()[0].dirty);
    while setup.editor.document().unwrap().is_dirty() {
        setup.ctrl("z");
    }
    assert_eq!(setup.text(), BALL);
    assert!(setup.drafts.texts().of(&setup.file()).is_none());
}

#[test]
fn a_mistake_is_marked_and_moves_with_the_text() {
    let mut setup = TestEditor::new(BALL.as_bytes());
    setup.go_to("- r");
    setup.type_text("- q ");
    assert!(!setup.load() && setup.editor.tells_mistakes());
    let marked = |setup: &TestEditor| {
        let one = setup.editor.document().unwrap().mistake().unwrap();
        setup.text()[one.range].to_owned()
    };
    assert_eq!(marked(&setup), "q");
    setup.go_to("let");
    setup.type_text("# a ball\n");
    assert_eq!(marked(&setup), "q");
    assert!(!setup.load());
    assert_eq!(marked(&setup), "q");
    setup.ctrl("e");
    assert!(setup.text()[setup.editor.document().unwrap().editing.cursor()..].starts_with("q "));
    setup.named(NamedKey::Delete);
    setup.named(NamedKey::Delete);
    setup.named(NamedKey::Delete);
    setup.named(NamedKey::Delete);
    assert!(setup.load(), "{:?}", setup.editor.document().unwrap().mistake());
    assert!(!setup.editor.tells_mistakes());
}

#[test]
fn a_warning_is_marked_moves_with_the_text_and_ends_with_its_cause() {
    let mut setup = TestEditor::new(format!("let lost = 1\n{BALL}").as_bytes());
    setup.go_to("0.5");
    setup.type_text("0");
    assert!(setup.load() && !setup.editor.tells_mistakes());
    let marked = |setup: &TestEditor| -> Vec<String> {
        let document = setup.editor.document().unwrap();
        document.warnings().map(|one| setup.text()[one.range].to_owned()).collect()
    };
    assert_eq!(marked(&setup), ["lost"]);
    setup.go_to("let lost");
    setup.type_text("# a ball\n");
    assert_eq!(marked(&setup), ["lost"]);
    assert!(setup.editor.document().unwrap().warning().is_none());
    setup.go_to("lost");
    assert!(setup.editor.document().unwrap().warning().is_some());
    setup.go_to("00.5");
    setup.type_text("lost + ");
    assert!(setup.load());
    assert!(marked(&setup).is_empty());
}

#[test]
fn a_text_is_saved_and_a_conflict_is_asked_about() {
    let mut setup = TestEditor::new(BALL.as_bytes());
    setup.go_to("0.5");
    setup.type_text("1");
    setup.ctrl("s");
    setup.wait("the save", |editor| !editor.document().unwrap().is_dirty());
    assert_eq!(fs::read_to_string(setup.file()).unwrap(), BALL.replace("0.5", "10.5"));
    fs::write(setup.file(), "let r = 3\nlength(p) - r").unwrap();
    setup.wait("their text", |editor| {
        editor.document().unwrap().editing.buffer().bytes().starts_with(b"let r = 3")
    });
    assert!(setup.asked().is_none());
    setup.go_to("3");
    setup.type_text("4");
    fs::write(setup.file(), "theirs").unwrap();
    setup.ctrl("s");
    setup.wait("the question", |editor| editor.document().unwrap().question.is_some());
    setup.wait("further messages", |_| true);
    assert_eq!(fs::read_to_string(setup.file()).unwrap(), "theirs");
    setup.ctrl("s");
    assert!(setup.said().contains("choose"), "{}", setup.said());
    setup.ctrl("2");
    assert_eq!(setup.text(), "theirs");
    setup.ctrl("z");
    assert_eq!(setup.text(), "let r = 43\nlength(p) - r");
    setup.ctrl("s");
    setup.wait("mine", |editor| !editor.document().unwrap().is_dirty());
    assert_eq!(fs::read_to_string(setup.file()).unwrap(), "let r = 43\nlength(p) - r");
}

#[test]
fn a_deleted_file_stays_on_screen_and_can_be_written_again() {
    let mut setup = TestEditor::new(BALL.as_bytes());
    fs::remove_file(setup.file()).unwrap();
    setup.wait("the question", |editor| editor.document().unwrap().question == Some(Question::Gone));
    assert!(setup.load(), "the draft replaces it");
    setup.ctrl("1");
    setup.wait("the file", |editor| !editor.document().unwrap().is_dirty());
    assert_eq!(fs::read_to_string(setup.file()).unwrap(), BALL);
}

#[test]
fn unsaved_text_is_offered_in_the_next_run() {
    let mut setup = TestEditor::new(BALL.as_bytes());
    setup.go_to("0.5");
    setup.type_text("7");
    setup.editor.finish();
    let mut setup = TestEditor::in_folder(setup.folder);
    assert!(matches!(setup.asked(), Some(Question::Kept(_))));
    assert_eq!(setup.text(), BALL);
    setup.ctrl("1");
    assert_eq!(setup.text(), BALL.replace("0.5", "70.5"));
    setup.ctrl("s");
    setup.wait("the save", |editor| !editor.document().unwrap().is_dirty());
    setup.go_to("70");
    setup.type_text("1");
    setup.editor.finish();
    let mut setup = TestEditor::in_folder(setup.folder);
    setup.ctrl("2");
    setup.editor.finish();
    let setup = TestEditor::in_folder(setup.folder);
    assert!(setup.asked().is_none());
}

#[test]
fn turning_a_number_does_not_parse_the_text() {
    let mut setup = TestEditor::new(BALL.as_bytes());
    assert!(setup.load());
    let at = BALL.find("0.5").unwrap();
    setup.editor.grab(at + 1);
    assert_eq!(setup.reloads(), 1, "one load makes it an input");
    assert!(setup.load());
    for _ in 0..50 {
        setup.editor.turn_number(2.0, TurnSpeed::Usual);
    }
    let commands = setup.commands();
    assert_eq!(commands.len(), 50, "the text is not parsed: {commands:?}");
    let last = Command::TurnNumbers(TurnedNumbers { file: setup.file(), values: vec![(at, 0.7)] });
    assert_eq!(commands.last(), Some(&last));
    assert_eq!(setup.text(), BALL.replace("0.5", "0.7"));
    setup.editor.let_go();
    assert_eq!(setup.reloads(), 1, "the text defines the number again");
    assert!(setup.load());
    assert_eq!(setup.editor.texts.findings.as_ref().unwrap().numbers, [0_usize; 0]);
    setup.ctrl("z");
    assert_eq!(setup.text(), BALL, "one undo step restores it");
}

#[test]
fn a_value_beyond_the_range_of_a_number_starts_a_new_range() {
    let mut setup = TestEditor::new(BALL.as_bytes());
    let at = BALL.find("0.5").unwrap();
    setup.editor.grab(at);
    assert!(setup.load());
    assert_eq!(setup.reloads(), 1);
    setup.editor.turn_number(200.0, TurnSpeed::Coarse);
    assert_eq!((setup.text(), setup.reloads()), (BALL.replace("0.5", "4.5"), 1));
    assert!(setup.load());
    setup.editor.turn_number(100.0, TurnSpeed::Usual);
    let commands = setup.commands();
    let is = |commands: &[Command], at: usize, wanted: f32| match commands {
        [Command::TurnNumbers(TurnedNumbers { values, .. })] => {
            matches!(values[..], [(digits, value)] if digits == at && (value - wanted).abs() < 1e-5)
        }
        _ => false,
    };
    assert!(is(&commands, at, 4.7), "{commands:?}");
    // A negative value gets a minus, so the digits move one byte to the right.
    setup.editor.turn_number(-400.0, TurnSpeed::Coarse);
    assert_eq!(setup.text(), BALL.replace("0.5", "-3.3"));
    assert!(setup.load());
    assert_eq!(setup.editor.texts.findings.as_ref().unwrap().numbers, [at + 1]);
    let _ = setup.commands();
    setup.editor.turn_number(50.0, TurnSpeed::Usual);
    let commands = setup.commands();
    assert!(is(&commands, at + 1, 3.2), "{commands:?}");
}

#[test]
fn a_structural_number_is_parsed_at_each_value() {
    let text = "object o { shape = length(p) - sum(for i in 0..4: 0.1) }";
    let mut setup = TestEditor::new(text.as_bytes());
    setup.editor.grab(text.find("4:").unwrap());
    assert!(setup.load());
    let _ = setup.commands();
    setup.editor.turn_number(24.0, TurnSpeed::Usual);
    assert_eq!((setup.text(), setup.reloads()), (text.replace("4:", "6:"), 1));
    assert!(setup.load());
    setup.editor.let_go();
    assert_eq!(setup.text(), text.replace("4:", "6:"));
}

#[test]
fn keys_turn_numbers_and_convert_them_to_parameters() {
    let mut setup = TestEditor::new(
        b"# A ball.\nmaterial m { roughness = 0.3 }\nobject o { shape = length(p) - 1  material = m }\n",
    );
    setup.go_to("0.3");
    assert!(setup.key(Key::Named(NamedKey::ArrowUp), Modifiers::ALT));
    assert!(setup.text().contains("roughness = 0.32"), "{}", setup.text());
    assert!(setup.key(Key::Named(NamedKey::ArrowDown), Modifiers::ALT | Modifiers::SHIFT));
    assert!(setup.text().contains("roughness = 0.318"), "{}", setup.text());
    setup.ctrl("p");
    assert_eq!(
        setup.text(),
        "# A ball.\nparam roughness_knob = 0.318 in 0 .. 0.636\nmaterial m { roughness = roughness_knob }\n\
         object o { shape = length(p) - 1  material = m }\n"
    );
    assert!(setup.load(), "{:?}", setup.editor.document().unwrap().mistake());
    setup.go_to("1  material");
    setup.ctrl("p");
    assert!(setup.text().contains("0.636\nparam knob = 1 in 0 .. 2\nmaterial"), "{}", setup.text());
    assert!(setup.load(), "{:?}", setup.editor.document().unwrap().mistake());
    setup.ctrl("z");
    assert!(!setup.text().contains("param knob"), "it is one step");
}

#[test]
fn proposals_appear_while_typing_and_tab_accepts_one() {
    let mut setup = TestEditor::new(b"object o { shape =  }");
    setup.go_to(" }");
    setup.type_text("smooth_u");
    let first = setup.editor.proposals.shown.as_ref().unwrap().list[0].clone();
    assert_eq!(first.name, "smooth_union");
    assert!(!first.about.text.is_empty());
    assert!(setup.named(NamedKey::Tab));
    assert!(setup.text().contains("smooth_union( }"), "{}", setup.text());
    setup.type_text("sph\n");
    assert!(setup.text().contains("(sph\n"), "{}", setup.text());
    setup.type_text("bo");
    setup.named(NamedKey::ArrowDown);
    let second = setup.editor.proposals.shown.as_ref().unwrap().list[1].name.clone();
    setup.named(NamedKey::Enter);
    assert!(setup.text().contains(&format!("\n{second}")), "{}", setup.text());
    setup.type_text(" bo");
    assert!(setup.named(NamedKey::Escape) && setup.editor.proposals.shown.is_none());
    assert!(
        setup.commands().iter().all(|command| *command == Command::ReloadScene),
        "Esc closes only the list"
    );
    setup.named(NamedKey::Escape);
    assert_eq!(setup.commands(), [CLOSE]);
}

#[test]
fn a_shipped_scene_says_how_to_copy_it() {
    let mut setup = TestEditor::new(BALL.as_bytes());
    let orb = SceneSource::Shipped("orb".into());
    setup.editor.show_scene(&orb);
    let before = setup.text();
    assert_eq!(before, orb.text().unwrap());
    setup.type_text("x");
    assert_eq!(setup.text(), before);
    assert!(setup.said().contains("Ctrl+S"), "{}", setup.said());
    let main = setup.source();
    setup.editor.show_scene(&main);
    setup.go_to("0.5");
    setup.type_text("9");
    setup.editor.show_scene(&orb);
    setup.editor.show_scene(&main);
    assert_eq!(setup.text(), BALL.replace("0.5", "90.5"));
}

#[test]
fn huge_pastes_invalid_bytes_and_mixed_line_ends_do_no_harm() {
    let bytes = b"# \xff\xfe\r\nlet r = 1\nlength(p) - r\r\n\0";
    let mut setup = TestEditor::new(bytes);
    assert!(!setup.load());
    let mistake = setup.editor.document().unwrap().mistake().unwrap();
    assert_eq!((mistake.range.clone(), mistake.message.contains("UTF-8")), (2..3, true));
    setup.editor.put_in(&vec![b'x'; 10 << 20]);
    assert!(setup.said().contains("1048576 bytes"), "{}", setup.said());
    setup.go_to("1\nlength");
    setup.type_text("2");
    setup.ctrl("s");
    setup.wait("the save", |editor| !editor.document().unwrap().is_dirty());
    assert_eq!(fs::read(setup.file()).unwrap(), b"# \xff\xfe\r\nlet r = 21\nlength(p) - r\r\n\0");
    let binary: Vec<u8> = (0..=255).cycle().take(70_000).collect();
    fs::write(setup.file(), &binary).unwrap();
    setup.wait("the bytes", |editor| {
        editor.document().unwrap().disk == Some(OnDisk::Bytes(binary.clone().into()))
    });
    assert_eq!(setup.editor.document().unwrap().editing.buffer().bytes(), binary);
}

#[test]
fn a_text_that_becomes_short_is_visible_from_its_first_row() {
    let by_keys = |setup: &mut TestEditor| {
        setup.ctrl("a");
        setup.editor.put_in(b"one\ntwo\nthree");
    };
    let by_another_program = |setup: &mut TestEditor| {
        fs::write(setup.file(), "one\ntwo\n").unwrap();
        setup.wait("the short text", |editor| editor.document().unwrap().editing.buffer().line_count() < 9);
    };
    for shorten in [by_keys as fn(&mut TestEditor), by_another_program] {
        let mut setup = TestEditor::new("# line\n".repeat(99).as_bytes());
        let view = |setup: &TestEditor| setup.editor.document().unwrap().view;
        setup.editor.record_drawn(20, 80);
        setup.key(Key::Named(NamedKey::End), Modifiers::CONTROL);
        assert!(view(&setup).0 > 70.0);
        shorten(&mut setup);
        let drawn = setup.editor.revision;
        setup.editor.record_drawn(20, 80);
        assert!(view(&setup) == (0.0, 0.0) && setup.editor.revision > drawn, "{:?}", view(&setup));
    }
}

#[test]
fn the_search_finds_the_next_match() {
    let mut setup = TestEditor::new(b"one two\ntwo one\n");
    setup.ctrl("f");
    setup.type_text("two");
    assert_eq!(setup.text(), "one two\ntwo one\n");
    let selected = |setup: &TestEditor| setup.editor.document().unwrap().editing.selection();
    setup.named(NamedKey::Enter);
    assert_eq!(selected(&setup), 4..7);
    setup.named(NamedKey::Enter);
    setup.named(NamedKey::F3);
    assert_eq!(selected(&setup), 4..7, "it wraps around");
    setup.named(NamedKey::Escape);
    assert!(setup.commands().is_empty() && setup.editor.finding.line.is_none());
    setup.type_text("2");
    assert_eq!(setup.text(), "one 2\ntwo one\n");
}

#[test]
fn the_key_that_opened_the_editor_is_not_typed() {
    let mut setup = TestEditor::new(b"y");
    setup.editor.set_focus(false);
    setup.editor.set_focus(true);
    let key = Key::Character("e".to_owned());
    let press = |repeat| KeyPress { key: key.clone(), latin: Some('e'), text: Some("e".to_owned()), repeat };
    let mut take = |repeat| setup.editor.handle_key(&press(repeat), Modifiers::empty());
    assert!(take(true));
    assert_eq!(setup.text(), "y");
    let mut take = |repeat| setup.editor.handle_key(&press(repeat), Modifiers::empty());
    assert!(take(false) && take(true));
    assert_eq!(setup.text(), "eey");
    assert!(!setup.named(NamedKey::F11) && !setup.named(NamedKey::MediaPlayPause));
}

#[test]
fn keys_right_after_the_key_that_opens_the_editor_were_lost() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("main.scene");
    fs::write(&file, BALL).unwrap();
    let mut setup = TestEditor::in_folder(folder);
    // The scene changes, and the user types before the editor has read the other file.
    let other = setup.folder.path().join("other.scene");
    fs::write(&other, BALL).unwrap();
    setup.editor.show_scene(&SceneSource::File(other.clone()));
    assert!(setup.named(NamedKey::Enter) && setup.named(NamedKey::ArrowLeft));
    setup.type_text("# ab");
    setup.editor.type_text("ç");
    setup.type_text("d");
    assert!(!setup.named(NamedKey::F11), "F11 belongs to the show");
    setup.wait("the text", |editor| editor.document().is_some_and(|document| document.disk.is_some()));
    assert_eq!(setup.text(), format!("# abçd\n{BALL}"));
    assert_eq!(setup.commands().iter().filter(|command| **command == CLOSE).count(), 0);
    // Esc closes an editor that still waits for its text, but not before the keys typed before it.
    fs::write(setup.folder.path().join("third.scene"), BALL).unwrap();
    setup.editor.show_scene(&SceneSource::File(setup.folder.path().join("third.scene")));
    setup.named(NamedKey::Escape);
    assert!(setup.commands().contains(&CLOSE));
}

#[test]
fn keys_after_the_key_that_copies_a_scene_were_refused() {
    let mut setup = TestEditor::new(BALL.as_bytes());
    setup.editor.show_scene(&SceneSource::Formula("length(p) - 1".to_owned()));
    setup.type_text("x");
    assert!(setup.said().contains("this formula has no file"), "{}", setup.said());
    setup.ctrl("s");
    setup.type_text("2 * ");
    let start = Instant::now();
    let copy = loop {
        setup.editor.update();
        let shown = setup.commands().into_iter().find_map(|command| match command {
            Command::ShowScene(source) => Some(*source),
            _ => None,
        });
        if let Some(copy) = shown {
            break copy;
        }
        assert!(start.elapsed() < WAIT_LIMIT, "no copy is made");
        let _ = setup.woken.recv_timeout(Duration::from_millis(50));
    };
    setup.editor.show_scene(&copy);
    setup.wait("the copy", |editor| editor.document().is_some_and(Document::is_open));
    assert_eq!(setup.text(), "2 * length(p) - 1");
}

#[test]
fn the_template_of_new_scenes_is_valid() {
    let source = SceneSource::Formula(super::texts::TEMPLATE.to_owned());
    assert!(source.ready().is_ok(), "{:?}", source.ready().err());
}
