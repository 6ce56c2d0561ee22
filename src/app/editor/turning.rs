//! Numbers that are turned in the text: the text changes with the hand, and the picture does without the text being read
//! again.
//!
//! When a number is taken, the scene is loaded once more with this number as an input of a frame that has a range. From
//! then on its value goes straight into the frame. Only when the hand leaves the range, or for a number on which the
//! scene's meaning depends, the text is read again.

use std::ops::Range;
use std::path::PathBuf;

use mariana_editing::{Number, TurnSpeed, numbers_before};
use mariana_field::lang::Turning;

use super::{Editor, Effect};
use crate::scenes::Findings;

/// Points of the hand for a key.
const POINTS_OF_KEY: f64 = 10.0;

/// A number that is being turned.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Turn {
    file: PathBuf,
    number: Number,
    /// Where the number stands now.
    now: Range<usize>,
    /// How far the hand has moved, in points of the usual speed.
    hand: f64,
    held: Option<Held>,
}

/// The number as an input of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Held {
    /// Its place among the numbers of the text.
    place: usize,
    /// Where its digits begin in the text that was loaded.
    digits: usize,
    /// Whether a sign stands before them there.
    negated: bool,
    /// From what to what a frame may set it.
    room: (f32, f32),
    /// The version of the drafts from which on it is one.
    since: u64,
}

impl Turn {
    /// Where the number stands.
    pub(super) fn range(&self) -> Range<usize> {
        self.now.clone()
    }
}

impl Editor {
    /// Takes the number at a place.
    pub(super) fn grab(&mut self, at: usize) {
        self.let_go();
        self.set_focus(true);
        self.close_small();
        let Some(document) = self.documents.get(self.shown) else { return };
        let (true, Some(file)) = (document.is_open(), document.file()) else {
            // It says why not.
            self.edit(|_| Ok(()));
            return;
        };
        let file = file.to_owned();
        let Some((number, line_start)) = document.number(at) else { return };
        let now = line_start + number.range.start..line_start + number.range.end;
        let is_main = self.source.as_ref().is_some_and(|source| document.is_of(source));
        let text = document.editing.buffer().bytes();
        let place = numbers_before(text, line_start + number.digits).filter(|_| is_main);
        let value = number.value;
        self.turn = Some(Turn { file, number, now: now.clone(), hand: 0.0, held: None });
        if let Some(place) = place {
            self.hold(place, value);
        }
        if let Some(document) = self.document_mut() {
            document.editing.select(now);
        }
        self.revision += 1;
    }

    /// Makes the number an input, with room around a value; the text is read for that.
    fn hold(&mut self, place: usize, value: f64) {
        let Some(turn) = &mut self.turn else { return };
        let Some(document) = self.documents.get_mut(self.shown) else { return };
        // A sign may have come or gone.
        let start = turn.now.start;
        let negated = document.editing.buffer().slice(start..start + 1) == b"-";
        let room = Number::room(digits_value(value, negated));
        let turning = Turning { place, least: room.0, most: room.1 };
        let digits = start + usize::from(negated);
        if document.is_dirty() {
            self.drafts.set(&turn.file, document.bytes());
        }
        let since = self.drafts.turn(Some((&turn.file, turning)));
        document.note_sent(since);
        turn.held = Some(Held { place, digits, negated, room, since });
        self.effects.push(Effect::Reload);
    }

    /// Turns the number by so many points of the hand.
    pub(super) fn turn(&mut self, points: f64, speed: TurnSpeed) {
        let Some(turn) = &mut self.turn else { return };
        turn.hand += points * speed.factor();
        let value = turn.number.turned(turn.hand, speed);
        let text = turn.number.written(value, speed);
        let (range, held) = (turn.now.clone(), turn.held);
        turn.now = range.start..range.start + text.len();
        let written = text.parse::<f64>().unwrap_or(value);
        self.write_turned(range, &text);
        let (Some(held), Some(turn)) = (held, &self.turn) else { return };
        let value = digits_value(written, held.negated);
        if (held.room.0..=held.room.1).contains(&value) {
            self.effects.push(Effect::Turn { file: turn.file.clone(), digits: held.digits, value });
        } else {
            // Read with the new text, as one that goes on from there.
            self.hold(held.place, written);
        }
    }

    fn write_turned(&mut self, range: Range<usize>, text: &str) {
        let Some(document) = self.documents.get_mut(self.shown) else { return };
        let refused = document.editing.turn(range.clone(), text.as_bytes()).err();
        document.editing.select_turned(range.start..range.start + text.len());
        self.note_change();
        if let Some(refused) = refused {
            self.say(refused.to_string());
        }
    }

    /// Whether the number that is turned needs no reading of the text.
    pub(super) fn turn_is_live(&self) -> bool {
        self.turn.as_ref().is_some_and(|turn| turn.held.is_some())
    }

    /// Looks whether the number that is turned has become an input. Where the meaning depends on it, it has not, and the
    /// text is read for each value.
    pub(super) fn check_turn(&mut self, findings: &Findings) {
        let Some(turn) = &mut self.turn else { return };
        let Some(held) = turn.held else { return };
        if findings.version >= held.since && !findings.numbers.contains(&held.digits) {
            turn.held = None;
            self.drafts.turn(None);
            self.send_again();
        }
    }

    /// Hands the text to the loader as it is.
    fn send_again(&mut self) {
        let Some(document) = self.documents.get_mut(self.shown) else { return };
        let Some(file) = document.file() else { return };
        let version = match document.is_dirty() {
            true => self.drafts.set(file, document.bytes()),
            false => self.drafts.remove(file),
        };
        document.note_sent(version);
        self.effects.push(Effect::Reload);
    }

    /// Lets go of the number: the text holds from now on.
    pub(super) fn let_go(&mut self) {
        let Some(turn) = self.turn.take() else { return };
        if let Some(document) = self.document_mut() {
            document.editing.settle();
        }
        if turn.held.is_some() {
            self.drafts.turn(None);
            self.send_again();
        }
        self.revision += 1;
    }

    /// Turns the number at the cursor by a key.
    pub(super) fn turn_by_key(&mut self, up: bool, fine: bool) {
        let Some(document) = self.documents.get_mut(self.shown).filter(|document| document.is_open()) else {
            self.edit(|_| Ok(()));
            return;
        };
        let cursor = document.editing.selection().start;
        let Some((number, line_start)) = document.number(cursor) else {
            return self.say("put the cursor into a number to turn it");
        };
        let speed = if fine { TurnSpeed::Fine } else { TurnSpeed::Usual };
        let least = if number.turned(POINTS_OF_KEY, speed) == number.value { 2.0 } else { 1.0 };
        let points = POINTS_OF_KEY * least * speed.factor() * if up { 1.0 } else { -1.0 };
        let text = number.written(number.turned(points, speed), speed);
        let range = line_start + number.range.start..line_start + number.range.end;
        let start = range.start;
        self.edit(|editing| {
            editing.turn(range, text.as_bytes())?;
            editing.select_turned(start..start + text.len());
            Ok(())
        });
    }

    /// Makes a parameter with a slider of the number at the cursor.
    pub(super) fn make_param(&mut self) {
        let Some(document) = self.document() else { return };
        let found = document.number(document.editing.selection().start);
        let Some((number, line_start)) = found else {
            return self.say("put the cursor into a number to make a parameter of it");
        };
        let buffer = document.editing.buffer();
        let line = buffer.line(buffer.line_of(line_start));
        let (name, at) = (name_for(buffer.bytes(), line, number.digits), param_place(buffer));
        let written =
            String::from_utf8_lossy(line.get(number.range.clone()).unwrap_or_default()).into_owned();
        let value = number.value;
        let (least, most) =
            if value == 0.0 { (-1.0, 1.0) } else { (value.min(2.0 * value), value.max(2.0 * value)) };
        let (least, most) = (if value > 0.0 { 0.0 } else { least }, if value < 0.0 { 0.0 } else { most });
        let end = String::from_utf8_lossy(buffer.line_end()).into_owned();
        let line = format!("param {name} = {written} in {least} .. {most}{end}");
        let range = line_start + number.range.start..line_start + number.range.end;
        if range.start < at {
            return self.say("numbers of parameters stay numbers");
        }
        let said = format!("{name} is a parameter now: Tab, without the editor, shows its slider");
        self.edit(|editing| {
            editing.replace_parts(&[(range, name.clone().into_bytes()), (at..at, line.into_bytes())])?;
            editing.select(at + "param ".len()..at + "param ".len() + name.len());
            Ok(())
        });
        if self.answer.is_none() {
            self.say(said);
        }
    }
}

/// What the digits of a number are by themselves if a sign stands before them, or does not.
fn digits_value(value: f64, negated: bool) -> f32 {
    if negated { -value as f32 } else { value as f32 }
}

/// Where a parameter is declared: behind those that are there, or before the first line that is no comment, no blank and
/// no include.
fn param_place(buffer: &mariana_editing::Buffer) -> usize {
    let starts = |line: usize, word: &[u8]| buffer.line(line).trim_ascii_start().starts_with(word);
    let last = (0..buffer.line_count()).rev().find(|line| starts(*line, b"param "));
    if let Some(last) = last {
        return buffer.line_start(last + 1);
    }
    let is_before = |line: &usize| {
        starts(*line, b"#") || starts(*line, b"include") || buffer.line(*line).trim_ascii().is_empty()
    };
    let first = (0..buffer.line_count()).find(|line| !is_before(line)).unwrap_or(0);
    buffer.line_start(first)
}

/// A name that the text does not have: that of the field to which the number belongs, or a plain one.
fn name_for(text: &[u8], line: &[u8], digits: usize) -> String {
    let before = String::from_utf8_lossy(line.get(..digits).unwrap_or_default()).into_owned();
    let is_letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let field = before.trim_end().strip_suffix('=').map(|rest| {
        let rest = rest.trim_end();
        rest.get(rest.rfind(|c| !is_letter(c)).map_or(0, |at| at + 1)..).unwrap_or_default().to_owned()
    });
    let stem = field.filter(|field| field.starts_with(|c: char| c.is_ascii_alphabetic()));
    let stem = stem.unwrap_or_else(|| "knob".to_owned());
    let text = String::from_utf8_lossy(text);
    let is_there = |name: &str| text.split(|c| !is_letter(c)).any(|word| word == name);
    let names = (0_usize..).map(|number| match number {
        // A field's name alone would hide nothing, but reads like the field.
        0 => format!("{stem}_knob"),
        number => format!("{stem}_knob{}", number + 1),
    });
    let mut names = names.map(|name| if stem == "knob" { name.replacen("knob_", "", 1) } else { name });
    names.find(|name| !is_there(name)).unwrap_or(stem)
}
