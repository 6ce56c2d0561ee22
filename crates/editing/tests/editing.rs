//! Property tests: random edits give the same bytes as edits of a plain `Vec`, the line index matches the bytes, and
//! every edit can be undone and redone.

#![allow(missing_docs, clippy::unwrap_used)]

use mariana_editing::{Buffer, Colors, Editing, Move, cells, column_of, offset_of, width};
use proptest::prelude::*;

#[derive(Debug, Clone)]
enum Action {
    Insert(Vec<u8>),
    Line,
    Delete(Move),
    Go(Move, bool),
    GoTo(usize, bool),
    Indent(bool),
    Comment,
    Turn(usize, Vec<u8>),
}

fn ways() -> impl Strategy<Value = Move> {
    prop_oneof![
        Just(Move::Left),
        Just(Move::Right),
        Just(Move::WordLeft),
        Just(Move::WordRight),
        (1_usize..4).prop_map(Move::Up),
        (1_usize..4).prop_map(Move::Down),
        Just(Move::LineStart),
        Just(Move::LineEnd),
        Just(Move::Start),
        Just(Move::End),
    ]
}

fn text() -> impl Strategy<Value = Vec<u8>> {
    let piece = prop_oneof![
        Just(b"a".to_vec()),
        Just(b"let x = 0.5".to_vec()),
        Just(b"\n".to_vec()),
        Just(b"\r\n".to_vec()),
        Just(b"\r".to_vec()),
        Just(b"\t".to_vec()),
        Just(b"/* ".to_vec()),
        Just(b" */".to_vec()),
        Just("球".as_bytes().to_vec()),
        Just("e\u{301}".as_bytes().to_vec()),
        Just(vec![0xff]),
        Just(vec![0xe7, 0x90]),
        any::<u8>().prop_map(|byte| vec![byte]),
    ];
    prop::collection::vec(piece, 0..12).prop_map(|pieces| pieces.concat())
}

fn actions() -> impl Strategy<Value = Vec<Action>> {
    let action = prop_oneof![
        text().prop_map(Action::Insert),
        Just(Action::Line),
        ways().prop_map(Action::Delete),
        (ways(), any::<bool>()).prop_map(|(way, select)| Action::Go(way, select)),
        (0_usize..80, any::<bool>()).prop_map(|(place, select)| Action::GoTo(place, select)),
        any::<bool>().prop_map(Action::Indent),
        Just(Action::Comment),
        (0_usize..40, text()).prop_map(|(place, text)| Action::Turn(place, text)),
    ];
    prop::collection::vec(action, 1..40)
}

fn act(editing: &mut Editing, action: &Action) {
    match action {
        Action::Insert(text) => editing.insert(text).unwrap(),
        Action::Line => editing.insert_line().unwrap(),
        Action::Delete(way) => editing.delete(*way),
        Action::Go(way, select) => editing.move_cursor(*way, *select),
        Action::GoTo(place, select) => editing.move_to(*place, *select),
        Action::Indent(deeper) => editing.indent(*deeper),
        Action::Comment => editing.toggle_comment(),
        Action::Turn(place, text) => editing.turn(*place..*place + 2, text).unwrap(),
    }
}

proptest! {
    #[test]
    fn all_edits_can_be_undone_and_redone(begin in text(), actions in actions()) {
        let mut editing = Editing::new(begin.clone());
        for action in &actions {
            act(&mut editing, action);
            prop_assert_eq!(editing.buffer(), &Buffer::new(editing.buffer().bytes().to_vec()));
            prop_assert!(editing.cursor() <= editing.buffer().len());
            prop_assert!(editing.selection().end <= editing.buffer().len());
        }
        let end = editing.buffer().bytes().to_vec();
        while editing.undo() {}
        prop_assert_eq!(editing.buffer().bytes(), begin);
        while editing.redo() {}
        prop_assert_eq!(editing.buffer().bytes(), end);
    }

    #[test]
    fn replacing_matches_a_plain_vec(begin in text(), new in text(), from in 0_usize..40, length in 0_usize..9) {
        let (mut buffer, mut model) = (Buffer::new(begin.clone()), begin);
        let (start, end) = (from.min(model.len()), (from + length).min(model.len()));
        let removed: Vec<u8> = model.splice(start..end, new.iter().copied()).collect();
        prop_assert_eq!(buffer.replace(from..from + length, &new), removed);
        prop_assert_eq!(&buffer, &Buffer::new(model));
    }

    #[test]
    fn cells_cover_a_line_without_a_gap(line in text()) {
        let (mut at, mut column) = (0, 0);
        for cell in cells(&line) {
            prop_assert_eq!((cell.start, cell.column), (at, column));
            prop_assert!(cell.end > cell.start);
            prop_assert_eq!(column_of(&line, cell.start), column);
            if cell.width > 0 {
                prop_assert_eq!(offset_of(&line, column as f32), cell.start);
            }
            (at, column) = (cell.end, column + cell.width);
        }
        prop_assert_eq!((at, width(&line)), (line.len(), column));
    }

    #[test]
    fn moving_right_and_back_visits_the_same_positions(begin in text()) {
        let mut editing = Editing::new(begin);
        let mut met = vec![0];
        while editing.cursor() < editing.buffer().len() {
            editing.move_cursor(Move::Right, false);
            prop_assert!(Some(&editing.cursor()) > met.last());
            met.push(editing.cursor());
        }
        while let Some(place) = met.pop() {
            prop_assert_eq!(editing.cursor(), place);
            editing.move_cursor(Move::Left, false);
        }
    }

    #[test]
    fn colours_after_an_edit_match_the_new_text(begin in text(), new in text(), from in 0_usize..40) {
        let mut buffer = Buffer::new(begin);
        let mut colors = Colors::default();
        let last = |buffer: &Buffer| buffer.line_count() - 1;
        let _ = colors.words(&buffer, last(&buffer));
        let line = buffer.line_of(from.min(buffer.len()));
        buffer.replace(from..from, &new);
        colors.forget_behind(line);
        for line in 0..=last(&buffer) {
            let words = colors.words(&buffer, line);
            prop_assert_eq!(&words, &Colors::default().words(&buffer, line));
            prop_assert!(words.iter().all(|word| word.start <= word.end && word.end <= buffer.line(line).len()));
        }
    }
}
