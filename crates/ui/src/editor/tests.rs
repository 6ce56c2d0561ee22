//! The editor without a window: its keys, its files, and a loader that is called by hand.

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

const WAIT_LIMIT: Duration = Duration::from_secs(10);
const BALL: &str = "let r = 0.5\nobject ball { shape = length(p) - r }\n";

struct Desk {
    folder: TempDir,
    editor: Editor,
    /// What the loader gets.
    drafts: Drafts,
    woken: Receiver<()>,
    edits: NumberEdits,
    /// What the show was asked for since it was looked at.
    commands: Vec<Command>,
}

impl Desk {
    /// An editor on `main.scene` with this text, which was read.
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
        let mut desk =
            Self { folder, editor, drafts, woken, edits: NumberEdits::default(), commands: Vec::new() };
        desk.editor.set_focus(true);
        desk.editor.focus.take_repeats();
        let source = desk.source();
        desk.editor.show_scene(&source);
        desk.wait("the text", |editor| editor.document().is_some_and(|document| document.disk.is_some()));
        desk
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
            self.commands.extend(self.editor.take_commands());
            if is_there(&self.editor) {
                return;
            }
            assert!(start.elapsed() < WAIT_LIMIT, "{what} did not come");
            let _ = self.woken.recv_timeout(Duration::from_millis(50));
        }
    }

    fn commands(&mut self) -> Vec<Command> {
        self.commands.extend(self.editor.take_commands());
        std::mem::take(&mut self.commands)
    }

    fn reloads(&mut self) -> usize {
        self.commands().into_iter().filter(|command| *command == Command::ReloadScene).count()
    }

    /// Does what the loader does; returns whether the scene can be drawn.
    fn load(&mut self) -> bool {
        let (source, texts) = (self.source(), self.drafts.texts());
        let (result, _) = source.ready_with(&mut TextureCache::default(), &mut self.edits, &texts);
        self.drafts.tell(Findings::of(&source, &texts, &result));
        self.editor.update();
        result.is_ok()
    }

    fn key(&mut self, key: Key, held: Modifiers) -> bool {
        let text = match &key {
            Key::Character(text) => Some(text.clone()),
            _ => None,
        };
        self.editor.take_key(&KeyPress { key, latin: None, text, repeat: false }, held)
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

    /// Puts the cursor before a part of the text.
    fn go_to(&mut self, part: &str) {
        let bytes = self.editor.document().unwrap().editing.buffer().bytes();
        let at = bytes.windows(part.len()).position(|bytes| bytes == part.as_bytes()).unwrap();
        self.editor.obey(EditorEvent::Press { at, clicks: 1, select: false });
    }

    fn picked_color(&self) -> Option<(usize, [f64; 3])> {
        self.editor.hand.picked_color(self.editor.document()?)
    }

    fn place(&self) -> Option<[f64; 3]> {
        self.editor.hand.place(self.editor.document()?)
    }

    fn asked(&self) -> Option<&Question> {
        self.editor.document().unwrap().question.as_ref()
    }
}

#[test]
fn every_key_goes_to_the_loader_and_what_is_undone_is_the_files_again() {
    let mut desk = Desk::new(BALL.as_bytes());
    assert!(desk.load());
    desk.go_to("0.5");
    desk.type_text("1 + ");
    assert_eq!((desk.text(), desk.reloads()), (BALL.replace("0.5", "1 + 0.5"), 4));
    assert!(desk.load() && desk.editor.texts.tabs()[0].dirty);
    while desk.editor.document().unwrap().is_dirty() {
        desk.ctrl("z");
    }
    assert_eq!(desk.text(), BALL);
    assert!(desk.drafts.texts().of(&desk.file()).is_none());
}

#[test]
fn a_mistake_stands_where_it_is_and_moves_with_the_text() {
    let mut desk = Desk::new(BALL.as_bytes());
    desk.go_to("- r");
    desk.type_text("- q ");
    assert!(!desk.load() && desk.editor.tells_mistakes());
    let marked = |desk: &Desk| {
        let one = desk.editor.document().unwrap().mistake().unwrap();
        desk.text()[one.range].to_owned()
    };
    assert_eq!(marked(&desk), "q");
    // Typed above before the loader has seen it: the mark moves.
    desk.go_to("let");
    desk.type_text("# a ball\n");
    assert_eq!(marked(&desk), "q");
    assert!(!desk.load());
    assert_eq!(marked(&desk), "q");
    desk.ctrl("e");
    assert!(desk.text()[desk.editor.document().unwrap().editing.cursor()..].starts_with("q "));
    desk.named(NamedKey::Delete);
    desk.named(NamedKey::Delete);
    desk.named(NamedKey::Delete);
    desk.named(NamedKey::Delete);
    assert!(desk.load(), "{:?}", desk.editor.document().unwrap().mistake());
    assert!(!desk.editor.tells_mistakes());
}

#[test]
fn a_text_is_saved_and_what_others_write_meanwhile_is_asked_about() {
    let mut desk = Desk::new(BALL.as_bytes());
    desk.go_to("0.5");
    desk.type_text("1");
    desk.ctrl("s");
    desk.wait("the save", |editor| !editor.document().unwrap().is_dirty());
    assert_eq!(fs::read_to_string(desk.file()).unwrap(), BALL.replace("0.5", "10.5"));
    // Saved by another program while there is nothing to lose: it is taken.
    fs::write(desk.file(), "let r = 3\nlength(p) - r").unwrap();
    desk.wait("their text", |editor| {
        editor.document().unwrap().editing.buffer().bytes().starts_with(b"let r = 3")
    });
    assert!(desk.asked().is_none());
    // And while there is.
    desk.go_to("3");
    desk.type_text("4");
    fs::write(desk.file(), "theirs").unwrap();
    desk.ctrl("s");
    desk.wait("the question", |editor| editor.document().unwrap().question.is_some());
    desk.wait("all that is told of it", |_| true);
    assert_eq!(fs::read_to_string(desk.file()).unwrap(), "theirs");
    desk.ctrl("s");
    assert!(desk.said().contains("choose"), "{}", desk.said());
    desk.ctrl("2");
    assert_eq!(desk.text(), "theirs");
    desk.ctrl("z");
    assert_eq!(desk.text(), "let r = 43\nlength(p) - r");
    desk.ctrl("s");
    desk.wait("mine", |editor| !editor.document().unwrap().is_dirty());
    assert_eq!(fs::read_to_string(desk.file()).unwrap(), "let r = 43\nlength(p) - r");
}

#[test]
fn a_deleted_file_stays_on_the_stage_and_is_written_again() {
    let mut desk = Desk::new(BALL.as_bytes());
    fs::remove_file(desk.file()).unwrap();
    desk.wait("the question", |editor| editor.document().unwrap().question == Some(Question::Gone));
    assert!(desk.load(), "its draft stands for it");
    desk.ctrl("1");
    desk.wait("the file", |editor| !editor.document().unwrap().is_dirty());
    assert_eq!(fs::read_to_string(desk.file()).unwrap(), BALL);
}

#[test]
fn what_was_typed_and_not_saved_is_offered_again() {
    let mut desk = Desk::new(BALL.as_bytes());
    desk.go_to("0.5");
    desk.type_text("7");
    desk.editor.finish();
    let mut desk = Desk::in_folder(desk.folder);
    assert!(matches!(desk.asked(), Some(Question::Kept(_))));
    assert_eq!(desk.text(), BALL);
    desk.ctrl("1");
    assert_eq!(desk.text(), BALL.replace("0.5", "70.5"));
    // Saved, it is offered no more; nor is what was thrown away.
    desk.ctrl("s");
    desk.wait("the save", |editor| !editor.document().unwrap().is_dirty());
    desk.go_to("70");
    desk.type_text("1");
    desk.editor.finish();
    let mut desk = Desk::in_folder(desk.folder);
    desk.ctrl("2");
    desk.editor.finish();
    let desk = Desk::in_folder(desk.folder);
    assert!(desk.asked().is_none());
}

#[test]
fn while_a_number_is_turned_no_text_is_read() {
    let mut desk = Desk::new(BALL.as_bytes());
    assert!(desk.load());
    let at = BALL.find("0.5").unwrap();
    desk.editor.obey(EditorEvent::Grab(at + 1));
    assert_eq!(desk.reloads(), 1, "once, to make it an input");
    assert!(desk.load());
    for _ in 0..50 {
        desk.editor.obey(EditorEvent::Turn { points: 2.0, speed: TurnSpeed::Usual });
    }
    let commands = desk.commands();
    assert_eq!(commands.len(), 50, "no text is read: {commands:?}");
    let last = Command::TurnNumbers(TurnedNumbers { file: desk.file(), values: vec![(at, 0.7)] });
    assert_eq!(commands.last(), Some(&last));
    assert_eq!(desk.text(), BALL.replace("0.5", "0.7"));
    desk.editor.obey(EditorEvent::LetGo);
    assert_eq!(desk.reloads(), 1, "the text holds again");
    assert!(desk.load());
    assert_eq!(desk.editor.texts.findings().unwrap().numbers, [0_usize; 0]);
    desk.ctrl("z");
    assert_eq!(desk.text(), BALL, "all of it is taken back at once");
}

#[test]
fn a_hand_that_leaves_the_room_of_a_number_goes_on_in_another() {
    let mut desk = Desk::new(BALL.as_bytes());
    let at = BALL.find("0.5").unwrap();
    desk.editor.obey(EditorEvent::Grab(at));
    assert!(desk.load());
    assert_eq!(desk.reloads(), 1);
    desk.editor.obey(EditorEvent::Turn { points: 200.0, speed: TurnSpeed::Coarse });
    assert_eq!((desk.text(), desk.reloads()), (BALL.replace("0.5", "4.5"), 1));
    assert!(desk.load());
    desk.editor.obey(EditorEvent::Turn { points: 100.0, speed: TurnSpeed::Usual });
    let commands = desk.commands();
    let is = |commands: &[Command], at: usize, wanted: f32| match commands {
        [Command::TurnNumbers(TurnedNumbers { values, .. })] => {
            matches!(values[..], [(digits, value)] if digits == at && (value - wanted).abs() < 1e-5)
        }
        _ => false,
    };
    assert!(is(&commands, at, 4.7), "{commands:?}");
    // Below nothing it has a sign of its own, and the digits stand behind it.
    desk.editor.obey(EditorEvent::Turn { points: -400.0, speed: TurnSpeed::Coarse });
    assert_eq!(desk.text(), BALL.replace("0.5", "-3.3"));
    assert!(desk.load());
    assert_eq!(desk.editor.texts.findings().unwrap().numbers, [at + 1]);
    let _ = desk.commands();
    desk.editor.obey(EditorEvent::Turn { points: 50.0, speed: TurnSpeed::Usual });
    let commands = desk.commands();
    assert!(is(&commands, at + 1, 3.2), "{commands:?}");
}

#[test]
fn a_number_on_which_the_meaning_depends_is_read_each_time() {
    let text = "object o { shape = length(p) - sum(for i in 0..4: 0.1) }";
    let mut desk = Desk::new(text.as_bytes());
    desk.editor.obey(EditorEvent::Grab(text.find("4:").unwrap()));
    assert!(desk.load());
    let _ = desk.commands();
    desk.editor.obey(EditorEvent::Turn { points: 24.0, speed: TurnSpeed::Usual });
    assert_eq!((desk.text(), desk.reloads()), (text.replace("4:", "6:"), 1));
    assert!(desk.load());
    desk.editor.obey(EditorEvent::LetGo);
    assert_eq!(desk.text(), text.replace("4:", "6:"));
}

#[test]
fn keys_turn_numbers_and_make_parameters_of_them() {
    let mut desk = Desk::new(
        b"# A ball.\nmaterial m { roughness = 0.3 }\nobject o { shape = length(p) - 1  material = m }\n",
    );
    desk.go_to("0.3");
    assert!(desk.key(Key::Named(NamedKey::ArrowUp), Modifiers::ALT));
    assert!(desk.text().contains("roughness = 0.32"), "{}", desk.text());
    assert!(desk.key(Key::Named(NamedKey::ArrowDown), Modifiers::ALT | Modifiers::SHIFT));
    assert!(desk.text().contains("roughness = 0.318"), "{}", desk.text());
    desk.ctrl("p");
    assert_eq!(
        desk.text(),
        "# A ball.\nparam roughness_knob = 0.318 in 0 .. 0.636\nmaterial m { roughness = roughness_knob }\n\
         object o { shape = length(p) - 1  material = m }\n"
    );
    assert!(desk.load(), "{:?}", desk.editor.document().unwrap().mistake());
    desk.go_to("1  material");
    desk.ctrl("p");
    assert!(desk.text().contains("0.636\nparam knob = 1 in 0 .. 2\nmaterial"), "{}", desk.text());
    assert!(desk.load(), "{:?}", desk.editor.document().unwrap().mistake());
    desk.ctrl("z");
    assert!(!desk.text().contains("param knob"), "it is one step");
}

#[test]
fn proposals_come_while_one_types_and_tab_takes_them() {
    let mut desk = Desk::new(b"object o { shape =  }");
    desk.go_to(" }");
    desk.type_text("smooth_u");
    let first = desk.editor.proposals.shown().unwrap().list[0].clone();
    assert_eq!(first.name, "smooth_union");
    assert!(!first.about.text.is_empty());
    assert!(desk.named(NamedKey::Tab));
    assert!(desk.text().contains("smooth_union( }"), "{}", desk.text());
    // Enter is a new line unless somebody has gone through them.
    desk.type_text("sph\n");
    assert!(desk.text().contains("(sph\n"), "{}", desk.text());
    desk.type_text("bo");
    desk.named(NamedKey::ArrowDown);
    let second = desk.editor.proposals.shown().unwrap().list[1].name.clone();
    desk.named(NamedKey::Enter);
    assert!(desk.text().contains(&format!("\n{second}")), "{}", desk.text());
    desk.type_text(" bo");
    assert!(desk.named(NamedKey::Escape) && desk.editor.proposals.shown().is_none());
    assert!(
        desk.commands().iter().all(|command| *command == Command::ReloadScene),
        "Esc has closed the list only"
    );
    desk.named(NamedKey::Escape);
    assert_eq!(desk.commands(), [CLOSE]);
}

#[test]
fn a_shipped_scene_says_how_it_can_be_changed() {
    let mut desk = Desk::new(BALL.as_bytes());
    let orb = SceneSource::Shipped("orb".into());
    desk.editor.show_scene(&orb);
    let before = desk.text();
    assert_eq!(before, orb.text().unwrap());
    desk.type_text("x");
    assert_eq!(desk.text(), before);
    assert!(desk.said().contains("Ctrl+S"), "{}", desk.said());
    // What was typed in the other text is still there when it comes back.
    let main = desk.source();
    desk.editor.show_scene(&main);
    desk.go_to("0.5");
    desk.type_text("9");
    desk.editor.show_scene(&orb);
    desk.editor.show_scene(&main);
    assert_eq!(desk.text(), BALL.replace("0.5", "90.5"));
}

#[test]
fn ten_megabytes_bytes_that_are_no_text_and_mixed_line_ends_harm_nothing() {
    let bytes = b"# \xff\xfe\r\nlet r = 1\nlength(p) - r\r\n\0";
    let mut desk = Desk::new(bytes);
    assert!(!desk.load());
    let mistake = desk.editor.document().unwrap().mistake().unwrap();
    assert_eq!((mistake.range.clone(), mistake.message.contains("UTF-8")), (2..3, true));
    desk.editor.put_in(&vec![b'x'; 10 << 20]);
    assert!(desk.said().contains("1048576 bytes"), "{}", desk.said());
    desk.go_to("1\nlength");
    desk.type_text("2");
    desk.ctrl("s");
    desk.wait("the save", |editor| !editor.document().unwrap().is_dirty());
    assert_eq!(fs::read(desk.file()).unwrap(), b"# \xff\xfe\r\nlet r = 21\nlength(p) - r\r\n\0");
    // A binary file is shown as what it is.
    let binary: Vec<u8> = (0..=255).cycle().take(70_000).collect();
    fs::write(desk.file(), &binary).unwrap();
    desk.wait("the bytes", |editor| {
        editor.document().unwrap().disk == Some(OnDisk::Bytes(binary.clone().into()))
    });
    assert_eq!(desk.editor.document().unwrap().editing.buffer().bytes(), binary);
}

#[test]
fn words_are_found_from_key_to_key() {
    let mut desk = Desk::new(b"one two\ntwo one\n");
    desk.ctrl("f");
    desk.type_text("two");
    assert_eq!(desk.text(), "one two\ntwo one\n");
    let selected = |desk: &Desk| desk.editor.document().unwrap().editing.selection();
    desk.named(NamedKey::Enter);
    assert_eq!(selected(&desk), 4..7);
    desk.named(NamedKey::Enter);
    desk.named(NamedKey::F3);
    assert_eq!(selected(&desk), 4..7, "around the end");
    desk.named(NamedKey::Escape);
    assert!(desk.commands().is_empty() && desk.editor.find_line().is_none());
    desk.type_text("2");
    assert_eq!(desk.text(), "one 2\ntwo one\n");
}

#[test]
fn the_key_that_opened_the_editor_is_not_typed_while_it_is_held() {
    let mut desk = Desk::new(b"y");
    desk.editor.set_focus(false);
    desk.editor.set_focus(true);
    let key = Key::Character("e".to_owned());
    let press = |repeat| KeyPress { key: key.clone(), latin: Some('e'), text: Some("e".to_owned()), repeat };
    let mut take = |repeat| desk.editor.take_key(&press(repeat), Modifiers::empty());
    assert!(take(true));
    assert_eq!(desk.text(), "y");
    let mut take = |repeat| desk.editor.take_key(&press(repeat), Modifiers::empty());
    assert!(take(false) && take(true));
    assert_eq!(desk.text(), "eey");
    // Keys without letters are the show's.
    assert!(!desk.named(NamedKey::F11) && !desk.named(NamedKey::MediaPlayPause));
}

#[test]
fn a_new_scene_begins_with_something_to_see() {
    let source = SceneSource::Formula(super::files::TEMPLATE.to_owned());
    assert!(source.ready().is_ok(), "{:?}", source.ready().err());
}
