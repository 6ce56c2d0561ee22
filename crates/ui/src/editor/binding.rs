//! Writes the binding of a parameter to a sound into the scene's text.

use std::ops::Range;

use mariana_control::SoundBinding;
use mariana_editing::Editing;
use mariana_field::graph::UnitInput;

use super::{Document, Editor};

/// A binding that waits until the text can be edited: the file is being read, or a shipped scene is being copied.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ToWrite {
    pub(super) name: String,
    pub(super) binding: SoundBinding,
    /// True once the copy of a shipped scene has been requested.
    pub(super) is_copied: bool,
}

pub(super) fn write_waiting(editor: &mut Editor) {
    let Some(to_write) = editor.to_write.take() else { return };
    let Some(document) = editor.document() else { return };
    let is_shipped = document.file().is_none();
    if !is_shipped && document.disk.is_none() || is_shipped && to_write.is_copied {
        editor.to_write = Some(to_write);
        return;
    }
    let (range, line) = match place_of(document, &to_write) {
        Ok(place) => place,
        Err(words) => return editor.show_notice(words),
    };
    if is_shipped {
        match editor.texts.save() {
            Ok(()) => editor.to_write = Some(ToWrite { is_copied: true, ..to_write }),
            Err(words) => editor.show_notice(words),
        }
        return;
    }
    let (start, length) = (range.start, line.len());
    editor.edit(|editing: &mut Editing| {
        editing.settle();
        editing.replace_part(range, line.as_bytes())?;
        editing.settle();
        editing.select(start..start + length);
        Ok(())
    });
    if editor.notice.words().is_none() {
        let name = &to_write.name;
        editor.show_notice(format!("{name} now follows the sound in the text; Ctrl+Z undoes this"));
    }
}

/// Returns the range of the parameter's declaration, and the text that replaces it.
fn place_of(document: &Document, to_write: &ToWrite) -> Result<(Range<usize>, String), String> {
    let ToWrite { name, binding, .. } = to_write;
    let input = UnitInput::named(&binding.input)
        .ok_or_else(|| format!("this version does not know the sound {}", binding.input))?;
    let expression = input.expression().ok_or_else(|| {
        format!("a scene cannot express {}: choose another sound for {name}", input.label())
    })?;
    let buffer = document.editing.buffer();
    let mut found = None;
    for line in 0..buffer.line_count() {
        let (text, words) = (buffer.line(line), document.words(line));
        let code: Vec<&str> = words
            .iter()
            .filter_map(|word| std::str::from_utf8(text.get(word.start..word.end)?).ok())
            .take_while(|word| !word.starts_with('#'))
            .collect();
        let [declares, declared, ..] = code[..] else { continue };
        if !["param", "let", "fn"].contains(&declares) {
            continue;
        }
        let is_indented = text.first().is_some_and(u8::is_ascii_whitespace);
        if declares == "param" && declared == name {
            let ends =
                words.first().map(|word| word.start).zip(words.get(code.len() - 1).map(|word| word.end));
            found = ends.map(|(start, end)| (buffer.line_start(line), start..end));
        }
        // A parameter named like the sound, such as `param bar`, cannot be written in terms of this sound.
        if !is_indented && names_in(&expression).any(|used| used == declared) {
            return Err(format!("the scene has its own {declared}: rename it, or choose another sound"));
        }
    }
    let (line_start, range) = found.ok_or_else(|| {
        format!("{name} is not declared in this text: press Ctrl+Tab for the included files")
    })?;
    let written = format!("let {name} = {}", binding.expression(&expression));
    Ok((line_start + range.start..line_start + range.end, written))
}

fn names_in(expression: &str) -> impl Iterator<Item = &str> {
    expression.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').filter(|name| !name.is_empty())
}
