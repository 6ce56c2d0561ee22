//! Numbers that are turned like knobs. Text and frame follow a turn without reloading the scene.
//!
//! When the user grabs a number, the scene is loaded once more with this number as a frame input that has a range. From
//! then on, values go straight into the frame. The text is parsed again only if a value leaves the range, or if the
//! number affects the scene's structure.

use std::ops::Range;
use std::path::{Path, PathBuf};

use mariana_commands::{Command, TurnedNumbers};
use mariana_editing::{Number, Refused, TurnSpeed, numbers_before};
use mariana_field::lang::Turning;

use super::document::Document;
use super::texts::{Edit, Texts};

/// Pointer movement, in points, that equals one key press.
const POINTS_OF_KEY: f64 = 10.0;

/// Numbers of one line that are being turned: a single number, or the three numbers of a `vec3`.
#[derive(Debug, Clone, PartialEq)]
struct Turn {
    file: PathBuf,
    /// The grabbed numbers with their old values, and their present byte ranges.
    numbers: Vec<(Number, Range<usize>)>,
    /// Pointer movement so far, in points at the usual speed.
    moved: f64,
    /// Values of a triple before they are rounded for the text.
    exact: [f64; 3],
    held: Option<Held>,
}

#[derive(Debug, Clone, PartialEq)]
struct Held {
    inputs: Vec<HeldNumber>,
    /// The version of the drafts since which the numbers are inputs.
    since: u64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct HeldNumber {
    /// The input's index among the numbers of the text, and the range in which a frame may set the input without a new
    /// parse of the text.
    turning: Turning,
    /// Offset of the input's digits in the loaded text.
    digits: usize,
    /// True if a minus precedes the digits in the loaded text.
    negated: bool,
}

impl Turn {
    fn range(&self) -> Range<usize> {
        let ends = self.numbers.first().zip(self.numbers.last());
        ends.map_or(0..0, |(first, last)| first.1.start..last.1.end)
    }

    fn is_triple(&self) -> bool {
        self.numbers.len() == 3
    }
}

#[derive(Default)]
pub(crate) struct HeldNumbers {
    turn: Option<Turn>,
    /// Byte offset of the colour that is open in the picker.
    pub(super) picked: Option<usize>,
}

impl HeldNumbers {
    pub(crate) fn turned(&self) -> Option<Range<usize>> {
        self.turn.as_ref().map(Turn::range)
    }

    pub(crate) fn turns_three(&self) -> bool {
        self.turn.as_ref().is_some_and(Turn::is_triple)
    }

    pub(crate) fn picked_color(&self, document: &Document) -> Option<(usize, [f64; 3])> {
        let at = self.picked?;
        let (triple, _) = document.triple_at(at)?;
        Some((at, triple.values()))
    }

    /// The position at the cursor in the scene's coordinates, unless the picker is open.
    pub(crate) fn place(&self, document: &Document) -> Option<[f64; 3]> {
        let (values, sign) = document.place_at_cursor().filter(|_| self.picked.is_none())?;
        Some(values.map(|value| sign * value))
    }

    pub(super) fn close_picker(&mut self, texts: &mut Texts) -> bool {
        let was = self.picked.take().is_some();
        if was && self.turns_three() {
            self.let_go(texts);
        }
        was
    }

    /// Grabs numbers of the line that begins at `line_start`. If the text is read-only, returns the reason.
    pub(super) fn grab(
        &mut self,
        numbers: Vec<Number>,
        line_start: usize,
        texts: &mut Texts,
    ) -> Result<(), &'static str> {
        self.let_go(texts);
        let is_main = texts.is_main();
        let Some(document) = texts.documents.shown_mut() else { return Ok(()) };
        document.check_open()?;
        let Some(file) = document.file().map(Path::to_owned) else { return Ok(()) };
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
        let turn =
            Turn { file, numbers: numbers.into_iter().map(placed).collect(), moved: 0.0, exact, held: None };
        let range = turn.range();
        self.turn = Some(turn);
        if places.len() == values.len() {
            self.hold(&places, &values, texts);
        }
        if let Some(document) = texts.documents.shown_mut().filter(|_| values.len() == 1) {
            document.editing.select(range);
        }
        Ok(())
    }

    /// Makes the numbers frame inputs with a range around their values. For this, the text is parsed again.
    fn hold(&mut self, places: &[usize], values: &[f64], texts: &mut Texts) {
        let (Some(turn), Some(document)) = (&mut self.turn, texts.documents.shown()) else { return };
        let mut inputs = Vec::new();
        let is_triple = turn.is_triple();
        for (((_, now), place), value) in turn.numbers.iter().zip(places).zip(values) {
            // The minus may have been added or removed since the load.
            let negated = document.editing.buffer().slice(now.start..now.start + 1) == b"-";
            let digits = digits_value(*value, negated);
            // No scene divides by a colour or a position, so its range may include 0.
            let wide = 4.0 * digits.abs().max(1.0);
            let (least, most) = if is_triple { (-wide, wide) } else { Number::room(digits) };
            let digits = now.start + usize::from(negated);
            inputs.push(HeldNumber { turning: Turning { place: *place, least, most }, digits, negated });
        }
        let turning: Vec<Turning> = inputs.iter().map(|input| input.turning).collect();
        turn.held = texts.hold(&turn.file, &turning).map(|since| Held { inputs, since });
    }

    pub(super) fn turn(&mut self, points: f64, speed: TurnSpeed, texts: &mut Texts) -> Result<(), Refused> {
        let Some(turn) = &mut self.turn else { return Ok(()) };
        turn.moved += points * speed.factor();
        let [(number, _)] = &turn.numbers[..] else { return Ok(()) };
        let text = number.written(number.turned(turn.moved, speed), speed);
        self.write(&[text], texts)
    }

    pub(super) fn turn_three(&mut self, values: [f64; 3], texts: &mut Texts) -> Result<(), Refused> {
        let Some(turn) = self.turn.as_mut().filter(|turn| turn.is_triple()) else { return Ok(()) };
        turn.exact = values;
        self.write(&values.map(mariana_editing::written_part), texts)
    }

    pub(super) fn move_three(&mut self, way: [f64; 3], texts: &mut Texts) -> Result<(), Refused> {
        let Some(before) = self.turn.as_ref().map(|turn| turn.exact) else { return Ok(()) };
        let place = texts.documents.shown().and_then(Document::place_at_cursor);
        let sign = place.map_or(1.0, |(_, sign)| sign);
        self.turn_three(std::array::from_fn(|axis| before[axis] + sign * way[axis]), texts)
    }

    fn write(&mut self, written: &[String], texts: &mut Texts) -> Result<(), Refused> {
        let (Some(turn), Some(document)) = (&mut self.turn, texts.documents.shown_mut()) else {
            return Ok(());
        };
        let whole = turn.range();
        let (mut new, mut behind) = (Vec::new(), whole.start);
        for ((_, now), text) in turn.numbers.iter_mut().zip(written) {
            new.extend_from_slice(document.editing.buffer().slice(behind..now.start));
            behind = now.end;
            let start = whole.start + new.len();
            new.extend_from_slice(text.as_bytes());
            *now = start..start + text.len();
        }
        let now = turn.range();
        let done = document.editing.turn(whole, &new);
        let is_one = written.len() == 1;
        document.editing.select_turned(if is_one { now } else { now.end..now.end });
        texts.record_change();
        let values: Vec<f64> = written.iter().map(|text| text.parse().unwrap_or_default()).collect();
        self.hand_on(&values, texts);
        done
    }

    fn hand_on(&mut self, values: &[f64], texts: &mut Texts) {
        let Some(turn) = &self.turn else { return };
        let Some(held) = &turn.held else { return };
        let inputs = held.inputs.iter().zip(values);
        let of_frame: Vec<(HeldNumber, f32)> =
            inputs.map(|(input, value)| (*input, digits_value(*value, input.negated))).collect();
        let fits = |turning: Turning, value: &f32| (turning.least..=turning.most).contains(value);
        if of_frame.iter().all(|(input, value)| fits(input.turning, value)) {
            let values = of_frame.into_iter().map(|(input, value)| (input.digits, value)).collect();
            let turned = TurnedNumbers { file: turn.file.clone(), values };
            texts.outbox.commands.push(Command::TurnNumbers(turned));
        } else {
            // A value is out of range: parse the new text, with ranges around the new values.
            let places: Vec<usize> = held.inputs.iter().map(|input| input.turning.place).collect();
            self.hold(&places, values, texts);
        }
    }

    /// After new findings, checks if the numbers became inputs. Numbers that affect the scene's structure cannot.
    pub(super) fn check(&mut self, texts: &mut Texts) {
        let (Some(turn), Some(findings)) = (&mut self.turn, texts.findings.as_ref()) else { return };
        let Some(held) = &turn.held else { return };
        let are_inputs = held.inputs.iter().all(|input| findings.numbers.contains(&input.digits));
        if findings.version >= held.since && !are_inputs {
            turn.held = None;
            texts.release();
        }
    }

    /// Releases the numbers, so that the text defines them again.
    pub(super) fn let_go(&mut self, texts: &mut Texts) {
        let Some(turn) = self.turn.take() else { return };
        if let Some(document) = texts.documents.shown_mut() {
            document.editing.settle();
        }
        if turn.held.is_some() {
            texts.release();
        }
    }
}

/// The edit by a key that turns the number at the selection.
pub(super) fn key_turn(document: &Document, up: bool, fine: bool) -> Option<Edit> {
    let (number, line_start) = document.number(document.editing.selection().start)?;
    let speed = if fine { TurnSpeed::Fine } else { TurnSpeed::Usual };
    let least = if number.turned(POINTS_OF_KEY, speed) == number.value { 2.0 } else { 1.0 };
    let points = POINTS_OF_KEY * least * speed.factor() * if up { 1.0 } else { -1.0 };
    let text = number.written(number.turned(points, speed), speed);
    let (start, end) = (line_start + number.range.start, line_start + number.range.end);
    Some(Box::new(move |editing| {
        editing.turn(start..end, text.as_bytes())?;
        editing.select_turned(start..start + text.len());
        Ok(())
    }))
}

fn digits_value(value: f64, negated: bool) -> f32 {
    if negated { -value as f32 } else { value as f32 }
}
