//! Conversion of a number in the text into a parameter.

use mariana_editing::Buffer;

use super::document::Document;
use super::texts::Edit;

/// Prepares the parameter. Returns its name and the edit that makes it, or a message if there is no suitable number at
/// the cursor.
pub(super) fn new_param(document: &Document) -> Result<(String, Edit), &'static str> {
    let found = document.number(document.editing.selection().start);
    let (number, line_start) = found.ok_or("put the cursor on a number first")?;
    let buffer = document.editing.buffer();
    let line = buffer.line(buffer.line_of(line_start));
    let (name, at) = (name_for(buffer.bytes(), line, number.digits), param_place(buffer));
    let written = String::from_utf8_lossy(line.get(number.range.clone()).unwrap_or_default()).into_owned();
    let value = number.value;
    let (least, most) =
        if value == 0.0 { (-1.0, 1.0) } else { (value.min(2.0 * value), value.max(2.0 * value)) };
    let (least, most) = (if value > 0.0 { 0.0 } else { least }, if value < 0.0 { 0.0 } else { most });
    let end = String::from_utf8_lossy(buffer.line_end()).into_owned();
    let line = format!("param {name} = {written} in {least} .. {most}{end}");
    let number = line_start + number.range.start..line_start + number.range.end;
    if number.start < at {
        return Err("this number already belongs to a parameter");
    }
    let new = name.clone().into_bytes();
    let edit: Edit = Box::new(move |editing| {
        let start = at + "param ".len();
        let selected = start..start + new.len();
        editing.replace_parts(&[(number, new.as_slice()), (at..at, line.as_bytes())])?;
        editing.select(selected);
        Ok(())
    });
    Ok((name, edit))
}

/// Returns where to declare the parameter: after the last parameter, or else before the first code after the includes.
fn param_place(buffer: &Buffer) -> usize {
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

/// Returns an unused name for the parameter, made from the name of the number's field.
fn name_for(text: &[u8], line: &[u8], digits: usize) -> String {
    let before = String::from_utf8_lossy(line.get(..digits).unwrap_or_default()).into_owned();
    let is_letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let field = before.trim_end().strip_suffix('=').map(|rest| {
        let rest = rest.trim_end();
        rest.get(rest.rfind(|c| !is_letter(c)).map_or(0, |at| at + 1)..).unwrap_or_default().to_owned()
    });
    let field = field.filter(|field| field.starts_with(|c: char| c.is_ascii_alphabetic()));
    // The suffix distinguishes the parameter from the field in the text.
    let stem = field.map_or_else(|| "knob".to_owned(), |field| field + "_knob");
    let text = String::from_utf8_lossy(text);
    let is_there = |name: &str| text.split(|c| !is_letter(c)).any(|word| word == name);
    let numbered = (2_usize..).map(|number| format!("{stem}{number}"));
    let free = std::iter::once(stem.clone()).chain(numbered).find(|name| !is_there(name));
    free.unwrap_or(stem)
}
