//! Prints a cue list as the text of a show file.

use std::fmt::Write;

use super::cue_list::{Anchor, CueList, Entry, Length, Setting, TransitionKind, is_of_no_scene};
use super::resolve::clock_to;
use mariana_field::world::{BlendKind, PortalShape};

/// Maximum number of decimals of a time in seconds. Recordings need more than three decimals only where the song
/// jumped back.
const MOMENT_DECIMALS: usize = 6;

/// Returns the text of a show file for `cue_list`, with `comments` as its first lines.
pub fn print(cue_list: &CueList, comments: &[String]) -> String {
    let mut text = String::new();
    for comment in comments {
        let _ = writeln!(text, "# {}", comment.replace(char::is_control, " "));
    }
    if !comments.is_empty() {
        text.push('\n');
    }
    let moments: Vec<String> = cue_list.entries.iter().map(moment).collect();
    let width = moments.iter().map(String::len).max().unwrap_or(0);
    for (entry, moment) in cue_list.entries.iter().zip(&moments) {
        let _ = write!(text, "at {moment:width$}  {}", name(&entry.scene));
        if let Some(camera) = &entry.camera {
            let _ = write!(text, "  camera {}", name(camera));
        }
        if let Some(transition) = entry.transition {
            let _ = write!(text, "  {}", transition.kind.style().name());
            if let TransitionKind::Blend(kind @ BlendKind::Portal(shape)) = transition.kind
                && shape != PortalShape::default()
            {
                let _ = write!(text, " {}", kind.name());
            }
            if transition.by_fader {
                text.push_str(" by fader");
            } else if transition.kind != TransitionKind::Cut {
                let _ = write!(text, " over {}", length(transition.length));
                text.push_str(if transition.unfinished { " unfinished" } else { "" });
            }
        }
        text.push('\n');
        for setting in &entry.settings {
            text.push_str(&set(setting));
        }
    }
    text
}

/// Returns the moment of an entry as a show file has it, such as `section B + 2 bars`.
pub fn moment(entry: &Entry) -> String {
    let numbered = |what: &str, number: u32| format!("{what} {number}");
    let anchor = match &entry.when.anchor {
        Anchor::Start => "start".to_owned(),
        Anchor::End => "end".to_owned(),
        Anchor::Cue => "cue".to_owned(),
        Anchor::Previous => "previous".to_owned(),
        Anchor::Time(seconds) => clock_to(*seconds, MOMENT_DECIMALS),
        Anchor::Bar(bar) => numbered("bar", *bar),
        Anchor::Drop(number) => numbered("drop", *number),
        Anchor::Build(number) => numbered("build", *number),
        Anchor::Section(letter, 1) => format!("section {letter}"),
        Anchor::Section(letter, number) => format!("section {letter} {number}"),
    };
    let offset = entry.when.offset;
    match offset.number() {
        0.0 => anchor,
        number if number < 0.0 => format!("{anchor} - {}", length(offset)),
        _ => format!("{anchor} + {}", length(offset)),
    }
}

/// Maximum length of a line. A longer animation is broken into several lines.
const WIDTH: usize = 100;

fn set(setting: &Setting) -> String {
    let is_plain = is_of_no_scene(&setting.param);
    let param = if is_plain { setting.param.clone() } else { name(&setting.param) };
    let mut text = format!("  set {param} = {}", setting.from);
    let after = match setting.after.number() {
        number if number > 0.0 => format!(" after {}", length(setting.after)),
        _ => String::new(),
    };
    let steps: Vec<String> =
        setting.steps.iter().map(|step| format!(" -> {} over {}", step.to, length(step.over))).collect();
    if text.len() + steps.iter().map(String::len).sum::<usize>() + after.len() <= WIDTH {
        return text + &steps.concat() + &after + "\n";
    }
    text += &after;
    let mut column = WIDTH;
    for step in steps {
        if column + step.len() > WIDTH {
            text += "\n   ";
            column = "   ".len();
        }
        column += step.len();
        text += &step;
    }
    text + "\n"
}

/// Formats the absolute value of a length.
fn length(length: Length) -> String {
    let number = length.number().abs();
    let names = Length::UNITS
        .iter()
        .find(|unit| (unit.of)(length.number()) == length)
        .map_or(&["s"][..], |unit| unit.names);
    let of_one = names.first().copied().unwrap_or("s");
    let unit = if number == 1.0 { of_one } else { names.last().copied().unwrap_or(of_one) };
    format!("{number} {unit}")
}

/// Formats a name, with quotes if necessary.
fn name(name: &str) -> String {
    let is_plain = name.starts_with(|c: char| c.is_alphabetic() || c == '_')
        && name.chars().all(|c| c.is_alphanumeric() || c == '_');
    if is_plain { name.to_owned() } else { format!("\"{}\"", name.replace(['"', '\n', '\r'], " ")) }
}
