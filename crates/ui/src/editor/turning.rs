//! Numbers that are turned in the text: the text changes with the hand, and the picture does without the text being read
//! again.
//!
//! When a number is taken, the scene is loaded once more with this number as an input of a frame that has a range. From
//! then on its value goes straight into the frame. Only when the hand leaves the range, or for a number on which the
//! scene's meaning depends, the text is read again.

use std::ops::Range;
use std::path::PathBuf;

use mariana_commands::{Command, TurnedNumbers};
use mariana_editing::{Number, TurnSpeed, numbers_before};
use mariana_field::lang::Turning;

use super::Editor;
use mariana_scenes::Findings;

/// Points of the hand for a key.
const POINTS_OF_KEY: f64 = 10.0;

/// Numbers of one line that are being turned: one, or the three of a `vec3`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Turn {
    file: PathBuf,
    /// Each as it was taken, and where it stands now.
    numbers: Vec<(Number, Range<usize>)>,
    /// How far the hand has moved, in points of the usual speed.
    hand: f64,
    /// What three numbers are, before they are rounded to be written.
    exact: [f64; 3],
    held: Option<Held>,
}

/// The numbers as inputs of a frame.
#[derive(Debug, Clone, PartialEq)]
struct Held {
    inputs: Vec<HeldNumber>,
    /// The version of the drafts from which on they are.
    since: u64,
}

/// A number as an input of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
struct HeldNumber {
    /// Its place among the numbers of the text.
    place: usize,
    /// Where its digits begin in the text that was loaded.
    digits: usize,
    /// Whether a sign stands before them there.
    negated: bool,
    /// From what to what a frame may set it.
    room: (f32, f32),
}

impl Turn {
    /// Where the numbers stand, from the first to the last.
    pub(super) fn range(&self) -> Range<usize> {
        let ends = self.numbers.first().zip(self.numbers.last());
        ends.map_or(0..0, |(first, last)| first.1.start..last.1.end)
    }

    /// Whether they are three.
    pub(super) fn is_triple(&self) -> bool {
        self.numbers.len() == 3
    }

    /// What the three are, exactly.
    pub(super) fn exact(&self) -> [f64; 3] {
        self.exact
    }
}

impl Editor {
    /// Takes the number at a place.
    pub(super) fn grab(&mut self, at: usize) {
        self.close_small();
        let Some(document) = self.documents.get(self.shown) else { return };
        let Some((number, line_start)) = document.number(at) else { return self.let_go() };
        self.take_numbers(vec![number], line_start);
    }

    /// Takes numbers of a line that begins at a byte. Returns whether they can be turned.
    pub(super) fn take_numbers(&mut self, numbers: Vec<Number>, line_start: usize) -> bool {
        self.let_go();
        self.set_focus(true);
        let Some(document) = self.documents.get(self.shown) else { return false };
        let (true, Some(file)) = (document.is_open(), document.file()) else {
            // It says why not.
            self.edit(|_| Ok(()));
            return false;
        };
        let file = file.to_owned();
        let is_main = self.source.as_ref().is_some_and(|source| document.is_of(source));
        let text = document.editing.buffer().bytes();
        let places: Vec<usize> = numbers
            .iter()
            .filter_map(|number| numbers_before(text, line_start + number.digits).filter(|_| is_main))
            .collect();
        let values: Vec<f64> = numbers.iter().map(|number| number.value).collect();
        let exact = std::array::from_fn(|part| values.get(part).copied().unwrap_or_default());
        let placed = |number: Number| {
            let now = line_start + number.range.start..line_start + number.range.end;
            (number, now)
        };
        let numbers: Vec<_> = numbers.into_iter().map(placed).collect();
        let is_one = numbers.len() == 1;
        let turn = Turn { file, numbers, hand: 0.0, exact, held: None };
        let range = turn.range();
        self.turn = Some(turn);
        if places.len() == values.len() {
            self.hold(&places, &values);
        }
        if let Some(document) = self.document_mut().filter(|_| is_one) {
            document.editing.select(range);
        }
        self.revision += 1;
        true
    }

    /// Makes the numbers inputs, with room around their values; the text is read for that.
    fn hold(&mut self, places: &[usize], values: &[f64]) {
        let Some(turn) = &mut self.turn else { return };
        let Some(document) = self.documents.get_mut(self.shown) else { return };
        let mut inputs = Vec::new();
        let is_triple = turn.is_triple();
        for (((_, now), place), value) in turn.numbers.iter().zip(places).zip(values) {
            // A sign may have come or gone.
            let negated = document.editing.buffer().slice(now.start..now.start + 1) == b"-";
            let digits = digits_value(*value, negated);
            // What three numbers are is a colour or a place: no text divides by it, so it may pass 0.
            let wide = 4.0 * digits.abs().max(1.0);
            let room = if is_triple { (-wide, wide) } else { Number::room(digits) };
            let digits = now.start + usize::from(negated);
            inputs.push(HeldNumber { place: *place, digits, negated, room });
        }
        let turning: Vec<Turning> = inputs
            .iter()
            .map(|input| Turning { place: input.place, least: input.room.0, most: input.room.1 })
            .collect();
        if document.is_dirty() {
            self.drafts.set(&turn.file, document.bytes());
        }
        let since = self.drafts.turn(Some((&turn.file, &turning)));
        document.note_sent(since);
        turn.held = Some(Held { inputs, since });
        self.commands.push(Command::ReloadScene);
    }

    /// Turns the number by so many points of the hand.
    pub(super) fn turn(&mut self, points: f64, speed: TurnSpeed) {
        let Some(turn) = &mut self.turn else { return };
        turn.hand += points * speed.factor();
        let [(number, _)] = &turn.numbers[..] else { return };
        let text = number.written(number.turned(turn.hand, speed), speed);
        self.write_turned(&[text]);
    }

    /// Gives the three numbers that are turned other values.
    pub(super) fn turn_three(&mut self, values: [f64; 3]) {
        let Some(turn) = self.turn.as_mut().filter(|turn| turn.is_triple()) else { return };
        turn.exact = values;
        self.write_turned(&values.map(mariana_editing::written_part));
    }

    /// Writes numbers in the place of those that are turned, and hands their values on.
    fn write_turned(&mut self, texts: &[String]) {
        let (Some(turn), Some(document)) = (&mut self.turn, self.documents.get_mut(self.shown)) else {
            return;
        };
        let whole = turn.range();
        let (mut new, mut behind) = (Vec::new(), whole.start);
        for ((_, now), text) in turn.numbers.iter_mut().zip(texts) {
            new.extend_from_slice(document.editing.buffer().slice(behind..now.start));
            behind = now.end;
            let start = whole.start + new.len();
            new.extend_from_slice(text.as_bytes());
            *now = start..start + text.len();
        }
        let (now, held, file) = (turn.range(), turn.held.clone(), turn.file.clone());
        let is_one = texts.len() == 1;
        let refused = document.editing.turn(whole, &new).err();
        document.editing.select_turned(if is_one { now } else { now.end..now.end });
        self.note_change();
        if let Some(refused) = refused {
            self.say(refused.to_string());
        }
        let Some(held) = held else { return };
        let values: Vec<f64> = texts.iter().map(|text| text.parse().unwrap_or_default()).collect();
        let inputs = held.inputs.iter().zip(&values);
        let of_frame: Vec<(HeldNumber, f32)> =
            inputs.map(|(input, value)| (*input, digits_value(*value, input.negated))).collect();
        if of_frame.iter().all(|(input, value)| (input.room.0..=input.room.1).contains(value)) {
            let values = of_frame.into_iter().map(|(input, value)| (input.digits, value)).collect();
            self.commands.push(Command::TurnNumbers(TurnedNumbers { file, values }));
        } else {
            // Read with the new text, as numbers that go on from there.
            let places: Vec<usize> = held.inputs.iter().map(|input| input.place).collect();
            self.hold(&places, &values);
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
        let Some(held) = &turn.held else { return };
        let are_inputs = held.inputs.iter().all(|input| findings.numbers.contains(&input.digits));
        if findings.version >= held.since && !are_inputs {
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
        self.commands.push(Command::ReloadScene);
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
